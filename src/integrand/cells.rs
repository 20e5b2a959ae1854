//! Values on equal cells: images and tables. All is exact.

use rustfft::num_complex::Complex;

use super::shape::{Shape, grid, turn};
use crate::fourier::transform;
use crate::sinc::sinc;

/// A function that is constant on equal cells.
pub(super) struct Cells {
    shape: [usize; 3],
    /// The last axis fastest.
    values: Vec<f64>,
    /// DFT(v) / number of cells.
    transform: Vec<Complex<f64>>,
    /// The mean of v_i v_(i+j), cyclic.
    products: Vec<f64>,
    square_integral: f64,
}

impl Cells {
    /// `values` with the last axis fastest.
    pub(super) fn new(shape: [usize; 3], values: Vec<f64>) -> Self {
        let n = values.len() as f64;
        let mut field: Vec<_> = values.iter().map(|&v| Complex::from(v / n)).collect();
        transform(&mut field, &shape);
        let mut power: Vec<_> = field.iter().map(|c| Complex::from(c.norm_sqr())).collect();
        // Even, so that the transform forwards is the one back.
        transform(&mut power, &shape);
        let products = power.into_iter().map(|c| c.re).collect();
        let square_integral = values.iter().map(|v| v * v).sum::<f64>() / n;
        Self { shape, values, transform: field, products, square_integral }
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[0] * self.shape[1] + cell[1]) * self.shape[2] + cell[2]
    }

    fn transformed(&self, m: [i32; 3]) -> Complex<f64> {
        self.transform[self.index(std::array::from_fn(|k| m[k].rem_euclid(self.shape[k] as i32) as usize))]
    }

    /// The transform of one cell along an axis, over its length.
    fn cell(&self, axis: usize, m: i32) -> Complex<f64> {
        let part = f64::from(m) / self.shape[axis] as f64;
        turn(0.5 * part) * sinc(part)
    }
}

impl Shape for Cells {
    fn value(&self, x: [f64; 3]) -> f64 {
        let cell = |k: usize| ((x[k] * self.shape[k] as f64) as usize).min(self.shape[k] - 1);
        self.values[self.index(std::array::from_fn(cell))]
    }

    fn square_integral(&self) -> f64 {
        self.square_integral
    }

    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        self.transformed(m) * self.cell(0, m[0]) * self.cell(1, m[1]) * self.cell(2, m[2])
    }

    fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        let lists: [Vec<Complex<f64>>; 3] =
            std::array::from_fn(|k| (-(max[k] as i32)..=max[k] as i32).map(|m| self.cell(k, m)).collect());
        let of = |k: usize, m: i32| lists[k][(m + max[k] as i32) as usize];
        grid(max, |m| self.transformed(m) * of(0, m[0]) * of(1, m[1]) * of(2, m[2]))
    }

    /// Linear between lags of whole cells, along every axis.
    fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        let mut at = [[0; 2]; 3];
        let mut weight = [[0.0; 2]; 3];
        for k in 0..3 {
            let n = self.shape[k];
            let place = r[k] * n as f64;
            let j = (place as usize).min(n - 1);
            let part = place - j as f64;
            at[k] = [j, if j + 1 == n { 0 } else { j + 1 }];
            weight[k] = [1.0 - part, part];
        }
        let mut sum = 0.0;
        for i in 0..2 {
            for j in 0..2 {
                for k in 0..2 {
                    let w = weight[0][i] * weight[1][j] * weight[2][k];
                    if w != 0.0 {
                        sum += w * self.products[self.index([at[0][i], at[1][j], at[2][k]])];
                    }
                }
            }
        }
        sum
    }

    fn cells(&self) -> Option<([usize; 3], &[f64])> {
        Some((self.shape, &self.values))
    }

    fn smoothness(&self) -> f64 {
        1.0
    }
}

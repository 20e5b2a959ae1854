//! A function that is known by its values alone: polynomials on equal cells, whose transform and autocorrelation are exact.

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::quadrature::{gauss, legendre};
use super::shape::{grid, turn, wrap};
use crate::fourier::transform;

/// Legendre series of degree `ORDER - 1` per axis and cell, through the values at the places of Gauss's rule.
pub(super) struct Pieces {
    dim: usize,
    cells: usize,
    /// For each product of Legendre polynomials, the first axis slowest: the DFT of its coefficients over the cells / number of cells.
    transforms: Vec<Vec<Complex<f64>>>,
    /// a at lags of whole cells, which is exact.
    products: Vec<f64>,
}

/// Terms of the series, per axis.
pub(super) const ORDER: usize = 4;

/// Lags that are interpolated between, per axis.
const LAGS: usize = 6;

impl Pieces {
    /// Of `f` on `cells` cells per axis.
    pub(super) fn new(dim: usize, cells: usize, f: impl Fn([f64; 3]) -> f64 + Sync) -> Self {
        let shape = vec![cells; dim];
        let (total, terms) = (cells.pow(dim as u32), ORDER.pow(dim as u32));
        let rule = gauss(ORDER);
        // (2 l + 1) / 2 w_g P_l(x_g): from values to coefficients along one axis.
        let matrix: Vec<Vec<f64>> = (0..ORDER)
            .map(|l| rule.iter().map(|&(x, w)| (l as f64 + 0.5) * w * legendre(ORDER, x)[l]).collect())
            .collect();
        let series = |cell: usize| {
            let place = |k: usize, i: usize| {
                let index = cell / cells.pow((dim - 1 - k) as u32) % cells;
                (index as f64 + 0.5 * (1.0 + rule[i].0)) / cells as f64
            };
            let node = |g: usize, k: usize| g / ORDER.pow((dim - 1 - k) as u32) % ORDER;
            let at = |g: usize| f(std::array::from_fn(|k| if k < dim { place(k, node(g, k)) } else { 0.0 }));
            let mut values: Vec<f64> = (0..terms).map(at).collect();
            for k in 0..dim {
                let step = ORDER.pow((dim - 1 - k) as u32);
                let along = |g: usize| {
                    let start = g - node(g, k) * step;
                    (0..ORDER).map(|i| matrix[node(g, k)][i] * values[start + i * step]).sum()
                };
                values = (0..terms).map(along).collect();
            }
            values
        };
        let all: Vec<f64> = (0..total).into_par_iter().flat_map_iter(series).collect();
        let transforms: Vec<Vec<Complex<f64>>> = (0..terms)
            .into_par_iter()
            .map(|l| {
                let mut field: Vec<_> =
                    all.iter().skip(l).step_by(terms).map(|&c| Complex::from(c / total as f64)).collect();
                transform(&mut field, &shape);
                field
            })
            .collect();
        // The polynomials are orthogonal: at lags of whole cells only equal ones meet, with 1 / (2 l + 1) per axis.
        let mut power = vec![Complex::default(); total];
        for (l, field) in transforms.iter().enumerate() {
            let norm: f64 = degrees(l, dim).map(|l| 1.0 / (2.0 * l as f64 + 1.0)).product();
            power.iter_mut().zip(field).for_each(|(p, c)| *p += norm * c.norm_sqr());
        }
        transform(&mut power, &shape);
        Self { dim, cells, transforms, products: power.into_iter().map(|c| c.re).collect() }
    }

    /// `(-i)^l j_l(pi m h)` along an axis: the transform of a Legendre polynomial.
    fn factors(&self, m: i32) -> [Complex<f64>; ORDER] {
        let part = f64::from(m) / self.cells as f64;
        let x = std::f64::consts::PI * part;
        let shift = turn(0.5 * part);
        let powers = [Complex::new(1.0, 0.0), Complex::new(0.0, -1.0), Complex::new(-1.0, 0.0), Complex::new(0.0, 1.0)];
        let sign = |l: i32| if x < 0.0 && l % 2 == 1 { -1.0 } else { 1.0 };
        std::array::from_fn(|l| {
            let l = l as i32;
            let j = if x == 0.0 { f64::from(u8::from(l == 0)) } else { super::radial::spherical_bessel(l, x.abs()) };
            shift * powers[l as usize] * (sign(l) * j)
        })
    }

    fn combined(&self, m: [i32; 3], factor: impl Fn(usize, usize) -> Complex<f64>) -> Complex<f64> {
        let cell = (0..self.dim).fold(0, |i, k| i * self.cells + m[k].rem_euclid(self.cells as i32) as usize);
        let term = |(l, field): (usize, &Vec<Complex<f64>>)| {
            degrees(l, self.dim).enumerate().fold(field[cell], |c, (k, l)| c * factor(k, l))
        };
        self.transforms.iter().enumerate().map(term).sum()
    }

    pub(super) fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        let lists = m.map(|m| self.factors(m));
        self.combined(m, |k, l| lists[k][l])
    }

    pub(super) fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        let lists = max.map(|max| (-(max as i32)..=max as i32).map(|m| self.factors(m)).collect::<Vec<_>>());
        grid(max, |m| self.combined(m, |k, l| lists[k][(m[k] + max[k] as i32) as usize][l]))
    }

    /// Between lags of whole cells by polynomials through the six nearest on the same side of the wrap, where a may have a kink.
    pub(super) fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        let n = self.cells;
        let mut first = [0; 3];
        let mut weights = [[0.0; LAGS]; 3];
        for k in 0..self.dim {
            let place = wrap(r[k]) * n as f64;
            first[k] = (place as usize).saturating_sub(LAGS / 2 - 1).min(n + 1 - LAGS);
            let x = place - first[k] as f64;
            for (i, weight) in weights[k].iter_mut().enumerate() {
                let others = (0..LAGS).filter(|j| *j != i);
                *weight = others.map(|j| (x - j as f64) / (i as f64 - j as f64)).product();
            }
        }
        let at = |k: usize, i: usize| (first[k] + i) % n;
        let line = |base: usize, k: usize| -> f64 {
            (0..LAGS).map(|i| weights[k][i] * self.products[base * n + at(k, i)]).sum()
        };
        match self.dim {
            1 => line(0, 0),
            2 => (0..LAGS).map(|i| weights[0][i] * line(at(0, i), 1)).sum(),
            _ => (0..LAGS)
                .map(|i| {
                    let plane = |j: usize| weights[1][j] * line(at(0, i) * n + at(1, j), 2);
                    weights[0][i] * (0..LAGS).map(plane).sum::<f64>()
                })
                .sum(),
        }
    }
}

/// The degrees per axis of a product of polynomials.
fn degrees(l: usize, dim: usize) -> impl Iterator<Item = usize> {
    (0..dim).map(move |k| l / ORDER.pow((dim - 1 - k) as u32) % ORDER)
}

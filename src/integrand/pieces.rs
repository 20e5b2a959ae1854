//! A function that is known by its values alone: polynomials on equal cells, whose transform and autocorrelation are exact.

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::quadrature::{gauss, legendre};
use super::shape::{grid, turn, wrap};
use crate::fourier::transform;

/// Cells per axis, by dimension.
pub(super) const CELLS: [usize; 3] = [4096, 256, 32];

/// Errors are twice what half as many cells differ by.
const SAFETY: f64 = 2.0;

/// Steps of a sequence that is evenly spread in the box.
pub(super) const SPREAD: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];

/// What pieces know of a function, and how well.
pub(super) struct Known {
    pieces: Pieces,
    /// What f_m, and a, may err by.
    pub(super) coefficient_error: f64,
    pub(super) autocorrelation_error: f64,
}

impl Known {
    /// Of a function whose integral is known better than by its pieces: that is f_0, and its square the mean of a.
    pub(super) fn new(dim: usize, f: impl Fn([f64; 3]) -> f64 + Sync, integral: f64) -> Self {
        let cells = CELLS[dim - 1];
        let [pieces, half] = [cells, cells / 2].map(|cells| Pieces::new(dim, cells, &f).with_integral(integral));
        let (coefficient_error, autocorrelation_error) = differences(dim, &pieces, &half);
        Self { pieces, coefficient_error, autocorrelation_error }
    }
}

impl std::ops::Deref for Known {
    type Target = Pieces;

    fn deref(&self) -> &Pieces {
        &self.pieces
    }
}

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

    /// The same with another integral.
    fn with_integral(mut self, integral: f64) -> Self {
        // The first product is that of constants, its first coefficient the mean.
        let before = std::mem::replace(&mut self.transforms[0][0], Complex::from(integral));
        let more = integral * integral - before.norm_sqr();
        self.products.iter_mut().for_each(|a| *a += more);
        self
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

/// The largest difference of f_m and of a, each times what makes it safe: of f_m on the axes, where most of a function of one coordinate
/// is, and elsewhere, low and high; of a between lags of whole cells.
fn differences(dim: usize, fine: &Pieces, coarse: &Pieces) -> (f64, f64) {
    let within = |x: [f64; 3]| std::array::from_fn(|k| if k < dim { x[k] } else { 0.0 });
    // In no order, evenly spread: Kronecker's sequence of the plastic numbers.
    let spread = |i: i32| within(SPREAD.map(|step| wrap(f64::from(i) * step)));
    let lags = (1..200).map(spread);
    let a = lags.map(|r| (fine.autocorrelation(r) - coarse.autocorrelation(r)).abs()).fold(0.0, f64::max);
    let elsewhere = (1..200).map(|i| {
        let reach = if i < 100 { 9.0 } else { 100.0 };
        spread(i).map(|r| if r == 0.0 { 0 } else { ((2.0 * r - 1.0) * reach).round() as i32 })
    });
    let axes = (0..dim).flat_map(|axis| (0..64).map(move |m| std::array::from_fn(|k| if k == axis { m } else { 0 })));
    let f = axes.chain(elsewhere).map(|m| (fine.coefficient(m) - coarse.coefficient(m)).norm()).fold(0.0, f64::max);
    (SAFETY * f, SAFETY * a)
}

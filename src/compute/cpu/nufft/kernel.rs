//! The kernel that points are spread with: the exponential of semicircle, its polynomials and its Fourier transform.
//!
//! `phi(t) = exp(beta (sqrt(1 - (2 t / w)^2) - 1))` for `|t| <= w / 2`, in cells of the fine grid (Barnett, Magland,
//! af Klinteberg, SIAM J. Sci. Comput. 41, C479, 2019).

use std::f64::consts::{PI, TAU};

use crate::plan::MAX_KERNEL_WIDTH as MAX_WIDTH;

/// Terms of the Chebyshev series that polynomials are cut from.
const TERMS: usize = 32;

/// The exponential of semicircle of one axis.
#[derive(Debug, Clone)]
pub(super) struct SpreadingKernel {
    width: usize,
    beta: f64,
    /// Coefficients by falling power of `u`, each for all pieces; 0 beyond the width.
    pieces: Vec<[f64; MAX_WIDTH]>,
}

impl SpreadingKernel {
    /// The kernel of `width` cells for a grid upsampled by `sigma`, its polynomials good to `tolerance` of its peak.
    pub(super) fn new(width: usize, sigma: f64, tolerance: f64) -> Self {
        // The transform then falls to the aliasing error just where the first alias begins (a
        // little less than that is best, for the widest kernel less so).
        let share = if width == MAX_WIDTH { 0.985 } else { 0.975 };
        let beta = share * PI * width as f64 * (1.0 - 0.5 / sigma);
        let mut kernel = Self { width, beta, pieces: Vec::new() };
        kernel.pieces = kernel.fit(tolerance);
        kernel
    }

    /// Its width in cells.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    fn value(&self, t: f64) -> f64 {
        let z = 2.0 * t / self.width as f64;
        // sqrt(1 - z^2) - 1 without the rounding error of the difference; the ends may be rounded outwards.
        let semicircle = (1.0 - z * z).max(0.0).sqrt();
        (-self.beta * z * z / (1.0 + semicircle)).exp()
    }

    /// Piece `k` is `phi` at the distances `u / 2 + (w - 1) / 2 - k`, for `u` in [-1, 1]: a Chebyshev series, cut where the
    /// rest is below the tolerance for all pieces, as powers of `u`.
    fn fit(&self, tolerance: f64) -> Vec<[f64; MAX_WIDTH]> {
        // T_n at Chebyshev node i; whole turns are dropped while the angle is exact.
        let chebyshev = |n: usize, i: usize| ((n * (2 * i + 1) % (4 * TERMS)) as f64 * PI / (2 * TERMS) as f64).cos();
        let mut series = vec![[0.0; MAX_WIDTH]; TERMS];
        for k in 0..self.width {
            let centre = 0.5 * (self.width as f64 - 1.0) - k as f64;
            let values: [f64; TERMS] = std::array::from_fn(|i| self.value(0.5 * chebyshev(1, i) + centre));
            for (n, term) in series.iter_mut().enumerate() {
                let sum: f64 = values.iter().enumerate().map(|(i, v)| v * chebyshev(n, i)).sum();
                term[k] = sum * if n == 0 { 1.0 } else { 2.0 } / TERMS as f64;
            }
        }
        let rest = |from: usize, k: usize| series[from..].iter().map(|term| term[k].abs()).sum::<f64>();
        let terms = (1..TERMS).find(|&n| (0..self.width).all(|k| rest(n, k) <= tolerance)).unwrap_or(TERMS);

        // T_0 and T_1 as powers of u; then T_(n + 1) = 2 u T_n - T_(n - 1).
        let mut last = vec![0.0; terms];
        let mut this = vec![0.0; terms];
        this[0] = 1.0;
        let mut powers = vec![[0.0; MAX_WIDTH]; terms];
        for (n, term) in series[..terms].iter().enumerate() {
            for (power, factor) in powers.iter_mut().zip(&this) {
                for (sum, c) in power.iter_mut().zip(term) {
                    *sum += factor * c;
                }
            }
            let twice = if n == 0 { 1.0 } else { 2.0 };
            let next = (0..terms).map(|p| if p == 0 { 0.0 } else { twice * this[p - 1] } - last[p]).collect();
            last = std::mem::replace(&mut this, next);
        }
        powers.reverse();
        powers
    }

    /// The coefficients of all pieces by falling power of `u`.
    pub(super) fn pieces(&self) -> &[[f64; MAX_WIDTH]] {
        &self.pieces
    }

    /// `integral phi(t) exp(-2 pi i m t / cells) dt` for `m` in `0..=largest`, by Gauss-Legendre quadrature.
    pub(super) fn transform(&self, cells: usize, largest: usize) -> Vec<f64> {
        // cos((start + k) a) = cos(start a) cos(k a) - sin(start a) sin(k a): few cosines, and no error that grows.
        const RUN: usize = 32;
        // An even integrand: half of the nodes do. More than enough of them for 16 cells and |m| <= cells / 2.
        let half = 0.5 * self.width as f64;
        let nodes: Vec<(f64, f64)> = gauss_legendre(4 * self.width + 40)
            .into_iter()
            .filter(|(x, _)| *x > 0.0)
            .map(|(x, weight)| (TAU * x * half / cells as f64, 2.0 * half * weight * self.value(x * half)))
            .collect();
        let tables: Vec<[(f64, f64); RUN]> =
            nodes.iter().map(|(a, _)| std::array::from_fn(|k| (k as f64 * a).sin_cos())).collect();
        let mut transform = vec![0.0; (largest + 1).next_multiple_of(RUN)];
        for (run, sums) in transform.chunks_exact_mut(RUN).enumerate() {
            for ((a, weight), table) in nodes.iter().zip(&tables) {
                let (sin, cos) = ((run * RUN) as f64 * a).sin_cos();
                for (sum, (s, c)) in sums.iter_mut().zip(table) {
                    *sum += weight * (cos * c - sin * s);
                }
            }
        }
        transform.truncate(largest + 1);
        transform
    }
}

/// Nodes and weights on [-1, 1], `count` even: the roots of the Legendre polynomial by Newton's method from Tricomi's estimate.
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let rule = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut last, mut this) = (1.0, x);
            for n in 2..=count {
                let n = n as f64;
                (last, this) = (this, ((2.0 * n - 1.0) * x * this - (n - 1.0) * last) / n);
            }
            slope = count as f64 * (x * this - last) / (x * x - 1.0);
            x -= this / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(rule).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_exact_for_polynomials() {
        for count in [2, 40, 104] {
            let rule = gauss_legendre(count);
            for power in 0..2 * count as i32 {
                let sum: f64 = rule.iter().map(|(x, weight)| weight * x.powi(power)).sum();
                let exact = if power % 2 == 0 { 2.0 / (f64::from(power) + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-14, "{count} nodes, x^{power}: {sum}, not {exact}");
            }
        }
    }

    #[test]
    fn polynomials_are_the_kernel() {
        for (width, tolerance) in [(2, 1e-2), (7, 1e-6), (8, 1e-7), (13, 1e-12), (16, 1e-15)] {
            let kernel = SpreadingKernel::new(width, 2.0, tolerance);
            for k in 0..width {
                for u in (-100..=100).map(|u| f64::from(u) / 100.0) {
                    let fit = kernel.pieces().iter().fold(0.0, |sum, power| sum * u + power[k]);
                    let error = (fit - kernel.value(0.5 * (u + width as f64 - 1.0) - k as f64)).abs();
                    assert!(error <= 1.01 * tolerance + 5e-16, "width {width}, piece {k}, u = {u}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn transform_is_that_of_the_kernel() {
        // The trapezoidal rule on so many nodes sees the transform at m and, far below rounding, its aliases.
        let kernel = SpreadingKernel::new(13, 2.0, 1e-12);
        let (cells, steps) = (1000, 1 << 16);
        for (m, found) in kernel.transform(cells, 250).into_iter().enumerate() {
            let t = |i: i32| 13.0 * (f64::from(i) + 0.5) / f64::from(steps) - 6.5;
            let term = |i: i32| kernel.value(t(i)) * (TAU * m as f64 * t(i) / cells as f64).cos();
            let sum = (0..steps).map(term).sum::<f64>() * 13.0 / f64::from(steps);
            assert!((found - sum).abs() <= 1e-13 * sum, "m = {m}: {found}, not {sum}");
        }
    }
}

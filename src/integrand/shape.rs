//! What an integrand of one dimension and one set of parameters can do.

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::Separable;
use super::elementary::nearest;

/// A function on the unit box, made ready. Axes that the box lacks have coordinate, lag and frequency 0.
pub(super) trait Shape: Send + Sync {
    /// f at `x` in [0, 1)^d.
    fn value(&self, x: [f64; 3]) -> f64;

    /// f at many places in [0, 1)^d. A loop of its own for every shape: nothing is looked up per place.
    fn values(&self, x: &[[f64; 3]], out: &mut [f64]) {
        for (out, &x) in out.iter_mut().zip(x) {
            *out = self.value(x);
        }
    }

    /// I, the integral of f.
    fn integral(&self) -> f64 {
        self.coefficient([0; 3]).re
    }

    /// A bound of the error of the two integrals that is more than rounding.
    fn integral_error(&self) -> f64 {
        0.0
    }

    /// The integral of f^2.
    fn square_integral(&self) -> f64 {
        self.autocorrelation([0.0; 3])
    }

    /// `f_m = int f(x) exp(-2 pi i m.x) dx`.
    fn coefficient(&self, m: [i32; 3]) -> Complex<f64>;

    /// A bound of its error that is more than rounding.
    fn coefficient_error(&self) -> f64 {
        0.0
    }

    /// `a(r) = int f(x) f(x + r mod 1) dx` at `r` in [0, 1)^d.
    fn autocorrelation(&self, r: [f64; 3]) -> f64;

    /// A bound of its error that is more than rounding.
    fn autocorrelation_error(&self) -> f64 {
        0.0
    }

    /// a at many lags, anywhere. A loop of its own for every shape: nothing is looked up per lag.
    fn autocorrelations(&self, r: &[[f64; 3]], out: &mut [f64]) {
        for (out, &r) in out.iter_mut().zip(r) {
            *out = self.autocorrelation(r.map(wrap));
        }
    }

    /// f_m on the whole grid `|m_k| <= max_k`, the first axis slowest, index m + max.
    fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        grid(max, |m| self.coefficient(m))
    }

    /// Its factors, if it is an offset and a product of functions of one coordinate each.
    fn separable(&self) -> Option<&Separable> {
        None
    }

    /// The cells per axis that it is constant on, and their values, the last axis fastest.
    fn cells(&self) -> Option<([usize; 3], &[f64])> {
        None
    }

    /// c of `|f_m|^2 ~ |m|^(-d-c)`: 1 with a jump, 3 with a kink, infinite where f is smooth, also across the wrap.
    fn smoothness(&self) -> f64;
}

/// `x` folded into [0, 1). The remainder of a tiny negative number rounds to 1, which is 0 on a torus.
pub(super) fn wrap(x: f64) -> f64 {
    let f = x - x.floor();
    if f < 1.0 { f } else { 0.0 }
}

/// `exp(-2 pi i t)`.
pub(super) fn turn(t: f64) -> Complex<f64> {
    let (sin, cos) = (std::f64::consts::TAU * nearest(t)).sin_cos();
    Complex::new(cos, -sin)
}

/// `m.x`, reduced by whole turns on each axis so that large frequencies lose nothing.
pub(super) fn phase(m: [i32; 3], x: [f64; 3]) -> f64 {
    (0..3).map(|k| nearest(f64::from(m[k]) * x[k])).sum()
}

/// A function with `f_-m = conj f_m` on the whole grid: half is computed, by all threads, and half mirrored.
pub(super) fn grid(max: [u32; 3], f: impl Fn([i32; 3]) -> Complex<f64> + Sync) -> Vec<Complex<f64>> {
    let shape = max.map(|f| 2 * f as usize + 1);
    let len: usize = shape.iter().product();
    let at = |i: usize, k: usize| i as i32 - max[k] as i32;
    let mode = |i: usize| {
        let (i0, i1, i2) = (i / (shape[1] * shape[2]), i / shape[2] % shape[1], i % shape[2]);
        [at(i0, 0), at(i1, 1), at(i2, 2)]
    };
    let mut all: Vec<Complex<f64>> =
        (0..len.div_ceil(2)).into_par_iter().with_min_len(256).map(|i| f(mode(i))).collect();
    all.reserve_exact(len - all.len());
    for i in (0..len / 2).rev() {
        let mirrored = all[i].conj();
        all.push(mirrored);
    }
    all
}

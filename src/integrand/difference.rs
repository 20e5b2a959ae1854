//! What is left of one function less a multiple of another.

use std::sync::Arc;

use rustfft::num_complex::Complex;

use super::pieces::{CELLS, Pieces};
use super::quadrature::nested;
use super::shape::Shape;

/// `f - s p`: values and f_m by those of both, a by cubic pieces on equal cells, as a formula's.
pub(super) struct Difference {
    f: Arc<dyn Shape>,
    p: Arc<dyn Shape>,
    scale: f64,
    square_integral: f64,
    integral_error: f64,
    pieces: Pieces,
}

impl Difference {
    pub(super) fn new(dim: usize, f: Arc<dyn Shape>, p: Arc<dyn Shape>, scale: f64) -> Self {
        let product = nested(dim, |x| f.value(x) * p.value(x));
        let square_integral = f.square_integral() - 2.0 * scale * product.value + scale * scale * p.square_integral();
        let integral_error = f.integral_error() + 2.0 * scale.abs() * (product.error + p.integral_error());
        let pieces = Pieces::new(dim, CELLS[dim - 1], |x| f.value(x) - scale * p.value(x));
        Self { f, p, scale, square_integral, integral_error, pieces }
    }
}

impl Shape for Difference {
    fn value(&self, x: [f64; 3]) -> f64 {
        self.f.value(x) - self.scale * self.p.value(x)
    }

    fn integral(&self) -> f64 {
        self.f.integral() - self.scale * self.p.integral()
    }

    fn integral_error(&self) -> f64 {
        self.integral_error
    }

    fn square_integral(&self) -> f64 {
        self.square_integral
    }

    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        self.f.coefficient(m) - self.p.coefficient(m) * self.scale
    }

    fn coefficient_error(&self) -> f64 {
        self.f.coefficient_error() + self.scale.abs() * self.p.coefficient_error()
    }

    fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        let (f, p) = (self.f.coefficients(max), self.p.coefficients(max));
        f.into_iter().zip(p).map(|(f, p)| f - p * self.scale).collect()
    }

    fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        self.pieces.autocorrelation(r)
    }

    fn smoothness(&self) -> f64 {
        self.f.smoothness().min(self.p.smoothness())
    }
}

//! Products of functions of one coordinate, with an offset.

use rustfft::num_complex::Complex;

use super::factors::Factor;
use super::shape::{Shape, grid};

/// `offset + scale * prod_k f_k(x_k)`: its f_m, a(r) and integrals are products too.
#[derive(Debug, Clone, PartialEq)]
pub struct Separable {
    offset: f64,
    scale: f64,
    factors: Vec<Factor>,
    /// The integral of the product.
    mean: f64,
}

impl Separable {
    /// The product, one factor per axis.
    pub(super) fn product(factors: Vec<Factor>) -> Self {
        let mean = factors.iter().map(Factor::integral).product();
        Self { offset: 0.0, scale: 1.0, factors, mean }
    }

    /// `offset + scale * product`.
    pub(super) fn with_offset(self, offset: f64, scale: f64) -> Self {
        Self { offset, scale, ..self }
    }

    /// What is added to the product.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// By what the product is multiplied.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The factors, one per axis.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// `a = o^2 + 2 o s I + s^2 a_p` of the product's a and integral: constant and factor.
    fn parts(&self) -> (f64, f64) {
        (self.offset * (self.offset + 2.0 * self.scale * self.mean), self.scale * self.scale)
    }
}

impl Shape for Separable {
    fn value(&self, x: [f64; 3]) -> f64 {
        self.offset + self.scale * self.factors.iter().zip(x).map(|(f, x)| f.value(x)).product::<f64>()
    }

    fn values(&self, x: &[[f64; 3]], out: &mut [f64]) {
        out.fill(1.0);
        for (axis, factor) in self.factors.iter().enumerate().filter(|(_, factor)| **factor != Factor::One) {
            factor.times_values(x, axis, out);
        }
        out.iter_mut().for_each(|f| *f = self.offset + self.scale * *f);
    }

    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        let product: Complex<f64> = self.factors.iter().zip(m).map(|(f, m)| f.coefficient(m)).product();
        let dc = if m == [0; 3] { self.offset } else { 0.0 };
        product * self.scale + dc
    }

    fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        let (constant, factor) = self.parts();
        constant + factor * self.factors.iter().zip(r).map(|(f, r)| f.autocorrelation(r)).product::<f64>()
    }

    /// Factor by factor, so that what kind it is is asked once.
    fn autocorrelations(&self, r: &[[f64; 3]], out: &mut [f64]) {
        out.fill(1.0);
        for (axis, factor) in self.factors.iter().enumerate().filter(|(_, factor)| **factor != Factor::One) {
            factor.times_autocorrelations(r, axis, out);
        }
        let (constant, factor) = self.parts();
        out.iter_mut().for_each(|a| *a = constant + factor * *a);
    }

    /// The outer product of one list per axis.
    fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        let lists: Vec<Vec<Complex<f64>>> = self
            .factors
            .iter()
            .zip(max)
            .map(|(factor, max)| (-(max as i32)..=max as i32).map(|m| factor.coefficient(m)).collect())
            .collect();
        grid(max, |m| {
            let product: Complex<f64> =
                lists.iter().enumerate().map(|(k, list)| list[(m[k] + max[k] as i32) as usize]).product();
            let dc = if m == [0; 3] { self.offset } else { 0.0 };
            product * self.scale + dc
        })
    }

    fn separable(&self) -> Option<&Separable> {
        Some(self)
    }

    fn smoothness(&self) -> f64 {
        self.factors.iter().map(Factor::smoothness).fold(f64::INFINITY, f64::min)
    }
}

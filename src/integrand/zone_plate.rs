//! Rings that become finer outwards.

use std::f64::consts::{FRAC_PI_4, PI};
use std::sync::Arc;

use errorfunctions::ComplexErrorFunctions;
use rustfft::num_complex::Complex;

use super::entry::{Entry, Given};
use super::shape::Shape;
use super::spec::Parameter;
use crate::error::Result;
use crate::samplers::Accepts;
use crate::sinc::sinc;

pub(super) static ENTRY: Entry = Entry {
    source: "the zone plate of sampling papers; Fresnel integrals: Abramowitz & Stegun 7.3, by the Faddeeva function",
    formulas: "f_m = [m = 0]/2 + (prod A_m + conj prod A_-m)/4, A_m = int exp(i alpha x^2 - 2 pi i m x) dx; a(r) likewise with 2 alpha",
    parameters: &[Parameter::number("alpha", "60", Accepts::Above(0.0, 1e5), "phase at distance 1, in radians")],
    ..Entry::new("zone-plate", "1/2 + cos(alpha |x|^2)/2 about the corner", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    Ok(Arc::new(ZonePlate::new(given.dim, given.number("alpha")?)))
}

/// `1/2 + cos(alpha |x|^2) / 2`: the real part of a product of chirps.
struct ZonePlate {
    dim: usize,
    alpha: f64,
    /// The integral of the cosine.
    mean: f64,
}

/// `int_y^infinity exp(i a t^2) dt / exp(i a y^2)`, y >= 0: it falls like 1/y and does not turn.
fn tail(a: f64, y: f64) -> Complex<f64> {
    let root = Complex::from_polar(a.sqrt(), FRAC_PI_4);
    (root * y).w() * Complex::from_polar(0.5 * (PI / a).sqrt(), FRAC_PI_4)
}

impl ZonePlate {
    fn new(dim: usize, alpha: f64) -> Self {
        let mut made = Self { dim, alpha, mean: 0.0 };
        made.mean = (0..dim).map(|_| made.chirp(0)).product::<Complex<f64>>().re;
        made
    }

    /// A_m. The square is completed at b = pi m / alpha; the phases of the two ends are 0 and alpha, whatever m.
    fn chirp(&self, m: i32) -> Complex<f64> {
        let a = self.alpha;
        let b = PI * f64::from(m) / a;
        let from = tail(a, b.abs());
        let to = Complex::from_polar(1.0, a) * tail(a, (1.0 - b).abs());
        if b < 0.0 {
            from - to
        } else if b > 1.0 {
            to - from
        } else {
            // The stationary point is inside.
            let whole = 2.0 * tail(a, 0.0) * Complex::from_polar(1.0, -a * b * b);
            whole - from - to
        }
    }

    /// `int exp(i alpha (x^2 + {x + r}^2)) dx`.
    fn sum_chirp(&self, r: f64) -> Complex<f64> {
        let a = 2.0 * self.alpha;
        // On each side of the wrap, x + t/2 between two numbers that are not negative.
        let part = |t: f64, from: f64, to: f64| {
            let end = |y: f64| Complex::from_polar(1.0, a * (y * y + 0.25 * t * t)) * tail(a, y);
            end(from + 0.5 * t) - end(to + 0.5 * t)
        };
        part(r, 0.0, 1.0 - r) + part(r - 1.0, 1.0 - r, 1.0)
    }

    /// `int exp(i alpha (x^2 - {x + r}^2)) dx`.
    fn difference_chirp(&self, r: f64) -> Complex<f64> {
        let (a, s) = (self.alpha, 1.0 - r);
        Complex::from_polar(s * sinc(a * r * s / PI), -a * r) + Complex::from_polar(r * sinc(a * s * r / PI), a * s)
    }
}

impl Shape for ZonePlate {
    fn value(&self, x: [f64; 3]) -> f64 {
        0.5 + 0.5 * (self.alpha * x[..self.dim].iter().map(|x| x * x).sum::<f64>()).cos()
    }

    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        let product = |sign: i32| m[..self.dim].iter().map(|&m| self.chirp(sign * m)).product::<Complex<f64>>();
        let dc = if m == [0; 3] { 0.5 } else { 0.0 };
        (product(1) + product(-1).conj()) * 0.25 + dc
    }

    fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        let most = max.iter().copied().max().unwrap_or(0) as i32;
        let list: Vec<_> = (-most..=most).map(|m| self.chirp(m)).collect();
        super::shape::grid(max, |m| {
            let product =
                |sign: i32| m[..self.dim].iter().map(|&m| list[(sign * m + most) as usize]).product::<Complex<f64>>();
            let dc = if m == [0; 3] { 0.5 } else { 0.0 };
            (product(1) + product(-1).conj()) * 0.25 + dc
        })
    }

    fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        let r = &r[..self.dim];
        let sums: Complex<f64> = r.iter().map(|&r| self.sum_chirp(r)).product();
        let differences: Complex<f64> = r.iter().map(|&r| self.difference_chirp(r)).product();
        0.25 + 0.5 * self.mean + 0.125 * (sums + differences).re
    }

    fn smoothness(&self) -> f64 {
        1.0
    }
}

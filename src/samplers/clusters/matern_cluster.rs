//! Matern's cluster process (Matern 1960): clusters of offsets that are uniform in a ball of radius R.
//!
//! `P(m) = 1 + mu f^2` with `f = sin q / q`, `2 J_1(q) / q`, `3 (sin q - q cos q) / q^3` in 1, 2, 3 dimensions, `q = 2 pi R |m|`. The
//! density of the difference of two offsets is the overlap of two balls over the square of their volume, while R <= 1/4.

use std::f64::consts::PI;
use std::sync::Arc;

use super::neyman_scott::{MU, NeymanScott, Offset, length};
use crate::samplers::{Accepts, Entry, Family, Number, Parameter, Stream};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Matern 1960",
    formulas: "P = 1 + mu f^2, f = sin q/q, 2 J_1(q)/q, 3 (sin q - q cos q)/q^3, q = 2 pi R nu; Var n = n (1 + mu); g by the overlap of two balls",
    number: Number::Expected,
    parameters: &[
        MU,
        Parameter::new("radius", "1", Accepts::Above(0.0, 1e6), "radius R of a cluster, in units of n^(-1/d)"),
    ],
    ..Entry::new(
        "matern-cluster",
        Family::Clusters,
        "Matern's clusters: uniform in balls around random parents",
        |given| Ok(Arc::new(NeymanScott::new(given, InBall { dim: given.dim, radius: length(given, "radius")? })?)),
    )
};

struct InBall {
    dim: usize,
    /// In units of the side.
    radius: f64,
}

impl Offset for InBall {
    fn draw(&self, stream: &mut Stream, offset: &mut [f64]) {
        loop {
            offset.fill_with(|| 2.0 * stream.uniform() - 1.0);
            if offset.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
                break;
            }
        }
        offset.iter_mut().for_each(|x| *x *= self.radius);
    }

    fn energy(&self, nu: f64) -> f64 {
        let q = 2.0 * PI * self.radius * nu;
        let f = match self.dim {
            // The series, where the quotients would cancel.
            dim if q < 1e-2 => 1.0 - q * q / (2.0 * (dim as f64 + 2.0)),
            1 => q.sin() / q,
            2 => 2.0 * libm::j1(q) / q,
            _ => 3.0 * (q.sin() - q * q.cos()) / q.powi(3),
        };
        f * f
    }

    fn difference(&self, r: f64) -> Option<f64> {
        let x = r / self.radius;
        // Overlap of two unit balls and the volume of one.
        let (overlap, ball) = match self.dim {
            _ if x >= 2.0 => (0.0, 1.0),
            1 => (2.0 - x, 2.0),
            2 => (2.0 * (x / 2.0).acos() - 0.5 * x * (4.0 - x * x).sqrt(), PI),
            _ => (PI / 12.0 * (4.0 + x) * (2.0 - x).powi(2), 4.0 / 3.0 * PI),
        };
        (self.radius <= 0.25).then(|| overlap / (ball * ball * self.radius.powi(self.dim as i32)))
    }
}

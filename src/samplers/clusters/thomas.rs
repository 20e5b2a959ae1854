//! The Thomas process (Thomas 1949): clusters of Gaussian offsets of standard deviation sigma per axis.
//!
//! The difference of two children of one parent is a wrapped Gaussian of standard deviation `sqrt(2) sigma`, and
//! `P(m) = 1 + mu exp(-4 pi^2 sigma^2 |m|^2)`.

use std::f64::consts::PI;
use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};

use super::neyman_scott::{MU, NeymanScott, Offset, length};
use crate::samplers::{Accepts, Entry, Family, Number, Parameter, Stream, gaussian};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Thomas 1949",
    formulas: "P = 1 + mu exp(-4 pi^2 sigma^2 nu^2), Var n = n (1 + mu), g by images",
    number: Number::Expected,
    parameters: &[
        MU,
        Parameter::new(
            "sigma",
            "0.5",
            Accepts::Above(0.0, 1e6),
            "standard deviation of a cluster along each axis, in units of n^(-1/d)",
        ),
    ],
    ..Entry::new("thomas", Family::Clusters, "Thomas process: Gaussian clusters around random parents", |given| {
        Ok(Arc::new(NeymanScott::new(given, Gaussian { dim: given.dim, sigma: length(given, "sigma")? })?))
    })
};

/// Beyond this share of the side, images further away than the three that `difference` sums would matter.
const WIDEST: f64 = 0.2;

struct Gaussian {
    dim: usize,
    /// In units of the side.
    sigma: f64,
}

impl Offset for Gaussian {
    fn draw(&self, stream: &mut Stream, offset: &mut [f64]) {
        for x in offset {
            let normal: f64 = StandardNormal.sample(&mut stream.rng);
            *x = self.sigma * normal;
        }
    }

    fn energy(&self, nu: f64) -> f64 {
        (-4.0 * PI * PI * self.sigma * self.sigma * nu * nu).exp()
    }

    fn difference(&self, r: f64) -> Option<f64> {
        let images = |k: usize| if k < self.dim { -3..=3 } else { 0..=0 };
        let variance = 2.0 * self.sigma * self.sigma;
        let mut sum = 0.0;
        for x in images(0) {
            for y in images(1) {
                for z in images(2) {
                    let far = f64::from(x * x + y * y + z * z).sqrt();
                    sum += gaussian::about(self.dim, variance, r, far);
                }
            }
        }
        (self.sigma <= WIDEST).then_some(sum)
    }
}

//! The Cauchy cluster process (Ghorbani, "Cauchy cluster process", Metrika 2013, here in d dimensions): offsets of the isotropic
//! Cauchy distribution, `scale z / |z_0|` with z normal in d dimensions and z_0 one more normal.
//!
//! `P(m) = 1 + mu exp(-4 pi scale |m|)` in every dimension. The wrapped tails leave no closed form of g.

use std::f64::consts::PI;
use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};

use super::neyman_scott::{MU, NeymanScott, Offset, length};
use crate::samplers::{Accepts, Entry, Family, Number, Parameter, Stream};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Ghorbani 2013",
    formulas: "P = 1 + mu exp(-4 pi scale nu), Var n = n (1 + mu)",
    number: Number::Expected,
    parameters: &[
        MU,
        Parameter::new("scale", "0.25", Accepts::Above(0.0, 1e6), "scale of the offsets, in units of n^(-1/d)"),
    ],
    ..Entry::new("cauchy-cluster", Family::Clusters, "Cauchy clusters: heavy tails around random parents", |given| {
        Ok(Arc::new(NeymanScott::new(given, Cauchy { scale: length(given, "scale")? })?))
    })
};

struct Cauchy {
    /// In units of the side.
    scale: f64,
}

impl Offset for Cauchy {
    fn draw(&self, stream: &mut Stream, offset: &mut [f64]) {
        let mut normal = || -> f64 { StandardNormal.sample(&mut stream.rng) };
        // One divisor for all axes; a 0 would leave no number.
        let divisor = loop {
            let z = normal().abs();
            if z > 0.0 {
                break z;
            }
        };
        offset.fill_with(|| self.scale * normal() / divisor);
    }

    fn energy(&self, nu: f64) -> f64 {
        (-4.0 * PI * self.scale * nu).exp()
    }

    fn difference(&self, _: f64) -> Option<f64> {
        None
    }
}

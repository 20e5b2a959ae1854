//! The Poisson process: a Poisson number of independent uniform points (complete spatial randomness).
//!
//! `g = 1`, `P(m) = 1`, and the number has variance n.

use std::sync::Arc;

use rand_distr::{Distribution, Poisson};

use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Entry, Family, Number, Realization, Sampler, Stream, poisson};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["csr"],
    formulas: "g = 1, P = 1, Var n = n",
    number: Number::Expected,
    ..Entry::new("poisson", Family::Independent, "a Poisson number of independent uniform points", |given| {
        Ok(Arc::new(Csr { number: poisson(given.n as f64)?, mean: given.n as f64 }))
    })
};

struct Csr {
    number: Poisson<f64>,
    mean: f64,
}

impl Csr {
    fn number(&self, stream: &mut Stream) -> u64 {
        self.number.sample(&mut stream.rng) as u64
    }
}

impl Sampler for Csr {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        Ok((0..self.number(&mut stream) * which.dim as u64).map(|_| stream.uniform()).collect())
    }

    fn count(&self, which: &Realization, _: &Control) -> Result<u64> {
        Ok(self.number(&mut which.stream()))
    }

    fn pair_correlation(&self, _: f64) -> Option<f64> {
        Some(1.0)
    }

    fn power(&self, _: &[i32]) -> Option<f64> {
        Some(1.0)
    }

    fn count_variance(&self) -> Option<f64> {
        Some(self.mean)
    }
}

//! Independent uniform points ("random", "white noise"; the binomial process).
//!
//! `P(m) = 1` for every m != 0 and `g = 1`, exactly at any n: distinct points are independent.

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Entry, Family, Realization, Sampler};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["white-noise", "binomial"],
    formulas: "g = 1, P = 1",
    dims: 1..=16,
    ..Entry::new("random", Family::Independent, "n independent uniform points", |given| {
        Ok(Arc::new(Random { n: given.n }))
    })
};

struct Random {
    n: u64,
}

impl Sampler for Random {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        Ok((0..which.n as usize * which.dim).map(|_| stream.uniform()).collect())
    }

    fn pair_correlation(&self, _: f64) -> Option<f64> {
        (self.n >= 2).then_some(1.0)
    }

    fn power(&self, _: &[i32]) -> Option<f64> {
        Some(1.0)
    }
}

//! Independent uniform points ("random", "white noise"; the binomial process).
//!
//! `P(m) = 1` for every m != 0 and `g = 1`, exactly at any n: distinct points are independent.

use super::stream::{stream, uniform};
use super::{ParameterValues, Realization, Sampler};
use crate::error::Result;

pub(super) struct Random;

impl Sampler for Random {
    fn name(&self) -> &'static str {
        "random"
    }

    fn summary(&self) -> &'static str {
        "n independent uniform points"
    }

    fn generate(&self, realization: &Realization, values: &ParameterValues) -> Result<Vec<f64>> {
        self.check(realization.n, realization.dim, values)?;
        let mut rng = stream(self, values, realization);
        Ok((0..realization.n as usize * realization.dim).map(|_| uniform(&mut rng)).collect())
    }

    fn pair_correlation(&self, n: u64, _dim: usize, _r: f64, _values: &ParameterValues) -> Option<f64> {
        (n >= 2).then_some(1.0)
    }

    fn power(&self, _n: u64, _m: [i32; 3], _dim: usize, _values: &ParameterValues) -> Option<f64> {
        Some(1.0)
    }
}

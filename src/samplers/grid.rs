//! The regular grid of n = k^d points at the centres of k^d cells.
//!
//! `P(m) = n` where every `m_j` is a multiple of k (the Bragg peaks), 0 elsewhere, shifted or not; g is a sum of deltas.

use super::stream::{stream, uniform};
use super::{Accepts, Parameter, ParameterValues, Realization, Sampler, nearest_power, strata_per_axis, wrap};
use crate::error::Result;

pub(super) struct Grid;

impl Sampler for Grid {
    fn name(&self) -> &'static str {
        "grid"
    }

    fn summary(&self) -> &'static str {
        "regular grid of n = k^d points"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter {
            name: "shift",
            default: "none",
            accepts: Accepts::OneOf(&["none", "random"]),
            help: "none: points at cell centres, all realizations equal; random: one uniform shift per realization",
        }]
    }

    fn check(&self, n: u64, dim: usize, _values: &ParameterValues) -> Result<()> {
        strata_per_axis(n, dim, self.name()).map(drop)
    }

    fn nearest_size(&self, n: u64, dim: usize) -> u64 {
        nearest_power(n, dim)
    }

    fn generate(&self, realization: &Realization, values: &ParameterValues) -> Result<Vec<f64>> {
        let Realization { n, dim, .. } = *realization;
        let k = strata_per_axis(n, dim, self.name())?;
        let mut shift = [0.0; 3];
        if values.word("shift")? == "random" {
            let mut rng = stream(self, values, realization);
            shift = std::array::from_fn(|_| uniform(&mut rng));
        }
        let mut points = Vec::with_capacity(n as usize * dim);
        for cell in 0..n {
            let mut rest = cell;
            for s in &shift[..dim] {
                points.push(wrap(((rest % k) as f64 + 0.5) / k as f64 + s));
                rest /= k;
            }
        }
        Ok(points)
    }

    fn power(&self, n: u64, m: [i32; 3], dim: usize, _values: &ParameterValues) -> Option<f64> {
        let k = strata_per_axis(n, dim, self.name()).ok()?;
        let on_peak = m[..dim].iter().all(|m| i64::from(*m) % k as i64 == 0);
        Some(if on_peak { n as f64 } else { 0.0 })
    }
}

//! A sampler with all that it takes.

use std::ops::Deref;
use std::sync::Arc;

use super::{ParameterValues, Realization, Sampler, find};
use crate::error::{Error, Result};
use crate::points::RawPoints;
use crate::setting::Setting;

/// A sampler of the registry, or somebody's own.
#[derive(Clone)]
pub enum AnySampler {
    /// Of the registry.
    Known(&'static dyn Sampler),
    /// Somebody's own.
    Own(Arc<dyn Sampler>),
}

impl Deref for AnySampler {
    type Target = dyn Sampler;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Known(sampler) => *sampler,
            Self::Own(sampler) => sampler.as_ref(),
        }
    }
}

/// Most realizations of a run. Of each its number of points is kept, so this is 16 GiB.
const MAX_REALIZATIONS: u64 = 1 << 30;

/// A sampler with everything that determines its realizations.
pub struct Process {
    /// The sampler.
    pub sampler: AnySampler,
    /// Its parameters.
    pub values: ParameterValues,
    /// Points per realization, expected where the sampler draws it.
    pub n: u64,
    /// Number of realizations.
    pub realizations: u64,
    /// Dimension.
    pub dim: usize,
    /// Seed.
    pub seed: u64,
}

impl Process {
    /// Checks the name, the parameters and n.
    ///
    /// # Errors
    /// A name or parameters that are not known, n that the sampler cannot draw, no realizations.
    pub fn new(name: &str, n: u64, realizations: u64, dim: usize, seed: u64, params: &[String]) -> Result<Self> {
        Self::of(AnySampler::Known(find(name)?), n, realizations, dim, seed, params)
    }

    /// Of a sampler of one's own, with its parameters as they are.
    ///
    /// # Errors
    /// n that the sampler cannot draw, no realizations.
    pub fn own(sampler: Arc<dyn Sampler>, n: u64, realizations: u64, dim: usize, seed: u64) -> Result<Self> {
        Self::of(AnySampler::Own(sampler), n, realizations, dim, seed, &[])
    }

    fn of(sampler: AnySampler, n: u64, realizations: u64, dim: usize, seed: u64, params: &[String]) -> Result<Self> {
        let values = ParameterValues::parse(&*sampler, params)?;
        sampler.check(n, dim, &values)?;
        if realizations == 0 {
            return Err(Error::setting(Setting::Realizations, 0, "expected at least 1 realization"));
        }
        if realizations > MAX_REALIZATIONS {
            let reason = format!(
                "expected at most {MAX_REALIZATIONS} realizations: what is kept of each would not fit into the memory of a machine"
            );
            return Err(Error::setting(Setting::Realizations, realizations, reason));
        }
        Ok(Self { sampler, values, n, realizations, dim, seed })
    }

    /// Realization `index`, on the unit torus.
    ///
    /// # Errors
    /// What the sampler says.
    pub fn realization(&self, index: u64) -> Result<RawPoints> {
        let which = Realization { n: self.n, dim: self.dim, seed: self.seed, index };
        let coordinates = self.sampler.generate(&which, &self.values)?;
        let source = format!("{}, realization {index}", self.sampler.name());
        Ok(RawPoints { dim: self.dim, coordinates, source, lines: Vec::new() })
    }

    /// Closed form of g on the unit torus, normalized by n (n - 1).
    pub fn pair_correlation(&self, r: f64) -> Option<f64> {
        self.sampler.pair_correlation(self.n, self.dim, r, &self.values)
    }

    /// Closed form of P at `m != 0`.
    pub fn power(&self, m: [i32; 3]) -> Option<f64> {
        self.sampler.power(self.n, m, self.dim, &self.values)
    }
}

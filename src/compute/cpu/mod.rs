//! The native path: threads and SIMD. Formulas, index ranges and signs stand in `reference`; here is only how the fast
//! form differs from them. No result depends on the number of threads or on how a batch was cut: counts are integers,
//! and every f64 is made by the same additions in the same order.

mod kernel_sums;
mod lag_bins;
mod lag_counts;
#[doc(hidden)]
pub mod nufft;
mod pair_bins;
mod pair_counts;
mod pair_weights;
mod phase_tables;
mod product;
mod simd;
mod tapered_power;
mod wave_covariance;
mod wave_power;
mod wave_product;
mod wave_terms;

pub use simd::{SimdLevel, fma_gflop};

use super::Compute;
use crate::accumulate::{Backend, ComputedBy};
use crate::accumulate::{KernelSums, LagCounts, PairCounts, WaveCovariance, WavePower};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{CovariancePlan, KernelPlan, LagPlan, PairPlan, WavePlan};
use crate::points::Ensemble;
use crate::pool::Pool;

/// The native implementation with its own pool of threads.
#[derive(Debug)]
pub struct Cpu {
    pool: Pool,
    level: SimdLevel,
    nuffts: nufft::Cache,
}

impl Cpu {
    /// `threads` threads (as many as the machine offers if `None`), and the best SIMD the processor has.
    pub fn new(threads: Option<usize>) -> Result<Self> {
        Ok(Self::with_pool(Pool::new(threads)?))
    }

    /// On threads that are there already.
    pub fn with_pool(pool: Pool) -> Self {
        Self { pool, level: SimdLevel::detect(), nuffts: nufft::Cache::default() }
    }

    /// The same with an instruction set chosen by hand, so that tests reach each of them. A level this processor lacks
    /// falls back to the best it has. Matrix products always use the best: `gemm` chooses for itself.
    #[doc(hidden)]
    pub fn with_level(threads: Option<usize>, level: SimdLevel) -> Result<Self> {
        Ok(Self { level: level.min(SimdLevel::detect()), ..Self::new(threads)? })
    }

    /// The threads.
    pub fn pool(&self) -> &Pool {
        &self.pool
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.pool.threads()
    }

    /// The instruction set in use.
    pub fn level(&self) -> SimdLevel {
        self.level
    }

    /// Kernel sums, pair by pair.
    pub(super) fn direct_kernel_sums(
        &self,
        plan: &KernelPlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Result<KernelSums> {
        kernel_sums::kernel_sums(self, plan, ensemble, control)
    }

    /// Products of amplitudes.
    pub(super) fn amplitude_products(
        &self,
        plan: &CovariancePlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Result<WaveCovariance> {
        wave_covariance::wave_covariance(self, plan, ensemble, control)
    }
}

impl Compute for Cpu {
    fn computed_by(&self) -> ComputedBy {
        let threads = self.threads();
        let s = if threads == 1 { "" } else { "s" };
        ComputedBy::new(Backend::Cpu, format!("cpu ({}, {threads} thread{s})", self.level.name()))
    }

    fn pool(&self) -> Option<&Pool> {
        Some(&self.pool)
    }

    fn pair_counts(&self, plan: &PairPlan, ensemble: &Ensemble, control: &Control) -> Result<PairCounts> {
        pair_counts::pair_counts(self, plan, ensemble, control)
    }

    fn lag_counts(&self, plan: &LagPlan, ensemble: &Ensemble, control: &Control) -> Result<LagCounts> {
        lag_counts::lag_counts(self, plan, ensemble, control)
    }

    fn wave_power(&self, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower> {
        match plan.tapered() {
            Some(taper) => tapered_power::tapered_power(self, plan, taper, ensemble, control),
            None => wave_power::wave_power(self, plan, ensemble, control),
        }
    }

    fn kernel_sums(&self, plan: &KernelPlan, ensemble: &Ensemble, control: &Control) -> Option<Result<KernelSums>> {
        Some(self.direct_kernel_sums(plan, ensemble, control))
    }

    fn wave_covariance(
        &self,
        plan: &CovariancePlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Option<Result<WaveCovariance>> {
        Some(self.amplitude_products(plan, ensemble, control))
    }
}

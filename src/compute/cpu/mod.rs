//! The native path: threads and SIMD. Formulas, index ranges and signs stand in `reference`; here is only how the fast
//! form differs from them. No result depends on the number of threads or on how a batch was cut: counts are integers,
//! and every f64 is made by the same additions in the same order.

mod counts;
mod discrepancy;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports, reason = "what vectors need"))]
mod fixed_point;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports, reason = "what vectors need"))]
mod histogram_rows;
mod integration;
mod intensity;
mod kernel_sums;
mod lag_bins;
mod lag_counts;
mod lag_deposit;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports, reason = "what vectors need"))]
mod linear_bins;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports, reason = "what vectors need"))]
mod log_bins;
#[doc(hidden)]
pub mod nufft;
mod pair_counts;
mod pair_rows;
mod pair_weights;
mod phase_tables;
mod polygon_weights;
mod product;
mod r2_rows;
mod simd;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports, reason = "what vectors need"))]
mod table_bins;
mod tapered_power;
mod wave_covariance;
mod wave_power;
mod wave_product;
mod wave_terms;

pub(crate) use discrepancy::Cube;
pub(super) use integration::{dot, realizations};
pub use simd::SimdLevel;
#[doc(hidden)]
pub use simd::fma_gflop;

use super::neighbors::neighbor_sums;
use super::{Compute, NotHere, Pending, See, Work, at_once};
use crate::accumulate::{Backend, ComputedBy, LevelCounts, RealizationDiscrepancy};
use crate::accumulate::{
    CountSums, DiscrepancySums, IntegrationSums, IntensitySums, KernelSums, LagCounts, NeighborSums, PairCounts,
    WaveCovariance, WavePower,
};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{
    CountPlan, CovariancePlan, DiscrepancyPlan, IntegrationPlan, IntensityPlan, KernelPlan, LagPlan, NeighborPlan,
    PairPlan, WavePlan,
};
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
    ///
    /// # Errors
    /// A number of threads that cannot be, or that the platform does not start.
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

    /// Discrepancies of one set of points in any dimension, all but its index and the covering radius. `part`: of the piece of
    /// work at hand.
    pub(crate) fn discrepancy(
        &self,
        cube: &Cube,
        part: f64,
        control: &Control,
    ) -> Result<(RealizationDiscrepancy, Vec<LevelCounts>)> {
        self.pool.install(|| discrepancy::measure(self, cube, part, control))
    }

    /// The instruction set in use.
    pub fn level(&self) -> SimdLevel {
        self.level
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

    fn supports(&self, _work: Work<'_>) -> Result<(), NotHere> {
        Ok(())
    }

    fn pair_counts<'a>(
        &'a self,
        plan: &'a PairPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, PairCounts> {
        at_once(|| pair_counts::pair_counts(self, plan, ensemble, control))
    }

    fn lag_counts<'a>(
        &'a self,
        plan: &'a LagPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, LagCounts> {
        at_once(|| lag_counts::lag_counts(self, plan, ensemble, control))
    }

    fn wave_power<'a>(
        &'a self,
        plan: &'a WavePlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WavePower> {
        at_once(|| match plan.tapered() {
            Some(taper) => tapered_power::tapered_power(self, plan, taper, ensemble, control),
            None => wave_power::wave_power(self, plan, ensemble, control),
        })
    }

    fn wave_power_seen<'a>(
        &'a self,
        plan: &'a WavePlan,
        ensemble: &'a Ensemble,
        see: &'a See<'a>,
        control: &'a Control,
    ) -> Pending<'a, WavePower> {
        at_once(|| wave_power::wave_power_seen(self, plan, ensemble, control, see))
    }

    fn kernel_sums<'a>(
        &'a self,
        plan: &'a KernelPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, KernelSums> {
        at_once(|| kernel_sums::kernel_sums(self, plan, ensemble, control))
    }

    fn wave_covariance<'a>(
        &'a self,
        plan: &'a CovariancePlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WaveCovariance> {
        at_once(|| wave_covariance::wave_covariance(self, plan, ensemble, control))
    }

    fn neighbors<'a>(
        &'a self,
        plan: &'a NeighborPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, NeighborSums> {
        at_once(|| self.pool.install(|| neighbor_sums(plan, ensemble, control)))
    }

    fn discrepancies<'a>(
        &'a self,
        plan: &'a DiscrepancyPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, DiscrepancySums> {
        at_once(|| discrepancy::discrepancies(self, plan, ensemble, control))
    }

    fn integration<'a>(
        &'a self,
        plan: &'a IntegrationPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, IntegrationSums> {
        Box::pin(super::integration::integration(self, self, plan, ensemble, control))
    }

    fn counts<'a>(
        &'a self,
        plan: &'a CountPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, CountSums> {
        at_once(|| counts::counts(self, plan, ensemble, control))
    }

    fn intensity<'a>(
        &'a self,
        plan: &'a IntensityPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, IntensitySums> {
        at_once(|| intensity::intensity(self, plan, ensemble, control))
    }
}

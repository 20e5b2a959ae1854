//! 3. Raw sums, three ways behind one trait:
//! - `reference`: slow, exact, one loop per sum of the formula;
//! - `cpu`: threads and SIMD;
//! - `gpu`: WGSL; the only folder that names wgpu.

mod binned_kernel;
pub(crate) mod cells;
mod compensated;
pub mod cpu;
mod fallback;
pub mod gpu;
pub mod neighbors;
mod open;
pub mod reference;

pub use binned_kernel::kernel_sums as binned_kernel_sums;
pub(crate) use fallback::WithFallback;
pub use open::{Opened, open};

use crate::accumulate::{ComputedBy, KernelSums, LagCounts, PairCounts, WaveCovariance, WavePower};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{CovariancePlan, KernelPlan, LagPlan, PairPlan, SearchCosts, WaveCosts, WavePlan};
use crate::points::Ensemble;
use crate::pool::Pool;

/// The least number from `least` on that shares no divisor with `n` (or `n` itself, where that is 0 or there is none below).
pub(crate) fn coprime_from(least: usize, n: usize) -> usize {
    fn gcd(a: usize, b: usize) -> usize {
        if b == 0 { a } else { gcd(b, a % b) }
    }
    (least..n).find(|&k| gcd(k, n) == 1).unwrap_or(n.max(1))
}

/// Raw sums over the realizations of one batch. `Error::Device` means that the device failed at it: the caller may do the
/// batch again elsewhere (and `analysis` does, on the CPU path); every other error is final. A result is whole or an error:
/// never a part of the sums. Sums in f64 merge only if batches start at multiples of `LEAF`; counts, being integers, always.
pub trait Compute: Send + Sync {
    /// Who computes.
    fn computed_by(&self) -> ComputedBy;

    /// Whether `wave_power` keeps the plan's promise here; the CPU path takes over where not.
    fn supports_wave_power(&self, _plan: &WavePlan) -> Result<(), String> {
        Ok(())
    }

    /// Whether `pair_counts` can run this plan here; the CPU path takes over where not.
    fn supports_pair_counts(&self, _plan: &PairPlan) -> Result<(), String> {
        Ok(())
    }

    /// Whether `lag_counts` can run this plan here; the CPU path takes over where not.
    fn supports_lag_counts(&self, _plan: &LagPlan) -> Result<(), String> {
        Ok(())
    }

    /// What searching for pairs costs here: plans that know it choose by it.
    fn search_costs(&self) -> SearchCosts {
        SearchCosts::CPU
    }

    /// What the roads to a spectrum cost here.
    fn wave_costs(&self) -> WaveCosts {
        WaveCosts::CPU
    }

    /// The threads it works with, where it has some.
    fn pool(&self) -> Option<&Pool> {
        None
    }

    /// Ordered pairs per bin of every realization.
    fn pair_counts(&self, plan: &PairPlan, ensemble: &Ensemble, control: &Control) -> Result<PairCounts>;

    /// Ordered pairs per cell of lags of every realization.
    fn lag_counts(&self, plan: &LagPlan, ensemble: &Ensemble, control: &Control) -> Result<LagCounts>;

    /// `|s_m|^2` per stored mode of every realization.
    fn wave_power(&self, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower>;

    /// The direct kernel sum at every r of every realization; `None` where this way has none and leaves it to the CPU path.
    fn kernel_sums(&self, _plan: &KernelPlan, _ensemble: &Ensemble, _control: &Control) -> Option<Result<KernelSums>> {
        None
    }

    /// Products of the amplitudes of low frequencies of every realization; `None` where this way has none and leaves it to
    /// the CPU path.
    fn wave_covariance(
        &self,
        _plan: &CovariancePlan,
        _ensemble: &Ensemble,
        _control: &Control,
    ) -> Option<Result<WaveCovariance>> {
        None
    }
}

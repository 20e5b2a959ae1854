//! 3. Raw sums, three ways behind one trait:
//! - `reference`: slow, exact, one loop per sum of the formula;
//! - `cpu`: threads and SIMD;
//! - `gpu`: WGSL; the only folder that names wgpu.

mod binned_kernel;
pub(crate) mod cells;
mod compensated;
pub mod cpu;
mod device;
pub mod gpu;
mod integration;
pub mod neighbors;
pub mod reference;
pub(crate) mod shifts;

#[doc(hidden)]
pub use binned_kernel::kernel_sums as binned_kernel_sums;
pub use device::Device;
pub(crate) use device::Session;

use std::pin::Pin;

use crate::accumulate::{
    Backend, ComputedBy, CountSums, DiscrepancySums, IntegrationSums, IntensitySums, KernelSums, LagCounts,
    NeighborSums, PairCounts, WaveCovariance, WavePower,
};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::plan::{
    CPU_COSTS, CountPlan, CovariancePlan, DeviceCosts, DiscrepancyPlan, IntegrationPlan, IntensityPlan, KernelPlan,
    LagPlan, NeighborPlan, PairPlan, WavePlan,
};
use crate::points::Ensemble;
use crate::pool::Pool;

/// The least number from `least` on that shares no divisor with `n` (or `n` itself, where that is 0 or there is none below).
pub(crate) fn coprime_from(least: usize, n: usize) -> usize {
    fn gcd(a: usize, b: usize) -> usize {
        if b == 0 { a } else { gcd(b, a % b) }
    }
    (least..n).find(|&k| gcd(k, n) == 1).unwrap_or(n.max(1))
}

/// Sums that may have to be waited for. Not to be sent to another thread: in a browser a device stays where it was opened.
pub type Pending<'a, T> = Pin<Box<dyn Future<Output = Result<T>> + 'a>>;

/// What looks at the power of one realization, `|s_m|^2` at every stored mode.
pub type See<'a> = dyn Fn(usize, &[f64]) + Sync + 'a;

/// Sums that are made as soon as somebody asks for them, and are there at once.
pub(crate) fn at_once<'a, T: 'a>(work: impl FnOnce() -> Result<T> + 'a) -> Pending<'a, T> {
    Box::pin(async move { work() })
}

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub enum Work<'a> {
    /// `Compute::pair_counts`.
    Pairs(&'a PairPlan),
    /// `Compute::lag_counts`.
    Lags(&'a LagPlan),
    /// `Compute::wave_power`.
    Waves(&'a WavePlan),
    /// `Compute::kernel_sums`.
    Kernel(&'a KernelPlan),
    /// `Compute::wave_covariance`.
    Covariance(&'a CovariancePlan),
    /// `Compute::neighbors`.
    Neighbors(&'a NeighborPlan),
    /// `Compute::discrepancies`.
    Discrepancy(&'a DiscrepancyPlan),
    /// `Compute::integration`.
    Integration(&'a IntegrationPlan),
    /// `Compute::counts`.
    Counts(&'a CountPlan),
    /// `Compute::intensity`.
    Intensity(&'a IntensityPlan),
}

/// Why the CPU path does something in place of a backend.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotHere {
    /// This backend never does it, as the plan says: nothing to be told of.
    Never,
    /// It does not do this one.
    Because(String),
}

/// Raw sums over the realizations of one batch. `Error::Device` means that the device failed at it: the caller may do the
/// batch again elsewhere (and `analysis` does, on the CPU path); every other error is final. A result is whole or an error:
/// never a part of the sums. Sums in f64 merge only if batches start at multiples of `LEAF`; counts, being integers, always.
pub trait Compute: Send + Sync {
    /// Who computes.
    fn computed_by(&self) -> ComputedBy;

    /// Whether this is done here, with the promise of its plan kept; the CPU path takes over where not.
    ///
    /// # Errors
    /// Why the CPU path does it.
    fn supports(&self, work: Work<'_>) -> Result<(), NotHere> {
        match work {
            Work::Pairs(_) | Work::Lags(_) | Work::Waves(_) => Ok(()),
            Work::Kernel(_)
            | Work::Covariance(_)
            | Work::Neighbors(_)
            | Work::Discrepancy(_)
            | Work::Integration(_)
            | Work::Counts(_)
            | Work::Intensity(_) => Err(NotHere::Never),
        }
    }

    /// What methods cost here, as built in: plans choose by that.
    fn costs(&self) -> DeviceCosts {
        DeviceCosts::CPU
    }

    /// What it is called where its costs were measured.
    fn costs_name(&self) -> String {
        let by = self.computed_by();
        if by.backends.contains(&Backend::Gpu) { by.device() } else { CPU_COSTS.into() }
    }

    /// The threads it works with, where it has some.
    fn pool(&self) -> Option<&Pool> {
        None
    }

    /// Ordered pairs per bin of every realization.
    fn pair_counts<'a>(
        &'a self,
        plan: &'a PairPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, PairCounts>;

    /// Ordered pairs per cell of lags of every realization.
    fn lag_counts<'a>(
        &'a self,
        plan: &'a LagPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, LagCounts>;

    /// `|s_m|^2` per stored mode of every realization.
    fn wave_power<'a>(
        &'a self,
        plan: &'a WavePlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WavePower>;

    /// The same, where each realization is looked at on the way. On a torus, without tapers.
    fn wave_power_seen<'a>(
        &'a self,
        _plan: &'a WavePlan,
        _ensemble: &'a Ensemble,
        _see: &'a See<'a>,
        _control: &'a Control,
    ) -> Pending<'a, WavePower> {
        at_once(|| Err(never(self.computed_by(), "wave_power_seen")))
    }

    /// The direct kernel sum at every r of every realization.
    fn kernel_sums<'a>(
        &'a self,
        _plan: &'a KernelPlan,
        _ensemble: &'a Ensemble,
        _control: &'a Control,
    ) -> Pending<'a, KernelSums> {
        at_once(|| Err(never(self.computed_by(), "kernel_sums")))
    }

    /// Products of the amplitudes of low frequencies of every realization.
    fn wave_covariance<'a>(
        &'a self,
        _plan: &'a CovariancePlan,
        _ensemble: &'a Ensemble,
        _control: &'a Control,
    ) -> Pending<'a, WaveCovariance> {
        at_once(|| Err(never(self.computed_by(), "wave_covariance")))
    }

    /// Nearest neighbours in every realization.
    fn neighbors<'a>(
        &'a self,
        _plan: &'a NeighborPlan,
        _ensemble: &'a Ensemble,
        _control: &'a Control,
    ) -> Pending<'a, NeighborSums> {
        at_once(|| Err(never(self.computed_by(), "neighbors")))
    }

    /// Discrepancies of every realization.
    fn discrepancies<'a>(
        &'a self,
        _plan: &'a DiscrepancyPlan,
        _ensemble: &'a Ensemble,
        _control: &'a Control,
    ) -> Pending<'a, DiscrepancySums> {
        at_once(|| Err(never(self.computed_by(), "discrepancies")))
    }

    /// Sums of integrands over the points, the power and the pairs of every realization.
    fn integration<'a>(
        &'a self,
        _plan: &'a IntegrationPlan,
        _ensemble: &'a Ensemble,
        _control: &'a Control,
    ) -> Pending<'a, IntegrationSums> {
        at_once(|| Err(never(self.computed_by(), "integration")))
    }

    /// Numbers of points in boxes and balls of every realization.
    fn counts<'a>(
        &'a self,
        _plan: &'a CountPlan,
        _ensemble: &'a Ensemble,
        _control: &'a Control,
    ) -> Pending<'a, CountSums> {
        at_once(|| Err(never(self.computed_by(), "counts")))
    }

    /// Sums of kernels on a grid of every realization.
    fn intensity<'a>(
        &'a self,
        _plan: &'a IntensityPlan,
        _ensemble: &'a Ensemble,
        _control: &'a Control,
    ) -> Pending<'a, IntensitySums> {
        at_once(|| Err(never(self.computed_by(), "intensity")))
    }
}

/// The error of a backend that was asked for what it never does.
fn never(backend: ComputedBy, what: &'static str) -> Error {
    Error::Device { device: backend.device(), what, reason: "not done here".into() }
}

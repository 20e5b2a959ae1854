//! A device with the CPU path behind it.

use pollster::block_on;

use super::{Compute, NotHere, Work, binned_kernel, cpu::Cpu};
use crate::accumulate::{KernelSums, LagCounts, NeighborSums, PairCounts, WaveCovariance, WavePower};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::plan::{CovariancePlan, KernelMethod, KernelPlan, LagPlan, NeighborPlan, PairPlan, WavePlan};
use crate::points::Ensemble;
use crate::pool::Pool;

/// Computes on a device, and on the CPU path what the device does not do, or everything once it has failed. Says so.
pub(crate) struct WithFallback<'a> {
    device: &'a dyn Compute,
    cpu: Option<Cpu>,
    /// For the CPU path, and all parallel work around a device.
    pool: Pool,
    /// The device failed; everything goes to the CPU path from here on.
    failed: bool,
    warnings: Vec<String>,
}

impl<'a> WithFallback<'a> {
    /// `threads` is for the CPU path, which is made ready when it is first needed. A device's own threads go before.
    pub(crate) fn new(device: &'a dyn Compute, threads: Option<usize>) -> Result<Self> {
        let pool = device.pool().cloned().map_or_else(|| Pool::new(threads), Ok)?;
        Ok(Self { device, cpu: None, pool, failed: false, warnings: Vec::new() })
    }

    /// Where parallel work around the device runs.
    pub(crate) fn pool(&self) -> Pool {
        self.pool.clone()
    }

    pub(crate) fn pair_counts(
        &mut self,
        plan: &PairPlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Result<PairCounts> {
        self.run(Work::Pairs(plan), |c| block_on(c.pair_counts(plan, ensemble, control)))
    }

    /// Of several ensembles, all by the same backend: their weights may be subtracted from each other.
    pub(crate) fn all_pair_counts(
        &mut self,
        plan: &PairPlan,
        ensembles: &[Ensemble],
        control: &Control,
    ) -> Result<Vec<PairCounts>> {
        let all = |c: &dyn Compute| ensembles.iter().map(|e| block_on(c.pair_counts(plan, e, control))).collect();
        self.run(Work::Pairs(plan), all)
    }

    pub(crate) fn lag_counts(&mut self, plan: &LagPlan, ensemble: &Ensemble, control: &Control) -> Result<LagCounts> {
        self.run(Work::Lags(plan), |c| block_on(c.lag_counts(plan, ensemble, control)))
    }

    pub(crate) fn wave_power(&mut self, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower> {
        self.run(Work::Waves(plan), |c| block_on(c.wave_power(plan, ensemble, control)))
    }

    /// By the method of the plan.
    pub(crate) fn kernel_sums(
        &mut self,
        plan: &KernelPlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Result<KernelSums> {
        match plan.method {
            KernelMethod::Binned => {
                let pool = self.pool();
                self.run(Work::Pairs(&plan.pairs), |c| {
                    block_on(binned_kernel::kernel_sums(c, &pool, plan, ensemble, control))
                })
            }
            KernelMethod::Direct => self.run(Work::Kernel(plan), |c| block_on(c.kernel_sums(plan, ensemble, control))),
        }
    }

    pub(crate) fn wave_covariance(
        &mut self,
        plan: &CovariancePlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Result<WaveCovariance> {
        self.run(Work::Covariance(plan), |c| block_on(c.wave_covariance(plan, ensemble, control)))
    }

    pub(crate) fn neighbors(
        &mut self,
        plan: &NeighborPlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Result<NeighborSums> {
        self.run(Work::Neighbors(plan), |c| block_on(c.neighbors(plan, ensemble, control)))
    }

    /// What the user should know about who computed.
    pub(crate) fn into_warnings(self) -> Vec<String> {
        self.warnings
    }

    /// A batch at which the device failed has left nothing behind, so it is simply done again.
    fn run<T>(&mut self, what: Work<'_>, work: impl Fn(&dyn Compute) -> Result<T>) -> Result<T> {
        if !self.failed {
            match self.device.supports(what) {
                Ok(()) => match work(self.device) {
                    Err(error @ Error::Device { .. }) => {
                        self.failed = true;
                        self.warn(format!("{error}; continued on the native CPU path"));
                    }
                    done => return done,
                },
                Err(NotHere::Because(why)) => self.warn(format!("{why}; done on the native CPU path")),
                Err(NotHere::Never) => {}
            }
        }
        work(self.cpu())
    }

    fn cpu(&mut self) -> &Cpu {
        self.cpu.get_or_insert_with(|| Cpu::with_pool(self.pool.clone()))
    }

    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}

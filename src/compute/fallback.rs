//! A device with the CPU path behind it.

use super::{Compute, Control, cpu::Cpu};
use crate::accumulate::{LagCounts, PairCounts, WavePower};
use crate::error::{Error, Result};
use crate::plan::{LagPlan, PairPlan, WavePlan};
use crate::points::Ensemble;

/// Computes on a device, and on the CPU path what the device does not do, or everything once it has failed. Says so.
pub(crate) struct WithFallback<'a> {
    device: &'a dyn Compute,
    cpu: Option<Cpu>,
    threads: Option<usize>,
    /// The device failed; everything goes to the CPU path from here on.
    failed: bool,
    warnings: Vec<String>,
}

impl<'a> WithFallback<'a> {
    /// `threads` is for the CPU path, which is made ready when it is first needed.
    pub(crate) fn new(device: &'a dyn Compute, threads: Option<usize>) -> Self {
        Self { device, cpu: None, threads, failed: false, warnings: Vec::new() }
    }

    pub(crate) fn pair_counts(
        &mut self,
        plan: &PairPlan,
        ensemble: &Ensemble,
        control: &Control,
    ) -> Result<PairCounts> {
        self.run(self.device.supports_pair_counts(plan), |c| c.pair_counts(plan, ensemble, control))
    }

    pub(crate) fn lag_counts(&mut self, plan: &LagPlan, ensemble: &Ensemble, control: &Control) -> Result<LagCounts> {
        self.run(self.device.supports_lag_counts(plan), |c| c.lag_counts(plan, ensemble, control))
    }

    pub(crate) fn wave_power(&mut self, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower> {
        self.run(self.device.supports_wave_power(plan), |c| c.wave_power(plan, ensemble, control))
    }

    /// What the user should know about who computed.
    pub(crate) fn into_warnings(self) -> Vec<String> {
        self.warnings
    }

    /// A batch at which the device failed has left nothing behind, so it is simply done again.
    fn run<T>(&mut self, supported: Result<(), String>, work: impl Fn(&dyn Compute) -> Result<T>) -> Result<T> {
        if !self.failed {
            match supported {
                Ok(()) => match work(self.device) {
                    Err(error @ Error::Device { .. }) => {
                        self.failed = true;
                        self.warn(format!("{error}; continued on the native CPU path"));
                    }
                    done => return done,
                },
                Err(why) => self.warn(format!("{why}; done on the native CPU path")),
            }
        }
        let cpu = match &mut self.cpu {
            Some(cpu) => cpu,
            none => none.insert(Cpu::new(self.threads)?),
        };
        work(cpu)
    }

    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}

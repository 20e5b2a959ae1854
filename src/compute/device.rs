//! A device made ready, with the CPU path behind it.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::cpu::{Cpu, check_threads};
use super::gpu::{AdapterChoice, GpuCompute};
use super::neighbors::neighbor_sums;
use super::{Compute, binned_kernel, reference::Reference};
use crate::accumulate::{ComputedBy, KernelSums, LagCounts, NeighborSums, PairCounts, WaveCovariance, WavePower};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::plan::{CovariancePlan, KernelPlan, KernelRoad, LagPlan, NeighborPlan, PairPlan, WavePlan};
use crate::points::Ensemble;
use crate::request::DeviceChoice;

/// What computes: a GPU, the CPU path or the reference. What a GPU does not do, or everything once it has failed, the CPU path
/// does. Opened once; both last as long as it does.
pub struct Device {
    compute: Box<dyn Compute>,
    note: Option<String>,
    threads: Option<usize>,
    cpu: Mutex<Option<Arc<Cpu>>>,
    /// What the device said when it failed.
    failure: OnceLock<String>,
}

impl Device {
    /// Of something that computes. `threads` are those of the CPU path behind it.
    pub fn new(compute: Box<dyn Compute>, threads: Option<usize>) -> Self {
        Self { compute, note: None, threads, cpu: Mutex::default(), failure: OnceLock::new() }
    }

    /// Opens the device that is asked for. `threads` is for the CPU path.
    ///
    /// # Errors
    /// `Error::NoDevice` where there is none of the kind, `Error::Setting` for a number of threads that cannot be.
    pub fn open(choice: DeviceChoice, threads: Option<usize>) -> Result<Self> {
        let gpu = |choice| -> Result<Self> {
            // The CPU path stands behind every GPU.
            threads.map_or(Ok(()), check_threads)?;
            Ok(Self::new(Box::new(GpuCompute::open(choice)?), threads))
        };
        match choice {
            DeviceChoice::Cpu => Ok(Self::new(Box::new(Cpu::new(threads)?), threads)),
            DeviceChoice::Reference => Ok(Self::new(Box::new(Reference), threads)),
            DeviceChoice::Gpu => gpu(AdapterChoice::Any),
            DeviceChoice::Index(index) => gpu(AdapterChoice::Index(index)),
            DeviceChoice::Auto => match gpu(AdapterChoice::HardwareOnly) {
                Err(error @ (Error::NoDevice { .. } | Error::Device { .. })) => {
                    let note = format!("{}; using the native CPU path", reason(&error));
                    Ok(Self { note: Some(note), ..Self::new(Box::new(Cpu::new(threads)?), threads) })
                }
                opened => opened,
            },
        }
    }

    /// What the user should know about the choice: why `auto` did not take a GPU.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// What was opened, without the CPU path behind it.
    pub fn compute(&self) -> &dyn Compute {
        self.compute.as_ref()
    }

    /// Who computes, as long as nothing fails.
    pub fn computed_by(&self) -> ComputedBy {
        self.compute.computed_by()
    }

    /// The CPU path, made ready when it is first needed.
    fn cpu(&self) -> Result<Arc<Cpu>> {
        let mut cpu = self.cpu.lock().unwrap_or_else(PoisonError::into_inner);
        match cpu.as_ref() {
            Some(cpu) => Ok(cpu.clone()),
            None => Ok(cpu.insert(Arc::new(Cpu::new(self.threads)?)).clone()),
        }
    }
}

/// The part of a device error that matters when nobody asked for that device.
fn reason(error: &Error) -> String {
    match error {
        Error::NoDevice { reason, .. } => reason.clone(),
        other => other.to_string(),
    }
}

/// One piece of work on a device, and what its user should know of who did it.
pub(crate) struct Work<'a> {
    device: &'a Device,
    control: &'a Control,
    warnings: Vec<String>,
}

impl<'a> Work<'a> {
    pub(crate) fn new(device: &'a Device, control: &'a Control) -> Self {
        Self { device, control, warnings: Vec::new() }
    }

    pub(crate) async fn pair_counts(&mut self, plan: &PairPlan, ensemble: &Ensemble) -> Result<PairCounts> {
        let control = self.control;
        self.run(self.device.compute.supports_pair_counts(plan), |c| c.pair_counts(plan, ensemble, control))
    }

    /// Of several ensembles, all by the same backend: their weights may be subtracted from each other.
    pub(crate) async fn all_pair_counts(&mut self, plan: &PairPlan, ensembles: &[Ensemble]) -> Result<Vec<PairCounts>> {
        let control = self.control;
        let supported = self.device.compute.supports_pair_counts(plan);
        self.run(supported, |c| ensembles.iter().map(|e| c.pair_counts(plan, e, control)).collect())
    }

    pub(crate) async fn lag_counts(&mut self, plan: &LagPlan, ensemble: &Ensemble) -> Result<LagCounts> {
        let control = self.control;
        self.run(self.device.compute.supports_lag_counts(plan), |c| c.lag_counts(plan, ensemble, control))
    }

    pub(crate) async fn wave_power(&mut self, plan: &WavePlan, ensemble: &Ensemble) -> Result<WavePower> {
        let control = self.control;
        self.run(self.device.compute.supports_wave_power(plan), |c| c.wave_power(plan, ensemble, control))
    }

    /// By the method of the plan. That the direct sum is not for a GPU is part of the plan: nothing to warn of.
    pub(crate) async fn kernel_sums(&mut self, plan: &KernelPlan, ensemble: &Ensemble) -> Result<KernelSums> {
        let control = self.control;
        match plan.road {
            KernelRoad::Binned => self.run(self.device.compute.supports_pair_counts(&plan.pairs), |c| {
                binned_kernel::kernel_sums(c, plan, ensemble, control)
            }),
            KernelRoad::Direct => match self.device.compute.kernel_sums(plan, ensemble, control) {
                Some(sums) => sums,
                None => self.device.cpu()?.direct_kernel_sums(plan, ensemble, control),
            },
        }
    }

    /// On the CPU path where the device has none, which is part of the plan.
    pub(crate) async fn wave_covariance(
        &mut self,
        plan: &CovariancePlan,
        ensemble: &Ensemble,
    ) -> Result<WaveCovariance> {
        match self.device.compute.wave_covariance(plan, ensemble, self.control) {
            Some(sums) => sums,
            None => self.device.cpu()?.amplitude_products(plan, ensemble, self.control),
        }
    }

    /// On the CPU path, whatever the device.
    pub(crate) async fn neighbors(&mut self, plan: &NeighborPlan, ensemble: &Ensemble) -> Result<NeighborSums> {
        neighbor_sums(plan, ensemble, self.control)
    }

    /// What the user should know about who computed.
    pub(crate) fn into_warnings(self) -> Vec<String> {
        self.warnings
    }

    /// A batch at which the device failed has left nothing behind, so it is simply done again.
    fn run<T>(&mut self, supported: Result<(), String>, work: impl Fn(&dyn Compute) -> Result<T>) -> Result<T> {
        if let Some(failure) = self.device.failure.get() {
            self.warn(failure.clone());
            return work(self.device.cpu()?.as_ref());
        }
        match supported {
            Ok(()) => match work(self.device.compute()) {
                Err(error @ Error::Device { .. }) => {
                    let failure = format!("{error}; continued on the native CPU path");
                    self.warn(self.device.failure.get_or_init(|| failure).clone());
                }
                done => return done,
            },
            Err(why) => self.warn(format!("{why}; done on the native CPU path")),
        }
        work(self.device.cpu()?.as_ref())
    }

    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}

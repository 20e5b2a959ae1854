//! A device made ready, with the CPU path behind it.

use std::sync::OnceLock;

use super::cpu::Cpu;
use super::gpu::{AdapterChoice, GpuCompute};
use super::integration::integration;
use super::{Compute, NotHere, Work, binned_kernel, reference::Reference};
use crate::accumulate::{
    ComputedBy, CountSums, DiscrepancySums, IntegrationSums, IntensityScores, IntensitySums, KernelSums, LagCounts,
    NeighborSums, PairCounts, WaveCovariance, WavePower, intensity_scores,
};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::plan::{
    CountPlan, CovariancePlan, DiscrepancyPlan, IntegrationPlan, IntensityPlan, IntensitySearch, KernelMethod,
    KernelPlan, LagPlan, NeighborPlan, PairPlan, WavePlan,
};
use crate::points::Ensemble;
use crate::pool::{Pool, check_threads};
use crate::request::DeviceChoice;

/// What computes: a GPU, the CPU path or the reference. What a GPU does not do, or everything once it has failed, the CPU path
/// does. Opened once; both last as long as it does, and so does the memory that it failed.
pub struct Device {
    compute: Box<dyn Compute>,
    note: Option<String>,
    /// Of the CPU path, and of all parallel work around a device.
    pool: Pool,
    cpu: OnceLock<Cpu>,
    /// What the device said when it failed.
    failure: OnceLock<String>,
}

impl Device {
    /// Of something that computes. `threads` are those of the CPU path behind it, where it has none of its own.
    ///
    /// # Errors
    /// `Error::Setting` for a number of threads that cannot be.
    pub fn new(compute: Box<dyn Compute>, threads: Option<usize>) -> Result<Self> {
        // A device's own threads go before.
        let pool = compute.pool().cloned().map_or_else(|| Pool::new(threads), Ok)?;
        Ok(Self { compute, note: None, pool, cpu: OnceLock::new(), failure: OnceLock::new() })
    }

    /// Opens the device that is asked for. `threads` is for the CPU path.
    ///
    /// # Errors
    /// `Error::NoDevice` where there is none of the kind, `Error::Setting` for a number of threads that cannot be.
    pub async fn open(choice: DeviceChoice, threads: Option<usize>) -> Result<Self> {
        let gpu = async |choice| -> Result<Self> {
            // The CPU path stands behind every GPU.
            threads.map_or(Ok(()), check_threads)?;
            Self::new(Box::new(GpuCompute::open(choice).await?), threads)
        };
        match choice {
            DeviceChoice::Cpu => Self::new(Box::new(Cpu::new(threads)?), threads),
            DeviceChoice::Reference => Self::new(Box::new(Reference), threads),
            DeviceChoice::Gpu => gpu(AdapterChoice::Any).await,
            DeviceChoice::Index(index) => gpu(AdapterChoice::Index(index)).await,
            DeviceChoice::Auto => match gpu(AdapterChoice::HardwareOnly).await {
                Err(error @ (Error::NoDevice { .. } | Error::Device { .. })) => {
                    let note = format!("{}; using the native CPU path", reason(&error));
                    Ok(Self::new(Box::new(Cpu::new(threads)?), threads)?.noted(note))
                }
                opened => opened,
            },
        }
    }

    /// What the user should know about the choice: why `auto` has not taken a GPU.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// The same, with a note about the choice.
    #[must_use]
    pub(crate) fn noted(self, note: String) -> Self {
        Self { note: Some(note), ..self }
    }

    /// What was opened, without the CPU path behind it.
    pub fn compute(&self) -> &dyn Compute {
        self.compute.as_ref()
    }

    /// Who computes, as long as nothing fails.
    pub fn computed_by(&self) -> ComputedBy {
        self.compute.computed_by()
    }

    /// Where parallel work around the device runs.
    pub fn pool(&self) -> &Pool {
        &self.pool
    }

    /// The CPU path, made ready when it is first needed.
    pub(crate) fn cpu(&self) -> &Cpu {
        self.cpu.get_or_init(|| Cpu::with_pool(self.pool.clone()))
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
pub(crate) struct Session<'a> {
    device: &'a Device,
    control: &'a Control,
    warnings: Vec<String>,
    /// Power of the same points that another piece of work had on the way.
    lent: Option<WavePower>,
}

impl<'a> Session<'a> {
    pub(crate) fn new(device: &'a Device, control: &'a Control, lent: Option<WavePower>) -> Self {
        Self { device, control, warnings: Vec::new(), lent }
    }

    /// What was lent, once.
    pub(crate) fn take_lent(&mut self) -> Option<WavePower> {
        self.lent.take()
    }

    /// As `Control::in_pieces`.
    pub(crate) fn in_pieces(&self, pieces: usize) {
        self.control.in_pieces(pieces);
    }

    pub(crate) async fn pair_counts(&mut self, plan: &PairPlan, ensemble: &Ensemble) -> Result<PairCounts> {
        let control = self.control;
        self.run(Work::Pairs(plan), async |c: &dyn Compute| c.pair_counts(plan, ensemble, control).await).await
    }

    /// Of several ensembles, all by the same backend: their weights may be subtracted from each other.
    pub(crate) async fn all_pair_counts(&mut self, plan: &PairPlan, ensembles: &[Ensemble]) -> Result<Vec<PairCounts>> {
        let control = self.control;
        control.in_pieces(ensembles.len());
        let all = async |c: &dyn Compute| {
            let mut all = Vec::with_capacity(ensembles.len());
            for ensemble in ensembles {
                all.push(c.pair_counts(plan, ensemble, control).await?);
            }
            Ok(all)
        };
        self.run(Work::Pairs(plan), all).await
    }

    pub(crate) async fn lag_counts(&mut self, plan: &LagPlan, ensemble: &Ensemble) -> Result<LagCounts> {
        let control = self.control;
        self.run(Work::Lags(plan), async |c: &dyn Compute| c.lag_counts(plan, ensemble, control).await).await
    }

    pub(crate) async fn wave_power(&mut self, plan: &WavePlan, ensemble: &Ensemble) -> Result<WavePower> {
        let control = self.control;
        self.run(Work::Waves(plan), async |c: &dyn Compute| c.wave_power(plan, ensemble, control).await).await
    }

    /// By the method of the plan.
    pub(crate) async fn kernel_sums(&mut self, plan: &KernelPlan, ensemble: &Ensemble) -> Result<KernelSums> {
        let (control, pool) = (self.control, self.device.pool());
        match plan.method {
            KernelMethod::Binned => {
                let binned = async |c: &dyn Compute| binned_kernel::kernel_sums(c, pool, plan, ensemble, control).await;
                self.run(Work::Pairs(&plan.pairs), binned).await
            }
            KernelMethod::Direct => {
                self.run(Work::Kernel(plan), async |c: &dyn Compute| c.kernel_sums(plan, ensemble, control).await).await
            }
        }
    }

    pub(crate) async fn wave_covariance(
        &mut self,
        plan: &CovariancePlan,
        ensemble: &Ensemble,
    ) -> Result<WaveCovariance> {
        let control = self.control;
        self.run(Work::Covariance(plan), async |c: &dyn Compute| c.wave_covariance(plan, ensemble, control).await).await
    }

    pub(crate) async fn neighbors(&mut self, plan: &NeighborPlan, ensemble: &Ensemble) -> Result<NeighborSums> {
        let control = self.control;
        self.run(Work::Neighbors(plan), async |c: &dyn Compute| c.neighbors(plan, ensemble, control).await).await
    }

    pub(crate) async fn discrepancies(
        &mut self,
        plan: &DiscrepancyPlan,
        ensemble: &Ensemble,
    ) -> Result<DiscrepancySums> {
        let control = self.control;
        self.run(Work::Discrepancy(plan), async |c: &dyn Compute| c.discrepancies(plan, ensemble, control).await).await
    }

    /// With its power lent to who comes next, if it `lends`.
    pub(crate) async fn integration(
        &mut self,
        plan: &IntegrationPlan,
        lends: bool,
        ensemble: &Ensemble,
    ) -> Result<IntegrationSums> {
        let (control, cpu) = (self.control, self.device.cpu());
        // What has no integration of its own gives the power.
        let work = async |c: &dyn Compute| match c.supports(Work::Integration(plan)) {
            Ok(()) => c.integration(plan, ensemble, control).await,
            Err(_) => integration(c, cpu, plan, ensemble, control).await,
        };
        let sums = self.run(Work::Waves(&plan.grid), work).await?;
        self.lent = lends.then(|| sums.grid.clone());
        Ok(sums)
    }

    pub(crate) async fn counts(&mut self, plan: &CountPlan, ensemble: &Ensemble) -> Result<CountSums> {
        let control = self.control;
        self.run(Work::Counts(plan), async |c: &dyn Compute| c.counts(plan, ensemble, control).await).await
    }

    pub(crate) async fn intensity(&mut self, plan: &IntensityPlan, ensemble: &Ensemble) -> Result<IntensitySums> {
        let control = self.control;
        self.run(Work::Intensity(plan), async |c: &dyn Compute| c.intensity(plan, ensemble, control).await).await
    }

    /// On the CPU, whatever the device.
    pub(crate) fn intensity_scores(&self, search: &IntensitySearch, ensemble: &Ensemble) -> Result<IntensityScores> {
        self.device.pool().install(|| intensity_scores(search, ensemble, self.control))
    }

    /// What the user should know about who computed, and what is lent.
    pub(crate) fn into_parts(self) -> (Vec<String>, Option<WavePower>) {
        (self.warnings, self.lent)
    }

    /// A batch at which the device failed has left nothing behind, so it is simply done again.
    async fn run<T>(&mut self, what: Work<'_>, work: impl AsyncFn(&dyn Compute) -> Result<T>) -> Result<T> {
        let device = self.device;
        match (device.failure.get(), device.compute.supports(what)) {
            (Some(failure), _) => self.warn(failure.clone()),
            (None, Ok(())) => match work(device.compute()).await {
                Err(error @ Error::Device { .. }) => {
                    let failure = format!("{error}; continued on the native CPU path");
                    self.warn(device.failure.get_or_init(|| failure).clone());
                }
                done => return done,
            },
            (None, Err(NotHere::Because(why))) => self.warn(format!("{why}; done on the native CPU path")),
            (None, Err(NotHere::Never)) => {}
        }
        work(device.cpu()).await
    }

    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}

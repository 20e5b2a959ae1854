//! The GPU path, through wgpu: exact pair and lag counts, edge weights, and power spectra. The only folder that names
//! wgpu.
//!
//! Three layers from a call to the device: `GpuCompute::pair_counts` cuts the work into dispatches, `Kernel` binds and
//! dispatches one, wgpu does it. Kernels are made once and reused; buffers live as long as one call.

mod answer;
mod buffers;
mod device;
mod kernel;
mod lag_counts;
mod pair_cells;
mod pair_counts;
mod pair_jobs;
mod pair_run;
mod pair_specs;
mod pair_sums;
#[doc(hidden)]
pub mod params;
mod probe;
mod wave_power;
mod wave_specs;

use std::sync::{Arc, Mutex, PoisonError};

#[doc(hidden)]
pub use buffers::Fill;
pub use device::{AdapterChoice, AdapterSummary, Gpu, adapters};
#[doc(hidden)]
pub use kernel::{Kernel, KernelSpec, SHADER_FILES, ShaderFile};
pub use probe::{Check, Verdict};

use super::{Compute, NotHere, Pending, See, Work, at_once};
use crate::accumulate::{Backend, ComputedBy};
use crate::accumulate::{LagCounts, PairCounts, WavePower};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Accuracy, DeviceCosts, LagPlan, PairDevice, PairPlan, SearchCosts, WaveCosts, WaveGrid, WavePlan};
use crate::points::Ensemble;

/// Workgroups per dimension that every device takes.
const MAX_GROUPS: u32 = 65_535;

/// How work is cut for a device. None of it changes a result.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tuning {
    /// Pairs looked at per submission: the driver's watchdog, and the user's patience, end long ones.
    pub pairs_per_dispatch: u64,
    /// Multiplications and additions per submission of `wave_power`.
    pub fma_per_dispatch: u64,
    /// Size of any one buffer, unless a single realization needs more.
    pub buffer_bytes: u64,
    /// What scratch memory holds at first.
    pub fill: Fill,
}

impl Tuning {
    /// About a second per submission at worst: on hardware from 2e9 pairs/s and 1e11 flop/s on, on software from 6e7 and 1e9.
    fn new(software: bool) -> Self {
        Self {
            pairs_per_dispatch: if software { 1 << 26 } else { 1 << 31 },
            fma_per_dispatch: if software { 1 << 29 } else { 1 << 36 },
            buffer_bytes: if software { 64 << 20 } else { 256 << 20 },
            fill: Fill::Zero,
        }
    }
}

/// The GPU implementation: an open device that passed the self-check, and the kernels made so far.
#[derive(Debug)]
pub struct GpuCompute {
    gpu: Gpu,
    kernels: Mutex<Vec<Arc<Kernel>>>,
    tuning: Tuning,
    verdict: Verdict,
}

/// Kernels kept. Callers come back with the same plan batch after batch; a viewer comes with many.
const KERNELS_KEPT: usize = 32;

impl GpuCompute {
    /// Opens an adapter and runs the self-check on it. An adapter that fails is passed over; `Err(NoDevice)` says what
    /// failed where none is left.
    ///
    /// # Errors
    /// `Error::NoDevice` where there is none of the kind, `Error::Device` if it fails at once or its self-check does not hold.
    pub async fn open(choice: AdapterChoice) -> Result<Self> {
        let mut failures = Vec::new();
        for (summary, adapter) in device::candidates(choice).await? {
            match Self::checked(summary.clone(), &adapter).await {
                Ok(compute) if compute.verdict.passed() => return Ok(compute),
                Ok(compute) => {
                    failures.push(format!("{summary} failed its self-check: {}", compute.verdict.failures()))
                }
                Err(e) => failures.push(e.to_string()),
            }
        }
        Err(device::refused(choice, &failures))
    }

    async fn checked(summary: AdapterSummary, adapter: &wgpu::Adapter) -> Result<Self> {
        let tuning = Tuning::new(summary.software);
        let gpu = Gpu::open(summary, adapter).await?;
        let mut compute = Self { gpu, kernels: Mutex::default(), tuning, verdict: Verdict::default() };
        compute.verdict = probe::check(&compute).await;
        Ok(compute)
    }

    /// The open device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// What the self-check found when the device was opened.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// For tests: other cuts of the same work.
    #[doc(hidden)]
    pub fn with_tuning(mut self, change: impl FnOnce(&mut Tuning)) -> Self {
        change(&mut self.tuning);
        self
    }

    /// The kernel, made if it was not yet.
    async fn kernel(&self, spec: KernelSpec) -> Result<Arc<Kernel>> {
        // A kernel is added whole or not at all, so the list is good even if another thread panicked.
        let kernels = || self.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kernels().iter().find(|k| *k.spec() == spec).map(Arc::clone);
        if let Some(kernel) = known {
            return Ok(kernel);
        }
        let kernel = Arc::new(Kernel::new(&self.gpu, spec).await?);
        let mut kernels = kernels();
        if kernels.len() >= KERNELS_KEPT {
            kernels.remove(0);
        }
        kernels.push(Arc::clone(&kernel));
        Ok(kernel)
    }
}

impl Gpu {
    fn encoder(&self, label: &'static str) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }
}

/// The kernel that counts all pairs of a plan, on a device with `workgroup_bytes` of workgroup memory.
pub fn pair_kernel(plan: &PairPlan, workgroup_bytes: u32) -> KernelSpec {
    pair_specs::all_pairs(plan, workgroup_bytes)
}

/// The kernels that sort points into cells, and the one that counts pairs in cells near each other.
pub fn cell_kernels(plan: &PairPlan, workgroup_bytes: u32) -> [KernelSpec; 3] {
    let [count, scatter] = pair_specs::sort(plan);
    [count, scatter, pair_specs::cell_pairs(plan, workgroup_bytes)]
}

/// The kernel that counts the pairs of a plan by their lag, on a device with `workgroup_bytes` of workgroup memory.
pub fn lag_kernel(plan: &LagPlan, workgroup_bytes: u32) -> KernelSpec {
    lag_counts::spec(plan, workgroup_bytes)
}

/// The kernels that compute the power on a grid, of points with or without weights.
pub fn wave_kernels(grid: &WaveGrid, accuracy: Accuracy, weighted: bool) -> [KernelSpec; 2] {
    let blocks = wave_specs::Blocks::new(grid);
    [wave_specs::product(&blocks, grid, accuracy, weighted), wave_specs::fold(&blocks, accuracy)]
}

/// The kernel of the self-check.
pub fn probe_kernel() -> KernelSpec {
    probe::spec()
}

impl Compute for GpuCompute {
    fn computed_by(&self) -> ComputedBy {
        ComputedBy::new(Backend::Gpu, self.gpu.summary().to_string())
    }

    fn supports(&self, work: Work<'_>) -> Result<(), NotHere> {
        let binding_bytes = self.gpu.limits.max_storage_buffer_binding_size;
        let done = match work {
            Work::Pairs(plan) => pair_specs::supports(plan, &self.gpu.limits),
            Work::Lags(plan) => lag_counts::supports(plan, binding_bytes),
            Work::Waves(plan) => wave_specs::supports(plan, self.verdict.f64(), binding_bytes),
            Work::Kernel(_)
            | Work::Covariance(_)
            | Work::Neighbors(_)
            | Work::Discrepancy(_)
            | Work::Integration(_)
            | Work::Counts(_)
            | Work::Intensity(_) => {
                return Err(NotHere::Never);
            }
        };
        done.map_err(NotHere::Because)
    }

    fn costs(&self) -> DeviceCosts {
        let buffers = Some(self.gpu.limits.max_storage_buffers_per_shader_stage);
        DeviceCosts { pairs: PairDevice { costs: SearchCosts::GPU, buffers }, waves: WaveCosts::GPU }
    }

    fn pair_counts<'a>(
        &'a self,
        plan: &'a PairPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, PairCounts> {
        Box::pin(pair_counts::pair_counts(self, plan, ensemble, control))
    }

    fn lag_counts<'a>(
        &'a self,
        plan: &'a LagPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, LagCounts> {
        Box::pin(lag_counts::lag_counts(self, plan, ensemble, control))
    }

    fn wave_power<'a>(
        &'a self,
        plan: &'a WavePlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WavePower> {
        self.wave_power_seen(plan, ensemble, &|_, _| (), control)
    }

    fn wave_power_seen<'a>(
        &'a self,
        plan: &'a WavePlan,
        ensemble: &'a Ensemble,
        see: &'a See<'a>,
        control: &'a Control,
    ) -> Pending<'a, WavePower> {
        match self.supports(Work::Waves(plan)) {
            Err(NotHere::Because(reason)) => at_once(move || Err(self.gpu.error("wave_power", reason))),
            _ => Box::pin(wave_power::wave_power(self, plan, ensemble, see, control)),
        }
    }
}

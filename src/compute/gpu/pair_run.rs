//! One call of `pair_counts` at work: what it uploads, submits and adds up, whichever pairs it looks at.

use std::ops::Range;

use super::buffers::ReadBack;
use super::kernel::Kernel;
use super::pair_sums::{Sums, depths};
use super::params::PairParams;
use super::{GpuCompute, pair_specs};
use crate::accumulate::PairCounts;
use crate::compute::Compute;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{BinFilter, PairPlan};
use crate::points::{Ensemble, round32};

pub(super) const NAME: &str = "pair_counts";

/// One call at work.
pub(super) struct Run<'a> {
    pub(super) compute: &'a GpuCompute,
    pub(super) plan: &'a PairPlan,
    pub(super) ensemble: &'a Ensemble,
    pub(super) control: &'a Control,
    /// Points per realization.
    pub(super) sizes: Vec<usize>,
    params: PairParams,
    sums: Sums,
    /// The histograms on their way to the host, and whose they are.
    under_way: Option<(Range<usize>, ReadBack)>,
}

/// What a buffer of the usual size holds, and a dispatch.
pub(super) struct Caps {
    pub(super) bytes: u64,
    pub(super) points: usize,
    pub(super) histograms: usize,
    pub(super) pairs: u64,
}

impl<'a> Run<'a> {
    pub(super) fn new(
        compute: &'a GpuCompute,
        plan: &'a PairPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Self {
        Self {
            compute,
            plan,
            ensemble,
            control,
            sizes: (0..ensemble.realizations()).map(|k| ensemble.points_in(k)).collect(),
            params: params(plan),
            sums: Sums::new(plan, ensemble.realizations()),
            under_way: None,
        }
    }

    /// What was counted.
    pub(super) fn into_sums(self) -> PairCounts {
        self.sums.finish(self.compute.computed_by(), self.plan, self.ensemble)
    }

    pub(super) fn caps(&self) -> Caps {
        let (tuning, limits) = (&self.compute.tuning, &self.compute.gpu().limits);
        let bytes = tuning.buffer_bytes.min(limits.max_storage_buffer_binding_size);
        Caps {
            bytes,
            points: (bytes / (8 * self.plan.domain.dim() as u64)) as usize,
            histograms: (bytes / (4 * self.words() as u64)).max(1) as usize,
            pairs: tuning.pairs_per_dispatch.min(pair_specs::pair_limit(self.plan)),
        }
    }

    fn words(&self) -> usize {
        self.sums.layout.words as usize
    }

    /// Submits jobs on `points`, which are those of `range`. `jobs` and what else the kernel reads.
    pub(super) async fn submit(
        &mut self,
        kernel: &Kernel,
        tables: &Tables,
        range: Range<usize>,
        points: &UploadedPoints,
        jobs: &[&wgpu::Buffer],
        groups: u32,
    ) -> Result<()> {
        let (gpu, fill) = (self.compute.gpu(), self.compute.tuning.fill);
        self.params.total_points = self.sizes[range.clone()].iter().sum::<usize>() as u32;
        let params = gpu.uniform("params", &self.params);
        let words = range.len() * self.words();
        let histograms = gpu.scratch("histograms", 4 * words as u64, fill);
        let mut encoder = gpu.encoder(NAME);
        encoder.clear_buffer(&histograms, 0, None);
        let first = [&params, jobs[0], &points.rounded, &points.exact, &tables.thresholds, &histograms];
        let rest = tables.bins.iter().chain(&points.depths).chain(jobs[1..].iter().copied());
        let buffers: Vec<_> = first.into_iter().chain(rest).collect();
        kernel.dispatch(gpu, &mut encoder, &buffers, groups);
        let read = gpu.submit_and_read::<u32>(NAME, encoder, &histograms, words);
        // One submission ahead: the device has work while the host adds up.
        if let Some((range, read)) = self.under_way.replace((range, read)) {
            self.sums.add(range, &gpu.finish(read).await?);
        }
        Ok(())
    }

    /// Waits for the last submission.
    pub(super) async fn finish(&mut self) -> Result<()> {
        if let Some((range, read)) = self.under_way.take() {
            self.sums.add(range, &self.compute.gpu().finish(read).await?);
        }
        Ok(())
    }
}

/// The numbers of a plan that every dispatch shares.
fn params(plan: &PairPlan) -> PairParams {
    let sides = plan.domain.side_steps();
    let mut params = PairParams {
        side_rounded: std::array::from_fn(|a| sides.get(a).map_or(0, |&s| round32(s, 0))),
        side_low: std::array::from_fn(|a| sides.get(a).map_or(0, |&s| s as u32)),
        side_high: std::array::from_fn(|a| sides.get(a).map_or(0, |&s| (s >> 32) as u32)),
        ..PairParams::default()
    };
    match &plan.filter {
        BinFilter::Linear { bins_per_step, relative_guard, absolute_guard } => {
            params.bins_per_step = *bins_per_step;
            params.relative_guard = *relative_guard;
            params.absolute_guard = *absolute_guard;
        }
        BinFilter::Table(table) => {
            params.first_cell = table.first_cell;
            params.last_cell = table.cells.len() as u32 - 1;
        }
    }
    params
}

/// What a plan puts into buffers.
pub(super) struct Tables {
    thresholds: wgpu::Buffer,
    /// Cells and bounds of a table of bins.
    bins: Vec<wgpu::Buffer>,
}

impl Tables {
    pub(super) fn upload(compute: &GpuCompute, plan: &PairPlan) -> Self {
        let (gpu, fill) = (compute.gpu(), compute.tuning.fill);
        let limbs = |t: &u128| -> [u32; 4] { std::array::from_fn(|k| (t >> (32 * k)) as u32) };
        let thresholds: Vec<[u32; 4]> = plan.thresholds.iter().map(limbs).collect();
        let bins = match &plan.filter {
            BinFilter::Linear { .. } => Vec::new(),
            BinFilter::Table(table) => {
                let bounds: Vec<[f32; 2]> =
                    table.low.iter().zip(&table.high).map(|(&low, &high)| [low, high]).collect();
                vec![gpu.upload("cells", &table.cells, fill), gpu.upload("bounds", &bounds, fill)]
            }
        };
        Self { thresholds: gpu.upload("thresholds", &thresholds, fill), bins }
    }
}

/// Points of several realizations.
pub(super) struct UploadedPoints {
    /// Positions rounded to 32 bits, axis by axis.
    pub(super) rounded: wgpu::Buffer,
    /// Positions, axis by axis.
    pub(super) exact: wgpu::Buffer,
    /// Bins whose upper edge is at most the distance from the border, for minus sampling.
    pub(super) depths: Option<wgpu::Buffer>,
}

impl UploadedPoints {
    /// Where the points of realizations `range` are.
    pub(super) fn upload(compute: &GpuCompute, ensemble: &Ensemble, range: &Range<usize>) -> Self {
        let (mut short, mut long) = (Vec::new(), Vec::new());
        let points =
            if range.is_empty() { 0..0 } else { ensemble.range(range.start).start..ensemble.range(range.end - 1).end };
        let domain = ensemble.domain();
        for (axis, &period) in domain.periods().iter().enumerate().take(domain.dim()) {
            let axis = &ensemble.all_lengths(axis)[points.clone()];
            let rounded = round32(period, 0);
            short.extend(axis.iter().map(|&x| round32(x, rounded)));
            // Low word first, as the kernel reads it.
            long.extend(axis.iter().map(|&x| [x as u32, (x >> 32) as u32]));
        }
        let (gpu, fill) = (compute.gpu(), compute.tuning.fill);
        Self { rounded: gpu.upload("rounded", &short, fill), exact: gpu.upload("exact", &long, fill), depths: None }
    }

    /// And how deep inside the window, where the plan asks for it.
    pub(super) fn with_depths(
        compute: &GpuCompute,
        plan: &PairPlan,
        ensemble: &Ensemble,
        range: &Range<usize>,
    ) -> Self {
        let depths: Option<Vec<u32>> =
            plan.border().then(|| range.clone().flat_map(|k| depths(plan, &ensemble.lengths(k))).collect());
        let depths = depths.map(|m| compute.gpu().upload("depths", &m, compute.tuning.fill));
        Self { depths, ..Self::upload(compute, ensemble, range) }
    }
}

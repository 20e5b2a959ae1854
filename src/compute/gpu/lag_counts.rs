//! Lag counts on the GPU: which kernel, and how its histograms become `LagCounts`. Work is cut as for pair counts. See the
//! reference for the definition and `shaders/lag_counts.wgsl` for the work itself.

use std::ops::Range;

use super::kernel::{self, KernelSpec};
use super::pair_jobs::dispatches;
use super::pair_run::UploadedPoints;
use super::pair_specs::fits;
use super::params::{LAG_COUNTS, LagParams};
use super::{GpuCompute, Tuning};
use crate::accumulate::{LagCounts, PairHistogram};
use crate::compute::Compute;
use crate::control::Control;
use crate::error::Result;
use crate::plan::LagPlan;
use crate::points::{Ensemble, round32};

const NAME: &str = "lag_counts";
/// Invocations, and points of a tile. Wide, since histograms of lags are large and few workgroups share a processor.
const WORKGROUP: u32 = 256;
/// Workgroup memory given to copies of the histogram.
const COPIES_BYTES: u32 = 16 << 10;
const MAX_COPIES: u32 = 8;

/// The kernel for a plan on a device with `limit` bytes of workgroup memory.
pub(super) fn spec(plan: &LagPlan, limit: u32) -> KernelSpec {
    let (dim, cells) = (plan.domain.dim() as u32, plan.grid.cells() as u32);
    let mut files = vec![kernel::WIDE_INTEGERS];
    files.push(if plan.domain.periods()[..dim as usize].iter().all(|&p| p == 0) {
        kernel::TORUS_CUBIC
    } else {
        kernel::TORUS_BOX
    });
    let mut overrides = vec![
        ("WORKGROUP", WORKGROUP),
        ("DIM", dim),
        ("AXIS_BINS", plan.grid.bins as u32),
        ("WORDS", cells),
        ("SUMS", 0),
        ("TILE_WORDS", dim * WORKGROUP),
        ("WINDOW", u32::from(!plan.domain.is_torus())),
    ];
    let tile_bytes = 4 * dim * WORKGROUP;
    if 4 * u64::from(cells) + u64::from(tile_bytes) <= u64::from(limit) {
        let mut copies = 1;
        while copies < MAX_COPIES && 2 * copies * cells * 4 <= COPIES_BYTES.min(limit - tile_bytes) {
            copies *= 2;
        }
        files.push(kernel::HISTOGRAM_WORKGROUP);
        overrides.extend([("COPIES", copies), ("HISTOGRAM_WORDS", cells * copies)]);
    } else {
        files.push(kernel::HISTOGRAM_GLOBAL);
    }
    files.push(kernel::LAG_COUNTS);
    KernelSpec { name: NAME, files, overrides, bindings: LAG_COUNTS }
}

/// Why a plan cannot run on a device whose buffers hold `binding_bytes`.
pub(super) fn supports(plan: &LagPlan, binding_bytes: u64) -> Result<(), String> {
    fits(plan.shape.max_points, plan.domain.dim(), binding_bytes)
}

fn params(plan: &LagPlan) -> (LagParams, Vec<[u32; 2]>) {
    let words = |v: u64| [v as u32, (v >> 32) as u32];
    let mut params = LagParams { offset: [0.5; 4], ..LagParams::default() };
    let mut thresholds = Vec::new();
    for (axis, period) in plan.domain.periods().into_iter().enumerate() {
        params.side_rounded[axis] = round32(period, 0);
        [params.side_low[axis], params.side_high[axis]] = words(period);
        let f = &plan.filter;
        params.scale[axis] = f.scale[axis];
        params.offset[axis] = f.offset[axis];
        params.low[axis] = f.low[axis];
        params.high[axis] = f.high[axis];
        params.guard[axis] = f.guard[axis];
        params.strides[axis] = plan.grid.strides()[axis] as u32;
    }
    for (axis, edges) in plan.grid.thresholds.iter().enumerate() {
        let (first, last) = (edges[0], edges[plan.grid.bins]);
        // Casts of i128 are modulo 2^64; all of these but `first` lie in [0, 2^64).
        [params.first_low[axis], params.first_high[axis]] = words(first as u64);
        [params.last_low[axis], params.last_high[axis]] = words((last - first - 1) as u64);
        thresholds.extend(edges[..plan.grid.bins].iter().map(|t| words((t - first) as u64)));
    }
    (params, thresholds)
}

pub(super) async fn lag_counts(
    compute: &GpuCompute,
    plan: &LagPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<LagCounts> {
    let gpu = compute.gpu();
    let tuning: &Tuning = &compute.tuning;
    let (dim, cells) = (plan.domain.dim(), plan.grid.cells());
    let realizations = ensemble.realizations();
    let binding_bytes = gpu.limits.max_storage_buffer_binding_size;
    let sizes: Vec<usize> = (0..realizations).map(|k| ensemble.points_in(k)).collect();
    let largest = sizes.iter().copied().max().unwrap_or(0);
    fits(largest as u64, dim, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;

    let kernel = compute.kernel(spec(plan, gpu.limits.max_compute_workgroup_storage_size)).await?;
    let buffer_bytes = tuning.buffer_bytes.min(binding_bytes);
    let point_cap = (buffer_bytes / (8 * dim as u64)) as usize;
    let histogram_cap = (buffer_bytes / (4 * cells as u64)).max(1) as usize;
    // A counter is u32: fewer than 2^32 pairs may be looked at before it is read.
    let pair_cap = tuning.pairs_per_dispatch.min(u64::from(u32::MAX));
    let work = dispatches(&sizes, WORKGROUP, pair_cap, point_cap, histogram_cap);
    let (mut params, thresholds) = params(plan);

    let mut counts = vec![0u64; realizations * cells];
    let mut collect = |range: Range<usize>, found: Vec<u32>| {
        for (sum, c) in counts[range.start * cells..range.end * cells].iter_mut().zip(found) {
            *sum += u64::from(c);
        }
    };
    let mut under_way = None;
    let mut held: Option<(Range<usize>, UploadedPoints)> = None;
    gpu.guarded(NAME, async || {
        let thresholds = gpu.upload("thresholds", &thresholds, tuning.fill);
        for dispatch in &work {
            control.check()?;
            let range = dispatch.realizations.clone();
            // A large realization takes many dispatches; its points go up once.
            if held.as_ref().is_none_or(|(r, _)| *r != range) {
                drop(held.take());
                held = Some((range.clone(), UploadedPoints::upload(compute, ensemble, &range)));
            }
            let Some((_, points)) = &held else { continue };
            let jobs = gpu.upload("jobs", &dispatch.jobs, tuning.fill);
            params.total_points = range.clone().map(|k| sizes[k]).sum::<usize>() as u32;
            let params = gpu.uniform("params", &params);
            let words = range.len() * cells;
            let histograms = gpu.scratch("histograms", 4 * words as u64, tuning.fill);
            let mut encoder = gpu.encoder(NAME);
            encoder.clear_buffer(&histograms, 0, None);
            let buffers = [&params, &jobs, &points.rounded, &points.exact, &thresholds, &histograms];
            kernel.dispatch(gpu, &mut encoder, &buffers, dispatch.jobs.len() as u32);
            let read = gpu.submit_and_read::<u32>(NAME, encoder, &histograms, words);
            control.advance(1.0 / work.len() as f64);
            // One submission ahead: the device has work while the host adds up.
            if let Some((range, read)) = under_way.replace((range, read)) {
                collect(range, gpu.finish(read).await?);
            }
        }
        if let Some((range, read)) = under_way {
            collect(range, gpu.finish(read).await?);
        }
        Ok(())
    })
    .await?;

    let mut sums = LagCounts::new(compute.computed_by(), plan);
    for (k, &n) in sizes.iter().enumerate() {
        let counts = plan.grid.with_mirror(&counts[k * cells..(k + 1) * cells]);
        sums.add(plan, &PairHistogram::new(n as u64, counts, None));
    }
    Ok(sums)
}

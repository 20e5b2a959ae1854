//! Pair counts on the GPU: which kernel, which dispatches, and how its histograms become `PairCounts`. See the reference
//! for the definition and `shaders/pair_counts.wgsl` for the work itself.

use std::ops::Range;

use super::kernel::{self, KernelSpec};
use super::params::{PAIR_LINEAR, PAIR_TABLE, PairJob, PairParams};
use super::{GpuCompute, MAX_GROUPS, Tuning};
use crate::accumulate::{PairCounts, PairHistogram};
use crate::compute::{Compute, Control};
use crate::error::Result;
use crate::plan::{BinFilter, BinTable, PairPlan};
use crate::points::Ensemble;

const NAME: &str = "pair_counts";
/// Points in registers per invocation.
const POINTS_PER_LANE: u32 = 4;
/// Workgroup memory given to copies of the histogram. More would keep other workgroups off the processor.
const COPIES_BYTES: u32 = 16 << 10;
const MAX_COPIES: u32 = 8;
/// From this many points per realization on, there are enough tiles to fill a large GPU with wide workgroups.
const WIDE_FROM_POINTS: u64 = 1 << 15;
/// A job is at most this many tiles, and a dispatch has about this many jobs where the work allows.
const MAX_STEPS: u32 = 64;
const JOBS_WANTED: u64 = 4096;

/// The kernel for a plan on a device with `limit` bytes of workgroup memory.
pub(super) fn spec(plan: &PairPlan, limit: u32) -> KernelSpec {
    let workgroup = if plan.shape.max_points >= WIDE_FROM_POINTS { 128 } else { 64 };
    let (dim, bins) = (plan.domain.dim() as u32, plan.bins.len() as u32);
    let tile = POINTS_PER_LANE * workgroup;
    let mut files = vec![kernel::WIDE_INTEGERS];
    files.push(if plan.domain.periods()[..dim as usize].iter().all(|&p| p == 0) {
        kernel::TORUS_CUBIC
    } else {
        kernel::TORUS_BOX
    });
    let mut overrides =
        vec![("WORKGROUP", workgroup), ("DIM", dim), ("BINS", bins), ("TILE", tile), ("TILE_WORDS", dim * tile)];
    let bindings = match plan.filter {
        BinFilter::Linear { .. } => {
            files.push(kernel::BINS_LINEAR);
            PAIR_LINEAR
        }
        BinFilter::Table(_) => {
            files.push(kernel::BINS_TABLE);
            overrides.push(("CELL_SHIFT", BinTable::CELL_SHIFT));
            PAIR_TABLE
        }
    };
    if 4 * u64::from(bins) + u64::from(4 * dim * tile) <= u64::from(limit) {
        let mut copies = 1;
        while copies < MAX_COPIES && 2 * copies * bins * 4 <= COPIES_BYTES.min(limit - 4 * dim * tile) {
            copies *= 2;
        }
        files.push(kernel::HISTOGRAM_WORKGROUP);
        overrides.extend([("COPIES", copies), ("HISTOGRAM_WORDS", bins * copies)]);
    } else {
        files.push(kernel::HISTOGRAM_GLOBAL);
    }
    files.push(kernel::PAIR_COUNTS);
    KernelSpec { name: NAME, files, overrides, bindings }
}

/// Jobs submitted together, whose realizations have one histogram each.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dispatch {
    pub(super) realizations: Range<usize>,
    pub(super) jobs: Vec<PairJob>,
}

/// Cuts the pairs of realizations with `sizes` points into dispatches of at most `pairs` pairs (or one job, where that is
/// more), `points` points, `bins_total` bins and `MAX_GROUPS` jobs.
pub(super) fn dispatches(sizes: &[usize], tile: u32, pairs: u64, points: usize, histograms: usize) -> Vec<Dispatch> {
    let tiles = |n: usize| n.div_ceil(tile as usize) as u32;
    // Tile `a` meets tiles a, a + 1, .. a + t/2 (mod t). For even t the last of them meets it, too: half of them skip it.
    let steps = |t: u32, a: u32| if t.is_multiple_of(2) && a >= t / 2 { t / 2 } else { t / 2 + 1 };
    let work = |t: u32| (0..t).map(|a| u64::from(steps(t, a))).sum::<u64>();
    let pairs_per_step = u64::from(tile) * u64::from(tile);
    let total: u64 = sizes.iter().map(|&n| work(tiles(n))).sum();
    let job_steps = (total / JOBS_WANTED).min(pairs / pairs_per_step).clamp(1, u64::from(MAX_STEPS)) as u32;

    let mut all = Vec::new();
    let mut current = Dispatch { realizations: 0..0, jobs: Vec::new() };
    let (mut current_pairs, mut current_points) = (0, 0);
    let close = |current: &mut Dispatch, next: usize, all: &mut Vec<Dispatch>| {
        let done = std::mem::replace(current, Dispatch { realizations: next..next, jobs: Vec::new() });
        if !done.jobs.is_empty() {
            all.push(done);
        }
    };
    for (k, &n) in sizes.iter().enumerate() {
        // Fewer than two points are no pairs, but they lie within the range of a dispatch.
        let t = if n < 2 { 0 } else { tiles(n) };
        let whole = work(t) * pairs_per_step;
        let full = current_pairs + whole > pairs
            || current_points + n > points
            || k - current.realizations.start >= histograms
            || current.jobs.len() + t as usize * (t / 2 + 1).div_ceil(job_steps) as usize > MAX_GROUPS as usize;
        if full {
            close(&mut current, k, &mut all);
            (current_pairs, current_points) = (0, 0);
        }
        current.realizations.end = k + 1;
        let mut first_point = current_points;
        for a in 0..t {
            let mut first_step = 0;
            while first_step < steps(t, a) {
                let count = job_steps.min(steps(t, a) - first_step);
                let cost = u64::from(count) * pairs_per_step;
                let over = current_pairs + cost > pairs || current.jobs.len() >= MAX_GROUPS as usize;
                if over && !current.jobs.is_empty() {
                    close(&mut current, k, &mut all);
                    current.realizations = k..k + 1;
                    (current_pairs, current_points, first_point) = (0, 0, 0);
                }
                current.jobs.push(PairJob {
                    first_point: first_point as u32,
                    points: n as u32,
                    tile: a,
                    first_step,
                    steps: count,
                    histogram: (k - current.realizations.start) as u32,
                });
                current_pairs += cost;
                first_step += count;
            }
        }
        current_points += n;
    }
    close(&mut current, sizes.len(), &mut all);
    all
}

/// The nearest multiple of 2^32, modulo the period (0 stands for 2^64), in units of 2^32.
fn rounded(position: u64, period: u64) -> u32 {
    let round = |v: u64| (v.wrapping_add(1 << 31) >> 32) as u32;
    let (position, period) = (round(position), round(period));
    if position == period { 0 } else { position }
}

/// Why a plan cannot run on a device whose buffers hold `binding_bytes`.
pub(super) fn supports(plan: &PairPlan, binding_bytes: u64) -> Result<(), String> {
    if plan.masses {
        return Err("weights of points are not computed on the GPU".into());
    }
    if plan.weighted() || plan.border() {
        return Err(format!("{} weights are not computed on the GPU", plan.correction));
    }
    fits(plan.shape.max_points, plan.domain.dim(), binding_bytes)
}

pub(super) fn fits(points: u64, dim: usize, binding_bytes: u64) -> Result<(), String> {
    let bytes = points.saturating_mul(8 * dim as u64);
    if bytes > binding_bytes || points > u64::from(u32::MAX) / 8 {
        return Err(format!("{points} points need {bytes} bytes in one buffer, the device has {binding_bytes}"));
    }
    Ok(())
}

pub(super) fn pair_counts(
    compute: &GpuCompute,
    plan: &PairPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<PairCounts> {
    let gpu = compute.gpu();
    let tuning: &Tuning = &compute.tuning;
    let (dim, bins) = (plan.domain.dim(), plan.bins.len());
    let realizations = ensemble.realizations();
    let binding_bytes = gpu.limits.max_storage_buffer_binding_size;
    let sizes: Vec<usize> = (0..realizations).map(|k| ensemble.points_in(k)).collect();
    supports(plan, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;
    let largest = sizes.iter().copied().max().unwrap_or(0);
    fits(largest as u64, dim, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;

    let kernel = compute.kernel(spec(plan, gpu.limits.max_compute_workgroup_storage_size))?;
    let tile = kernel.spec().overrides.iter().find(|o| o.0 == "TILE").map_or(1, |o| o.1);
    let buffer_bytes = tuning.buffer_bytes.min(binding_bytes);
    let point_cap = (buffer_bytes / (8 * dim as u64)) as usize;
    let histogram_cap = (buffer_bytes / (4 * bins as u64)).max(1) as usize;
    // A bin is u32: fewer than 2^32 pairs may be looked at before it is read.
    let pair_cap = tuning.pairs_per_dispatch.min(u64::from(u32::MAX));
    let work = dispatches(&sizes, tile, pair_cap, point_cap, histogram_cap);

    let periods = plan.domain.periods();
    let mut params = PairParams {
        period_rounded: std::array::from_fn(|a| periods.get(a).map_or(0, |&p| (p.wrapping_add(1 << 31) >> 32) as u32)),
        period_low: std::array::from_fn(|a| periods.get(a).map_or(0, |&p| p as u32)),
        period_high: std::array::from_fn(|a| periods.get(a).map_or(0, |&p| (p >> 32) as u32)),
        ..PairParams::default()
    };
    let limbs = |t: &u128| -> [u32; 4] { std::array::from_fn(|k| (t >> (32 * k)) as u32) };
    let thresholds: Vec<[u32; 4]> = plan.thresholds.iter().map(limbs).collect();
    let (mut cells, mut bounds) = (&[][..], Vec::new());
    match &plan.filter {
        BinFilter::Linear { bins_per_step, relative_guard, absolute_guard } => {
            params.bins_per_step = *bins_per_step;
            params.relative_guard = *relative_guard;
            params.absolute_guard = *absolute_guard;
        }
        BinFilter::Table(table) => {
            params.first_cell = table.first_cell;
            params.last_cell = table.cells.len() as u32 - 1;
            cells = &table.cells;
            bounds = table.low.iter().zip(&table.high).map(|(&low, &high)| [low, high]).collect();
        }
    }

    let mut counts = vec![0u64; realizations * bins];
    let mut collect = |range: Range<usize>, found: Vec<u32>| {
        for (sum, c) in counts[range.start * bins..range.end * bins].iter_mut().zip(found) {
            // Each unordered pair is two ordered ones.
            *sum += 2 * u64::from(c);
        }
    };
    let mut under_way = None;
    let mut held: Option<(Range<usize>, [wgpu::Buffer; 2])> = None;
    gpu.guarded(NAME, || {
        let thresholds = gpu.upload("thresholds", &thresholds, tuning.fill);
        let table = [gpu.upload("cells", cells, tuning.fill), gpu.upload("bounds", &bounds, tuning.fill)];
        for dispatch in &work {
            control.check()?;
            let range = dispatch.realizations.clone();
            // A large realization takes many dispatches; its points go up once.
            if held.as_ref().is_none_or(|(r, _)| *r != range) {
                drop(held.take());
                held = Some((range.clone(), upload_points(compute, ensemble, &range, periods)));
            }
            let Some((_, [rounded, exact])) = &held else { continue };
            let jobs = gpu.upload("jobs", &dispatch.jobs, tuning.fill);
            params.total_points = range.clone().map(|k| sizes[k]).sum::<usize>() as u32;
            let params = gpu.uniform("params", &params);
            let words = range.len() * bins;
            let histograms = gpu.scratch("histograms", 4 * words as u64, tuning.fill);
            let mut encoder = gpu.encoder(NAME);
            encoder.clear_buffer(&histograms, 0, None);
            let mut buffers = vec![&params, &jobs, rounded, exact, &thresholds, &histograms];
            if kernel.spec().bindings.len() > buffers.len() {
                buffers.extend(&table);
            }
            kernel.dispatch(gpu, &mut encoder, &buffers, dispatch.jobs.len() as u32);
            let read = gpu.submit_and_read::<u32>(NAME, encoder, &histograms, words);
            // One submission ahead: the device has work while the host adds up.
            if let Some((range, read)) = under_way.replace((range, read)) {
                collect(range, gpu.finish(read)?);
            }
        }
        if let Some((range, read)) = under_way {
            collect(range, gpu.finish(read)?);
        }
        Ok(())
    })?;

    let mut sums = PairCounts::new(compute.computed_by(), plan);
    for (k, &n) in sizes.iter().enumerate() {
        let counts = counts[k * bins..(k + 1) * bins].to_vec();
        sums.add(&PairHistogram::new(n as u64, counts, None));
    }
    Ok(sums)
}

/// The points of realizations `range`, axis by axis: rounded to 32 bits, and exact.
pub(super) fn upload_points(
    compute: &GpuCompute,
    ensemble: &Ensemble,
    range: &Range<usize>,
    periods: [u64; 3],
) -> [wgpu::Buffer; 2] {
    let (mut short, mut long) = (Vec::new(), Vec::new());
    let points =
        if range.is_empty() { 0..0 } else { ensemble.range(range.start).start..ensemble.range(range.end - 1).end };
    for (axis, &period) in periods.iter().enumerate().take(ensemble.domain().dim()) {
        let axis = &ensemble.all_lengths(axis)[points.clone()];
        short.extend(axis.iter().map(|&x| rounded(x, period)));
        // Low word first, as the kernel reads it.
        long.extend(axis.iter().map(|&x| [x as u32, (x >> 32) as u32]));
    }
    let fill = compute.tuning.fill;
    [compute.gpu().upload("rounded", &short, fill), compute.gpu().upload("exact", &long, fill)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pair of tiles of every realization in exactly one job, whatever the caps.
    #[test]
    fn dispatches_cover_each_pair_of_tiles_once() {
        let sizes = [0, 1, 2, 300, 256, 5000, 257, 0, 1024, 100, 1];
        for (pairs, points, histograms) in
            [(1, 1 << 20, 100), (1 << 20, 6000, 3), (1 << 40, 1 << 20, 100), (3 << 16, 1 << 20, 1)]
        {
            let mut seen = std::collections::BTreeMap::new();
            for d in dispatches(&sizes, 256, pairs, points, histograms) {
                assert!(d.jobs.len() <= MAX_GROUPS as usize);
                let evaluated: u64 = d.jobs.iter().map(|j| u64::from(j.steps) << 16).sum();
                assert!(evaluated <= pairs || (d.jobs.len() == 1 && d.jobs[0].steps == 1));
                for job in d.jobs {
                    let k = d.realizations.start + job.histogram as usize;
                    assert!(d.realizations.contains(&k));
                    assert_eq!(job.points as usize, sizes[k]);
                    let before: usize = sizes[d.realizations.start..k].iter().sum();
                    assert_eq!(job.first_point as usize, before, "realization {k}");
                    let t = sizes[k].div_ceil(256) as u32;
                    for step in job.first_step..job.first_step + job.steps {
                        let other = (job.tile + step) % t;
                        let key = (k, job.tile.min(other), job.tile.max(other));
                        *seen.entry(key).or_insert(0) += 1;
                    }
                }
            }
            let expected: usize =
                sizes.iter().filter(|&&n| n > 1).map(|n| n.div_ceil(256)).map(|t| t * (t + 1) / 2).sum();
            assert_eq!(seen.len(), expected);
            assert!(seen.values().all(|&c| c == 1));
        }
    }

    #[test]
    fn many_small_realizations_go_together() {
        let t = Tuning::new(false);
        let (points, histograms) = (t.buffer_bytes as usize / 16, t.buffer_bytes as usize / 1024);
        let all = dispatches(&[256; 10_000], 256, t.pairs_per_dispatch, points, histograms);
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].jobs.len(), 10_000);
    }

    #[test]
    fn rounding_stays_below_the_period() {
        assert_eq!(rounded(u64::MAX, 0), 0);
        assert_eq!(rounded(1 << 31, 0), 1);
        let period = (5 << 32) + (3 << 30);
        assert_eq!(rounded(period - 1, period), 0, "6 = the rounded period");
        assert_eq!(rounded(4 << 32, period), 4);
    }
}

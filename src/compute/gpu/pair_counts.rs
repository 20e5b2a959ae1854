//! Pair counts on the GPU: which kernel, which dispatches, and how its histograms become `PairCounts`. See the reference
//! for the definition and `shaders/pair_counts.wgsl` for the work itself.

use std::ops::Range;

use super::kernel::{self, KernelSpec, ShaderFile};
use super::pair_jobs::dispatches;
use super::params::{Binding, PAIR_LINEAR, PAIR_LINEAR_BORDER, PAIR_TABLE, PAIR_TABLE_BORDER, PairParams};
use super::{GpuCompute, Tuning};
use crate::accumulate::{BorderHistogram, PairCounts, PairHistogram};
use crate::compute::{Compute, Control, reference};
use crate::error::Result;
use crate::plan::{BinFilter, BinTable, Correction, PairPlan};
use crate::points::Ensemble;

const NAME: &str = "pair_counts";
/// Points in registers per invocation.
const POINTS_PER_LANE: u32 = 4;
/// Workgroup memory given to copies of the histogram, per invocation: 16 KiB for 128 of them. More would keep other workgroups
/// off the processor.
const COPIES_BYTES: u32 = 128;
/// A copy for every lane that runs in step with others (32 on most hardware) leaves none to wait for.
const MAX_COPIES: u32 = 32;
/// From this many points per realization on, there are enough tiles to fill a large GPU with wide workgroups.
const WIDE_FROM_POINTS: u64 = 1 << 15;
/// Dispatches of fewer pairs than this are not worth it.
const LEAST_PAIRS: u64 = 1 << 22;

/// The words of one histogram, and how many of them are pairs of words.
struct Layout {
    /// All words.
    words: u32,
    /// Sums of 64 bits, at the end: low halves, then high halves.
    sums: u32,
}

impl Layout {
    fn new(plan: &PairPlan) -> Self {
        let bins = plan.bins.len() as u32;
        match plan.correction {
            Correction::None => Self { words: bins, sums: 0 },
            Correction::Translation | Correction::Isotropic => Self { words: 3 * bins, sums: bins },
            Correction::Border => Self { words: 3 * bins + 1, sums: 0 },
        }
    }

    /// Words that are sums of their own.
    fn plain(&self) -> usize {
        (self.words - 2 * self.sums) as usize
    }

    /// How many sums there are.
    fn values(&self) -> usize {
        (self.words - self.sums) as usize
    }
}

/// The kernel for a plan on a device with `limit` bytes of workgroup memory.
pub(super) fn spec(plan: &PairPlan, limit: u32) -> KernelSpec {
    let workgroup = if plan.shape.max_points >= WIDE_FROM_POINTS { 128 } else { 64 };
    let (dim, tile) = (plan.domain.dim() as u32, POINTS_PER_LANE * workgroup);
    let (mut files, mut overrides, bindings) = parts(plan, workgroup, limit - 4 * dim * tile);
    files.push(kernel::PAIR_COUNTS);
    overrides.extend([("TILE", tile), ("TILE_WORDS", dim * tile)]);
    KernelSpec { name: NAME, files, overrides, bindings }
}

/// What kernels over pairs share, for workgroups with `bytes` of memory left for histograms: files, numbers, bindings.
#[allow(clippy::type_complexity, reason = "the fields of a KernelSpec")]
fn parts(
    plan: &PairPlan,
    workgroup: u32,
    bytes: u32,
) -> (Vec<ShaderFile>, Vec<(&'static str, u32)>, &'static [Binding]) {
    let (dim, bins) = (plan.domain.dim(), plan.bins.len() as u32);
    let layout = Layout::new(plan);
    let cubic = plan.domain.periods()[..dim].iter().all(|&p| p == 0);
    let mut files = vec![kernel::WIDE_INTEGERS, if cubic { kernel::TORUS_CUBIC } else { kernel::TORUS_BOX }];
    let mut overrides = vec![
        ("WORKGROUP", workgroup),
        ("DIM", dim as u32),
        ("BINS", bins),
        ("WORDS", layout.words),
        ("SUMS", layout.sums),
    ];
    let border = plan.border();
    let bindings = match plan.filter {
        BinFilter::Linear { .. } => {
            files.push(kernel::BINS_LINEAR);
            if border { PAIR_LINEAR_BORDER } else { PAIR_LINEAR }
        }
        BinFilter::Table(_) => {
            files.push(kernel::BINS_TABLE);
            overrides.push(("CELL_SHIFT", BinTable::CELL_SHIFT));
            if border { PAIR_TABLE_BORDER } else { PAIR_TABLE }
        }
    };
    if 4 * u64::from(layout.words) <= u64::from(bytes) {
        let mut copies = 1;
        while copies < MAX_COPIES && 8 * copies * layout.words <= (COPIES_BYTES * workgroup).min(bytes) {
            copies *= 2;
        }
        files.push(kernel::HISTOGRAM_WORKGROUP);
        overrides.extend([("COPIES", copies), ("HISTOGRAM_WORDS", layout.words * copies)]);
    } else {
        files.push(kernel::HISTOGRAM_GLOBAL);
    }
    match plan.correction {
        Correction::None => files.push(kernel::WEIGHTS_NONE),
        Correction::Translation => files.extend([kernel::WEIGHTS_FIXED_POINT, kernel::WEIGHTS_TRANSLATION]),
        Correction::Isotropic => files.extend([kernel::WEIGHTS_FIXED_POINT, kernel::WEIGHTS_ISOTROPIC]),
        Correction::Border => files.push(kernel::WEIGHTS_BORDER),
    }
    files.push(kernel::PAIRS);
    (files, overrides, bindings)
}

/// What one unordered pair adds to any word of a histogram, at most: the upper halves of sums count whole units.
fn largest_addend(plan: &PairPlan) -> f64 {
    let ratio = plan.bins.r_max() / plan.domain.shortest_side();
    match plan.correction {
        Correction::None => 1.0,
        // Both of its points.
        Correction::Border => 2.0,
        // Of the differences along the axes only one exceeds r / sqrt(2), and none of the rest r / sqrt(3).
        Correction::Translation => {
            (1..=plan.domain.dim()).map(|k| 1.0 / (1.0 - ratio / (k as f64).sqrt()).max(1e-9)).product()
        }
        // A circle no wider than the window crosses at most two sides, which meet: a quarter of it is inside.
        Correction::Isotropic if ratio <= 0.5 => 2.0 * 4.0,
        Correction::Isotropic => 2.0 * 100.0,
    }
}

/// How many pairs may be looked at before words of 32 bits overflow.
fn pair_limit(plan: &PairPlan) -> u64 {
    (f64::from(u32::MAX) / (1.001 * largest_addend(plan))) as u64
}

/// Why a plan cannot run on a device whose buffers hold `binding_bytes`.
pub(super) fn supports(plan: &PairPlan, binding_bytes: u64) -> Result<(), String> {
    if plan.masses {
        return Err("weights of points are not computed on the GPU".into());
    }
    if pair_limit(plan) < LEAST_PAIRS {
        let largest = largest_addend(plan);
        return Err(format!("{} weights up to {largest:.0} are too large for sums on the GPU", plan.correction));
    }
    fits(plan.shape.max_points, plan.domain.dim(), binding_bytes)
}

fn fits(points: u64, dim: usize, binding_bytes: u64) -> Result<(), String> {
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
    let dim = plan.domain.dim();
    let realizations = ensemble.realizations();
    let binding_bytes = gpu.limits.max_storage_buffer_binding_size;
    let sizes: Vec<usize> = (0..realizations).map(|k| ensemble.points_in(k)).collect();
    supports(plan, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;
    let largest = sizes.iter().copied().max().unwrap_or(0);
    fits(largest as u64, dim, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;

    let kernel = compute.kernel(spec(plan, gpu.limits.max_compute_workgroup_storage_size))?;
    let tile = kernel.spec().overrides.iter().find(|o| o.0 == "TILE").map_or(1, |o| o.1);
    let mut sums = Sums::new(plan, realizations);
    let words = sums.layout.words as usize;
    let buffer_bytes = tuning.buffer_bytes.min(binding_bytes);
    let point_cap = (buffer_bytes / (8 * dim as u64)) as usize;
    let histogram_cap = (buffer_bytes / (4 * words as u64)).max(1) as usize;
    let pair_cap = tuning.pairs_per_dispatch.min(pair_limit(plan));
    let work = dispatches(&sizes, tile, pair_cap, point_cap, histogram_cap);

    let mut params = params(plan);
    let mut under_way = None;
    let mut held: Option<(Range<usize>, Points)> = None;
    gpu.guarded(NAME, || {
        let tables = Tables::upload(compute, plan);
        for dispatch in &work {
            control.check()?;
            let range = dispatch.realizations.clone();
            // A large realization takes many dispatches; its points go up once.
            if held.as_ref().is_none_or(|(r, _)| *r != range) {
                drop(held.take());
                held = Some((range.clone(), Points::upload(compute, plan, ensemble, &range)));
            }
            let Some((_, points)) = &held else { continue };
            let jobs = gpu.upload("jobs", &dispatch.jobs, tuning.fill);
            params.total_points = range.clone().map(|k| sizes[k]).sum::<usize>() as u32;
            let params = gpu.uniform("params", &params);
            let words = range.len() * words;
            let histograms = gpu.scratch("histograms", 4 * words as u64, tuning.fill);
            let mut encoder = gpu.encoder(NAME);
            encoder.clear_buffer(&histograms, 0, None);
            let buffers = tables.bind(&params, &jobs, points, &histograms);
            kernel.dispatch(gpu, &mut encoder, &buffers, dispatch.jobs.len() as u32);
            let read = gpu.submit_and_read::<u32>(NAME, encoder, &histograms, words);
            // One submission ahead: the device has work while the host adds up.
            if let Some((range, read)) = under_way.replace((range, read)) {
                sums.add(range, &gpu.finish(read)?);
            }
        }
        if let Some((range, read)) = under_way {
            sums.add(range, &gpu.finish(read)?);
        }
        Ok(())
    })?;
    Ok(sums.finish(compute, plan, ensemble))
}

/// The numbers of a plan that every dispatch shares.
fn params(plan: &PairPlan) -> PairParams {
    let sides = plan.domain.side_steps();
    let mut params = PairParams {
        side_rounded: std::array::from_fn(|a| sides.get(a).map_or(0, |&s| (s.wrapping_add(1 << 31) >> 32) as u32)),
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
struct Tables {
    thresholds: wgpu::Buffer,
    /// Cells and bounds of a table of bins.
    bins: Vec<wgpu::Buffer>,
}

impl Tables {
    fn upload(compute: &GpuCompute, plan: &PairPlan) -> Self {
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

    /// The buffers of a dispatch in the order of `PAIR_LINEAR` and its kin.
    fn bind<'a>(
        &'a self,
        params: &'a wgpu::Buffer,
        jobs: &'a wgpu::Buffer,
        points: &'a Points,
        histograms: &'a wgpu::Buffer,
    ) -> Vec<&'a wgpu::Buffer> {
        let first = [params, jobs, &points.rounded, &points.exact, &self.thresholds, histograms];
        first.into_iter().chain(&self.bins).chain(&points.depths).collect()
    }
}

/// Points of several realizations.
struct Points {
    /// Positions rounded to 32 bits, axis by axis.
    rounded: wgpu::Buffer,
    /// Positions, axis by axis.
    exact: wgpu::Buffer,
    /// Bins whose upper edge is at most the distance from the border, for minus sampling.
    depths: Option<wgpu::Buffer>,
}

impl Points {
    fn upload(compute: &GpuCompute, plan: &PairPlan, ensemble: &Ensemble, range: &Range<usize>) -> Self {
        let (mut short, mut long) = (Vec::new(), Vec::new());
        let points =
            if range.is_empty() { 0..0 } else { ensemble.range(range.start).start..ensemble.range(range.end - 1).end };
        for (axis, &period) in plan.domain.periods().iter().enumerate().take(plan.domain.dim()) {
            let axis = &ensemble.all_lengths(axis)[points.clone()];
            short.extend(axis.iter().map(|&x| rounded(x, period)));
            // Low word first, as the kernel reads it.
            long.extend(axis.iter().map(|&x| [x as u32, (x >> 32) as u32]));
        }
        let depths: Option<Vec<u32>> =
            plan.border().then(|| range.clone().flat_map(|k| depths(plan, &ensemble.lengths(k))).collect());
        let (gpu, fill) = (compute.gpu(), compute.tuning.fill);
        Self {
            rounded: gpu.upload("rounded", &short, fill),
            exact: gpu.upload("exact", &long, fill),
            depths: depths.map(|m| gpu.upload("depths", &m, fill)),
        }
    }
}

/// Per point of a realization, the number of bins whose upper edge is at most its distance from the border.
fn depths(plan: &PairPlan, axes: &[&[u64]]) -> Vec<u32> {
    let sides = plan.domain.side_steps();
    let depth = |i| reference::depth(&plan.thresholds, reference::border_distance(axes, sides, i)) as u32;
    (0..axes[0].len()).map(depth).collect()
}

/// The nearest multiple of 2^32, modulo the period (0 stands for 2^64), in units of 2^32.
fn rounded(position: u64, period: u64) -> u32 {
    let round = |v: u64| (v.wrapping_add(1 << 31) >> 32) as u32;
    let (position, period) = (round(position), round(period));
    if position == period { 0 } else { position }
}

/// What all dispatches counted, realization by realization.
struct Sums {
    layout: Layout,
    sums: Vec<u128>,
}

impl Sums {
    fn new(plan: &PairPlan, realizations: usize) -> Self {
        let layout = Layout::new(plan);
        Self { sums: vec![0; realizations * layout.values()], layout }
    }

    /// Adds the histograms of one dispatch.
    fn add(&mut self, realizations: Range<usize>, found: &[u32]) {
        let (plain, values) = (self.layout.plain(), self.layout.values());
        for (k, words) in realizations.zip(found.chunks_exact(self.layout.words as usize)) {
            let sums = &mut self.sums[k * values..(k + 1) * values];
            for (word, sum) in sums.iter_mut().enumerate() {
                *sum += u128::from(words[word]);
                if word >= plain {
                    *sum += u128::from(words[word + self.layout.sums as usize]) << 32;
                }
            }
        }
    }

    fn finish(self, compute: &GpuCompute, plan: &PairPlan, ensemble: &Ensemble) -> PairCounts {
        let bins = plan.bins.len();
        let mut counts = PairCounts::new(compute.computed_by(), plan);
        let realizations = self.sums.chunks_exact(self.layout.values()).enumerate();
        for (k, (pairs, rest)) in realizations.map(|(k, sums)| (k, sums.split_at(bins))) {
            // Each unordered pair is two ordered ones.
            let ordered: Vec<u64> = pairs.iter().map(|&c| 2 * c as u64).collect();
            // Excesses over a weight of 1: of both orders together, or of either.
            let weights = |orders: u128| {
                let excess = rest.iter().map(|e| orders * e);
                ordered.iter().zip(excess).map(|(&c, e)| (u128::from(c) << 32) + e).collect()
            };
            let weights = match plan.correction {
                Correction::Translation => Some(weights(2)),
                Correction::Isotropic => Some(weights(1)),
                Correction::None | Correction::Border => None,
            };
            let border = plan.border().then(|| {
                let mut points = vec![0; bins];
                for depth in depths(plan, &ensemble.lengths(k)) {
                    points[..depth as usize].iter_mut().for_each(|p| *p += 1);
                }
                let (counts, ends) = rest.split_at(bins);
                let small = |sums: &[u128]| sums.iter().map(|&c| c as u64).collect();
                BorderHistogram { counts: small(counts), ends: small(ends), points }
            });
            let n = ensemble.points_in(k) as u64;
            counts.add(&PairHistogram { border, ..PairHistogram::new(n, ordered, weights) });
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_stays_below_the_period() {
        assert_eq!(rounded(u64::MAX, 0), 0);
        assert_eq!(rounded(1 << 31, 0), 1);
        let period = (5 << 32) + (3 << 30);
        assert_eq!(rounded(period - 1, period), 0, "6 = the rounded period");
        assert_eq!(rounded(4 << 32, period), 4);
    }
}

//! Pair counts, two-phase: f32 puts almost every pair into its bin, and the few whose distance is too near to an edge
//! for f32 to tell are settled by the definition in integers. Formula: see `reference`.
//!
//! 1. Coordinates are rounded to 32 bits. On a torus a wrapping difference read as i32 is then the minimum image.
//! 2. `histogram_rows` and `r2_rows` write the bin of each pair of one row into a short buffer, and list the undecided pairs.
//! 3. The buffer is scattered into a histogram (of several copies, so that equal distances in a row do not wait for each
//!    other). Computing and scattering in turns keeps both loops free of branches.
//!
//! Points are sorted by cell, and partners taken from cells nearby (`cells`; one cell where all pairs are looked at). For
//! the points of a cell, the rows, the partners are brought together in pieces of columns, which is the kernel's interface:
//! (rows, columns). The sums are integers, so any thread may take any block of points.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Cpu;
use super::histogram_rows::{Bins, Stream, count_rows, stride_of};
use super::linear_bins::LinearBins;
use super::log_bins::LogBins;
use super::pair_rows::{COLUMNS, LANES, Rows, Undecided};
use super::pair_weights::{PairWeights, PointData, WeightSums};
use super::polygon_weights::PolygonWeights;
use super::r2_rows::by_r2;
use super::simd::SimdLevel;
use super::table_bins::TableBins;
use crate::accumulate::{PairCounts, PairHistogram};
use crate::compute::Compute;
use crate::compute::cells::{Neighbourhood, SortedPoints};
use crate::control::{Control, Done};
use crate::error::Result;
use crate::plan::{BinFilter, PairPlan, PairSearch};
use crate::points::geometry;
use crate::points::{Ensemble, round32};

/// Points per block: large enough to amortise a block's overhead, small enough that a cancel is quick.
const BLOCK: usize = 128;

/// With more bins than this the sums of one realization are large, so that they are shared between threads.
const SHARED_BINS: usize = 1 << 15;

/// Histograms that take turns where bins come from a table, unless they are too large for the first-level cache.
const SCATTER_COPIES: usize = 4;

pub(super) fn pair_counts(cpu: &Cpu, plan: &PairPlan, ensemble: &Ensemble, control: &Control) -> Result<PairCounts> {
    let realizations = ensemble.realizations();
    let threads = cpu.threads();
    let filter = Filter::new(plan);
    let near = Neighbourhood::new(plan);
    let polygon = PolygonWeights::new(plan);
    let polygon = polygon.as_ref();
    let new_sums = || PairCounts::new(cpu.computed_by(), plan);
    let largest = (0..realizations).map(|k| ensemble.points_in(k)).max().unwrap_or(0);
    let next = AtomicUsize::new(0);

    // Small or many realizations: one thread each.
    if plan.bins.len() <= SHARED_BINS && (realizations >= 8 * threads || largest < 1024) {
        let parts = cpu.pool.broadcast(|_| {
            let mut sums = new_sums();
            let mut tally = Tally::new(plan, &filter);
            loop {
                control.check()?;
                let k = next.fetch_add(1, Ordering::Relaxed);
                if k >= realizations {
                    return Ok(sums);
                }
                let sorted = Sorted::new(plan, &near, ensemble, k);
                let set = Set::new(plan, &sorted, polygon);
                for block in 0..set.blocks() {
                    control.check()?;
                    tally.count(cpu.level, plan, &filter, &near, &set, block);
                }
                sums.add(&tally.take(&set));
                tally.tell(&set, control);
                control.advance(1.0 / realizations as f64);
            }
        });
        let mut sums = new_sums();
        for part in parts {
            sums.merge(&part?)?;
        }
        return Ok(sums);
    }

    let mut sums = new_sums();
    for k in 0..realizations {
        control.check()?;
        let sorted = Sorted::new(plan, &near, ensemble, k);
        let set = Set::new(plan, &sorted, polygon);
        next.store(0, Ordering::Relaxed);
        let parts = cpu.pool.broadcast(|_| {
            let mut tally = Tally::new(plan, &filter);
            loop {
                control.check()?;
                let block = next.fetch_add(1, Ordering::Relaxed);
                if block >= set.blocks() {
                    tally.tell(&set, control);
                    return Ok(tally.take(&set));
                }
                tally.count(cpu.level, plan, &filter, &near, &set, block);
                // In a grid of cells a block looks at a few around it, else at the blocks from its own on.
                let all = set.blocks() as f64;
                let part = match plan.search {
                    PairSearch::All => (2.0 * (all - block as f64) - 1.0) / all,
                    PairSearch::Cells(_) => 1.0,
                };
                control.advance(part / all / realizations as f64);
            }
        });
        let mut whole: Option<PairHistogram> = None;
        for part in parts {
            let part = part?;
            match &mut whole {
                Some(whole) => whole.merge(&part),
                None => whole = Some(part),
            }
        }
        if let Some(whole) = whole {
            sums.add(&whole);
        }
    }
    Ok(sums)
}

/// The points of one realization in the order in which they are looked at.
struct Sorted<'a> {
    points: SortedPoints,
    exact: Vec<Cow<'a, [u64]>>,
    masses: Option<Cow<'a, [f64]>>,
}

impl<'a> Sorted<'a> {
    fn new(plan: &PairPlan, near: &Neighbourhood, ensemble: &'a Ensemble, k: usize) -> Self {
        let axes = ensemble.lengths(k);
        let points = near.sort(plan, &axes);
        let exact = axes.into_iter().map(|axis| points.permuted(axis)).collect();
        let masses = ensemble.weights(k).map(|masses| points.permuted(masses));
        Self { points, exact, masses }
    }
}

/// One realization: exact coordinates, and the same rounded to 32 bits.
struct Set<'a> {
    n: usize,
    points: &'a SortedPoints,
    exact: Vec<&'a [u64]>,
    /// What weights need beside positions.
    data: PointData<'a>,
    polygon: Option<&'a PolygonWeights<'a>>,
    periods: [u64; 3],
    rounded: Vec<Vec<u32>>,
    rounded_periods: [u32; 3],
}

impl<'a> Set<'a> {
    fn new(plan: &PairPlan, sorted: &'a Sorted<'_>, polygon: Option<&'a PolygonWeights<'a>>) -> Self {
        let exact: Vec<&[u64]> = sorted.exact.iter().map(|axis| &**axis).collect();
        let periods = plan.domain.periods();
        // Periods are below 2^64 - 2^31, or 0 for 2^64 itself, except for sides that differ by less than 2^-33: those
        // round to 2^32, which 0 stands for.
        let rounded_periods = periods.map(|p| round32(p, 0));
        let rounded = exact
            .iter()
            .zip(rounded_periods)
            .map(|(axis, period)| axis.iter().map(|&v| round32(v, period)).collect())
            .collect();
        let data = PointData::new(plan, &exact, sorted.masses.as_deref());
        Self { n: exact[0].len(), points: &sorted.points, exact, data, polygon, periods, rounded, rounded_periods }
    }

    fn blocks(&self) -> usize {
        self.n.div_ceil(BLOCK)
    }
}

/// The bins of a plan as the kernels find them.
enum Filter<'a> {
    Linear(Box<LinearBins>),
    Log(Box<LogBins<'a>>),
    Table(Box<TableBins<'a, u16>>),
    /// More than a table of 16 bits holds.
    Wide(Box<TableBins<'a, u32>>),
    /// Bins that f32 cannot tell apart: all pairs with `r2` up to this are undecided.
    Near(f32),
}

impl<'a> Filter<'a> {
    fn new(plan: &'a PairPlan) -> Self {
        let edges = plan.bins.edges();
        let steps = 2f64.powi(32) / plan.domain.length_unit();
        let displaced = BinFilter::displaced(&plan.domain);
        let (bins, first, last) = (plan.bins.len(), edges[0], plan.bins.r_max());
        let width = (last - first) / bins as f64;
        // Far inside what the guards are for.
        let all = |edge: &dyn Fn(f64) -> f64| {
            edges.iter().enumerate().all(|(k, e)| (e - edge(k as f64)).abs() <= 1e-12 * last.min(e + width))
        };
        if all(&|k| first + k * width) {
            let per_step = 1.0 / (width * steps);
            if let Some(linear) = LinearBins::new(bins, per_step, first / width, displaced * per_step) {
                return Self::Linear(Box::new(linear));
            }
        }
        match &plan.filter {
            BinFilter::Table(table) => {
                let log = first > 0.0 && all(&|k| first * (last / first).powf(k / bins as f64));
                let log = log.then(|| LogBins::new(table, first * steps, last * steps, displaced)).flatten();
                let wide = || Self::Wide(Box::new(TableBins::new(table)));
                let by_table = || TableBins::narrow(table).map_or_else(wide, |narrow| Self::Table(Box::new(narrow)));
                log.map_or_else(by_table, |log| Self::Log(Box::new(log)))
            }
            // Rounding coordinates moves a difference by at most 1.5 steps per axis.
            BinFilter::Linear { .. } => Self::Near(((last * steps + 3.0).powi(2) * 1.000_01) as f32),
        }
    }

    /// Rows of pairs into `sink`, by the function of r2 that all of them have.
    fn by_r2(
        &self,
        level: SimdLevel,
        job: &Rows<'_>,
        bins: usize,
        sink: impl FnMut(usize, usize, &[u32]),
        undecided: &mut Vec<Undecided>,
    ) {
        let none = bins as u32;
        match self {
            Self::Linear(linear) => by_r2(level, job, |r2| linear.bin(r2), none, sink, undecided),
            Self::Log(log) => by_r2(level, job, |r2| log.bin(r2), none, sink, undecided),
            Self::Table(table) => by_r2(level, job, |r2| table.bin(r2), none, sink, undecided),
            Self::Wide(table) => by_r2(level, job, |r2| table.bin(r2), none, sink, undecided),
            Self::Near(beyond) => by_r2(level, job, |r2| near_bin(*beyond, bins, r2), none, sink, undecided),
        }
    }
}

/// Partners brought together: which points they are, and their rounded coordinates, with padding behind.
#[derive(Default)]
struct Columns {
    points: Vec<u32>,
    axes: [Vec<u32>; 3],
}

impl Columns {
    fn len(&self) -> usize {
        self.points.len()
    }

    fn clear(&mut self) {
        self.points.clear();
        self.axes.iter_mut().for_each(Vec::clear);
    }

    fn extend(&mut self, set: &Set<'_>, points: Range<usize>) {
        let len = self.len();
        self.points.extend(points.start as u32..points.end as u32);
        for (to, from) in self.axes.iter_mut().zip(&set.rounded) {
            to.truncate(len);
            to.extend_from_slice(&from[points.clone()]);
            to.extend_from_slice(&[0; LANES]);
        }
    }
}

/// The sums of one thread.
struct Tally {
    bins: usize,
    /// `copies` histograms of `stride` counters, short-lived.
    short: Vec<u32>,
    stride: usize,
    stream: Stream,
    /// Pairs that went into `short` since it was last emptied.
    pending: u64,
    /// Pairs that were looked at since it was told.
    seen: u64,
    counts: Vec<u64>,
    weights: Option<WeightSums>,
    undecided: Vec<Undecided>,
    columns: Columns,
    ranges: Vec<Range<usize>>,
}

impl Tally {
    fn new(plan: &PairPlan, filter: &Filter<'_>) -> Self {
        let bins = plan.bins.len();
        let (copies, stride) = match filter {
            Filter::Linear(linear) => (linear.copies(), linear.stride()),
            Filter::Log(log) => (log.copies(), log.stride()),
            Filter::Table(table) => (table.copies(), table.stride()),
            Filter::Wide(table) => (table.copies(), table.stride()),
            Filter::Near(_) => (1, stride_of(bins)),
        };
        Self {
            bins,
            short: vec![0; copies * stride],
            stride,
            stream: Stream::new(),
            pending: 0,
            seen: 0,
            counts: vec![0; bins],
            weights: WeightSums::new(plan),
            undecided: Vec::new(),
            columns: Columns::default(),
            ranges: Vec::new(),
        }
    }

    /// Counts the pairs of one block of points with their partners.
    fn count(
        &mut self,
        level: SimdLevel,
        plan: &PairPlan,
        filter: &Filter<'_>,
        near: &Neighbourhood,
        set: &Set<'_>,
        block: usize,
    ) {
        let mut columns = std::mem::take(&mut self.columns);
        let mut ranges = std::mem::take(&mut self.ranges);
        for (cell, rows) in set.points.runs(block * BLOCK..((block + 1) * BLOCK).min(set.n)) {
            near.partners(&set.points.starts, cell, &rows, &mut ranges);
            // In pieces, so that they stay in the first-level cache for all rows.
            columns.clear();
            let mut triangle = true;
            for range in &ranges {
                let mut begin = range.start;
                while begin < range.end {
                    let end = range.end.min(begin + COLUMNS - columns.len());
                    columns.extend(set, begin..end);
                    begin = end;
                    if columns.len() == COLUMNS {
                        self.count_piece(level, plan, filter, set, rows.clone(), &columns, triangle);
                        columns.clear();
                        triangle = false;
                    }
                }
            }
            if columns.len() > 0 {
                self.count_piece(level, plan, filter, set, rows, &columns, triangle);
            }
        }
        (self.columns, self.ranges) = (columns, ranges);
    }

    /// Counts the pairs of `rows` with `columns`; if these begin with the rows themselves (`triangle`), each row with
    /// those after it.
    #[expect(clippy::too_many_arguments, reason = "what is counted, how, and where")]
    fn count_piece(
        &mut self,
        level: SimdLevel,
        plan: &PairPlan,
        filter: &Filter<'_>,
        set: &Set<'_>,
        rows: Range<usize>,
        columns: &Columns,
        triangle: bool,
    ) {
        let pairs = (rows.len() * columns.len()) as u64;
        if self.pending + pairs > u64::from(u32::MAX) {
            self.empty();
        }
        self.pending += pairs;
        // A row of a triangle has those after it.
        self.seen += pairs - if triangle { (rows.len() * (rows.len() + 1) / 2) as u64 } else { 0 };
        let own: Vec<&[u32]> = set.rounded.iter().map(Vec::as_slice).collect();
        let others: Vec<&[u32]> = columns.axes.iter().map(Vec::as_slice).collect();
        let periods = set.rounded_periods;
        let job = Rows { own: &own, rows, others: &others[..own.len()], columns: columns.len(), triangle, periods };
        let bins = self.bins;
        let Self { short, stride, stream, weights, counts, undecided, .. } = self;
        if let Some(weights) = weights {
            let of_points = PairWeights::new(plan, &set.exact, &set.data, set.polygon);
            let sink = |i: usize, first: usize, slots: &[u32]| {
                for (&j, &slot) in columns.points[first..].iter().zip(slots) {
                    let bin = slot as usize;
                    if bin < bins {
                        counts[bin] += 1;
                        weights.add(&of_points, bin, i, j as usize);
                    }
                }
            };
            filter.by_r2(level, &job, bins, sink, undecided);
            for pair in undecided.drain(..) {
                let (i, j) = (pair.i as usize, columns.points[pair.column as usize] as usize);
                if let Some(bin) = settle(plan, set, i, j, pair.place) {
                    counts[bin] += 1;
                    weights.add(&of_points, bin, i, j);
                }
            }
            return;
        }
        let counted = match filter {
            Filter::Linear(linear) => count_rows(level, &job, &**linear, stream, short, undecided),
            Filter::Log(log) => count_rows(level, &job, &**log, stream, short, undecided),
            Filter::Table(table) => count_rows(level, &job, &**table, stream, short, undecided),
            Filter::Wide(table) => count_rows(level, &job, &**table, stream, short, undecided),
            Filter::Near(_) => false,
        };
        if !counted {
            let sink = |_, _, slots: &[u32]| scatter(short, *stride, slots);
            filter.by_r2(level, &job, bins, sink, undecided);
        }
        for pair in undecided.drain(..) {
            let j = columns.points[pair.column as usize] as usize;
            if let Some(bin) = settle(plan, set, pair.i as usize, j, pair.place) {
                counts[bin] += 1;
            }
        }
    }

    /// Tells of the pairs that were looked at: of each, the coordinates of a partner were read.
    fn tell(&mut self, set: &Set<'_>, control: &Control) {
        let pairs = std::mem::take(&mut self.seen);
        control.did(Done { pairs, bytes: pairs * 4 * set.rounded.len() as u64, ..Done::default() });
    }

    /// Moves the short counters into the long ones, before they can overflow.
    fn empty(&mut self) {
        self.stream.finish(&mut self.short);
        for copy in self.short.chunks_exact_mut(self.stride) {
            for (count, short) in self.counts.iter_mut().zip(&*copy) {
                *count += u64::from(*short);
            }
            copy.fill(0);
        }
        self.pending = 0;
    }

    /// The histogram of ordered pairs of `set` counted so far, leaving nothing.
    fn take(&mut self, set: &Set<'_>) -> PairHistogram {
        self.empty();
        // Every unordered pair stands for two ordered ones of the same distance.
        let counts = self.counts.iter_mut().map(|c| 2 * std::mem::take(c)).collect();
        let histogram = PairHistogram::new(set.n as u64, counts, None);
        match &mut self.weights {
            Some(weights) => weights.take(histogram, &set.data),
            None => histogram,
        }
    }
}

/// Counts into one histogram or into `SCATTER_COPIES` in turn: increments of one counter wait for each other.
#[inline(always)]
fn scatter(histograms: &mut [u32], stride: usize, slots: &[u32]) {
    let increment = |histogram: &mut [u32], slot: u32| {
        let count = &mut histogram[slot as usize];
        *count = count.wrapping_add(1);
    };
    let (rounds, rest) = slots.as_chunks::<SCATTER_COPIES>();
    if histograms.len() == stride {
        slots.iter().for_each(|&slot| increment(histograms, slot));
        return;
    }
    for round in rounds {
        for (histogram, &slot) in histograms.chunks_exact_mut(stride).zip(round) {
            increment(histogram, slot);
        }
    }
    rest.iter().for_each(|&slot| increment(histograms, slot));
}

/// No bin beyond, undecided up to there.
#[inline(always)]
fn near_bin(beyond: f32, bins: usize, r2: f32) -> (u32, bool) {
    (bins as u32, r2 <= beyond)
}

/// The bin of a pair by the definition; nearly always one of those at the edge of the bin `near`.
fn settle(plan: &PairPlan, set: &Set<'_>, i: usize, j: usize, near: u32) -> Option<usize> {
    let thresholds = &plan.thresholds;
    let r2 = geometry::squared_distance(&set.exact, set.periods, i, j);
    let first = (near as usize).min(thresholds.len() - 1).saturating_sub(1);
    for (k, edges) in thresholds[first..].windows(2).take(3).enumerate() {
        if edges[0] <= r2 && r2 < edges[1] {
            return Some(first + k);
        }
    }
    let slot = thresholds.partition_point(|&t| t <= r2);
    (1..thresholds.len()).contains(&slot).then(|| slot - 1)
}

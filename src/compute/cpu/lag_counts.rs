//! Lag counts, two-phase like pair counts: f32 puts almost every lag into its cell, and the few too near to an edge for f32
//! to tell are settled by the definition in integers. Formula: see `reference`.
//!
//! Which of the two lags of a pair is taken only matters on an edge. So the loop takes the one at hand, and each cell and
//! its mirror image are added up at the end.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::Cpu;
use super::lag_bins::Rows;
use super::lag_bins::{self, Places};
use super::pair_rows::{COLUMNS, LANES};
use super::simd::SimdLevel;
use crate::accumulate::{LagCounts, PairHistogram};
use crate::compute::Compute;
use crate::control::Control;
use crate::error::Result;
use crate::plan::LagPlan;
use crate::points::geometry;
use crate::points::{Ensemble, round32};

/// Rows per block: large enough to amortise a block's overhead, small enough that a cancel is quick.
const BLOCK: usize = 64;

/// With more cells than this the sums of one realization are large, so that they are shared between threads.
const SHARED_CELLS: usize = 1 << 15;

pub(super) fn lag_counts(cpu: &Cpu, plan: &LagPlan, ensemble: &Ensemble, control: &Control) -> Result<LagCounts> {
    let realizations = ensemble.realizations();
    let threads = cpu.threads();
    let places = Places::new(&plan.filter, &plan.grid);
    let new_sums = || LagCounts::new(cpu.computed_by(), plan);
    let largest = (0..realizations).map(|k| ensemble.points_in(k)).max().unwrap_or(0);
    let next = AtomicUsize::new(0);
    let mut sums = new_sums();

    // Small or many realizations: one thread each.
    if plan.grid.cells() <= SHARED_CELLS && (realizations >= 8 * threads || largest < 1024) {
        let parts = cpu.pool.broadcast(|_| {
            let mut sums = new_sums();
            let mut tally = Tally::new(plan, &places);
            loop {
                control.check()?;
                let k = next.fetch_add(1, Ordering::Relaxed);
                if k >= realizations {
                    return Ok(sums);
                }
                let set = Set::new(plan, ensemble, k);
                for block in 0..set.blocks() {
                    control.check()?;
                    tally.count(cpu.level, plan, &places, &set, block);
                }
                sums.add(plan, &tally.take(plan, set.n));
                control.advance(1.0 / realizations as f64);
            }
        });
        for part in parts {
            sums.merge(&part?)?;
        }
        return Ok(sums);
    }

    let mut tallies: Vec<Tally> = (0..threads).map(|_| Tally::new(plan, &places)).collect();
    for k in 0..realizations {
        control.check()?;
        let set = Set::new(plan, ensemble, k);
        next.store(0, Ordering::Relaxed);
        let count = |tally: &mut Tally| {
            while control.check().is_ok() {
                let block = next.fetch_add(1, Ordering::Relaxed);
                if block >= set.blocks() {
                    return;
                }
                tally.count(cpu.level, plan, &places, &set, block);
                // A block looks at the blocks from its own on.
                let all = set.blocks() as f64;
                control.advance((2.0 * (all - block as f64) - 1.0) / (all * all) / realizations as f64);
            }
        };
        cpu.pool.install(|| tallies.par_iter_mut().for_each(count));
        control.check()?;
        let mut whole: Option<PairHistogram> = None;
        for tally in &mut tallies {
            let part = tally.take(plan, set.n);
            match &mut whole {
                Some(whole) => whole.merge(&part),
                None => whole = Some(part),
            }
        }
        if let Some(whole) = whole {
            sums.add(plan, &whole);
        }
    }
    Ok(sums)
}

/// One realization: exact coordinates, and the same rounded to 32 bits with padding behind.
struct Set<'a> {
    n: usize,
    exact: Vec<&'a [u64]>,
    rounded: Vec<Vec<u32>>,
    periods: [u32; 3],
}

impl<'a> Set<'a> {
    fn new(plan: &LagPlan, ensemble: &'a Ensemble, k: usize) -> Self {
        let exact = ensemble.lengths(k);
        let periods = plan.domain.periods().map(|p| round32(p, 0));
        let round = |(axis, period): (&&[u64], u32)| {
            axis.iter().map(|&v| round32(v, period)).chain(std::iter::repeat_n(0, LANES)).collect()
        };
        let rounded = exact.iter().zip(periods).map(round).collect();
        Self { n: ensemble.points_in(k), exact, rounded, periods }
    }

    fn blocks(&self) -> usize {
        self.n.div_ceil(BLOCK)
    }
}

/// The sums of one thread.
struct Tally {
    /// Short-lived counters of lags as the loop found them.
    short: Vec<u32>,
    /// Pairs that went into `short` since it was last emptied.
    pending: u64,
    counts: Vec<u64>,
    undecided: Vec<(u32, u32)>,
}

impl Tally {
    fn new(plan: &LagPlan, places: &Places) -> Self {
        let counts = vec![0; plan.grid.cells()];
        Self { short: vec![0; places.counters()], pending: 0, counts, undecided: Vec::new() }
    }

    /// Counts the pairs of one block of rows with all later points.
    fn count(&mut self, level: SimdLevel, plan: &LagPlan, places: &Places, set: &Set<'_>, block: usize) {
        let axes: Vec<&[u32]> = set.rounded.iter().map(Vec::as_slice).collect();
        let rows = block * BLOCK..((block + 1) * BLOCK).min(set.n);
        // Columns in short pieces, so that they stay in the first-level cache for all rows of the block.
        for begin in (rows.start..set.n).step_by(COLUMNS) {
            let columns = begin..(begin + COLUMNS).min(set.n);
            self.make_room(&rows, &columns);
            let job = Rows { axes: &axes, periods: set.periods, rows: rows.clone(), columns };
            lag_bins::count(level, &job, places, &mut self.short, &mut self.undecided);
            for (i, j) in self.undecided.drain(..) {
                if let Some(cell) =
                    plan.grid.cell(geometry::canonical_lag(&plan.domain, &set.exact, i as usize, j as usize))
                {
                    self.counts[cell] += 1;
                }
            }
        }
    }

    /// Empties the short counters before they can overflow.
    fn make_room(&mut self, rows: &Range<usize>, columns: &Range<usize>) {
        let pairs = (rows.len() * columns.len()) as u64;
        if self.pending + pairs > u64::from(u32::MAX) {
            self.empty();
        }
        self.pending += pairs;
    }

    fn empty(&mut self) {
        for (count, short) in self.counts.iter_mut().zip(&self.short) {
            *count += u64::from(*short);
        }
        self.short.fill(0);
        self.pending = 0;
    }

    /// The histogram of ordered pairs counted so far, leaving nothing.
    fn take(&mut self, plan: &LagPlan, n: usize) -> PairHistogram {
        self.empty();
        let counts = plan.grid.with_mirror(&self.counts);
        self.counts.fill(0);
        PairHistogram::new(n as u64, counts, None)
    }
}

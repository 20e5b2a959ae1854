//! The inner loops of pair counting, once per instruction set. `unsafe` are calls across a `target_feature` boundary
//! (made after asking the processor), and loads, stores and counter updates whose bounds are asserted or clamped just
//! before.

#![expect(unsafe_code, reason = "SIMD loads and stores, and calls into functions for a detected instruction set")]

use std::ops::Range;

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::simd::SimdLevel;
use crate::plan::BinTable;

/// Columns a row kernel takes at a time.
pub(super) const COLUMNS: usize = 1024;

/// Most lanes any kernel uses; rounded coordinates have this much padding behind them.
pub(super) const LANES: usize = 16;

/// The pairs (i in `rows`, o in `0..columns`) of points with 32-bit coordinates.
pub(super) struct Rows<'a> {
    /// Per axis, the coordinates that `rows` index.
    pub(super) own: &'a [&'a [u32]],
    pub(super) rows: Range<usize>,
    /// Per axis, the coordinates of the columns, and `LANES` more behind the last one.
    pub(super) others: &'a [&'a [u32]],
    /// At most `COLUMNS` of them.
    pub(super) columns: usize,
    /// The columns begin with the rows themselves: of these, only pairs with later ones.
    pub(super) triangle: bool,
    /// Per axis, the period; 0 stands for 2^32.
    pub(super) periods: [u32; 3],
}

impl Rows<'_> {
    /// The first column of row `i`.
    #[inline(always)]
    fn first(&self, i: usize) -> usize {
        if self.triangle { i - self.rows.start + 1 } else { 0 }
    }
}

/// A pair f32 cannot decide (a row and a column), and the edge it is near to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Undecided {
    pub(super) i: u32,
    pub(super) column: u32,
    pub(super) guess: u32,
}

/// `BinFilter::Linear`, unrolled: with `t` the distance in bins, a pair is undecided iff
/// `floor(t - guard(t)) != floor(t + guard(t))`, which is the same as an edge within the guard.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    bins: u32,
    /// Bins per step, times (1 - relative guard).
    below: f32,
    /// Bins per step, times (1 + relative guard).
    above: f32,
    /// Absolute guard in bins.
    guard: f32,
    /// Distances beyond the last bin are cut to half a bin beyond `bins + lane`: clear of edges, and counted at places
    /// that differ between lanes, since increments of one counter wait for each other.
    limit: [f32; LANES],
    /// Where each lane's histogram begins.
    base: [u32; LANES],
    /// The largest index of each lane.
    last: [u32; LANES],
    /// Number of histograms the lanes share.
    pub(super) copies: usize,
    /// Counters per histogram.
    pub(super) stride: usize,
}

impl Linear {
    pub(super) fn new(bins: usize, bins_per_step: f32, relative_guard: f32, absolute_guard: f32) -> Self {
        // Copies must fit into the first-level cache beside the coordinates.
        let copies = if bins <= 1024 { 4 } else { 1 };
        let stride = (bins + LANES).next_multiple_of(16);
        let (b, g) = (f64::from(bins_per_step), f64::from(relative_guard));
        let lane = |k: usize| k as f64;
        Self {
            bins: bins as u32,
            below: (b * (1.0 - g)) as f32,
            above: (b * (1.0 + g)) as f32,
            guard: absolute_guard,
            limit: std::array::from_fn(|k| ((bins as f64 + lane(k) + 0.5) / b) as f32),
            base: std::array::from_fn(|k| (k % copies * stride) as u32),
            last: std::array::from_fn(|k| (k % copies * stride + stride - 1) as u32),
            copies,
            stride,
        }
    }

    /// The same with all lanes in one histogram, so that an index is a bin.
    pub(super) fn one_copy(&self) -> Self {
        let last = [self.stride as u32 - 1; LANES];
        Self { base: [0; LANES], last, copies: 1, ..self.clone() }
    }
}

/// Squared distance in f32, in squared steps of 2^-32.
#[inline(always)]
fn squared<const D: usize, const UNEQUAL: bool>(a: [u32; D], b: [u32; D], periods: [u32; 3]) -> f32 {
    let mut r2 = 0.0;
    for k in 0..D {
        let d = if UNEQUAL {
            let apart = a[k].abs_diff(b[k]);
            apart.min(periods[k].wrapping_sub(apart)) as i32
        } else {
            a[k].wrapping_sub(b[k]) as i32
        };
        let d = d as f32;
        r2 += d * d;
    }
    r2
}

/// Runs `$f::<D, UNEQUAL>` for the number of axes at hand.
macro_rules! by_shape {
    ($job:expr, $f:ident, $($arg:expr),*) => {
        match ($job.own.len(), $job.periods == [0; 3]) {
            (1, true) => $f::<1, false, _>($($arg),*),
            (2, true) => $f::<2, false, _>($($arg),*),
            (_, true) => $f::<3, false, _>($($arg),*),
            (1, false) => $f::<1, true, _>($($arg),*),
            (2, false) => $f::<2, true, _>($($arg),*),
            (_, false) => $f::<3, true, _>($($arg),*),
        }
    };
}

/// Bins by a function of r2 that answers with the bin and whether it is undecided, row by row, into
/// `sink(i, first column, bins)`. Undecided pairs get `no_bin`. `table` says that the function is a look-up there.
pub(super) fn by_r2(
    level: SimdLevel,
    job: &Rows<'_>,
    bin: impl Fn(f32) -> (u32, bool),
    table: Option<&BinTable>,
    no_bin: u32,
    sink: impl FnMut(usize, usize, &[u32]),
    undecided: &mut Vec<Undecided>,
) {
    let _ = level;
    #[cfg(target_arch = "x86_64")]
    if level >= SimdLevel::Avx2 {
        // SAFETY: the level was detected.
        return unsafe { by_r2_avx2(job, (bin, table, no_bin, sink), undecided) };
    }
    let _ = table;
    by_r2_any(job, (bin, None, no_bin, sink), undecided);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn by_r2_avx2<B: Fn(f32) -> (u32, bool), S: FnMut(usize, usize, &[u32])>(
    job: &Rows<'_>,
    rule: (B, Option<&BinTable>, u32, S),
    undecided: &mut Vec<Undecided>,
) {
    by_r2_any(job, rule, undecided);
}

#[inline(always)]
fn by_r2_any<B: Fn(f32) -> (u32, bool), S: FnMut(usize, usize, &[u32])>(
    job: &Rows<'_>,
    rule: (B, Option<&BinTable>, u32, S),
    undecided: &mut Vec<Undecided>,
) {
    by_shape!(job, by_r2_rows, job, rule, undecided);
}

trait R2Rule {
    fn bin(&self, r2: f32) -> (u32, bool);
    fn table(&self) -> Option<&BinTable>;
    fn no_bin(&self) -> u32;
    fn sink(&mut self, i: usize, first: usize, bins: &[u32]);
}

impl<B: Fn(f32) -> (u32, bool), S: FnMut(usize, usize, &[u32])> R2Rule for (B, Option<&BinTable>, u32, S) {
    #[inline(always)]
    fn bin(&self, r2: f32) -> (u32, bool) {
        (self.0)(r2)
    }
    #[inline(always)]
    fn table(&self) -> Option<&BinTable> {
        self.1
    }
    #[inline(always)]
    fn no_bin(&self) -> u32 {
        self.2
    }
    #[inline(always)]
    fn sink(&mut self, i: usize, first: usize, bins: &[u32]) {
        (self.3)(i, first, bins);
    }
}

#[inline(always)]
fn by_r2_rows<const D: usize, const UNEQUAL: bool, R: R2Rule>(
    job: &Rows<'_>,
    mut rule: R,
    undecided: &mut Vec<Undecided>,
) {
    let mut r2 = [0f32; COLUMNS];
    let mut slots = [0u32; COLUMNS];
    let mut flagged = [0u32; COLUMNS + 1];
    for i in job.rows.clone() {
        let first = job.first(i);
        let len = job.columns.saturating_sub(first);
        let own: [u32; D] = std::array::from_fn(|k| job.own[k][i]);
        let others: [&[u32]; D] = std::array::from_fn(|k| &job.others[k][first..first + len]);
        for (o, r2) in r2[..len].iter_mut().enumerate() {
            *r2 = squared::<D, UNEQUAL>(own, std::array::from_fn(|k| others[k][o]), job.periods);
        }
        let mut flags = 0;
        if let Some(table) = rule.table() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: there is a table only where AVX2 was detected.
            unsafe {
                flags = look_up_avx2(table, rule.no_bin(), &r2, len, &mut slots, &mut flagged);
            }
            let _ = table;
        } else {
            // Listed without a branch, since a table's answers are as good as random.
            for (o, (slot, &r2)) in slots[..len].iter_mut().zip(&r2).enumerate() {
                let (bin, unsure) = rule.bin(r2);
                *slot = bin;
                flagged[flags] = o as u32;
                flags += usize::from(unsure);
            }
        }
        for &o in &flagged[..flags] {
            let slot = &mut slots[o as usize];
            let guess = slot.wrapping_add(1);
            undecided.push(Undecided { i: i as u32, column: first as u32 + o, guess });
            *slot = rule.no_bin();
        }
        rule.sink(i, first, &slots[..len]);
    }
}

/// `BinFilter::Table` for the first `len` of `r2`: bins into `slots`, the places of undecided ones into `flagged`, whose
/// number is returned.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn look_up_avx2(
    table: &BinTable,
    no_bin: u32,
    r2: &[f32; COLUMNS],
    len: usize,
    slots: &mut [u32; COLUMNS],
    flagged: &mut [u32; COLUMNS + 1],
) -> usize {
    assert!(!table.cells.is_empty() && table.low.len() == table.high.len() && !table.low.is_empty());
    let first_cell = _mm256_set1_epi32(table.first_cell as i32);
    let last_cell = _mm256_set1_epi32(table.cells.len() as i32 - 1);
    let last_edge = _mm256_set1_epi32(table.low.len() as i32 - 1);
    let no_bin = _mm256_set1_epi32(no_bin as i32);
    let zero = _mm256_setzero_si256();
    let mut masks = [0u8; COLUMNS / 8];
    let eights = r2.as_chunks::<8>().0.iter().zip(slots.as_chunks_mut::<8>().0).zip(&mut masks);
    // What lies beyond `len` in the last eight is looked up too, and ignored.
    for ((r2, slots), mask) in eights.take(len.div_ceil(8)) {
        // SAFETY: eight values each; cells and edges are cut to the ends of their arrays just before.
        unsafe {
            let r2 = _mm256_loadu_ps(r2.as_ptr());
            let bits = _mm256_srli_epi32::<{ BinTable::CELL_SHIFT as i32 }>(_mm256_castps_si256(r2));
            let cell = _mm256_sub_epi32(_mm256_max_epu32(bits, first_cell), first_cell);
            let cell = _mm256_min_epu32(cell, last_cell);
            let edge = _mm256_i32gather_epi32::<4>(table.cells.as_ptr().cast(), cell);
            // The mark of a search is the sign bit.
            let e = _mm256_min_epu32(edge, last_edge);
            let low = _mm256_i32gather_ps::<4>(table.low.as_ptr(), e);
            let high = _mm256_i32gather_ps::<4>(table.high.as_ptr(), e);
            let above = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GT_OQ>(r2, high));
            let below = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(r2, low));
            let decided = _mm256_andnot_si256(_mm256_cmpgt_epi32(zero, edge), _mm256_or_si256(above, below));
            // Slot e + above is bin e + above - 1; `above` is 0 or -1.
            let bin = _mm256_sub_epi32(_mm256_add_epi32(e, _mm256_set1_epi32(-1)), above);
            _mm256_storeu_si256(slots.as_mut_ptr().cast(), _mm256_min_epu32(bin, no_bin));
            *mask = !_mm256_movemask_ps(_mm256_castsi256_ps(decided)) as u8;
        }
    }
    let mut flags = 0;
    for (eight, &mask) in masks[..len.div_ceil(8)].iter().enumerate() {
        let mut mask = mask;
        while mask != 0 {
            let o = 8 * eight + mask.trailing_zeros() as usize;
            mask &= mask - 1;
            if o < len {
                flagged[flags] = o as u32;
                flags += 1;
            }
        }
    }
    flags
}

/// Linear bins, row by row, into `sink(i, first column, indices)`.
pub(super) fn linear(
    level: SimdLevel,
    job: &Rows<'_>,
    linear: &Linear,
    mut sink: impl FnMut(usize, usize, &[u32]),
    undecided: &mut Vec<Undecided>,
) {
    run_linear(level, job, linear, &mut sink, undecided);
}

/// Linear bins into the histograms of `linear`.
pub(super) fn linear_histogram(
    level: SimdLevel,
    job: &Rows<'_>,
    linear: &Linear,
    histogram: &mut [u32],
    undecided: &mut Vec<Undecided>,
) {
    assert!(histogram.len() >= linear.copies * linear.stride, "one histogram per copy");
    let mut sink = |_: usize, _: usize, slots: &[u32]| {
        let mut increment = |slot: u32| {
            debug_assert!((slot as usize) < histogram.len(), "indices are cut to `last`");
            // SAFETY: every kernel cuts its indices to `linear.last`, which is below copies * stride.
            let count = unsafe { histogram.get_unchecked_mut(slot as usize) };
            *count = count.wrapping_add(1);
        };
        // By eights: one store per cycle is the limit, which a loop of one increment does not reach.
        let (eights, rest) = slots.as_chunks::<8>();
        for eight in eights {
            eight.iter().for_each(|&slot| increment(slot));
        }
        rest.iter().for_each(|&slot| increment(slot));
    };
    run_linear(level, job, linear, &mut sink, undecided);
}

#[inline(always)]
fn run_linear<S: FnMut(usize, usize, &[u32])>(
    level: SimdLevel,
    job: &Rows<'_>,
    linear: &Linear,
    sink: &mut S,
    undecided: &mut Vec<Undecided>,
) {
    assert!(job.columns <= COLUMNS, "a piece fits the buffer");
    assert!(job.others.iter().all(|a| a.len() >= job.columns + LANES), "coordinates are padded");
    match level {
        // SAFETY: the level was detected, and the lengths were checked just now.
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx512 => unsafe { by_shape!(job, linear_avx512, job, linear, sink, undecided) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2 => unsafe { by_shape!(job, linear_avx2, job, linear, sink, undecided) },
        _ => by_shape!(job, linear_portable, job, linear, sink, undecided),
    }
}

#[inline(always)]
fn linear_portable<const D: usize, const UNEQUAL: bool, S: FnMut(usize, usize, &[u32])>(
    job: &Rows<'_>,
    linear: &Linear,
    sink: &mut S,
    undecided: &mut Vec<Undecided>,
) {
    let mut slots = [0u32; COLUMNS + LANES];
    let mut upper = [0u32; COLUMNS + LANES];
    for i in job.rows.clone() {
        let first = job.first(i);
        let len = job.columns.saturating_sub(first);
        let own: [u32; D] = std::array::from_fn(|k| job.own[k][i]);
        for begin in (0..len).step_by(LANES) {
            let others: [&[u32]; D] = std::array::from_fn(|k| &job.others[k][first + begin..first + begin + LANES]);
            let (slots, upper) = (&mut slots[begin..begin + LANES], &mut upper[begin..begin + LANES]);
            for l in 0..LANES {
                let r2 = squared::<D, UNEQUAL>(own, std::array::from_fn(|k| others[k][l]), job.periods);
                let r = r2.sqrt().min(linear.limit[l]);
                slots[l] = (r * linear.below - linear.guard) as i32 as u32;
                upper[l] = (r * linear.above + linear.guard) as i32 as u32;
            }
        }
        for o in 0..len {
            let (lower, lane) = (slots[o], o % LANES);
            let index = if lower == upper[o] {
                lower
            } else {
                let guess = lower.wrapping_add(1);
                undecided.push(Undecided { i: i as u32, column: (first + o) as u32, guess });
                linear.bins
            };
            slots[o] = (linear.base[lane] + index.min(linear.stride as u32 - 1)).min(linear.last[lane]);
        }
        sink(i, first, &slots[..len]);
    }
}

/// Lists the lanes set in `mask` as undecided and takes them out of the histogram.
#[cfg(target_arch = "x86_64")]
#[cold]
#[inline(never)]
fn set_aside(
    mut mask: u32,
    i: usize,
    first: usize,
    linear: &Linear,
    slots: &mut [u32],
    left: usize,
    undecided: &mut Vec<Undecided>,
) {
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        let base = linear.base[lane % 8];
        let guess = slots[lane].wrapping_sub(base).wrapping_add(1);
        slots[lane] = base + linear.bins;
        if lane < left {
            undecided.push(Undecided { i: i as u32, column: (first + lane) as u32, guess });
        }
    }
}

/// # Safety
/// AVX2 and FMA; `job.others` hold `LANES` more than the last column; at most `COLUMNS` columns.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn linear_avx2<const D: usize, const UNEQUAL: bool, S: FnMut(usize, usize, &[u32])>(
    job: &Rows<'_>,
    linear: &Linear,
    sink: &mut S,
    undecided: &mut Vec<Undecided>,
) {
    let mut slots = [0u32; COLUMNS + LANES];
    // Where groups of 16 with undecided pairs begin: kept for later, so that the loop has no branches or calls.
    let mut flagged = [0u32; COLUMNS / 16 + 1];
    let below = _mm256_set1_ps(linear.below);
    let above = _mm256_set1_ps(linear.above);
    let guard = _mm256_set1_ps(linear.guard);
    // SAFETY: the arrays have 16 elements.
    let (limit, base, last) = unsafe {
        (
            _mm256_loadu_ps(linear.limit.as_ptr()),
            _mm256_loadu_si256(linear.base.as_ptr().cast()),
            _mm256_loadu_si256(linear.last.as_ptr().cast()),
        )
    };
    let periods = job.periods.map(|p| _mm256_set1_epi32(p as i32));
    for i in job.rows.clone() {
        let first = job.first(i);
        if first >= job.columns {
            continue;
        }
        let len = job.columns - first;
        let own: [__m256i; D] = std::array::from_fn(|k| _mm256_set1_epi32(job.own[k][i] as i32));
        // The index of 8 pairs, and which of them are undecided (lanes of ones where decided).
        let eight = |o: usize| {
            let mut r2 = _mm256_setzero_ps();
            for k in 0..D {
                // SAFETY: `first + o + 8` is at most `columns + 15`.
                let other = unsafe { _mm256_loadu_si256(job.others[k].as_ptr().add(first + o).cast()) };
                let d = if UNEQUAL {
                    let apart = _mm256_sub_epi32(_mm256_max_epu32(own[k], other), _mm256_min_epu32(own[k], other));
                    _mm256_min_epu32(apart, _mm256_sub_epi32(periods[k], apart))
                } else {
                    _mm256_sub_epi32(own[k], other)
                };
                let d = _mm256_cvtepi32_ps(d);
                r2 = if k == 0 { _mm256_mul_ps(d, d) } else { _mm256_fmadd_ps(d, d, r2) };
            }
            let r = _mm256_min_ps(_mm256_sqrt_ps(r2), limit);
            let lower = _mm256_cvttps_epi32(_mm256_fmsub_ps(r, below, guard));
            let upper = _mm256_cvttps_epi32(_mm256_fmadd_ps(r, above, guard));
            (_mm256_min_epu32(_mm256_add_epi32(lower, base), last), _mm256_cmpeq_epi32(lower, upper))
        };
        let mut flags = 0;
        for o in (0..len).step_by(16) {
            let (index0, decided0) = eight(o);
            let (index1, decided1) = eight(o + 8);
            // SAFETY: `o + 16` is at most `COLUMNS + LANES`.
            unsafe {
                let to = slots.as_mut_ptr().add(o);
                _mm256_storeu_si256(to.cast(), index0);
                _mm256_storeu_si256(to.add(8).cast(), index1);
            }
            let decided = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_and_si256(decided0, decided1)));
            flagged[flags] = o as u32;
            flags += usize::from(decided != 0xff);
        }
        for &o in &flagged[..flags] {
            let o = o as usize;
            let [mask0, mask1] =
                [eight(o).1, eight(o + 8).1].map(|d| !_mm256_movemask_ps(_mm256_castsi256_ps(d)) as u32 & 0xff);
            set_aside(mask0 | mask1 << 8, i, first + o, linear, &mut slots[o..o + 16], len - o, undecided);
        }
        sink(i, first, &slots[..len]);
    }
}

/// # Safety
/// AVX-512 F; `job.others` hold `LANES` more than the last column; at most `COLUMNS` columns.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
unsafe fn linear_avx512<const D: usize, const UNEQUAL: bool, S: FnMut(usize, usize, &[u32])>(
    job: &Rows<'_>,
    linear: &Linear,
    sink: &mut S,
    undecided: &mut Vec<Undecided>,
) {
    let mut slots = [0u32; COLUMNS + LANES];
    // Where groups of 16 with undecided pairs begin: kept for later, so that the loop has no branches or calls.
    let mut flagged = [0u32; COLUMNS / 16 + 1];
    let below = _mm512_set1_ps(linear.below);
    let above = _mm512_set1_ps(linear.above);
    let guard = _mm512_set1_ps(linear.guard);
    // Both halves alike, so that lane k and k + 8 share a histogram, as with 8 lanes.
    // SAFETY: the arrays have 16 elements.
    let (limit, base, last) = unsafe {
        (
            _mm512_loadu_ps(linear.limit.as_ptr()),
            _mm512_loadu_si512(linear.base.as_ptr().cast()),
            _mm512_loadu_si512(linear.last.as_ptr().cast()),
        )
    };
    let periods = job.periods.map(|p| _mm512_set1_epi32(p as i32));
    for i in job.rows.clone() {
        let first = job.first(i);
        if first >= job.columns {
            continue;
        }
        let len = job.columns - first;
        let own: [__m512i; D] = std::array::from_fn(|k| _mm512_set1_epi32(job.own[k][i] as i32));
        // The index of 16 pairs, and which of them are undecided.
        let sixteen = |o: usize| {
            let mut r2 = _mm512_setzero_ps();
            for k in 0..D {
                // SAFETY: `first + o + 16` is at most `columns + 15`.
                let other = unsafe { _mm512_loadu_si512(job.others[k].as_ptr().add(first + o).cast()) };
                let d = if UNEQUAL {
                    let apart = _mm512_sub_epi32(_mm512_max_epu32(own[k], other), _mm512_min_epu32(own[k], other));
                    _mm512_min_epu32(apart, _mm512_sub_epi32(periods[k], apart))
                } else {
                    _mm512_sub_epi32(own[k], other)
                };
                let d = _mm512_cvtepi32_ps(d);
                r2 = if k == 0 { _mm512_mul_ps(d, d) } else { _mm512_fmadd_ps(d, d, r2) };
            }
            let r = _mm512_min_ps(_mm512_sqrt_ps(r2), limit);
            let lower = _mm512_cvttps_epi32(_mm512_fmsub_ps(r, below, guard));
            let upper = _mm512_cvttps_epi32(_mm512_fmadd_ps(r, above, guard));
            let index = _mm512_min_epu32(_mm512_add_epi32(lower, base), last);
            (index, u32::from(_mm512_cmpneq_epi32_mask(lower, upper)))
        };
        let mut flags = 0;
        for o in (0..len).step_by(16) {
            let (index, mask) = sixteen(o);
            // SAFETY: `o + 16` is at most `COLUMNS + LANES`.
            unsafe { _mm512_storeu_si512(slots.as_mut_ptr().add(o).cast(), index) };
            flagged[flags] = o as u32;
            flags += usize::from(mask != 0);
        }
        for &o in &flagged[..flags] {
            let o = o as usize;
            set_aside(sixteen(o).1, i, first + o, linear, &mut slots[o..o + 16], len - o, undecided);
        }
        sink(i, first, &slots[..len]);
    }
}

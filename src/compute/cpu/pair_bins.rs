//! The inner loops of pair counting, once per instruction set. `unsafe` are calls across a `target_feature` boundary
//! (made after asking the processor), and loads, stores and counter updates whose bounds are asserted or clamped just
//! before.

#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "SIMD loads and stores, and calls into functions for a detected instruction set")
)]

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

/// A pair f32 cannot decide (a row and a column), and the place in the histogram where it was counted or, if it was not
/// (`by_r2`), a bin at the edge in question.
#[derive(Debug, Clone, Copy)]
pub(super) struct Undecided {
    pub(super) i: u32,
    pub(super) column: u32,
    pub(super) place: u32,
}

/// Relative error of the distance in bins: five roundings of 2^-24 in r^2 (conversion twice, product, two sums) are half
/// as many in r; the root, the bins per step and the product are one each. Together 5.5 2^-24, below this.
const RELATIVE_ERROR: f64 = 3.3e-7;

/// `BinFilter::Linear` in fixed point. With `t` the distance in bins, f32 rounds `t + 2^e` to `f = 23 - e` bits behind the
/// point, if `2^e` is beyond all bins; these bits say which bin it is and how near an edge. Adding the guard first makes
/// the undecided ones those with fraction bits below twice the guard, and with the guard a power of two these are the
/// ones without any of the bits above.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    bins: u32,
    bins_per_step: f32,
    /// `2^e + guard`.
    shift: f32,
    /// `f`.
    fraction_bits: u32,
    /// The bits that undecided pairs lack.
    clear: u32,
    /// Smaller distances are raised to this one, clear of the edge at 0, which no distance is below.
    least: f32,
    /// Distances beyond the last bin are cut to half a bin beyond `bins + lane`: clear of edges, and counted at places
    /// that differ between lanes, since increments of one counter wait for each other.
    limit: [f32; LANES],
    /// Where each lane's histogram begins, less what `2^e` adds.
    base: [u32; LANES],
    /// Number of histograms the lanes share.
    pub(super) copies: usize,
    /// Counters per histogram.
    pub(super) stride: usize,
}

impl Linear {
    /// `None` where f32 decides too little: a guard of more than a quarter of a bin.
    pub(super) fn new(bins: usize, bins_per_step: f32, absolute_guard: f32) -> Option<Self> {
        // Copies must fit into the first-level cache beside the coordinates.
        let copies = if bins <= 1024 { 4 } else { 1 };
        let stride = (bins + LANES).next_multiple_of(16);
        let exponent = stride.next_power_of_two().ilog2();
        let fraction_bits = 23 - exponent;
        let unit = 0.5f64.powi(fraction_bits as i32);
        let guard = RELATIVE_ERROR * bins as f64 + f64::from(absolute_guard);
        // Bins far below a step have an infinite guard, or none that is a number.
        if guard.is_nan() || guard > 0.25 {
            return None;
        }
        // Rounding to the unit adds half of one.
        let units = ((guard / unit + 0.5).ceil() as u32).next_power_of_two();
        if f64::from(units) * unit > 0.25 {
            return None;
        }
        let b = f64::from(bins_per_step);
        let one = 2f32.powi(exponent as i32);
        let linear = Self {
            bins: bins as u32,
            bins_per_step,
            shift: one + units as f32 * unit as f32,
            fraction_bits,
            clear: ((1 << fraction_bits) - 1) & !(2 * units - 1),
            least: (1.25 * f64::from(units) * unit / b) as f32,
            limit: std::array::from_fn(|k| ((bins as f64 + k as f64 + 0.5) / b) as f32),
            base: std::array::from_fn(|k| ((k % copies * stride) as u32).wrapping_sub(one.to_bits() >> fraction_bits)),
            copies,
            stride,
        };
        // All indices grow with the distance, which is cut to these.
        let within = |k: usize| linear.index(linear.limit[k], k).0 < (copies * stride) as u32;
        assert!((0..LANES).all(within), "indices are below {copies} * {stride}");
        Some(linear)
    }

    /// The index of a distance between `least` and `limit[lane]`, and whether it is undecided.
    #[inline(always)]
    fn index(&self, r: f32, lane: usize) -> (u32, bool) {
        let bits = (r * self.bins_per_step + self.shift).to_bits();
        ((bits >> self.fraction_bits).wrapping_add(self.base[lane]), bits & self.clear == 0)
    }

    /// The bin of a squared distance (`bins` for none), and whether it is undecided.
    #[inline(always)]
    pub(super) fn bin(&self, r2: f32) -> (u32, bool) {
        let (bin, undecided) = self.index(r2.sqrt().max(self.least).min(self.limit[0]), 0);
        (bin.min(self.bins), undecided)
    }
}

/// Indices on their way into histograms: those of one row are counted while those of the next are computed, since
/// arithmetic and counting use different parts of a processor.
pub(super) struct Stream {
    /// Two rows that take turns, with the 15 indices that may be left of the one before.
    rows: Box<[[u32; COLUMNS + 512]; 2]>,
    /// Which of them is to be counted, and how many indices it holds.
    turn: usize,
    written: usize,
}

impl Stream {
    pub(super) fn new() -> Self {
        Self { rows: Box::new([[0; COLUMNS + 512]; 2]), turn: 0, written: 0 }
    }

    /// Counts what is left.
    pub(super) fn finish(&mut self, histogram: &mut [u32]) {
        for &index in &self.rows[self.turn][..self.written] {
            let count = &mut histogram[index as usize];
            *count = count.wrapping_add(1);
        }
        self.written = 0;
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
    ($job:expr, $f:ident $([$rule:tt])?, $($arg:expr),*) => {
        match ($job.own.len(), $job.periods == [0; 3]) {
            (1, true) => $f::<1, false $(, $rule)?>($($arg),*),
            (2, true) => $f::<2, false $(, $rule)?>($($arg),*),
            (_, true) => $f::<3, false $(, $rule)?>($($arg),*),
            (1, false) => $f::<1, true $(, $rule)?>($($arg),*),
            (2, false) => $f::<2, true $(, $rule)?>($($arg),*),
            (_, false) => $f::<3, true $(, $rule)?>($($arg),*),
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
    by_shape!(job, by_r2_rows[_], job, rule, undecided);
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
            undecided.push(Undecided { i: i as u32, column: first as u32 + o, place: *slot });
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

/// Linear bins into the histograms of `linear`, by way of `stream`. Undecided pairs are counted where they may be wrong.
/// Whether there is a kernel for it; `by_r2` does it too.
#[must_use]
#[cfg_attr(not(target_arch = "x86_64"), allow(unreachable_code, unused_variables, reason = "there is no vector loop"))]
pub(super) fn linear_histogram(
    level: SimdLevel,
    job: &Rows<'_>,
    linear: &Linear,
    stream: &mut Stream,
    histogram: &mut [u32],
    undecided: &mut Vec<Undecided>,
) -> bool {
    assert!(histogram.len() >= linear.copies * linear.stride, "one histogram per copy");
    assert!(job.columns <= COLUMNS, "a piece fits the buffer");
    assert!(job.others.iter().all(|a| a.len() >= job.columns + LANES), "coordinates are padded");
    match level {
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx512 => by_shape!(job, linear_rows[true], job, linear, stream, histogram, undecided),
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2 => by_shape!(job, linear_rows[false], job, linear, stream, histogram, undecided),
        _ => return false,
    }
    true
}

/// One point against all columns, and counting meanwhile.
#[cfg(target_arch = "x86_64")]
struct LinearRow<'a, const D: usize> {
    linear: &'a Linear,
    own: [u32; D],
    others: [*const u32; D],
    periods: [u32; 3],
    len: usize,
    /// Where indices go: room for `len` and `LANES` more.
    to: *mut u32,
    /// Indices to be counted, in groups of 16.
    from: *const u32,
    groups: usize,
    histogram: *mut u32,
}

/// Offset and mask of each 16 columns with undecided pairs among them.
#[cfg(target_arch = "x86_64")]
type Flags = [u32; COLUMNS / 16 + 1];

/// The instruction sets must have been detected, the job and the histogram checked.
#[cfg(target_arch = "x86_64")]
fn linear_rows<const D: usize, const UNEQUAL: bool, const AVX512: bool>(
    job: &Rows<'_>,
    linear: &Linear,
    stream: &mut Stream,
    histogram: &mut [u32],
    undecided: &mut Vec<Undecided>,
) {
    let mut flags: Flags = [0; _];
    for i in job.rows.clone() {
        let first = job.first(i);
        if first >= job.columns {
            continue;
        }
        let len = job.columns - first;
        let (groups, left) = (stream.written / LANES, stream.written % LANES);
        let [a, b] = &mut *stream.rows;
        let (from, to) = if stream.turn == 0 { (a, b) } else { (b, a) };
        to[..LANES].copy_from_slice(&from[LANES * groups..][..LANES]);
        let row = LinearRow::<D> {
            linear,
            own: std::array::from_fn(|k| job.own[k][i]),
            others: std::array::from_fn(|k| job.others[k][first..].as_ptr()),
            periods: job.periods,
            len,
            to: to[left..].as_mut_ptr(),
            from: from.as_ptr(),
            groups,
            histogram: histogram.as_mut_ptr(),
        };
        // SAFETY: columns are padded by `LANES`; `to` has room for 15 left, `COLUMNS` and padding; all indices of
        // `linear` are within the histogram.
        let flagged = unsafe {
            if AVX512 {
                linear_row_avx512::<D, UNEQUAL>(&row, &mut flags)
            } else {
                linear_row_avx2::<D, UNEQUAL>(&row, &mut flags)
            }
        };
        let indices = &to[left..left + len];
        for &flag in &flags[..flagged] {
            let mut mask = flag & 0xffff;
            while mask != 0 {
                let o = (flag >> 16) as usize + mask.trailing_zeros() as usize;
                mask &= mask - 1;
                // What lies beyond the row is none of its pairs.
                if let Some(&place) = indices.get(o) {
                    undecided.push(Undecided { i: i as u32, column: (first + o) as u32, place });
                }
            }
        }
        (stream.turn, stream.written) = (1 - stream.turn, left + len);
    }
}

/// Calls `$compute(o)` for every 16 columns and counts `row.groups` groups, in turns as long as there are both.
#[cfg(target_arch = "x86_64")]
macro_rules! compute_and_count {
    ($row:expr, $compute:expr) => {
        let row = $row;
        let computed = row.len.div_ceil(LANES);
        for g in 0..computed.min(row.groups) {
            $compute(LANES * g);
            count(row.from.add(LANES * g), row.histogram);
        }
        for g in row.groups..computed {
            $compute(LANES * g);
        }
        for g in computed..row.groups {
            count(row.from.add(LANES * g), row.histogram);
        }
    };
}

/// Counts 16 indices.
///
/// # Safety
/// There are 16, all below the length of the histogram.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn count(indices: *const u32, histogram: *mut u32) {
    for k in 0..LANES {
        // SAFETY: as the caller says.
        unsafe {
            let count = histogram.add(*indices.add(k) as usize);
            *count = (*count).wrapping_add(1);
        }
    }
}

/// The number of flags. Kept apart from its callers, so that constants stay in registers.
///
/// # Safety
/// AVX2 and FMA; what `LinearRow` says of its pointers.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[inline(never)]
unsafe fn linear_row_avx2<const D: usize, const UNEQUAL: bool>(row: &LinearRow<'_, D>, flags: &mut Flags) -> usize {
    let linear = row.linear;
    let bins_per_step = _mm256_set1_ps(linear.bins_per_step);
    let shift = _mm256_set1_ps(linear.shift);
    let least = _mm256_set1_ps(linear.least);
    let clear = _mm256_set1_epi32(linear.clear as i32);
    let fraction_bits = _mm256_set1_epi32(linear.fraction_bits as i32);
    let own: [__m256i; D] = row.own.map(|x| _mm256_set1_epi32(x as i32));
    let periods = row.periods.map(|p| _mm256_set1_epi32(p as i32));
    // The indices of 8 pairs, and which of them are undecided.
    let eight = |o: usize, lane: usize| {
        let mut r2 = _mm256_setzero_ps();
        for k in 0..D {
            // SAFETY: columns are padded.
            let other = unsafe { _mm256_loadu_si256(row.others[k].add(o + lane).cast()) };
            let d = if UNEQUAL {
                let apart = _mm256_sub_epi32(_mm256_max_epu32(own[k], other), _mm256_min_epu32(own[k], other));
                _mm256_min_epu32(apart, _mm256_sub_epi32(periods[k], apart))
            } else {
                _mm256_sub_epi32(own[k], other)
            };
            let d = _mm256_cvtepi32_ps(d);
            r2 = if k == 0 { _mm256_mul_ps(d, d) } else { _mm256_fmadd_ps(d, d, r2) };
        }
        // SAFETY: the arrays have 16 elements, `lane` is 0 or 8; there is room for 16 indices.
        unsafe {
            let limit = _mm256_loadu_ps(linear.limit.as_ptr().add(lane));
            let base = _mm256_loadu_si256(linear.base.as_ptr().add(lane).cast());
            let r = _mm256_min_ps(_mm256_max_ps(_mm256_sqrt_ps(r2), least), limit);
            let bits = _mm256_castps_si256(_mm256_fmadd_ps(r, bins_per_step, shift));
            let index = _mm256_add_epi32(_mm256_srlv_epi32(bits, fraction_bits), base);
            _mm256_storeu_si256(row.to.add(o + lane).cast(), index);
            let near = _mm256_cmpeq_epi32(_mm256_and_si256(bits, clear), _mm256_setzero_si256());
            _mm256_movemask_ps(_mm256_castsi256_ps(near)) as u32
        }
    };
    let mut flagged = 0;
    let mut sixteen = |o: usize| {
        let mask = eight(o, 0) | eight(o, 8) << 8;
        // A branch, since a store whose place hangs on the mask would hold up the counting that comes after it.
        if mask != 0 {
            // SAFETY: at most one flag per 16 columns.
            unsafe { *flags.get_unchecked_mut(flagged) = (o as u32) << 16 | mask };
            flagged += 1;
        }
    };
    // SAFETY: `row` says so.
    unsafe {
        compute_and_count!(row, sixteen);
    }
    flagged
}

/// The number of flags.
///
/// # Safety
/// AVX-512 F and DQ; what `LinearRow` says of its pointers.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
#[inline(never)]
unsafe fn linear_row_avx512<const D: usize, const UNEQUAL: bool>(row: &LinearRow<'_, D>, flags: &mut Flags) -> usize {
    let linear = row.linear;
    let bins_per_step = _mm512_set1_ps(linear.bins_per_step);
    let shift = _mm512_set1_ps(linear.shift);
    let least = _mm512_set1_ps(linear.least);
    let clear = _mm512_set1_epi32(linear.clear as i32);
    let fraction_bits = _mm512_set1_epi32(linear.fraction_bits as i32);
    // SAFETY: the arrays have 16 elements.
    let (limit, base) =
        unsafe { (_mm512_loadu_ps(linear.limit.as_ptr()), _mm512_loadu_si512(linear.base.as_ptr().cast())) };
    let own: [__m512i; D] = row.own.map(|x| _mm512_set1_epi32(x as i32));
    let periods = row.periods.map(|p| _mm512_set1_epi32(p as i32));
    let mut flagged = 0;
    let mut sixteen = |o: usize| {
        let mut r2 = _mm512_setzero_ps();
        for k in 0..D {
            // SAFETY: columns are padded.
            let other = unsafe { _mm512_loadu_si512(row.others[k].add(o).cast()) };
            let d = if UNEQUAL {
                let apart = _mm512_sub_epi32(_mm512_max_epu32(own[k], other), _mm512_min_epu32(own[k], other));
                _mm512_min_epu32(apart, _mm512_sub_epi32(periods[k], apart))
            } else {
                _mm512_sub_epi32(own[k], other)
            };
            let d = _mm512_cvtepi32_ps(d);
            r2 = if k == 0 { _mm512_mul_ps(d, d) } else { _mm512_fmadd_ps(d, d, r2) };
        }
        let r = _mm512_min_ps(_mm512_max_ps(_mm512_sqrt_ps(r2), least), limit);
        let bits = _mm512_castps_si512(_mm512_fmadd_ps(r, bins_per_step, shift));
        let mask = u32::from(_mm512_testn_epi32_mask(bits, clear));
        let index = _mm512_add_epi32(_mm512_srlv_epi32(bits, fraction_bits), base);
        // SAFETY: there is room for 16 indices.
        unsafe { _mm512_storeu_si512(row.to.add(o).cast(), index) };
        // A branch, since a store whose place hangs on the mask would hold up the counting that comes after it.
        if mask != 0 {
            // SAFETY: at most one flag per 16 columns.
            unsafe { *flags.get_unchecked_mut(flagged) = (o as u32) << 16 | mask };
            flagged += 1;
        }
    };
    // SAFETY: `row` says so.
    unsafe {
        compute_and_count!(row, sixteen);
    }
    flagged
}

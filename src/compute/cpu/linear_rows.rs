//! Rows of pairs into bins of equal width, straight into histograms. `unsafe` are calls across a `target_feature` boundary (made
//! after asking the processor), and loads, stores and counter updates whose bounds are asserted or clamped just before.

#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "SIMD loads and stores, and calls into functions for a detected instruction set")
)]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

#[cfg(target_arch = "x86_64")]
use super::pair_rows::by_shape;
use super::pair_rows::{COLUMNS, LANES, Rows, Undecided};
use super::simd::SimdLevel;

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

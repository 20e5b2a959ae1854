//! Rows of pairs straight into histograms, whatever the bins. `unsafe` are calls across a `target_feature` boundary (made
//! after asking the processor), and loads, stores and counter updates whose bounds are asserted or clamped just before.

#![expect(unsafe_code, reason = "SIMD loads and stores, and calls into functions for a detected instruction set")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

#[cfg(target_arch = "x86_64")]
use super::pair_rows::by_shape;
use super::pair_rows::{COLUMNS, LANES, Rows, Undecided, squared};
use super::simd::SimdLevel;

/// Bins into which pairs are counted without a branch: each lane of a vector makes the squared distance of its pair an
/// index into one of `copies` histograms of `stride` counters, and says whether f32 decides it.
///
/// # Safety
/// Every index is below `copies * stride`, whatever the distance.
pub(super) unsafe trait Bins {
    /// Number of histograms the lanes share, since increments of one counter wait for each other.
    fn copies(&self) -> usize;

    /// Counters per histogram: bins, and places for pairs in none of them.
    fn stride(&self) -> usize;

    /// The bin of a squared distance (the number of bins for none), and whether it is undecided.
    fn bin(&self, r2: f32) -> (u32, bool);

    /// A closer look at a pair that is undecided: its bin (the number of bins for none), if that decides it.
    fn closer(&self, _r2: f32) -> Option<u32> {
        None
    }

    /// What `eight` needs of `self`, in registers.
    #[cfg(target_arch = "x86_64")]
    type Eight: Copy;

    /// What `sixteen` needs of `self`, in registers.
    #[cfg(target_arch = "x86_64")]
    type Sixteen: Copy;

    /// # Safety
    /// AVX2.
    #[cfg(target_arch = "x86_64")]
    unsafe fn load_eight(&self) -> Self::Eight;

    /// # Safety
    /// AVX-512 F and DQ.
    #[cfg(target_arch = "x86_64")]
    unsafe fn load_sixteen(&self) -> Self::Sixteen;

    /// The indices of 8 pairs for the lanes from `lane`, and a bit for each that is undecided.
    ///
    /// # Safety
    /// AVX2 and FMA; `lane` is 0 or 8.
    #[cfg(target_arch = "x86_64")]
    unsafe fn eight(&self, loaded: Self::Eight, r2: __m256, lane: usize) -> (__m256i, u32);

    /// The indices of 16 pairs, and a bit for each that is undecided.
    ///
    /// # Safety
    /// AVX-512 F and DQ.
    #[cfg(target_arch = "x86_64")]
    unsafe fn sixteen(&self, loaded: Self::Sixteen, r2: __m512) -> (__m512i, u32);
}

/// Histograms that lanes share: copies must fit into the first-level cache beside the coordinates.
pub(super) fn copies_of(bins: usize) -> usize {
    if bins <= 1024 { 4 } else { 1 }
}

/// Counters per histogram: bins, and one place per lane for pairs beyond them, which would wait for each other.
pub(super) fn stride_of(bins: usize) -> usize {
    (bins + LANES).next_multiple_of(16)
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

/// Pairs into the histograms of `bins`, by way of `stream`; undecided ones are counted in none.
/// Whether there is a kernel for it; `by_r2` does it too.
#[must_use]
#[cfg_attr(not(target_arch = "x86_64"), allow(unreachable_code, unused_variables, reason = "there is no vector loop"))]
pub(super) fn count_rows<B: Bins>(
    level: SimdLevel,
    job: &Rows<'_>,
    bins: &B,
    stream: &mut Stream,
    histogram: &mut [u32],
    undecided: &mut Vec<Undecided>,
) -> bool {
    assert!(histogram.len() >= bins.copies() * bins.stride(), "one histogram per copy");
    assert!(job.columns <= COLUMNS, "a piece fits the buffer");
    assert!(job.others.iter().all(|a| a.len() >= job.columns + LANES), "coordinates are padded");
    match level {
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx512 => by_shape!(job, rows[true, B], job, bins, stream, histogram, undecided),
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2 => by_shape!(job, rows[false, B], job, bins, stream, histogram, undecided),
        _ => return false,
    }
    true
}

/// One point against all columns, and counting meanwhile.
#[cfg(target_arch = "x86_64")]
struct Row<'a, B, const D: usize> {
    bins: &'a B,
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
fn rows<const D: usize, const UNEQUAL: bool, const AVX512: bool, B: Bins>(
    job: &Rows<'_>,
    bins: &B,
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
        let row = Row::<B, D> {
            bins,
            own: std::array::from_fn(|k| job.own[k][i]),
            others: std::array::from_fn(|k| job.others[k][first..].as_ptr()),
            periods: job.periods,
            len,
            to: to[left..].as_mut_ptr(),
            from: from.as_ptr(),
            groups,
            histogram: histogram.as_mut_ptr(),
        };
        // SAFETY: columns are padded by `LANES`; `to` has room for 15 left, `COLUMNS` and padding; all indices are those
        // of `bins`, and the histogram has its counters.
        let flagged = unsafe {
            if AVX512 {
                row_avx512::<D, UNEQUAL, B>(&row, &mut flags)
            } else {
                row_avx2::<D, UNEQUAL, B>(&row, &mut flags)
            }
        };
        let indices = &to[left..left + len];
        for &flag in &flags[..flagged] {
            let mut mask = flag & 0xffff;
            while mask != 0 {
                let o = (flag >> 16) as usize + mask.trailing_zeros() as usize;
                mask &= mask - 1;
                // What lies beyond the row is none of its pairs.
                let Some(&index) = indices.get(o) else { continue };
                let column = first + o;
                let other = std::array::from_fn(|k| job.others[k][column]);
                // Counting may be yet to come; the sums are right all the same.
                let mut add = |index: u32, one: u32| {
                    let count = &mut histogram[index as usize];
                    *count = count.wrapping_add(one);
                };
                add(index, u32::MAX);
                match bins.closer(squared::<D, UNEQUAL>(row.own, other, job.periods)) {
                    Some(bin) => add(bin, 1),
                    None => {
                        let place = index % bins.stride() as u32;
                        undecided.push(Undecided { i: i as u32, column: column as u32, place });
                    }
                }
            }
        }
        (stream.turn, stream.written) = (1 - stream.turn, left + len);
    }
}

/// Calls `$compute(o)` for every 16 columns, which makes flags, and counts `row.groups` groups, in turns as long as there
/// are both.
#[cfg(target_arch = "x86_64")]
macro_rules! compute_and_count {
    ($row:expr, $compute:expr, $flags:expr) => {{
        let row = $row;
        let computed = row.len.div_ceil(LANES);
        let mut flagged = 0;
        let mut compute = |o: usize| {
            let mask: u32 = $compute(o);
            // A branch, since a store whose place hangs on the mask would hold up the counting that comes after it.
            if mask != 0 {
                // SAFETY: at most one flag per 16 columns.
                unsafe { *$flags.get_unchecked_mut(flagged) = (o as u32) << 16 | mask };
                flagged += 1;
            }
        };
        // SAFETY: `row` says that indices and counters are there.
        let count = |g: usize| unsafe { count(row.from.add(LANES * g), row.histogram) };
        for g in 0..computed.min(row.groups) {
            compute(LANES * g);
            count(g);
        }
        for g in row.groups..computed {
            compute(LANES * g);
        }
        for g in computed..row.groups {
            count(g);
        }
        flagged
    }};
}

/// Counts 16 indices.
///
/// # Safety
/// There are 16, all below the length of the histogram.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
unsafe fn count(indices: *const u32, histogram: *mut u32) {
    // Two at a time: loads are what there is too little of.
    for k in 0..LANES / 2 {
        // SAFETY: as the caller says.
        unsafe {
            let two = indices.cast::<u64>().add(k).read_unaligned();
            for index in [two as u32, (two >> 32) as u32] {
                let count = histogram.add(index as usize);
                *count = (*count).wrapping_add(1);
            }
        }
    }
}

/// The number of flags. Kept apart from its callers, so that constants stay in registers.
///
/// # Safety
/// AVX2 and FMA; what `Row` says of its pointers.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[inline(never)]
unsafe fn row_avx2<const D: usize, const UNEQUAL: bool, B: Bins>(row: &Row<'_, B, D>, flags: &mut Flags) -> usize {
    // SAFETY: the instructions are there.
    let loaded = unsafe { row.bins.load_eight() };
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
        // SAFETY: `lane` is 0 or 8; there is room for 16 indices.
        unsafe {
            let (index, mask) = row.bins.eight(loaded, r2, lane);
            _mm256_storeu_si256(row.to.add(o + lane).cast(), index);
            mask
        }
    };
    compute_and_count!(row, |o| eight(o, 0) | eight(o, 8) << 8, flags)
}

/// The number of flags.
///
/// # Safety
/// AVX-512 F and DQ; what `Row` says of its pointers.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
#[inline(never)]
unsafe fn row_avx512<const D: usize, const UNEQUAL: bool, B: Bins>(row: &Row<'_, B, D>, flags: &mut Flags) -> usize {
    // SAFETY: the instructions are there.
    let loaded = unsafe { row.bins.load_sixteen() };
    let own: [__m512i; D] = row.own.map(|x| _mm512_set1_epi32(x as i32));
    let periods = row.periods.map(|p| _mm512_set1_epi32(p as i32));
    let sixteen = |o: usize| {
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
        // SAFETY: there is room for 16 indices.
        unsafe {
            let (index, mask) = row.bins.sixteen(loaded, r2);
            _mm512_storeu_si512(row.to.add(o).cast(), index);
            mask
        }
    };
    compute_and_count!(row, sixteen, flags)
}

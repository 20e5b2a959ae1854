//! Any bins, by one look-up: a table over the bits of the squared distance. `unsafe` are vector instructions, which the
//! caller has asked the processor for, and look-ups at places that are cut to the ends of the table.

#![expect(unsafe_code, reason = "SIMD")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::histogram_rows::{Bins, copies_of, stride_of};
use super::pair_rows::LANES;
use crate::plan::BinTable;

/// Marks a cell that an edge, or the doubt about one, reaches into.
const UNDECIDED: u32 = 1 << 31;

/// What a cell of no bin holds: more than any limit.
const NO_BIN: u32 = UNDECIDED - 1;

/// Cells of equal width in the bits of r2, each with its bin. Where the kernel for GPUs (`BinFilter::Table`) compares every
/// distance with the one edge of its cell, here cells are so narrow that few have one, and only their pairs are compared.
#[derive(Debug)]
pub(super) struct TableBins<'a> {
    edges: &'a BinTable,
    bins: u32,
    /// Bits of r2 that a cell spans.
    shift: u32,
    /// The first and the last cell, into which everything below and above is cut.
    range: [u32; 2],
    cells: Vec<u32>,
    limit: [u32; LANES],
    base: [u32; LANES],
    copies: usize,
    stride: usize,
}

impl<'a> TableBins<'a> {
    /// Cells no narrower than pays: 2^10 an octave, or as many more as leave few pairs undecided, as long as the table
    /// stays in the second-level cache.
    pub(super) fn new(edges: &'a BinTable) -> Self {
        let mut bins = Self::with_shift(edges, 13);
        while bins.undecided_share() > 0.01 && bins.shift > 7 && bins.cells.len() < 1 << 17 {
            bins = Self::with_shift(edges, bins.shift - 1);
        }
        bins
    }

    fn with_shift(edges: &'a BinTable, shift: u32) -> Self {
        let bins = edges.low.len() - 1;
        let cell_of = |r2: f32| r2.max(0.0).to_bits() >> shift;
        // An edge at 0 has nothing below it.
        let at_zero = usize::from(edges.high[0] < 0.0);
        let first = cell_of(edges.low[at_zero]).saturating_sub(1);
        let last = cell_of(edges.high[bins]) + 1;
        let bin = |slot: usize| if (1..=bins).contains(&slot) { slot as u32 - 1 } else { NO_BIN };
        let mut cells: Vec<u32> = Vec::with_capacity((last - first) as usize + 1);
        for e in at_zero..=bins {
            let [from, to] = [edges.low[e], edges.high[e]].map(|r2| (cell_of(r2) - first) as usize);
            // Slot e lies between the edge before and this one. Cells of two edges keep the first.
            cells.resize(from.max(cells.len()), bin(e));
            cells.resize(to + 1, UNDECIDED | e.saturating_sub(1) as u32);
        }
        cells.push(NO_BIN);
        let (copies, stride) = (copies_of(bins), stride_of(bins));
        Self {
            edges,
            bins: bins as u32,
            shift,
            range: [first, last],
            cells,
            limit: std::array::from_fn(|lane| (bins + lane) as u32),
            base: std::array::from_fn(|lane| (lane % copies * stride) as u32),
            copies,
            stride,
        }
    }

    /// The share of undecided cells in the last two octaves of r2, where most pairs are.
    fn undecided_share(&self) -> f64 {
        let octaves = (2 << (23 - self.shift)).min(self.cells.len());
        let undecided = self.cells[self.cells.len() - octaves..].iter().filter(|&&cell| cell >= UNDECIDED).count();
        undecided as f64 / octaves as f64
    }
}

// SAFETY: bins are cut to `limit`, which is below the stride.
unsafe impl Bins for TableBins<'_> {
    fn copies(&self) -> usize {
        self.copies
    }

    fn stride(&self) -> usize {
        self.stride
    }

    #[inline(always)]
    fn bin(&self, r2: f32) -> (u32, bool) {
        let [first, last] = self.range;
        let cell = self.cells[((r2.to_bits() >> self.shift).clamp(first, last) - first) as usize];
        ((cell & NO_BIN).min(self.bins), cell >= UNDECIDED)
    }

    fn closer(&self, r2: f32) -> Option<u32> {
        self.edges.bin(r2)
    }

    #[cfg(target_arch = "x86_64")]
    type Eight = (__m128i, [__m256i; 3]);

    #[cfg(target_arch = "x86_64")]
    type Sixteen = (__m128i, [__m512i; 5]);

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn load_eight(&self) -> Self::Eight {
        let [first, last] = self.range;
        // SAFETY: as the caller says.
        unsafe { (_mm_cvtsi32_si128(self.shift as i32), [first, last, NO_BIN].map(|x| _mm256_set1_epi32(x as i32))) }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn load_sixteen(&self) -> Self::Sixteen {
        let [first, last] = self.range;
        // SAFETY: as the caller says; the arrays have 16 elements.
        unsafe {
            let [first, last, bin] = [first, last, NO_BIN].map(|x| _mm512_set1_epi32(x as i32));
            let [limit, base] = [&self.limit, &self.base].map(|lanes| _mm512_loadu_si512(lanes.as_ptr().cast()));
            (_mm_cvtsi32_si128(self.shift as i32), [first, last, bin, limit, base])
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn eight(&self, loaded: Self::Eight, r2: __m256, lane: usize) -> (__m256i, u32) {
        let (shift, [first, last, bin]) = loaded;
        // SAFETY: as the caller says; the arrays have 16 elements, cells are cut to those there are.
        unsafe {
            let [limit, base] =
                [&self.limit, &self.base].map(|lanes| _mm256_loadu_si256(lanes.as_ptr().add(lane).cast()));
            let cell = _mm256_srl_epi32(_mm256_castps_si256(r2), shift);
            let cell = _mm256_sub_epi32(_mm256_min_epu32(_mm256_max_epu32(cell, first), last), first);
            let cell = _mm256_i32gather_epi32::<4>(self.cells.as_ptr().cast(), cell);
            let mask = _mm256_movemask_ps(_mm256_castsi256_ps(cell)) as u32;
            (_mm256_add_epi32(_mm256_min_epu32(_mm256_and_si256(cell, bin), limit), base), mask)
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn sixteen(&self, loaded: Self::Sixteen, r2: __m512) -> (__m512i, u32) {
        let (shift, [first, last, bin, limit, base]) = loaded;
        // SAFETY: as the caller says; cells are cut to those there are.
        unsafe {
            let cell = _mm512_srl_epi32(_mm512_castps_si512(r2), shift);
            let cell = _mm512_sub_epi32(_mm512_min_epu32(_mm512_max_epu32(cell, first), last), first);
            let cell = _mm512_i32gather_epi32::<4>(cell, self.cells.as_ptr().cast());
            let mask = u32::from(_mm512_movepi32_mask(cell));
            (_mm512_add_epi32(_mm512_min_epu32(_mm512_and_si512(cell, bin), limit), base), mask)
        }
    }
}

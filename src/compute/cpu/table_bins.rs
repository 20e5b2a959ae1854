//! Any bins, by one look-up: a table over the bits of the squared distance. `unsafe` are vector instructions, which the
//! caller has asked the processor for, and look-ups at places that are cut to the ends of the table.

#![expect(unsafe_code, reason = "SIMD")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::histogram_rows::{Bins, copies_of, stride_of};
use super::pair_rows::LANES;
use crate::plan::BinTable;

/// A bin, and whether an edge, or the doubt about one, reaches into its cell.
pub(super) trait Cell: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// Bits it takes: 16 or 32.
    const BITS: u32;

    /// Marks a cell that is undecided.
    const UNDECIDED: u32 = 1 << (Self::BITS - 1);

    /// What a cell of no bin holds: more than any limit.
    const NO_BIN: u32 = Self::UNDECIDED - 1;

    fn new(bits: u32) -> Self;

    fn bits(self) -> u32;
}

impl Cell for u16 {
    const BITS: u32 = 16;

    fn new(bits: u32) -> Self {
        bits as Self
    }

    fn bits(self) -> u32 {
        self.into()
    }
}

impl Cell for u32 {
    const BITS: u32 = 32;

    fn new(bits: u32) -> Self {
        bits
    }

    fn bits(self) -> u32 {
        self
    }
}

/// Cells of equal width in the bits of r2, each with its bin. Where the kernel for GPUs (`BinFilter::Table`) compares every
/// distance with the one edge of its cell, here cells are so narrow that few have one, and only their pairs are compared.
#[derive(Debug)]
pub(super) struct TableBins<'a, C> {
    edges: &'a BinTable,
    bins: u32,
    /// Bits of r2 that a cell spans.
    shift: u32,
    /// The first and the last cell, into which everything below and above is cut.
    range: [u32; 2],
    /// One more than there are cells: what is gathered is as wide as a lane.
    cells: Vec<C>,
    limit: [u32; LANES],
    base: [u32; LANES],
    copies: usize,
    stride: usize,
}

impl<'a> TableBins<'a, u16> {
    /// Cells half as wide, of which twice as many are near; `None` where there are more bins than they can hold.
    pub(super) fn narrow(edges: &'a BinTable) -> Option<Self> {
        (edges.low.len() + LANES < u16::NO_BIN as usize).then(|| Self::new(edges))
    }
}

impl<'a, C: Cell> TableBins<'a, C> {
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
        let bin = |slot: usize| C::new(if (1..=bins).contains(&slot) { slot as u32 - 1 } else { C::NO_BIN });
        let mut cells: Vec<C> = Vec::with_capacity((last - first) as usize + 2);
        for e in at_zero..=bins {
            let [from, to] = [edges.low[e], edges.high[e]].map(|r2| (cell_of(r2) - first) as usize);
            // Slot e lies between the edge before and this one. Cells of two edges keep the first.
            cells.resize(from.max(cells.len()), bin(e));
            cells.resize(to + 1, C::new(C::UNDECIDED | e.saturating_sub(1) as u32));
        }
        cells.resize(cells.len() + 2, C::new(C::NO_BIN));
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
        let undecided =
            self.cells[self.cells.len() - octaves..].iter().filter(|cell| cell.bits() >= C::UNDECIDED).count();
        undecided as f64 / octaves as f64
    }
}

// SAFETY: bins are cut to `limit`, which is below the stride.
unsafe impl<C: Cell> Bins for TableBins<'_, C> {
    fn copies(&self) -> usize {
        self.copies
    }

    fn stride(&self) -> usize {
        self.stride
    }

    #[inline(always)]
    fn bin(&self, r2: f32) -> (u32, bool) {
        let [first, last] = self.range;
        let cell = self.cells[((r2.to_bits() >> self.shift).clamp(first, last) - first) as usize].bits();
        ((cell & C::NO_BIN).min(self.bins), cell >= C::UNDECIDED)
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
        unsafe { (_mm_cvtsi32_si128(self.shift as i32), [first, last, C::NO_BIN].map(|x| _mm256_set1_epi32(x as i32))) }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn load_sixteen(&self) -> Self::Sixteen {
        let [first, last] = self.range;
        // SAFETY: as the caller says; the arrays have 16 elements.
        unsafe {
            let [first, last, bin] = [first, last, C::NO_BIN].map(|x| _mm512_set1_epi32(x as i32));
            let [limit, base] = [&self.limit, &self.base].map(|lanes| _mm512_loadu_si512(lanes.as_ptr().cast()));
            (_mm_cvtsi32_si128(self.shift as i32), [first, last, bin, limit, base])
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn eight(&self, loaded: Self::Eight, r2: __m256, lane: usize) -> (__m256i, u32) {
        let (shift, [first, last, bin]) = loaded;
        // SAFETY: as the caller says; the arrays have 16 elements, cells are cut to those there are, of which one more is there to be read.
        unsafe {
            let [limit, base] =
                [&self.limit, &self.base].map(|lanes| _mm256_loadu_si256(lanes.as_ptr().add(lane).cast()));
            let cell = _mm256_srl_epi32(_mm256_castps_si256(r2), shift);
            let cell = _mm256_sub_epi32(_mm256_min_epu32(_mm256_max_epu32(cell, first), last), first);
            let cells = self.cells.as_ptr().cast();
            let (cell, sign) = if C::BITS == 32 {
                let cell = _mm256_i32gather_epi32::<4>(cells, cell);
                (cell, cell)
            } else {
                let cell = _mm256_i32gather_epi32::<2>(cells, cell);
                (cell, _mm256_slli_epi32::<16>(cell))
            };
            let mask = _mm256_movemask_ps(_mm256_castsi256_ps(sign)) as u32;
            (_mm256_add_epi32(_mm256_min_epu32(_mm256_and_si256(cell, bin), limit), base), mask)
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn sixteen(&self, loaded: Self::Sixteen, r2: __m512) -> (__m512i, u32) {
        let (shift, [first, last, bin, limit, base]) = loaded;
        // SAFETY: as the caller says; cells are cut to those there are, of which one more is there to be read.
        unsafe {
            let cell = _mm512_srl_epi32(_mm512_castps_si512(r2), shift);
            let cell = _mm512_sub_epi32(_mm512_min_epu32(_mm512_max_epu32(cell, first), last), first);
            let cells = self.cells.as_ptr().cast();
            let (cell, sign) = if C::BITS == 32 {
                let cell = _mm512_i32gather_epi32::<4>(cell, cells);
                (cell, cell)
            } else {
                let cell = _mm512_i32gather_epi32::<2>(cell, cells);
                (cell, _mm512_slli_epi32::<16>(cell))
            };
            let mask = u32::from(_mm512_movepi32_mask(sign));
            (_mm512_add_epi32(_mm512_min_epu32(_mm512_and_si512(cell, bin), limit), base), mask)
        }
    }
}

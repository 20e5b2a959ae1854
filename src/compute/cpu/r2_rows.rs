//! Rows of pairs, binned by a function of the squared distance or by a table. `unsafe` are calls across a `target_feature`
//! boundary (made after asking the processor), and loads and stores whose bounds are clamped just before.

#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "SIMD loads and stores, and calls into functions for a detected instruction set")
)]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::pair_rows::{COLUMNS, Rows, Undecided, by_shape};
use super::simd::SimdLevel;
use crate::plan::BinTable;

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

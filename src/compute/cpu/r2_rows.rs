//! Rows of pairs, binned by any function of the squared distance. `unsafe` are calls across a `target_feature` boundary, made
//! after asking the processor.

#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "calls into functions for a detected instruction set")
)]

use super::pair_rows::{COLUMNS, Rows, Undecided, by_shape, squared};
use super::simd::SimdLevel;

/// Bins by a function of r2 that answers with the bin and whether it is undecided, row by row, into
/// `sink(i, first column, bins)`. Undecided pairs get `no_bin`.
pub(super) fn by_r2(
    level: SimdLevel,
    job: &Rows<'_>,
    bin: impl Fn(f32) -> (u32, bool),
    no_bin: u32,
    sink: impl FnMut(usize, usize, &[u32]),
    undecided: &mut Vec<Undecided>,
) {
    let _ = level;
    #[cfg(target_arch = "x86_64")]
    if level >= SimdLevel::Avx2 {
        // SAFETY: the level was detected.
        return unsafe { by_r2_avx2(job, (bin, no_bin, sink), undecided) };
    }
    by_r2_any(job, (bin, no_bin, sink), undecided);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn by_r2_avx2<B: Fn(f32) -> (u32, bool), S: FnMut(usize, usize, &[u32])>(
    job: &Rows<'_>,
    rule: (B, u32, S),
    undecided: &mut Vec<Undecided>,
) {
    by_r2_any(job, rule, undecided);
}

#[inline(always)]
fn by_r2_any<B: Fn(f32) -> (u32, bool), S: FnMut(usize, usize, &[u32])>(
    job: &Rows<'_>,
    rule: (B, u32, S),
    undecided: &mut Vec<Undecided>,
) {
    by_shape!(job, by_r2_rows[_], job, rule, undecided);
}

trait R2Rule {
    fn bin(&self, r2: f32) -> (u32, bool);
    fn no_bin(&self) -> u32;
    fn sink(&mut self, i: usize, first: usize, bins: &[u32]);
}

impl<B: Fn(f32) -> (u32, bool), S: FnMut(usize, usize, &[u32])> R2Rule for (B, u32, S) {
    #[inline(always)]
    fn bin(&self, r2: f32) -> (u32, bool) {
        (self.0)(r2)
    }
    #[inline(always)]
    fn no_bin(&self) -> u32 {
        self.1
    }
    #[inline(always)]
    fn sink(&mut self, i: usize, first: usize, bins: &[u32]) {
        (self.2)(i, first, bins);
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
        // Listed without a branch, since it would be as good as random.
        for (o, (slot, &r2)) in slots[..len].iter_mut().zip(&r2).enumerate() {
            let (bin, unsure) = rule.bin(r2);
            *slot = bin;
            flagged[flags] = o as u32;
            flags += usize::from(unsure);
        }
        for &o in &flagged[..flags] {
            let slot = &mut slots[o as usize];
            undecided.push(Undecided { i: i as u32, column: first as u32 + o, place: *slot });
            *slot = rule.no_bin();
        }
        rule.sink(i, first, &slots[..len]);
    }
}

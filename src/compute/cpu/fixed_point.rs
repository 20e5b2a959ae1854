//! Bins that are equal steps of some function of the distance: of itself (`linear_bins`), of its logarithm (`log_bins`).
//! `unsafe` are vector instructions, which the caller has asked the processor for.

#![cfg_attr(target_arch = "x86_64", expect(unsafe_code, reason = "SIMD"))]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::histogram_rows::{copies_of, stride_of};
use super::pair_rows::LANES;

/// A position `t` among bins (bin `k` is `[k, k + 1)`) in fixed point: f32 rounds `t + 2^e` to `f = 23 - e` bits behind
/// the point, if `2^e` is beyond all bins; these bits say which bin it is and how near an edge. Adding the guard first
/// makes the undecided ones those with fraction bits below twice the guard, and with the guard a power of two these are
/// the ones without any of the bits above.
#[derive(Debug, Clone)]
pub(super) struct FixedPoint {
    bins: u32,
    /// `2^e + guard`.
    pub(super) shift: f32,
    /// The guard, in bins.
    pub(super) guard: f32,
    /// `f`.
    fraction_bits: u32,
    /// The bits that undecided pairs lack.
    clear: u32,
    /// Where each lane's histogram begins, less what `2^e` adds.
    base: [u32; LANES],
    pub(super) copies: usize,
    pub(super) stride: usize,
}

#[cfg(target_arch = "x86_64")]
pub(super) type Eight = [__m256i; 2];

#[cfg(target_arch = "x86_64")]
pub(super) type Sixteen = [__m512i; 3];

impl FixedPoint {
    /// `None` where f32 decides too little: `t` is off by more than a quarter of a bin.
    pub(super) fn new(bins: usize, error: f64) -> Option<Self> {
        let (copies, stride) = (copies_of(bins), stride_of(bins));
        let exponent = stride.next_power_of_two().ilog2();
        let fraction_bits = 23 - exponent;
        let unit = 0.5f64.powi(fraction_bits as i32);
        // Bins far below a step have an infinite error, or none that is a number.
        if error.is_nan() || error > 0.25 {
            return None;
        }
        // Rounding to the unit adds half of one.
        let units = ((error / unit + 0.5).ceil() as u32).next_power_of_two();
        let guard = f64::from(units) * unit;
        if guard > 0.25 {
            return None;
        }
        let one = 2f32.powi(exponent as i32);
        Some(Self {
            bins: bins as u32,
            shift: one + guard as f32,
            guard: guard as f32,
            fraction_bits,
            clear: ((1 << fraction_bits) - 1) & !(2 * units - 1),
            base: std::array::from_fn(|k| ((k % copies * stride) as u32).wrapping_sub(one.to_bits() >> fraction_bits)),
            copies,
            stride,
        })
    }

    /// Where positions beyond the last bin are cut to: half a bin beyond `bins + lane`, clear of edges, and counted at
    /// places that differ between lanes, since increments of one counter wait for each other.
    pub(super) fn limit(&self, lane: usize) -> f64 {
        f64::from(self.bins) + lane as f64 + 0.5
    }

    /// Whether `shifted`, a position plus `shift`, has an index within the histograms for every lane.
    pub(super) fn holds(&self, shifted: impl Fn(usize) -> f32) -> bool {
        (0..LANES).all(|lane| self.index(shifted(lane), lane).0 < (self.copies * self.stride) as u32)
    }

    /// The index of a position plus `shift`, and whether it is undecided.
    #[inline(always)]
    fn index(&self, shifted: f32, lane: usize) -> (u32, bool) {
        let bits = shifted.to_bits();
        ((bits >> self.fraction_bits).wrapping_add(self.base[lane]), bits & self.clear == 0)
    }

    /// The bin (`bins` for none), and whether it is undecided.
    #[inline(always)]
    pub(super) fn bin(&self, shifted: f32) -> (u32, bool) {
        let (bin, undecided) = self.index(shifted, 0);
        (bin.min(self.bins), undecided)
    }

    /// # Safety
    /// AVX2.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) unsafe fn load_eight(&self) -> Eight {
        // SAFETY: as the caller says.
        [self.clear, self.fraction_bits].map(|x| unsafe { _mm256_set1_epi32(x as i32) })
    }

    /// # Safety
    /// AVX-512 F.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) unsafe fn load_sixteen(&self) -> Sixteen {
        // SAFETY: as the caller says; the array has 16 elements.
        unsafe {
            let [clear, fraction_bits] = [self.clear, self.fraction_bits].map(|x| _mm512_set1_epi32(x as i32));
            [clear, fraction_bits, _mm512_loadu_si512(self.base.as_ptr().cast())]
        }
    }

    /// # Safety
    /// AVX2; `lane` is 0 or 8.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) unsafe fn eight(&self, [clear, fraction_bits]: Eight, shifted: __m256, lane: usize) -> (__m256i, u32) {
        // SAFETY: as the caller says; the array has 16 elements.
        unsafe {
            let base = _mm256_loadu_si256(self.base.as_ptr().add(lane).cast());
            let bits = _mm256_castps_si256(shifted);
            let near = _mm256_cmpeq_epi32(_mm256_and_si256(bits, clear), _mm256_setzero_si256());
            let mask = _mm256_movemask_ps(_mm256_castsi256_ps(near)) as u32;
            (_mm256_add_epi32(_mm256_srlv_epi32(bits, fraction_bits), base), mask)
        }
    }

    /// # Safety
    /// AVX-512 F.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) unsafe fn sixteen([clear, fraction_bits, base]: Sixteen, shifted: __m512) -> (__m512i, u32) {
        // SAFETY: as the caller says.
        unsafe {
            let bits = _mm512_castps_si512(shifted);
            let mask = u32::from(_mm512_testn_epi32_mask(bits, clear));
            (_mm512_add_epi32(_mm512_srlv_epi32(bits, fraction_bits), base), mask)
        }
    }
}

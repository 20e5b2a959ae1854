//! Bins of equal ratio. `unsafe` are vector instructions, which the caller has asked the processor for.

#![expect(unsafe_code, reason = "SIMD")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::fixed_point::{self, FixedPoint};
use super::histogram_rows::Bins;
use super::pair_rows::LANES;
use crate::plan::BinTable;

/// `log2(1 + x) / x` for `1 + x` from 1/sqrt(2) to sqrt(2), by least squares weighted until errors level out (Lawson).
const LOG2: [f32; 8] =
    [1.442_694_8, -0.721_357_17, 0.480_939_45, -0.360_087_22, 0.286_707_46, -0.250_069_05, 0.236_890_36, -0.145_744_44];

/// Bound of its error with all roundings, fused or not: 9e-8 fused, as the test below finds.
const LOG2_ERROR: f64 = 2e-7;

/// Five roundings of 2^-24 in r^2 (conversion twice, product, two sums), as an error of its logarithm to base 2.
const R2_ERROR: f64 = 4.4e-7;

/// The bits of 1/sqrt(2).
const ROOT_HALF: u32 = 0x3f35_04f3;

/// Positions `(log2 r2 - log2 first^2) bins_per_octave` for bins of equal ratio. The exponent is read off the bits of r2,
/// the rest is a polynomial: no memory is read, and no root taken.
#[derive(Debug, Clone)]
pub(super) struct LogBins<'a> {
    edges: &'a BinTable,
    fixed: FixedPoint,
    /// The bits of `2^e0 / sqrt(2)`, with `2^e0` near the first edge squared: so exponents are small numbers.
    origin: u32,
    /// Bins per octave of r2, and the same by 2^-23, for exponents left where the bits have them.
    bins_per_octave: f32,
    bins_per_exponent: f32,
    /// Less the position of `2^e0`.
    first: f32,
    /// Positions below this are below the first bin for sure, and cut to the limit.
    lowest: f32,
    limit: [f32; LANES],
}

impl<'a> LogBins<'a> {
    /// Bins from `r_min` to `r_max`, both in steps, with these `edges`. `displaced`: how far roundings of coordinates move
    /// a distance, in steps. `None` where f32 decides too little.
    pub(super) fn new(edges: &'a BinTable, r_min: f64, r_max: f64, displaced: f64) -> Option<Self> {
        let bins = edges.low.len() - 1;
        let bins_per_octave = bins as f64 / (2.0 * (r_max / r_min).log2());
        let octaves = 2.0 * r_min.log2();
        let e0 = octaves.round();
        // Exponents of f32 are from -126 on; nothing below a step is in question.
        if !(r_min > 16.0 * displaced && (0.0..100.0).contains(&e0)) {
            return None;
        }
        // The relative error of r2 is twice that of r, largest at the first edge.
        let displaced = 2.0 * displaced / r_min / std::f64::consts::LN_2 * 1.1;
        // The bins per octave, two products, two sums: each 2^-24 of at most all bins and one octave.
        let rounded = 5.0 * 2f64.powi(-24) * (bins as f64 + 2.0 * bins_per_octave);
        // Half of the guard for the error, so that what is not below is above minus the guard.
        let fixed = FixedPoint::new(bins, 2.0 * ((LOG2_ERROR + R2_ERROR + displaced) * bins_per_octave + rounded))?;
        let log = Self {
            edges,
            origin: ROOT_HALF + ((e0 as u32) << 23),
            bins_per_octave: bins_per_octave as f32,
            bins_per_exponent: (bins_per_octave * 2f64.powi(-23)) as f32,
            first: ((e0 - octaves) * bins_per_octave) as f32,
            lowest: -fixed.guard / 2.0,
            limit: std::array::from_fn(|k| fixed.limit(k) as f32),
            fixed,
        };
        // Positions are cut to these.
        assert!(log.fixed.holds(|_| log.lowest + log.fixed.shift), "the least index is within");
        assert!(log.fixed.holds(|lane| log.limit[lane] + log.fixed.shift), "the largest index is within");
        Some(log)
    }

    /// The position of a squared distance.
    #[inline(always)]
    fn position(&self, r2: f32) -> f32 {
        let above = r2.to_bits().wrapping_sub(self.origin);
        let exponent = above & 0xff80_0000;
        let x = f32::from_bits((above - exponent) + ROOT_HALF) - 1.0;
        let polynomial = LOG2.iter().rev().fold(0.0, |sum, &c| sum * x + c);
        let octave = (exponent as i32) as f32 * self.bins_per_exponent + self.first;
        x * polynomial * self.bins_per_octave + octave
    }
}

// SAFETY: positions are cut to values whose indices are asserted to be within.
unsafe impl Bins for LogBins<'_> {
    fn copies(&self) -> usize {
        self.fixed.copies
    }

    fn stride(&self) -> usize {
        self.fixed.stride
    }

    #[inline(always)]
    fn bin(&self, r2: f32) -> (u32, bool) {
        let t = self.position(r2);
        let t = if t >= self.lowest { t.min(self.limit[0]) } else { self.limit[0] };
        self.fixed.bin(t + self.fixed.shift)
    }

    fn closer(&self, r2: f32) -> Option<u32> {
        self.edges.bin(r2)
    }

    #[cfg(target_arch = "x86_64")]
    type Eight = ([__m256; 5], __m256i, fixed_point::Eight);

    #[cfg(target_arch = "x86_64")]
    type Sixteen = ([__m512; 6], __m512i, fixed_point::Sixteen);

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn load_eight(&self) -> Self::Eight {
        // SAFETY: as the caller says.
        unsafe {
            let numbers = [self.bins_per_octave, self.bins_per_exponent, self.first, self.lowest, self.fixed.shift];
            (numbers.map(|x| _mm256_set1_ps(x)), _mm256_set1_epi32(self.origin as i32), self.fixed.load_eight())
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn load_sixteen(&self) -> Self::Sixteen {
        // SAFETY: as the caller says; the array has 16 elements.
        unsafe {
            let [per_octave, per_exponent, first, lowest, shift] =
                [self.bins_per_octave, self.bins_per_exponent, self.first, self.lowest, self.fixed.shift]
                    .map(|x| _mm512_set1_ps(x));
            let limit = _mm512_loadu_ps(self.limit.as_ptr());
            let origin = _mm512_set1_epi32(self.origin as i32);
            ([per_octave, per_exponent, first, lowest, shift, limit], origin, self.fixed.load_sixteen())
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn eight(&self, loaded: Self::Eight, r2: __m256, lane: usize) -> (__m256i, u32) {
        let ([per_octave, per_exponent, first, lowest, shift], origin, fixed) = loaded;
        // SAFETY: as the caller says; the array has 16 elements.
        unsafe {
            let above = _mm256_sub_epi32(_mm256_castps_si256(r2), origin);
            let exponent = _mm256_and_si256(above, _mm256_set1_epi32(0xff80_0000u32 as i32));
            let significand = _mm256_add_epi32(_mm256_sub_epi32(above, exponent), _mm256_set1_epi32(ROOT_HALF as i32));
            let x = _mm256_sub_ps(_mm256_castsi256_ps(significand), _mm256_set1_ps(1.0));
            let mut polynomial = _mm256_set1_ps(LOG2[7]);
            for k in (0..7).rev() {
                polynomial = _mm256_fmadd_ps(polynomial, x, _mm256_set1_ps(LOG2[k]));
            }
            let octave = _mm256_fmadd_ps(_mm256_cvtepi32_ps(exponent), per_exponent, first);
            let t = _mm256_fmadd_ps(_mm256_mul_ps(polynomial, x), per_octave, octave);
            let limit = _mm256_loadu_ps(self.limit.as_ptr().add(lane));
            let t = _mm256_blendv_ps(_mm256_min_ps(t, limit), limit, _mm256_cmp_ps::<_CMP_LT_OQ>(t, lowest));
            self.fixed.eight(fixed, _mm256_add_ps(t, shift), lane)
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn sixteen(&self, loaded: Self::Sixteen, r2: __m512) -> (__m512i, u32) {
        let ([per_octave, per_exponent, first, lowest, shift, limit], origin, fixed) = loaded;
        // SAFETY: as the caller says.
        unsafe {
            let above = _mm512_sub_epi32(_mm512_castps_si512(r2), origin);
            let exponent = _mm512_and_si512(above, _mm512_set1_epi32(0xff80_0000u32 as i32));
            let significand = _mm512_add_epi32(_mm512_sub_epi32(above, exponent), _mm512_set1_epi32(ROOT_HALF as i32));
            let x = _mm512_sub_ps(_mm512_castsi512_ps(significand), _mm512_set1_ps(1.0));
            let mut polynomial = _mm512_set1_ps(LOG2[7]);
            for k in (0..7).rev() {
                polynomial = _mm512_fmadd_ps(polynomial, x, _mm512_set1_ps(LOG2[k]));
            }
            let octave = _mm512_fmadd_ps(_mm512_cvtepi32_ps(exponent), per_exponent, first);
            let t = _mm512_fmadd_ps(_mm512_mul_ps(polynomial, x), per_octave, octave);
            let not_below = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(t, lowest);
            let t = _mm512_mask_min_ps(limit, not_below, t, limit);
            FixedPoint::sixteen(fixed, _mm512_add_ps(t, shift))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every significand; the bound is stated for fused sums as well, which are closer.
    #[test]
    fn the_logarithm_keeps_its_bound() {
        let worst = (ROOT_HALF..ROOT_HALF + (1 << 23)).fold(0.0f64, |worst, bits| {
            let x = f32::from_bits(bits) - 1.0;
            let polynomial = LOG2.iter().rev().fold(0.0, |sum, &c| sum * x + c);
            worst.max((f64::from(x * polynomial) - f64::from(f32::from_bits(bits)).log2()).abs())
        });
        assert!(worst < LOG2_ERROR && worst > LOG2_ERROR / 4.0, "{worst}");
    }

    /// What it decides is right near every edge, and it decides nearly everything.
    #[test]
    fn decided_bins_are_those_of_the_edges() {
        for (bins, r_min, r_max) in
            [(24, 4e6, 2e9), (256, 1e4, 2.1e9), (2000, 1e7, 3e9), (1, 100.0, 1e9), (7, 40.0, 41.0)]
        {
            let table = BinTable { first_cell: 0, cells: Vec::new(), low: vec![0.0; bins + 1], high: Vec::new() };
            let Some(log) = LogBins::new(&table, r_min, r_max, 2.2) else {
                assert_eq!(bins, 7, "bins of a step are not decided by f32");
                continue;
            };
            let edge = |k: f64| r_min * (r_max / r_min).powf(k / bins as f64);
            let (mut decided, mut asked) = (0, 0);
            for k in -3..=bins as i32 + 3 {
                for off in [-0.4, -0.1, -1e-2, -1e-3, -1e-4, -1e-5, 0.0, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.4] {
                    let position = f64::from(k) + off;
                    let r2 = (edge(position) * edge(position)) as f32;
                    let (bin, undecided) = log.bin(r2);
                    asked += 1;
                    if !undecided {
                        decided += 1;
                        let inside = (0.0..bins as f64).contains(&position);
                        assert_eq!(bin as usize, if inside { position as usize } else { bins }, "{position} of {bins}");
                    }
                }
            }
            assert!(4 * decided > asked, "{decided} of {asked}");
            assert_eq!([0.0, f32::MIN_POSITIVE, f32::MAX].map(|r2| log.bin(r2)), [(bins as u32, false); 3]);
        }
    }
}

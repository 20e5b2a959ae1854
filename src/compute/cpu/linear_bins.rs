//! Bins of equal width. `unsafe` are vector instructions, which the caller has asked the processor for.

#![expect(unsafe_code, reason = "SIMD")]

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::fixed_point::{self, FixedPoint};
use super::histogram_rows::Bins;
use super::pair_rows::LANES;

/// Relative error of the distance in bins: five roundings of 2^-24 in r^2 (conversion twice, product, two sums) are half
/// as many in r; the root, the bins per step and the product are one each. Together 5.5 2^-24, below this.
const RELATIVE_ERROR: f64 = 3.3e-7;

/// Positions `r * bins_per_step - first` for bins of equal width.
#[derive(Debug, Clone)]
pub(super) struct LinearBins {
    fixed: FixedPoint,
    bins_per_step: f32,
    /// What takes distances in bins to positions in fixed point.
    shift: f32,
    /// Smaller distances are raised to this one, clear of the edge at 0, which no distance is below. 0 where bins begin
    /// further out.
    least: f32,
    /// Distances below this are below the first bin for sure, and cut to the limit: 0 where bins begin there.
    lowest: f32,
    limit: [f32; LANES],
}

impl LinearBins {
    /// Bins from `first` widths on. `displaced`: how far roundings of coordinates move a distance, in bins. `None` where
    /// f32 decides too little.
    pub(super) fn new(bins: usize, bins_per_step: f64, first: f64, displaced: f64) -> Option<Self> {
        let fixed = if first > 0.0 {
            // Two more roundings, and half of the guard for the error, so that what is not below is above minus the guard.
            FixedPoint::new(bins, 2.0 * (RELATIVE_ERROR * (bins as f64 + 2.0 * first) + displaced))?
        } else {
            FixedPoint::new(bins, RELATIVE_ERROR * bins as f64 + displaced)?
        };
        let guard = f64::from(fixed.guard);
        let linear = Self {
            bins_per_step: bins_per_step as f32,
            shift: (f64::from(fixed.shift) - first) as f32,
            least: if first > 0.0 { 0.0 } else { (1.25 * guard / bins_per_step) as f32 },
            lowest: if first > 0.0 { ((first - guard / 2.0) / bins_per_step).max(0.0) as f32 } else { 0.0 },
            limit: std::array::from_fn(|k| ((fixed.limit(k) + first) / bins_per_step) as f32),
            fixed,
        };
        // All indices grow with the distance, which is cut to these.
        let least = linear.least.max(linear.lowest);
        assert!(linear.fixed.holds(|_| linear.shifted(least)), "the least index is within");
        assert!(linear.fixed.holds(|lane| linear.shifted(linear.limit[lane])), "the largest index is within");
        Some(linear)
    }

    #[inline(always)]
    fn shifted(&self, r: f32) -> f32 {
        r * self.bins_per_step + self.shift
    }
}

// SAFETY: distances are cut to values whose indices are asserted to be within.
unsafe impl Bins for LinearBins {
    fn copies(&self) -> usize {
        self.fixed.copies
    }

    fn stride(&self) -> usize {
        self.fixed.stride
    }

    #[inline(always)]
    fn bin(&self, r2: f32) -> (u32, bool) {
        let r = r2.sqrt();
        let inside = r.max(self.least).min(self.limit[0]);
        self.fixed.bin(self.shifted(if r >= self.lowest { inside } else { self.limit[0] }))
    }

    #[cfg(target_arch = "x86_64")]
    type Eight = ([__m256; 4], fixed_point::Eight);

    #[cfg(target_arch = "x86_64")]
    type Sixteen = ([__m512; 5], fixed_point::Sixteen);

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn load_eight(&self) -> Self::Eight {
        // SAFETY: as the caller says.
        unsafe {
            let numbers = [self.bins_per_step, self.shift, self.least, self.lowest];
            (numbers.map(|x| _mm256_set1_ps(x)), self.fixed.load_eight())
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn load_sixteen(&self) -> Self::Sixteen {
        // SAFETY: as the caller says; the array has 16 elements.
        unsafe {
            let [bins_per_step, shift, least, lowest] =
                [self.bins_per_step, self.shift, self.least, self.lowest].map(|x| _mm512_set1_ps(x));
            let limit = _mm512_loadu_ps(self.limit.as_ptr());
            ([bins_per_step, shift, least, lowest, limit], self.fixed.load_sixteen())
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn eight(&self, loaded: Self::Eight, r2: __m256, lane: usize) -> (__m256i, u32) {
        let ([bins_per_step, shift, least, lowest], fixed) = loaded;
        // SAFETY: as the caller says; the array has 16 elements.
        unsafe {
            let limit = _mm256_loadu_ps(self.limit.as_ptr().add(lane));
            let r = _mm256_sqrt_ps(r2);
            let inside = _mm256_min_ps(_mm256_max_ps(r, least), limit);
            let r = _mm256_blendv_ps(inside, limit, _mm256_cmp_ps::<_CMP_LT_OQ>(r, lowest));
            self.fixed.eight(fixed, _mm256_fmadd_ps(r, bins_per_step, shift), lane)
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn sixteen(&self, loaded: Self::Sixteen, r2: __m512) -> (__m512i, u32) {
        let ([bins_per_step, shift, least, lowest, limit], fixed) = loaded;
        // SAFETY: as the caller says.
        unsafe {
            let r = _mm512_sqrt_ps(r2);
            let not_below = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(r, lowest);
            let r = _mm512_mask_min_ps(limit, not_below, _mm512_max_ps(r, least), limit);
            FixedPoint::sixteen(fixed, _mm512_fmadd_ps(r, bins_per_step, shift))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pair a hair from an edge has any `r2` that five roundings make of the square of that edge: no such number is decided. One is that
    /// of the number itself.
    #[test]
    fn roundings_of_an_edge_are_undecided() {
        for (bins, first) in [(24, 0.0), (60, 0.0), (250, 0.0), (1000, 0.0), (250, 3.0), (24, 400.0)] {
            let width = 1_234_567.8;
            let linear = LinearBins::new(bins, 1.0 / width, first, 0.0).unwrap();
            let square = |t: f64| ((t + first) * width).powi(2);
            for bin in 1..bins {
                let edge = bin as f64;
                for roundings in -4..=4 {
                    let r2 = (square(edge) * (1.0 + f64::from(roundings) * 2f64.powi(-24))) as f32;
                    assert!(linear.bin(r2).1, "edge {bin} of {bins} from {first}, {roundings} roundings");
                }
                assert_eq!(linear.bin(square(edge + 0.5) as f32), (bin as u32, false), "{bin} of {bins} from {first}");
            }
        }
    }
}

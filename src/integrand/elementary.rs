//! Values of elementary functions at many places. What is written here is arithmetic without branches, which the compiler does several
//! places at a time, by the widest instructions that the processor at hand has; every one of them rounds alike.

use std::f64::consts::{LOG2_E, TAU};

use multiversion::multiversion;

/// `1.5 * 2^52`: what is added to it is rounded to a whole number, ties to even.
const ROUNDS: f64 = 6_755_399_441_055_744.0;

/// The distance of `r` from the nearest whole number, in [-1/2, 1/2]; |r| below 2^51.
#[inline(always)]
pub(super) fn nearest(r: f64) -> f64 {
    r - ((r + ROUNDS) - ROUNDS)
}

/// `cos(2 pi u)`, to rounding: the sine of a quarter turn less |u|, by its power series, whose next term is below 2^-60.
#[inline(always)]
pub(super) fn cosine_of_turns(u: f64) -> f64 {
    let t = TAU * (0.25 - nearest(u).abs());
    let t2 = t * t;
    // 1/(2 k + 1)!, alternating.
    const TERMS: [f64; 11] = {
        let (mut terms, mut k) = ([1.0; 11], 1);
        while k < 11 {
            terms[k] = -terms[k - 1] / ((2 * k) * (2 * k + 1)) as f64;
            k += 1;
        }
        terms
    };
    t * TERMS.iter().rev().fold(0.0, |sum, term| sum * t2 + term)
}

/// `exp(x)` for x up to 700, to rounding; 0 below -708. As `2^k exp(r)`, |r| at most log(2)/2 (Cody & Waite 1980), by the power series of
/// which the next term is below 2^-57.
#[inline(always)]
pub(super) fn exp(x: f64) -> f64 {
    // log(2), and what its first 32 bits leave.
    const HIGH: f64 = 6.931_471_803_691_238e-1;
    const LOW: f64 = 1.908_214_929_270_587_7e-10;
    const TERMS: [f64; 14] = {
        let (mut terms, mut k) = ([1.0; 14], 1);
        while k < 14 {
            terms[k] = terms[k - 1] / k as f64;
            k += 1;
        }
        terms
    };
    let inside = x.max(-708.0);
    let shifted = inside * LOG2_E + ROUNDS;
    let k = shifted - ROUNDS;
    let r = (inside - k * HIGH) - k * LOW;
    let series = TERMS.iter().rev().fold(0.0, |sum, term| sum * r + term);
    // The low bits of what was shifted are k: the exponent of a power of two.
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    if x < -708.0 { 0.0 } else { series * power }
}

/// Multiplies by 1 where `lo <= x < hi`, else by 0.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2", "x86_64+avx2"))]
pub(super) fn times_interval(x: &[f64], lo: f64, hi: f64, out: &mut [f64]) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out *= if lo <= x && x < hi { 1.0 } else { 0.0 };
    }
}

/// Multiplies by the value of the equal cell of [0, 1) that x is in.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2", "x86_64+avx2"))]
pub(super) fn times_steps(x: &[f64], values: &[f64], out: &mut [f64]) {
    let (n, last) = (values.len() as f64, values.len() - 1);
    for (out, &x) in out.iter_mut().zip(x) {
        *out *= values[((x * n) as u32 as usize).min(last)];
    }
}

/// Multiplies by `cos(2 pi (k x + phase))`.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2", "x86_64+avx2"))]
pub(super) fn times_cosine(x: &[f64], k: f64, phase: f64, out: &mut [f64]) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out *= cosine_of_turns(nearest(k * x) + phase);
    }
}

/// `sum_j exp(-(x + j)^2 / 2 s^2) = exp(-x^2 / 2 s^2) (1 + 2 sum_(j > 0) exp(-j^2 / 2 s^2) cosh(j x / s^2))`, ready for many x.
pub(super) struct Images {
    scale: f64,
    slope: f64,
    /// `exp(-j^2 / 2 s^2)` from j = 1 on, as far as it counts.
    far: [f64; MOST_IMAGES],
    reach: usize,
}

/// Images to each side, at most: sigma is at most the root of 2.
const MOST_IMAGES: usize = 14;

/// Beyond this many sigmas a Gaussian is below rounding.
pub(super) const REACH: f64 = 9.0;

/// Places worked on at a time.
pub(super) const LANES: usize = 64;

impl Images {
    pub(super) fn new(sigma: f64) -> Self {
        // Even the narrowest is 1 at 0.
        let scale = (-0.5 / (sigma * sigma)).max(-1e290);
        let reach = ((0.5 + REACH * sigma) as usize).min(MOST_IMAGES);
        let far = std::array::from_fn(|j| if j < reach { (scale * ((j + 1) * (j + 1)) as f64).exp() } else { 0.0 });
        Self { scale, slope: -2.0 * scale, far, reach }
    }

    /// Multiplies by `factor` times the sum at `x - center`; at most `LANES` places.
    pub(super) fn times(&self, x: &[f64], center: f64, factor: f64, out: &mut [f64]) {
        times_images(self, x, center, factor, out);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2", "x86_64+avx2"))]
fn times_images(images: &Images, x: &[f64], center: f64, factor: f64, out: &mut [f64]) {
    let mut place = [0.0; LANES];
    for ((place, &x), out) in place.iter_mut().zip(x).zip(out.iter_mut()) {
        *place = nearest(x - center);
        *out *= factor * exp(images.scale * *place * *place);
    }
    let far = &images.far[..images.reach];
    if far.is_empty() {
        return;
    }
    let mut ones = [[1.0; LANES]; 5];
    let [right, left, rights, lefts, sum] = ones.each_mut().map(|ones| &mut ones[..x.len().min(LANES)]);
    for ((place, right), left) in place.iter().zip(&mut *right).zip(&mut *left) {
        *right = exp(images.slope * place);
        *left = 1.0 / *right;
    }
    for far in far {
        for (((rights, right), (lefts, left)), sum) in
            rights.iter_mut().zip(&*right).zip(lefts.iter_mut().zip(&*left)).zip(&mut *sum)
        {
            *rights *= *right;
            *lefts *= *left;
            *sum += far * (*rights + *lefts);
        }
    }
    out.iter_mut().zip(sum).for_each(|(out, sum)| *out *= *sum);
}

/// `(1 - d^2 / R^2)^q` where d, the distance from a centre on the torus, is below R, else 0; q below 16.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx2", "x86_64+avx2"))]
pub(super) fn radial(x: &[[f64; 3]], center: [f64; 3], radius: f64, q: u32, out: &mut [f64]) {
    let square = radius * radius;
    let bit = |k: u32, power: f64| if q >> k & 1 == 1 { power } else { 1.0 };
    for (out, x) in out.iter_mut().zip(x) {
        let d: [f64; 3] = std::array::from_fn(|k| nearest(x[k] - center[k]));
        let d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let once = 1.0 - d2 / square;
        let twice = once * once;
        let fourfold = twice * twice;
        let power = bit(0, once) * bit(1, twice) * (bit(2, fourfold) * bit(3, fourfold * fourfold));
        *out = if d2 < square { power } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest difference in units of `scale`.
    fn worst(
        f: impl Fn(f64) -> f64,
        truth: impl Fn(f64) -> f64,
        from: f64,
        to: f64,
        scale: impl Fn(f64) -> f64,
    ) -> f64 {
        let at = |k: usize| from + (to - from) * k as f64 / 1e5;
        (0..=100_000).map(at).map(|x| (f(x) - truth(x)).abs() / scale(x)).fold(0.0, f64::max)
    }

    #[test]
    fn they_are_what_the_library_says() {
        let turns = |x: f64| (TAU * nearest(x)).cos();
        // The library rounds the angle, whose error the cosine has.
        assert!(worst(cosine_of_turns, turns, -3.0, 3.0, |_| 1.0) < 4e-16);
        for (k, exact) in [(0.0, 1.0), (0.25, 0.0), (0.5, -1.0), (0.75, 0.0), (1.0, 1.0), (-0.5, -1.0)] {
            assert_eq!(cosine_of_turns(k), exact, "{k}");
        }
        assert!(worst(exp, f64::exp, -707.0, 699.0, f64::exp) < 4e-16);
        assert!(worst(exp, f64::exp, -1.0, 1.0, f64::exp) < 4e-16);
        assert_eq!([exp(0.0), exp(-0.0), exp(-709.0), exp(-1e300), exp(f64::NEG_INFINITY)], [1.0, 1.0, 0.0, 0.0, 0.0]);
        assert_eq!([nearest(0.75), nearest(-0.75), nearest(7.25), nearest(0.0)], [-0.25, 0.25, 0.25, 0.0]);
    }

    #[test]
    fn a_gaussian_has_its_images() {
        for sigma in [1e-200, 1e-3, 0.05, 0.1, 0.3, 1.0] {
            let images = Images::new(sigma);
            for k in 0..256 {
                // Multiples of a power of two: no distance is rounded. Images beyond 9 sigma are left out.
                let x = f64::from(k) / 128.0 - 1.0;
                let mut here = [1.0];
                images.times(&[x], 0.25, 1.0, &mut here);
                let one = |j: i32| (-0.5 * ((x - 0.25 + f64::from(j)) / sigma).powi(2)).exp();
                let truth: f64 = (-15..=15).map(one).sum();
                let bound = 4e-15 - 1e-15 * truth.max(1e-308).ln().min(0.0);
                assert!((here[0] - truth).abs() <= bound * truth + 1e-17, "{sigma} {x}: {} {truth}", here[0]);
            }
        }
    }
}

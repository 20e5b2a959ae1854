//! Which instruction set is used, and the loops that the compiler vectorizes by itself once it may use that set.

#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "calls into functions for a detected instruction set")
)]

use std::ops::Range;

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use super::discrepancy::{Axis, KINDS, Row, pair_sums};
use super::lag_deposit::{self, Lags};
use super::nufft::Band;
use super::phase_tables::{Panel, Table, fill};
use super::wave_power::WavePoints;
use super::wave_terms::{LANES, Vector, terms};

/// Instruction sets with kernels of their own, in rising order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SimdLevel {
    /// What the compiler makes for the baseline of the target.
    Portable,
    /// x86-64 with AVX2 and FMA.
    Avx2,
    /// x86-64 with AVX-512 F, DQ and VL.
    Avx512,
}

impl SimdLevel {
    /// The best this processor has.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            let wide = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl");
            return if wide { Self::Avx512 } else { Self::Avx2 };
        }
        Self::Portable
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable SIMD",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }
}

/// Functions that run `$body` as compiled for the level, with fused multiply-adds where the processor has them.
macro_rules! by_level {
    ($($(#[$doc:meta])* $name:ident = $($body:ident)::+($($arg:ident: $type:ty),*);)*) => {$(
        $(#[$doc])*
        pub(super) fn $name(level: SimdLevel, $($arg: $type),*) {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
            fn avx512($($arg: $type),*) {
                $($body)::+::<true>($($arg),*);
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,fma")]
            fn avx2($($arg: $type),*) {
                $($body)::+::<true>($($arg),*);
            }
            match level {
                // SAFETY: the level was detected.
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx512 => unsafe { avx512($($arg),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                SimdLevel::Avx2 => unsafe { avx2($($arg),*) },
                _ => $($body)::+::<false>($($arg),*),
            }
        }
    )*};
}

by_level! {
    /// Fills a table in f32.
    fill_f32 = fill::f32(table: &Table, panel: &Panel<'_>, out: &mut [f32], stride: usize);
    /// Fills a table in f64.
    fill_f64 = fill::f64(table: &Table, panel: &Panel<'_>, out: &mut [f64], stride: usize);
    /// Writes the sums of a table's columns over points, times a weight per point.
    table_sums_f32 = fill::sums_f32(table: &[f32], stride: usize, weights: &[f32], sums: &mut [f32]);
    /// The same in f64.
    table_sums_f64 = fill::sums_f64(table: &[f64], stride: usize, weights: &[f64], sums: &mut [f64]);
    /// Adds the pairs of one point to the sums of discrepancies.
    discrepancy_row = pair_sums::add_row(
        axes: &[Axis<'_>], means: &[Vec<f64>; 3], constants: &[f64; KINDS], i: usize, row: &mut Row
    );
    /// Adds the pairs of some points to the cells of their lags.
    deposit_lags = lag_deposit::add(lags: &Lags, rows: Range<usize>, corners: &mut [f32]);
    /// Adds the terms of one wave vector at a chunk of points.
    add_terms = terms::add(vector: &Vector, points: &WavePoints<'_>, sums: &mut [[f64; LANES]; 2]);
}

/// Spreads the points of a band. Wider vectors than those of AVX2 are no faster: few of them lie within one cache line.
pub(super) fn spread(level: SimdLevel, band: Band<'_>, weighted: bool) {
    #[cfg(target_arch = "x86_64")]
    if level >= SimdLevel::Avx2 {
        // SAFETY: the level was detected.
        return unsafe { spread_avx2(band, weighted) };
    }
    let _ = level;
    band.spread::<false>(weighted);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn spread_avx2(band: Band<'_>, weighted: bool) {
    band.spread::<true>(weighted);
}

/// `to += from`: the sums of a panel join those of all points.
pub(super) fn add(level: SimdLevel, to: &mut [f64], from: &[f32]) {
    #[cfg(target_arch = "x86_64")]
    if level >= SimdLevel::Avx2 {
        // SAFETY: the level was detected.
        return unsafe { add_avx2(to, from) };
    }
    let _ = level;
    add_any(to, from);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn add_avx2(to: &mut [f64], from: &[f32]) {
    add_any(to, from);
}

#[inline(always)]
fn add_any(to: &mut [f64], from: &[f32]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to += f64::from(from);
    }
}

/// f32 multiply-adds on one thread in a chain-free loop, in GFLOP: the limit that throughput is compared with. Returns a
/// value that depends on all of them.
pub fn fma_gflop(level: SimdLevel, rounds: u32) -> (f64, f32) {
    #[cfg(target_arch = "x86_64")]
    match level {
        // SAFETY: the level was detected.
        SimdLevel::Avx512 => return unsafe { fma_avx512(rounds) },
        // SAFETY: likewise.
        SimdLevel::Avx2 => return unsafe { fma_avx2(rounds) },
        SimdLevel::Portable => {}
    }
    let _ = level;
    let mut sums = [[1f32; 8]; 8];
    for _ in 0..rounds {
        for lane in sums.iter_mut().flatten() {
            *lane = *lane * 0.999 + 0.001;
        }
    }
    (f64::from(rounds) * 64.0 * 2e-9, sums.iter().flatten().sum())
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
fn fma_avx512(rounds: u32) -> (f64, f32) {
    let (a, b) = (_mm512_set1_ps(0.999), _mm512_set1_ps(0.001));
    let mut sums: [__m512; 12] = std::array::from_fn(|k| _mm512_set1_ps(k as f32));
    for _ in 0..rounds {
        for sum in &mut sums {
            *sum = _mm512_fmadd_ps(*sum, a, b);
        }
    }
    let total = sums.into_iter().fold(_mm512_setzero_ps(), |t, s| _mm512_add_ps(t, s));
    (f64::from(rounds) * 12.0 * 16.0 * 2e-9, _mm512_reduce_add_ps(total))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fma_avx2(rounds: u32) -> (f64, f32) {
    let (a, b) = (_mm256_set1_ps(0.999), _mm256_set1_ps(0.001));
    // Different beginnings, or the compiler keeps only one of the chains.
    let mut sums: [__m256; 12] = std::array::from_fn(|k| _mm256_set1_ps(k as f32));
    for _ in 0..rounds {
        for sum in &mut sums {
            *sum = _mm256_fmadd_ps(*sum, a, b);
        }
    }
    let total = sums.into_iter().fold(_mm256_setzero_ps(), |t, s| _mm256_add_ps(t, s));
    (f64::from(rounds) * 12.0 * 8.0 * 2e-9, _mm256_cvtss_f32(total))
}

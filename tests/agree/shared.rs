//! Shared by the tests of this room.

use crate::common::*;
use pairwave::accumulate::WavePower;
use pairwave::compute::cpu::{Cpu, SimdLevel};
use pairwave::points::Ensemble;

/// The native path with each instruction set this processor has.
pub fn levels() -> Vec<Cpu> {
    let all = [SimdLevel::Portable, SimdLevel::Avx2, SimdLevel::Avx512];
    let here = SimdLevel::detect();
    println!("instruction sets up to {} are tested", here.name());
    all.into_iter().filter(|&l| l <= here).map(|l| Cpu::with_level(Some(2), l).unwrap()).collect()
}

pub fn cpu(threads: usize) -> Cpu {
    Cpu::new(Some(threads)).unwrap()
}

pub fn many(dim: usize, realizations: usize, n: usize) -> Ensemble {
    let sets: Vec<_> = (0..realizations).map(|k| uniform(dim, n + k % 5, 100 + k as u64)).collect();
    ensemble(&sets)
}

/// All sums of a spectrum, bit for bit.
pub fn bits(power: &WavePower) -> Vec<u64> {
    let (modes, rings) = (power.mode_totals(), power.ring_totals());
    [modes.q, modes.q_squared, modes.q_n, rings.q, rings.q_squared, rings.q_n]
        .iter()
        .flatten()
        .map(|x| x.to_bits())
        .chain(power.norm_totals().map(f64::to_bits))
        .chain([power.realizations])
        .collect()
}

//! Rings of constant frequency.

use super::convention::RingRule;
use super::{Sectors, WaveGrid, WaveVectors};
use crate::points::Domain;

/// Rings of constant frequency: which stored modes each of them holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Rings {
    /// `1 / longest side`, in cycles per unit length.
    pub fundamental: f64,
    /// Number of rings.
    pub count: usize,
    /// Per ring: its lower end, its label and its upper end, in cycles per unit length.
    pub bounds: Vec<[f64; 3]>,
    /// Ring (1-based) of each stored mode, 0 for none.
    pub ring_of: Vec<u32>,
    /// How many members of its ring each stored mode stands for.
    pub times: Vec<u8>,
    /// Members per ring (index `k - 1`).
    pub modes: Vec<u64>,
    /// How many of them are independent: P(-m) = P(m).
    pub independent: Vec<u64>,
    /// Sectors of direction, over all rings.
    pub sectors: Sectors,
}

impl Rings {
    /// Ring `k` (1-based) holds the modes with `nu / nu_1` in `[k - 1/2, k + 1/2)`, where `nu = |m / L|` and
    /// `nu_1 = 1 / max L`; only rings that lie whole inside the grid. DC is in none. A list has none, unless it was made for
    /// rings (`WaveList::ring_directions`): then their members are those listed.
    pub fn new(waves: &WaveVectors, domain: &Domain) -> Self {
        let longest = domain.sides().iter().copied().fold(0.0, f64::max);
        let fundamental = 1.0 / longest;
        let ratios = side_ratios(domain);
        let ring = |index: usize| ring_number(waves.vector(index).map(|m| m as i32), &ratios);
        let count = match waves {
            WaveVectors::Grid(grid) => whole_rings(&grid.max_frequency()[..grid.dim()], &ratios),
            WaveVectors::List(list) if list.mirrored => (0..waves.len()).map(ring).max().unwrap_or(0),
            WaveVectors::List(_) => return Self::none(fundamental, waves.len()),
        };
        let ring_of: Vec<u32> = (0..waves.len())
            .map(|index| match ring(index) {
                ring if ring <= count => ring as u32,
                _ => 0,
            })
            .collect();
        let times: Vec<u8> = (0..ring_of.len()).map(|index| waves.multiplicity(index) as u8).collect();
        let mut modes = vec![0; count];
        for (&ring, &times) in ring_of.iter().zip(&times).filter(|(ring, _)| **ring > 0) {
            modes[ring as usize - 1] += u64::from(times);
        }
        let bounds = (1..=count).map(|k| [-0.5, 0.0, 0.5].map(|d| (k as f64 + d) * fundamental)).collect();
        let independent = modes.iter().map(|m| m / 2).collect();
        Self { fundamental, count, bounds, ring_of, times, modes, independent, sectors: Sectors::default() }
    }

    /// The rings of another program, lowest edge as label, in cycles per side over `rule.unit`. With `dc_cleared`, P(0) is
    /// counted among the members of the first ring but adds nothing to their sum.
    pub(super) fn by(rule: &RingRule, grid: &WaveGrid, dc_cleared: bool) -> Self {
        let dc = grid.dc();
        let mut ring_of = vec![0; grid.half_len()];
        let mut times = vec![0; grid.half_len()];
        let (mut modes, mut independent) = (Vec::new(), Vec::new());
        for index in (0..grid.half_len()).filter(|&index| rule.dc || index != dc) {
            let squared: f64 = grid.mode(index).iter().map(|&m| f64::from(m).powi(2)).sum();
            let ring = (rule.ring)(squared);
            if ring >= rule.count {
                continue;
            }
            if modes.len() <= ring {
                modes.resize(ring + 1, 0);
                independent.resize(ring + 1, 0);
            }
            ring_of[index] = ring as u32 + 1;
            times[index] = if index == dc && dc_cleared { 0 } else { grid.multiplicity(index) as u8 };
            modes[ring] += u64::from(grid.multiplicity(index));
            independent[ring] += u64::from(index > dc);
        }
        // A ring about 0 that does not hold DC holds nothing.
        let first = modes.iter().take_while(|&&m| m == 0).count();
        ring_of.iter_mut().filter(|ring| **ring > 0).for_each(|ring| *ring -= first as u32);
        let edge = |k: usize| k as f64 * rule.width / rule.unit;
        let bounds = (first..modes.len()).map(|k| [edge(k), edge(k), edge(k + 1)]).collect();
        let (modes, independent) = (modes.split_off(first), independent.split_off(first));
        let (fundamental, count) = (1.0 / rule.unit, modes.len());
        Self { fundamental, count, bounds, ring_of, times, modes, independent, sectors: Sectors::default() }
    }

    /// Indices of the upper half of the rings.
    pub fn upper(&self) -> std::ops::Range<usize> {
        self.count / 2..self.count
    }

    /// No rings.
    pub fn none(fundamental: f64, stored: usize) -> Self {
        Self {
            fundamental,
            count: 0,
            bounds: Vec::new(),
            ring_of: vec![0; stored],
            times: vec![0; stored],
            modes: Vec::new(),
            independent: Vec::new(),
            sectors: Sectors::default(),
        }
    }
}

/// How much wider the lattice of wave vectors is along each axis than along the axis of the longest side.
pub(super) fn side_ratios(domain: &Domain) -> Vec<f64> {
    let longest = domain.sides().iter().copied().fold(0.0, f64::max);
    domain.sides().iter().map(|s| longest / s).collect()
}

/// The ring that `m` lies in; 0 for DC.
pub(super) fn ring_number(m: [i32; 3], ratios: &[f64]) -> usize {
    let squared: f64 = m.into_iter().zip(ratios).map(|(m, ratio)| (f64::from(m) * ratio).powi(2)).sum();
    // |m| is never exactly a half integer for integer m (4|m|^2 is even), so rounding is safe on a cube.
    (squared.sqrt() + 0.5).floor() as usize
}

/// Ring k is whole if every mode just outside the grid lies at or beyond its upper end k + 1/2.
pub(super) fn whole_rings(max_frequency: &[u32], ratios: &[f64]) -> usize {
    let outside = max_frequency.iter().zip(ratios).map(|(&f, ratio)| (f64::from(f) + 1.0) * ratio);
    (outside.fold(f64::INFINITY, f64::min) - 0.5).floor() as usize
}

//! Wave vectors for radial means alone: a few per ring, evenly spread over directions.

use std::f64::consts::{PI, TAU};

use super::wave_rings::{ring_number, side_ratios, whole_rings};
use super::wave_vectors::check_vectors;
use super::{MAX_FREQUENCY, WaveList};
use crate::error::{Error, Result, numbers};
use crate::points::Domain;
use crate::setting::Setting;

/// The inverse of the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Which wave vectors stand for a ring, in words.
pub const RING_DIRECTIONS_RULE: &str = "of each ring its members nearest to N directions that are evenly spread over half a turn \
     (2D; from ring to ring shifted by the golden ratio) or over half the sphere (3D; a Fibonacci spiral), each once; rings with \
     at most N pairs of opposite members whole";

impl WaveList {
    /// At most `directions` wave vectors for every ring of the grid up to `max_frequency` (one number per axis), one of each
    /// pair of opposite ones. Of ring k, with `nu = k nu_1` at its middle, these are the members closest to `k nu_1 u_j`:
    /// in 2D with `u_j` at the angle `pi (j + {k / phi}) / N`; in 3D at height `(j + 1/2) / N` and azimuth
    /// `2 pi (k N + j) / phi` (Fibonacci spiral: Swinbank and Purser, Q. J. R. Meteorol. Soc. 132, 2006), where phi is the
    /// golden ratio and braces take the part below 1. Directions whose closest member is the same count once. A ring with no
    /// more than `directions` such pairs is taken whole.
    ///
    /// # Errors
    /// No directions, or more wave vectors than a list may have.
    pub fn ring_directions(domain: &Domain, max_frequency: &[u32], directions: u64) -> Result<Self> {
        if directions == 0 {
            return Err(Error::setting(Setting::RingDirections, directions, "expected at least 1"));
        }
        if max_frequency.len() != domain.dim() || max_frequency.iter().any(|&f| f > MAX_FREQUENCY) {
            let reason = format!(
                "expected 1 or {} numbers of at most {MAX_FREQUENCY} for points with {0} coordinates",
                domain.dim()
            );
            let value = numbers(max_frequency.iter().map(|&f| f64::from(f)));
            return Err(Error::setting(Setting::MaxFrequency, value, reason));
        }
        let rings = Annuli::new(domain);
        let count = whole_rings(max_frequency, &rings.ratios);
        check_vectors(count as u128 * u128::from(directions), Setting::RingDirections, directions)?;
        let mut vectors = Vec::new();
        for k in 1..=count {
            let few = rings.members(k, directions as usize);
            vectors.extend(few.unwrap_or_else(|| rings.nearest(k, directions)));
        }
        Ok(Self { dim: domain.dim(), vectors: vectors.into_iter().map(|m| m.map(f64::from)).collect(), mirrored: true })
    }
}

/// The rings of a lattice with spacings `ratios`, the least of which is 1.
struct Annuli {
    ratios: Vec<f64>,
    /// The axis with spacing 1: along it there is a member wherever a line meets the ring.
    along: usize,
    across: Vec<usize>,
}

impl Annuli {
    fn new(domain: &Domain) -> Self {
        let ratios = side_ratios(domain);
        let along = (0..ratios.len()).find(|&a| ratios[a] == 1.0).unwrap_or(0);
        let across = (0..ratios.len()).filter(|&a| a != along).collect();
        Self { ratios, along, across }
    }

    fn vector(&self, row: [i32; 2], x: i32) -> [i32; 3] {
        let mut m = [0; 3];
        m[self.along] = x;
        for (&a, m_a) in self.across.iter().zip(row) {
            m[a] = m_a;
        }
        m
    }

    /// `|x|` along a line at squared distance `rest` from the origin where ring `k` is, one more on either side; `None`
    /// where the line misses it.
    fn span(k: usize, rest: f64) -> Option<[i32; 2]> {
        let [lo, hi] = [k as f64 - 0.5, k as f64 + 0.5].map(|r| r * r - rest);
        (hi > 0.0).then(|| [(lo.max(0.0).sqrt() - 1.0).floor() as i32, hi.sqrt() as i32 + 1])
    }

    /// The squared distance of a line from the origin.
    fn rest(&self, row: [i32; 2]) -> f64 {
        self.across.iter().zip(row).map(|(&a, m)| (f64::from(m) * self.ratios[a]).powi(2)).sum()
    }

    /// One of each pair of opposite members of ring `k`, unless there are more than `most`.
    fn members(&self, k: usize, most: usize) -> Option<Vec<[i32; 3]>> {
        let reach = |axis: usize| self.across.get(axis).map_or(0, |&a| ((k as f64 + 0.5) / self.ratios[a]) as i32);
        let [reach_0, reach_1] = [reach(0), reach(1)];
        let mut found = Vec::new();
        for row_0 in 0..=reach_0 {
            for row_1 in (if row_0 == 0 { 0 } else { -reach_1 })..=reach_1 {
                let row = [row_0, row_1];
                let Some([from, to]) = Self::span(k, self.rest(row)) else { continue };
                let through_0 = row == [0, 0];
                for x in from.max(i32::from(through_0))..=to {
                    for x in if x == 0 || through_0 { vec![x] } else { vec![x, -x] } {
                        let m = self.vector(row, x);
                        if ring_number(m, &self.ratios) == k {
                            found.push(upper(m));
                        }
                    }
                }
                if found.len() > most {
                    return None;
                }
            }
        }
        found.sort_unstable();
        Some(found)
    }

    /// Of ring `k` the members nearest to evenly spread directions, each once.
    fn nearest(&self, k: usize, directions: u64) -> Vec<[i32; 3]> {
        let mut found: Vec<_> = (0..directions)
            .filter_map(|j| self.nearest_to(k, direction(self.ratios.len(), k, j, directions)))
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    fn nearest_to(&self, k: usize, u: [f64; 3]) -> Option<[i32; 3]> {
        let target = u.map(|u| k as f64 * u);
        let mut nearest: Option<(f64, [i32; 3])> = None;
        let around = |axis: usize| match self.across.get(axis) {
            Some(&a) => {
                let middle = (target[a] / self.ratios[a]).round() as i32;
                middle - 1..=middle + 1
            }
            None => 0..=0,
        };
        for row_0 in around(0) {
            for row_1 in around(1) {
                let row = [row_0, row_1];
                let Some([from, to]) = Self::span(k, self.rest(row)) else { continue };
                let middle = (target[self.along].abs().round() as i32).clamp(from, to);
                for x in [middle - 1, middle, middle + 1] {
                    let m = self.vector(row, if target[self.along] < 0.0 { -x } else { x });
                    let apart = |a: usize| f64::from(m[a]) * self.ratios[a] - target[a];
                    let squared: f64 = (0..self.ratios.len()).map(|a| apart(a).powi(2)).sum();
                    if ring_number(m, &self.ratios) == k && nearest.is_none_or(|(least, _)| squared < least) {
                        nearest = Some((squared, upper(m)));
                    }
                }
            }
        }
        nearest.map(|(_, m)| m)
    }
}

/// Direction `j` of `count` for ring `k`. By `libm`, so that every machine takes the same members.
fn direction(dim: usize, k: usize, j: u64, count: u64) -> [f64; 3] {
    let (k, j, count) = (k as f64, j as f64, count as f64);
    if dim < 3 {
        let angle = PI * (j + (k * GOLDEN).fract()) / count;
        return [libm::cos(angle), libm::sin(angle), 0.0];
    }
    let height = (j + 0.5) / count;
    let azimuth = TAU * ((k * count + j) * GOLDEN).fract();
    let radius = (1.0 - height * height).sqrt();
    [radius * libm::cos(azimuth), radius * libm::sin(azimuth), height]
}

/// Of `m` and `-m` the one whose first coordinate that is not 0 is above 0.
fn upper(m: [i32; 3]) -> [i32; 3] {
    if m < [0; 3] { m.map(|x| -x) } else { m }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Rings, WaveGrid};

    fn list(sides: &[f64], f: &[u32], directions: u64) -> (WaveList, Rings, Rings) {
        let domain = Domain::torus(sides).unwrap();
        let list = WaveList::ring_directions(&domain, f, directions).unwrap();
        let rings = Rings::new(&list.clone().into(), &domain);
        (list, rings, Rings::new(&WaveGrid::new(f).unwrap().into(), &domain))
    }

    #[test]
    fn enough_directions_are_the_whole_rings() {
        for (sides, f) in [
            (vec![1.0], vec![20]),
            (vec![1.0, 1.0], vec![20, 20]),
            (vec![1.0, 3.7], vec![5, 18]),
            (vec![2.0, 1.0, 1.3], vec![9, 5, 6]),
        ] {
            let (list, rings, whole) = list(&sides, &f, 1 << 20);
            assert_eq!((rings.modes, &rings.bounds), (whole.modes, &whole.bounds), "{sides:?}");
            assert!(list.vectors.iter().all(|v| *v > [0.0; 3]));
        }
    }

    #[test]
    fn few_directions_are_members_evenly_spread() {
        for (sides, f, n) in [
            (vec![1.0, 1.0], vec![200, 200], 16),
            (vec![1.0, 40.0], vec![20, 800], 16),
            (vec![1.0, 1.0, 1.0], vec![40, 40, 40], 24),
            (vec![1.0, 2.0, 9.0], vec![10, 20, 90], 24),
        ] {
            let (list, rings, whole) = list(&sides, &f, n);
            assert_eq!(rings.count, whole.count, "{sides:?}");
            for (k, (&some, &all)) in rings.independent.iter().zip(&whole.independent).enumerate() {
                // Rows that a flat ring crosses at a grazing angle hold few members near a direction.
                let least = if sides.iter().all(|s| *s == sides[0]) { n / 2 } else { n / 4 };
                let fewest = all.min(if k > 30 { least } else { 1 });
                assert!((fewest..=all.min(n)).contains(&some), "{sides:?}, ring {}: {some} of {all}", k + 1);
                assert!(all > n || some == all, "{sides:?}, ring {}: {some} of {all}", k + 1);
            }
            let mut sorted = list.vectors.clone();
            sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
            sorted.dedup();
            assert_eq!(sorted.len(), list.vectors.len(), "each once");
        }
    }

    /// The mean of u u^T over directions is that of the sphere.
    #[test]
    fn no_direction_is_favoured() {
        for (dim, f) in [(2, vec![300, 300]), (3, vec![60, 60, 60])] {
            let list = WaveList::ring_directions(&Domain::unit_torus(dim), &f, 32).unwrap();
            let far: Vec<_> = list.vectors.iter().filter(|v| v.iter().map(|x| x * x).sum::<f64>() > 900.0).collect();
            for (a, b) in [(0, 0), (1, 1), (dim - 1, dim - 1), (0, 1), (0, dim - 1)] {
                let mean = far.iter().map(|v| v[a] * v[b] / v.iter().map(|x| x * x).sum::<f64>()).sum::<f64>()
                    / far.len() as f64;
                let expected = if a == b { 1.0 / dim as f64 } else { 0.0 };
                assert!((mean - expected).abs() < 0.01, "{dim}D, {a} {b}: {mean}");
            }
        }
    }

    #[test]
    fn high_frequencies_need_no_grid() {
        let list = WaveList::ring_directions(&Domain::unit_torus(2), &[20_000, 20_000], 4).unwrap();
        assert!((75_000..=80_000).contains(&list.vectors.len()), "{}", list.vectors.len());
        let error = WaveList::ring_directions(&Domain::unit_torus(2), &[20_000, 20_000], 1 << 40).unwrap_err();
        assert!(error.to_string().contains("bytes"), "{error}");
    }
}

//! What the sides of a window do to sums of pairs.

use std::f64::consts::TAU;

use crate::plan::{Correction, PairPlan};
use crate::points::Domain;

/// Places, directions and distances at which it is looked at, and fewer places where each pair is looked at from its other end too.
const PLACES: usize = 256;
const PLACES_BOTH_ENDS: usize = 64;
const DIRECTIONS: usize = 32;
const DISTANCES: usize = 32;

/// Places tried for each that is inside.
const TRIES: usize = 64;

/// How far the measure of the part of a shell that is inside, weighted by the edge correction, differs between places.
///
/// Points near the sides see less of a shell, and weights make up for it only on average, so that a sum of pairs follows the number of
/// points near the sides: what edge effects add to its variance.
pub(super) struct WindowEdges {
    /// Distances, evenly spread up to the last edge.
    pub(super) distances: [f64; DISTANCES],
    /// For each bin the nearest of them.
    pub(super) nearest: Vec<usize>,
    /// Per bin, the variance over places of that measure for its shell, and for all up to it.
    pub(super) variances: [Vec<f64>; 2],
}

impl WindowEdges {
    /// Of a window, with any correction but minus sampling.
    pub(super) fn new(plan: &PairPlan) -> Self {
        let (domain, bins, r_max) = (&plan.domain, &plan.bins, plan.bins.r_max());
        let distances: [f64; DISTANCES] = std::array::from_fn(|j| r_max * (j as f64 + 0.5) / DISTANCES as f64);
        let nearest = |r: f64| ((r / r_max * DISTANCES as f64) as usize).min(DISTANCES - 1);
        let nearest: Vec<usize> = bins.centres().into_iter().map(nearest).collect();
        let seen = parts_inside(domain, plan.correction, &distances);
        let mut moments = [vec![[0.0; 2]; bins.len()], vec![[0.0; 2]; bins.len()]];
        for parts in &seen {
            let mut ball = 0.0;
            for b in 0..bins.len() {
                let shell = bins.shell_measure(b, domain.dim()) * parts[nearest[b]];
                ball += shell;
                for (of, value) in moments.iter_mut().zip([shell, ball]) {
                    of[b][0] += value;
                    of[b][1] += value * value;
                }
            }
        }
        let count = seen.len().max(1) as f64;
        let variance = |[sum, squares]: &[f64; 2]| (squares - sum * sum / count).max(0.0) / count;
        Self { distances, nearest, variances: moments.map(|of| of.iter().map(variance).collect()) }
    }
}

/// Per place, the weighted part of the sphere of each radius that is inside.
fn parts_inside(domain: &Domain, correction: Correction, distances: &[f64; DISTANCES]) -> Vec<[f64; DISTANCES]> {
    let both_ends = correction == Correction::Isotropic;
    let places = places(domain, if both_ends { PLACES_BOTH_ENDS } else { PLACES });
    let directions: [[f64; 3]; DIRECTIONS] = std::array::from_fn(|i| direction(i, domain.dim()));
    let part = |x: &[f64; 3], r: f64| {
        directions.iter().filter(|u| inside(domain, &along(x, u, r))).count() as f64 / DIRECTIONS as f64
    };
    let mut parts = vec![[0.0; DISTANCES]; places.len()];
    for (j, &r) in distances.iter().enumerate() {
        for u in &directions {
            let seen: Vec<bool> = places.iter().map(|x| inside(domain, &along(x, u, r))).collect();
            let overlap = seen.iter().filter(|seen| **seen).count() as f64 / places.len() as f64;
            for ((x, parts), _) in places.iter().zip(&mut parts).zip(&seen).filter(|(_, seen)| **seen) {
                let weight = match correction {
                    Correction::Translation => 1.0 / overlap,
                    // Seen from here all directions together weigh 1; from there each weighs the inverse of the part inside.
                    Correction::Isotropic => 0.5 / part(&along(x, u, r), r).max(1.0 / DIRECTIONS as f64),
                    Correction::None | Correction::Border => 1.0,
                };
                parts[j] += weight / DIRECTIONS as f64;
            }
        }
    }
    parts
}

fn along(x: &[f64; 3], u: &[f64; 3], r: f64) -> [f64; 3] {
    std::array::from_fn(|k| x[k] + r * u[k])
}

/// Whether a place, seen from the origin of the domain, is inside.
fn inside(domain: &Domain, x: &[f64; 3]) -> bool {
    let origin = domain.origin();
    domain.sides().iter().zip(x).all(|(side, x)| (0.0..*side).contains(x))
        && domain.as_polygon().is_none_or(|polygon| polygon.contains_point([0, 1].map(|k| origin[k] + x[k])))
}

/// Places evenly spread over the domain: multiples of powers of a number far from all fractions, modulo 1 (Roberts, "The
/// unreasonable effectiveness of quasirandom sequences", 2018).
fn places(domain: &Domain, count: usize) -> Vec<[f64; 3]> {
    let root: f64 = [1.618_033_988_749_895, 1.324_717_957_244_746, 1.220_744_084_605_76][domain.dim() - 1];
    let place = |i: usize| -> [f64; 3] {
        std::array::from_fn(|k| {
            let part = 0.5 + i as f64 * root.powi(-(k as i32 + 1));
            domain.sides().get(k).map_or(0.0, |side| part.fract() * side)
        })
    };
    (0..count * TRIES).map(place).filter(|x| inside(domain, x)).take(count).collect()
}

/// One of evenly spread directions.
fn direction(i: usize, dim: usize) -> [f64; 3] {
    let part = (i as f64 + 0.5) / DIRECTIONS as f64;
    match dim {
        1 => [if i.is_multiple_of(2) { 1.0 } else { -1.0 }, 0.0, 0.0],
        2 => [(TAU * part).cos(), (TAU * part).sin(), 0.0],
        _ => {
            let (z, angle) = (1.0 - 2.0 * part, TAU * 0.618_033_988_749_895 * i as f64);
            let rho = (1.0 - z * z).sqrt();
            [rho * angle.cos(), rho * angle.sin(), z]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{EnsembleShape, RadialBins};

    /// Of the two points at distance r on a line of length 1, one is outside for 2 r of all places: with weight 1 the variance of
    /// the part that is inside is `r (1 - 2 r) / 2`.
    #[test]
    fn sides_of_an_interval() {
        let domain = Domain::window(&[(2.0, 3.0)]).unwrap();
        let shape = EnsembleShape { realizations: 1, mean_points: 10.0, max_points: 10 };
        let bins = RadialBins::linear(0.4, 32).unwrap();
        for correction in [Correction::None, Correction::Translation] {
            let plan = PairPlan::new(&domain, bins.clone(), correction, shape).unwrap();
            let edges = WindowEdges::new(&plan);
            for b in 0..32 {
                let (r, shell) = (bins.centres()[b], 2.0 * 0.4 / 32.0);
                let weight = if correction == Correction::None { 1.0 } else { 1.0 / (1.0 - r) };
                let expected = 0.5 * r * (1.0 - 2.0 * r) * (shell * weight).powi(2);
                let found = edges.variances[0][b];
                assert!((found - expected).abs() < 0.1 * expected, "{correction}, {r}: {found}, expected {expected}");
            }
        }
    }

    /// Isotropic on the same line, r below a quarter: seen from its other end too, a pair weighs `1/2 1/part` there, with part 1/2 nearer
    /// than r to an end. One of four pieces of length r each weighs 1/4 or 3/4, all the rest 1/2: a variance of `4 r / 16`.
    #[test]
    fn sides_of_an_interval_from_both_ends() {
        let domain = Domain::window(&[(2.0, 3.0)]).unwrap();
        let shape = EnsembleShape { realizations: 1, mean_points: 10.0, max_points: 10 };
        let bins = RadialBins::linear(0.24, 32).unwrap();
        let plan = PairPlan::new(&domain, bins.clone(), Correction::Isotropic, shape).unwrap();
        let edges = WindowEdges::new(&plan);
        for b in 8..32 {
            let (r, shell) = (bins.centres()[b], 2.0 * 0.24 / 32.0);
            let (found, expected) = (edges.variances[0][b], 0.25 * r * shell * shell);
            assert!((found - expected).abs() < 0.2 * expected, "{r}: {found}, expected {expected}");
        }
    }
}

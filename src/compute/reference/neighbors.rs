//! Nearest neighbours, by the definition: all points are compared with all.
//!
//! For points `x_1 .. x_n` and test points `y_1 .. y_p` in a box:
//!
//! ```text
//! d_i = min_(j != i) |x_i - x_j|        e_k = min_j |y_k - x_j|
//! ```
//!
//! with `|.|` as in `pair_counts`. G is the distribution function of d, F that of e. On a torus it is the share of distances
//! below r. In a window a distance s is censored at b, the way to the border, if s > b; with `o = min(s, b)` and the
//! distinct uncensored `s_1 < s_2 < ..` (Kaplan and Meier; Baddeley and Gill, "Kaplan-Meier estimators of distance
//! distributions for spatial point processes", Annals of Statistics 25, 1997):
//!
//! ```text
//! F(r) = 1 - prod_(s_l < r) (1 - #{uncensored, s = s_l} / #{o >= s_l})
//! ```
//!
//! In the plane, points i and j are neighbours if their Voronoi cells share an edge: some stretch of the line of all places
//! equally far from both on which no other point is nearer. With the angles theta of the bonds from i to its N_i neighbours
//! (Nelson and Halperin, "Dislocation-mediated melting in two dimensions", Phys. Rev. B 19, 1979):
//!
//! ```text
//! psi_6(i) = (1 / N_i) sum_j exp(6 i theta_ij)
//! ```
//!
//! Stretches shorter than 1e-5 of the distance of the points are corners. On a torus images count as points of their own:
//! an edge is no further than half a side from either point along any axis, so those of the eight boxes around are all that
//! matter. In a window, points whose cells reach to infinity are left out.

use crate::accumulate::{
    Bonds, COUNT_STEPS, Distances, DistributionCounts, NeighborSums, NoBonds, RealizationNeighbors,
};
use crate::compute::neighbors::sides;
use crate::control::Control;
use crate::error::Result;
use crate::plan::NeighborPlan;
use crate::points::geometry::squared_distance;
use crate::points::{Domain, Ensemble};

/// Of every realization.
pub(super) fn neighbors(plan: &NeighborPlan, ensemble: &Ensemble, control: &Control) -> Result<NeighborSums> {
    let mut sums = NeighborSums::default();
    let [from, to] = sides(plan, ensemble);
    let within = plan.classes.is_none_or(|[a, b]| a == b);
    for k in 0..ensemble.realizations() {
        let (axes, others) = (from.lengths(k), to.lengths(k));
        let (n, m) = (axes[0].len(), others[0].len());
        // Those from which stand behind those to which.
        let both: Vec<Vec<u64>> = others.iter().zip(&axes).map(|(to, from)| [*to, *from].concat()).collect();
        let both: Vec<&[u64]> = both.iter().map(Vec::as_slice).collect();
        let mut nearest = Vec::with_capacity(n);
        for i in 0..n {
            control.check()?;
            let others = (0..m).filter(|&j| !within || j != i);
            nearest.push(others.map(|j| squared_distance(&both, plan.domain.periods(), m + i, j)).min());
        }
        let mut empty = Vec::with_capacity(plan.probes.len());
        for probe in 0..plan.probes.len() {
            control.check()?;
            // The test point stands behind the points.
            let place = plan.probes.position(probe);
            let with: Vec<Vec<u64>> = others.iter().zip(place).map(|(axis, y)| [*axis, &[y][..]].concat()).collect();
            let with: Vec<&[u64]> = with.iter().map(Vec::as_slice).collect();
            empty.push((0..m).map(|j| squared_distance(&with, plan.domain.periods(), m, j)).min());
        }
        let one = RealizationNeighbors {
            index: ensemble.first_index() + k as u64,
            n: n as u64,
            distances: distances(&nearest, &plan.domain),
            bonds: if plan.bonds { bonds(&axes, &plan.domain, control)? } else { Err(NoBonds::NotAskedFor) },
        };
        let place = |i: usize| std::array::from_fn(|a| axes.get(a).map_or(0, |axis| axis[i]));
        let g = distribution(plan, &nearest, place);
        let f = distribution(plan, &empty, |i| plan.probes.position(i));
        sums.add(one, &g, &f);
    }
    Ok(sums)
}

/// The closest pair and the mean over points; `None` without a pair.
fn distances(squares: &[Option<u128>], domain: &Domain) -> Option<Distances> {
    let step = domain.length_unit() / 2f64.powi(64);
    let distances: Vec<f64> = squares.iter().flatten().map(|&square| (square as f64).sqrt() * step).collect();
    let n = distances.len() as f64;
    (!distances.is_empty()).then(|| Distances {
        minimum: distances.iter().copied().fold(f64::INFINITY, f64::min),
        mean: distances.iter().sum::<f64>() / n,
        closest_packing: domain.closest_packing_distance(n),
    })
}

/// Of squared distances, taken from `place(i)`; `None` is infinitely far.
fn distribution(
    plan: &NeighborPlan,
    squares: &[Option<u128>],
    place: impl Fn(usize) -> [u64; 3],
) -> DistributionCounts {
    let border = plan.domain.border();
    let observed: Vec<(u128, bool)> = (0..squares.len())
        .map(|i| {
            let square = squares[i].unwrap_or(u128::MAX);
            let border = u128::from(border.distance(&place(i)[..plan.domain.dim()])).pow(2);
            if plan.domain.is_torus() || square <= border { (square, true) } else { (border, false) }
        })
        .collect();
    let mut seen: Vec<u128> = observed.iter().filter(|o| o.1).map(|o| o.0).collect();
    seen.sort_unstable();
    seen.dedup();
    let at_least = |s: u128| observed.iter().filter(|o| o.0 >= s).count();
    let count = |&threshold: &u128| {
        if plan.domain.is_torus() {
            return ((squares.len() - at_least(threshold)) as u128) << 32;
        }
        let mut survival = 1.0;
        for &s in seen.iter().take_while(|&&s| s < threshold) {
            let deaths = observed.iter().filter(|&&o| o == (s, true)).count();
            survival *= 1.0 - deaths as f64 / at_least(s) as f64;
        }
        ((1.0 - survival) * squares.len() as f64 * COUNT_STEPS).round() as u128
    };
    DistributionCounts {
        points: squares.len() as u64,
        counts: plan.thresholds.iter().map(count).collect(),
        at_risk: plan.thresholds.iter().map(|&threshold| at_least(threshold) as u64).collect(),
    }
}

/// The least length of an edge between cells, in distances of their points.
const CORNER: f64 = 1e-5;

/// Of one realization, or why there is none.
fn bonds(axes: &[&[u64]], domain: &Domain, control: &Control) -> Result<std::result::Result<Bonds, NoBonds>> {
    let &[x, y] = axes else { return Ok(Err(NoBonds::NotPlanar)) };
    if domain.as_polygon().is_some() {
        return Ok(Err(NoBonds::InPolygon));
    }
    if x.len() < 3 {
        return Ok(Err(NoBonds::FewPoints));
    }
    // Points that coincide have one cell.
    let place = |i: usize| [x[i], y[i]];
    let points: Vec<[u64; 2]> = (0..x.len()).filter(|&i| (0..i).all(|j| place(j) != place(i))).map(place).collect();
    let mut found = Bonds { points: 0, with_neighbors: [0; 3], local: 0.0, global: 0.0 };
    let mut sum = [0.0; 2];
    for &point in &points {
        control.check()?;
        let Some((psi, neighbors)) = psi(&offsets(point, &points, domain)) else { continue };
        found.points += 1;
        if let 5..=7 = neighbors {
            found.with_neighbors[neighbors - 5] += 1;
        }
        found.local += psi[0].hypot(psi[1]);
        sum = [sum[0] + psi[0], sum[1] + psi[1]];
    }
    if found.points == 0 {
        return Ok(Err(NoBonds::AllOutside));
    }
    found.local /= found.points as f64;
    found.global = sum[0].hypot(sum[1]) / found.points as f64;
    Ok(Ok(found))
}

/// From a point to all others, images included.
fn offsets(from: [u64; 2], points: &[[u64; 2]], domain: &Domain) -> Vec<[f64; 2]> {
    let period = |a: usize| if domain.periods()[a] == 0 { 1i128 << 64 } else { i128::from(domain.periods()[a]) };
    let turns = if domain.is_torus() { -1..=1 } else { 0..=0 };
    let mut offsets = Vec::new();
    for to in points {
        for right in turns.clone() {
            for up in turns.clone() {
                let along =
                    |a: usize, turns: i128| (i128::from(to[a]) - i128::from(from[a]) + turns * period(a)) as f64;
                offsets.push([along(0, right), along(1, up)]);
            }
        }
    }
    offsets.retain(|&offset| offset != [0.0; 2]);
    offsets
}

/// psi_6 of the point at the origin and its number of neighbours; `None` if its cell reaches to infinity.
fn psi(others: &[[f64; 2]]) -> Option<([f64; 2], usize)> {
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let (mut sum, mut neighbors) = ([0.0; 2], 0);
    for &d in others {
        // Equally far from both are the places d / 2 + t d', with d' across d and as long. Point k is no nearer to them where
        // t (d' . k) <= (k . k - d . k) / 2.
        let across = [-d[1], d[0]];
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for &k in others.iter().filter(|&&k| k != d) {
            let (slope, bound) = (dot(across, k), 0.5 * (dot(k, k) - dot(d, k)));
            if slope > 0.0 {
                to = to.min(bound / slope);
            } else if slope < 0.0 {
                from = from.max(bound / slope);
            } else if bound < 0.0 {
                to = f64::NEG_INFINITY;
            }
            if to - from <= CORNER {
                break;
            }
        }
        if to - from <= CORNER {
            continue;
        }
        if from.is_infinite() || to.is_infinite() {
            return None;
        }
        let theta = d[1].atan2(d[0]);
        sum = [sum[0] + (6.0 * theta).cos(), sum[1] + (6.0 * theta).sin()];
        neighbors += 1;
    }
    (neighbors > 0).then(|| (sum.map(|x| x / neighbors as f64), neighbors))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::neighbors::neighbor_sums;
    use crate::plan::EnsembleShape;
    use crate::points::RawPoints;

    /// Fractions of the sides of points that no two distances of are alike.
    fn scattered(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / 2f64.powi(53)
        };
        (0..n).map(|_| unit()).collect()
    }

    fn ensemble(domain: &Domain, sets: &[Vec<f64>]) -> Ensemble {
        let dim = domain.dim();
        let place = |(i, x): (usize, &f64)| domain.origin()[i % dim] + x * domain.sides()[i % dim];
        let raw = sets.iter().map(|set| RawPoints {
            dim,
            coordinates: set.iter().enumerate().map(place).collect(),
            source: "test".into(),
            lines: Vec::new(),
        });
        Ensemble::from_raw(&raw.collect::<Vec<_>>(), domain, domain.is_torus(), 5).unwrap()
    }

    fn plan(ensemble: &Ensemble) -> NeighborPlan {
        let sizes: Vec<u64> = (0..ensemble.realizations()).map(|k| ensemble.points_in(k) as u64).collect();
        let shape = EnsembleShape { realizations: 200, ..EnsembleShape::of(&sizes) };
        NeighborPlan::new(ensemble.domain(), None, shape).unwrap()
    }

    /// What differs: integers to one step of a distribution's 2^-32 per point, numbers to some roundings of f64.
    fn difference(a: &NeighborSums, b: &NeighborSums) -> Option<String> {
        for (name, a, b) in [("G", &a.nearest, &b.nearest), ("F", &a.empty, &b.empty)] {
            let counts = a.counts.iter().zip(&b.counts).any(|(a, b)| a.abs_diff(*b) > 4 * a.max(b) / (1 << 40) + 8);
            if (a.points, &a.at_risk) != (b.points, &b.at_risk) || a.counts.len() != b.counts.len() || counts {
                return Some(name.into());
            }
        }
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-11 * (1.0 + a.abs());
        let alike = |a: &RealizationNeighbors, b: &RealizationNeighbors| {
            let distances = match (a.distances, b.distances) {
                (Some(a), Some(b)) => {
                    let relative = |a: f64, b: f64| (a - b).abs() <= 1e-14 * a;
                    relative(a.minimum, b.minimum) && relative(a.mean, b.mean) && a.closest_packing == b.closest_packing
                }
                (a, b) => a == b,
            };
            let bonds = match (a.bonds, b.bonds) {
                (Ok(a), Ok(b)) => {
                    (a.points, a.with_neighbors) == (b.points, b.with_neighbors)
                        && near(a.local, b.local)
                        && near(a.global, b.global)
                }
                (a, b) => a == b,
            };
            (a.index, a.n) == (b.index, b.n) && distances && bonds
        };
        if a.realizations.len() != b.realizations.len() {
            return Some("number of realizations".into());
        }
        let wrong = a.realizations.iter().zip(&b.realizations).find(|(a, b)| !alike(a, b))?;
        Some(format!("{wrong:?}"))
    }

    fn domains() -> Vec<Domain> {
        let sides = [1.0, 0.712_345_678_901, 1.234_567_890_123];
        let windows = [(-0.1, 1.1), (0.0, 1.7), (5.0, 5.8)];
        (1..=3)
            .flat_map(|dim| {
                let (torus, window) = (Domain::torus(&sides[..dim]).unwrap(), Domain::window(&windows[..dim]).unwrap());
                [Domain::unit_torus(dim), torus, window]
            })
            .collect()
    }

    #[test]
    fn the_fast_search_agrees() {
        for domain in domains() {
            let sets: Vec<_> = [40, 0, 1, 2, 150].map(|n| scattered(n * domain.dim(), 7 + n as u64)).into();
            let points = ensemble(&domain, &sets);
            let plan = plan(&points);
            let truth = neighbors(&plan, &points, &Control::default()).unwrap();
            let fast = neighbor_sums(&plan, &points, &Control::default()).unwrap();
            assert_eq!(difference(&truth, &fast), None, "{domain:?}");
            let planar = domain.dim() == 2;
            assert!(truth.realizations.iter().all(|r| r.bonds.is_ok() == (planar && r.n > 2)), "{domain:?}");
            // Of classes: within one, between two, to one of which there is no point.
            let total = points.total_points() as u32;
            let points = points.with_classes((0..total).map(|j| j * j % 3).collect());
            for classes in [[0, 0], [0, 1], [1, 0], [1, 2]] {
                let plan = NeighborPlan { classes: Some(classes), bonds: false, ..plan.clone() };
                let truth = neighbors(&plan, &points, &Control::default()).unwrap();
                let fast = neighbor_sums(&plan, &points, &Control::default()).unwrap();
                assert_eq!(difference(&truth, &fast), None, "{domain:?} {classes:?}");
            }
        }
    }

    /// The comparison above sees a point moved by a thousandth of its distance, a bond lost, and a distance miscounted.
    #[test]
    fn a_fault_is_seen() {
        for domain in domains() {
            let set = scattered(60 * domain.dim(), 3);
            let mut moved = set.clone();
            moved[0] = (moved[0] + 1e-5).min(0.999);
            let points = ensemble(&domain, &[set]);
            let plan = plan(&points);
            let truth = neighbors(&plan, &points, &Control::default()).unwrap();
            let fast = |points: &Ensemble| neighbor_sums(&plan, points, &Control::default()).unwrap();
            assert!(difference(&truth, &fast(&ensemble(&domain, &[moved]))).is_some(), "{domain:?}");
            let mut off = fast(&points);
            off.empty.counts[9] += 1 << 32;
            assert!(difference(&truth, &off).is_some(), "{domain:?}");
            let mut off = fast(&points);
            if let Ok(bonds) = &mut off.realizations[0].bonds {
                bonds.with_neighbors[1] += 1;
                assert!(difference(&truth, &off).is_some(), "{domain:?}");
            }
        }
    }

    /// Four neighbours in a square lattice, whose cells meet at corners; six in one of triangles.
    #[test]
    fn lattices_have_the_order_they_are_known_for() {
        let square: Vec<f64> = (0..36).flat_map(|i| [i % 6, i / 6].map(|c| f64::from(c) / 6.0)).collect();
        let triangles: Vec<f64> = (0..48u32)
            .flat_map(|i| {
                let (column, row) = (i % 6, i / 6);
                [(f64::from(column) + 0.5 * f64::from(row % 2)) / 6.0, f64::from(row) / 8.0]
            })
            .collect();
        let slim = Domain::torus(&[1.0, 8.0 / 6.0 * 0.75f64.sqrt()]).unwrap();
        for (domain, set, six, order) in [(Domain::unit_torus(2), square, 0, 0.0), (slim, triangles, 48, 1.0)] {
            let points = ensemble(&domain, &[set]);
            let found = neighbors(&plan(&points), &points, &Control::default()).unwrap();
            let bonds = found.realizations[0].bonds.unwrap();
            assert_eq!(bonds.with_neighbors[1], six);
            assert!((bonds.local - order).abs() < 1e-9 && (bonds.global - order).abs() < 1e-9, "{bonds:?}");
        }
    }
}

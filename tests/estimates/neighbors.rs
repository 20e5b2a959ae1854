//! Nearest-neighbour statistics: distances, their distribution functions, bond order.
//!
//! Trusts the exact search (its own tests compare it with all pairs). Compares with closed forms in standard errors, with
//! figures of spatstat and freud, and shows that the comparison with a closed form would notice missing edge correction.

use crate::common::*;
use pairwave::accumulate::{CrossNeighborSums, NeighborSums};
use pairwave::compute::neighbors::neighbor_sums;
use pairwave::control::Control;
use pairwave::estimate::{CrossNeighbors, ErrorSource, Neighbors};
use pairwave::plan::{NeighborPlan, RadialBins};
use pairwave::points::read::{ReadOptions, read_all};
use pairwave::points::{Domain, Ensemble, RawPoints};
use std::f64::consts::PI;

fn plan(ensemble: &Ensemble, edges: Option<&[f64]>) -> NeighborPlan {
    let bins = edges.map(|e| RadialBins::from_edges(e.to_vec()).unwrap());
    NeighborPlan::new(ensemble.domain(), bins.as_ref(), shape(ensemble)).unwrap()
}

fn sums(plan: &NeighborPlan, ensemble: &Ensemble) -> NeighborSums {
    neighbor_sums(plan, ensemble, &Control::default()).unwrap()
}

fn measure_at(ensemble: &Ensemble, edges: &[f64]) -> Neighbors {
    let plan = plan(ensemble, Some(edges));
    Neighbors::new(&plan, &sums(&plan, ensemble), shape(ensemble))
}

fn measure(domain: &Domain, sets: &[RawPoints]) -> Neighbors {
    let ensemble = Ensemble::from_raw(sets, domain, domain.is_torus(), 0).unwrap();
    let plan = plan(&ensemble, None);
    Neighbors::new(&plan, &sums(&plan, &ensemble), shape(&ensemble))
}

/// Uniform points, stretched into the domain.
fn scattered(domain: &Domain, n: usize, seed: u64) -> RawPoints {
    let mut points = uniform(domain.dim(), n, seed);
    for (i, x) in points.coordinates.iter_mut().enumerate() {
        let a = i % domain.dim();
        *x = domain.origin()[a] + *x * domain.sides()[a];
    }
    points
}

fn ball(dim: usize, r: f64) -> f64 {
    [2.0 * r, PI * r * r, 4.0 / 3.0 * PI * r.powi(3)][dim - 1]
}

fn read(name: &str) -> Vec<RawPoints> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    read_all(&[path], &ReadOptions::default()).unwrap()
}

#[test]
fn the_distances_of_small_cases() {
    let domain = Domain::torus(&[4.0, 2.0]).unwrap();
    let (none, single) = (raw(2, vec![]), raw(2, vec![1.0, 1.0]));
    // Across the boundary: 1 apart in x, 0 in y.
    let pair = raw(2, vec![0.25, 1.0, 3.25, 1.0]);
    // 0.5 and 0.5 apart in y, the third sees the second.
    let triple = raw(2, vec![1.0, 0.0, 1.0, 0.5, 1.0, 1.25]);
    let ensemble = Ensemble::from_raw(&[none, single, pair, triple], &domain, false, 10).unwrap();
    let plan = plan(&ensemble, None);
    let whole = sums(&plan, &ensemble);
    let indices: Vec<_> = whole.realizations.iter().map(|r| (r.index, r.n, r.distances.is_some())).collect();
    assert_eq!(indices, [(10, 0, false), (11, 1, false), (12, 2, true), (13, 3, true)]);
    let found = Neighbors::new(&plan, &whole, shape(&ensemble)).distances;
    let packing = [2.0, 3.0].map(|n: f64| (2.0 / (3f64.sqrt() * n / 8.0)).sqrt());
    assert_eq!((found.minimum, found.mean_minimum), (Some(0.5), Some(0.75)));
    assert_eq!(found.mean, Some((1.0 + 1.75 / 3.0) / 2.0));
    // Two values a and b: |a - b| / 2.
    assert_eq!(found.mean_minimum_se, Some(0.25));
    assert!((found.mean_se.unwrap() - (1.0 - 1.75 / 3.0) / 2.0).abs() < 1e-15);
    assert_eq!(found.minimum_relative, Some(0.5 / packing[1]));
    assert_eq!(found.mean_minimum_relative, Some((1.0 / packing[0] + 0.5 / packing[1]) / 2.0));
    assert_eq!(found.mean_relative, Some((1.0 / packing[0] + 1.75 / 3.0 / packing[1]) / 2.0));

    let estimates = |range: std::ops::Range<usize>| {
        let part = sums(&plan, &ensemble.slice(range));
        Neighbors::new(&plan, &part, shape(&ensemble)).distances
    };
    assert_eq!(estimates(0..2), Default::default(), "nobody has a neighbour");
    assert_eq!((estimates(1..3).mean, estimates(1..3).mean_se), (Some(1.0), None));
}

#[test]
fn random_points_have_the_mean_distance_of_a_poisson_process() {
    // 1 / (2 sqrt(lambda)) for n to infinity; with n - 1 others Gamma(n) / (2 Gamma(n + 1/2)), 1 + 1/(8 n) times that.
    let n = 2000;
    let sets: Vec<_> = (0..200).map(|k| uniform(2, n, k)).collect();
    let found = measure(&Domain::unit_torus(2), &sets).distances;
    let expected = 0.5 / (n as f64).sqrt() * (1.0 + 1.0 / 8.0 / n as f64);
    let z = (found.mean.unwrap() - expected) / found.mean_se.unwrap();
    assert!(z.abs() < 4.0, "{z} standard errors off");
}

#[test]
fn parts_and_threads_do_not_change_a_bit() {
    for domain in [Domain::torus(&[1.0, 0.7]).unwrap(), Domain::window(&[(0.0, 1.0), (-1.0, 2.0)]).unwrap()] {
        let sets: Vec<_> = (0..20).map(|k| scattered(&domain, 5 + 13 * k as usize, k)).collect();
        let ensemble = Ensemble::from_raw(&sets, &domain, false, 32).unwrap();
        let plan = plan(&ensemble, None);
        let whole = sums(&plan, &ensemble);
        for cut in [1, 7, 16] {
            let [left, right] = [0..cut, cut..20].map(|range| sums(&plan, &ensemble.slice(range)));
            for (mut a, b) in [(left.clone(), &right), (right.clone(), &left)] {
                a.merge(b).unwrap();
                assert_eq!(a, whole, "cut at {cut}");
                assert!(a.merge(b).unwrap_err().to_string().contains("both parts hold realization"));
            }
        }
        for threads in [1, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| sums(&plan, &ensemble)), whole, "{threads} threads");
        }
    }
}

/// G and F of n independent points on a torus: 1 - (1 - v)^m with m = n - 1 and n, v the share of the ball.
#[test]
fn functions_of_random_points() {
    for (dim, n) in [(1, 40), (2, 50), (3, 60)] {
        let domain = Domain::torus(&[1.0, 0.8, 1.3][..dim]).unwrap();
        let sets: Vec<_> = (0..400).map(|k| scattered(&domain, n, k)).collect();
        let ensemble = Ensemble::from_raw(&sets, &domain, false, 0).unwrap();
        let packing = domain.closest_packing_distance(n as f64);
        let edges: Vec<f64> = [0.1, 0.2, 0.35, 0.5, 0.7].iter().map(|x| x * packing).collect();
        let found = measure_at(&ensemble, &edges).functions;
        assert_eq!((found.errors, &found.r), (ErrorSource::AcrossRealizations, &edges));
        for (i, &r) in edges.iter().enumerate() {
            let missed = 1.0 - ball(dim, r) / domain.measure();
            let (g, f) = (1.0 - missed.powi(n as i32 - 1), 1.0 - missed.powi(n as i32));
            for (name, value, se, expected) in
                [("G", found.g[i], found.g_se[i], g), ("F", found.f[i], found.f_se[i], f)]
            {
                let z = (value.unwrap() - expected) / se.unwrap();
                assert!(z.abs() < 4.0, "{dim}D, {name}({r}): {value:?}, not {expected}: {z} standard errors");
            }
            let j = (1.0 - found.g[i].unwrap()) / (1.0 - found.f[i].unwrap());
            assert_eq!(found.j[i], Some(j));
            let poisson = 1.0 - (-(n as f64) * ball(dim, r) / domain.measure()).exp();
            assert!((found.poisson[i] - poisson).abs() < 1e-12);
        }
    }
}

/// In a window the same curves come out, for the Kaplan-Meier estimator knows of the border; plain shares do not.
#[test]
fn a_window_shows_the_curves_of_the_whole_plane() {
    let (n, domain) = (100, Domain::window(&[(0.0, 2.0), (3.0, 4.0)]).unwrap());
    // Poisson numbers would do; fixed ones make G and F those of the binomial process to 1/n, so allow for that.
    let sets: Vec<_> = (0..400).map(|k| scattered(&domain, n, k)).collect();
    let ensemble = Ensemble::from_raw(&sets, &domain, false, 0).unwrap();
    let packing = domain.closest_packing_distance(n as f64);
    let edges: Vec<f64> = [0.2, 0.4, 0.6, 0.8].iter().map(|x| x * packing).collect();
    let found = measure_at(&ensemble, &edges).functions;
    let distances: Vec<f64> = sets.iter().flat_map(|s| nearest(&s.coordinates)).collect();
    let plain = edges.iter().map(|r| distances.iter().filter(|d| *d < r).count() as f64 / distances.len() as f64);
    let mut worst_plain: f64 = 0.0;
    for ((i, &r), plain) in edges.iter().enumerate().zip(plain) {
        let missed = 1.0 - ball(2, r) / domain.measure();
        let (g, f) = (1.0 - missed.powi(n as i32 - 1), 1.0 - missed.powi(n as i32));
        for (name, value, se, expected) in [("G", found.g[i], found.g_se[i], g), ("F", found.f[i], found.f_se[i], f)] {
            let off = (value.unwrap() - expected).abs();
            assert!(off < 4.0 * se.unwrap() + 0.2 / n as f64, "{name}({r}): {value:?}, not {expected} ± {se:?}");
        }
        worst_plain = worst_plain.max((plain - g).abs() / found.g_se[i].unwrap());
    }
    assert!(worst_plain > 10.0, "no correction would pass as well: {worst_plain} standard errors off");
}

/// Plain distances to the nearest other point, in the plane.
fn nearest(xy: &[f64]) -> Vec<f64> {
    let points: Vec<_> = xy.chunks_exact(2).collect();
    let distance = |a: &[f64], b: &[f64]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let others = |i: usize| (0..points.len()).filter(move |&j| j != i);
    (0..points.len()).map(|i| others(i).map(|j| distance(points[i], points[j])).fold(f64::INFINITY, f64::min)).collect()
}

/// A square lattice with spacing s: every point has its neighbours at s, discs of radius below s/2 do not overlap.
#[test]
fn functions_of_a_lattice() {
    let k = 16;
    let s = 1.0 / k as f64;
    let edges = [0.2 * s, 0.45 * s, 0.999 * s, 1.001 * s];
    let found = measure_at(&ensemble(&[lattice(2, k)]), &edges).functions;
    assert_eq!(found.errors, ErrorSource::Theory);
    assert_eq!(found.g, [0.0, 0.0, 0.0, 1.0].map(Some));
    assert_eq!(found.g_se, [0.0; 4].map(Some));
    for (i, r) in edges.iter().enumerate().take(2) {
        let expected = PI * r * r / (s * s);
        assert!((found.f[i].unwrap() - expected).abs() < 0.005, "F({r}) = {:?}, not {expected}", found.f[i]);
        assert_eq!(found.j[i], Some(1.0 / (1.0 - found.f[i].unwrap())));
    }
    // Half the diagonal of a cell is the longest way to a point.
    assert_eq!((found.f[2], found.j[2], found.j[3]), (Some(1.0), None, None));
}

/// Points that keep a distance: G is 0 below it, J above 1, and F is the disc's area below half of it.
#[test]
fn functions_of_a_hard_core() {
    let mut rng = Rng(4);
    let distance = 0.06;
    let mut points: Vec<[f64; 2]> = Vec::new();
    while points.len() < 120 {
        let p = [rng.unit(), rng.unit()];
        let apart = |a: f64, b: f64| (a - b).abs().min(1.0 - (a - b).abs());
        if points.iter().all(|q| apart(p[0], q[0]).hypot(apart(p[1], q[1])) >= distance) {
            points.push(p);
        }
    }
    let edges = [0.02, 0.029, 0.059, 0.2];
    let found = measure_at(&ensemble(&[raw(2, points.concat())]), &edges).functions;
    assert_eq!(found.g[..3], [Some(0.0); 3]);
    assert!(found.j[2].unwrap() > 1.5);
    for (i, &r) in edges.iter().enumerate().take(2) {
        let expected = 120.0 * ball(2, r);
        // The lattice has some 16,000 test points.
        assert!((found.f[i].unwrap() - expected).abs() < 0.01, "{:?}, not {expected}", found.f[i]);
    }
    assert_eq!((found.g[3], found.f[3]), (Some(1.0), Some(1.0)));
}

/// spatstat.explore 3.0-6: Gest and Fest of swedishpines, correction "km", r in steps of 0.005, Fest with eps = 0.1. The r below
/// are no distances between points of integer coordinates.
#[test]
fn swedish_pines_as_spatstat_sees_them() {
    let domain = Domain::window(&[(0.0, 96.0), (0.0, 100.0)]).unwrap();
    let ensemble = Ensemble::from_raw(&read("swedishpines.csv"), &domain, false, 0).unwrap();
    let figures = [
        (1.7, 0.0, 0.066_234_829_93),
        (2.7, 0.016_666_666_67, 0.161_335_385_31),
        (3.3, 0.15, 0.238_977_475_54),
        (4.3, 0.166_666_666_67, 0.393_983_776_71),
        (5.9, 0.236_111_111_11, 0.671_730_917_14),
        (6.7, 0.305_555_555_56, 0.788_483_947_60),
        (7.9, 0.486_882_716_05, 0.909_250_354_90),
        (8.7, 0.596_836_419_75, 0.956_015_705_78),
        (9.6, 0.711_371_527_78, 0.985_176_777_35),
        (10.7, 0.846_064_814_81, 0.998_193_216_81),
        (11.7, 0.942_274_305_56, 1.0),
        (13.3, 1.0, 1.0),
    ];
    let found = measure_at(&ensemble, &figures.map(|f| f.0)).functions;
    for (i, (r, g, f)) in figures.into_iter().enumerate() {
        assert!((found.g[i].unwrap() - g).abs() < 1e-9, "G({r}) = {:?}, not {g}", found.g[i]);
        // Two lattices of test points.
        assert!((found.f[i].unwrap() - f).abs() < 0.003, "F({r}) = {:?}, not {f}", found.f[i]);
    }
    let nearest = measure_at(&ensemble, &[1.0, 2.0]).distances;
    assert!((nearest.minimum.unwrap() / 5f64.sqrt() - 1.0).abs() < 1e-13);
    assert!((nearest.mean.unwrap() / 7.907_540_558_274_65 - 1.0).abs() < 1e-13);
}

/// No more is said where nothing was seen: one point in a window has no neighbour, and its border is near.
#[test]
fn too_small_a_window_leaves_cells_empty() {
    let domain = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let found = measure(&domain, &[raw(2, vec![0.5, 0.5])]);
    let functions = &found.functions;
    let last = functions.r.iter().rposition(|r| *r <= 0.5).unwrap();
    assert_eq!((functions.g[last], functions.g[last + 1]), (Some(0.0), None));
    assert!(functions.f.iter().flatten().all(|f| (0.0..=1.0).contains(f)));
    assert_eq!(found.bonds, Err("fewer than 3 points"));
}

fn bonds(domain: &Domain, points: &[f64]) -> Result<pairwave::estimate::BondOrder, &'static str> {
    measure(domain, &[raw(domain.dim(), points.to_vec())]).bonds
}

/// Rows of the hexagonal lattice on a torus of sides `columns` and `rows sqrt(3)/2`; rows must be even.
/// Lines on which a triangulation would take quadratic time, with some points beside them; a lattice is no such thing.
#[test]
fn many_points_on_a_line_are_refused() {
    let reason = Err("a quarter of the points or more lie on one line");
    let line = |slope: f64, n: u32| {
        (0..n).flat_map(move |i| [f64::from(i) / f64::from(n), slope * f64::from(i) / f64::from(n)])
    };
    let beside = [0.3, 0.7, 0.6, 0.2];
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    for domain in [Domain::unit_torus(2), window] {
        for slope in [0.0, 0.25] {
            let points: Vec<f64> = line(slope, 20_000).chain(beside).collect();
            assert_eq!(bonds(&domain, &points), reason);
        }
        let half: Vec<f64> = line(0.25, 2000).chain(uniform(2, 3000, 1).coordinates).collect();
        assert_eq!(bonds(&domain, &half), reason);
        let lattice: Vec<f64> = (0..3600).flat_map(|i| [f64::from(i % 60) / 60.0, f64::from(i / 60) / 60.0]).collect();
        assert!(bonds(&domain, &lattice).is_ok());
    }
}

fn hexagonal(columns: usize, rows: usize) -> (Domain, Vec<f64>) {
    let height = 3f64.sqrt() / 2.0;
    let place = |row: usize, column: usize| [column as f64 + 0.5 * (row % 2) as f64 + 0.1, (row as f64 + 0.1) * height];
    let points = (0..rows).flat_map(|row| (0..columns).flat_map(move |column| place(row, column))).collect();
    (Domain::torus(&[columns as f64, rows as f64 * height]).unwrap(), points)
}

#[test]
fn lattices_have_their_bond_order() {
    for (columns, rows) in [(8, 8), (10, 4), (3, 2), (30, 40)] {
        let (domain, points) = hexagonal(columns, rows);
        let found = bonds(&domain, &points).unwrap();
        assert!(
            (found.local - 1.0).abs() < 1e-12 && (found.global - 1.0).abs() < 1e-12,
            "{columns} x {rows}: {found:?}"
        );
        assert_eq!(found.with_5_6_7_neighbors, [0.0, 1.0, 0.0]);
    }
    // However the squares are cut, also where rounding cuts them: four neighbours, that cancel.
    for k in [2, 3, 8, 30] {
        let exact = lattice(2, k).coordinates;
        let single: Vec<f64> = exact.iter().map(|&x| f64::from(x as f32)).collect();
        for points in [exact, single] {
            let found = bonds(&Domain::unit_torus(2), &points).unwrap();
            assert!(found.local < 1e-4 && found.with_5_6_7_neighbors == [0.0; 3], "{k}: {found:?}");
        }
    }
    // In a window the points on the hull are left out; next to it a neighbour may be missing.
    let (torus, points) = hexagonal(9, 8);
    let window = Domain::window(&[(0.0, torus.sides()[0]), (0.0, torus.sides()[1])]).unwrap();
    let found = bonds(&window, &points).unwrap();
    assert!((found.local - 1.0).abs() < 1e-12 && found.with_5_6_7_neighbors[1] > 0.8, "{found:?}");
}

/// psi_6 and the number of neighbours of every point, by the definition of the Voronoi diagram: j is a neighbour of i if on the
/// line halfway between them a stretch longer than 1e-5 of their distance is nearer to no other point.
fn psi_by_definition(domain: &Domain, points: &[f64], turns: i32) -> Vec<([f64; 2], usize)> {
    let points: Vec<[f64; 2]> = points.chunks_exact(2).map(|p| [p[0], p[1]]).collect();
    let [width, height] = [domain.sides()[0], domain.sides()[1]];
    let shifts =
        (-turns..=turns).flat_map(|a| (-turns..=turns).map(move |b| [f64::from(a) * width, f64::from(b) * height]));
    let sites: Vec<[f64; 2]> = shifts.flat_map(|s| points.iter().map(move |p| [p[0] + s[0], p[1] + s[1]])).collect();
    let of_point = |from: &[f64; 2]| {
        let others: Vec<[f64; 2]> =
            sites.iter().map(|s| [s[0] - from[0], s[1] - from[1]]).filter(|o| *o != [0.0; 2]).collect();
        let (mut sum, mut neighbors) = ([0.0; 2], 0);
        for to in &others {
            // The points (to + t across) / 2 are as far from `from` as from `to`, and nearer than `other` if t a < b.
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            for other in others.iter().filter(|o| *o != to) {
                let a = other[1] * to[0] - other[0] * to[1];
                let b = other[0] * (other[0] - to[0]) + other[1] * (other[1] - to[1]);
                match a {
                    0.0 if b < 0.0 => high = f64::NEG_INFINITY,
                    0.0 => {}
                    _ if a > 0.0 => high = high.min(b / a),
                    _ => low = low.max(b / a),
                }
            }
            if 0.5 * (high - low) > 1e-5 {
                let angle = 6.0 * to[1].atan2(to[0]);
                sum = [sum[0] + angle.cos(), sum[1] + angle.sin()];
                neighbors += 1;
            }
        }
        (sum.map(|s| s / neighbors as f64), neighbors)
    };
    points.iter().map(of_point).collect()
}

#[test]
fn bonds_are_those_of_the_voronoi_diagram() {
    for sides in [[1.0, 1.0], [1.0, 0.7], [0.3, 1.0]] {
        let domain = Domain::torus(&sides).unwrap();
        for (n, seed) in [(3, 1), (4, 2), (6, 3), (12, 4), (30, 5)] {
            let points = scattered(&domain, n, seed).coordinates;
            let found = bonds(&domain, &points).unwrap();
            let each = psi_by_definition(&domain, &points, 4);
            let mean = |values: Vec<f64>| values.iter().sum::<f64>() / n as f64;
            let local = mean(each.iter().map(|p| p.0[0].hypot(p.0[1])).collect());
            let [re, im] = [0, 1].map(|part| mean(each.iter().map(|p| p.0[part]).collect()));
            let global = re.hypot(im);
            assert!((found.local - local).abs() < 1e-9, "{n} in {sides:?}: {} against {local}", found.local);
            assert!((found.global - global).abs() < 1e-9, "{n} in {sides:?}: {} against {global}", found.global);
            for (share, k) in found.with_5_6_7_neighbors.into_iter().zip(5..) {
                assert_eq!(share, each.iter().filter(|p| p.1 == k).count() as f64 / n as f64, "{n} in {sides:?}: {k}");
            }
        }
    }
}

/// freud 3.4.0, `order.Hexatic(k=6)` over the neighbours of `locality.Voronoi`, which computes in float32.
#[test]
fn bond_order_as_freud_sees_it() {
    let points = &read("jittered3d_n2744.npy")[0];
    let plane: Vec<f64> = points.coordinates.chunks_exact(3).step_by(5).flat_map(|p| [p[0], p[1]]).collect();
    let found = bonds(&Domain::unit_torus(2), &plane).unwrap();
    assert!((found.local - 0.358_497).abs() < 1e-5, "{found:?}");
    assert!((found.global - 0.020_779_5).abs() < 1e-5, "{found:?}");
    for (share, expected) in
        found.with_5_6_7_neighbors.into_iter().zip([153.0, 155.0, 119.0].map(|count| count / 549.0))
    {
        assert!((share - expected).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn bond_order_over_realizations() {
    let domain = Domain::unit_torus(2);
    let sets: Vec<_> = (0..3).map(|k| uniform(2, 20 + 5 * k as usize, k)).collect();
    let each: Vec<_> = sets.iter().map(|set| bonds(&domain, &set.coordinates).unwrap()).collect();
    let found = measure(&domain, &[&sets[..], &[raw(2, vec![0.5, 0.5])]].concat()).bonds.unwrap();
    assert_eq!(found.realizations, 3, "one point has no bonds");
    for (value, se, each) in [
        (found.local, found.local_se, each.iter().map(|b| b.local).collect::<Vec<_>>()),
        (found.global, found.global_se, each.iter().map(|b| b.global).collect()),
    ] {
        let mean = each.iter().sum::<f64>() / 3.0;
        let spread = each.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        assert!((value - mean).abs() < 1e-15 && (se.unwrap() - (spread / 6.0).sqrt()).abs() < 1e-15);
    }
    assert!(each[0].local_se.is_none());
}

/// Whatever the points are: a number in [0, 1], or a reason.
#[test]
fn degenerate_patterns_have_bonds_or_a_reason() {
    let random = uniform(2, 200, 7).coordinates;
    let on_a_line = |f: fn(f64) -> [f64; 2]| -> Vec<f64> { random.iter().flat_map(|&x| f(x)).collect() };
    let patterns: Vec<Vec<f64>> = vec![
        vec![],
        vec![0.5, 0.5],
        vec![0.1, 0.2, 0.3, 0.4],
        vec![0.1, 0.2, 0.3, 0.4, 0.9, 0.1],
        [0.25, 0.75].repeat(1000),
        [&[0.25, 0.75].repeat(1000)[..], &[0.5, 0.5]].concat(),
        [&random[..], &random[..]].concat(),
        on_a_line(|x| [x, 0.0]),
        on_a_line(|x| [x, x]),
        on_a_line(|x| [0.5, x]),
        on_a_line(|x| [x, 1e-12 * x]),
        on_a_line(|x| [2f64.powi(-60) * x, 0.5 + 2f64.powi(-53) * x]),
        on_a_line(|x| [0.5 + 0.3 * (7.0 * x).cos(), 0.5 + 0.3 * (7.0 * x).sin()]),
        lattice(2, 12).coordinates,
        rank1(610, 377).coordinates,
    ];
    let domains = [
        Domain::unit_torus(2),
        Domain::torus(&[1.0, 0.01]).unwrap(),
        Domain::torus(&[1e-6, 1.0]).unwrap(),
        Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap(),
        Domain::window(&[(0.0, 1e-6), (-3.0, -2.0)]).unwrap(),
    ];
    let mut with = 0;
    for (i, pattern) in patterns.iter().enumerate() {
        for domain in &domains {
            let place = |(k, x): (usize, &f64)| domain.origin()[k % 2] + x * domain.sides()[k % 2];
            let points: Vec<f64> = pattern.iter().enumerate().map(place).collect();
            match bonds(domain, &points) {
                Ok(b) => {
                    with += 1;
                    let valid = |x: f64| (0.0..=1.0 + 1e-12).contains(&x);
                    assert!(valid(b.local) && b.global <= b.local + 1e-12, "pattern {i} in {domain:?}: {b:?}");
                    assert!(b.with_5_6_7_neighbors.into_iter().all(valid));
                }
                Err(reason) => assert!(!reason.is_empty()),
            }
        }
    }
    assert!(with >= 15, "only {with}");
    let flat = |dim| measure(&Domain::unit_torus(dim), &[uniform(dim, 20, 1)]).bonds;
    assert_eq!((flat(1), flat(3)), (Err("defined in two dimensions only"), Err("defined in two dimensions only")));
}

/// Duplicates are one point; distances of 0 are quick to find.
#[test]
fn duplicates_are_fast_and_zero() {
    for dim in 1..=3 {
        for domain in [Domain::unit_torus(dim), Domain::window(&vec![(0.0, 1.0); dim]).unwrap()] {
            let found = measure(&domain, &[raw(dim, vec![0.25; 200_000 * dim])]);
            let distances = found.distances;
            assert_eq!((distances.minimum, distances.mean, distances.mean_se), (Some(0.0), Some(0.0), None));
            // One point alone, far from a hundred thousand equal ones.
            let mut but_one = vec![0.25; 100_000 * dim];
            but_one[..dim].fill(0.75);
            let mean = measure(&domain, &[raw(dim, but_one)]).distances.mean.unwrap();
            let expected = 0.5 * (dim as f64).sqrt() / 1e5;
            assert!((mean / expected - 1.0).abs() < 1e-14, "{dim}D: {mean}");
        }
    }
}

#[test]
fn cancelling_ends_it() {
    let control = Control::default();
    control.cancel();
    let ensemble = ensemble(&[uniform(2, 100, 1)]);
    assert!(neighbor_sums(&plan(&ensemble, None), &ensemble, &control).is_err());
}

/// The index is 1 for independent points and its z is standard normal, on tori and in a rectangle; a square lattice has 2.
#[test]
fn clark_evans_is_standard_for_independent_points() {
    let rectangle = Domain::window(&[(3.0, 6.0), (-1.0, 1.0)]).unwrap();
    let torus = Domain::torus(&[2.0, 1.0]).unwrap();
    for (domain, n) in
        [(Domain::unit_torus(1), 300), (torus, 300), (Domain::unit_torus(3), 300), (rectangle.clone(), 100)]
    {
        let sets: Vec<_> = (0..600).map(|i| scattered(&domain, n, 9000 + i)).collect();
        let ensemble = Ensemble::from_raw(&sets, &domain, false, 0).unwrap();
        let plan = NeighborPlan { bonds: false, ..plan(&ensemble, Some(&[0.0, 0.1])) };
        let each = |k: usize| {
            let one = ensemble.slice(k..k + 1);
            Neighbors::new(&plan, &sums(&plan, &one), shape(&one)).clark_evans.unwrap()
        };
        let z: Vec<f64> = (0..600).map(|k| each(k).z).collect();
        let mean = z.iter().sum::<f64>() / 600.0;
        let variance = z.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / 599.0;
        // Four standard errors of each; Donnelly's constants are known to 2 %.
        assert!(
            mean.abs() < 4.0 / 600f64.sqrt() && (variance - 1.0).abs() < 4.0 * (2.0 / 600f64).sqrt(),
            "{mean} {variance}"
        );
        let all = Neighbors::new(&plan, &sums(&plan, &ensemble), shape(&ensemble)).clark_evans.unwrap();
        assert!((all.index - 1.0).abs() < 4.0 * all.index_se.unwrap(), "{all:?}");
        assert!((all.z - z.iter().sum::<f64>() / 600f64.sqrt()).abs() < 1e-9 && each(0).index_se.is_none());
    }
    let lattice: Vec<f64> = (0..64).flat_map(|i| [f64::from(i % 8) / 8.0, f64::from(i / 8) / 8.0]).collect();
    let found = measure(&Domain::unit_torus(2), &[raw(2, lattice)]).clark_evans.unwrap();
    assert!((found.index - 2.0).abs() < 1e-12 && found.z > 8.0, "{found:?}");
    // No edge correction is known in three dimensions.
    let box3 = Domain::window(&[(0.0, 1.0); 3]).unwrap();
    assert_eq!(measure(&box3, &[scattered(&box3, 50, 1)]).clark_evans, None);
    assert_eq!(measure(&rectangle, &[raw(2, vec![4.0, 0.0])]).clark_evans, None);
}

/// G between two classes against a loop over the points of each, and J = 1 between independent classes.
#[test]
fn g_and_j_of_two_classes_are_their_definitions() {
    let torus = Domain::torus(&[2.0, 1.0]).unwrap();
    let sets: Vec<_> = (0..40).map(|i| scattered(&torus, 150, 700 + i)).collect();
    let e = Ensemble::from_raw(&sets, &torus, false, 0).unwrap();
    let e = e.with_classes((0..150 * 40).map(|j| u32::from(j % 3 == 0)).collect());
    let edges: Vec<f64> = (0..=20).map(|k| 0.01 * f64::from(k)).collect();
    let plan = NeighborPlan { bonds: false, ..plan(&e, Some(&edges)) };
    let of = |classes| sums(&NeighborPlan { classes: Some(classes), ..plan.clone() }, &e);
    let sums = CrossNeighborSums([[0, 0], [1, 1], [0, 1], [1, 0]].map(of));
    let found = CrossNeighbors::new(["oak".into(), "elm".into()], &plan, &sums);
    for ([from, to], functions) in [[0, 0], [1, 1], [0, 1], [1, 0]].into_iter().zip(found.each().map(|(_, f)| f)) {
        let (mut below, mut all) = (vec![0.0; edges.len()], 0.0);
        for k in 0..40 {
            let at = |j: usize| e.position(k, j);
            let of = |class: u32| (0..150).filter(move |j| u32::from(j % 3 == 0) == class);
            for i in of(from) {
                let distance = |j: usize| {
                    let along =
                        |a: usize, side: f64| ((at(i)[a] - at(j)[a]).abs()).min(side - (at(i)[a] - at(j)[a]).abs());
                    along(0, 2.0).hypot(along(1, 1.0))
                };
                let nearest = of(to).filter(|&j| j != i).map(distance).fold(f64::INFINITY, f64::min);
                all += 1.0;
                edges.iter().zip(&mut below).for_each(|(r, below)| *below += f64::from(u8::from(nearest < *r)));
            }
        }
        for (i, below) in below.iter().enumerate() {
            assert!((functions.g[i].unwrap() - below / all).abs() < 1e-12, "{from} {to} at {}", edges[i]);
            let poisson = functions.poisson[i];
            let [g, f] =
                [(&functions.g, &functions.g_se), (&functions.f, &functions.f_se)].map(|(y, se)| (y[i], se[i]));
            for (value, se) in [g, f].map(|(y, se)| (y.unwrap(), se.unwrap())) {
                // n of a class is fixed: no more than 1/n off the Poisson one.
                assert!((value - poisson).abs() < 4.0 * se + 0.02, "{value} {poisson} {se}");
            }
        }
        assert!((functions.j[8].unwrap() - 1.0).abs() < 0.05, "{:?}", functions.j[8]);
    }
}

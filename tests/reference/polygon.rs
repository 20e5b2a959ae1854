//! Windows that are polygons: overlaps and arcs worked by hand, a box drawn as a polygon, the reference, the CPU path and `geo`
//! against each other, and what randomness must give.

use crate::common::*;
use geo::{Area, BooleanOps, Coord, LineString, Translate};
use pairwave::analysis::{Measurement, Plan};
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::compute::{Compute, Device};
use pairwave::control::Control;
use pairwave::plan::{Correction, PairPlan, PairSettings, RadialBins};
use pairwave::points::polygon::Ring;
use pairwave::points::{Domain, Ensemble};
use pairwave::source::Points;

const CORRECTIONS: [Correction; 4] =
    [Correction::Translation, Correction::Isotropic, Correction::Border, Correction::None];

/// [0, 2]^2 without (1, 2]^2.
fn l_shape() -> Domain {
    let ring = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    Domain::polygon(vec![vec![ring]]).unwrap()
}

fn square(low: f64, high: f64) -> Ring {
    vec![[low, low], [high, low], [high, high], [low, high]]
}

/// [0, 4]^2 without (1, 3)^2.
fn with_hole() -> Domain {
    Domain::polygon(vec![vec![square(0.0, 4.0), square(1.0, 3.0)]]).unwrap()
}

/// A star with a hole, and a triangle beside it: no side along an axis.
fn ragged() -> Vec<Vec<Ring>> {
    let mut rng = Rng(77);
    let mut star = |center: [f64; 2], size: f64, corners: usize| -> Ring {
        let corner = |k: usize| {
            let (sin, cos) = ((k as f64 + 0.3) / corners as f64 * std::f64::consts::TAU).sin_cos();
            let r = size * (0.6 + 0.4 * rng.unit());
            [center[0] + r * cos, center[1] + r * sin]
        };
        (0..corners).map(corner).collect()
    };
    let island = vec![[500_002.2, 103.1], [500_003.7, 102.9], [500_003.1, 104.6]];
    vec![vec![star([500_000.0, 100.0], 3.0, 17), star([500_000.2, 100.1], 0.8, 7)], vec![island]]
}

/// Uniform points in a polygon.
fn inside(domain: &Domain, n: usize, seed: u64) -> Vec<f64> {
    let polygon = domain.as_polygon().unwrap();
    let mut rng = Rng(seed);
    let mut coordinates = Vec::new();
    while coordinates.len() < 2 * n {
        let point = [0, 1].map(|a| domain.origin()[a] + domain.sides()[a] * rng.unit());
        if polygon.contains_point(point) {
            coordinates.extend(point);
        }
    }
    coordinates
}

fn of(domain: &Domain, sets: &[Vec<f64>]) -> Ensemble {
    let raw: Vec<_> = sets.iter().map(|set| raw(2, set.clone())).collect();
    Ensemble::from_raw(&raw, domain, false, 0).unwrap()
}

fn backends() -> [Box<dyn Compute>; 2] {
    [Box::new(Reference), Box::new(Cpu::new(Some(2)).unwrap())]
}

/// The weights of a pair, seen from both of its points, together.
fn weights(backend: &dyn Compute, domain: &Domain, pair: [[f64; 2]; 2], correction: Correction) -> f64 {
    let ensemble = of(domain, &[pair.concat()]);
    let r = (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1]);
    let plan = pair_plan(&ensemble, RadialBins::linear(r * 1.001, 1).unwrap(), correction);
    let counts = wait(backend.pair_counts(&plan, &ensemble, &Control::default())).unwrap();
    counts.bins.sums[0] as f64 / plan.weight_steps()
}

#[test]
fn overlaps_by_hand() {
    let (l, hole) = (l_shape(), with_hole());
    assert_eq!((l.measure(), hole.measure()), (3.0, 12.0));
    for (domain, from, h, overlap) in [
        // Two rows: 1.5 x 1 and 0.5 x 1.
        (&l, [0.25, 0.25], [0.5, 0.0], 2.0),
        (&l, [0.25, 0.25], [0.0, 0.5], 2.0),
        // A square of 1.5 without one of 1.
        (&l, [0.25, 0.25], [0.5, 0.5], 1.25),
        // 1.75 without the notch of the other, a quarter.
        (&l, [0.25, 0.75], [0.5, -0.5], 1.5),
        // 3 x 4, without both holes: 4 and what the far one has of the near strip, 2.
        (&hole, [0.5, 0.5], [1.0, 0.0], 6.0),
        // 3.5^2, without two holes of 4 that share 1.5^2.
        (&hole, [0.25, 0.25], [0.5, 0.5], 6.5),
    ] {
        let to = [from[0] + h[0], from[1] + h[1]];
        for backend in backends() {
            for pair in [[from, to], [to, from]] {
                let found = weights(&*backend, domain, pair, Correction::Translation);
                let expected = 2.0 * domain.measure() / overlap;
                assert!((found / expected - 1.0).abs() < 1e-9, "{domain}, {h:?}: {found}, not {expected}");
            }
        }
    }
}

#[test]
fn arcs_by_hand() {
    let (l, hole) = (l_shape(), with_hole());
    for (domain, pair, expected) in [
        // All of it from both.
        (&l, [[0.5, 0.5], [0.75, 0.5]], 2.0),
        // About the inner corner three quarters; about the other point all, though it touches a side and the corner.
        (&l, [[1.0, 1.0], [0.5, 1.0]], 4.0 / 3.0 + 1.0),
        // A quarter, and a half.
        (&l, [[0.0, 0.0], [0.5, 0.0]], 4.0 + 2.0),
        // A side cuts a third off and the hole another; about the other point a third and a sixth.
        (&hole, [[2.0, 0.5], [3.0, 0.5]], 3.0 + 2.0),
        // Two sides cut off half, to the corner where they meet, and the hole is touched; about its corner, three quarters.
        (&hole, [[0.5, 0.5], [1.0, 1.0]], 2.0 + 4.0 / 3.0),
        // Half a turn on both sides of the hole: all but a third, in it.
        (&hole, [[0.5, 2.0], [0.5, 3.0]], 3.0 + 2.0),
    ] {
        let found = backends().map(|backend| weights(&*backend, domain, pair, Correction::Isotropic));
        let near = found.iter().all(|found| (found / expected - 1.0).abs() < 1e-9);
        assert!(near, "{domain}, {pair:?}: {found:?}, not {expected}");
    }
    // Any circle: the part of 100,000 directions that stays inside.
    let domain = Domain::polygon(ragged()).unwrap();
    let polygon = domain.as_polygon().unwrap();
    for seed in 0..20 {
        let points = inside(&domain, 2, 100 + seed);
        let pair = [[points[0], points[1]], [points[2], points[3]]];
        let r = (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1]);
        if r > 0.99 * domain.circumradius() {
            continue;
        }
        let part = |[x, y]: [f64; 2]| {
            let stays = |k: &i32| {
                let (sin, cos) = (f64::from(*k) * 1e-5 * std::f64::consts::TAU).sin_cos();
                let at = [x + r * cos, y + r * sin];
                let in_box = (0..2).all(|a| (0.0..=domain.sides()[a]).contains(&(at[a] - domain.origin()[a])));
                in_box && polygon.contains_point(at)
            };
            (0..100_000).filter(stays).count() as f64 / 1e5
        };
        let expected = 1.0 / part(pair[0]) + 1.0 / part(pair[1]);
        for backend in backends() {
            let found = weights(&*backend, &domain, pair, Correction::Isotropic);
            assert!((found / expected - 1.0).abs() < 2e-4 * expected, "{pair:?}: {found}, not {expected}");
        }
    }
}

/// Circles that pass through the tip of a wedge cut into a box and meet nothing else, whatever rounding makes of the angles at which they
/// enter and leave it: all of each is inside, and all but the wedge of the one about the tip.
#[test]
fn a_circle_through_a_tip_is_whole() {
    let ring = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.125, 4.0], [2.0, 2.0], [1.875, 4.0], [0.0, 4.0]];
    let domain = Domain::polygon(vec![vec![ring]]).unwrap();
    let wedge = 2.0 * (0.125f64 / 2.0).atan() / std::f64::consts::TAU;
    let mut rng = Rng(9);
    for _ in 0..200 {
        let pair = [[1.6 + 0.8 * rng.unit(), 1.3 + 0.4 * rng.unit()], [2.0, 2.0]];
        for backend in backends() {
            let found = weights(&*backend, &domain, pair, Correction::Isotropic);
            let expected = 1.0 + 1.0 / (1.0 - wedge);
            assert!((found - expected).abs() < 1e-9, "{pair:?}: {found}, not {expected}");
        }
    }
}

/// From the tip of a needle on a body farther off, and from where it is some wider: weights of ten millions are those of the angle, not of the least there is.
#[test]
fn a_needle_shows_little_of_a_circle() {
    let slope = 1e-7;
    let ring = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.9, 1.0], [0.9, 0.9 * slope]];
    let domain = Domain::polygon(vec![vec![ring]]).unwrap();
    // About the other point the tip adds nothing, and the needle is twice as wide at twice the distance.
    let expected = std::f64::consts::TAU / slope * (1.0 + 0.5);
    for backend in backends() {
        let found = weights(&*backend, &domain, [[0.0, 0.0], [0.4, 0.2 * slope]], Correction::Isotropic);
        assert!((found / expected - 1.0).abs() < 1e-5, "{found:e}, not {expected:e}");
    }
}

/// A box drawn with a vertex in the middle of a side is a polygon, and weighs pairs as the box does.
#[test]
fn a_box_is_a_box_however_it_is_drawn() {
    let ranges = [(500_000.1, 500_002.1), (-1.0, 0.5)];
    let window = Domain::window(&ranges).unwrap();
    let [(x0, x1), (y0, y1)] = ranges;
    let mut ring = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    assert_eq!(Domain::polygon(vec![vec![ring.clone()]]).unwrap(), window);
    ring.reverse();
    assert_eq!(Domain::polygon(vec![vec![ring.clone()]]).unwrap(), window);
    ring.push([x0, y0 + 0.5]);
    ring.rotate_right(1);
    let polygon = Domain::polygon(vec![vec![ring]]).unwrap();
    assert!(polygon.as_polygon().is_some());
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    assert!(near(polygon.measure(), window.measure()));
    assert!(
        near(polygon.inner_diameter(), window.inner_diameter()) && near(polygon.circumradius(), window.circumradius())
    );
    let mut sets = inside(&polygon, 150, 5);
    // On the sides, in all corners (a side of the box is 2^63 steps), and twice at one place.
    sets.extend([x0, y0, x1, y0, x1, y1, x0, y1, x1, y0 + 0.25, x0 + 0.5, y1, x0 + 0.5, y1]);
    for correction in CORRECTIONS {
        let counts = [&polygon, &window].map(|domain| {
            let ensemble = of(domain, &[sets.clone()]);
            let settings = PairSettings { cumulative: true, ..correction.into() };
            let plan = PairPlan::new(domain, RadialBins::linear(0.7, 14).unwrap(), settings, shape(&ensemble)).unwrap();
            wait(Cpu::new(Some(1)).unwrap().pair_counts(&plan, &ensemble, &Control::default())).unwrap()
        });
        let [a, b] = &counts;
        assert_eq!(a.counts, b.counts, "{correction}");
        let sums = a.bins.sums.iter().zip(&b.bins.sums);
        let off = sums.fold(0.0, |off: f64, (&a, &b)| off.max(a.abs_diff(b) as f64 / (b as f64).max(1.0)));
        // A quantum of 2^-32 where a weight is rounded the other way.
        assert!(off < 1e-9, "{correction}: {off:e}");
        if correction == Correction::Border {
            assert_eq!(a.bins, b.bins);
        }
    }
}

#[test]
fn the_cpu_agrees_with_the_reference() {
    for (parts, r_max) in [(ragged(), 0.55), (vec![vec![square(0.0, 4.0), square(1.0, 3.0)]], 0.55)] {
        let domain = Domain::polygon(parts).unwrap();
        let ensemble = of(&domain, &[inside(&domain, 220, 1), inside(&domain, 90, 2)]);
        for correction in CORRECTIONS {
            let settings = PairSettings { cumulative: true, ..correction.into() };
            let bins = RadialBins::linear(r_max, 11).unwrap();
            let plan = PairPlan::new(&domain, bins, settings, shape(&ensemble)).unwrap();
            let truth = reference_counts(&plan, &ensemble);
            let [one, three] = [1, 3].map(|threads| {
                wait(Cpu::new(Some(threads)).unwrap().pair_counts(&plan, &ensemble, &Control::default())).unwrap()
            });
            assert_eq!((&one.bins, &one.counts, &one.cumulative), (&three.bins, &three.counts, &three.cumulative));
            let error = weight_error(&one, &truth).unwrap_or_else(|why| panic!("{domain}, {correction}: {why}"));
            assert!(error < 1e-9, "{domain}, {correction}: {error:e}");
        }
    }
}

/// The overlap that `geo` finds with its own method, in integers of its own.
#[test]
fn overlaps_are_those_of_another_program() {
    let parts = ragged();
    let domain = Domain::polygon(parts.clone()).unwrap();
    let line = |ring: &Ring| LineString::from_iter(ring.iter().map(|&[x, y]| Coord { x: x - 500_000.0, y: y - 100.0 }));
    let polygons = parts.iter().map(|rings| geo::Polygon::new(line(&rings[0]), rings[1..].iter().map(line).collect()));
    let whole = geo::MultiPolygon::from_iter(polygons);
    assert!((whole.unsigned_area() / domain.measure() - 1.0).abs() < 1e-10);
    for seed in 0..40 {
        let points = inside(&domain, 2, 300 + seed);
        let pair = [[points[0], points[1]], [points[2], points[3]]];
        let h = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        if h[0].hypot(h[1]) > 0.9 * domain.inner_diameter() {
            continue;
        }
        let overlap = whole.intersection(&whole.translate(h[0], h[1])).unsigned_area();
        let expected = 2.0 * domain.measure() / overlap;
        for backend in backends() {
            let found = weights(&*backend, &domain, pair, Correction::Translation);
            assert!((found / expected - 1.0).abs() < 1e-6, "{h:?}: {found}, not {expected}");
        }
    }
}

/// A hole that one side does not know of, and a vertex that is off by a hair.
#[test]
fn planted_faults_are_seen() {
    let (mut filled, mut moved) = (ragged(), ragged());
    filled[0].truncate(1);
    moved[0][0][3][0] += 1e-6;
    let ensemble = of(&Domain::polygon(ragged()).unwrap(), &[inside(&Domain::polygon(ragged()).unwrap(), 60, 3)]);
    for wrong in [filled, moved] {
        let wrong = Domain::polygon(wrong).unwrap();
        for correction in [Correction::Translation, Correction::Isotropic] {
            let bins = || RadialBins::linear(0.55, 4).unwrap();
            let plan = pair_plan(&ensemble, bins(), correction);
            let fault = PairPlan { domain: wrong.clone(), ..plan.clone() };
            let found = wait(Cpu::new(Some(1)).unwrap().pair_counts(&fault, &ensemble, &Control::default())).unwrap();
            let error = weight_error(&found, &reference_counts(&plan, &ensemble)).unwrap();
            assert!(error > 1e-9, "{correction}: {error:e}");
        }
    }
}

/// Independent points: g = 1, K = pi r^2, and G and F those of a Poisson process, under every correction.
#[test]
fn independent_points_in_an_l() {
    let domain = l_shape();
    let sets: Vec<_> = (0..200).map(|k| inside(&domain, 60, 5000 + k)).collect();
    for correction in CORRECTIONS {
        let line =
            format!("--stats pcf,k-function,neighbors --r-max 0.5 --bins 10 --correction {correction} --device cpu");
        let found = pairwave::measure(Points::new(domain.clone(), &sets).unwrap(), &request(&line)).unwrap();
        let (g, k) = (found.pair_correlation().unwrap(), found.k_function().unwrap());
        let off = |value: f64, se: f64, expected: f64| (value - expected).abs() / se;
        for b in 0..10 {
            let expected = std::f64::consts::PI * k.r[b] * k.r[b];
            let worst = off(g.g[b], g.g_se[b], 1.0).max(off(k.k[b], k.k_se[b], expected));
            // Without a correction what the window does not show is missing.
            if correction != Correction::None {
                assert!(worst < 4.0, "{correction}, r {}: g {}, K {} for {expected}", k.r[b], g.g[b], k.k[b]);
            } else if b == 9 {
                assert!(worst > 4.0, "{worst}");
            }
        }
        let functions = &found.neighbors().unwrap().functions;
        for (b, r) in functions.r.iter().enumerate().filter(|(_, r)| (0.02..0.2).contains(*r)) {
            let expected = 1.0 - (-60.0 / 3.0 * std::f64::consts::PI * r * r).exp();
            for (value, se, n) in [(functions.g[b], functions.g_se[b], 59.0), (functions.f[b], functions.f_se[b], 60.0)]
            {
                let expected = 1.0 - (1.0 - expected).powf(n / 60.0);
                let (value, se) = (value.unwrap(), se.unwrap());
                // n points are a little more even than a Poisson process.
                assert!((value - expected).abs() < 4.0 * se + 0.01, "r {r}: {value} +- {se}, not {expected}");
            }
        }
    }
}

#[test]
fn circles_in_and_about() {
    let l = l_shape();
    // Touching two sides and the inner corner: r (1 + sqrt 2) = sqrt 2. About it: through three corners.
    let inner = 2.0 * (2.0 - 2f64.sqrt());
    assert!((l.inner_diameter() / inner - 1.0).abs() < 1e-4 && l.inner_diameter() <= inner * (1.0 + 1e-12));
    assert!((l.circumradius() / 2f64.sqrt() - 1.0).abs() < 1e-12, "{}", l.circumradius());
    // Of two parts the smaller counts.
    let two = Domain::polygon(vec![vec![square(0.0, 4.0)], vec![square(5.0, 6.0)]]).unwrap();
    assert!((two.circumradius() - 0.5f64.sqrt()).abs() < 1e-12);
    assert!((two.inner_diameter() - 4.0).abs() < 4e-4);
}

/// A file of sums knows its polygon, and does not go with sums of another.
#[test]
fn sums_of_a_polygon_are_written_and_read() {
    let measured = |parts: Vec<Vec<Ring>>| {
        let domain = Domain::polygon(parts).unwrap();
        let request = request("--stats k-function --device cpu");
        let sets = [inside(&Domain::polygon(ragged()).unwrap(), 40, 9)];
        let source = std::sync::Arc::new(Points::new(domain, &sets).unwrap());
        let plan = Plan::of(&request, &source).unwrap();
        let mut measurement = Measurement::new(request, source, plan);
        let device = Device::new(Box::new(Cpu::new(Some(1)).unwrap()), None).unwrap();
        while measurement.step(&device, &Control::default()).unwrap() {}
        measurement
    };
    let first = measured(ragged());
    let read = Measurement::read("polygon.sums", &first.write()).unwrap();
    let [a, b] = [&first, &read].map(|m| m.analysis().unwrap());
    assert_eq!((&a.domain, &a.k_function().unwrap().k), (&b.domain, &b.k_function().unwrap().k));
    let mut filled = ragged();
    filled[0].truncate(1);
    let mut other = measured(filled);
    assert!(other.merge(read).unwrap_err().to_string().contains("domain"));
}

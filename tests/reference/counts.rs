//! Counts in boxes and balls: by hand, against the reference, against closed forms.

use crate::common::*;
use pairwave::accumulate::{CountSums, Places};
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::estimate::Counts;
use pairwave::plan::{CountExtent, CountPlan, CountShape, CountSize};
use pairwave::points::{Domain, Ensemble};
use pairwave::samplers::Process;

fn sums_of(compute: &dyn Compute, plan: &CountPlan, ensemble: &Ensemble) -> CountSums {
    wait(compute.counts(plan, ensemble, &Control::default())).unwrap()
}

fn measured(ensemble: &Ensemble) -> (CountPlan, Counts) {
    let plan = CountPlan::new(ensemble.domain(), ensemble.shape());
    let counts = Counts::new(&plan, &sums_of(&Cpu::new(None).unwrap(), &plan, ensemble));
    (plan, counts)
}

fn drawn(name: &str, n: u64, dim: usize, k: u64) -> Ensemble {
    Process::new(name, n, k, dim, 5, &[]).unwrap().ensemble(0..k, &Control::default()).unwrap()
}

/// The same points in another domain.
fn moved(ensemble: &Ensemble, domain: &Domain) -> Ensemble {
    let set = |k: usize| {
        let axes = ensemble.coordinates(k).unwrap();
        let place = |i: usize| (0..axes.len()).map(move |a| (a, i));
        let all = (0..axes[0].len()).flat_map(place);
        raw(axes.len(), all.map(|(a, i)| domain.origin()[a] + axes[a][i] * domain.sides()[a]).collect())
    };
    let sets: Vec<_> = (0..ensemble.realizations()).map(set).collect();
    Ensemble::from_raw(&sets, domain, false, 3).unwrap()
}

/// An interval of a quarter of the torus among points at 0, 1/8 and 1/2: two are in it from 7/8 to 1, else one or none.
#[test]
fn intervals_by_hand() {
    let quarter = CountExtent::Interval(1 << 62);
    let plan = |domain: &Domain, extent| {
        let shape = pairwave::points::EnsembleShape::of(&[3]);
        let mut plan = CountPlan::new(domain, shape);
        plan.sizes = vec![CountSize { shape: CountShape::Box, size: 0.25, measure: 0.25, extent }];
        plan
    };
    let torus = Domain::unit_torus(1);
    let points = Ensemble::from_raw(&[raw(1, vec![0.0, 0.125, 0.5])], &torus, false, 0).unwrap();
    // Every point is in it for a quarter of all places; the first two together for an eighth.
    let expected = Places { places: 1 << 64, sum: 3 << 62, squares: (3 << 62) + (2 << 61) };
    for way in [&Cpu::new(None).unwrap() as &dyn Compute, &Reference] {
        assert_eq!(sums_of(way, &plan(&torus, quarter), &points).realizations[0].sizes, [expected]);
    }
    // In a window the length unit is twice the side, and places go from 0 to 3/4: the point at 0 is met at one place only.
    let window = Domain::window(&[(0.0, 1.0)]).unwrap();
    let points = Ensemble::from_raw(&[raw(1, vec![0.0, 0.125, 0.5])], &window, false, 0).unwrap();
    let expected = Places { places: 3 << 61, sum: 3 << 60, squares: 3 << 60 };
    for way in [&Cpu::new(None).unwrap() as &dyn Compute, &Reference] {
        assert_eq!(
            sums_of(way, &plan(&window, CountExtent::Interval(1 << 61)), &points).realizations[0].sizes,
            [expected]
        );
    }
}

/// The CPU path is the reference to the last count, in every kind of domain.
#[test]
fn equals_the_reference() {
    let notched = vec![vec![vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.7, 1.0], [0.7, 3.0], [0.0, 3.0]]]];
    let polygon = Domain::polygon(notched).unwrap();
    let mut seen = 0;
    for (name, n, dim) in [("random", 50, 1), ("thomas", 60, 2), ("grid", 25, 2), ("random", 30, 3)] {
        let ensemble = drawn(name, n, dim, 2);
        let sides = [1.0, 0.6, 0.8];
        let window = Domain::window(&[(-3.0, -1.0), (5.0, 5.7), (0.0, 1.3)][..dim]).unwrap();
        let mut all =
            vec![ensemble.clone(), moved(&ensemble, &window), moved(&ensemble, &Domain::torus(&sides[..dim]).unwrap())];
        if dim == 2 {
            // Points of the box that are in the polygon.
            let mut rng = Rng(n);
            let inside = |p: &[f64; 2]| p[1] <= 1.0 || p[0] <= 0.7;
            let points: Vec<[f64; 2]> = (0..90).map(|_| [2.0 * rng.unit(), 3.0 * rng.unit()]).filter(inside).collect();
            all.push(Ensemble::from_raw(&[raw(2, points.concat())], &polygon, false, 1).unwrap());
        }
        for ensemble in all {
            let mut plan = CountPlan::new(ensemble.domain(), ensemble.shape());
            // As few as will show a fault.
            (plan.cells, plan.centers) = (13, std::array::from_fn(|a| if a < dim { 7 } else { 1 }));
            plan.sizes.retain(|s| !matches!(s.extent, CountExtent::Cells(q) if q > 6));
            let [fast, slow] =
                [&Cpu::new(Some(2)).unwrap() as &dyn Compute, &Reference].map(|way| sums_of(way, &plan, &ensemble));
            assert_eq!(fast, slow, "{name} in {}", ensemble.domain());
            seen += slow.realizations[0].sizes.iter().filter(|p| p.sum > 0).count();
        }
    }
    assert!(seen > 100, "{seen}");
}

/// One point moved by a cell changes the counts: the comparison can fail.
#[test]
fn a_moved_point_is_seen() {
    let torus = Domain::unit_torus(2);
    let of = |x: f64| {
        let ensemble = Ensemble::from_raw(&[raw(2, vec![0.2, 0.3, 0.25, 0.35, x, 0.9])], &torus, false, 0).unwrap();
        sums_of(&Cpu::new(None).unwrap(), &CountPlan::new(&torus, ensemble.shape()), &ensemble)
    };
    assert_eq!(of(0.6), of(0.6));
    assert_ne!(of(0.6), of(0.6 + 1.0 / 61.0));
}

/// Of a grid with spacing a, an interval of (k + f) a holds k or k + 1 points: variance f (1 - f). Of jittered points it is
/// f - f^2 + f^3/3 below one stratum, and 1/3 at whole numbers of them.
#[test]
fn one_dimension_has_its_closed_forms() {
    let (plan, counts) = measured(&drawn("grid", 10, 1, 1));
    assert_eq!(counts.sizes.len(), plan.sizes.len());
    for size in &counts.sizes {
        let f = (10.0 * size.size).fract();
        assert!((size.mean - 10.0 * size.size).abs() < 1e-12, "{size:?}");
        assert!((size.variance - f * (1.0 - f)).abs() < 1e-9, "{size:?}");
        assert_eq!((size.mean_se, size.variance_se, size.dispersion_se), (None, None, None));
    }
    let (_, counts) = measured(&drawn("jittered", 16, 1, 4000));
    let mut seen = 0;
    for size in counts.sizes.iter().filter(|s| 16.0 * s.size < 1.0) {
        let f = 16.0 * size.size;
        let (expected, se) = (f - f * f + f.powi(3) / 3.0, size.variance_se.unwrap());
        assert!((size.variance - expected).abs() < 4.0 * se, "{size:?}: not {expected}");
        assert!(se < 0.02 * expected);
        seen += 1;
    }
    assert!(seen > 5);
    let half = counts.largest(CountShape::Box).unwrap();
    assert!((half.variance - 1.0 / 3.0).abs() < 4.0 * half.variance_se.unwrap(), "{half:?}");
}

/// In boxes and balls, on a torus and in a window: 1 for a Poisson process, 1 - |B|/|D| for a fixed number.
#[test]
fn independent_points_have_their_dispersion() {
    for dim in 1..=3 {
        for (name, window) in [("random", false), ("random", true), ("poisson", false), ("poisson", true)] {
            let torus = drawn(name, 60, dim, 400);
            let ensemble = match window {
                true => moved(&torus, &Domain::window(&vec![(1.0, 3.0); dim]).unwrap()),
                false => torus,
            };
            let (_, counts) = measured(&ensemble);
            let sizes = counts.sizes.iter().filter(|s| s.mean > 0.05);
            for size in sizes {
                let expected = match name {
                    "random" => 1.0 - size.measure / ensemble.domain().measure(),
                    _ => 1.0,
                };
                let (found, se) = (size.dispersion.unwrap(), size.dispersion_se.unwrap());
                assert!((found - expected).abs() < 4.5 * se.max(1e-3), "{name} {dim}D: {size:?}, not {expected}");
                let near = if name == "random" { 1e-12 } else { 0.15 };
                assert!((size.random - expected).abs() < near, "{size:?}");
                let mean = 60.0 * size.measure / ensemble.domain().measure();
                let slack = 4.5 * size.mean_se.unwrap() + 1e-9;
                assert!((size.mean - mean).abs() < slack, "{name} {dim}D: {size:?}, mean not {mean}");
                if name == "random" && !window && size.shape == CountShape::Box {
                    assert!((size.mean - mean).abs() < 1e-9, "every place counts every point");
                }
            }
        }
    }
}

/// Clusters are above, jittered points below what is random.
#[test]
fn clusters_and_strata_are_told_apart() {
    for (name, above) in [("thomas", true), ("jittered", false)] {
        let (_, counts) = measured(&drawn(name, 100, 2, 30));
        for shape in [CountShape::Box, CountShape::Ball] {
            let size = counts.largest(shape).unwrap();
            let (z, random) = ((size.dispersion.unwrap() - size.random) / size.dispersion_se.unwrap(), size.random);
            assert!(if above { z > 5.0 } else { z < -5.0 }, "{name}: {z} from {random}");
        }
    }
}

/// Batches and shards give the sums of the whole.
#[test]
fn parts_merge_to_the_whole() {
    use pairwave::accumulate::{Decoder, Encoder, Sums};
    let ensemble = drawn("random", 40, 2, 5);
    let plan = CountPlan::new(ensemble.domain(), ensemble.shape());
    let cpu = Cpu::new(None).unwrap();
    let whole = sums_of(&cpu, &plan, &ensemble);
    let [mut late, early] = [2..5, 0..2].map(|range| sums_of(&cpu, &plan, &ensemble.slice(range)));
    late.merge(early.clone()).unwrap();
    assert_eq!(late, whole);
    assert!(late.merge(early).unwrap_err().to_string().contains("both parts hold realization 0"));
    assert!(late.merge(CountSums::new(3)).is_err());
    let mut out = Encoder::default();
    whole.encode(&mut out);
    let file = out.finish();
    assert_eq!(CountSums::decode(&mut Decoder::new("a", &file).unwrap()).unwrap(), whole);
}

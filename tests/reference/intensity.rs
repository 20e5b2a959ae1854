//! The intensity on a grid: by hand, against direct sums, against what is uniform, its bandwidth against the rules as written.

use std::f64::consts::TAU;

use crate::common::*;
use pairwave::accumulate::{Decoder, Encoder, IntensitySums, Sums};
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::estimate::Intensity;
use pairwave::plan::{IntensityBandwidth, IntensityPlan};
use pairwave::points::{Domain, Ensemble};
use pairwave::samplers::Process;

fn sums(compute: &dyn Compute, plan: &IntensityPlan, ensemble: &Ensemble) -> IntensitySums {
    wait(compute.intensity(plan, ensemble, &Control::default())).unwrap()
}

fn plan(ensemble: &Ensemble, cells: usize, bandwidth: f64) -> IntensityPlan {
    let bandwidth = IntensityBandwidth::Given(bandwidth);
    IntensityPlan::new(ensemble.domain(), Some(cells), bandwidth, ensemble.shape()).unwrap()
}

fn measured(ensemble: &Ensemble, cells: usize, bandwidth: f64) -> Intensity {
    let plan = plan(ensemble, cells, bandwidth);
    Intensity::new(&plan, &sums(&Cpu::new(None).unwrap(), &plan, ensemble)).unwrap()
}

fn l_shape() -> Domain {
    let ring = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    Domain::polygon(vec![vec![ring]]).unwrap()
}

/// One point: a Gaussian about it, over the part of it that is in the window; on a torus with its images.
#[test]
fn one_point_by_hand() {
    let gaussian = |x: f64, h: f64| (-0.5 * (x / h).powi(2)).exp() / (h * TAU.sqrt());
    let window = Domain::window(&[(10.0, 12.0)]).unwrap();
    let point = Ensemble::from_raw(&[raw(1, vec![10.5])], &window, false, 0).unwrap();
    let found = measured(&point, 4, 0.5);
    for (i, lambda) in found.lambda.iter().enumerate() {
        let x = 0.25 + 0.5 * i as f64;
        // The Gaussian from 0 to 2 about x, by the midpoint rule.
        let steps = 20_000;
        let at = |k: i32| (f64::from(k) + 0.5) * 2.0 / f64::from(steps);
        let mass: f64 = (0..steps).map(|k| gaussian(at(k) - x, 0.5) * 2.0 / f64::from(steps)).sum();
        let expected = gaussian(x - 0.5, 0.5) / mass;
        assert!((lambda / expected - 1.0).abs() < 1e-8, "{x}: {lambda}, not {expected}");
    }
    assert_eq!((found.mean, found.lambda_se, found.errors), (0.5, None, None));
    let torus = Domain::torus(&[2.0, 1.0]).unwrap();
    let point = Ensemble::from_raw(&[raw(2, vec![0.25, 0.75])], &torus, false, 0).unwrap();
    let found = measured(&point, 4, 0.4);
    let wrapped = |x: f64, side: f64| (-9..=9).map(|k| gaussian(x + f64::from(k) * side, 0.4)).sum::<f64>();
    for (cell, lambda) in found.lambda.iter().enumerate() {
        let [x, y] = [0.25 + 0.5 * (cell / 4) as f64, 0.125 + 0.25 * (cell % 4) as f64];
        let expected = wrapped(x - 0.25, 2.0) * wrapped(y - 0.75, 1.0);
        assert!((lambda / expected - 1.0).abs() < 1e-12, "{x}, {y}: {lambda}, not {expected}");
    }
}

/// The CPU path is the direct sum to rounding, in every kind of domain, and a moved point is seen.
#[test]
fn equals_the_direct_sum() {
    let cpu = Cpu::new(Some(2)).unwrap();
    for dim in 1..=3 {
        let cells = [40, 16, 7][dim - 1];
        let torus = Domain::torus(&[1.0, 0.5, 0.8][..dim]).unwrap();
        let window = Domain::window(&[(-1.0, 0.0), (5.0, 5.5), (0.0, 0.8)][..dim]).unwrap();
        let unit: Vec<_> = (0..3).map(|k| uniform(dim, 300, k)).collect();
        let placed = |domain: &Domain| {
            let place = |(i, x): (usize, &f64)| domain.origin()[i % dim] + x * domain.sides()[i % dim];
            let sets: Vec<_> =
                unit.iter().map(|s| raw(dim, s.coordinates.iter().enumerate().map(place).collect())).collect();
            // Numbered across the end of a leaf.
            Ensemble::from_raw(&sets, domain, false, 15).unwrap()
        };
        let mut domains = vec![placed(&torus), placed(&window)];
        if dim == 2 {
            let shape = l_shape();
            let mut rng = Rng(4);
            let all = (0..400).map(|_| [2.0 * rng.unit(), 2.0 * rng.unit()]).filter(|p| p[0] < 1.0 || p[1] < 1.0);
            let points: Vec<f64> = all.flatten().collect();
            domains.push(Ensemble::from_raw(&[raw(2, points)], &shape, false, 0).unwrap());
        }
        for ensemble in domains {
            for bandwidth in [0.01, 0.1, 0.45] {
                let plan = plan(&ensemble, cells, bandwidth);
                let [fast, slow] = [&cpu as &dyn Compute, &Reference].map(|way| sums(way, &plan, &ensemble));
                let [[a, a2], [b, b2]] = [fast.totals(), slow.totals()];
                let top = b.iter().copied().fold(0.0, f64::max);
                for (x, y) in a.iter().zip(&b) {
                    assert!((x - y).abs() <= 1e-13 * top, "{dim}D, {bandwidth}: {x} is not {y}");
                }
                for (x, y) in a2.iter().zip(&b2) {
                    assert!((x - y).abs() <= 1e-12 * top * top, "{dim}D, {bandwidth}: {x} is not {y}");
                }
                assert_eq!((fast.realizations, fast.points), (slow.realizations, slow.points));
                // Parts merge to the bytes of the whole.
                if ensemble.realizations() == 3 {
                    let [mut late, early] = [1..3, 0..1].map(|range| sums(&cpu, &plan, &ensemble.slice(range)));
                    late.merge(early).unwrap();
                    assert_eq!(late, fast);
                    let again = sums(&cpu, &plan, &ensemble.slice(0..1));
                    assert!(late.merge(again).unwrap_err().to_string().contains("same realizations"));
                    let mut out = Encoder::default();
                    fast.encode(&mut out);
                    let file = out.finish();
                    assert_eq!(IntensitySums::decode(&mut Decoder::new("a", &file).unwrap()).unwrap(), fast);
                }
            }
        }
    }
    let torus = Domain::unit_torus(2);
    let of = |x: f64| {
        let ensemble = Ensemble::from_raw(&[raw(2, vec![x, 0.5, 0.1, 0.2])], &torus, false, 0).unwrap();
        measured(&ensemble, 8, 0.2).lambda
    };
    assert!(of(0.3).iter().zip(of(0.301)).any(|(a, b)| (a - b).abs() > 1e-6));
}

/// On a torus all kernels together have the mass n; a lattice finer than the kernel is uniform, in windows and polygons up to their
/// edges.
#[test]
fn what_is_uniform_is_uniform() {
    for dim in 1..=3 {
        let ensemble = Process::new("random", 50, 4, dim, 3, &[]).unwrap().ensemble(0..4, &Control::default()).unwrap();
        let found = measured(&ensemble, [64, 32, 16][dim - 1], 0.15);
        assert!((found.integral / 50.0 - 1.0).abs() < 1e-9, "{dim}D: {}", found.integral);
        assert!((found.mean - 50.0).abs() < 1e-12 && found.lambda_se.is_some());
    }
    for domain in [Domain::window(&[(0.0, 2.0), (0.0, 2.0)]).unwrap(), l_shape()] {
        let step = 0.02;
        let all = (0..10_000).map(|k| [(f64::from(k % 100) + 0.5) * step, (f64::from(k / 100) + 0.5) * step]);
        let inside = |p: &[f64; 2]| domain.as_polygon().is_none() || p[0] < 1.0 || p[1] < 1.0;
        let points: Vec<f64> = all.filter(inside).flatten().collect();
        let ensemble = Ensemble::from_raw(&[raw(2, points)], &domain, false, 0).unwrap();
        let found = measured(&ensemble, 20, 0.2);
        let mut seen = 0;
        for (cell, lambda) in found.lambda.iter().enumerate() {
            let inside = domain.as_polygon().is_none() || cell / 20 < 10 || cell % 20 < 10;
            assert_eq!(found.inside[cell], inside);
            let expected = if inside { 2500.0 } else { 0.0 };
            assert!((lambda - expected).abs() < 1e-2 * 2500.0, "{domain}, cell {cell}: {lambda}, not {expected}");
            seen += usize::from(inside);
        }
        assert_eq!(seen, if domain.as_polygon().is_some() { 300 } else { 400 });
    }
}

/// Errors across realizations are those of the mean of each one's intensity.
#[test]
fn errors_are_across_realizations() {
    let ensemble = Process::new("poisson", 40, 20, 2, 9, &[]).unwrap().ensemble(0..20, &Control::default()).unwrap();
    let found = measured(&ensemble, 5, 0.1);
    let each: Vec<Vec<f64>> = (0..20).map(|k| measured(&ensemble.slice(k..k + 1), 5, 0.1).lambda).collect();
    for cell in 0..25 {
        let values: Vec<f64> = each.iter().map(|lambda| lambda[cell]).collect();
        let mean = values.iter().sum::<f64>() / 20.0;
        let se = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (20.0 * 19.0)).sqrt();
        assert!((found.lambda[cell] / mean - 1.0).abs() < 1e-12);
        assert!((found.lambda_se.as_ref().unwrap()[cell] / se - 1.0).abs() < 1e-9);
    }
}

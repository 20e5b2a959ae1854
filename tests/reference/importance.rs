//! Importance sampling by weights and by removal: the estimates, what is predicted, and faults that are seen.

use crate::integrals::{self, drawn, each, found, parts, settings, sums};
use pairwave::accumulate::IntegrationSums;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::estimate::IntegrationErrors;
use pairwave::plan::{By, Estimator, IntegrationPlan, IntegrationSettings};
use pairwave::points::Ensemble;

/// Nowhere below a tenth of its largest value.
const DENSITY: &str = "formula:0.25+0.75*sin(pi*x)^2*(0.4+0.6*y)";

struct Asked<'a> {
    integrands: &'a [&'a str],
    estimator: Option<Estimator>,
    intensity: Option<&'a str>,
    by: Option<By>,
    weighted: bool,
}

fn plan(ensemble: &Ensemble, asked: &Asked<'_>) -> IntegrationPlan {
    let settings = IntegrationSettings {
        estimator: asked.estimator,
        intensity: asked.intensity,
        by: asked.by,
        weighted: asked.weighted,
        max_frequency: Some(&[10, 10, 10][..ensemble.domain().dim()]),
        low_frequency: Some(3),
        ..settings()
    };
    integrals::plan(ensemble, asked.integrands, settings)
}

/// Numbers of every realization and integrand, in one row.
fn numbers(sums: &IntegrationSums) -> Vec<f64> {
    let of = |r: &pairwave::accumulate::RealizationSums| {
        let mut all = vec![r.weight, r.square];
        for s in &r.each {
            all.extend(parts(s));
        }
        if let Some(removal) = &r.removal {
            all.extend([removal.kept as f64, removal.shifts as f64]);
            removal.each.iter().for_each(|s| all.extend([s.error, s.given, s.shifted[0], s.shifted[1]]));
        }
        all
    };
    sums.realizations.iter().flat_map(of).collect()
}

/// Weights of any size and sign, intensities, and every estimator of points that are kept: the CPU path against the definition.
#[test]
fn cpu_equals_the_reference() {
    let all = ["gaussian:sigma=0.12", "ramp", "disk"];
    // What depends on the process or the dimension is looked at once each: plans of products take a while.
    let scenes: [(&str, u64, usize, &[usize]); 4] = [
        ("jittered", 16, 1, &[0, 1, 2, 3, 4]),
        ("random", 30, 2, &[0, 1, 2, 3, 4]),
        ("thomas", 24, 2, &[3]),
        ("random", 12, 3, &[0, 4]),
    ];
    for (name, n, dim, wanted) in scenes {
        let density = if dim == 2 { DENSITY } else { "formula:0.3+x^2" };
        let points = drawn(name, n, dim, 2, &[]);
        let weights: Vec<f64> = (0..points.total_points()).map(|j| 3e5 * (0.2 + (j as f64 * 0.7).sin())).collect();
        let mut cases = vec![
            (points.clone().with_weights(&weights), None, None, true),
            (points.clone(), None, Some(density), false),
        ];
        let ratios = [Some(Estimator::Lambda), Some(Estimator::Ratio), Some(Estimator::CountRatio)];
        cases.extend(ratios.map(|estimator| (points.clone(), estimator, Some(density), false)));
        for (case, (points, estimator, intensity, weighted)) in cases.into_iter().enumerate() {
            if !wanted.contains(&case) {
                continue;
            }
            let by = (case >= 2).then_some(By::Removal);
            let plan = plan(
                &points,
                &Asked { integrands: if dim == 3 { &all[..2] } else { &all }, estimator, intensity, by, weighted },
            );
            let [fast, slow] = [
                numbers(&sums(&Cpu::new(Some(2)).unwrap(), &plan, &points)),
                numbers(&sums(&Reference, &plan, &points)),
            ];
            assert_eq!(fast.len(), slow.len());
            let unit = slow.iter().fold(0.0, |unit: f64, x| unit.max(x.abs()));
            for (k, (a, b)) in fast.iter().zip(&slow).enumerate() {
                assert!(
                    (a - b).abs() <= 1e-11 * (b.abs() + 1e-4 * unit),
                    "{name} {dim}D, case {case}, number {k}: {a}, not {b}"
                );
            }
        }
    }
}

/// Points with weights: the error over all shifts is one number in frequency and in space, with the level that weights leave.
#[test]
fn both_forms_are_one_number_with_weights() {
    let points = drawn("random", 40, 2, 3, &[]);
    let weights: Vec<f64> = (0..120).map(|j| 0.02 * (1.0 + 0.5 * (j as f64).sin())).collect();
    let points = points.with_weights(&weights);
    for estimator in [Estimator::Lambda, Estimator::Ratio, Estimator::Mean, Estimator::CountRatio] {
        let asked = Asked {
            integrands: &["gaussian:sigma=0.12", "cosine:x=2,phase=0.3"],
            estimator: Some(estimator),
            intensity: None,
            by: None,
            weighted: true,
        };
        let plan = plan(&points, &asked);
        let sums = sums(&Cpu::new(Some(2)).unwrap(), &plan, &points);
        let found = IntegrationErrors::new(&plan, &sums).unwrap();
        for e in &found.each {
            let (space, frequency) = (e.spatial.unwrap().value, e.closed.value);
            assert!((space - frequency).abs() < 1e-11 * space, "{estimator:?} {:?}: {space} {frequency}", e.integrand);
            // As they are: bias and variance of the estimates that weights make.
            let by_hand = |k: usize| {
                let w = &weights[40 * k..40 * (k + 1)];
                let [x, y] = [0, 1].map(|a| points.turns(k, a).collect::<Vec<f64>>());
                let sum: f64 = (0..40).map(|j| w[j] * e.integrand.value(&[x[j], y[j]])).sum();
                match estimator {
                    Estimator::Lambda => sum,
                    Estimator::Ratio => sum / w.iter().sum::<f64>(),
                    Estimator::Mean => sum / 40.0,
                    // All have 40 points, which is also what is expected.
                    Estimator::CountRatio => sum,
                }
            };
            for (k, estimate) in e.estimates.iter().enumerate() {
                assert!((estimate - by_hand(k)).abs() < 1e-13, "{estimator:?}: {estimate} {}", by_hand(k));
            }
            // mse = V + phase by what phase is; V without the level is another number.
            assert!((e.mse - e.closed.value - e.phase.value).abs() < 1e-12 * e.closed.value.max(e.mse));
            let off = weights.iter().sum::<f64>() / 3.0 - 1.0;
            if matches!(estimator, Estimator::Lambda) && e.integrand.integral() > 0.01 && off.abs() > 1e-3 {
                assert!(e.count_term > 1e-6 * e.closed.value);
            }
        }
    }
}

/// Points that are kept of a parent: predicted over shifts, predicted as the parents are, and observed, of every estimator.
#[test]
fn removal_is_predicted() {
    let line = |sampler: &str, rest: &str| {
        found(&format!(
            "--sampler {sampler} -k 400 --integrand disk --by removal --intensity {DENSITY} --device cpu --stats counts {rest}"
        ))
    };
    for (sampler, rest) in [
        ("jittered -n 100", "--integrand gaussian --integrand cosine:x=1,y=1,phase=0"),
        ("random -n 100", "--integrand gaussian"),
        ("thomas -n 100", "--integrand gaussian"),
        ("jittered -n 100", "--estimator ratio"),
        ("jittered -n 100", "--estimator count-ratio"),
    ] {
        let (analysis, ratio) = (line(sampler, rest), rest.contains("ratio"));
        let all = analysis.integration().unwrap();
        let placed = all.placed.as_ref().unwrap();
        let kept = (placed.points.value - placed.expected) / placed.points.se.unwrap();
        assert!(kept.abs() < 4.5, "{sampler}: {placed:?}");
        for e in &all.each {
            let removal = e.removal.unwrap();
            assert!(removal.error < 1e-6 * removal.variance, "{removal:?}");
            // A ratio is predicted to first order: some percent of itself.
            let first_order = if ratio { 0.1 * e.closed.value } else { 0.0 };
            let off = (e.shifted.value - e.closed.value).abs();
            let se = e.shifted.se.unwrap();
            assert!(
                off < 4.5 * se + first_order,
                "{sampler} {rest} {:?}: shifted {:?}, predicted {:?}",
                e.integrand,
                e.shifted,
                e.closed
            );
            // Without what removal adds it is another number, by far, but for clusters, whose own variance is much larger.
            let without = (e.shifted.value - e.closed.value + removal.variance).abs();
            assert!(without > 8.0 * se || sampler.starts_with("thomas"), "{sampler}: {removal:?}");
            if !ratio {
                assert!(removal.z_as_is.unwrap().abs() < 4.5 && e.z.unwrap().abs() < 4.5, "{sampler} {removal:?}");
                assert!((e.bias.value / e.bias.se.unwrap()).abs() < 4.5);
            } else {
                assert!(removal.as_is.is_none());
            }
        }
        assert!(analysis.warnings.iter().all(|w| !w.contains("biased")), "{:?}", analysis.warnings);
    }
}

/// The part that removal adds, in closed form: q = x and f = x^2, `int x^4 (1/x - 1) = 1/20`.
#[test]
fn removal_in_closed_form() {
    for (line, term) in [
        ("--sampler random --dim 1 --integrand monomial:x=2 --intensity monomial:x=1", 1.0 / 20.0),
        ("--sampler random --dim 2 --integrand disk --intensity formula:0.5+0*x", 0.0),
        ("--sampler random --dim 2 --integrand disk --intensity formula:1/(1+x)", std::f64::consts::PI * 0.0625 * 0.5),
    ] {
        let analysis = found(&format!("{line} -n 50 -k 4 --by removal --device cpu --stats counts"));
        let removal = each(&analysis)[0].removal.unwrap();
        assert!((removal.variance * 50.0 - term).abs() < 1e-8, "{line}: {}", removal.variance * 50.0);
    }
}

/// A picture as the density: the part that removal adds is a sum over pixels, by hand.
#[test]
fn removal_by_a_picture() {
    let picture = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/pictures/spectrum.png");
    let line = |integrand: &str, how: &str| {
        found(&format!("--sampler random -n 40 -k 60 --integrand {integrand} --device cpu --stats counts {how}"))
    };
    let spec = format!("image:file={picture}");
    let image = pairwave::Integrand::new(&spec, 2).unwrap();
    let side = 2048;
    let values = (0..side * side)
        .map(|i| image.value(&[((i % side) as f64 + 0.5) / side as f64, ((i / side) as f64 + 0.5) / side as f64]));
    let values: Vec<f64> = values.collect();
    let most = values.iter().fold(0f64, |most, v| most.max(*v));
    let inside = |i: usize| {
        let [x, y] = [i % side, i / side].map(|k| (k as f64 + 0.5) / side as f64 - 0.5);
        x * x + y * y < 0.0625
    };
    let sum: f64 = values.iter().enumerate().filter(|(i, _)| inside(*i)).map(|(_, v)| most / v - 1.0).sum();
    let by_hand = sum / (side * side) as f64;
    let analysis = line("disk", &format!("--by removal --intensity {spec}"));
    let e = &each(&analysis)[0];
    let removal = e.removal.unwrap();
    assert!((removal.variance * 40.0 / by_hand - 1.0).abs() < 1e-3, "{removal:?}, by hand {by_hand}");
    assert!(removal.error < 1e-2 * removal.variance);
    assert!((e.shifted.value - e.closed.value).abs() < 4.5 * e.shifted.se.unwrap(), "{e:?}");
}

/// Weights that are not one over the intensity are seen by the bias, and said; right ones are not.
#[test]
fn wrong_weights_are_said() {
    let dir = tempfile::tempdir().unwrap();
    let run = |weight: &dyn Fn(f64, f64) -> f64, name: &str| {
        let q = |x: f64, y: f64| 0.25 + 0.75 * (std::f64::consts::PI * x).sin().powi(2) * (0.4 + 0.6 * y);
        let ensemble = drawn("random", 100, 2, 200, &[]);
        let mut text = String::new();
        let mut state = 1u64;
        for k in 0..200 {
            text += "#\n";
            for (x, y) in ensemble.turns(k, 0).zip(ensemble.turns(k, 1)) {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                if ((state >> 11) as f64) * 2f64.powi(-53) < q(x, y) {
                    text += &format!("{x} {y} {}\n", weight(q(x, y), 100.0));
                }
            }
        }
        let path = dir.path().join(name);
        std::fs::write(&path, text).unwrap();
        found(&format!(
            "{} --weight-column 3 --integrand disk --integrand gaussian --device cpu --stats counts",
            path.display()
        ))
    };
    let right = run(&|q, n| 1.0 / (n * q), "right.txt");
    assert!(right.warnings.iter().all(|w| !w.contains("biased")), "{:?}", right.warnings);
    let wrong = run(&|_, n| 1.0 / n, "wrong.txt");
    assert_eq!(wrong.warnings.iter().filter(|w| w.contains("biased")).count(), 2, "{:?}", wrong.warnings);
    for e in each(&wrong) {
        assert!(e.bias.value / e.bias.se.unwrap() < -10.0, "{:?}", e.bias);
    }
}

//! How wide a kernel is: the rules of thumb, and cross-validation against its score written out.

use crate::common::*;
use crate::shared::{cpu, direct, kernel_plan};
use pairwave::accumulate::PairCounts;
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::estimate::{CrossValidation, Normalization};
use pairwave::plan::{Bandwidth, BandwidthSearch, Correction, Divisor, Smoothing, SmoothingKernel};
use pairwave::points::{Domain, Ensemble};
use pairwave::samplers::Process;

#[test]
fn rules_of_bandwidth() {
    let domain = Domain::torus(&[2.0, 3.0]).unwrap();
    let stoyan = Bandwidth::Stoyan.value(&domain, 24.0);
    assert!((stoyan - 0.15 / 5f64.sqrt() * 0.5).abs() < 1e-15, "half-width 0.15 / sqrt(lambda), lambda = 4");
    assert!((Bandwidth::Fiksel.value(&domain, 24.0) - 0.05).abs() < 1e-15);
    let typed = |text: &str| text.parse::<Bandwidth>().unwrap();
    assert_eq!(
        [typed("0.25"), typed("fiksel"), typed("lscv")],
        [Bandwidth::Given(0.25), Bandwidth::Fiksel, Bandwidth::Lscv]
    );
}

fn search(e: &Ensemble, shape_: SmoothingKernel, r: [f64; 2]) -> (BandwidthSearch, PairCounts) {
    let search = BandwidthSearch::new(shape_, r, e.domain(), Correction::None, shape(e)).unwrap();
    let counts = wait(cpu().pair_counts(&search.pairs, e, &Control::default())).unwrap();
    (search, counts)
}

/// Guan's score, pair by pair.
fn brute_force_score(e: &Ensemble, kernel: Smoothing, divisor: Divisor, [from, to]: [f64; 2]) -> f64 {
    let surface = |r: f64| std::f64::consts::TAU * r;
    let (mut distances, mut norm) = (Vec::new(), 0.0);
    for k in 0..e.realizations() {
        let (axes, n) = (e.fractions(k), e.points_in(k));
        norm += (n * (n - 1)) as f64;
        for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let along = |x: &&[u64]| (x[i].wrapping_sub(x[j]) as i64 as f64 * 2f64.powi(-64)).powi(2);
            distances.push(axes.iter().map(along).sum::<f64>().sqrt());
        }
    }
    // Both orders of every pair but `without`.
    let g = |r: f64, without: Option<usize>| {
        let pairs = distances.iter().enumerate().filter(|(p, _)| Some(*p) != without);
        let divided = |d: f64| if divisor == Divisor::D { surface(d) } else { surface(r) };
        pairs.map(|(_, &d)| 2.0 * kernel.value(r - d) / divided(d)).sum::<f64>() / norm
    };
    let steps = 4000;
    let step = (to - from) / f64::from(steps);
    let integral: f64 =
        (0..steps).map(|i| from + step * (f64::from(i) + 0.5)).map(|r| g(r, None).powi(2) * surface(r) * step).sum();
    let inside = distances.iter().enumerate().filter(|(_, d)| (from..=to).contains(*d));
    integral - 2.0 * inside.map(|(p, &d)| 2.0 * g(d, Some(p))).sum::<f64>() / norm
}

#[test]
fn the_score_of_cross_validation_is_guans() {
    let cases = [
        (clustered(2, 30, 1), SmoothingKernel::Epanechnikov, Divisor::R),
        // Pairs nearer than a bin would be divided by the surface at its centre.
        (uniform(2, 30, 1), SmoothingKernel::Gaussian, Divisor::D),
    ];
    for (points, shape, divisor) in cases {
        let e = ensemble(&[points, uniform(2, 25, 2)]);
        let (search, counts) = search(&e, shape, [0.01, 0.3]);
        let [lo, hi] = search.range;
        for bandwidth in [lo, (lo * hi).sqrt(), hi] {
            let ours = CrossValidation::score(&search, &counts, divisor, Normalization::Pairs, bandwidth);
            let truth = brute_force_score(&e, Smoothing { shape, bandwidth }, divisor, search.distances);
            assert!((ours - truth).abs() < 0.01 * truth.abs(), "{shape:?}, {bandwidth}: {ours} against {truth}");
        }
        let found = CrossValidation::new(&search, &counts, divisor, Normalization::Pairs);
        let scores = (0..=40).map(|k| lo * (hi / lo).powf(f64::from(k) / 40.0));
        let scores = scores.map(|b| CrossValidation::score(&search, &counts, divisor, Normalization::Pairs, b));
        assert!(found.score <= scores.fold(f64::INFINITY, f64::min) + 1e-3 * found.score.abs(), "{found:?}");
    }
}

/// On clusters much wider than Stoyan's bandwidth, against the closed form.
#[test]
fn cross_validation_beats_the_rule_of_thumb() {
    let mut errors = [0.0; 2];
    for seed in 1..=4 {
        let process = Process::new("thomas", 400, 4, 2, seed, &["mu=10", "sigma=1"]).unwrap();
        let e = process.ensemble(0..4, &Control::default()).unwrap();
        let r: Vec<f64> = (0..200).map(|k| 0.03 + 0.0011 * f64::from(k)).collect();
        let (search, counts) = search(&e, SmoothingKernel::Epanechnikov, [r[0], r[199]]);
        let found = CrossValidation::new(&search, &counts, Divisor::R, Normalization::Pairs);
        assert!(!found.at_end && search.distances == [r[0], r[199]], "{found:?}");
        let squared_error = |bandwidth: f64| {
            let kernel = Smoothing { shape: SmoothingKernel::Epanechnikov, bandwidth };
            let g = direct(&cpu(), &kernel_plan(&e, kernel, Divisor::R, &r, Correction::None, 400.0), &e);
            let error = |(r, g): (&f64, &Option<f64>)| (g.unwrap() - process.pair_correlation(*r).unwrap()).powi(2) * r;
            g.r.iter().zip(&g.g).map(error).sum::<f64>()
        };
        let (ours, stoyan) =
            (squared_error(found.bandwidth), squared_error(Bandwidth::Stoyan.value(e.domain(), 400.0)));
        println!("seed {seed}: bandwidth {:.4}, squared error {ours:.3e}, Stoyan {stoyan:.3e}", found.bandwidth);
        errors = [errors[0] + ours, errors[1] + stoyan];
    }
    assert!(errors[0] < 0.9 * errors[1], "{errors:?}");
}

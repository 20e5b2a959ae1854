//! How often errors of one realization hold what they promise: 200 realizations, each measured alone, of random, regular and
//! clustered points; the truth is their mean.

use crate::common::*;
use crate::shared::cpu;
use pairwave::accumulate::PairCounts;
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::estimate::{ErrorSource, KFunction, Normalization, PairCorrelation, PowerSpectrum, RadialSpectrum};
use pairwave::plan::{Accuracy, Correction, PairPlan, PairSettings, RadialBins};
use pairwave::points::{Domain, Ensemble};
use pairwave::samplers::Process;

const RUNS: u64 = 200;

/// What a standard error of a normal value holds.
const NOMINAL: f64 = 0.683;

/// Values and their errors, at some abscissae.
type Values = (Vec<f64>, Vec<f64>);

/// Realizations of a process on the unit torus, as they are or as if they had been seen through the window of that size.
fn realizations(sampler: &str, params: &[&str], n: u64, dim: usize, window: bool) -> Vec<Ensemble> {
    let process = Process::new(sampler, n, RUNS, dim, 7, params).unwrap();
    let domain = if window { Domain::window(&vec![(0.0, 1.0); dim]).unwrap() } else { Domain::unit_torus(dim) };
    let one = |index| {
        let points = process.coordinates(index, &Control::default()).unwrap();
        ensemble_in(&domain, &[raw(dim, points)])
    };
    (0..RUNS).map(one).collect()
}

/// The part of values within one standard error of the mean of all, at each abscissa.
fn coverage(runs: &[Values]) -> Vec<f64> {
    let mean = |k: usize| runs.iter().map(|(values, _)| values[k]).sum::<f64>() / runs.len() as f64;
    let held = |k: usize| {
        let truth = mean(k);
        runs.iter().filter(|(values, se)| (values[k] - truth).abs() <= se[k]).count() as f64 / runs.len() as f64
    };
    (0..runs[0].0.len()).map(held).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// g and K of each, with what their errors rest on.
fn pairs(all: &[Ensemble], correction: Correction, bins: usize) -> ([Vec<Values>; 2], Vec<ErrorSource>) {
    let (mut of_g, mut of_k, mut sources) = (Vec::new(), Vec::new(), Vec::new());
    for e in all {
        let n = e.points_in(0) as f64;
        let settings = PairSettings { cumulative: true, ..correction.into() };
        // The same bins whatever n.
        let r_max = PairPlan::default_r_max(e.domain(), 500.0);
        let bins = RadialBins::linear(r_max, bins).unwrap();
        let plan = PairPlan::new(e.domain(), bins, settings, shape(e)).unwrap();
        let counts = wait(cpu().pair_counts(&plan, e, &Control::default())).unwrap();
        let g = PairCorrelation::new(&plan, &counts, Normalization::Pairs);
        let k = KFunction::new(&plan, &counts, Normalization::Pairs, n).unwrap();
        assert_eq!(g.errors, k.errors);
        sources.push(g.errors);
        of_g.push((g.g, g.g_se));
        of_k.push((k.k, k.k_se));
    }
    ([of_g, of_k], sources)
}

/// The first bin, and those where hardly any realization has a pair, say nothing.
fn assert_held(name: &str, runs: &[Values], tolerance: f64, worst: f64) {
    let held = coverage(runs);
    let held = &held[1..];
    assert!((mean(held) - NOMINAL).abs() < tolerance, "{name}: {:.3} of {held:.2?}", mean(held));
    assert!(held.iter().all(|h| (h - NOMINAL).abs() < worst), "{name}: {held:.2?}");
}

const PROCESSES: [(&str, u64, ErrorSource); 3] = [
    ("random", 500, ErrorSource::SpectralTheory),
    ("jittered", 529, ErrorSource::SpectralTheory),
    ("thomas", 500, ErrorSource::ClusterTheory),
];

/// Values of neighbouring bins of K rise and fall together, so that its mean over bins is known no better than one of them, to 0.03.
#[test]
fn errors_of_g_and_k_hold_on_a_torus() {
    for (name, n, expected) in PROCESSES {
        let ([g, k], sources) = pairs(&realizations(name, &[], n, 2, false), Correction::None, 24);
        assert!(sources.iter().all(|source| *source == expected), "{name}: {sources:?}");
        assert_held(&format!("g of {name}"), &g, 0.03, 0.12);
        assert_held(&format!("K of {name}"), &k, 0.06, 0.12);
    }
}

/// A pair closer than three spacings makes P, and so the errors of all bins, another; one beyond changes that of its own bin. And no bin is
/// surer than one unordered pair makes it.
#[test]
fn pairs_up_to_three_spacings_make_p() {
    let e = realizations("jittered", &[], 400, 2, false).swap_remove(0);
    let plan = pair_plan(&e, RadialBins::linear(0.2, 80).unwrap(), Correction::None);
    let counts = wait(cpu().pair_counts(&plan, &e, &Control::default())).unwrap();
    let errors = |counts: &PairCounts| {
        let g = PairCorrelation::new(&plan, counts, Normalization::Pairs);
        assert_eq!(g.errors, ErrorSource::SpectralTheory);
        g.g_se
    };
    let as_is = errors(&counts);
    for (spacings, seen) in [(1.7, true), (2.3, true), (2.9, true), (3.1, false), (3.8, false)] {
        let mut more = counts.clone();
        let bin = (spacings * 0.05 * 400.0) as usize;
        more.counts[bin] += 2;
        more.bins.sums[bin] += 2 << more.steps.sum_bits;
        let more = errors(&more);
        let differs = (0..80).any(|b| b != bin && more[b] != as_is[b]);
        assert_eq!(differs, seen, "a pair more at {spacings} spacings");
    }
    let empty = counts.counts.iter().take_while(|&&count| count == 0).count();
    assert!(empty > 0);
    for (b, se) in as_is[..empty].iter().enumerate() {
        let ordered_pairs = se * 400.0 * 399.0 * plan.shell_measure(b);
        assert!((ordered_pairs - 2.0).abs() < 1e-9, "bin {b}: {ordered_pairs}");
    }
}

#[test]
fn errors_of_g_and_k_hold_in_a_window() {
    for (name, n, _) in PROCESSES {
        let all = realizations(name, &[], n, 2, true);
        for correction in [Correction::Translation, Correction::Isotropic] {
            let ([g, k], _) = pairs(&all, correction, 24);
            assert_held(&format!("g of {name}, {correction}"), &g, 0.09, 0.17);
            assert_held(&format!("K of {name}, {correction}"), &k, 0.1, 0.27);
        }
    }
}

#[test]
fn errors_of_g_and_k_hold_in_one_and_three_dimensions() {
    for dim in [1, 3] {
        for (name, n) in [("random", 500), ("jittered", if dim == 1 { 500 } else { 512 }), ("thomas", 500)] {
            let ([g, k], _) = pairs(&realizations(name, &[], n, dim, false), Correction::None, 24);
            assert_held(&format!("g of {name}, {dim}D"), &g, 0.04, 0.15);
            assert_held(&format!("K of {name}, {dim}D"), &k, 0.09, 0.28);
        }
    }
}

/// Ring means of P and their 95 % bands.
#[test]
fn errors_of_ring_means_hold() {
    for (name, n, source) in PROCESSES {
        let (mut runs, mut bands) = (Vec::new(), Vec::new());
        for e in realizations(name, &[], n, 2, false) {
            let plan = wave_plan(&e, &[64, 64], Accuracy::Fast);
            let power = wait(cpu().wave_power(&plan, &e, &Control::default())).unwrap();
            let radial = RadialSpectrum::new(&plan, &power, &PowerSpectrum::new(&plan, &power));
            let clustered = radial.errors == ErrorSource::ClusterTheory;
            assert_eq!(clustered, source == ErrorSource::ClusterTheory, "{name}: {:?}", radial.errors);
            runs.push(radial.rings.iter().map(|ring| (ring.p, ring.p_se)).unzip());
            bands.push(radial.rings.iter().map(|ring| ring.band.unwrap()).collect::<Vec<_>>());
        }
        assert_held(&format!("P of {name}"), &runs, 0.03, 0.12);
        let held = |k: usize| {
            let truth = runs.iter().map(|(p, _): &Values| p[k]).sum::<f64>() / RUNS as f64;
            bands.iter().filter(|of| (of[k].lo..=of[k].hi).contains(&truth)).count() as f64 / RUNS as f64
        };
        let held: Vec<f64> = (0..runs[0].0.len()).map(held).collect();
        assert!((mean(&held) - 0.95).abs() < 0.015, "{name}: {held:.2?}");
        assert!(held.iter().all(|h| *h > 0.88), "{name}: {held:.2?}");
    }
}

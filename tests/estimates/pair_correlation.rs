//! Raw sums -> g(r) with errors, against plain formulas written out here. Trusts the reference's raw sums.

use crate::common::*;
use crate::shared::tag;
use pairwave::accumulate::{LagCounts, PairCounts, PairHistogram};
use pairwave::estimate::{ErrorSource, KFunction, Normalization, PairCorrelation, PowerSpectrum, VectorCorrelation};
use pairwave::plan::{Accuracy, Correction, PairPlan, PairSettings, RadialBins};
use pairwave::points::{Domain, Ensemble};

#[test]
fn g_and_its_error_across_realizations() {
    let sets: Vec<_> = (0..7).map(|i| uniform(2, 50, i)).collect();
    let ensemble = ensemble(&sets);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 10).unwrap(), Correction::None);
    let g = PairCorrelation::new(&plan, &reference_counts(&plan, &ensemble), Normalization::Pairs);
    assert_eq!(g.errors, ErrorSource::AcrossRealizations);
    for b in 0..10 {
        let (lo, hi) = (0.05 * b as f64, 0.05 * (b + 1) as f64);
        let each: Vec<f64> = (0..7)
            .map(|k| {
                let one = ensemble.slice(k..k + 1);
                let count = reference_counts(&plan, &one).counts[b] as f64;
                count / (50.0 * 49.0 * std::f64::consts::PI * (hi * hi - lo * lo))
            })
            .collect();
        let mean = each.iter().sum::<f64>() / 7.0;
        let variance = each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 6.0;
        assert!((g.g[b] - mean).abs() < 1e-12, "bin {b}: {} against {mean}", g.g[b]);
        let se = (variance / 7.0).sqrt();
        assert!((g.g_se[b] - se).abs() < 1e-10 * (1.0 + se), "bin {b}: {} against {se}", g.g_se[b]);
    }
}

#[test]
fn one_realization_gets_poisson_errors() {
    let plan_of = |e: &Ensemble| pair_plan(e, RadialBins::from_edges(vec![0.0, 0.1, 0.5]).unwrap(), Correction::None);
    let e = ensemble(&[uniform(2, 3, 1)]);
    let mut counts = PairCounts::new(tag(), &plan_of(&e));
    counts.add(&PairHistogram::new(100, vec![0, 7000], None));
    let g = PairCorrelation::new(&plan_of(&e), &counts, Normalization::Pairs);
    assert_eq!(g.errors, ErrorSource::Theory);
    let expected = 9900.0 * std::f64::consts::PI * 0.24;
    assert!((g.g_se[1] - (2.0 * 7000f64).sqrt() / expected).abs() < 1e-12, "sqrt(2 c): unordered pairs are Poisson");
    assert_eq!(g.g[0], 0.0);
    // That of one unordered pair: an empty bin is not known exactly.
    assert!((g.g_se[0] - 2.0 / (9900.0 * std::f64::consts::PI * 0.01)).abs() < 1e-12, "{}", g.g_se[0]);
    // Minus sampling: twice the pairs seen.
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let e = ensemble_in(&window, &[uniform(2, 60, 4)]);
    let plan = pair_plan(&e, RadialBins::linear(0.3, 2).unwrap(), Correction::Border);
    let counts = reference_counts(&plan, &e);
    let g = PairCorrelation::new(&plan, &counts, Normalization::Pairs);
    for b in 0..2 {
        assert!((g.g_se[b] / g.g[b] - (2.0 / counts.sum(b)).sqrt()).abs() < 1e-12, "{} +- {}", g.g[b], g.g_se[b]);
    }
}

#[test]
fn identical_realizations_have_no_error() {
    let e = ensemble(&vec![uniform(2, 40, 3); 5]);
    let plan = pair_plan(&e, RadialBins::linear(0.5, 6).unwrap(), Correction::None);
    let g = PairCorrelation::new(&plan, &reference_counts(&plan, &e), Normalization::Pairs);
    assert_eq!(g.g_se, [0.0; 6]);
    let plan = wave_plan(&e, &[6, 6], Accuracy::High);
    let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &e));
    assert!(spectrum.p_se.iter().zip(&spectrum.p).all(|(se, p)| *se <= 1e-6 * p), "rounding is not variance");
    assert_eq!(spectrum.dc(), Some((40.0, 0.0)));
}

#[test]
fn unequal_n_is_a_ratio_of_sums() {
    // Twice as many points in half of the realizations, all of them independent and uniform: g = 1 and P = 1.
    let sets: Vec<_> = (0..40).map(|i| uniform(2, if i % 2 == 0 { 30 } else { 60 }, 50 + i)).collect();
    let e = ensemble(&sets);
    let plan = pair_plan(&e, RadialBins::linear(0.5, 1).unwrap(), Correction::None);
    let sums = reference_counts(&plan, &e);
    let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
    let pairs = 20.0 * (30.0 * 29.0 + 60.0 * 59.0);
    assert!((g.g[0] - sums.counts[0] as f64 / (pairs * std::f64::consts::PI * 0.25)).abs() < 1e-12);
    assert!((g.g[0] - 1.0).abs() < 5.0 * g.g_se[0], "{} +- {}", g.g[0], g.g_se[0]);
    let residual = |k: usize| {
        let n = if k.is_multiple_of(2) { 30.0 * 29.0 } else { 60.0 * 59.0 };
        reference_counts(&plan, &e.slice(k..k + 1)).counts[0] as f64 - sums.counts[0] as f64 / pairs * n
    };
    let squares: f64 = (0..40).map(|k| residual(k).powi(2)).sum();
    let se = (40.0 / 39.0 * squares).sqrt() / (pairs * std::f64::consts::PI * 0.25);
    assert!((g.g_se[0] - se).abs() < 1e-6 * se, "{}, not {se}", g.g_se[0]);
    let plan = wave_plan(&e, &[10, 10], Accuracy::High);
    let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &e));
    assert_eq!(spectrum.dc().unwrap().0, (30.0 * 30.0 + 60.0 * 60.0) / 90.0, "P(0) = sum n^2 / sum n");
}

/// Asserts that deviations in standard errors look like standard errors.
fn assert_standard(name: &str, deviations: &[f64]) {
    let mean_square = deviations.iter().map(|z| z * z).sum::<f64>() / deviations.len() as f64;
    let worst = deviations.iter().fold(0f64, |w, z| w.max(z.abs()));
    println!("{name}: mean square {mean_square:.3} of {}, worst {worst:.2}", deviations.len());
    // Of 24 normal values one mean of a thousand is below.
    assert!((0.34..1.6).contains(&mean_square) && worst < 6.0, "{name}: mean square {mean_square}, worst {worst}");
}

/// The measure of a ball.
fn ball(r: f64, dim: usize) -> f64 {
    [2.0 * r, std::f64::consts::PI * r * r, 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)][dim - 1]
}

/// Independent points in a window have g = 1 and the K of a ball, whatever the correction.
#[test]
fn independent_points_in_a_window() {
    let n = 60;
    for dim in 1..=3 {
        let window = Domain::window(&[(-1.0, 1.0), (0.0, 1.0), (5.0, 6.5)][..dim]).unwrap();
        let sets: Vec<_> = (0..80).map(|i| uniform(dim, n, 3000 + i)).collect();
        let plain = ensemble_in(&window, &sets);
        let mut rng = Rng(17);
        let weights: Vec<f64> = (0..plain.total_points()).map(|_| 0.2 + rng.unit()).collect();
        let weighted = plain.clone().with_weights(&weights);
        for correction in [Correction::Translation, Correction::Isotropic, Correction::Border] {
            if dim == 3 && correction == Correction::Isotropic {
                continue;
            }
            let (r_max, share) = match correction {
                // Lambda is n / |D| here, though a point sees n - 1 others.
                Correction::Border => (0.35 * window.shortest_side(), (n as f64 - 1.0) / n as f64),
                Correction::Isotropic => (0.9 * window.half_diagonal(), 1.0),
                _ => (0.8 * window.shortest_side(), 1.0),
            };
            for (ensemble, masses) in [(&plain, false), (&weighted, true)] {
                let settings = PairSettings { cumulative: true, masses, ..correction.into() };
                let bins = RadialBins::linear(r_max, 25).unwrap();
                let plan = PairPlan::new(&window, bins, settings, shape(ensemble)).unwrap();
                let sums = reference_counts(&plan, ensemble);
                let name = format!("{correction}, {dim}D, weights of points: {masses}");
                let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
                let known = (0..25).filter(|&b| g.count[b] > 200);
                assert_standard(
                    &format!("g, {name}"),
                    &known.map(|b| (g.g[b] - share) / g.g_se[b]).collect::<Vec<_>>(),
                );
                let k = KFunction::new(&plan, &sums, Normalization::Pairs, n as f64).unwrap();
                for b in (4..25).step_by(5) {
                    let z = (k.k[b] - share * ball(k.r[b], dim)) / k.k_se[b];
                    assert!(z.abs() < 4.0, "K, {name}: {} at {}, {z} standard errors off", k.k[b], k.r[b]);
                    let z = (k.l[b] - k.r[b] * share.powf(1.0 / dim as f64)) / k.l_se[b].unwrap();
                    assert!(z.abs() < 4.0, "L, {name}: {} at {}", k.l[b], k.r[b]);
                }
            }
        }
    }
}

/// Pairs expected in a window are integrals of its set covariance: with as many pairs as expected g is 1 in every cell.
#[test]
fn translation_correction_is_the_integral_of_the_set_covariance() {
    let window = Domain::window(&[(0.0, 2.0), (1.0, 2.0)]).unwrap();
    let e = ensemble_in(&window, &(0..50).map(|i| uniform(2, 30, 400 + i)).collect::<Vec<_>>());
    for (bins, lag_max) in [(6, None), (7, None), (5, Some(0.8))] {
        let plan = lag_plan(&e, bins, lag_max, Correction::Translation);
        let mut counts = LagCounts::new(tag(), &plan);
        let n = 1_000_000u64;
        let gamma = |x: f64, y: f64| (2.0 - x.abs()).max(0.0) * (1.0 - y.abs()).max(0.0);
        let integral = |c: usize| {
            let steps = 64;
            let at = |axis: usize, s: usize| {
                plan.grid.centre(c, axis) + plan.grid.width(axis) * ((s as f64 + 0.5) / steps as f64 - 0.5)
            };
            let sum: f64 = (0..steps * steps).map(|s| gamma(at(0, s / steps), at(1, s % steps))).sum();
            sum / (steps * steps) as f64 * plan.grid.width(0) * plan.grid.width(1)
        };
        let pairs = (n * (n - 1)) as f64;
        let expected: Vec<u64> = (0..plan.grid.cells()).map(|c| (pairs * integral(c) / 4.0) as u64).collect();
        counts.add(&plan, &PairHistogram::new(n, expected, None));
        let g = VectorCorrelation::new(&plan, &counts, Normalization::Pairs);
        // The middle rule is exact but where the integrand bends.
        assert!(g.g.iter().all(|g| (g - 1.0).abs() < 1e-3), "{bins} bins: {:?}", g.g);
        assert!(g.sectors.iter().all(|s| s.g.is_none_or(|g| (g - 1.0).abs() < 1e-3)), "{:?}", g.sectors);
        // And independent points have it.
        let g = VectorCorrelation::new(&plan, &reference_lags(&plan, &e), Normalization::Pairs);
        let z: Vec<f64> =
            (0..plan.grid.cells() / 2).filter(|&c| g.count[c] > 50).map(|c| (g.g[c] - 1.0) / g.g_se[c]).collect();
        let mean_square = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
        assert!((0.4..1.9).contains(&mean_square), "mean square {mean_square} of {} deviations", z.len());
        // Without correction long lags are missed.
        let plain = lag_plan(&e, bins, lag_max, Correction::None);
        let plain = VectorCorrelation::new(&plain, &reference_lags(&plain, &e), Normalization::Pairs);
        assert!(plain.g[0] < 0.5 * g.g[0] || g.g[0] == 0.0, "{} against {}", plain.g[0], g.g[0]);
    }
}

/// Up to half the diagonal of a torus every pair is seen, and g of independent points is 1.
#[test]
fn independent_points_beyond_half_a_torus() {
    for sides in [&[1.0, 1.0][..], &[2.0, 0.6], &[1.0; 3], &[1.0, 1.5, 0.7]] {
        let torus = Domain::torus(sides).unwrap();
        let sets: Vec<_> = (0..60).map(|i| uniform(sides.len(), 70, 8000 + i)).collect();
        let ensemble = ensemble_in(&torus, &sets);
        let settings = PairSettings { beyond_half: true, ..Correction::None.into() };
        let bins = RadialBins::linear(torus.half_diagonal(), 24).unwrap();
        let plan = PairPlan::new(&torus, bins, settings, shape(&ensemble)).unwrap();
        let sums = reference_counts(&plan, &ensemble);
        assert_eq!(sums.counts.iter().sum::<u64>(), 60 * 70 * 69, "no pair is further apart");
        let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
        let known = (0..24).filter(|&b| g.count[b] > 200);
        assert_standard(&format!("torus {sides:?}"), &known.map(|b| (g.g[b] - 1.0) / g.g_se[b]).collect::<Vec<_>>());
    }
}

/// Weights that span six decades, with border correction: pairs of a heavy point with itself would be most of what is expected.
#[test]
fn independent_points_of_very_unequal_weights_seen_from_deep_inside() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let n = 40;
    let sets: Vec<_> = (0..400).map(|i| uniform(2, n, 52_000 + i)).collect();
    let mut rng = Rng(23);
    let weights: Vec<f64> = (0..400 * n).map(|_| 10f64.powf(-6.0 * rng.unit())).collect();
    let ensemble = ensemble_in(&window, &sets).with_weights(&weights);
    let settings = PairSettings { cumulative: true, masses: true, ..Correction::Border.into() };
    let plan = PairPlan::new(&window, RadialBins::linear(0.25, 5).unwrap(), settings, shape(&ensemble)).unwrap();
    let sums = reference_counts(&plan, &ensemble);
    let share = (n as f64 - 1.0) / n as f64;
    let k = KFunction::new(&plan, &sums, Normalization::Pairs, n as f64).unwrap();
    for b in 0..5 {
        let z = (k.k[b] - share * ball(k.r[b], 2)) / k.k_se[b];
        assert!(z.abs() < 4.0, "{} at {}, {z} standard errors off", k.k[b], k.r[b]);
    }
    assert!(k.k_se[4] < 0.15 * k.k[4], "{} of {}", k.k_se[4], k.k[4]);
    // Divided by (sum u) times what is deep, those pairs are missed.
    let with_itself = KFunction::new(&plan, &sums, Normalization::Intensity, n as f64).unwrap();
    let expected = 1.0 - weights.iter().map(|u| u * u).sum::<f64>() / (weights.iter().sum::<f64>().powi(2) / 400.0);
    assert!((with_itself.k[4] / k.k[4] - expected).abs() < 0.1 && expected < 0.9, "{expected}");
}

/// g of weighted points by border correction in plain f64, from coordinates: what is seen from deep points, over what all weights
/// would show if they were spread evenly.
#[test]
fn minus_sampling_of_weighted_points_is_its_definition() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let n = 90;
    let mut rng = Rng(31);
    for heavy in [1.0, 1e6] {
        let weights: Vec<f64> = (0..n).map(|j| (0.1 + rng.unit()) * if j == 7 { heavy } else { 1.0 }).collect();
        let mut points = uniform(2, n, 61);
        points.coordinates[14..16].copy_from_slice(&[0.5, 0.5]);
        let ensemble = ensemble_in(&window, &[points]).with_weights(&weights);
        let settings = PairSettings { cumulative: true, masses: true, ..Correction::Border.into() };
        let plan = PairPlan::new(&window, RadialBins::linear(0.3, 6).unwrap(), settings, shape(&ensemble)).unwrap();
        let sums = reference_counts(&plan, &ensemble);
        let at: Vec<Vec<f64>> = (0..n).map(|j| ensemble.position(0, j)).collect();
        let depth = |i: usize| [at[i][0], 2.0 - at[i][0], at[i][1], 1.0 - at[i][1]].into_iter().fold(1.0, f64::min);
        for normalization in [Normalization::Pairs, Normalization::Intensity] {
            let g = PairCorrelation::new(&plan, &sums, normalization);
            let k = KFunction::new(&plan, &sums, normalization, n as f64).unwrap();
            for b in 0..6 {
                let (lo, hi) = (plan.bins.edges()[b], plan.bins.edges()[b + 1]);
                let (mut seen, mut closer, mut expected) = (0.0, 0.0, 0.0);
                for i in (0..n).filter(|&i| depth(i) >= hi) {
                    for j in 0..n {
                        let (u, d) = (weights[i] * weights[j], (at[i][0] - at[j][0]).hypot(at[i][1] - at[j][1]));
                        expected += match normalization {
                            Normalization::Pairs if i == j => 0.0,
                            Normalization::Pairs => u * n as f64 / (n as f64 - 1.0),
                            Normalization::Intensity => u,
                        };
                        if i != j {
                            seen += if (lo..hi).contains(&d) { u } else { 0.0 };
                            closer += if d < hi { u } else { 0.0 };
                        }
                    }
                }
                let ring = std::f64::consts::PI * (hi * hi - lo * lo);
                let found = [g.g[b], k.k[b]];
                let right = [2.0 * seen / (expected * ring), 2.0 * closer / expected];
                let off = [0, 1].map(|q| (found[q] - right[q]).abs() / right[q].max(1e-3));
                assert!(
                    off.iter().all(|&off| off < 1e-7),
                    "{normalization}, {heavy}, bin {b}: {found:?}, not {right:?}"
                );
            }
        }
    }
}

/// Equal weights are no weights: not in windows either, where only deep points look, and not in the errors of one realization.
#[test]
fn equal_weights_change_nothing_with_border_correction() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    for sets in [&[uniform(2, 80, 5)][..], &[uniform(2, 80, 5), uniform(2, 70, 6), uniform(2, 1, 7)]] {
        let e = ensemble_in(&window, sets);
        let weighted = e.clone().with_weights(&vec![0.3; e.total_points()]);
        let of = |e: &Ensemble, masses, normalization| {
            let settings = PairSettings { cumulative: true, masses, ..Correction::Border.into() };
            let plan = PairPlan::new(&window, RadialBins::linear(0.4, 8).unwrap(), settings, shape(e)).unwrap();
            let sums = reference_counts(&plan, e);
            let k = KFunction::new(&plan, &sums, normalization, 50.0).unwrap();
            (PairCorrelation::new(&plan, &sums, normalization), k)
        };
        for normalization in [Normalization::Pairs, Normalization::Intensity] {
            let (plain, weighted) = (of(&e, false, normalization), of(&weighted, true, normalization));
            // In one realization what part of the pairs is seen is only estimated.
            let se = if sets.len() == 1 { 0.1 } else { 1e-3 };
            for b in 0..8 {
                for (a, b, within) in [
                    (plain.0.g[b], weighted.0.g[b], 1e-8),
                    (plain.1.k[b], weighted.1.k[b], 1e-8),
                    (plain.0.g_se[b], weighted.0.g_se[b], se),
                    (plain.1.k_se[b], weighted.1.k_se[b], se),
                ] {
                    assert!((a - b).abs() <= within * a, "{a} and {b}");
                }
            }
        }
    }
}

/// Equal weights are no weights.
#[test]
fn equal_weights_change_nothing() {
    let e = ensemble(&[uniform(2, 80, 5), uniform(2, 70, 6)]);
    let weighted = e.clone().with_weights(&[0.3; 150]);
    let g = |e: &Ensemble, masses| {
        let settings = PairSettings { masses, ..Correction::None.into() };
        let plan = PairPlan::new(e.domain(), RadialBins::linear(0.5, 8).unwrap(), settings, shape(e)).unwrap();
        PairCorrelation::new(&plan, &reference_counts(&plan, e), Normalization::Pairs)
    };
    let (plain, weighted) = (g(&e, false), g(&weighted, true));
    for b in 0..8 {
        assert!((plain.g[b] / weighted.g[b] - 1.0).abs() < 1e-8 && (plain.g_se[b] - weighted.g_se[b]).abs() < 1e-4);
    }
}

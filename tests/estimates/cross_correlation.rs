//! Raw sums -> g of two classes, against plain formulas written out here. Trusts the reference's raw sums.

use crate::common::*;
use crate::shared::tag;
use pairwave::accumulate::{CrossCounts, PairCounts};
use pairwave::estimate::{CrossCorrelation, CrossK, Normalization, PairCorrelation};
use pairwave::plan::{Correction, PairPlan, PairSettings, RadialBins};
use pairwave::points::{Domain, Ensemble};

/// Pairs within two classes and between them, realization by realization.
fn cross_counts(plan: &PairPlan, ensemble: &Ensemble) -> CrossCounts {
    let [both, a, b] = [&[0, 1][..], &[0], &[1]].map(|classes| ensemble.of_classes(classes));
    let mut between = PairCounts::new(tag(), plan);
    for k in 0..ensemble.realizations() {
        let one = |set: &Ensemble| reference_counts(plan, &set.slice(k..k + 1));
        between.add_between(plan, &one(&both), &one(&a), &one(&b));
    }
    CrossCounts { a: reference_counts(plan, &a), b: reference_counts(plan, &b), between }
}

/// g between two classes against a loop over the pairs of a point of each; a third class is left out.
#[test]
fn g_between_classes_is_its_definition() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let sets: Vec<_> = (0..6).map(|i| uniform(2, 60, 400 + i)).collect();
    for (domain, correction, masses) in [
        (Domain::unit_torus(2), Correction::None, false),
        (window.clone(), Correction::Translation, false),
        (window.clone(), Correction::Translation, true),
        (window.clone(), Correction::None, false),
        (window.clone(), Correction::Border, false),
        (window, Correction::Border, true),
    ] {
        let classes: Vec<u32> = (0..360).map(|j| j % 3).collect();
        let e = ensemble_in(&domain, &sets).with_classes(classes);
        let weights: Vec<f64> = (0..360).map(|j| if masses { 1.0 + f64::from(j % 7) } else { 1.0 }).collect();
        let e = if masses { e.with_weights(&weights) } else { e };
        // As they are scaled.
        let largest = if masses { 8.0 } else { 1.0 };
        let settings = PairSettings { cumulative: true, masses, ..correction.into() };
        let plan = PairPlan::new(&domain, RadialBins::linear(0.4, 4).unwrap(), settings, shape(&e)).unwrap();
        let names = ["oak".to_string(), "elm".to_string()];
        let counts = cross_counts(&plan, &e);
        let cross = CrossCorrelation::new(names.clone(), &plan, &counts, Normalization::Pairs);
        let k_function = CrossK::new(names, &plan, &counts, Normalization::Pairs).unwrap();
        let sides = domain.sides();
        for b in 0..4 {
            let (lo, hi) = (plan.bins.edges()[b], plan.bins.edges()[b + 1]);
            // Sums over realizations of weights from A to B and back, of pairs from A to B, of what is expected.
            let (mut sum, mut closer, mut count, mut norm) = (0.0, 0.0, 0, 0.0);
            let mut each = Vec::new();
            for k in 0..6 {
                let at: Vec<Vec<f64>> = (0..60).map(|j| e.position(k, j)).collect();
                let deep =
                    |j: usize| (0..2).map(|a| at[j][a].min(sides[a] - at[j][a])).fold(f64::INFINITY, f64::min) >= hi;
                let (mut s, mut m) = (0.0, 0.0);
                for i in (0..60).filter(|i| i % 3 < 2) {
                    for j in (0..60).filter(|j| j % 3 == 1 - i % 3) {
                        let of_points = weights[60 * k + i] * weights[60 * k + j] / (largest * largest);
                        let (mut d2, mut weight) = (0.0, of_points);
                        for a in 0..2 {
                            let mut d = (at[i][a] - at[j][a]).abs();
                            if domain.is_torus() {
                                d = d.min(sides[a] - d);
                            } else if correction == Correction::Translation {
                                weight *= sides[a] / (sides[a] - d);
                            }
                            d2 += d * d;
                        }
                        let seen = correction != Correction::Border || deep(i);
                        m += if seen { of_points } else { 0.0 };
                        closer += if seen && d2.sqrt() < hi { weight } else { 0.0 };
                        if (lo..hi).contains(&d2.sqrt()) {
                            count += usize::from(i % 3 == 0);
                            s += if seen { weight } else { 0.0 };
                        }
                    }
                }
                sum += s;
                norm += m;
                each.push((s, m));
            }
            let expected = norm * std::f64::consts::PI * (hi * hi - lo * lo) / domain.measure();
            let g = &cross.between;
            assert_eq!(g.count[b], count as u64, "{correction}, bin {b}");
            assert!((g.g[b] - sum / expected).abs() < 1e-8, "{correction}, bin {b}: {} not {}", g.g[b], sum / expected);
            let k = domain.measure() * closer / norm;
            let found = k_function.between.k[b];
            assert!((found - k).abs() < 1e-8 * k, "{correction}, K at {hi}: {found} not {k}");
            let residuals: f64 = each.iter().map(|(s, m)| (s - sum / norm * m).powi(2)).sum();
            let se = (6.0 / 5.0 * residuals).sqrt() / expected;
            assert!((g.g_se[b] - se).abs() < 1e-4 * se, "{correction}, bin {b}: {} not {se}", g.g_se[b]);
        }
        let alone = reference_counts(&plan, &e.of_classes(&[1]));
        assert_eq!(cross.b, PairCorrelation::new(&plan, &alone, Normalization::Pairs));
    }
}

//! Raw sums -> K and L with errors, against plain formulas written out here. Trusts the reference's raw sums.

use crate::common::*;
use pairwave::estimate::{ErrorSource, KFunction, Normalization};
use pairwave::plan::{Correction, PairPlan, PairSettings, RadialBins};

#[test]
fn k_and_its_errors() {
    let sets: Vec<_> = (0..7).map(|i| uniform(2, 50, i)).collect();
    let e = ensemble(&sets);
    let settings = PairSettings { cumulative: true, ..Correction::None.into() };
    let plan = PairPlan::new(e.domain(), RadialBins::linear(0.5, 10).unwrap(), settings, shape(&e)).unwrap();
    let k = KFunction::new(&plan, &reference_counts(&plan, &e), Normalization::Pairs, 50.0).unwrap();
    assert_eq!(k.errors, ErrorSource::AcrossRealizations);
    for b in 0..10 {
        let each: Vec<f64> = (0..7)
            .map(|i| {
                reference_counts(&plan, &e.slice(i..i + 1)).counts[..=b].iter().sum::<u64>() as f64 / (50.0 * 49.0)
            })
            .collect();
        let mean = each.iter().sum::<f64>() / 7.0;
        let se = (each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 42.0).sqrt();
        assert!((k.k[b] - mean).abs() < 1e-12 && (k.k_se[b] - se).abs() < 1e-12, "K({}) = {}", k.r[b], k.k[b]);
        let closer: u64 = reference_counts(&plan, &e).counts[..=b].iter().sum();
        assert!((k.neighbors[b] - closer as f64 / 350.0).abs() < 1e-12, "ordered pairs per point");
        assert!((k.l[b].powi(2) * std::f64::consts::PI - mean).abs() < 1e-12, "L = sqrt(K / pi)");
        let of_l = se * k.l[b] / (2.0 * k.k[b]);
        assert!((k.l_se[b].unwrap() - of_l).abs() < 1e-12, "the error of L = sqrt(K / pi), to first order");
    }
    // One realization, in bins too wide to show a spectrum: unordered pairs are Poisson.
    let coarse = PairPlan::new(e.domain(), RadialBins::linear(0.5, 3).unwrap(), settings, shape(&e)).unwrap();
    let counts = reference_counts(&coarse, &e.slice(0..1));
    let one = KFunction::new(&coarse, &counts, Normalization::Intensity, 50.0).unwrap();
    let closer = counts.counts.iter().sum::<u64>() as f64;
    assert_eq!(one.errors, ErrorSource::Theory);
    assert!((one.k[2] - closer / 2500.0).abs() < 1e-12);
    assert!((one.k_se[2] - (2.0 * closer).sqrt() / 2500.0).abs() < 1e-12);
    let no_k = pair_plan(&e, RadialBins::linear(0.5, 10).unwrap(), Correction::None);
    assert_eq!(KFunction::new(&no_k, &reference_counts(&no_k, &e), Normalization::Pairs, 50.0), None);
}

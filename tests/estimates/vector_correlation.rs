//! Raw sums -> g of the vector with errors, against plain formulas written out here. Trusts the reference's raw sums.

use crate::common::*;
use crate::shared::tag;
use pairwave::accumulate::{LagCounts, PairHistogram};
use pairwave::estimate::{ErrorSource, Normalization, VectorCorrelation};
use pairwave::plan::Correction;

#[test]
fn vector_g_and_its_error_across_realizations() {
    let e = ensemble(&(0..6).map(|i| uniform(2, 40, 70 + i)).collect::<Vec<_>>());
    let plan = lag_plan(&e, 5, Some(0.4), Correction::None);
    let g = VectorCorrelation::new(&plan, &reference_lags(&plan, &e), Normalization::Pairs);
    assert_eq!(g.errors, ErrorSource::AcrossRealizations);
    // Of a cell, and of sectors by the cells they name.
    let statistics = |cells: &[usize]| {
        let of = |k: usize| {
            let counts = reference_lags(&plan, &e.slice(k..k + 1)).cells.sums;
            let sum: u128 = cells.iter().map(|&c| counts[c]).sum();
            sum as f64 / (40.0 * 39.0 * 0.16 * 0.16 * cells.len() as f64)
        };
        let each: Vec<f64> = (0..6).map(of).collect();
        let mean = each.iter().sum::<f64>() / 6.0;
        (mean, (each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 5.0 / 6.0).sqrt())
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-10 * (1.0 + b), "{a} against {b}");
    for c in 0..25 {
        let (mean, se) = statistics(&[c]);
        close(g.g[c], mean);
        close(g.g_se[c], se);
    }
    assert!(!g.sectors.is_empty());
    for (sector, plan) in g.sectors.iter().zip(&plan.sectors) {
        match sector.g {
            Some(value) => {
                let (mean, se) = statistics(&plan.cells.iter().map(|&c| c as usize).collect::<Vec<_>>());
                close(value, mean);
                close(sector.g_se.unwrap(), se);
            }
            None => assert!(plan.cells.is_empty()),
        }
    }
}

#[test]
fn vector_g_of_one_realization_gets_poisson_errors() {
    let e = ensemble(&[uniform(1, 50, 1)]);
    let plan = lag_plan(&e, 3, None, Correction::None);
    let mut counts = LagCounts::new(tag(), &plan);
    counts.add(&plan, &PairHistogram::new(50, vec![900, 0, 900], None));
    let g = VectorCorrelation::new(&plan, &counts, Normalization::Intensity);
    assert_eq!(g.errors, ErrorSource::Theory);
    let expected = 2500.0 / 3.0;
    assert!((g.g[0] - 900.0 / expected).abs() < 1e-12, "n^2");
    assert!((g.g_se[0] - 30.0 / expected).abs() < 1e-12, "each of 900 unordered pairs is once in this cell");
    assert!((g.g_se[1] - 2.0 / expected).abs() < 1e-12, "the middle cell gets one pair twice");
}

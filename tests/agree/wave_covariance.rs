//! The native path sums the same products of amplitudes, up to rounding.

use crate::common::*;
use crate::shared::cpu;
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::plan::{CovariancePlan, LEAF};
use pairwave::points::Ensemble;

/// Products of amplitudes are the reference's, and the same bytes on any number of threads and for any cut.
#[test]
fn covariances_equal_the_reference() {
    let sizes = |k: u64| 20 + (k % 3) as usize;
    for (dim, weighted, realizations) in [(1, false, 1), (2, false, 35), (2, true, 18), (3, false, 2)] {
        let sets: Vec<_> = (0..realizations).map(|k| uniform(dim, sizes(k), k)).collect();
        let mut points = ensemble(&sets);
        if weighted {
            let weights: Vec<f64> = (0..points.total_points()).map(|j| (j as f64 * 0.7).sin()).collect();
            points = points.with_weights(&weights);
        }
        let plan = CovariancePlan::new(points.domain(), Some(3), shape(&points)).unwrap();
        let of = |compute: &dyn Compute, points: &Ensemble| {
            wait(compute.wave_covariance(&plan, points, &Control::default())).unwrap()
        };
        let reference = of(&pairwave::compute::reference::Reference, &points);
        let whole = of(&cpu(1), &points);
        let found = whole.totals();
        assert_eq!(covariances_agree(&whole, &reference), Ok(()), "{dim}D");
        for threads in [2, 3] {
            assert_eq!(of(&cpu(threads), &points).totals(), found, "{threads} threads");
        }
        if realizations > LEAF {
            let cut = LEAF as usize;
            let mut parts = of(&cpu(2), &points.slice(cut..realizations as usize));
            parts.merge(of(&cpu(1), &points.slice(0..cut))).unwrap();
            assert_eq!((parts.totals(), parts.realizations), (found, realizations));
            assert!(parts.merge(of(&cpu(1), &points.slice(0..cut))).is_err());
        }
    }
}

//! Trusts the reference and the comparators (`reference/`). Proves that the GPU counts the same lags, whatever the input and
//! however the work is cut. Cannot see: speed, and other drivers than the one here.

use crate::common::*;
use crate::shared::{go, open, shared};
use pairwave::compute::Compute;
use pairwave::compute::gpu::Fill;
use pairwave::plan::Correction;
use pairwave::points::Domain;

#[test]
fn lag_counts_are_equal() {
    let Some(gpu) = shared("lag counts") else { return };
    for case in lag_cases(120) {
        let here = wait(gpu.lag_counts(&case.plan, &case.ensemble, &go())).unwrap();
        assert_lags_equal(&case.name, &here, &reference_lags(&case.plan, &case.ensemble));
    }
    // Several tiles, the last of them partial, and realizations of very different sizes in one dispatch.
    let sets = [uniform(2, 700, 1), lattice(2, 16), uniform(2, 3, 2), uniform(2, 513, 3)];
    for domain in [Domain::unit_torus(2), Domain::torus(&[1.0, 0.8]).unwrap()] {
        let ensemble = ensemble_in(&domain, &sets);
        let plan = lag_plan(&ensemble, 32, None, Correction::None);
        let here = wait(gpu.lag_counts(&plan, &ensemble, &go())).unwrap();
        assert_lags_equal("several tiles", &here, &reference_lags(&plan, &ensemble));
    }
}

#[test]
fn lag_counts_do_not_depend_on_cuts_or_memory() {
    let Some(gpu) = open("lag counts, cuts") else { return };
    let ensemble = ensemble(&[uniform(2, 600, 1), uniform(2, 30, 2), uniform(2, 300, 3)]);
    let plan = lag_plan(&ensemble, 20, Some(0.2), Correction::None);
    let truth = reference_lags(&plan, &ensemble);
    let gpu = gpu.with_tuning(|t| {
        t.pairs_per_dispatch = 1;
        t.buffer_bytes = 1 << 12;
        t.fill = Fill::Poison;
    });
    assert_lags_equal("small cuts", &wait(gpu.lag_counts(&plan, &ensemble, &go())).unwrap(), &truth);
}

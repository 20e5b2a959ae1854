//! The native path counts the same lags, integer for integer, on any number of threads.

use crate::common::*;
use crate::shared::{cpu, levels};
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::plan::Correction;
use pairwave::points::Ensemble;

#[test]
fn lag_counts_equal_the_reference() {
    let agree = |name: &str, plan: &pairwave::plan::LagPlan, ensemble: &Ensemble| {
        let truth = reference_lags(plan, ensemble);
        for cpu in levels() {
            let counts = wait(cpu.lag_counts(plan, ensemble, &Control::default())).unwrap();
            assert_lags_equal(&format!("{name}, {}", cpu.level().name()), &counts, &truth);
        }
    };
    for case in lag_cases(300) {
        agree(&case.name, &case.plan, &case.ensemble);
    }
    // Around pieces of columns and blocks of rows, and realizations shared between threads.
    for n in [15, 16, 17, 63, 64, 65, 1023, 1024, 1025, 2049] {
        let ensemble = ensemble(&[uniform(2, n, n as u64)]);
        agree(&format!("n = {n}"), &lag_plan(&ensemble, 10, Some(0.3), Correction::None), &ensemble);
    }
    let several = ensemble(&[1100, 40, 0, 600].map(|n| uniform(3, n, 5)));
    agree("shared", &lag_plan(&several, 40, None, Correction::None), &several);
}

#[test]
fn lag_counts_do_not_depend_on_threads() {
    let sets: Vec<_> = (0..40).map(|k| uniform(2, 50 + k as usize, k)).collect();
    for ensemble in [ensemble(&sets), ensemble(&[uniform(2, 3000, 1)])] {
        let plan = lag_plan(&ensemble, 12, None, Correction::None);
        let mut one = wait(cpu(1).lag_counts(&plan, &ensemble, &Control::default())).unwrap();
        let three = wait(cpu(3).lag_counts(&plan, &ensemble, &Control::default())).unwrap();
        one.computed_by = three.computed_by.clone();
        assert_eq!(one, three);
    }
}

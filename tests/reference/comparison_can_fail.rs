//! The comparators the other tests trust: each planted fault here must be caught.

use crate::common::*;
use pairwave::accumulate::{Backend, ComputedBy};
use pairwave::accumulate::{CovarianceSums, PairCounts, WaveCovariance};
use pairwave::compute::{Compute, reference::Reference};
use pairwave::control::Control;
use pairwave::plan::{Accuracy, Correction, CovariancePlan, GPU_WEIGHT_BOUND, PairPlan, PairSettings, RadialBins};
use pairwave::points::Domain;

fn as_if_by_cpu(computed_by: &mut ComputedBy) {
    *computed_by = ComputedBy::new(Backend::Cpu, "planted");
}

#[test]
fn one_moved_pair_is_caught() {
    let ensemble = ensemble(&[uniform(2, 200, 1)]);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let truth = reference_counts(&plan, &ensemble);
    let mut other = truth.clone();
    as_if_by_cpu(&mut other.computed_by);
    assert_eq!(counts_agree(&other, &truth), Ok(()), "equal counts pass");
    other.counts[3] += 1;
    other.counts[4] -= 1;
    assert!(counts_agree(&other, &truth).unwrap_err().contains("bin 3"), "one moved pair");
}

#[test]
fn a_moved_edge_is_caught() {
    let ensemble = ensemble(&[lattice(2, 10)]);
    let at = |r_max: f64| {
        let plan = pair_plan(&ensemble, RadialBins::linear(r_max, 5).unwrap(), Correction::None);
        reference_counts(&plan, &ensemble)
    };
    let mut moved = at(0.5 - 1e-12);
    as_if_by_cpu(&mut moved.computed_by);
    assert!(counts_agree(&moved, &at(0.5)).is_err(), "lattice distances sit on the edges: 1e-12 moves them");
}

#[test]
fn a_weight_beyond_the_bound_and_a_moved_pair_beside_weights_are_caught() {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 2.0)]).unwrap();
    let ensemble = ensemble_in(&window, &[uniform(2, 200, 1)]);
    let settings = PairSettings { cumulative: true, ..Correction::Translation.into() };
    let bins = RadialBins::linear(0.4, 20).unwrap();
    let plan = PairPlan::new(&window, bins, settings, shape(&ensemble)).unwrap();
    let truth = reference_counts(&plan, &ensemble);
    assert!(weight_error(&truth, &truth).is_err(), "reference against reference compares nothing");
    let mut other = truth.clone();
    as_if_by_cpu(&mut other.computed_by);
    assert_eq!(weight_error(&other, &truth), Ok(0.0), "equal sums pass");
    let planted = |change: &dyn Fn(&mut PairCounts)| {
        let mut planted = other.clone();
        change(&mut planted);
        weight_error(&planted, &truth)
    };
    let off = |sum: &mut u128| *sum += *sum * 3 / 1_000_000;
    assert!(planted(&|c| off(&mut c.bins.sums[7])).unwrap() > GPU_WEIGHT_BOUND, "a sum off by 3e-6");
    assert!(planted(&|c| off(&mut c.cumulative.as_mut().unwrap().sums[19])).unwrap() > GPU_WEIGHT_BOUND);
    assert!(planted(&|c| c.counts[3] += 1).is_err(), "a pair too many");
    assert!(planted(&|c| c.bins.norms[0][0].sum += 1).is_err(), "another norm");
}

#[test]
fn a_lag_on_the_wrong_side_is_caught() {
    let ensemble = ensemble(&[lattice(2, 8)]);
    let plan = lag_plan(&ensemble, 8, None, Correction::None);
    let truth = reference_lags(&plan, &ensemble);
    let mut other = truth.clone();
    as_if_by_cpu(&mut other.computed_by);
    assert_eq!(lags_agree(&other, &truth), Ok(()), "equal counts pass");
    assert!(lags_agree(&truth, &truth).is_err(), "reference against reference compares nothing");
    other.cells.sums[3] += 1;
    other.cells.sums[4] -= 1;
    assert!(lags_agree(&other, &truth).unwrap_err().contains("cell 3"), "one moved pair");
    // Edges moved by less than any float between 1/4 and 1/2 could tell.
    let mut moved = plan.clone();
    moved.grid.thresholds[0].iter_mut().for_each(|t| *t += 1);
    let mut moved = reference_lags(&moved, &ensemble);
    as_if_by_cpu(&mut moved.computed_by);
    assert!(lags_agree(&moved, &truth).is_err(), "one step of 2^-64");
}

#[test]
fn the_same_hand_twice_is_refused() {
    let ensemble = ensemble(&[uniform(2, 20, 1)]);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 4).unwrap(), Correction::None);
    let truth = reference_counts(&plan, &ensemble);
    assert!(counts_agree(&truth, &truth).is_err(), "reference against reference compares nothing");
    let waves = wave_plan(&ensemble, &[4, 4], Accuracy::Fast);
    let power = reference_power(&waves, &ensemble);
    assert!(power_error(&power, &power).is_err(), "reference against reference compares nothing");
}

#[test]
fn a_missing_point_and_a_nan_are_caught() {
    let whole = ensemble(&[uniform(2, 100, 1)]);
    let waves = wave_plan(&whole, &[4, 4], Accuracy::Fast);
    let truth = reference_power(&waves, &whole);

    let mut same = truth.clone();
    as_if_by_cpu(&mut same.computed_by);
    assert_eq!(power_error(&same, &truth).unwrap().max, 0.0, "equal powers pass");

    // A point left out of every sum but one.
    let mut points = uniform(2, 100, 1);
    points.coordinates[0] += 1e-3;
    let mut off = reference_power(&waves, &ensemble(&[points]));
    as_if_by_cpu(&mut off.computed_by);
    let error = power_error(&off, &truth).unwrap();
    assert!(error.max > Accuracy::Fast.power_bound().max_any(100.0), "one point moved by 1e-3: {error:?}");

    let mut nan =
        pairwave::accumulate::WavePower::new(ComputedBy::new(Backend::Cpu, "planted"), truth.modes(), &waves.rings);
    let mut values = truth.mode_totals().q;
    values[7] = f64::NAN;
    nan.add(0, 100.0, &values, &waves.rings);
    assert!(power_error(&nan, &truth).is_err(), "NaN cannot pass");
}

#[test]
fn cancelling_gives_an_error_not_a_part() {
    use pairwave::compute::{Compute, reference::Reference};
    let ensemble = ensemble(&[uniform(2, 20, 1)]);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 4).unwrap(), Correction::None);
    let control = Control::default();
    control.cancel();
    assert!(wait(Reference.pair_counts(&plan, &ensemble, &control)).is_err(), "cancelled work must not return sums");
}

#[test]
fn an_amplitude_conjugated_or_a_nan_in_a_covariance_is_caught() {
    let points = ensemble(&[uniform(2, 30, 1), uniform(2, 33, 2)]);
    let plan = CovariancePlan::new(points.domain(), Some(2), shape(&points)).unwrap();
    let truth = wait(Reference.wave_covariance(&plan, &points, &Control::default())).unwrap();
    assert!(covariances_agree(&truth, &truth).is_err(), "reference against reference compares nothing");
    let planted = |change: &dyn Fn(&mut CovarianceSums)| {
        let mut sums = truth.totals();
        change(&mut sums);
        let mut other = WaveCovariance::new(ComputedBy::new(Backend::Cpu, "planted"), sums.stored);
        other.add_leaf(0, 2, sums);
        covariances_agree(&other, &truth)
    };
    assert_eq!(planted(&|_| ()), Ok(()), "equal sums pass");
    // Mode 3 with the sign of its imaginary part, component 3 + H, turned over: its row and its column but for the diagonal.
    let conjugated = planted(&|s| {
        let (h, a) = (s.stored, s.stored + 3);
        (0..2 * h).filter(|&b| b != a).for_each(|b| {
            s.products[a * 2 * h + b] *= -1.0;
            s.products[b * 2 * h + a] *= -1.0;
        });
    });
    assert!(conjugated.unwrap_err().contains("products:"));
    assert!(planted(&|s| s.products_n[5] *= 1.0 + 1e-6).unwrap_err().contains("norms: "), "1e-6 of one product");
    assert!(planted(&|s| s.powers[7] = f64::NAN).unwrap_err().contains("powers"), "NaN cannot pass");
    assert!(planted(&|s| s.norms[1] += 1.0).unwrap_err().starts_with("norms"));
}

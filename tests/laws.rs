//! Laws that need no reference: each holds for every input, whatever the numbers are. Checked on the reference here and
//! on the fast paths by `backends_agree`, which makes them equal.

mod common;

use common::*;
use pairwave::accumulate::{LEAF, PairCounts, WavePower};
use pairwave::compute::{Compute, Control, reference::Reference};
use pairwave::estimate::PowerSpectrum;
use pairwave::plan::{Accuracy, Correction, PairPlan, RadialBins};
use pairwave::points::{Ensemble, RawPoints};

fn all_pairs(ensemble: &Ensemble) -> PairPlan {
    pair_plan(ensemble, RadialBins::linear(0.5, 32).unwrap(), Correction::None)
}

/// Dyadic coordinates: shifting them is exact.
fn dyadic(dim: usize, n: usize, seed: u64) -> RawPoints {
    let mut points = uniform(dim, n, seed);
    points.coordinates.iter_mut().for_each(|x| *x = (*x * 1024.0).floor() / 1024.0);
    points
}

#[test]
fn a_shift_of_the_torus_changes_nothing() {
    for dim in 1..=3 {
        let still = dyadic(dim, 120, 1);
        let mut shifted = still.clone();
        shifted.coordinates.iter_mut().for_each(|x| *x = (*x + 0.3125) % 1.0);
        let (a, b) = (ensemble(&[still]), ensemble(&[shifted]));
        let plan = all_pairs(&a);
        assert_eq!(reference_counts(&plan, &a), reference_counts(&plan, &b), "counts, {dim}D");
        let plan = wave_plan(&a, &vec![4; dim], Accuracy::High);
        let (p, q) = (reference_power(&plan, &a).mode_totals().q, reference_power(&plan, &b).mode_totals().q);
        assert!(p.iter().zip(&q).all(|(p, q)| (p - q).abs() < 1e-10), "powers, {dim}D");
    }
}

#[test]
fn the_order_of_points_changes_nothing() {
    let points = uniform(2, 150, 2);
    let mut reversed = points.clone();
    reversed.coordinates = points.coordinates.chunks(2).rev().flatten().copied().collect();
    let (a, b) = (ensemble(&[points]), ensemble(&[reversed]));
    let plan = all_pairs(&a);
    assert_eq!(reference_counts(&plan, &a), reference_counts(&plan, &b));
    let plan = wave_plan(&a, &[5, 5], Accuracy::High);
    let (p, q) = (reference_power(&plan, &a).mode_totals().q, reference_power(&plan, &b).mode_totals().q);
    assert!(p.iter().zip(&q).all(|(p, q)| (p - q).abs() < 1e-11));
}

#[test]
fn the_sum_of_all_bins_is_all_pairs() {
    // In 1D every distance is at most 1/2, and 1/2 itself never occurs here.
    let line = ensemble(&[uniform(1, 100, 3), uniform(1, 57, 4)]);
    assert_eq!(reference_counts(&all_pairs(&line), &line).counts.iter().sum::<u64>(), 100 * 99 + 57 * 56);
    // A window with r beyond every distance that occurs.
    let window = pairwave::points::Domain::window(&[(0.0, 9.0), (0.0, 9.0)]).unwrap();
    let mut corner = uniform(2, 80, 5);
    corner.coordinates.iter_mut().for_each(|x| *x *= 0.5);
    let few = ensemble_in(&window, &[corner]);
    let plan = pair_plan(&few, RadialBins::linear(8.0, 9).unwrap(), Correction::Translation);
    assert_eq!(reference_counts(&plan, &few).counts.iter().sum::<u64>(), 80 * 79);
}

#[test]
fn dc_is_n_and_the_mirror_image_is_the_same() {
    let points = ensemble(&[uniform(3, 64, 6)]);
    let plan = wave_plan(&points, &[3, 2, 4], Accuracy::High);
    let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &points));
    assert_eq!(spectrum.dc().0, 64.0, "P(0) = n, exactly");
    let full: Vec<f64> = spectrum.full(&spectrum.p).collect();
    assert_eq!(full.len(), 7 * 5 * 9);
    assert!(full.iter().eq(full.iter().rev()), "P(-m) = P(m)");
    // The whole grid is in C order, x slowest, index m + F.
    let at = |m: [i32; 3]| full[((m[0] + 3) as usize * 5 + (m[1] + 2) as usize) * 9 + (m[2] + 4) as usize];
    for m in [[0, 0, 0], [3, -2, 4], [-1, 2, -3], [0, -1, 0], [0, 0, 4]] {
        assert_eq!(at(m), spectrum.at(m), "m = {m:?}");
    }
    // And the mirrored plane m_0 = 0, stored whole, is its own mirror image up to rounding.
    assert!((spectrum.at([0, 1, -2]) - spectrum.at([0, -1, 2])).abs() < 1e-12);
}

#[test]
fn every_point_twice_doubles_and_quadruples() {
    let once = dyadic(2, 60, 8);
    let mut twice = once.clone();
    twice.coordinates.extend(once.coordinates.iter());
    let (a, b) = (ensemble(&[once]), ensemble(&[twice]));
    let plan = all_pairs(&a);
    let (a_counts, b_counts) = (reference_counts(&plan, &a).counts, reference_counts(&plan, &b).counts);
    assert_eq!(b_counts[0], 4 * a_counts[0] + 2 * 60, "each pair four times, and each point with its copy");
    assert!(a_counts[1..].iter().zip(&b_counts[1..]).all(|(a, b)| 4 * a == *b));
}

#[test]
fn shards_merge_to_the_bytes_of_the_whole() {
    let sets: Vec<_> = (0..5 * LEAF + 3).map(|i| uniform(2, 10 + i as usize % 3, i)).collect();
    let whole = ensemble(&sets);
    let (pairs, waves) = (all_pairs(&whole), wave_plan(&whole, &[3, 3], Accuracy::Fast));
    let run = |part: &Ensemble| -> (PairCounts, WavePower) {
        let control = Control::default();
        (Reference.pair_counts(&pairs, part, &control).unwrap(), Reference.wave_power(&waves, part, &control).unwrap())
    };
    let (all_counts, all_power) = run(&whole);
    for cut in (LEAF..whole.realizations() as u64).step_by(LEAF as usize) {
        let (left, right) = (whole.slice(0..cut as usize), whole.slice(cut as usize..whole.realizations()));
        for (first, second) in [(&left, &right), (&right, &left)] {
            let (mut counts, mut power) = run(first);
            let (more_counts, more_power) = run(second);
            counts.merge(&more_counts).unwrap();
            power.merge(more_power).unwrap();
            assert_eq!(counts, all_counts, "cut at {cut}");
            assert_eq!(power.mode_totals(), all_power.mode_totals(), "cut at {cut}");
        }
    }
    let (mut counts, mut power) = run(&whole);
    assert!(power.merge(run(&whole).1).is_err(), "the same realizations twice are refused");
    let other = pair_plan(&whole, RadialBins::linear(0.5, 5).unwrap(), Correction::None);
    assert!(counts.merge(&reference_counts(&other, &whole)).is_err(), "other bins are refused");
}

#[test]
fn points_of_a_torus_fold() {
    use pairwave::points::Domain;
    let torus = Domain::torus(&[2.0, 3.0]).unwrap();
    let inside = Ensemble::from_raw(&[raw(2, vec![0.5, 2.5])], &torus, false, 0).unwrap();
    let outside = Ensemble::from_raw(&[raw(2, vec![-3.5, 8.5])], &torus, true, 0).unwrap();
    assert_eq!(inside.position(0, 0), outside.position(0, 0));
    let error = Ensemble::from_raw(&[raw(2, vec![0.5, 3.0])], &torus, false, 0).unwrap_err().to_string();
    assert_eq!(
        error,
        "test, point 0: y = 3 is outside [0, 3); --wrap folds points in, --box sets the sides, --window a window"
    );
}

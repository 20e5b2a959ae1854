//! Laws that need no reference: each holds for every input, whatever the numbers are. Checked on the reference and on the CPU
//! path; `gpu_agrees` ties the GPU to the reference integer for integer.

use crate::common::*;
use pairwave::accumulate::{LagCounts, PairCounts, WavePower};
use pairwave::compute::{Compute, cpu::Cpu, reference::Reference};
use pairwave::control::Control;
use pairwave::estimate::PowerSpectrum;
use pairwave::plan::LEAF;
use pairwave::plan::{Accuracy, Correction, LagPlan, PairPlan, RadialBins, WavePlan};
use pairwave::points::{Ensemble, RawPoints};

/// A law holds for every backend.
fn for_each_backend(law: impl Fn(&dyn Compute)) {
    law(&Reference);
    law(&Cpu::new(Some(2)).unwrap());
}

fn counts(backend: &dyn Compute, plan: &PairPlan, ensemble: &Ensemble) -> PairCounts {
    wait(backend.pair_counts(plan, ensemble, &Control::default())).unwrap()
}

fn lags(backend: &dyn Compute, plan: &LagPlan, ensemble: &Ensemble) -> LagCounts {
    wait(backend.lag_counts(plan, ensemble, &Control::default())).unwrap()
}

fn power(backend: &dyn Compute, plan: &WavePlan, ensemble: &Ensemble) -> WavePower {
    wait(backend.wave_power(plan, ensemble, &Control::default())).unwrap()
}

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
    for_each_backend(|backend| {
        for dim in 1..=3 {
            let still = dyadic(dim, 120, 1);
            let mut shifted = still.clone();
            shifted.coordinates.iter_mut().for_each(|x| *x = (*x + 0.3125) % 1.0);
            let (a, b) = (ensemble(&[still]), ensemble(&[shifted]));
            let plan = all_pairs(&a);
            assert_eq!(counts(backend, &plan, &a), counts(backend, &plan, &b), "counts, {dim}D");
            let plan = wave_plan(&a, &vec![4; dim], Accuracy::High);
            let (p, q) = (power(backend, &plan, &a).mode_totals().q, power(backend, &plan, &b).mode_totals().q);
            assert!(p.iter().zip(&q).all(|(p, q)| (p - q).abs() < 1e-10), "powers, {dim}D");
        }
    });
}

#[test]
fn the_order_of_points_changes_nothing() {
    for_each_backend(|backend| {
        let points = uniform(2, 150, 2);
        let mut reversed = points.clone();
        reversed.coordinates = points.coordinates.chunks(2).rev().flatten().copied().collect();
        let (a, b) = (ensemble(&[points]), ensemble(&[reversed]));
        let plan = all_pairs(&a);
        assert_eq!(counts(backend, &plan, &a), counts(backend, &plan, &b));
        let plan = wave_plan(&a, &[5, 5], Accuracy::High);
        let (p, q) = (power(backend, &plan, &a).mode_totals().q, power(backend, &plan, &b).mode_totals().q);
        assert!(p.iter().zip(&q).all(|(p, q)| (p - q).abs() < 1e-11));
    });
}

#[test]
fn the_sum_of_all_bins_is_all_pairs() {
    for_each_backend(|backend| {
        // In 1D every distance is at most 1/2, and 1/2 itself never occurs here.
        let line = ensemble(&[uniform(1, 100, 3), uniform(1, 57, 4)]);
        assert_eq!(counts(backend, &all_pairs(&line), &line).counts.iter().sum::<u64>(), 100 * 99 + 57 * 56);
        // A window with r beyond every distance that occurs.
        let window = pairwave::points::Domain::window(&[(0.0, 9.0), (0.0, 9.0)]).unwrap();
        let mut corner = uniform(2, 80, 5);
        corner.coordinates.iter_mut().for_each(|x| *x *= 0.5);
        let few = ensemble_in(&window, &[corner]);
        let plan = pair_plan(&few, RadialBins::linear(8.0, 9).unwrap(), Correction::Translation);
        assert_eq!(counts(backend, &plan, &few).counts.iter().sum::<u64>(), 80 * 79);
    });
}

#[test]
fn dc_is_n_and_the_mirror_image_is_the_same() {
    for_each_backend(|backend| {
        let points = ensemble(&[uniform(3, 64, 6)]);
        let plan = wave_plan(&points, &[3, 2, 4], Accuracy::High);
        let spectrum = PowerSpectrum::new(&plan, &power(backend, &plan, &points));
        assert_eq!(spectrum.dc().unwrap().0, 64.0, "P(0) = n, exactly");
        let full: Vec<f64> = spectrum.waves.grid().unwrap().full(&spectrum.p).collect();
        assert_eq!(full.len(), 7 * 5 * 9);
        assert!(full.iter().eq(full.iter().rev()), "P(-m) = P(m)");
        // The whole grid is in C order, x slowest, index m + F.
        let at = |m: [i32; 3]| full[((m[0] + 3) as usize * 5 + (m[1] + 2) as usize) * 9 + (m[2] + 4) as usize];
        for m in [[0, 0, 0], [3, -2, 4], [-1, 2, -3], [0, -1, 0], [0, 0, 4]] {
            assert_eq!(Some(at(m)), spectrum.at(m), "m = {m:?}");
        }
        // And the mirrored plane m_0 = 0, stored whole, is its own mirror image up to rounding, of which `full` shows nothing.
        assert!((spectrum.at([0, 1, -2]).unwrap() - spectrum.at([0, -1, 2]).unwrap()).abs() < 1e-12);
    });
}

#[test]
fn every_point_twice_doubles_and_quadruples() {
    for_each_backend(|backend| {
        let once = dyadic(2, 60, 8);
        let mut twice = once.clone();
        twice.coordinates.extend(once.coordinates.iter());
        let (a, b) = (ensemble(&[once]), ensemble(&[twice]));
        let plan = all_pairs(&a);
        let (a_counts, b_counts) = (counts(backend, &plan, &a).counts, counts(backend, &plan, &b).counts);
        assert_eq!(b_counts[0], 4 * a_counts[0] + 2 * 60, "each pair four times, and each point with its copy");
        assert!(a_counts[1..].iter().zip(&b_counts[1..]).all(|(a, b)| 4 * a == *b));
    });
}

#[test]
fn shards_merge_to_the_bytes_of_the_whole() {
    for_each_backend(|backend| {
        let sets: Vec<_> = (0..5 * LEAF + 3).map(|i| uniform(2, 10 + i as usize % 3, i)).collect();
        let whole = ensemble(&sets);
        let (pairs, waves) = (all_pairs(&whole), wave_plan(&whole, &[3, 3], Accuracy::Fast));
        let run = |part: &Ensemble| -> (PairCounts, WavePower) {
            let control = Control::default();
            (
                wait(backend.pair_counts(&pairs, part, &control)).unwrap(),
                wait(backend.wave_power(&waves, part, &control)).unwrap(),
            )
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
        let (mut all_counts, mut power) = run(&whole);
        assert!(power.merge(run(&whole).1).is_err(), "the same realizations twice are refused");
        let other = pair_plan(&whole, RadialBins::linear(0.5, 5).unwrap(), Correction::None);
        assert!(all_counts.merge(&counts(backend, &other, &whole)).is_err(), "other bins are refused");
    });
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
        "test, point 0: y = 3 is outside [0, 3); `wrap` folds points in, `sides` sets the sides, `window` a window"
    );
}

#[test]
fn opposite_lags_are_counted_alike_whatever_the_order() {
    for_each_backend(|backend| {
        for case in lag_cases(60) {
            let counts = lags(backend, &case.plan, &case.ensemble);
            let c = &counts.cells.sums;
            assert!(c.iter().eq(c.iter().rev()), "{}: c(k) = c(B - 1 - k)", case.name);
            // The points in reverse order.
            let domain = case.ensemble.domain();
            let sets: Vec<_> = (0..case.ensemble.realizations())
                .map(|k| (0..case.ensemble.points_in(k)).rev().flat_map(|j| case.ensemble.position(k, j)).collect())
                .map(|coordinates| raw(domain.dim(), coordinates))
                .collect();
            let there = Ensemble::from_raw(&sets, domain, true, 0).unwrap();
            let sets: Vec<_> = sets
                .into_iter()
                .map(|set| raw(set.dim, set.coordinates.chunks(set.dim).rev().flatten().copied().collect()))
                .collect();
            let back = Ensemble::from_raw(&sets, domain, true, 0).unwrap();
            assert_eq!(lags(backend, &case.plan, &there), lags(backend, &case.plan, &back), "{}", case.name);
        }
    });
}

#[test]
fn a_grid_of_all_lags_holds_all_pairs() {
    for_each_backend(|backend| {
        for dim in 1..=3 {
            let sets = [dyadic(dim, 70, 1), lattice(dim, 4), coincident(dim, 9)];
            let pairs: u128 = sets.iter().map(|s| (s.len() * (s.len() - 1)) as u128).sum();
            let torus = ensemble(&sets);
            let unequal = ensemble_in(&pairwave::points::Domain::torus(&[1.0, 0.7, 0.3][..dim]).unwrap(), &sets);
            let ranges = &[(0.0, 3.0), (1.0, 2.0), (-1.0, 1.0)][..dim];
            let window = ensemble_in(&pairwave::points::Domain::window(ranges).unwrap(), &sets);
            for ensemble in [torus, unequal, window] {
                for bins in [1, 6, 7] {
                    let plan = lag_plan(&ensemble, bins, None, Correction::None);
                    let total: u128 = lags(backend, &plan, &ensemble).cells.sums.iter().sum();
                    assert_eq!(total, pairs, "{:?}, {bins} bins", ensemble.domain());
                }
            }
        }
    });
}

#[test]
fn a_shift_of_the_torus_changes_no_lag() {
    for_each_backend(|backend| {
        for dim in 1..=3 {
            let still = dyadic(dim, 90, 1);
            let mut shifted = still.clone();
            shifted.coordinates.iter_mut().for_each(|x| *x = (*x + 0.3125) % 1.0);
            let (a, b) = (ensemble(&[still]), ensemble(&[shifted]));
            // Edges in multiples of 2^-5: many lags lie on them.
            let plan = lag_plan(&a, 32, None, Correction::None);
            assert_eq!(lags(backend, &plan, &a), lags(backend, &plan, &b), "{dim}D");
        }
    });
}

#[test]
fn sectors_are_the_cells_of_their_ring() {
    for_each_backend(|backend| {
        let ensemble = ensemble(&[uniform(2, 200, 3), clustered(2, 100, 4)]);
        for bins in [40, 41] {
            let plan = lag_plan(&ensemble, bins, None, Correction::None);
            let counts = lags(backend, &plan, &ensemble);
            let mut first = 0;
            for ring in plan.sectors.chunk_by(|a, b| a.r == b.r) {
                let whole: u128 = (0..plan.grid.cells())
                    .filter(|&c| {
                        let r = plan.grid.centre(c, 0).hypot(plan.grid.centre(c, 1));
                        (ring[0].r[0]..ring[0].r[2]).contains(&r)
                    })
                    .map(|c| counts.cells.sums[c])
                    .sum();
                let halves: u128 = counts.sectors.sums[first..first + ring.len()].iter().sum();
                assert_eq!(2 * halves, whole, "sectors hold one of each mirror pair");
                first += ring.len();
            }
            assert!(first >= 3 * 4 && first == plan.sectors.len(), "three rings");
        }
    });
}

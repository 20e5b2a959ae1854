//! What all ways of computing share, each against the coordinates as they were given: the integers that stand for them, and
//! what is read off these. A fault here is in the reference as well, so that no agreement with it would show.

use crate::common::*;
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::plan::{Accuracy, Debias, Taper, TaperPlan, WaveList, WavePlan};
use pairwave::points::{Domain, Ensemble};

/// Exact arithmetic: everything is a multiple of 2^-56 below 2^6.
fn exact(x: f64) -> i128 {
    let steps = x * 2f64.powi(56);
    assert!(steps.fract() == 0.0 && steps.abs() <= 2f64.powi(62), "{x}");
    steps as i128
}

/// Whether `steps` is the multiple of 2^-64 nearest to `offset / unit`, all but the last in exact numbers.
fn is_nearest(steps: u128, offset: i128, unit: f64) -> bool {
    2 * (steps as i128 * exact(unit) - (offset << 64)).abs() <= exact(unit)
}

fn next_down(x: f64) -> f64 {
    -(-x).next_up()
}

/// Windows whose sides are no powers of two, whose corners are no multiples of them, and whose sides f64 rounds.
fn windows() -> Vec<Vec<(f64, f64)>> {
    vec![
        vec![(0.0, 10.0)],
        vec![(0.1, 1.1)],
        vec![(-0.5, 0.5 + 2f64.powi(-53))],
        vec![(0.0, 10.0), (0.0, 10.0)],
        vec![(-3.0, 0.3), (0.1, 1.1)],
        vec![(0.0, 30.0), (1.0, 1.1)],
        vec![(0.0, 1.0), (-1.7, 2.6), (5.1, 5.7)],
    ]
}

/// Places on one axis: both sides, their neighbours among the numbers of f64, and between.
fn places((lo, hi): (f64, f64), rng: &mut Rng) -> Vec<f64> {
    // Not finer than arithmetic here is exact for.
    let step = 2f64.powi(-50);
    let mut places = vec![lo, hi, lo + step, hi - step, 0.5 * (lo + hi)];
    if lo.abs() >= 0.1 {
        places.push(lo.next_up());
    }
    if hi.abs() >= 0.1 {
        places.push(next_down(hi));
    }
    places.extend((0..40).map(|_| lo + ((hi - lo) * rng.unit() / step).floor() * step));
    places.retain(|x| (lo..=hi).contains(x));
    places
}

/// `n` points with such coordinates, each coordinate of an axis in some of them.
fn points(ranges: &[(f64, f64)], rng: &mut Rng) -> Vec<f64> {
    let axes: Vec<Vec<f64>> = ranges.iter().map(|&range| places(range, rng)).collect();
    // Corners, then everything in turn.
    let corners = (0..1 << ranges.len())
        .flat_map(|c: usize| ranges.iter().enumerate().map(move |(k, r)| if c >> k & 1 == 0 { r.0 } else { r.1 }));
    let turn = |j: usize| axes.iter().enumerate().map(move |(k, axis)| axis[(j * (3 * k + 1) + 5 * k) % axis.len()]);
    let turns: Vec<f64> = (0..60).flat_map(turn).collect();
    corners.chain(turns).collect()
}

#[test]
fn integers_of_a_window_are_the_nearest_to_its_coordinates() {
    let mut rng = Rng(11);
    for ranges in windows() {
        let window = Domain::window(&ranges).unwrap();
        let set = points(&ranges, &mut rng);
        let ensemble = Ensemble::from_raw(&[raw(ranges.len(), set.clone())], &window, false, 0).unwrap();
        for (k, &(lo, hi)) in ranges.iter().enumerate() {
            let (side, unit) = (window.sides()[k], window.length_unit());
            // From corner to corner, which f64 may not hold.
            let whole = exact(hi) - exact(lo);
            assert!(is_nearest(u128::from(window.side_steps()[k]), whole, unit), "{ranges:?}: side {k}");
            assert_eq!(window.extents()[k], u128::from(window.side_steps()[k]) + 1);
            for (j, point) in set.chunks_exact(ranges.len()).enumerate() {
                let (x, length, fraction) = (point[k], ensemble.lengths(0)[k][j], ensemble.fractions(0)[k][j]);
                let offset = exact(x) - exact(lo);
                assert!(is_nearest(u128::from(length), offset, unit), "{ranges:?}: length of {x:?}");
                let turns = ensemble.turns(0, k).nth(j).unwrap();
                // Cycles are per side as f64 has it: what is beyond it is on it.
                let offset = offset.min(exact(side));
                let whole = u128::from(fraction) + if turns == 1.0 && fraction == 0 { 1 << 64 } else { 0 };
                assert!(is_nearest(whole, offset, side), "{ranges:?}: fraction of {x:?}");
                assert_eq!(turns, whole as f64 / 2f64.powi(64), "{x:?}");
                assert_eq!(x == lo, length == 0, "{ranges:?}: only the lower side is 0, not {x:?}");
                assert!(length <= window.side_steps()[k] && (x != hi || length == window.side_steps()[k]));
            }
        }
    }
}

#[test]
fn no_two_places_of_a_window_are_one() {
    let mut rng = Rng(12);
    for ranges in windows() {
        let window = Domain::window(&ranges).unwrap();
        for (k, &range) in ranges.iter().enumerate() {
            let mut all = places(range, &mut rng);
            all.sort_unstable_by(f64::total_cmp);
            all.dedup();
            let set = all.iter().flat_map(|&x| (0..ranges.len()).map(move |a| if a == k { x } else { f64::NAN }));
            let set = set.enumerate().map(|(i, x)| if x.is_nan() { ranges[i % ranges.len()].1 } else { x });
            let ensemble = Ensemble::from_raw(&[raw(ranges.len(), set.collect())], &window, false, 0).unwrap();
            assert_eq!(ensemble.duplicates(), 0, "{ranges:?}");
            let mut lengths = ensemble.lengths(0)[k].to_vec();
            assert!(lengths.is_sorted());
            lengths.dedup();
            assert!(lengths.len() == all.len(), "{ranges:?}: {} of {}", lengths.len(), all.len());
        }
    }
}

/// A lattice with points on all sides, and what coincides in it: nothing, until something is said twice.
#[test]
fn duplicates_are_points_with_the_same_coordinates() {
    let lattice: Vec<f64> = (0..36).flat_map(|i| [10.0 * f64::from(i % 6), 10.0 * f64::from(i / 6)]).collect();
    let count = |ranges: &[(f64, f64)], set: Vec<f64>| {
        let window = Domain::window(ranges).unwrap();
        Ensemble::from_raw(&[raw(ranges.len(), set)], &window, false, 0).unwrap().duplicates()
    };
    let window = [(0.0, 50.0), (0.0, 50.0)];
    assert_eq!(count(&window, lattice.clone()), 0);
    assert_eq!(count(&window, [lattice.clone(), vec![50.0, 50.0, 0.0, 50.0]].concat()), 2);
    assert_eq!(count(&window, vec![0.0, 1.0, -0.0, 1.0]), 1, "-0 is 0");
    assert_eq!(count(&[(0.0, 1.0)], vec![0.0, 1.0, next_down(1.0), 1e-300]), 0);
    assert_eq!(count(&[(0.1, 1.1)], vec![0.1, 1.1, next_down(1.1), 0.1f64.next_up()]), 0);
    // On a torus the upper side is the lower one, and points are folded first.
    let torus = Domain::torus(&[10.0]).unwrap();
    let folded = Ensemble::from_raw(&[raw(1, vec![0.0, 10.0, -10.0, 3.0, 23.0, -7.0])], &torus, true, 0).unwrap();
    assert_eq!(folded.duplicates(), 4);
}

#[test]
fn integers_of_a_torus_are_the_nearest_to_its_coordinates() {
    let mut rng = Rng(13);
    for sides in [vec![1.0], vec![10.0, 10.0], vec![3.0, 1.3, 0.7], vec![0.1, 30.0]] {
        let torus = Domain::torus(&sides).unwrap();
        let dim = sides.len();
        let step = 2f64.powi(-50);
        let mut set: Vec<f64> =
            (0..50).flat_map(|_| sides.clone()).map(|s| (s * rng.unit() / step).floor() * step).collect();
        // Many sides away, on either side; and on a side.
        let away =
            |s: &f64| ((6.0 * rng.unit() - 3.0) / step).floor() * step * s.min(8.0).log2().exp2().floor().max(1.0);
        set.extend((0..50).flat_map(|_| sides.clone()).collect::<Vec<_>>().iter().map(away));
        set.extend(sides.iter().flat_map(|s| [*s, -s, 0.0]).cycle().take(6 * dim));
        let ensemble = Ensemble::from_raw(&[raw(dim, set.clone())], &torus, true, 0).unwrap();
        for (k, &side) in sides.iter().enumerate() {
            let unit = torus.length_unit();
            let period = if torus.periods()[k] == 0 { 1 << 64 } else { u128::from(torus.periods()[k]) };
            // As near as the quotient is in f64.
            let off = (period as i128 * exact(unit) - (exact(side) << 64)).abs();
            assert!(off >> 11 <= exact(side), "{sides:?}: period {k}");
            for (j, point) in set.chunks_exact(dim).enumerate() {
                let folded = exact(point[k]).rem_euclid(exact(side));
                let (fraction, length) = (ensemble.fractions(0)[k][j], ensemble.lengths(0)[k][j]);
                let or_one = |f: u64| if f == 0 && 2 * folded > exact(side) { 1 << 64 } else { u128::from(f) };
                assert!(is_nearest(or_one(fraction), folded, side), "{sides:?}: fraction of {:?}", point[k]);
                // Within a step, and what the period is off by, around the torus.
                let off = (i128::from(length) * exact(unit) - (folded << 64)).rem_euclid(exact(side) << 64);
                let off = off.min((exact(side) << 64) - off);
                assert!(2 * off <= 3 * exact(unit) + (exact(side) << 12), "{sides:?}: length of {:?}", point[k]);
            }
        }
    }
}

/// `|sum f(x_j) exp(-2 pi i nu . (x_j - o)) - N F|^2` with coordinates in f64, as anyone would write it.
fn plainly(ranges: &[(f64, f64)], set: &[f64], nu: &[f64], taper: &TaperPlan) -> f64 {
    let dim = ranges.len();
    let (mut re, mut im) = (0.0, 0.0);
    for point in set.chunks_exact(dim) {
        let (mut phase, mut f) = (0.0, 1.0);
        for k in 0..dim {
            phase += nu[k] * (point[k] - ranges[k].0);
            if taper.taper == Taper::Sine {
                let u = (point[k] - ranges[k].0) / (ranges[k].1 - ranges[k].0);
                f *= std::f64::consts::SQRT_2 * (std::f64::consts::PI * u).sin();
            }
        }
        let (sin, cos) = (std::f64::consts::TAU * phase).sin_cos();
        (re, im) = (re + f * cos, im - f * sin);
    }
    if taper.debias == Debias::Direct {
        let m = std::array::from_fn(|k| nu.get(k).map_or(0.0, |nu| nu * (ranges[k].1 - ranges[k].0)));
        let [a, b] = taper.transform([1; 3], m, dim).map(|f| f * (set.len() / dim) as f64);
        (re, im) = (re - a, im - b);
    }
    re * re + im * im
}

/// Points on both sides of a window, at frequencies that are no multiples of 1 / L: the upper side is not the lower one.
#[test]
fn spectra_of_points_on_the_sides_are_those_of_their_coordinates() {
    let mut rng = Rng(14);
    for ranges in windows() {
        let window = Domain::window(&ranges).unwrap();
        let dim = ranges.len();
        let set = points(&ranges, &mut rng);
        let n = (set.len() / dim) as f64;
        let ensemble = Ensemble::from_raw(&[raw(dim, set.clone())], &window, false, 0).unwrap();
        let mut frequencies = vec![vec![0.03; dim], vec![0.0; dim], vec![-1.27; dim]];
        frequencies.push((0..dim).map(|k| 0.4 / window.sides()[k]).collect());
        frequencies.push((0..dim).map(|k| (k as f64 + 2.0) / window.sides()[k]).collect());
        frequencies.extend((0..6).map(|_| (0..dim).map(|_| 3.0 * rng.unit() - 1.5).collect()));
        let vector = |nu: &Vec<f64>| std::array::from_fn(|k| nu.get(k).map_or(0.0, |nu| nu * window.sides()[k]));
        let list = WaveList { dim, vectors: frequencies.iter().map(vector).collect(), mirrored: false };
        for (taper, debias) in
            [(Taper::Bartlett, Debias::None), (Taper::Bartlett, Debias::Direct), (Taper::Sine, Debias::Direct)]
        {
            let taper = TaperPlan::new(taper, None, debias, dim).unwrap();
            let plan =
                WavePlan::new(&window, list.clone(), Accuracy::High, shape(&ensemble)).unwrap().with_taper(taper);
            let cpu = Cpu::new(Some(2)).unwrap();
            for compute in [&Reference as &dyn Compute, &cpu] {
                let found = wait(compute.wave_power(&plan, &ensemble, &Control::default())).unwrap().mode_totals().q;
                for (nu, found) in frequencies.iter().zip(found) {
                    let expected = plainly(&ranges, &set, nu, &taper);
                    let off = (found - expected).abs() / (n + expected);
                    let by = compute.computed_by().device();
                    assert!(off < 1e-12, "{by}, {ranges:?}, {taper}, nu = {nu:?}: {found}, expected {expected}");
                }
            }
        }
    }
}

/// What a fold of the upper side would do, so that the comparison above is known to see it.
#[test]
fn a_folded_side_would_be_seen() {
    let ranges = [(0.0, 10.0), (0.0, 10.0)];
    let set = points(&ranges, &mut Rng(15));
    let folded: Vec<f64> = set.iter().map(|&x| if x == 10.0 { 0.0 } else { x }).collect();
    let plain = TaperPlan::new(Taper::Bartlett, None, Debias::None, 2).unwrap();
    let at = |nu: f64| [&set, &folded].map(|set| plainly(&ranges, set, &[nu, nu], &plain));
    let [off_grid, on_grid] = [at(0.03), at(0.2)];
    assert!((off_grid[0] - off_grid[1]).abs() > 10.0, "{off_grid:?}");
    assert!((on_grid[0] - on_grid[1]).abs() < 1e-9, "{on_grid:?}");
}

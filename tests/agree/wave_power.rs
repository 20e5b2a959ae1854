//! Trusts: the reference (`reference/`) and the comparators (`reference/comparison_can_fail.rs`).
//! Proves: the native path keeps the promises of both accuracy levels,
//! with every instruction set, any number of threads and any cut of a batch (`cuts_and_threads.rs`).
//! Cannot see: what only another processor would do.

use crate::common::*;
use crate::shared::{bits, cpu, levels, many};
use pairwave::accumulate::WavePower;
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::plan::{Accuracy, WaveList, WavePlan, WaveVectors};
use pairwave::points::{Domain, Ensemble};

/// The plan by each method it could choose.
fn by_each_method(plan: &WavePlan) -> Vec<WavePlan> {
    let methods = plan.methods(plan.shape.mean_points).into_iter().map(|estimate| Some(estimate.method));
    methods.map(|method| WavePlan { method, ..plan.clone() }).collect()
}

/// Runs every method at both accuracies on every instruction set; `check` gets a name, the plan and what came out.
fn every_way(
    name: &str,
    ensemble: &Ensemble,
    plan: impl Fn(Accuracy) -> WavePlan,
    mut check: impl FnMut(&str, &WavePlan, &WavePower),
) {
    for accuracy in [Accuracy::Fast, Accuracy::High] {
        for plan in by_each_method(&plan(accuracy)) {
            for cpu in levels() {
                let power = wait(cpu.wave_power(&plan, ensemble, &Control::default())).unwrap();
                let method = plan.method.unwrap().name();
                check(&format!("{name}, {}, {method}, {}", accuracy.name(), cpu.level().name()), &plan, &power);
            }
        }
    }
}

fn powers_are_within(name: &str, ensemble: &Ensemble, max_frequency: &[u32]) {
    let truth = reference_power(&wave_plan(ensemble, max_frequency, Accuracy::High), ensemble);
    every_way(
        name,
        ensemble,
        |accuracy| wave_plan(ensemble, max_frequency, accuracy),
        |name, plan, power| {
            assert_power_within(name, plan.accuracy, power, &truth);
        },
    );
}

#[test]
fn powers_are_within_the_promise() {
    for f in [0, 1, 2, 3, 5, 9, 100, 1000] {
        powers_are_within(&format!("1D, F = {f}"), &ensemble(&[uniform(1, 300, f)]), &[f as u32]);
    }
    for f in [[0, 0], [0, 3], [3, 0], [1, 1], [7, 9], [64, 64], [33, 5]] {
        powers_are_within(&format!("2D, F = {f:?}"), &ensemble(&[uniform(2, 300, 1), clustered(2, 150, 2)]), &f);
    }
    for f in [[0, 0, 0], [2, 3, 4], [0, 1, 5], [8, 8, 8]] {
        powers_are_within(&format!("3D, F = {f:?}"), &ensemble(&[uniform(3, 300, 1), lattice(3, 5)]), &f);
    }
    // Few points after many, which leave their tables behind.
    let sizes = [300, 2, 129, 1, 128, 0, 127].map(|n| uniform(2, n, n as u64));
    powers_are_within("n = 300, 2, ...", &ensemble(&sizes), &[10, 10]);
    powers_are_within("coincident", &ensemble(&[coincident(2, 1000)]), &[20, 20]);
    let window = Domain::window(&[(-1.0, 2.0), (0.0, 1.0)]).unwrap();
    powers_are_within("window", &ensemble_in(&window, &[uniform(2, 300, 1)]), &[20, 20]);
    let torus = Domain::torus(&[3.0, 1.0]).unwrap();
    powers_are_within("unequal torus", &ensemble_in(&torus, &[uniform(2, 300, 1)]), &[30, 10]);
}

/// The farthest frequencies of the promise: a tile of rows at a time.
#[test]
fn powers_are_within_the_promise_far_out() {
    powers_are_within("strip 65536 x 2", &ensemble(&[uniform(2, 60, 1)]), &[65_536, 2]);
    powers_are_within("strip 2 x 65536", &ensemble(&[uniform(2, 60, 2)]), &[2, 65_536]);
    powers_are_within("line 65536", &ensemble(&[uniform(1, 200, 3)]), &[65_536]);
    // 0.1 is no multiple of 2^-32, and all errors add up.
    powers_are_within("coincident, far out", &ensemble(&[raw(2, vec![0.1; 400])]), &[65_536, 2]);
}

#[test]
fn powers_of_many_uniform_points_are_within_the_promise() {
    for (n, f) in [(4096, 20), (65_536, 12), (1_000_000, 3)] {
        let ensemble = ensemble(&[uniform(2, n, 4)]);
        let f = [f, f];
        let truth = reference_power(&wave_plan(&ensemble, &f, Accuracy::High), &ensemble);
        let plan = |accuracy| wave_plan(&ensemble, &f, accuracy);
        every_way(&format!("n = {n}"), &ensemble, plan, |name, plan, power| {
            let bound = plan.accuracy.power_bound();
            let error = assert_power_within(name, plan.accuracy, power, &truth);
            println!("    clearance of the rms: {:.1}", bound.rms_uniform / error.rms);
            assert!(error.rms <= bound.rms_uniform && error.max <= bound.max_uniform, "{name}: {error:?}");
        });
    }
}

/// Gaussian jitter of 1e-3 of a cell: what is left of P at low frequencies is 1e-11 of what points have by themselves.
#[test]
fn powers_of_a_jittered_lattice_keep_the_promise() {
    let (side, mut rng) = (256, Rng(5));
    let mut normal = || (-2.0 * (1.0 - rng.unit()).ln()).sqrt() * (std::f64::consts::TAU * rng.unit()).cos();
    let at = |i: usize, z: f64| ((i as f64 + 0.5 + 1e-3 * z) / side as f64).rem_euclid(1.0);
    let coordinates = (0..side * side).flat_map(|k| [at(k / side, normal()), at(k % side, normal())]).collect();
    let ensemble = ensemble(&[raw(2, coordinates)]);
    let f = [20, 20];
    let truth = reference_power(&wave_plan(&ensemble, &f, Accuracy::High), &ensemble).mode_totals().q;
    let plan = |accuracy| wave_plan(&ensemble, &f, accuracy);
    let dc = plan(Accuracy::High).waves.dc().unwrap();
    assert!(truth.iter().all(|&q| q > 0.0) && truth.iter().any(|&q| q / 65_536.0 < 1e-9));
    every_way("jittered lattice", &ensemble, plan, |name, plan, power| {
        let q = power.mode_totals().q;
        let mut errors: Vec<f64> = (0..q.len()).filter(|&m| m != dc).map(|m| (q[m] / truth[m] - 1.0).abs()).collect();
        assert!(errors.iter().all(|e| e.is_finite()), "{name}");
        errors.sort_by(f64::total_cmp);
        let (median, bound) = (errors[errors.len() / 2], plan.accuracy.power_bound().jittered_median);
        println!("{name}: median {median:.1e} (clearance {:.1})", bound / median);
        assert!(median <= bound, "{name}: {median:e}");
    });
}

/// Weights of either sign, of very different size, and of sum 0.
#[test]
fn weighted_powers_are_within_the_promise() {
    let mut rng = Rng(9);
    let weights: [fn(usize, f64) -> f64; 5] = [
        |_, u| u,
        |_, u| 2.0 * u - 1.0,
        |j, u| if j.is_multiple_of(2) { 1e30 * u } else { -1e-30 },
        |j, _| [1.0, -1.0][j % 2],
        |_, u| 1e-30 * (u - 0.5),
    ];
    for (k, weight) in weights.into_iter().enumerate() {
        for (dim, f) in [(1, vec![37]), (2, vec![9, 7]), (3, vec![3, 4, 5])] {
            let points = ensemble(&[uniform(dim, 300, 1), clustered(dim, 170, 2)]);
            let weights: Vec<f64> = (0..points.total_points()).map(|j| weight(j, rng.unit())).collect();
            let points = points.with_weights(&weights);
            powers_are_within(&format!("weights {k}, {dim}D"), &points, &f);
            // DC is the square of the sum of weights, whatever the method.
            let truth = reference_power(&wave_plan(&points, &f, Accuracy::High), &points);
            let plan = |accuracy| wave_plan(&points, &f, accuracy);
            every_way("DC", &points, plan, |name, plan, power| {
                let dc = plan.waves.dc().unwrap();
                assert_eq!(power.mode_totals().q[dc], truth.mode_totals().q[dc], "weights {k}, {name}");
            });
        }
    }
}

/// Integers up to the largest 32-bit ones, and frequencies between them.
#[test]
fn lists_are_within_the_promise() {
    let mut rng = Rng(3);
    for dim in 1..=3 {
        let mut vectors = vec![[0.0; 3]];
        for k in 0..200 {
            let component = |bits: u64, unit: f64| match k % 3 {
                0 => bits as i32 as f64,
                1 => 40.0 * unit - 20.0,
                _ => [2_147_483_647.0, -2_147_483_647.0, 1.0, 0.0, 1e5][bits as usize % 5],
            };
            let mut m = [0.0; 3];
            m[..dim].fill_with(|| component(rng.bits(), rng.unit()));
            vectors.push(m);
        }
        // Coordinates that are multiples of 2^-64, as finer ones are not: at |m| = 2^31 that would show (docs/limits.md).
        let mut clumps = clustered(dim, 170, 2);
        clumps.coordinates.iter_mut().for_each(|x| *x = (*x * 2f64.powi(53)).floor() / 2f64.powi(53));
        let points = ensemble(&[uniform(dim, 3001, 1), clumps, uniform(dim, 1, 3)]);
        let weights: Vec<f64> = (0..points.total_points()).map(|_| rng.unit() - 0.3).collect();
        for points in [points.clone(), points.with_weights(&weights)] {
            let plan = |accuracy| {
                let list = WaveList { dim, vectors: vectors.clone(), mirrored: false };
                WavePlan::new(points.domain(), list, accuracy, shape(&points)).unwrap()
            };
            let truth = reference_power(&plan(Accuracy::High), &points);
            let mut last = None;
            every_way(&format!("list, {dim}D"), &points, plan, |name, _, power| {
                // Lists are summed in f64 at either accuracy.
                assert_power_within(name, Accuracy::High, power, &truth);
                assert_eq!(power.mode_totals().q[0], truth.mode_totals().q[0], "{name}: DC");
                last = Some(power.clone());
            });
            // A vector off by one cycle is seen.
            let mut wrong = plan(Accuracy::High);
            let WaveVectors::List(list) = &mut wrong.waves else { panic!("a list") };
            list.vectors[4][0] += 1.0;
            let error = power_error(&last.unwrap(), &reference_power(&wrong, &points)).unwrap();
            assert!(error.max > 1e-3, "{error:?}");
        }
    }
}

/// Lists and weights too.
#[test]
fn threads_do_not_change_a_bit_of_any_method() {
    let points = many(2, 5, 700);
    let weights: Vec<f64> = (0..points.total_points()).map(|j| (j as f64).sin()).collect();
    let points = points.with_weights(&weights);
    let vectors = (0..300).map(|k| [f64::from(k) * 0.7, 3.0, 0.0]).collect();
    let list =
        WavePlan::new(points.domain(), WaveList { dim: 2, vectors, mirrored: false }, Accuracy::High, shape(&points));
    let mut plans = by_each_method(&list.unwrap());
    plans.extend(by_each_method(&wave_plan(&points, &[70, 40], Accuracy::Fast)));
    for plan in plans {
        let run = |threads: usize| bits(&wait(cpu(threads).wave_power(&plan, &points, &Control::default())).unwrap());
        let one = run(1);
        for threads in [2, 5] {
            assert!(run(threads) == one, "{:?} with {threads} threads", plan.method);
        }
    }
}

/// With only rings wanted, these are the same to the bit, and no other mode is there.
#[test]
fn rings_alone_are_the_rings_of_the_grid() {
    let cube = |dim| Domain::unit_torus(dim);
    let long = Domain::torus(&[3.0, 1.0]).unwrap();
    for (domain, f) in
        [(cube(1), vec![50]), (cube(2), vec![90, 90]), (long, vec![150, 50]), (cube(3), vec![12, 12, 14])]
    {
        let points = ensemble_in(&domain, &[uniform(domain.dim(), 500, 1), uniform(domain.dim(), 41, 2)]);
        for plan in by_each_method(&wave_plan(&points, &f, Accuracy::Fast)) {
            let alone = WavePlan { rings_only: true, ..plan.clone() };
            let mut kept = Vec::new();
            for threads in [1, 2] {
                let [all, alone] =
                    [&plan, &alone].map(|p| wait(cpu(threads).wave_power(p, &points, &Control::default())).unwrap());
                assert_eq!(all.ring_totals(), alone.ring_totals(), "{f:?}, {:?}", plan.method);
                let dc = plan.waves.dc().unwrap();
                for (at, q) in alone.mode_totals().q.into_iter().enumerate() {
                    let wanted = plan.rings.ring_of[at] > 0 || at == dc;
                    assert_eq!(q, if wanted { all.mode_totals().q[at] } else { 0.0 }, "{f:?}, mode {at}");
                }
                kept.push(bits(&alone));
            }
            assert!(kept[0] == kept[1]);
        }
    }
}

/// Points that repeat coordinates: the worst there is for sums in f32, and what the bound for any input is about.
#[test]
fn powers_of_repeated_coordinates_keep_the_bound_for_any_points() {
    for n in [300, 4096, 65_536, 400_000] {
        powers_are_within(&format!("three places, n = {n}"), &ensemble(&[three_places(n)]), &[3]);
    }
}

/// Sizes that share divisors with the panels' length, or do not.
#[test]
fn the_zeros_of_a_lattice_stay_zero() {
    for (n, z) in [(65_536usize, 19_463usize), (65_536, 12_345), (46_368, 28_657), (40_000, 15_277), (4096, 1557)] {
        zeros_stay_zero(n, z);
    }
}

fn zeros_stay_zero(n: usize, z: usize) {
    let ensemble = ensemble(&[rank1(n, z)]);
    let plan = |accuracy| wave_plan(&ensemble, &[64, 64], accuracy);
    every_way(&format!("n = {n}"), &ensemble, plan, |name, plan, power| {
        let mut worst = 0.0;
        for (index, q) in power.mode_totals().q.iter().enumerate() {
            let m = plan.waves.grid().unwrap().mode(index);
            let on_dual = (i64::from(m[0]) + i64::from(m[1]) * z as i64).rem_euclid(n as i64) == 0;
            let p = q / n as f64;
            assert!(p.is_finite());
            if on_dual {
                assert!((p / n as f64 - 1.0).abs() < 1e-5, "P = {p} at {m:?}, a point of the dual lattice");
            } else {
                worst = f64::max(worst, p);
            }
        }
        let bound = plan.accuracy.power_bound().lattice_zero;
        println!("{name}: largest P at a zero {worst:.1e} (clearance {:.1})", bound / worst);
        assert!(worst <= bound, "{name}: {worst:e}");
    });
}

//! Trusts: the reference (`reference_is_right.rs`) and the comparators (`comparison_can_fail.rs`).
//! Proves: the native path counts the same pairs, integer for integer, and keeps the promises of both accuracy levels,
//! with every instruction set, any number of threads and any cut of a batch.
//! Cannot see: what only another processor would do.

mod common;

use common::*;
use pairwave::Error;
use pairwave::accumulate::WavePower;
use pairwave::compute::Compute;
use pairwave::compute::cpu::{Cpu, SimdLevel};
use pairwave::control::Control;
use pairwave::plan::LEAF;
use pairwave::plan::{
    Accuracy, Correction, CovariancePlan, PairPlan, PairSearch, PairSettings, RadialBins, SearchCosts, WaveList,
    WavePlan, WaveVectors,
};
use pairwave::points::{Domain, Ensemble};

/// The native path with each instruction set this processor has.
fn levels() -> Vec<Cpu> {
    let all = [SimdLevel::Portable, SimdLevel::Avx2, SimdLevel::Avx512];
    let here = SimdLevel::detect();
    println!("instruction sets up to {} are tested", here.name());
    all.into_iter().filter(|&l| l <= here).map(|l| Cpu::with_level(Some(2), l).unwrap()).collect()
}

fn cpu(threads: usize) -> Cpu {
    Cpu::new(Some(threads)).unwrap()
}

fn counts_are_equal(name: &str, plan: &PairPlan, ensemble: &Ensemble) {
    let truth = reference_counts(plan, ensemble);
    for cpu in levels() {
        let counts = wait(cpu.pair_counts(plan, ensemble, &Control::default())).unwrap();
        assert_counts_equal(&format!("{name}, {}", cpu.level().name()), &counts, &truth);
    }
}

#[test]
fn counts_equal_the_reference() {
    for case in pair_cases(700) {
        counts_are_equal(&case.name, &case.plan, &case.ensemble);
    }
}

/// Every search a plan can choose from, and finer cells than it would.
fn forced_searches(plan: &PairPlan) -> Vec<PairPlan> {
    let finer = SearchCosts { cells_per_point: 4.0, max_reach: 4, ..SearchCosts::CPU };
    let searches = [SearchCosts::CPU, finer].into_iter().flat_map(|costs| plan.searches(&costs)).map(|s| s.search);
    searches.map(|search| PairPlan { search, ..plan.clone() }).collect()
}

/// All searches of all cases, and short ranges of them, where there are many cells.
#[test]
fn every_search_finds_the_same_pairs() {
    let mut cells = 0;
    for case in pair_cases(400) {
        let domain = case.ensemble.domain();
        let mut plans = vec![case.plan.clone()];
        for (part, bins) in [(0.25, 5), (0.1, 10), (0.02, 3)] {
            let bins = RadialBins::linear(part * domain.shortest_side(), bins).unwrap();
            plans.push(pair_plan(&case.ensemble, bins, Correction::None));
            if !domain.is_torus() {
                let bins = RadialBins::logarithmic(0.01 * part, part * domain.shortest_side(), 5).unwrap();
                plans.push(pair_plan(&case.ensemble, bins, Correction::Translation));
            }
        }
        for plan in plans {
            let truth = reference_counts(&plan, &case.ensemble);
            for forced in forced_searches(&plan) {
                cells += usize::from(forced.search != PairSearch::All);
                let counts = wait(cpu(2).pair_counts(&forced, &case.ensemble, &Control::default())).unwrap();
                let name = format!("{}, r < {}, {}", case.name, plan.bins.r_max(), forced.search);
                assert_counts_equal(&name, &counts, &truth);
            }
        }
    }
    assert!(cells > 500, "only {cells} cases with cells");
}

/// Lattices whose points lie on the sides of cells and whose distances lie on edges, with `r_max` at what just fits the
/// cells and one step to either side of it.
#[test]
fn cells_are_exact_at_their_limits() {
    for dim in 1..=3 {
        let k = [60, 20, 9][dim - 1];
        for domain in [Domain::unit_torus(dim), Domain::window(&vec![(0.0, 1.0); dim]).unwrap()] {
            let ensemble = ensemble_in(&domain, &[lattice(dim, k)]);
            for cells in [3.0, 5.0, 9.0, k as f64 / 2.0] {
                for step in [-1i64, 0, 1] {
                    let r = f64::from_bits((1f64 / cells).to_bits().wrapping_add_signed(step));
                    let plan = pair_plan(&ensemble, RadialBins::linear(r, 4).unwrap(), Correction::None);
                    let truth = reference_counts(&plan, &ensemble);
                    for forced in forced_searches(&plan) {
                        let counts = wait(cpu(1).pair_counts(&forced, &ensemble, &Control::default())).unwrap();
                        assert_counts_equal(&format!("{dim}D, r_max {r:e}, {}", forced.search), &counts, &truth);
                    }
                }
            }
        }
    }
}

/// Two clusters a billionth apart and far from each other, and points at both ends of the torus: nearly all in one cell.
#[test]
fn hostile_sets_are_exact_in_every_search() {
    for dim in 1..=3 {
        let mut rng = Rng(8);
        let ends = [0.0, 1.0 - 2f64.powi(-53), 0.5, 1e-300];
        let mut coordinates: Vec<f64> = (0..100 * dim).map(|_| 0.25 + 1e-9 * rng.unit()).collect();
        coordinates.extend((0..100 * dim).map(|_| 0.250_000_001 + 1e-9 * rng.unit()));
        coordinates.extend((0..100 * dim).map(|_| ends[(rng.bits() % 4) as usize]));
        let ensemble = ensemble(&[raw(dim, coordinates)]);
        for (r, bins) in [(0.5, 1), (0.1, 1), (0.1, 100_000), (0.03, 64), (4e-9, 100), (1e-9, 7)] {
            let plan = pair_plan(&ensemble, RadialBins::linear(r, bins).unwrap(), Correction::None);
            let truth = reference_counts(&plan, &ensemble);
            for forced in forced_searches(&plan) {
                for cpu in levels() {
                    let counts = wait(cpu.pair_counts(&forced, &ensemble, &Control::default())).unwrap();
                    assert_counts_equal(&format!("{dim}D, {bins} bins to {r}, {}", forced.search), &counts, &truth);
                }
            }
        }
    }
}

/// Ordered pairs per point of the integer lattice with `from <= |distance|^2 < to`.
fn lattice_shell(dim: usize, from: f64, to: f64) -> u64 {
    let k = to.sqrt().ceil() as i64;
    let range = |used: bool| if used { -k..=k } else { 0..=0 };
    let squares = range(true).flat_map(|a| range(dim > 1).map(move |b| a * a + b * b));
    let squares = squares.flat_map(|ab| range(dim > 2).map(move |c| (ab + c * c) as f64));
    squares.filter(|&r2| r2 > 0.0 && from <= r2 && r2 < to).count() as u64
}

/// A million points whose counts are known, looked for in cells: a dyadic lattice with its distances on the edges, and one
/// whose coordinates are rounded, with edges between its distances.
#[test]
fn counts_of_large_lattices_are_those_of_the_integers() {
    for (dim, k, reach, half) in [(2, 1024, 8, false), (3, 64, 4, false), (1, 1 << 17, 64, false), (2, 1000, 8, true)] {
        let (side, shift) = (k as f64, if half { 0.5 } else { 0.0 });
        let edge = |e: usize| e as f64 + if e == 0 { 0.0 } else { shift };
        let ensemble = ensemble(&[lattice(dim, k)]);
        let bins = RadialBins::from_edges((0..=reach).map(|e| edge(e) / side).collect()).unwrap();
        let plan = pair_plan(&ensemble, bins, Correction::None);
        assert_ne!(plan.search, PairSearch::All);
        let n = (k as u64).pow(dim as u32);
        let truth: Vec<u64> =
            (0..reach).map(|b| n * lattice_shell(dim, edge(b).powi(2), edge(b + 1).powi(2))).collect();
        let counts = wait(cpu(2).pair_counts(&plan, &ensemble, &Control::default())).unwrap();
        assert_eq!(counts.counts, truth, "{dim}D, {k} a side");
    }
}

/// More points than a piece of columns or a block of rows, and sizes around their multiples.
#[test]
fn counts_are_equal_around_block_sizes() {
    for n in [15, 16, 17, 63, 64, 65, 127, 1023, 1024, 1025, 1100, 2049] {
        let ensemble = ensemble(&[uniform(2, n, n as u64)]);
        let bins = RadialBins::linear(0.5, 8).unwrap();
        counts_are_equal(&format!("n = {n}"), &pair_plan(&ensemble, bins, Correction::None), &ensemble);
    }
}

/// Every correction, with and without weights of points, in windows whose points touch sides and corners.
#[test]
fn corrected_sums_equal_the_reference() {
    for dim in 1..=3 {
        let ranges = &[(-1.0, 2.0), (0.5, 1.75), (10.0, 12.2)][..dim];
        let window = Domain::window(ranges).unwrap();
        // The lattice has points on both ends of the closed window's sides.
        let closed = raw(dim, lattice(dim, 7).coordinates.iter().map(|x| x * 7.0 / 6.0).collect());
        let sets = [uniform(dim, 300, 1), clustered(dim, 200, 2), closed, uniform(dim, 1, 3), uniform(dim, 0, 4)];
        let ensemble = ensemble_in(&window, &sets);
        let mut rng = Rng(9);
        let weights: Vec<f64> =
            (0..ensemble.total_points()).map(|j| 3.7 * rng.unit() * f64::from(j as u32 % 3)).collect();
        let ensemble = ensemble.with_weights(&weights);
        for correction in [Correction::None, Correction::Translation, Correction::Isotropic, Correction::Border] {
            if dim == 3 && correction == Correction::Isotropic {
                continue;
            }
            let r = match correction {
                Correction::Isotropic => window.half_diagonal(),
                Correction::Border => 0.49 * window.shortest_side(),
                _ => 0.9 * window.shortest_side(),
            };
            for (name, bins) in [
                ("linear", RadialBins::linear(r, 70).unwrap()),
                ("log", RadialBins::logarithmic(1e-3 * r, r, 30).unwrap()),
                ("given", RadialBins::from_edges(vec![0.1 * r, 0.2 * r, 0.200_000_001 * r, r]).unwrap()),
                ("tiny", RadialBins::linear(1e-9, 100).unwrap()),
            ] {
                for masses in [false, true] {
                    if masses && correction == Correction::Border {
                        continue;
                    }
                    let settings = PairSettings { cumulative: true, masses, ..correction.into() };
                    let plan = PairPlan::new(&window, bins.clone(), settings, shape(&ensemble)).unwrap();
                    let name = format!("window, {correction}, {name}, {dim}D, weights of points: {masses}");
                    counts_are_equal(&name, &plan, &ensemble);
                }
            }
        }
    }
}

/// Large realizations are shared between threads, part by part.
#[test]
fn corrected_sums_of_large_realizations_equal_the_reference() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let ensemble = ensemble_in(&window, &[uniform(2, 1100, 1)]);
    let weights: Vec<f64> = (0..1100).map(f64::from).collect();
    let ensemble = ensemble.with_weights(&weights);
    for (correction, masses) in
        [(Correction::Border, false), (Correction::Isotropic, true), (Correction::Translation, true)]
    {
        let settings = PairSettings { cumulative: true, masses, ..correction.into() };
        let bins = RadialBins::linear(0.4, 40).unwrap();
        let plan = PairPlan::new(&window, bins, settings, shape(&ensemble)).unwrap();
        counts_are_equal(&format!("{correction}, n = 1100"), &plan, &ensemble);
    }
    let torus = ensemble_in(&Domain::torus(&[2.0, 1.0]).unwrap(), &[uniform(2, 600, 1)]);
    let weighted = torus.with_weights(&weights[..600]);
    let settings = PairSettings { masses: true, beyond_half: true, ..Correction::None.into() };
    let bins = RadialBins::linear(1.25f64.sqrt(), 90).unwrap();
    let plan = PairPlan::new(weighted.domain(), bins, settings, shape(&weighted)).unwrap();
    counts_are_equal("weighted torus, to half the diagonal", &plan, &weighted);
}

/// Bins narrower than a step of 2^-32, or so many that f32 decides next to nothing.
#[test]
fn hopeless_bins_are_still_exact() {
    let tight = |scale: f64| {
        let mut rng = Rng(5);
        raw(2, (0..300).map(|_| 0.5 + scale * (rng.unit() - 0.5)).collect())
    };
    for (scale, r_max, bins) in
        [(1e-8, 1e-8, 1000), (1e-9, 1e-9, 3), (1e-15, 1e-15, 50), (1e-6, 1e-6, 4000), (0.5, 1e-300, 2), (0.5, 1e-42, 9)]
    {
        let sets = ensemble(&[tight(scale), uniform(2, 200, 6), coincident(2, 40)]);
        let plan = pair_plan(&sets, RadialBins::linear(r_max, bins).unwrap(), Correction::None);
        counts_are_equal(&format!("{bins} bins to {r_max:e}"), &plan, &sets);
    }
    for dim in 1..=3 {
        let sets = ensemble(&[uniform(dim, 40, 7), lattice(dim, 3)]);
        let plan = pair_plan(&sets, RadialBins::linear(0.5, 1 << 20).unwrap(), Correction::None);
        counts_are_equal(&format!("2^20 bins, {dim}D"), &plan, &sets);
        let plan = pair_plan(&sets, RadialBins::logarithmic(1e-6, 0.5, 100_000).unwrap(), Correction::None);
        counts_are_equal(&format!("100,000 logarithmic bins, {dim}D"), &plan, &sets);
    }
}

/// Sides so unequal that a period of 2^32 steps is rounded coarsely, and distances that exactly touch edges there.
#[test]
fn counts_are_equal_on_unequal_tori() {
    for sides in [&[1.0, 1.0 / 3.0][..], &[1e-3, 1.0], &[1.0, 1.0 - 1e-12], &[7.0, 5.0, 3.0], &[1.0, 1e-5]] {
        let torus = Domain::torus(sides).unwrap();
        let r = torus.shortest_side() / 2.0;
        let dim = sides.len();
        let sets = ensemble_in(&torus, &[uniform(dim, 120, 1), lattice(dim, 5), clustered(dim, 80, 2)]);
        for bins in [
            RadialBins::linear(r, 12).unwrap(),
            RadialBins::linear(r, 30_000).unwrap(),
            RadialBins::logarithmic(r * 1e-3, r, 50).unwrap(),
        ] {
            counts_are_equal(&format!("sides {sides:?}"), &pair_plan(&sets, bins, Correction::None), &sets);
        }
    }
}

#[test]
fn counters_pass_2_to_the_32() {
    let n = 100_000;
    let points = raw(2, vec![0.3; 2 * n]);
    let ensemble = ensemble(&[points]);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 4).unwrap(), Correction::None);
    let counts = wait(cpu(2).pair_counts(&plan, &ensemble, &Control::default())).unwrap();
    let n = n as u64;
    assert_eq!(counts.counts, vec![n * (n - 1), 0, 0, 0]);
}

fn many(dim: usize, realizations: usize, n: usize) -> Ensemble {
    let sets: Vec<_> = (0..realizations).map(|k| uniform(dim, n + k % 5, 100 + k as u64)).collect();
    ensemble(&sets)
}

#[test]
fn threads_do_not_change_a_bit() {
    for (realizations, n) in [(1, 1500), (3, 1100), (70, 60)] {
        let ensemble = many(2, realizations, n);
        let pairs = pair_plan(&ensemble, RadialBins::linear(0.3, 50).unwrap(), Correction::None);
        let waves: Vec<_> =
            [Accuracy::Fast, Accuracy::High].map(|a| wave_plan(&ensemble, &[70, 40], a)).into_iter().collect();
        let run = |threads: usize| {
            let cpu = cpu(threads);
            let control = Control::default();
            let counts = wait(cpu.pair_counts(&pairs, &ensemble, &control)).unwrap();
            let powers: Vec<_> =
                waves.iter().map(|w| bits(&wait(cpu.wave_power(w, &ensemble, &control)).unwrap())).collect();
            ((counts.counts, counts.bins, counts.realizations), powers)
        };
        let one = run(1);
        for threads in [2, 5] {
            assert!(run(threads) == one, "{realizations} x {n} with {threads} threads");
        }
    }
}

/// All sums of a spectrum, bit for bit.
fn bits(power: &WavePower) -> Vec<u64> {
    let (modes, rings) = (power.mode_totals(), power.ring_totals());
    [modes.q, modes.q_squared, modes.q_n, rings.q, rings.q_squared, rings.q_n]
        .iter()
        .flatten()
        .map(|x| x.to_bits())
        .chain(power.norm_totals().map(f64::to_bits))
        .chain([power.realizations])
        .collect()
}

#[test]
fn cuts_of_a_batch_do_not_change_a_bit() {
    let leaf = LEAF as usize;
    let ensemble = many(3, 5 * leaf + 3, 50);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.3, 50).unwrap(), Correction::None);
    let waves = wave_plan(&ensemble, &[5, 4, 3], Accuracy::Fast);
    let (cpu, control) = (cpu(2), Control::default());
    let whole = (
        wait(cpu.pair_counts(&pairs, &ensemble, &control)).unwrap(),
        bits(&wait(cpu.wave_power(&waves, &ensemble, &control)).unwrap()),
    );
    for cut in [leaf, 3 * leaf, 5 * leaf] {
        let parts = [ensemble.slice(0..cut), ensemble.slice(cut..ensemble.realizations())];
        let [mut counts, other] = parts.each_ref().map(|e| wait(cpu.pair_counts(&pairs, e, &control)).unwrap());
        counts.merge(&other).unwrap();
        assert!(counts == whole.0, "counts cut at {cut}");
        let [mut power, other] = parts.each_ref().map(|e| wait(cpu.wave_power(&waves, e, &control)).unwrap());
        power.merge(other).unwrap();
        assert!(bits(&power) == whole.1, "powers cut at {cut}");
    }
}

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
    let sizes = [0, 1, 2, 127, 128, 129, 300].map(|n| uniform(2, n, n as u64));
    powers_are_within("n = 0, 1, 2, ...", &ensemble(&sizes), &[10, 10]);
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
        let points = ensemble(&[uniform(dim, 3001, 1), clustered(dim, 170, 2), uniform(dim, 1, 3)]);
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

#[test]
fn cancelling_is_an_error_and_bad_threads_are_refused() {
    let ensemble = ensemble(&[uniform(2, 100, 1)]);
    let control = Control::default();
    control.cancel();
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 4).unwrap(), Correction::None);
    assert!(matches!(wait(cpu(2).pair_counts(&pairs, &ensemble, &control)), Err(Error::Cancelled)));
    let waves = wave_plan(&ensemble, &[4, 4], Accuracy::Fast);
    assert!(matches!(wait(cpu(2).wave_power(&waves, &ensemble, &control)), Err(Error::Cancelled)));
    for threads in [0, 1_000_000] {
        let error = Cpu::new(Some(threads)).unwrap_err();
        assert!(error.to_string().starts_with(&format!("threads {threads}: ")), "{error}");
    }
    assert!(cpu(2).computed_by().device().contains("2 threads"));
}

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

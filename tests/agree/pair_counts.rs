//! Trusts: the reference (`reference/`) and the comparators (`reference/comparison_can_fail.rs`).
//! Proves: the native path counts the same pairs, integer for integer,
//! with every instruction set, any number of threads and any cut of a batch (`cuts_and_threads.rs`).
//! Cannot see: what only another processor would do.

use crate::common::*;
use crate::shared::{cpu, levels};
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::plan::{Correction, PairPlan, PairSearch, PairSettings, RadialBins, SearchCosts};
use pairwave::points::{Domain, Ensemble};

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
                // Weights up to 2^29.
                Correction::Isotropic => window.half_diagonal() * (1.0 - 1e-8),
                Correction::Border => 0.49 * window.shortest_side(),
                _ => 0.9 * window.shortest_side(),
            };
            for (name, bins) in [
                ("linear", RadialBins::linear(r, 70).unwrap()),
                ("log", RadialBins::logarithmic(1e-3 * r, r, 30).unwrap()),
                ("given", RadialBins::from_edges(vec![0.1 * r, 0.2 * r, 0.200_000_001 * r, r]).unwrap()),
                (
                    "further out",
                    RadialBins::from_edges((0..=50).map(|k| r * (0.5 + 0.01 * f64::from(k))).collect()).unwrap(),
                ),
                ("tiny", RadialBins::linear(1e-9, 100).unwrap()),
            ] {
                for masses in [false, true] {
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
    for (correction, masses) in [
        (Correction::Border, false),
        (Correction::Border, true),
        (Correction::Isotropic, true),
        (Correction::Translation, true),
    ] {
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

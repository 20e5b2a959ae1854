//! Trusts the reference and the comparators (`reference/`). Proves that the GPU counts the same integers, whatever the input and
//! however the work is cut. Cannot see: speed, and other drivers than the one here.

use crate::common::*;
use crate::shared::{go, open, shared};
use pairwave::compute::cpu::Cpu;
use pairwave::compute::gpu::{Fill, GpuCompute, pair_kernel};
use pairwave::compute::{Compute, Work};
use pairwave::plan::{
    CellGrid, Correction, EnsembleShape, PairPlan, PairSearch, PairSettings, RadialBins, SearchCosts,
};
use pairwave::points::{Domain, RawPoints};

#[test]
fn counts_are_equal() {
    let Some(gpu) = shared("counts") else { return };
    for case in pair_cases(500) {
        let here = wait(gpu.pair_counts(&case.plan, &case.ensemble, &go())).unwrap();
        assert_counts_equal(&case.name, &here, &reference_counts(&case.plan, &case.ensemble));
    }
}

/// Counts and minus sampling are equal, sums of weights within their bound.
fn agree_with_the_reference(gpu: &GpuCompute, case: &PairCase) -> f64 {
    let here = wait(gpu.pair_counts(&case.plan, &case.ensemble, &go())).unwrap();
    let truth = reference_counts(&case.plan, &case.ensemble);
    if case.plan.weighted() {
        return assert_weights_within(&case.name, &here, &truth);
    }
    assert_counts_equal(&case.name, &here, &truth);
    0.0
}

#[test]
fn corrected_sums_agree() {
    let Some(gpu) = shared("corrections") else { return };
    let mut worst = 0f64;
    for case in corrected_cases(300) {
        assert_eq!(gpu.supports(Work::Pairs(&case.plan)), Ok(()), "{}", case.name);
        worst = worst.max(agree_with_the_reference(gpu, &case));
    }
    println!("worst of all: {worst:.1e}");
    assert!(worst > 0.0, "f32 weights that equal f64 ones compare nothing");
}

#[test]
fn corrected_sums_are_the_same_bytes_however_the_work_is_cut() {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 2.0)]).unwrap();
    let ensemble = ensemble_in(&window, &[uniform(2, 900, 1), uniform(2, 1, 2), clustered(2, 300, 3)]);
    for correction in [Correction::Translation, Correction::Isotropic, Correction::Border] {
        // As many bins as fit into workgroup memory, and more.
        for bins in [40, 9000] {
            let plan = pair_plan(&ensemble, RadialBins::linear(0.49, bins).unwrap(), correction);
            let Some(gpu) = shared("cuts") else { return };
            let once = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
            assert_eq!(wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap(), once, "{correction}, again");
            let Some(gpu) = open("cuts") else { return };
            let gpu = gpu.with_tuning(|t| (t.pairs_per_dispatch, t.fill) = (1, Fill::Poison));
            assert_eq!(wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap(), once, "{correction}, cut");
        }
    }
}

/// Ensembles with pairs at short distances only, for cells: points on their borders, crowded and empty cells, and
/// realizations of 0 and 1 points.
fn cell_cases() -> Vec<PairCase> {
    let mut cases = Vec::new();
    let mut add = |name: &str, domain: &Domain, sets: &[RawPoints], bins: RadialBins, correction: Correction| {
        let ensemble = ensemble_in(domain, sets);
        let settings = PairSettings { cumulative: true, ..correction.into() };
        let plan = PairPlan::new(domain, bins, settings, shape(&ensemble)).unwrap();
        cases.push(PairCase { name: format!("{name}, {correction}, {}D", domain.dim()), ensemble, plan });
    };
    let linear = |r: f64, bins: usize| RadialBins::linear(r, bins).unwrap();
    for dim in 1..=3 {
        let torus = Domain::unit_torus(dim);
        let k = 500f64.powf(1.0 / dim as f64).round() as usize;
        let sets = [
            uniform(dim, 0, 1),
            uniform(dim, 600, 2),
            uniform(dim, 1, 3),
            lattice(dim, k),
            clustered(dim, 300, 4),
            uniform(dim, 40, 5),
        ];
        add("torus", &torus, &sets, linear(0.125, 40), Correction::None);
        let unequal = Domain::torus(&[0.7, 2.5, 1.0][..dim]).unwrap();
        let bins = RadialBins::logarithmic(1e-3, 0.1, 24).unwrap();
        add("unequal sides", &unequal, &sets, bins, Correction::None);
        let window = Domain::window(&[(-1.0, 2.0), (0.5, 1.75), (10.0, 12.2)][..dim]).unwrap();
        let r = 0.21 * window.shortest_side();
        for correction in [Correction::None, Correction::Translation, Correction::Isotropic, Correction::Border] {
            if dim < 3 || correction != Correction::Isotropic {
                add("window", &window, &sets, linear(r, 30), correction);
            }
        }
    }
    // More rows than a workgroup holds, and more partners than a task takes.
    let unit = Domain::unit_torus(2);
    add("one crowded cell", &unit, &[coincident(2, 1500), uniform(2, 200, 6)], linear(0.1, 20), Correction::None);
    cases
}

#[test]
fn cells_find_the_same_pairs() {
    let Some(gpu) = shared("cells") else { return };
    let mut grids = 0;
    for case in cell_cases() {
        let PairCase { name, ensemble, plan } = &case;
        let truth = reference_counts(plan, ensemble);
        let beyond = plan.thresholds[plan.bins.len()];
        let all = PairPlan { search: PairSearch::All, ..plan.clone() };
        let all = wait(gpu.pair_counts(&all, ensemble, &go())).unwrap();
        let searches = [(1, 1e5), (2, 1e5), (3, 50.0)]
            .into_iter()
            .filter_map(|(reach, most)| CellGrid::new(ensemble.domain(), beyond, reach, most).map(PairSearch::Cells));
        for search in searches {
            let cells = PairPlan { search, ..plan.clone() };
            let here = wait(gpu.pair_counts(&cells, ensemble, &go())).unwrap();
            let name = format!("{name}, {search}");
            if plan.weighted() {
                assert_weights_within(&name, &here, &truth);
            } else {
                assert_counts_equal(&name, &here, &truth);
            }
            assert_eq!(here, all, "{name}: bytes, not only values");
            grids += 1;
        }
    }
    assert!(grids > 30, "only {grids} grids");
}

#[test]
fn cells_give_the_same_bytes_however_the_work_is_cut() {
    let sets = [uniform(2, 500, 1), clustered(2, 300, 2), uniform(2, 0, 3), lattice(2, 16)];
    let window = Domain::window(&[(0.0, 1.0), (0.0, 2.0)]).unwrap();
    let ensemble = ensemble_in(&window, &sets);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.2, 30).unwrap(), Correction::Isotropic);
    let beyond = plan.thresholds[plan.bins.len()];
    let grid = CellGrid::new(&window, beyond, 1, 1e4).unwrap();
    let plan = PairPlan { search: PairSearch::Cells(grid), ..plan };
    let Some(mut gpu) = open("cut cells") else { return };
    let once = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
    for (pairs, bytes) in [(1 << 31, 64 << 20), (1, 64 << 20), (1 << 12, 2000), (1 << 31, 1)] {
        gpu = gpu.with_tuning(|t| {
            (t.pairs_per_dispatch, t.buffer_bytes, t.fill) = (pairs, bytes, Fill::Poison);
        });
        assert_eq!(wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap(), once, "{pairs} pairs, {bytes} bytes");
    }
}

/// Sets so large that cells are chosen, and the reference would take minutes: the CPU path counts the same.
#[test]
fn large_sets_count_as_on_the_cpu() {
    let Some(gpu) = shared("large sets") else { return };
    let cpu = Cpu::new(None).unwrap();
    let ensemble = ensemble(&[uniform(2, 60_000, 1), clustered(2, 30_000, 2)]);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.01, 256).unwrap(), Correction::None);
    let plan = plan.for_device(gpu.costs().pairs);
    assert!(matches!(plan.search, PairSearch::Cells(_)));
    let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
    assert_counts_equal("large sets", &here, &wait(cpu.pair_counts(&plan, &ensemble, &go())).unwrap());
}

/// What is chosen by estimate: cells for many points and short distances, all pairs else.
#[test]
fn cells_are_chosen_where_they_are_faster() {
    let searched = |n: f64, r: f64| {
        let torus = Domain::unit_torus(2);
        let shape = EnsembleShape { realizations: 1, mean_points: n, max_points: n as u64 };
        let plan = PairPlan::new(&torus, RadialBins::linear(r, 256).unwrap(), Correction::None, shape).unwrap();
        let beyond = plan.thresholds[256];
        PairSearch::choose(&torus, beyond, n, &plan.filter, &SearchCosts::GPU)
    };
    assert!(matches!(searched(1e6, 0.05), PairSearch::Cells(_)));
    assert!(matches!(searched(1e5, 0.01), PairSearch::Cells(_)));
    assert_eq!(searched(1e6, 0.5), PairSearch::All);
    assert_eq!(searched(1e3, 0.05), PairSearch::All);
}

#[test]
fn counts_are_equal_over_many_tiles() {
    let Some(gpu) = shared("many tiles") else { return };
    let cases = [
        (Domain::unit_torus(2), RadialBins::linear(0.5, 90).unwrap(), vec![lattice(2, 45), uniform(2, 1030, 3)]),
        (Domain::torus(&[1.0, 0.8, 2.0]).unwrap(), RadialBins::linear(0.4, 40).unwrap(), vec![uniform(3, 1537, 4)]),
        // More bins than workgroup memory holds, and bins narrower than a step of the f32 filter.
        (Domain::unit_torus(2), RadialBins::linear(0.5, 20_000).unwrap(), vec![lattice(2, 20), uniform(2, 300, 5)]),
        (Domain::unit_torus(2), RadialBins::linear(1e-9, 256).unwrap(), vec![coincident(2, 20), close_pairs(400)]),
    ];
    for (domain, bins, sets) in cases {
        let ensemble = ensemble_in(&domain, &sets);
        let plan = pair_plan(&ensemble, bins, Correction::None);
        let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
        assert_counts_equal(&format!("{domain:?}"), &here, &reference_counts(&plan, &ensemble));
    }
}

#[test]
fn wide_workgroups_count_the_same() {
    let Some(gpu) = shared("wide workgroups") else { return };
    let sets = [uniform(3, 1100, 1), lattice(3, 9), uniform(3, 513, 2)];
    let ensemble = ensemble(&sets);
    // A plan for large sets takes the wide kernel; these are small only so that the reference is quick.
    let shape = EnsembleShape { max_points: 1 << 16, ..shape(&ensemble) };
    for bins in [RadialBins::linear(0.5, 45).unwrap(), RadialBins::logarithmic(0.01, 0.5, 30).unwrap()] {
        let plan = PairPlan::new(ensemble.domain(), bins, Correction::None, shape).unwrap();
        assert!(pair_kernel(&plan, 32 << 10).overrides.contains(&("WORKGROUP", 128)));
        let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
        assert_counts_equal("wide", &here, &reference_counts(&plan, &ensemble));
    }
}

/// Distances that differ from an edge by less than any float could tell: the last limbs decide.
#[test]
fn pairs_a_hair_from_an_edge() {
    let Some(gpu) = shared("a hair from an edge") else { return };
    let ulp = 2f64.powi(-54);
    for sides in [vec![1.0], vec![1.0, 1.0], vec![1.0, 1.0, 1.0], vec![1.0, 0.75], vec![0.5, 1.0, 0.625]] {
        let dim = sides.len();
        let domain = Domain::torus(&sides).unwrap();
        let mut coordinates = Vec::new();
        for k in 0..32 {
            for (step, aside) in
                [(0, 0.0), (1, 0.0), (-1, 0.0), (0, 2f64.powi(-31)), (-1, 2f64.powi(-31)), (0, 2f64.powi(-60))]
            {
                let x = (f64::from(k) / 32.0 + f64::from(step) * ulp).rem_euclid(1.0);
                coordinates.extend((0..dim).map(|a| if a == 0 { x } else { 0.5 + aside }));
            }
        }
        let ensemble = ensemble_in(&domain, &[raw(dim, coordinates)]);
        let r = domain.shortest_side() / 2.0;
        for bins in [
            RadialBins::linear(r, 16).unwrap(),
            RadialBins::from_edges((2..=32).map(|k| r * f64::from(k) / 32.0).collect()).unwrap(),
        ] {
            let plan = pair_plan(&ensemble, bins, Correction::None);
            let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
            assert_counts_equal(&format!("{sides:?}"), &here, &reference_counts(&plan, &ensemble));
        }
    }
}

/// 4.5e9 unordered pairs in one bin: more than a u32 holds, and as many per dispatch as are ever allowed.
/// The longest test of all (about a minute on a software device); nothing smaller can reach it.
#[test]
fn a_bin_beyond_32_bits() {
    let Some(gpu) = open("32 bits") else { return };
    let gpu = gpu.with_tuning(|t| t.pairs_per_dispatch = u64::MAX);
    let n = 95_000;
    let ensemble = ensemble(&[coincident(1, n)]);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 4).unwrap(), Correction::None);
    let counts = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap().counts;
    let n = n as u64;
    // The n coincident points among themselves, and each with the one at a distance of 0.15.
    assert_eq!(counts, [n * (n - 1), 2 * n, 0, 0]);
}

/// Points so close together that 32 bits hardly tell them apart.
fn close_pairs(n: usize) -> RawPoints {
    let mut rng = Rng(9);
    raw(2, (0..2 * n).map(|_| 1e-9 * rng.unit()).collect())
}

#[test]
fn forced_many_dispatches_give_the_same_counts() {
    let sets = [uniform(2, 900, 1), uniform(2, 0, 2), lattice(2, 20), uniform(2, 257, 3), uniform(2, 1, 4)];
    let ensemble = ensemble(&sets);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 60).unwrap(), Correction::None);
    let truth = reference_counts(&plan, &ensemble);
    for (pairs, bytes) in [(1, 1 << 20), (1 << 18, 1 << 20), (1 << 40, 1 << 13), (3 << 16, 1)] {
        let Some(gpu) = open("many dispatches") else { return };
        let gpu = gpu.with_tuning(|t| (t.pairs_per_dispatch, t.buffer_bytes) = (pairs, bytes));
        let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
        assert_counts_equal(&format!("{pairs} pairs, {bytes} bytes"), &here, &truth);
    }
}

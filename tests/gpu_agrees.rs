//! Trusts the reference (its own tests) and the comparators (`comparison_can_fail.rs`). Proves that the GPU counts the same
//! integers and keeps the promised bound on P, whatever the input and however the work is cut; that results do not
//! depend on what memory held before; and that a lost device is an error. Cannot see: speed, and other drivers than
//! the one here.

mod common;

use std::sync::OnceLock;

use common::*;
use pairwave::Error;
use pairwave::accumulate::WavePower;
use pairwave::compute::gpu::{AdapterChoice, Fill, GpuCompute, adapters, pair_kernel};
use pairwave::compute::{Compute, NotHere, Work, cpu::Cpu};
use pairwave::control::Control;
use pairwave::plan::{
    Accuracy, CellGrid, Correction, EnsembleShape, PairPlan, PairSearch, PairSettings, RadialBins, SearchCosts,
    WaveGrid, WaveList, WavePlan,
};
use pairwave::points::{Domain, Ensemble, RawPoints};

/// A device of one's own, or `None` where there is no driver and a person said that this is fine.
fn open(test: &str) -> Option<GpuCompute> {
    if gpu_tests_skipped(test) {
        return None;
    }
    match wait(GpuCompute::open(AdapterChoice::Any)) {
        Ok(gpu) => Some(gpu),
        Err(why) => panic!("{test}: {why} (PAIRWAVE_ALLOW_NO_GPU=1 skips where there is no driver)"),
    }
}

/// One device for the tests that change nothing about it.
fn shared(test: &str) -> Option<&'static GpuCompute> {
    static GPU: OnceLock<Option<GpuCompute>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| open(test)).as_ref();
    if gpu.is_none() {
        gpu_tests_skipped(test);
    }
    gpu
}

/// Why a device leaves something to the CPU path.
fn refusal(gpu: &GpuCompute, work: Work<'_>) -> String {
    match gpu.supports(work) {
        Err(NotHere::Because(why)) => why,
        other => panic!("{work:?}: {other:?}"),
    }
}

fn go() -> Control {
    Control::default()
}

#[test]
fn self_check_passes_and_says_what_it_found() {
    let Some(gpu) = shared("self-check") else { return };
    println!("{}\n{}", gpu.gpu().summary(), gpu.verdict());
    assert!(gpu.verdict().passed() && gpu.verdict().checks.len() >= 5);
    // A device may have no f64, but one that has it is to compute well.
    let f64 = gpu.verdict().f64();
    assert!(f64.as_ref().err().is_none_or(|why| why.contains("SHADER_F64")), "{f64:?}");
    assert!(wait(adapters()).iter().any(|a| a == gpu.gpu().summary()));
}

#[test]
fn an_adapter_that_is_not_there_is_an_error() {
    let none = wait(GpuCompute::open(AdapterChoice::Index(99))).map(|_| ()).unwrap_err();
    assert!(matches!(none, Error::NoDevice { .. }), "{none}");
    // A processor in disguise is never taken for hardware.
    let hardware = wait(adapters()).iter().any(|a| !a.software);
    match wait(GpuCompute::open(AdapterChoice::HardwareOnly)) {
        Ok(gpu) => assert!(!gpu.gpu().summary().software),
        Err(why) => assert!(!hardware && matches!(why, Error::NoDevice { .. }), "{why}"),
    }
}

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
    let plan = plan.for_device(gpu.pair_device());
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

#[test]
fn many_small_realizations() {
    let Some(gpu) = shared("many small realizations") else { return };
    let sets: Vec<_> = (0..500).map(|k| uniform(2, 20 + k % 13, k as u64)).collect();
    let ensemble = ensemble(&sets);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 32).unwrap(), Correction::None);
    let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
    assert_counts_equal("500 sets", &here, &reference_counts(&plan, &ensemble));
    let plan = wave_plan(&ensemble, &[6, 6], Accuracy::Fast);
    let here = wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap();
    assert_power_within("500 sets", Accuracy::Fast, &here, &reference_power(&plan, &ensemble));
}

#[test]
fn empty_realizations_are_zeros() {
    let Some(gpu) = shared("empty") else { return };
    for sets in [vec![uniform(2, 0, 1)], vec![uniform(2, 0, 1), uniform(2, 1, 2), uniform(2, 0, 3)]] {
        let ensemble = ensemble(&sets);
        let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 8).unwrap(), Correction::None);
        let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
        assert_counts_equal("empty", &here, &reference_counts(&plan, &ensemble));
        let plan = wave_plan(&ensemble, &[4, 4], Accuracy::Fast);
        let (here, truth) = (wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap(), reference_power(&plan, &ensemble));
        assert_eq!((here.norm_totals(), here.realizations), (truth.norm_totals(), truth.realizations));
        for (a, b) in here.mode_totals().q.iter().zip(&truth.mode_totals().q) {
            assert!((a - b).abs() <= 1e-6, "{a} against {b}");
        }
    }
}

#[test]
fn batches_can_be_split_anywhere_at_a_leaf() {
    let Some(gpu) = shared("split") else { return };
    let sets: Vec<_> = (0..48).map(|k| uniform(2, 30 + k % 5, k as u64)).collect();
    let whole = ensemble(&sets);
    let pairs = pair_plan(&whole, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let waves = wave_plan(&whole, &[9, 9], Accuracy::Fast);
    let all =
        (wait(gpu.pair_counts(&pairs, &whole, &go())).unwrap(), wait(gpu.wave_power(&waves, &whole, &go())).unwrap());
    let parts = [0..16, 16..32, 32..48].map(|r| whole.slice(r));
    let mut merged: Option<(_, _)> = None;
    for part in &parts {
        let (p, w) =
            (wait(gpu.pair_counts(&pairs, part, &go())).unwrap(), wait(gpu.wave_power(&waves, part, &go())).unwrap());
        match &mut merged {
            None => merged = Some((p, w)),
            Some((ps, ws)) => {
                ps.merge(&p).unwrap();
                ws.merge(w).unwrap();
            }
        }
    }
    assert_eq!(merged.unwrap(), all, "bytes, not only values");
}

struct WaveCase {
    name: &'static str,
    ensemble: Ensemble,
    frequency: Vec<u32>,
}

fn wave_cases() -> Vec<WaveCase> {
    let torus = Domain::torus(&[1.5, 0.6, 1.0]).unwrap();
    let case = |name, ensemble, frequency: &[u32]| WaveCase { name, ensemble, frequency: frequency.to_vec() };
    vec![
        case("uniform 1D", ensemble(&[uniform(1, 700, 1)]), &[400]),
        case("uniform 2D", ensemble(&[uniform(2, 1500, 2)]), &[40, 40]),
        case("uniform 3D", ensemble(&[uniform(3, 600, 3)]), &[9, 8, 7]),
        case("clustered 2D", ensemble(&[clustered(2, 900, 4)]), &[33, 20]),
        case("lattice 2D", ensemble(&[lattice(2, 24)]), &[50, 50]),
        case("rank-1 lattice", ensemble(&[rank1(1597, 987)]), &[60, 40]),
        case("coincident", ensemble(&[coincident(2, 500)]), &[17, 17]),
        case("strip of high m_0", ensemble(&[uniform(2, 37, 5)]), &[65_536, 2]),
        case("strip of high m_1", ensemble(&[uniform(2, 37, 6)]), &[1, 65_536]),
        case("unequal n", ensemble(&[0, 1, 2, 33, 900, 16].map(|n| uniform(2, n, 50 + n as u64))), &[20, 20]),
        case("unequal sides", ensemble_in(&torus, &[uniform(3, 300, 7), clustered(3, 200, 8)]), &[7, 3, 5]),
        case(
            "window",
            ensemble_in(&Domain::window(&[(-1.0, 2.0), (0.0, 1.0)]).unwrap(), &[uniform(2, 400, 9)]),
            &[20, 9],
        ),
        case("only m_2", ensemble(&[uniform(3, 200, 10)]), &[0, 0, 70]),
        case("chunks of points", ensemble(&[uniform(2, 4500, 11), uniform(2, 2049, 12)]), &[10, 10]),
    ]
}

/// What each accuracy promises about P on any device.
struct Promise {
    accuracy: Accuracy,
    /// Root mean square of `P - P_ref` for uniform points.
    rms: f64,
    /// `|P - P_ref| / (1 + P_ref)` for them.
    max: f64,
    /// P of a rank-1 lattice of 65,536 points where it is 0.
    zero: f64,
    /// Median of `|P - P_ref| / P_ref` of a jittered lattice.
    jittered: f64,
    /// Error of cosine and sine.
    table: f64,
}

const PROMISES: [Promise; 2] = [
    Promise { accuracy: Accuracy::Fast, rms: 6e-7, max: 1e-5, zero: 1e-10, jittered: 3e-4, table: 2e-7 },
    Promise { accuracy: Accuracy::High, rms: 1e-12, max: 1e-11, zero: 1e-24, jittered: 1e-9, table: 1e-15 },
];

/// The promises the device makes: `fast` always, `high` where it has a good f64, as every driver of a test machine should.
fn promises(gpu: &GpuCompute) -> impl Iterator<Item = &'static Promise> {
    if let Err(why) = gpu.verdict().f64() {
        println!("accuracy high is not tested: {why}");
    }
    PROMISES.iter().filter(|p| p.accuracy == Accuracy::Fast || gpu.verdict().f64().is_ok())
}

#[test]
fn power_is_within_its_bound() {
    let Some(gpu) = shared("power") else { return };
    for promise in promises(gpu) {
        for case in wave_cases() {
            let plan = wave_plan(&case.ensemble, &case.frequency, promise.accuracy);
            let here = wait(gpu.wave_power(&plan, &case.ensemble, &go())).unwrap();
            let truth = reference_power(&plan, &case.ensemble);
            let error = assert_power_within(case.name, promise.accuracy, &here, &truth);
            if case.name.starts_with("uniform") {
                assert!(error.rms <= promise.rms && error.max <= promise.max, "{}: {error:?}", case.name);
            }
        }
    }
}

/// Weights of either sign, one of them large, and such that sum to 0.
#[test]
fn power_of_weighted_points_is_within_its_bound() {
    let Some(gpu) = shared("weighted power") else { return };
    for (name, ensemble, frequency) in [
        ("1D", ensemble(&[uniform(1, 700, 1)]), vec![300]),
        ("2D", ensemble(&[uniform(2, 1500, 2), uniform(2, 0, 3), uniform(2, 33, 4)]), vec![33, 20]),
        ("3D", ensemble(&[uniform(3, 600, 3)]), vec![6, 5, 4]),
    ] {
        let n = ensemble.total_points();
        let mut draws = Rng(5);
        let mut weights: Vec<f64> = (0..n).map(|_| draws.unit() - 0.3).collect();
        weights[n / 2] = 7.5e30;
        let spread = ensemble.clone().with_weights(&weights);
        weights[n / 2] = 0.5;
        let mean = weights.iter().sum::<f64>() / n as f64;
        weights.iter_mut().for_each(|w| *w -= mean);
        for (what, ensemble) in [("one large", spread), ("sum 0", ensemble.with_weights(&weights))] {
            for promise in promises(gpu) {
                let plan = wave_plan(&ensemble, &frequency, promise.accuracy);
                let here = wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap();
                let name = format!("{name}, weights {what}");
                let error = assert_power_within(&name, promise.accuracy, &here, &reference_power(&plan, &ensemble));
                assert!(error.rms <= promise.rms && error.max <= promise.max, "{name}: {error:?}");
            }
        }
    }
}

/// P here and by the reference, at every `every`th mode of a grid: the reference takes its time.
fn sampled_power(gpu: &GpuCompute, ensemble: &Ensemble, f: u32, accuracy: Accuracy, every: usize) -> Vec<[f64; 2]> {
    let plan = wave_plan(ensemble, &[f, f], accuracy);
    let here = wait(gpu.wave_power(&plan, ensemble, &go())).unwrap().mode_totals().q;
    let indices: Vec<usize> = (0..plan.waves.len()).step_by(every).filter(|&i| plan.waves.dc() != Some(i)).collect();
    let vectors = indices.iter().map(|&i| plan.waves.vector(i)).collect();
    let list = WaveList { dim: 2, vectors, mirrored: false };
    let listed = WavePlan::new(ensemble.domain(), list, accuracy, shape(ensemble)).unwrap();
    let truth = reference_power(&listed, ensemble).mode_totals().q;
    let n = ensemble.total_points() as f64;
    indices.iter().zip(truth).map(|(&i, q)| [here[i] / n, q / n]).collect()
}

#[test]
fn power_of_many_points_keeps_the_rms() {
    let Some(gpu) = shared("rms") else { return };
    for promise in promises(gpu) {
        for (n, f, every) in [(65_536, 16, 3), (1_000_000, 8, 7)] {
            if n > 65_536 && promise.accuracy == Accuracy::High {
                continue;
            }
            let powers = sampled_power(gpu, &ensemble(&[uniform(2, n, 1)]), f, promise.accuracy, every);
            let squares: f64 = powers.iter().map(|[p, r]| (p - r).powi(2)).sum();
            let rms = (squares / powers.len() as f64).sqrt();
            // Written so that NaN stays.
            let max =
                powers.iter().map(|[p, r]| (p - r).abs() / (1.0 + r)).fold(0.0, |m, e| if e <= m { m } else { e });
            let name = promise.accuracy.name();
            println!("{name}, n = {n}, {} modes: rms {rms:.1e}, max {max:.1e}", powers.len());
            assert!(rms <= promise.rms && max <= promise.max, "{name}, n = {n}: rms {rms:e}, max {max:e}");
        }
    }
}

/// Gaussian jitter of a thousandth of a cell: P is far below 1, and s small against its addends.
#[test]
fn power_of_a_jittered_lattice_keeps_its_relative_error() {
    let Some(gpu) = shared("jittered lattice") else { return };
    let side = 256;
    let mut draws = Rng(3);
    let mut place = |cell: usize| {
        let (radius, turn) = ((-2.0 * (1.0 - draws.unit()).ln()).sqrt(), draws.unit());
        let x = (cell as f64 + 0.5 + 1e-3 * radius * (std::f64::consts::TAU * turn).cos()) / side as f64;
        x.rem_euclid(1.0)
    };
    let points = (0..side * side).flat_map(|i| [place(i / side), place(i % side)]).collect();
    let ensemble = ensemble(&[raw(2, points)]);
    for promise in promises(gpu) {
        let (f, every) = if promise.accuracy == Accuracy::Fast { (64, 41) } else { (16, 5) };
        let powers = sampled_power(gpu, &ensemble, f, promise.accuracy, every);
        let mut errors: Vec<f64> = powers.iter().map(|[p, r]| (p - r).abs() / r).collect();
        errors.sort_by(f64::total_cmp);
        let (median, max) = (errors[errors.len() / 2], errors[errors.len() - 1]);
        let least = powers.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
        let name = promise.accuracy.name();
        println!("{name}, P from {least:.1e}, {} modes: median {median:.1e}, max {max:.1e}", errors.len());
        assert!(median <= promise.jittered && max.is_finite(), "{name}: {median:e}, {max:e}");
    }
}

/// Two points, one of them at 0: `|s_m|^2 = 2 + 2 cos(2 pi m x)`.
#[test]
fn table_entries_are_good_at_any_frequency() {
    let Some(gpu) = shared("table entries") else { return };
    for x in [0.123_456_789_012_345_67, 0.618_033_988_749_894_9, 1.0 / 2f64.sqrt()] {
        let ensemble = ensemble(&[raw(1, vec![0.0, x])]);
        for promise in promises(gpu) {
            let plan = wave_plan(&ensemble, &[65_536], promise.accuracy);
            let here = wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap().mode_totals().q;
            let truth = reference_power(&plan, &ensemble).mode_totals().q;
            // d|s|^2 = 2 (1 + c) dc + 2 s ds, at most 4 times the error of the entry, and |s|^2 <= 4 is rounded.
            let errors = here.iter().zip(&truth).map(|(a, b)| (a - b).abs() / 4.0);
            let worst = errors.fold(0.0, |m, e| if e <= m { m } else { e });
            println!("{}, x = {x}: {worst:.1e}", promise.accuracy.name());
            assert!(worst <= promise.table, "{}, x = {x}: {worst:e}", promise.accuracy.name());
        }
    }
}

/// Points that repeat coordinates: the worst there is for sums in f32, and what the bound for any input is about.
#[test]
fn power_of_repeated_coordinates_keeps_the_bound_for_any_points() {
    let Some(gpu) = shared("repeated coordinates") else { return };
    for n in [300, 4096, 65_536, 400_000] {
        let ensemble = ensemble(&[three_places(n)]);
        let plan = wave_plan(&ensemble, &[3], Accuracy::Fast);
        let here = wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap();
        assert_power_within(
            &format!("three places, n = {n}"),
            Accuracy::Fast,
            &here,
            &reference_power(&plan, &ensemble),
        );
    }
}

#[test]
fn power_of_a_lattice_vanishes_off_its_dual() {
    let Some(gpu) = shared("lattice zeros") else { return };
    for promise in promises(gpu) {
        for (n, z, f) in [
            (4096, 1531, 40),
            (4096, 1557, 40),
            (32_768, 12_599, 12),
            (65_536, 19_463, 12),
            (65_536, 12_345, 12),
            (65_521, 1, 12),
        ] {
            // Coordinates that are no multiples of 2^-53 are rounded before we see them, and P is not 0 then.
            if promise.accuracy == Accuracy::High && n == 65_521 {
                continue;
            }
            let ensemble = ensemble(&[rank1(n, z)]);
            let plan = wave_plan(&ensemble, &[f, f], promise.accuracy);
            let here = wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap().mode_totals().q;
            let (mut zeros, mut worst) = (0, 0f64);
            for (index, q) in here.iter().enumerate() {
                let m = plan.waves.vector(index).map(|m| m as i64);
                if (m[0] + m[1] * z as i64).rem_euclid(n as i64) != 0 {
                    zeros += 1;
                    let p = q / n as f64;
                    worst = if p <= worst { worst } else { p };
                }
            }
            println!("{}, rank-1 lattice n = {n}: P <= {worst:.1e} at {zeros} modes", promise.accuracy.name());
            assert!(zeros > 200 && worst <= promise.zero, "{}: P = {worst:e}", promise.accuracy.name());
        }
    }
}

#[test]
fn poisoned_memory_and_other_cuts_give_identical_bytes() {
    let sets = [uniform(2, 2500, 1), uniform(2, 700, 2), uniform(2, 3, 3)];
    let weights: Vec<f64> = (0..3203).map(|j| f64::from(j % 17) / 16.0 - 0.4).collect();
    let plain = ensemble(&sets);
    let weighted = plain.clone().with_weights(&weights);
    let pairs = pair_plan(&plain, RadialBins::logarithmic(1e-3, 0.5, 30).unwrap(), Correction::None);
    let Some(gpu) = shared("poison") else { return };
    let spectra = |gpu: &GpuCompute, frequency: &[u32]| -> Vec<WavePower> {
        let both = promises(gpu).flat_map(|p| [(p.accuracy, &plain), (p.accuracy, &weighted)]);
        both.map(|(accuracy, points)| {
            wait(gpu.wave_power(&wave_plan(points, frequency, accuracy), points, &go())).unwrap()
        })
        .collect()
    };
    let clean = (wait(gpu.pair_counts(&pairs, &plain, &go())).unwrap(), spectra(gpu, &[70, 71]));
    // 600 KiB hold one block of the grid at a time, 2^20 sums cut that into submissions. 1 byte is the smallest cut there is.
    for (fill, bytes, fma) in
        [(Fill::Poison, 64 << 20, 1 << 29), (Fill::Poison, 600 << 10, 1 << 20), (Fill::Zero, 1, 1)]
    {
        let Some(gpu) = open("poison") else { return };
        let gpu = gpu.with_tuning(|t| (t.fill, t.buffer_bytes, t.fma_per_dispatch) = (fill, bytes, fma));
        for _ in 0..2 {
            if bytes > 1 {
                assert_eq!(wait(gpu.pair_counts(&pairs, &plain, &go())).unwrap(), clean.0, "{fill:?}, {bytes}");
            }
            assert_eq!(spectra(&gpu, &[70, 71]), clean.1, "{fill:?}, {bytes}");
        }
    }
}

#[test]
fn a_lost_device_is_an_error_and_stays_one() {
    let Some(gpu) = open("lost device") else { return };
    let ensemble = ensemble(&[uniform(2, 300, 1)]);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let waves = wave_plan(&ensemble, &[9, 9], Accuracy::Fast);
    wait(gpu.pair_counts(&pairs, &ensemble, &go())).unwrap();
    gpu.gpu().lose();
    for _ in 0..2 {
        let why = wait(gpu.pair_counts(&pairs, &ensemble, &go())).unwrap_err();
        assert!(matches!(why, Error::Device { .. }) && why.to_string().contains("lost"), "{why}");
        let why = wait(gpu.wave_power(&waves, &ensemble, &go())).unwrap_err();
        assert!(matches!(why, Error::Device { .. }), "{why}");
    }
}

#[test]
fn a_device_lost_at_work_is_an_error() {
    let Some(gpu) = open("device lost at work") else { return };
    // One small dispatch after another, again and again, so that the loss falls among them.
    let gpu = gpu.with_tuning(|t| t.pairs_per_dispatch = 1);
    let ensemble = ensemble(&[uniform(2, 20_000, 1)]);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let why = std::thread::scope(|scope| {
        let work = scope.spawn(|| (0..10_000).find_map(|_| wait(gpu.pair_counts(&pairs, &ensemble, &go())).err()));
        std::thread::sleep(std::time::Duration::from_millis(500));
        gpu.gpu().lose();
        work.join().expect("no panic").expect("an error")
    });
    assert!(matches!(why, Error::Device { .. }), "{why}");
}

#[test]
fn cancelled_work_ends() {
    let Some(gpu) = shared("cancel") else { return };
    let ensemble = ensemble(&[uniform(2, 300, 1)]);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let control = Control::default();
    control.cancel();
    assert!(matches!(wait(gpu.pair_counts(&pairs, &ensemble, &control)), Err(Error::Cancelled)));
    let waves = wave_plan(&ensemble, &[9, 9], Accuracy::Fast);
    assert!(matches!(wait(gpu.wave_power(&waves, &ensemble, &control)), Err(Error::Cancelled)));
}

#[test]
fn what_is_not_done_here_is_said() {
    let Some(gpu) = shared("supports") else { return };
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let ensemble = ensemble_in(&window, &[uniform(2, 50, 1)]);
    let plain = pair_plan(&ensemble, RadialBins::linear(0.4, 8).unwrap(), Correction::None);
    assert_eq!(gpu.supports(Work::Pairs(&plain)), Ok(()));
    let bins = |r: f64| RadialBins::linear(r, 8).unwrap();
    // Weights that grow without bound, and weights of points.
    let steep = pair_plan(&ensemble, bins(0.999), Correction::Translation);
    assert!(refusal(gpu, Work::Pairs(&steep)).contains("translation weights up to"));
    let settings = PairSettings { masses: true, ..Correction::None.into() };
    let masses = PairPlan::new(&window, bins(0.4), settings, shape(&ensemble)).unwrap();
    assert!(refusal(gpu, Work::Pairs(&masses)).contains("weights of points"));
    for plan in [steep, masses] {
        assert!(wait(gpu.pair_counts(&plan, &ensemble, &go())).is_err());
    }
    assert_eq!(gpu.supports(Work::Waves(&wave_plan(&ensemble, &[4, 4], Accuracy::Fast))), Ok(()));
    let high = wave_plan(&ensemble, &[4, 4], Accuracy::High);
    let why = gpu.verdict().f64().map_err(|why| NotHere::Because(format!("accuracy high needs f64: {why}")));
    assert_eq!(gpu.supports(Work::Waves(&high)), why);
    assert_eq!(wait(gpu.wave_power(&high, &ensemble, &go())).is_ok(), why.is_ok());
    let list = WaveList { dim: 2, vectors: vec![[1.0, 2.0, 0.0]], mirrored: false };
    let listed = WavePlan::new(&Domain::unit_torus(2), list, Accuracy::Fast, shape(&ensemble)).unwrap();
    assert!(refusal(gpu, Work::Waves(&listed)).contains("lists"));
    assert!(wait(gpu.wave_power(&listed, &ensemble, &go())).is_err());
    // More than any device has in one buffer: the number of bytes is said.
    let huge = EnsembleShape { max_points: 1 << 40, ..shape(&ensemble) };
    let huge = WavePlan::new(&window, WaveGrid::new(&[4, 4]).unwrap(), Accuracy::Fast, huge).unwrap();
    assert!(refusal(gpu, Work::Waves(&huge)).contains("17592186044416 bytes"));
}

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

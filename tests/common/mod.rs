//! Shared by the tests: inputs, and comparators that `reference/comparison_can_fail.rs` proves able to fail.
#![allow(dead_code, reason = "every room uses its own part")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pairwave::accumulate::{LagCounts, PairCounts, WaveCovariance, WavePower};
use pairwave::compute::{Compute, reference::Reference};
use pairwave::control::Control;
use pairwave::estimate::Analysis;
use pairwave::plan::{
    Accuracy, Correction, EnsembleShape, GPU_WEIGHT_BOUND, LagGrid, LagPlan, PairPlan, PairSettings, RadialBins,
    WaveGrid, WavePlan,
};
use pairwave::points::{Domain, Ensemble, RawPoints};
use pairwave::report;
use pairwave::request::Request;

/// The request of a command line.
pub fn request(line: &str) -> Request {
    Request::parse(line.split_whitespace().map(String::from)).unwrap()
}

/// All files of numbers that a report has, by name.
pub fn files(analysis: &Analysis) -> BTreeMap<String, Vec<u8>> {
    let dir = tempfile::tempdir().unwrap();
    let written = report::write(&dir.path().join("out"), analysis, false).unwrap();
    let numbers = |p: &&PathBuf| p.extension().is_some_and(|e| e == "csv" || e == "npy");
    let name = |p: &Path| p.file_name().unwrap().to_string_lossy().into_owned();
    written.iter().filter(numbers).map(|p| (name(p), std::fs::read(p).unwrap())).collect()
}

/// What a backend was asked for.
pub fn wait<T>(work: impl Future<Output = T>) -> T {
    pollster::block_on(work)
}

/// SplitMix64: enough randomness for inputs, the same on every platform.
pub struct Rng(pub u64);

impl Rng {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 2f64.powi(53)
    }
}

/// Points from coordinates, point by point.
pub fn raw(dim: usize, coordinates: Vec<f64>) -> RawPoints {
    RawPoints { dim, coordinates, source: "test".into(), lines: Vec::new() }
}

/// `n` uniform points in the unit cube.
pub fn uniform(dim: usize, n: usize, seed: u64) -> RawPoints {
    let mut rng = Rng(seed);
    raw(dim, (0..n * dim).map(|_| rng.unit()).collect())
}

/// `n` points in tight clumps of 10, some of them straddling the sides of the unit torus.
pub fn clustered(dim: usize, n: usize, seed: u64) -> RawPoints {
    let mut rng = Rng(seed);
    let mut centre = vec![0.0; dim];
    let mut coordinates = Vec::with_capacity(n * dim);
    for j in 0..n {
        if j % 10 == 0 {
            centre = (0..dim).map(|_| if rng.unit() < 0.3 { 0.0 } else { rng.unit() }).collect();
        }
        coordinates.extend(centre.iter().map(|c| (c + 1e-3 * (rng.unit() - 0.5)).rem_euclid(1.0)));
    }
    raw(dim, coordinates)
}

/// The regular lattice with `k` points a side: distances lie exactly on the edges of suitable bins.
pub fn lattice(dim: usize, k: usize) -> RawPoints {
    let n = k.pow(dim as u32);
    let coordinates = (0..n).flat_map(|j| (0..dim).map(move |a| (j / k.pow(a as u32) % k) as f64 / k as f64)).collect();
    raw(dim, coordinates)
}

/// The rank-1 lattice `(i / n)(1, z)`.
pub fn rank1(n: usize, z: usize) -> RawPoints {
    raw(2, (0..n).flat_map(|i| [i as f64 / n as f64, (i * z % n) as f64 / n as f64]).collect())
}

/// Everything `n` times at the same place, then one point elsewhere.
pub fn coincident(dim: usize, n: usize) -> RawPoints {
    let mut coordinates = vec![0.25; n * dim];
    coordinates.extend(vec![0.4; dim]);
    raw(dim, coordinates)
}

/// Points at three places only, in turns of a circle so nearly balanced that P is about 1, then `sqrt(n)` at the origin: the
/// rounding errors of equal points add up while the points themselves cancel.
pub fn three_places(n: usize) -> RawPoints {
    let places = [(0.478_96, 136_156.0), (0.478_27, 645_528.0), (0.042_77, 912_420.0)];
    let mut x = Vec::with_capacity(n);
    for (share, place) in places {
        x.extend(std::iter::repeat_n(place / 1_048_576.0, (share * n as f64).round() as usize));
    }
    x.extend(vec![0.0; (n as f64).sqrt() as usize]);
    raw(1, x)
}

/// An ensemble on the unit torus.
pub fn ensemble(sets: &[RawPoints]) -> Ensemble {
    ensemble_in(&Domain::unit_torus(sets[0].dim), sets)
}

/// An ensemble whose unit-cube coordinates are stretched to fill `domain`.
pub fn ensemble_in(domain: &Domain, sets: &[RawPoints]) -> Ensemble {
    let dim = domain.dim();
    let stretched: Vec<RawPoints> = sets
        .iter()
        .map(|set| {
            let coordinates = set.coordinates.iter().enumerate();
            let place = |(i, x): (usize, &f64)| domain.origin()[i % dim] + x * domain.sides()[i % dim];
            raw(dim, coordinates.map(place).collect())
        })
        .collect();
    Ensemble::from_raw(&stretched, domain, true, 0).unwrap()
}

/// The shape of an ensemble, for plans.
pub fn shape(ensemble: &Ensemble) -> EnsembleShape {
    let k = ensemble.realizations();
    EnsembleShape {
        realizations: k as u64,
        mean_points: ensemble.total_points() as f64 / k as f64,
        max_points: (0..k).map(|k| ensemble.points_in(k)).max().unwrap() as u64,
    }
}

/// A pair plan for an ensemble.
pub fn pair_plan(ensemble: &Ensemble, bins: RadialBins, correction: Correction) -> PairPlan {
    PairPlan::new(ensemble.domain(), bins, correction, shape(ensemble)).unwrap()
}

/// A lag plan for an ensemble, with the default rings.
pub fn lag_plan(ensemble: &Ensemble, bins: usize, lag_max: Option<f64>, correction: Correction) -> LagPlan {
    let grid = LagGrid::new(ensemble.domain(), bins, lag_max).unwrap();
    LagPlan::new(ensemble.domain(), grid, correction, None, shape(ensemble)).unwrap()
}

/// A wave plan for an ensemble.
pub fn wave_plan(ensemble: &Ensemble, max_frequency: &[u32], accuracy: Accuracy) -> WavePlan {
    WavePlan::new(ensemble.domain(), WaveGrid::new(max_frequency).unwrap(), accuracy, shape(ensemble)).unwrap()
}

/// Whether the GPU part of a test is to be skipped: there is no driver at all, and a person has typed
/// `PAIRWAVE_ALLOW_NO_GPU=1` to accept that. Says so on stderr itself, since the test harness keeps what `println` says.
pub fn gpu_tests_skipped(test: &str) -> bool {
    use std::io::Write;
    let accepted = std::env::var("PAIRWAVE_ALLOW_NO_GPU").is_ok_and(|v| v == "1");
    let skipped = accepted && pollster::block_on(pairwave::compute::gpu::adapters()).is_empty();
    if skipped {
        let line = format!("{test}: SKIPPED, there is no GPU driver and PAIRWAVE_ALLOW_NO_GPU=1\n");
        std::io::stderr().write_all(line.as_bytes()).unwrap();
    }
    skipped
}

/// A named pair-counting case.
pub struct PairCase {
    pub name: String,
    pub ensemble: Ensemble,
    pub plan: PairPlan,
}

/// The table of pair-counting cases every backend must count exactly: every kind of input, bins and torus, in 1, 2 and 3
/// dimensions. `size` scales the point counts (about `size` points a set).
pub fn pair_cases(size: usize) -> Vec<PairCase> {
    let mut cases = Vec::new();
    let mut add = |name: &str, domain: &Domain, sets: &[RawPoints], bins: RadialBins| {
        let ensemble = ensemble_in(domain, sets);
        let plan = pair_plan(&ensemble, bins, Correction::None);
        cases.push(PairCase { name: format!("{name}, {}D", domain.dim()), ensemble, plan });
    };
    for dim in 1..=3 {
        let unit = Domain::unit_torus(dim);
        let k = (size as f64).powf(1.0 / dim as f64).round() as usize;
        let linear = |r: f64, b: usize| RadialBins::linear(r, b).unwrap();
        add("uniform", &unit, &[uniform(dim, size, 1)], linear(0.5, 256));
        add("uniform, short range", &unit, &[uniform(dim, size, 2)], linear(0.05, 7));
        add("clustered", &unit, &[clustered(dim, size, 3)], linear(0.5, 1024));
        add("lattice, distances on edges", &unit, &[lattice(dim, k)], linear(0.5, k.max(2)));
        add("dyadic lattice", &unit, &[lattice(dim, 8)], linear(0.5, 64));
        add("coincident", &unit, &[coincident(dim, size.min(500))], linear(0.5, 10));
        add("two points", &unit, &[raw(dim, [vec![0.0; dim], vec![0.999; dim]].concat())], linear(0.5, 16));
        add(
            "n = 0, 1, 2, 3 and more",
            &unit,
            &[0, 1, 2, 3, 40, 7].map(|n| uniform(dim, n, 40 + n as u64)),
            linear(0.4, 33),
        );
        add("logarithmic", &unit, &[uniform(dim, size, 5)], RadialBins::logarithmic(1e-3, 0.49, 24).unwrap());
        let given = vec![0.0, 0.01, 0.010_000_001, 0.1, 0.33, 0.5];
        add(
            "given edges",
            &unit,
            &[lattice(dim, k), clustered(dim, size / 2, 6)],
            RadialBins::from_edges(given).unwrap(),
        );
        add("not from 0", &unit, &[lattice(dim, k)], RadialBins::from_edges(vec![0.25, 0.3, 0.5]).unwrap());
        let close = raw(dim, [vec![0.5; dim], vec![0.5 + 1e-9; dim], vec![0.5 - 3e-9; dim], vec![0.0; dim]].concat());
        add("1e-9 apart", &unit, &[close], RadialBins::logarithmic(1e-10, 0.5, 300).unwrap());
        let sides = &[2.5, 1.0, 0.7][..dim];
        let torus = Domain::torus(sides).unwrap();
        let r = torus.shortest_side() / 2.0;
        add("unequal sides", &torus, &[uniform(dim, size, 7), lattice(dim, k)], linear(r, 100));
        add(
            "unequal sides, log",
            &torus,
            &[clustered(dim, size, 8)],
            RadialBins::logarithmic(r * 1e-4, r, 40).unwrap(),
        );
        let ranges: Vec<(f64, f64)> = (0..dim).map(|a| (-1.0 - a as f64, 2.0 + a as f64)).collect();
        let window = Domain::window(&ranges).unwrap();
        add("window", &window, &[uniform(dim, size, 9), lattice(dim, k)], linear(1.5, 60));
        // Distances so near edges that f32 takes some for the bin beside.
        for bins in [
            linear(0.4, 250),
            RadialBins::from_edges((0..=60).map(|k| 0.1 + f64::from(k) / 200.0).collect()).unwrap(),
            RadialBins::logarithmic(1e-3, 0.4, 60).unwrap(),
            RadialBins::from_edges((0..200).map(|k| 0.4 * (f64::from(k) / 200.0).powf(0.7)).collect()).unwrap(),
        ] {
            let set = beside_edges(dim, size, bins.edges());
            add("a hair from edges", &unit, &[set], bins);
        }
        // Bins of a hundred or so steps of 32 bits, so that rounding of coordinates takes some of the pairs over an edge.
        for (name, domain) in [("unit", &unit), ("unequal sides", &torus), ("window", &window)] {
            let mut close = uniform(dim, size.min(300), 10);
            close.coordinates.iter_mut().for_each(|x| *x = 0.4 + *x * 2f64.powi(-20));
            let r = domain.length_unit() * 2f64.powi(-19);
            add(&format!("near, {name}"), domain, std::slice::from_ref(&close), linear(r, 61));
            add(&format!("near, {name}, log"), domain, &[close], RadialBins::logarithmic(r / 64.0, r, 24).unwrap());
        }
    }
    cases
}

/// A point and `n` others, each at the distance of an edge from it but for 3e-7 of it.
fn beside_edges(dim: usize, n: usize, edges: &[f64]) -> RawPoints {
    let mut rng = Rng(11);
    let mut coordinates = vec![0.0; dim];
    for &edge in edges.iter().filter(|edge| **edge > 0.0).cycle().take(n) {
        let r = edge * (1.0 + 6e-7 * (rng.unit() - 0.5));
        let towards: Vec<f64> = (0..dim).map(|_| rng.unit() - 0.5).collect();
        let length = towards.iter().map(|x| x * x).sum::<f64>().sqrt();
        coordinates.extend(towards.iter().map(|x| (r * x / length).rem_euclid(1.0)));
    }
    raw(dim, coordinates)
}

/// A named case of counting by lags.
pub struct LagCase {
    pub name: String,
    pub ensemble: Ensemble,
    pub plan: LagPlan,
}

/// The table of lag-counting cases every backend must count exactly: every kind of input, grid and domain, lags on edges
/// and of half a period, in 1, 2 and 3 dimensions. `size` scales the point counts.
pub fn lag_cases(size: usize) -> Vec<LagCase> {
    let mut cases = Vec::new();
    let mut add = |name: &str, domain: &Domain, sets: &[RawPoints], bins: usize, lag_max: Option<f64>| {
        let ensemble = ensemble_in(domain, sets);
        let plan = lag_plan(&ensemble, bins, lag_max, Correction::None);
        cases.push(LagCase { name: format!("{name}, {bins} bins, {}D", domain.dim()), ensemble, plan });
    };
    for dim in 1..=3 {
        let unit = Domain::unit_torus(dim);
        let k = (size as f64).powf(1.0 / dim as f64).round() as usize;
        for bins in [1, 2, 7, 16, 25] {
            add("uniform", &unit, &[uniform(dim, size, 1)], bins, None);
            add("uniform, short range", &unit, &[uniform(dim, size, 2)], bins, Some(0.07));
            add("dyadic lattice, lags on edges", &unit, &[lattice(dim, 8)], bins, None);
            add("dyadic lattice, lags on the last edge", &unit, &[lattice(dim, 8)], bins, Some(0.25));
        }
        add("lattice", &unit, &[lattice(dim, k), clustered(dim, size / 2, 3)], k.clamp(2, 60), None);
        add("coincident", &unit, &[coincident(dim, size.min(200))], 6, None);
        add("n = 0, 1, 2, 3 and more", &unit, &[0, 1, 2, 3, 40, 7].map(|n| uniform(dim, n, 40 + n as u64)), 9, None);
        let close = raw(dim, [vec![0.5; dim], vec![0.5 + 1e-9; dim], vec![0.5 - 3e-9; dim], vec![0.0; dim]].concat());
        for h in [1e-8, 1e-9, 1e-12, 2f64.powi(-66), 1e-300] {
            add("hopeless for f32", &unit, &[close.clone(), clustered(dim, size / 4, 4)], 12, Some(h));
        }
        let torus = Domain::torus(&[2.5, 1.0, 0.7][..dim]).unwrap();
        for (bins, lag_max) in [(10, None), (11, None), (8, Some(0.35)), (8, Some(0.349_999_999_9)), (5, Some(0.1))] {
            add("unequal sides", &torus, &[uniform(dim, size / 2, 7), lattice(dim, 8)], bins, lag_max);
        }
        let ranges: Vec<(f64, f64)> = (0..dim).map(|a| (-1.0 - a as f64, 2.0 + a as f64)).collect();
        let window = Domain::window(&ranges).unwrap();
        // The lattice has points on both ends of the closed sides.
        let closed = raw(dim, lattice(dim, 5).coordinates.iter().map(|x| x * 5.0 / 4.0).collect());
        for (bins, lag_max) in [(8, None), (9, None), (6, Some(1.5)), (5, Some(3.0))] {
            add("window", &window, &[uniform(dim, size / 2, 9), closed.clone()], bins, lag_max);
        }
    }
    add("narrow torus", &Domain::torus(&[1.0, 1e-5]).unwrap(), &[uniform(2, size, 1), lattice(2, 8)], 12, None);
    add("a third", &Domain::torus(&[1.0, 1.0 / 3.0]).unwrap(), &[uniform(2, size, 1), lattice(2, 9)], 18, None);
    add("many bins", &Domain::unit_torus(1), &[uniform(1, size, 2), lattice(1, 64)], 65_536, None);
    add("many cells", &Domain::unit_torus(2), &[uniform(2, size, 2), lattice(2, 8)], 200, None);
    cases
}

/// The reference's lag counts for a plan.
pub fn reference_lags(plan: &LagPlan, ensemble: &Ensemble) -> LagCounts {
    wait(Reference.lag_counts(plan, ensemble, &Control::default())).unwrap()
}

/// Equal integers from different backends, or what differs.
pub fn lags_agree(a: &LagCounts, b: &LagCounts) -> Result<(), String> {
    if a.computed_by.backends == b.computed_by.backends {
        return Err(format!("both sides were computed by {:?}: that compares nothing", a.computed_by.backends));
    }
    if a.realizations != b.realizations || a.cells.norms != b.cells.norms {
        return Err(format!("different realizations: {} and {}", a.realizations, b.realizations));
    }
    let (x, y) = (&a.cells.sums, &b.cells.sums);
    if let Some(cell) = (0..x.len().max(y.len())).find(|&k| x.get(k) != y.get(k)) {
        return Err(format!("cell {cell}: {:?} against {:?} pairs", x.get(cell), y.get(cell)));
    }
    if a.cells != b.cells || a.sectors != b.sectors {
        return Err("the moments or the sectors differ".into());
    }
    Ok(())
}

/// Asserts `lags_agree`.
pub fn assert_lags_equal(name: &str, a: &LagCounts, b: &LagCounts) {
    if let Err(why) = lags_agree(a, b) {
        panic!("{name}: {why}");
    }
}

/// Every edge correction in windows whose points touch sides and corners, up to the longest distances that the GPU takes.
/// `size` scales the point counts.
pub fn corrected_cases(size: usize) -> Vec<PairCase> {
    let mut cases = Vec::new();
    for (dim, correction) in (1..=3)
        .flat_map(|dim| [Correction::Translation, Correction::Isotropic, Correction::Border].map(|c| (dim, c)))
        .filter(|case| *case != (3, Correction::Isotropic))
    {
        let k = (size as f64).powf(1.0 / dim as f64).round() as usize;
        let window = Domain::window(&[(-1.0, 2.0), (0.5, 1.75), (10.0, 12.2)][..dim]).unwrap();
        let strip = Domain::window(&[(0.0, 1.0), (0.0, 300.0), (0.0, 20.0)][..dim]).unwrap();
        // The lattice has points on both ends of the closed window's sides, and circles that touch them.
        let closed = raw(dim, lattice(dim, k).coordinates.iter().map(|x| x * k as f64 / (k - 1) as f64).collect());
        let sets = [uniform(dim, size, 1), closed, clustered(dim, size / 2, 2), uniform(dim, 1, 3), uniform(dim, 0, 4)];
        for (name, window) in [("window", &window), ("strip", &strip)] {
            let side = window.shortest_side();
            let r = match correction {
                Correction::Isotropic => (0.99 * window.half_diagonal()).min(1.2 * side),
                Correction::Border => 0.49 * side,
                _ => 0.9 * side,
            };
            let others = match name {
                "window" => ("log", RadialBins::logarithmic(1e-3 * r, r, 30).unwrap()),
                _ => ("tiny", RadialBins::linear(1e-7 * side, 9).unwrap()),
            };
            for (scale, bins) in [("linear", RadialBins::linear(r, 70).unwrap()), others] {
                let ensemble = ensemble_in(window, &sets);
                let settings = PairSettings { cumulative: true, ..correction.into() };
                let plan = PairPlan::new(window, bins, settings, shape(&ensemble)).unwrap();
                cases.push(PairCase { name: format!("{correction}, {name}, {scale}, {dim}D"), ensemble, plan });
            }
        }
    }
    cases
}

/// The reference's counts for a plan.
pub fn reference_counts(plan: &PairPlan, ensemble: &Ensemble) -> PairCounts {
    wait(Reference.pair_counts(plan, ensemble, &Control::default())).unwrap()
}

/// The reference's powers for a plan.
pub fn reference_power(plan: &WavePlan, ensemble: &Ensemble) -> WavePower {
    wait(Reference.wave_power(plan, ensemble, &Control::default())).unwrap()
}

/// Equal integers from different backends, or what differs.
pub fn counts_agree(a: &PairCounts, b: &PairCounts) -> Result<(), String> {
    if a.computed_by.backends == b.computed_by.backends {
        return Err(format!("both sides were computed by {:?}: that compares nothing", a.computed_by.backends));
    }
    if a.realizations != b.realizations || a.bins.norms != b.bins.norms {
        return Err(format!("different realizations: {} and {}", a.realizations, b.realizations));
    }
    if let Some(bin) = (0..a.counts.len().max(b.counts.len())).find(|&k| a.counts.get(k) != b.counts.get(k)) {
        return Err(format!("bin {bin}: {:?} against {:?} pairs", a.counts.get(bin), b.counts.get(bin)));
    }
    if a.bins.sums != b.bins.sums {
        return Err("the weight sums differ".into());
    }
    if a.bins != b.bins || a.cumulative != b.cumulative {
        return Err("the moments differ".into());
    }
    Ok(())
}

/// The largest relative error of the sums of weights of `a`, in bins and cumulative; or why they cannot be compared, or that
/// counts beside them differ.
pub fn weight_error(a: &PairCounts, reference: &PairCounts) -> Result<f64, String> {
    let unweighted = |counts: &PairCounts| PairCounts {
        bins: pairwave::accumulate::Ratios {
            sums: Vec::new(),
            squares: Vec::new(),
            products: Vec::new(),
            ..counts.bins.clone()
        },
        cumulative: None,
        ..counts.clone()
    };
    counts_agree(&unweighted(a), &unweighted(reference))?;
    let sums = |counts: &PairCounts| {
        let cumulative = counts.cumulative.iter().flat_map(|c| c.sums.clone());
        counts.bins.sums.iter().copied().chain(cumulative).collect::<Vec<_>>()
    };
    let (a, b) = (sums(a), sums(reference));
    if a.len() != b.len() {
        return Err(format!("{} sums against {}", a.len(), b.len()));
    }
    let errors = a.iter().zip(&b).map(|(&a, &b)| if a == b { 0.0 } else { a.abs_diff(b) as f64 / b as f64 });
    Ok(errors.fold(0.0, f64::max))
}

/// Asserts that sums of weights keep `GPU_WEIGHT_BOUND`, and returns how close they came.
pub fn assert_weights_within(name: &str, a: &PairCounts, reference: &PairCounts) -> f64 {
    let error = weight_error(a, reference).unwrap_or_else(|why| panic!("{name}: {why}"));
    println!("{name}: {error:.1e}");
    assert!(error <= GPU_WEIGHT_BOUND, "{name}: weights are off by {error:.1e}");
    error
}

/// Asserts `counts_agree`.
pub fn assert_counts_equal(name: &str, a: &PairCounts, b: &PairCounts) {
    if let Err(why) = counts_agree(a, b) {
        panic!("{name}: {why}");
    }
}

/// How close two power spectra are.
#[derive(Debug, Clone, Copy)]
pub struct PowerError {
    /// `max |P - P_ref| / (1 + P_ref)`.
    pub max: f64,
    /// Root mean square of `P - P_ref`.
    pub rms: f64,
}

/// The error of `a` against `reference`, or why they cannot be compared. DC, an exact n, is part of it.
pub fn power_error(a: &WavePower, reference: &WavePower) -> Result<PowerError, String> {
    if a.computed_by.backends == reference.computed_by.backends {
        return Err(format!("both sides were computed by {:?}: that compares nothing", a.computed_by.backends));
    }
    if (a.realizations, a.norm_totals(), a.modes())
        != (reference.realizations, reference.norm_totals(), reference.modes())
    {
        return Err("different realizations or modes".into());
    }
    let n = reference.norm_totals()[0];
    let (p, p_ref) = (a.mode_totals().q, reference.mode_totals().q);
    let (mut max, mut squares) = (0f64, 0.0);
    for (p, r) in p.iter().zip(&p_ref) {
        let (p, r) = (p / n, r / n);
        let error = (p - r).abs() / (1.0 + r);
        // Written so that NaN fails.
        if !(error.is_finite()) {
            return Err(format!("P = {p} where the reference has {r}"));
        }
        max = max.max(error);
        squares += (p - r).powi(2);
    }
    Ok(PowerError { max, rms: (squares / p.len() as f64).sqrt() })
}

/// Whether the sums behind a covariance of amplitudes are those of the reference up to rounding.
pub fn covariances_agree(a: &WaveCovariance, reference: &WaveCovariance) -> Result<(), String> {
    if a.computed_by.backends == reference.computed_by.backends {
        return Err(format!("both sides were computed by {:?}: that compares nothing", a.computed_by.backends));
    }
    let (sums, truth) = (a.totals(), reference.totals());
    if (a.realizations, sums.stored) != (reference.realizations, truth.stored) {
        return Err("different realizations or modes".into());
    }
    for (name, a, b) in [
        ("products", &sums.products[..], &truth.products[..]),
        ("products with norms", &sums.products_n, &truth.products_n),
        ("powers", &sums.powers, &truth.powers),
        ("norms", &sums.norms, &truth.norms),
    ] {
        let top = b.iter().fold(1.0, |t: f64, x| t.max(x.abs()));
        // Written so that NaN fails.
        let near = |k: usize| (a[k] - b[k]).abs() <= 1e-12 * top;
        if a.len() != b.len() {
            return Err(format!("{name}: {} values, not {}", a.len(), b.len()));
        }
        if let Some(k) = (0..a.len()).find(|&k| !near(k)) {
            return Err(format!("{name}: {} at {k}, not {}", a[k], b[k]));
        }
    }
    Ok(())
}

/// Asserts the promise of an accuracy level and prints the clearance.
pub fn assert_power_within(name: &str, accuracy: Accuracy, a: &WavePower, reference: &WavePower) -> PowerError {
    let bound = accuracy.power_bound();
    let n = reference.norm_totals()[0] / reference.realizations as f64;
    let error = power_error(a, reference).unwrap_or_else(|why| panic!("{name}: {why}"));
    println!("{name}: max {:.1e} (clearance {:.1}), rms {:.1e}", error.max, bound.max_any(n) / error.max, error.rms);
    assert!(error.max <= bound.max_any(n), "{name}: {error:?} exceeds {bound:?}");
    error
}

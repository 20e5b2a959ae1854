//! Throughput of the native path on one thread, next to the multiply-add rate of the same core in the same process, and of
//! the GPU if there is one. Rates are per second of processor time where the system tells it (software GPUs too, but
//! hardware ones by the clock on the wall), so that other load hardly matters; each is the best of several repetitions,
//! and the calibrator runs between them.

mod common;
mod naive;

use pairwave::compute::cpu::{Cpu, SimdLevel, fma_gflop};
use pairwave::compute::gpu::{AdapterChoice, GpuCompute};
use pairwave::compute::{Compute, Work};
use pairwave::control::Control;
use pairwave::plan::{Accuracy, Correction, LagGrid, LagPlan, PairPlan, RadialBins, WaveGrid, WaveMethod, WavePlan};
use pairwave::points::Ensemble;

use common::{Clock, uniform, wait};
use naive::Naive;

const REPETITIONS: usize = 5;

fn main() {
    let levels = [SimdLevel::Portable, SimdLevel::Avx2, SimdLevel::Avx512];
    // All pools live to the end: a thread that ends takes its processor time along, and the clock would run backwards.
    let cpus: Vec<Cpu> = levels
        .into_iter()
        .filter(|&level| level <= SimdLevel::detect())
        .filter_map(|level| Cpu::with_level(Some(1), level).ok())
        .collect();
    // The best first; its limit is the machine's.
    for cpu in cpus.iter().rev() {
        table(cpu, true);
    }
    match wait(GpuCompute::open(AdapterChoice::Any)) {
        Ok(gpu) => {
            let summary = gpu.gpu().summary().clone();
            table(&gpu, summary.software);
            naive_pairs(&gpu, summary.index, summary.software);
            naive_spectrum(&gpu, summary.index, summary.software);
        }
        Err(why) => println!("\nGPU not measured: {why}"),
    }
}

fn table(device: &dyn Compute, by_processor: bool) {
    let level = SimdLevel::detect();
    let per = if by_processor { "per second of processor time" } else { "per second" };
    println!("\n{}, {per}", device.computed_by().device());
    println!("{:<52} {:>10} {:>12} {:>12}", "", "rate", "unit", "per GFLOP/s");
    let mut limit = calibrate(level);
    for (dim, bins) in [(2, 256), (2, 1024), (3, 256)] {
        let n = 10_000;
        let (ensemble, shape) = uniform(dim, n, 1);
        let name = |what: &str| format!("pairs {dim}D, n = {n}, r < 0.5, {bins} {what}bins");
        // Edges that are given, here of equal areas.
        let edge = |k: usize| 0.5 * (k as f64 / bins as f64).sqrt();
        for (what, bins) in [
            ("", RadialBins::linear(0.5, bins)),
            ("logarithmic ", RadialBins::logarithmic(1e-3, 0.5, bins)),
            ("given ", RadialBins::from_edges((0..=bins).map(edge).collect())),
        ] {
            let Ok(bins) = bins else { continue };
            if !wanted(&name(what)) {
                continue;
            }
            let Ok(plan) = PairPlan::new(ensemble.domain(), bins, Correction::None, shape) else { continue };
            let rate = best(level, &mut limit, by_processor, plan.pairs() * 1e-9, || {
                let counts = wait(device.pair_counts(&plan, &ensemble, &Control::default()));
                assert!(counts.is_ok());
            });
            print(&name(what), rate, "Gpair/s", limit);
        }
    }
    for (dim, bins, lag_max) in [(2, 64, 0.5), (2, 256, 0.5), (2, 64, 0.05), (3, 64, 0.5)] {
        let n = 10_000;
        let name = format!("lags {dim}D, n = {n}, |h| < {lag_max}, {bins}^{dim} cells");
        let (ensemble, shape) = uniform(dim, n, 1);
        let Ok(grid) = LagGrid::new(ensemble.domain(), bins, Some(lag_max)) else { continue };
        let Ok(plan) = LagPlan::new(ensemble.domain(), grid, Correction::None, None, shape) else {
            continue;
        };
        if !wanted(&name) {
            continue;
        }
        let rate = best(level, &mut limit, by_processor, plan.pairs() * 1e-9, || {
            assert!(wait(device.lag_counts(&plan, &ensemble, &Control::default())).is_ok());
        });
        print(&name, rate, "Gpair/s", limit);
    }
    // Cells: what all pairs would take against what is taken, the sort included.
    for (dim, r) in [(2, 0.02), (2, 0.05), (2, 0.1), (3, 0.02), (3, 0.05), (3, 0.1)] {
        let (n, bins) = (100_000, 256);
        let name = format!("pairs {dim}D, n = {n}, r < {r}, {bins} bins, cells");
        if !wanted(&name) {
            continue;
        }
        let (ensemble, shape) = uniform(dim, n, 1);
        let Ok(bins) = RadialBins::linear(r, bins) else { continue };
        let Ok(plan) = PairPlan::new(ensemble.domain(), bins, Correction::None, shape) else { continue };
        let rate = best(level, &mut limit, by_processor, plan.pairs() * 1e-9, || {
            assert!(wait(device.pair_counts(&plan, &ensemble, &Control::default())).is_ok());
        });
        print(&name, rate, "Gpair/s", limit);
    }
    for (accuracy, n, k, m) in [
        (Accuracy::Fast, 1024, 16, 64),
        (Accuracy::Fast, 65_536, 1, 64),
        (Accuracy::Fast, 16_384, 1, 256),
        (Accuracy::Fast, 4096, 1, 512),
        (Accuracy::Fast, 65_536, 1, 256),
        (Accuracy::Fast, 4096, 1000, 64),
        (Accuracy::Fast, 4096, 1, 127),
        (Accuracy::High, 16_384, 1, 64),
        (Accuracy::High, 8192, 1, 256),
    ] {
        // The last two are sizes for hardware.
        if by_processor && n * k * m * m > 1 << 31 {
            continue;
        }
        let method = if accuracy == Accuracy::Fast { WaveMethod::DirectF32 } else { WaveMethod::DirectF64 };
        let name = format!("spectrum 2D {}, {k} x n = {n}, M = {m}", method.name());
        if !wanted(&name) {
            continue;
        }
        let (ensemble, shape) = uniform(2, n, k);
        let Ok(grid) = WaveGrid::new(&[m as u32, m as u32]) else { continue };
        let Ok(plan) = WavePlan::new(ensemble.domain(), grid, accuracy, shape) else { continue };
        // What a transform takes is no matter of multiply-adds.
        let plan = WavePlan { method: Some(method), ..plan };
        let gflop = gflop(n * k, m);
        if device.supports(Work::Waves(&plan)).is_err() {
            continue;
        }
        let rate = best(level, &mut limit, by_processor, gflop, || {
            assert!(wait(device.wave_power(&plan, &ensemble, &Control::default())).is_ok());
        });
        print(&name, rate, "GFLOP/s", limit);
    }
    println!("{:<52} {limit:>10.2} {:>12}", "f32 multiply-add limit", "GFLOP/s");
}

fn gflop(points: usize, m: usize) -> f64 {
    8.0 * points as f64 * (m + 1).pow(2) as f64 * 1e-9
}

/// The points of the first realization in f32.
fn rounded(ensemble: &Ensemble, n: usize) -> Vec<[f32; 2]> {
    let fraction = |axis: usize, j: usize| (ensemble.all_fractions(axis)[j] >> 40) as f32 / (1 << 24) as f32;
    (0..n).map(|j| [fraction(0, j), fraction(1, j)]).collect()
}

/// Exact counts by tiles against a histogram in global memory, on the same device and points.
fn naive_pairs(gpu: &GpuCompute, adapter: usize, by_processor: bool) {
    let (n, bins) = (if by_processor { 10_000 } else { 1_000_000 }, 256);
    let name = format!("pairs 2D naive, n = {n}, r < 0.5, {bins} bins");
    if !wanted(&name) {
        return;
    }
    let (ensemble, shape) = uniform(2, n, 1);
    let Ok(edges) = RadialBins::linear(0.5, bins) else { return };
    let Ok(plan) = PairPlan::new(ensemble.domain(), edges, Correction::None, shape) else { return };
    let size = [n as u32, bins as u32];
    let Ok(naive) = Naive::new(adapter, naive::PAIRS, &rounded(&ensemble, n), bins as u32, size) else { return };
    // Both count the same pairs, but for those next to an edge.
    let (Ok(theirs), Ok(ours)) = (naive.run::<u32>(), wait(gpu.pair_counts(&plan, &ensemble, &Control::default())))
    else {
        return;
    };
    let moved: u64 = theirs.iter().zip(&ours.counts).map(|(a, b)| (2 * u64::from(*a)).abs_diff(*b)).sum();
    assert!(moved as f64 <= 2e-4 * plan.pairs(), "{moved} pairs in other bins");
    let (level, mut limit) = (SimdLevel::detect(), 0.0);
    let amount = plan.pairs() * 1e-9;
    let slow = best(level, &mut limit, by_processor, amount, || assert!(naive.run::<u32>().is_ok()));
    let fast = best(level, &mut limit, by_processor, amount, || {
        assert!(wait(gpu.pair_counts(&plan, &ensemble, &Control::default())).is_ok());
    });
    print(&name, slow, "Gpair/s", limit);
    println!("exact counts by tiles take {:.2} times as long as distances in f32 into one histogram", slow / fast);
}

/// A sine and a cosine per term against the product, on the same device and points.
fn naive_spectrum(gpu: &GpuCompute, adapter: usize, by_processor: bool) {
    let (n, m) = if by_processor { (4096, 64) } else { (65_536, 256) };
    let name = format!("spectrum 2D naive, 1 x n = {n}, M = {m}");
    if !wanted(&name) {
        return;
    }
    let (ensemble, shape) = uniform(2, n, 1);
    let Ok(grid) = WaveGrid::new(&[m as u32, m as u32]) else { return };
    let Ok(plan) = WavePlan::new(ensemble.domain(), grid, Accuracy::Fast, shape) else { return };
    let modes = ((m + 1) * (2 * m + 1)) as u32;
    let points = rounded(&ensemble, n);
    let Ok(naive) = Naive::new(adapter, naive::SPECTRUM, &points, m as u32, [modes; 2]) else { return };
    // Both compute the same thing.
    let (Ok(theirs), Ok(ours)) = (naive.run::<f32>(), wait(gpu.wave_power(&plan, &ensemble, &Control::default())))
    else {
        return;
    };
    for (a, b) in theirs.iter().zip(ours.mode_totals().q) {
        assert!((f64::from(*a) - b).abs() <= 1e-2 * (n as f64 + b), "{a} against {b}");
    }
    let (level, mut limit) = (SimdLevel::detect(), 0.0);
    let slow = best(level, &mut limit, by_processor, gflop(n, m), || assert!(naive.run::<f32>().is_ok()));
    let fast = best(level, &mut limit, by_processor, gflop(n, m), || {
        assert!(wait(gpu.wave_power(&plan, &ensemble, &Control::default())).is_ok());
    });
    print(&name, slow, "GFLOP/s", limit);
    println!("the product is {:.1} times as fast as a sine and a cosine per term", fast / slow);
}

/// `cargo bench --bench throughput -- WORD...` keeps the rows that contain every word.
fn wanted(name: &str) -> bool {
    std::env::args().skip(1).filter(|a| !a.starts_with('-')).all(|word| name.contains(&word))
}

fn print(name: &str, rate: f64, unit: &str, limit: f64) {
    println!("{name:<52} {rate:>10.3} {unit:>12} {:>12.4}", rate / limit);
}

/// The best rate in `amount` per second.
fn best(level: SimdLevel, limit: &mut f64, by_processor: bool, amount: f64, work: impl Fn()) -> f64 {
    let mut best = 0.0;
    for _ in 0..REPETITIONS {
        // Long enough for the clock: at least 0.2 s.
        let (mut done, start) = (0.0, Clock::start(by_processor));
        while start.seconds() < 0.2 {
            work();
            done += amount;
        }
        best = f64::max(best, done / start.seconds());
        *limit = limit.max(calibrate(level));
    }
    best
}

/// GFLOP/s of f32 multiply-adds.
fn calibrate(level: SimdLevel) -> f64 {
    let (mut done, start) = (0.0, Clock::start(true));
    while start.seconds() < 0.05 {
        let (gflop, value) = fma_gflop(level, std::hint::black_box(1_000_000));
        std::hint::black_box(value);
        done += gflop;
    }
    done / start.seconds()
}

//! The nonuniform FFT on one thread, in milliseconds of processor time per realization: the best of many calls, sorting,
//! spreading and transforms included, the plan not.
//!
//! `cargo bench --bench nufft` prints a table; `cargo bench --bench nufft -- WORD...` the rows that contain every word.
//! `-- --points FILE --max-frequency F,F --tolerance E --out FILE` does one case: coordinates in [0, 1) as f64, point by
//! point, in; the powers of the stored modes as f64 out. `benches/peers/spectra.py` compares them with other programs'.

mod common;

use pairwave::compute::cpu::SimdLevel;
use pairwave::compute::cpu::nufft::{Nonuniform, Nufft, Scratch};
use pairwave::control::Control;
use pairwave::plan::WaveGrid;

use common::{Clock, uniform};

const REPETITIONS: usize = 8;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |flag: &str| words.iter().position(|w| w == flag).and_then(|at| words.get(at + 1));
    if let (Some(file), Some(f), Some(tolerance), Some(out)) =
        (value("--points"), value("--max-frequency"), value("--tolerance"), value("--out"))
    {
        let f: Vec<u32> = f.split(',').map(|f| f.parse().expect("a frequency")).collect();
        let bytes = std::fs::read(file).expect("the points");
        let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|&b| f64::from_ne_bytes(b)).collect();
        let axis = |a: usize| numbers.iter().skip(a).step_by(f.len()).map(|x| (x * 2f64.powi(64)) as u64).collect();
        let axes: Vec<Vec<u64>> = (0..f.len()).map(axis).collect();
        let axes: Vec<&[u64]> = axes.iter().map(Vec::as_slice).collect();
        let (ms, power) = measured(&axes, &f, tolerance.parse().expect("a tolerance"));
        let bytes: Vec<u8> = power.iter().flat_map(|p| p.to_ne_bytes()).collect();
        std::fs::write(out, bytes).expect("the powers");
        println!("{ms}");
        return;
    }
    println!("{:<52} {:>10} {:>14}", "", "ms", "Mpoints/s");
    for (n, f) in [
        (4096, vec![256, 256]),
        (65_536, vec![256, 256]),
        (1_000_000, vec![512, 512]),
        (65_536, vec![65_536]),
        (65_536, vec![40, 40, 40]),
        (1_000_000, vec![40, 40, 40]),
    ] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let name = format!("{}D, n = {n}, |m| <= {}, tolerance {tolerance:e}", f.len(), f[0]);
            if words.iter().all(|word| name.contains(word)) {
                let (ensemble, _) = uniform(f.len(), n, 1);
                let (ms, _) = measured(&ensemble.fractions(0), &f, tolerance);
                println!("{name:<52} {ms:>10.2} {:>14.2}", n as f64 * 1e-3 / ms);
            }
        }
    }
}

/// The least time of a call, in milliseconds, and its powers.
fn measured(axes: &[&[u64]], f: &[u32], tolerance: f64) -> (f64, Vec<f64>) {
    let grid = WaveGrid::new(f).expect("a grid");
    let nufft = Nufft::new(&grid, tolerance, axes[0].len() as f64, SimdLevel::detect()).expect("a plan");
    let points = Nonuniform { axes, weights: None };
    let (mut scratch, mut power) = (Scratch::default(), vec![0.0; grid.half_len()]);
    let mut best = f64::INFINITY;
    for _ in 0..REPETITIONS {
        // Long enough for the clock.
        let (clock, mut calls, mut seconds) = (Clock::start(true), 0.0, 0.0);
        while seconds < 0.1 {
            nufft.power(&points, &mut scratch, None, &Control::default(), &mut power).expect("powers");
            calls += 1.0;
            seconds = clock.seconds();
        }
        best = best.min(1e3 * seconds / calls);
    }
    (best, power)
}

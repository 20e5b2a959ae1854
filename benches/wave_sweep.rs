//! Whether plans of spectra choose well: every method of a sweep of plans is run, and the chosen one compared with the
//! fastest. A case of less than 0.3 ms in all is shown, but does not count. Processor time of one thread, the best of
//! several repetitions in turns. `-- all` prints every method with its estimate.

mod common;

use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::control::Control;
use pairwave::plan::{Accuracy, WaveGrid, WavePlan};

use common::{Clock, uniform, wait};

fn main() {
    let Ok(cpu) = Cpu::new(Some(1)) else { return };
    println!("{}; milliseconds per realization", cpu.computed_by().device());
    let verbose = std::env::args().any(|a| a == "all");
    let (mut worst, mut cases) = (1.0f64, 0);
    for (dim, n, k) in [
        (2, 60, 64),
        (2, 256, 16),
        (2, 1024, 4),
        (2, 4096, 1),
        (2, 4096, 4),
        (2, 65_536, 1),
        (2, 500_000, 1),
        (1, 256, 16),
        (1, 4096, 1),
        (1, 65_536, 1),
        (3, 256, 4),
        (3, 4096, 1),
        (3, 65_536, 1),
    ] {
        let (ensemble, shape) = uniform(dim, n, k);
        let frequencies: &[u32] = match dim {
            1 => &[32, 256, 2048, 16_384],
            2 => &[8, 24, 64, 100, 128, 256, 512],
            _ => &[4, 8, 16, 32],
        };
        for &f in frequencies {
            for accuracy in [Accuracy::Fast, Accuracy::High] {
                let Ok(grid) = WaveGrid::new(&vec![f; dim]) else { continue };
                let Ok(plan) = WavePlan::new(ensemble.domain(), grid, accuracy, shape) else { continue };
                let mut methods = plan.methods(n as f64);
                let least = methods.iter().map(|r| r.seconds).fold(f64::INFINITY, f64::min);
                // What is estimated to be many times slower is not the fastest; the sweep stays short.
                methods.retain(|r| r.seconds <= 4.0 * least);
                let mut times = vec![f64::INFINITY; methods.len()];
                // Long enough for the clock, which is a few milliseconds late.
                let runs = (0.02 / (least * k as f64)).clamp(1.0, 1000.0) as u32;
                for _ in 0..4 {
                    for (time, estimate) in times.iter_mut().zip(&methods) {
                        let plan = WavePlan { method: Some(estimate.method), ..plan.clone() };
                        let clock = Clock::start(true);
                        for _ in 0..runs {
                            assert!(wait(cpu.wave_power(&plan, &ensemble, &Control::default())).is_ok());
                        }
                        *time = time.min(clock.seconds() / f64::from(runs) / k as f64);
                    }
                }
                let method = plan.method(n);
                let chosen = methods.iter().position(|r| r.method == method).map_or(f64::NAN, |c| times[c]);
                let best = times.iter().copied().fold(f64::INFINITY, f64::min);
                println!(
                    "{dim}D n = {n} x {k}, F = {f}, {}: {:.4} {}, ratio {:.3}",
                    accuracy.name(),
                    1e3 * chosen,
                    method.name(),
                    chosen / best
                );
                if verbose {
                    for (estimate, time) in methods.iter().zip(&times) {
                        println!(
                            "    {:<12} {:9.4} ({:.4})",
                            estimate.method.name(),
                            1e3 * time,
                            1e3 * estimate.seconds
                        );
                    }
                }
                if best * k as f64 >= 3e-4 {
                    worst = worst.max(chosen / best);
                    cases += 1;
                }
            }
        }
    }
    println!("worst ratio of chosen to best over {cases} cases: {worst:.3}");
}

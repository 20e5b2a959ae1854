//! Whether plans choose well: every search of a sweep of plans is run, and the chosen one compared with the fastest.
//! Processor time of one thread, the best of several repetitions in turns.

mod common;

use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::control::Control;
use pairwave::plan::{Correction, PairPlan, RadialBins, SearchCosts};

use common::{Clock, uniform, wait};

fn main() {
    let Ok(cpu) = Cpu::new(Some(1)) else { return };
    println!("{}; milliseconds per search, (estimate)", cpu.computed_by().device());
    let verbose = std::env::args().any(|a| a == "all");
    let (mut worst, mut cases) = (1.0f64, 0);
    for (dim, n, k) in [
        (2, 300, 40),
        (2, 1000, 20),
        (2, 10_000, 1),
        (2, 100_000, 1),
        (3, 300, 40),
        (3, 1000, 20),
        (3, 10_000, 1),
        (3, 100_000, 1),
        (1, 3000, 4),
    ] {
        let (ensemble, shape) = uniform(dim, n, k);
        for r in [0.002, 0.02, 0.05, 0.1, 0.2, 0.3, 0.45] {
            for bins in [32, 256, 2000] {
                // Some seconds a search are no longer a sweep.
                if n > 10_000 && (r > 0.1 || bins != 256) {
                    continue;
                }
                let Ok(bins) = RadialBins::linear(r, bins) else { continue };
                let Ok(plan) = PairPlan::new(ensemble.domain(), bins, Correction::None, shape) else { continue };
                let mut searches = plan.searches(&SearchCosts::CPU);
                let least = searches.iter().map(|s| s.seconds).fold(f64::INFINITY, f64::min);
                // What is estimated to be many times slower is not the fastest; the sweep stays short.
                searches.retain(|s| s.seconds <= 5.0 * least);
                let mut times = vec![f64::INFINITY; searches.len()];
                // Long enough for the clock, which is a few milliseconds late.
                let runs = (0.02 / (least * k as f64)).clamp(1.0, 1000.0) as u32;
                for _ in 0..5 {
                    for (time, estimate) in times.iter_mut().zip(&searches) {
                        let plan = PairPlan { search: estimate.search, ..plan.clone() };
                        let clock = Clock::start(true);
                        for _ in 0..runs {
                            assert!(wait(cpu.pair_counts(&plan, &ensemble, &Control::default())).is_ok());
                        }
                        *time = time.min(clock.seconds() / f64::from(runs));
                    }
                }
                let chosen = searches.iter().position(|s| s.search == plan.search).map_or(f64::NAN, |c| times[c]);
                let best = times.iter().copied().fold(f64::INFINITY, f64::min);
                let fastest = times.iter().position(|&t| t == best).map_or(plan.search, |b| searches[b].search);
                println!(
                    "{dim}D n = {n} x {k}, r < {r}, {} bins: {:.3} {}; best {:.3} {fastest}; ratio {:.3}",
                    plan.bins.len(),
                    1e3 * chosen,
                    plan.search,
                    1e3 * best,
                    chosen / best
                );
                if verbose {
                    for (estimate, time) in searches.iter().zip(&times) {
                        let ms = 1e3 * k as f64 * estimate.seconds;
                        println!("    {:<40} {:9.3} ({ms:.3})", estimate.search.to_string(), 1e3 * time);
                    }
                }
                worst = worst.max(chosen / best);
                cases += 1;
            }
        }
    }
    println!("worst ratio of chosen to best over {cases} cases: {worst:.3}");
}

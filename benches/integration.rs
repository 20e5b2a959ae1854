//! Where the time of integration errors goes: milliseconds of one thread per realization of jittered points in the plane, eight integrands,
//! both predictions, as is and at 16 shifts; then what it takes without one of them. `cargo bench --bench integration [n...]` (1024);
//! `benches/peers/integration.py` does the same in numpy.

mod common;

use pairwave::Memory;
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::control::Control;
use pairwave::plan::{Accuracy, IntegrationPlan, IntegrationSettings, Spatial};
use pairwave::samplers::Process;

use common::{Clock, wait};

const INTEGRANDS: [&str; 8] = ["disk", "box", "half-plane", "gaussian", "ramp", "cosine:x=2", "checker", "bump"];

fn main() -> pairwave::Result<()> {
    let given: Vec<u64> = std::env::args().skip(1).filter_map(|n| n.parse().ok()).collect();
    let specs: Vec<String> = INTEGRANDS.iter().map(ToString::to_string).collect();
    let cpu = Cpu::new(Some(1))?;
    let control = Control::default();
    for n in if given.is_empty() { vec![1024] } else { given } {
        let k = (400_000 / n).clamp(16, 400) / 16 * 16;
        let points = Process::new("jittered", n, k, 2, 1, &[])?.ensemble(0..k, &control)?;
        let shape = points.shape();
        let time = |spatial: Option<Spatial>, shifts: u32, f: Option<&[u32]>| -> pairwave::Result<f64> {
            let settings = IntegrationSettings {
                integrands: &specs,
                estimator: None,
                shifts,
                spatial,
                top: None,
                intensity: None,
                by: None,
                weighted: false,
                max_frequency: f,
                low_frequency: None,
                accuracy: Accuracy::Fast,
                memory: Memory(1 << 30),
                equal: true,
            };
            let plan = IntegrationPlan::new(points.domain(), settings, shape)?;
            let mut best = f64::INFINITY;
            for _ in 0..5 {
                let clock = Clock::start(true);
                wait(cpu.integration(&plan, &points, &control))?;
                best = best.min(clock.seconds());
            }
            Ok(best * 1e3 / k as f64)
        };
        let deposit = Some(Spatial::Deposit);
        let all = time(deposit, 16, None)?;
        let pairs = all - time(Some(Spatial::None), 16, None)?;
        let shifts = (all - time(deposit, 1, None)?) * 16.0 / 15.0;
        let grid = all - time(deposit, 16, Some(&[1]))?;
        println!(
            "n = {n}, {k} realizations of jittered points, 8 integrands: {all:.3} ms each, {:.0} realizations/s",
            1e3 / all
        );
        for (what, part) in [
            ("power on the grid, and its products with |f_m|^2", grid),
            ("pairs deposited on lags, and their products with a - I^2", pairs),
            ("16 shifts", shifts),
            ("axes to 4 n, low frequencies, as is", all - grid - pairs - shifts),
        ] {
            println!("  {part:8.3} ms  {:4.0} %  {what}", 100.0 * part / all);
        }
    }
    Ok(())
}

//! P at wave vectors of one's own, by the expert's way: plan, compute, estimate.

use pairwave::compute::{Compute, cpu::Cpu};
use pairwave::control::Control;
use pairwave::estimate::PowerSpectrum;
use pairwave::plan::{Accuracy, WaveList, WavePlan};
use pairwave::samplers::Process;
use pairwave::{Domain, Result};

fn main() -> Result<()> {
    let control = Control::default();
    let points = Process::new("jittered", 1024, 50, 2, 1, &[])?.ensemble(0..50, &control)?;
    let vectors = vec![[1.0, 0.0, 0.0], [32.0, 0.0, 0.0], [32.0, 32.0, 0.0], [1_000_000.0, 1.0, 0.0]];
    let list = WaveList { dim: 2, vectors, mirrored: false };
    let plan = WavePlan::new(&Domain::unit_torus(2), list, Accuracy::High, points.shape())?;
    let sums = pairwave::control::wait(Cpu::new(None)?.wave_power(&plan, &points, &control))?;
    let spectrum = PowerSpectrum::new(&plan, &sums);
    for (k, p) in spectrum.p.iter().enumerate() {
        let [x, y, _] = plan.waves.vector(k);
        println!("P({x}, {y}) = {p:.4} ± {:.4}", spectrum.p_se[k]);
    }
    Ok(())
}

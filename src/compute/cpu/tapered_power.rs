//! Tapered spectra: every taper is a spectrum of weighted points.

use super::Cpu;
use super::wave_power::amplitudes;
use crate::accumulate::WavePower;
use crate::compute::Compute;
use crate::compute::reference::tapered_power::tapered_power as of_one;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{TaperPlan, WavePlan};
use crate::points::Ensemble;

/// One realization after the other, each by all threads.
pub(super) fn tapered_power(
    cpu: &Cpu,
    plan: &WavePlan,
    taper: &TaperPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<WavePower> {
    let mut sums = WavePower::new(cpu.computed_by(), plan.waves.len(), &plan.rings);
    for k in 0..ensemble.realizations() {
        let axes = ensemble.fractions(k);
        let power = of_one(taper, &plan.waves, &axes, ensemble.weights(k), |weights| {
            let mut out = vec![[0.0; 2]; plan.waves.len()];
            amplitudes(cpu, &plan.waves, &axes, Some(weights), &mut out, control)?;
            Ok(out)
        })?;
        sums.add(ensemble.first_index() + k as u64, ensemble.norm(k), &power, &plan.rings);
    }
    sums.close_leaf();
    Ok(sums)
}

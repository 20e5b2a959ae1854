//! Numbers that sum up a power spectrum. Definitions, ranges and sources: `docs/spectrum-scalars.md`.

use super::confidence::Band;
use super::low_frequency::LowFrequency;
use super::power_spectrum::{ratio_estimate, realizations};
use super::{BlueNoise, Diaphony, PowerSpectrum, RadialSpectrum};
use crate::accumulate::WavePower;
use crate::plan::WavePlan;

/// Scalars of P (`docs/spectrum-scalars.md`); each is `None` where it is not defined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumScalars {
    /// Effective Nyquist frequency and oscillations; 2D torus.
    pub blue_noise: Option<BlueNoise>,
    /// Hyperuniformity; torus.
    pub low_frequency: Option<LowFrequency>,
    /// The level of P at high frequency.
    pub high_frequency: Option<HighFrequency>,
    /// Diaphony; torus.
    pub diaphony: Option<Diaphony>,
}

/// Mean of P over the modes of the upper half of the rings, where that begins beyond one cycle per mean spacing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HighFrequency {
    /// The range of frequencies, in cycles per unit length.
    pub range: [f64; 2],
    /// The mean.
    pub p: f64,
    /// Its standard error: across realizations of their own means, or for K = 1 of independent exponential ordinates.
    pub p_se: f64,
    /// Its confidence band.
    pub band: Option<Band>,
}

impl SpectrumScalars {
    /// The numbers.
    pub fn new(plan: &WavePlan, power: &WavePower, spectrum: &PowerSpectrum, radial: &RadialSpectrum) -> Self {
        let density = plan.shape.mean_points / plan.domain.measure();
        let spacing = density.powf(1.0 / plan.domain.dim() as f64);
        let torus = plan.domain.is_torus();
        let high_frequency = high_frequency(plan, power, spacing);
        Self {
            blue_noise: BlueNoise::new(plan, spectrum, radial),
            low_frequency: LowFrequency::new(radial, spacing, realizations(power)).filter(|_| torus),
            // Where no ring is high, independent points stand in.
            diaphony: Diaphony::new(plan, spectrum, high_frequency.map_or(1.0, |h| h.p)),
            high_frequency,
        }
    }
}

fn high_frequency(plan: &WavePlan, power: &WavePower, spacing: f64) -> Option<HighFrequency> {
    let upper = plan.rings.upper();
    let range = [plan.rings.bounds.get(upper.start)?[0], plan.rings.bounds.last()?[2]];
    let total = |of: &[u64]| of[upper.clone()].iter().sum::<u64>() as f64;
    let (modes, independent) = (total(&plan.rings.modes), total(&plan.rings.independent) / plan.ring_variance());
    let (p, p_se) = ratio_estimate(power, &power.upper_totals(), |_| modes, |_| independent);
    let band = Band::new(p[0], p_se[0], realizations(power), independent);
    (range[0] >= spacing).then_some(HighFrequency { range, p: p[0], p_se: p_se[0], band })
}

//! Wave power -> power by direction.

use super::confidence::Band;
use super::power_spectrum::{ratio_estimate, realizations};
use super::{ErrorSource, RadialSpectrum};
use crate::accumulate::WavePower;
use crate::plan::WavePlan;

/// The power of one sector of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectorPower {
    /// First, central and last direction of `nu = m / L`, in radians from the x axis.
    pub theta: [f64; 3],
    /// Modes of whole rings in it, both of each mirror pair.
    pub modes: u64,
    /// Mean of P over them.
    pub p: f64,
    /// Its standard error: across realizations of the sector's own mean; for K = 1 `p` over the root of the independent
    /// ordinates, which where P varies over rings are `(sum P)^2 / sum P^2` (Welch 1947, Satterthwaite 1946), fewer for tapers
    /// (`TaperPlan::ring_variance`).
    pub p_se: f64,
    /// Its confidence band.
    pub band: Option<Band>,
    /// `p` over the mean of the ring means at the same modes: 1 for an isotropic spectrum, however steep.
    pub ratio: Option<f64>,
    /// Standard error of the ratio, that of the ring means left out.
    pub ratio_se: Option<f64>,
}

/// Angular power: mean of P over the modes of whole rings, by direction (2D; Ulichney, Digital Halftoning, 1987; Bartlett,
/// "The Spectral Analysis of Two-Dimensional Point Processes", 1964).
#[derive(Debug, Clone, PartialEq)]
pub struct AngularSpectrum {
    /// The sectors that hold modes, over half a turn.
    pub sectors: Vec<SectorPower>,
    /// Where errors come from.
    pub errors: ErrorSource,
}

impl AngularSpectrum {
    /// The estimate. Without sectors in the plan, or modes in them, there is nothing.
    pub fn new(plan: &WavePlan, power: &WavePower, radial: &RadialSpectrum) -> Option<Self> {
        let sectors = &plan.rings.sectors;
        // Per sector, what the ring means sum to, and their squares.
        let mut predicted = vec![[0.0; 2]; sectors.count];
        for (index, &sector) in sectors.sector_of.iter().enumerate().filter(|(_, s)| **s > 0) {
            let p = radial.rings[plan.rings.ring_of[index] as usize - 1].p;
            let times = f64::from(plan.rings.times[index]);
            let [sum, squares] = &mut predicted[sector as usize - 1];
            *sum += times * p;
            *squares += times * p * p;
        }
        let independent = |s: usize| {
            let [sum, squares] = predicted[s];
            let modes = if squares > 0.0 { sum * sum / squares } else { sectors.modes[s] as f64 };
            0.5 * modes / plan.ring_variance()
        };
        let (p, p_se) = ratio_estimate(power, &power.sector_totals(), |s| sectors.modes[s] as f64, independent);
        let realizations = realizations(power);
        let filled = (0..sectors.count).filter(|&s| sectors.modes[s] > 0).map(|s| {
            let expected = predicted[s][0] / sectors.modes[s] as f64;
            let relative = |x: f64| (expected > 0.0).then(|| x / expected);
            SectorPower {
                theta: sectors.bounds(s),
                modes: sectors.modes[s],
                p: p[s],
                p_se: p_se[s],
                band: Band::new(p[s], p_se[s], realizations, independent(s)),
                ratio: relative(p[s]),
                ratio_se: relative(p_se[s]),
            }
        });
        let sectors: Vec<_> = filled.collect();
        (!sectors.is_empty()).then_some(Self { sectors, errors: radial.errors })
    }
}

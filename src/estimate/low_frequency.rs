//! How P behaves at low frequency: hyperuniformity index and exponent.
//! See `docs/spectrum-scalars.md`.

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::gamma::digamma;

use super::RadialSpectrum;
use super::confidence::{CONFIDENCE, Realizations};
use super::line::Line;

/// Low is below this part of one cycle per mean spacing, `lambda^(1/d)`:
const LOW: f64 = 0.2;
/// or as far as this many rings go,
const FEWEST: usize = 4;
/// but never beyond this part of it.
const NOT_LOW: f64 = 0.5;

/// P at low frequency, from the rings below 0.2 cycles per mean spacing (`lambda^(1/d)`), at least 4 of them, all below half a cycle.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LowFrequency {
    /// The range of the rings used, in cycles per unit length.
    pub range: [f64; 2],
    /// How many there are.
    pub rings: usize,
    /// Hyperuniformity index `H = P(0) / P(peak)`: P at 0 extrapolated by a line through the rings (weighted by what exponential
    /// ordinates about that line scatter), over the highest ring mean, or 1 if none is above 1 (Torquato, "Hyperuniform
    /// states of matter", Physics Reports 745, 2018; as in the Python package structure-factor). A line through a curve
    /// that bends upward from 0 crosses 0 on the way: H may be negative.
    pub hyperuniformity_index: f64,
    /// Its standard error, of the extrapolation.
    pub hyperuniformity_index_se: f64,
    /// Exponent b of `P ~ nu^b`: the slope of ln P over ln nu, each ring weighing `K N` (the variance of the logarithm of a mean of K N
    /// exponential ordinates is near `1 / K N`; its bias `digamma(K N) - ln(K N)` is taken off). `None` where P is 0 in a ring.
    pub exponent: Option<f64>,
    /// The confidence interval of the exponent, 95 %: where rings scatter more about the line than exponential ordinates do, as
    /// they scatter.
    pub exponent_interval: Option<[f64; 2]>,
}

impl LowFrequency {
    /// The numbers; `spacing` is `lambda^(1/d)`. `None` where fewer than 4 rings are low.
    pub(super) fn new(radial: &RadialSpectrum, spacing: f64, realizations: Realizations) -> Option<Self> {
        let below = |part: f64| radial.rings.iter().take_while(|r| r.nu <= part * spacing).count();
        let count = below(LOW).max(FEWEST.min(below(NOT_LOW)));
        if count < FEWEST {
            return None;
        }
        let rings = &radial.rings[..count];
        let ordinates = |k: usize| realizations.effective * rings[k].independent_modes as f64;
        let nu: Vec<f64> = rings.iter().map(|r| r.nu).collect();
        let p: Vec<f64> = rings.iter().map(|r| r.p).collect();

        // The scatter follows the line, which follows the scatter; it settles at once.
        let mut level = vec![p.iter().sum::<f64>() / count as f64; count];
        let mut line = Line::default();
        for _ in 0..4 {
            let largest = level.iter().copied().fold(0.0, f64::max);
            let floor = if largest > 0.0 { 0.05 * largest } else { 1.0 };
            let weights: Vec<f64> = (0..count).map(|k| ordinates(k) / level[k].max(floor).powi(2)).collect();
            line = Line::through(&nu, &p, &weights);
            level = nu.iter().map(|x| line.at_zero + line.slope * x).collect();
        }
        let peak = radial.rings.iter().map(|r| r.p).fold(1.0, f64::max);
        let exponent = p.iter().all(|&p| p > 1e-12 * peak).then(|| {
            let logs: Vec<f64> = (0..count).map(|k| p[k].ln() - digamma(ordinates(k)) + ordinates(k).ln()).collect();
            let weights: Vec<f64> = (0..count).map(ordinates).collect();
            Line::through(&nu.iter().map(|x| x.ln()).collect::<Vec<_>>(), &logs, &weights)
        });
        let quantile = StudentsT::new(0.0, 1.0, (count - 2) as f64)
            .map_or(f64::INFINITY, |t| t.inverse_cdf(0.5 + 0.5 * CONFIDENCE));
        let interval = |l: &Line| {
            // Known scatter has normal quantiles, estimated scatter those of Student's t; the wider of the two.
            let reach =
                (super::confidence::normal_quantile() * l.slope_se).max(quantile * l.slope_se * l.scatter.sqrt());
            [l.slope - reach, l.slope + reach]
        };
        Some(Self {
            range: [rings[0].nu_lo, rings[count - 1].nu_hi],
            rings: count,
            hyperuniformity_index: line.at_zero / peak,
            hyperuniformity_index_se: line.at_zero_se / peak,
            exponent: exponent.as_ref().map(|l| l.slope),
            exponent_interval: exponent.as_ref().map(interval),
        })
    }
}

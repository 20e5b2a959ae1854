//! How good a blue-noise pattern is: effective Nyquist frequency and oscillations, from P itself (2D).
//! See `docs/spectrum-scalars.md`.

use super::{PowerSpectrum, RadialSpectrum};
use crate::plan::WavePlan;

/// What a mean over a disk stays below, up to the effective Nyquist frequency.
const THRESHOLD: f64 = 0.1;
/// P counts as risen here; from there on it should be 1.
const RISEN: f64 = 0.98;
/// Least part of a ring that the grid must hold for oscillations to include it.
const LEAST_PART: f64 = 0.25;

/// Effective Nyquist frequency and oscillations (Heck, Schloemer and Deussen, "Blue Noise Sampling with Controlled Aliasing",
/// ACM TOG 32(3), 2013, with the thresholds of their program PSA), on a torus in two dimensions.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BlueNoise {
    /// With `E(nu) = (1/nu^2) integral from 0 to nu of 2 nu' P(nu') dnu'`, the mean of P over a disk: from the first `nu` at or above
    /// `sqrt(lambda) / 2` where `E > 1/2` back to where E was last below 0.1, half of that frequency, in units of
    /// `sqrt(lambda) / 2`, the Nyquist frequency of a square lattice. 0 where E is never below 0.1; `None` where the
    /// rings end before E exceeds 1/2. E is linear between the ends of rings, P below the first ring as in it.
    pub effective_nyquist: Option<f64>,
    /// `10 sqrt(2 pi integral (P - 1)^2 nu dnu / (pi (nu_1^2 - nu_0^2)))` over `[nu_0, nu_1]`, from where the running maximum of P
    /// reaches 0.98 over ten times `sqrt(lambda) / 2`, as far as the grid reaches: rings count of which it holds a quarter.
    /// Noise is part of it: for independent exponential ordinates its square is near
    /// `200 / (pi K |D| nu_f (nu_0 + nu_1))`, nu_f the fundamental. `None` where P never reaches 0.98.
    pub oscillation: Option<f64>,
    /// `[nu_0, nu_1]`, in cycles per unit length.
    pub oscillation_range: Option<[f64; 2]>,
}

impl BlueNoise {
    /// The numbers, on a torus in 2D with rings.
    pub fn new(plan: &WavePlan, spectrum: &PowerSpectrum, radial: &RadialSpectrum) -> Option<Self> {
        if plan.domain.dim() != 2 || !plan.domain.is_torus() || radial.rings.is_empty() {
            return None;
        }
        let root = (plan.shape.mean_points / plan.domain.measure()).sqrt();
        let curve = with_partial_rings(plan, spectrum, radial);
        let (oscillation, oscillation_range) = oscillation(&curve, root).unzip();
        Some(Self { effective_nyquist: effective_nyquist(radial, root), oscillation, oscillation_range })
    }
}

fn effective_nyquist(radial: &RadialSpectrum, root: f64) -> Option<f64> {
    // Upper end of each ring and the mean of P over the disk up to there.
    let mut sum = radial.rings[0].p * radial.rings[0].nu_lo.powi(2);
    let disks: Vec<[f64; 2]> = (radial.rings.iter())
        .map(|r| {
            sum += r.p * (r.nu_hi * r.nu_hi - r.nu_lo * r.nu_lo);
            [r.nu_hi, sum / (r.nu_hi * r.nu_hi)]
        })
        .collect();
    let full = disks.iter().position(|&[nu, e]| nu >= 0.5 * root && e > 0.5)?;
    let Some(low) = disks[..full].iter().rposition(|d| d[1] < THRESHOLD) else { return Some(0.0) };
    let ([nu_a, a], [nu_b, b]) = (disks[low], disks[low + 1]);
    let nu = nu_a + (nu_b - nu_a) * (THRESHOLD - a) / (b - a);
    Some((nu / 2.0) / (root / 2.0))
}

/// nu and P of each ring, beyond the whole ones also of those that the grid holds in part.
fn with_partial_rings(plan: &WavePlan, spectrum: &PowerSpectrum, radial: &RadialSpectrum) -> Vec<[f64; 2]> {
    let mut curve: Vec<[f64; 2]> = radial.rings.iter().map(|r| [r.nu, r.p]).collect();
    let Some(grid) = plan.waves.grid() else { return curve };
    let (first, fundamental) = (plan.rings.count + 1, plan.rings.fundamental);
    let mut sums: Vec<[f64; 2]> = Vec::new();
    let beyond = |index: usize| plan.rings.ring_of[index] == 0 && plan.computes(index);
    for (index, p) in spectrum.p.iter().enumerate().filter(|(index, _)| beyond(*index)) {
        let nu = plan.waves.frequency_length(index, &plan.domain);
        // What is in no ring is DC or lies beyond all.
        let Some(ring) = ((nu / fundamental + 0.5).floor() as usize).checked_sub(first) else { continue };
        if sums.len() <= ring {
            sums.resize(ring + 1, [0.0; 2]);
        }
        let times = f64::from(grid.multiplicity(index));
        sums[ring][0] += times;
        sums[ring][1] += times * p;
    }
    // Modes per area of frequencies: one per 1 / |D|.
    let density = plan.domain.measure();
    for (k, &[modes, sum]) in sums.iter().enumerate() {
        let nu = (first + k) as f64 * fundamental;
        let whole = 2.0 * std::f64::consts::PI * nu * fundamental * density;
        if modes < LEAST_PART * whole {
            break;
        }
        curve.push([nu, sum / modes]);
    }
    curve
}

/// Over nu and P at rising nu; also the range.
fn oscillation(curve: &[[f64; 2]], root: f64) -> Option<(f64, [f64; 2])> {
    let from = curve.iter().position(|c| c[1] >= RISEN)?;
    let nu_0 = curve[from][0];
    let end = nu_0 + 10.0 * root / 2.0;
    let range: Vec<_> = curve[from..].iter().take_while(|c| c[0] <= end).collect();
    let nu_1 = range.last()?[0];
    let part = |[nu, p]: &[f64; 2]| (p - 1.0).powi(2) * nu;
    let integral: f64 = range.windows(2).map(|w| 0.5 * (part(w[0]) + part(w[1])) * (w[1][0] - w[0][0])).sum();
    (nu_1 > nu_0).then(|| (10.0 * (2.0 * integral / (nu_1 * nu_1 - nu_0 * nu_0)).sqrt(), [nu_0, nu_1]))
}

//! Wave power -> radial mean and anisotropy.

use super::Analysis;
use super::clusters::{Clusters, RingPower};
use super::confidence::Band;
use super::power_spectrum::{ratio_estimate, realizations};
use super::{ErrorSource, PowerSpectrum};
use crate::accumulate::WavePower;
use crate::plan::{AnisotropyRule, WavePlan};

/// One ring of constant frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Ring {
    /// Lower end, `(k - 1/2) / max L`, in cycles per unit length. (Of another program's rings: see `Conventions::labels`.)
    pub nu_lo: f64,
    /// Label, `k / max L`.
    pub nu: f64,
    /// k: `nu` in units of the fundamental `1 / max L`.
    pub m: f64,
    /// Upper end.
    pub nu_hi: f64,
    /// Mean frequency `|m / L|` of its members, in cycles per unit length: the label is the middle of the ring, which few
    /// lattice points need lie about.
    pub nu_mean: f64,
    /// The same in units of the fundamental, as `m` is.
    pub m_mean: f64,
    /// Modes of the whole grid in the ring.
    pub modes: u64,
    /// Half of them: P(-m) = P(m).
    pub independent_modes: u64,
    /// Mean of P over the ring.
    pub p: f64,
    /// Standard error of `p`: across realizations, or for K = 1 `p / sqrt(independent_modes)`, times the root of
    /// `TaperPlan::ring_variance` for tapers, and of as many fewer modes as clusters correlate them (`docs/errors.md`).
    pub p_se: f64,
    /// Confidence band of `p`, of as many modes.
    pub band: Option<Band>,
    /// `10 log10(s^2 / p^2)` in dB, `s^2` the variance (ddof 1) of the K-averaged P over the ring's independent modes.
    /// `None` where undefined: a single independent mode, no spread at all, or P below what the accuracy resolves.
    pub anisotropy_db: Option<f64>,
    /// Standard error of the anisotropy for an isotropic spectrum, in dB.
    pub anisotropy_db_se: Option<f64>,
}

/// Radial mean of P and its anisotropy, per ring. DC is in no ring.
#[derive(Debug, Clone, PartialEq)]
pub struct RadialSpectrum {
    /// The rings, from the fundamental upward.
    pub rings: Vec<Ring>,
    /// What the anisotropy of an isotropic spectrum would be: `-10 log10 K` dB, with `K = (sum N)^2 / sum N^2` where the
    /// norms N of realizations differ (n varies, or points have weights), times the number of tapers.
    pub anisotropy_reference_db: f64,
    /// That K: how many realizations of equal norm would know as much.
    pub realizations: f64,
    /// Where `p_se` comes from.
    pub errors: ErrorSource,
}

impl RadialSpectrum {
    /// The estimate. (Anisotropy: Ulichney, Digital Halftoning, 1987, with the independent modes counted as Lagae and
    /// Dutre, "A Comparison of Methods for Generating Poisson Disk Distributions", 2008, do not: the two halves of the
    /// plane are the same numbers.)
    pub fn new(plan: &WavePlan, power: &WavePower, spectrum: &PowerSpectrum) -> Self {
        let ring_moments = power.ring_totals();
        let modes = |k: usize| plan.rings.modes[k] as f64;
        let nu_mean = mean_frequencies(plan);
        let exponential: Vec<f64> =
            (0..plan.rings.count).map(|k| plan.rings.independent[k] as f64 / plan.ring_variance()).collect();
        let (p, _) = ratio_estimate(power, &ring_moments, modes, |k| exponential[k]);
        let clusters = clusters(plan, power, &p, &nu_mean, &exponential);
        let correlated = |k: usize| clusters.map_or(0.0, |c| c.ordinate_covariance(plan.shape.mean_points, nu_mean[k]));
        // The variance of a mean over N ordinates is that of one over N, and their covariance.
        let ordinates: Vec<f64> =
            (0..exponential.len()).map(|k| 1.0 / (1.0 / exponential[k] + correlated(k))).collect();
        let (p, p_se) = ratio_estimate(power, &ring_moments, modes, |k| ordinates[k]);
        let p_se = without_dc(plan, power, spectrum, &p, p_se);
        let spread = spread(plan, &spectrum.p, &p);
        let realizations = realizations(power);
        let averaged = realizations.effective * plan.tapers();
        let rings = (0..plan.rings.count)
            .map(|k| {
                let independent = plan.rings.independent[k];
                let variance = spread[k] / (spread_members(plan, k) - 1.0);
                let resolved = p[k] > plan.accuracy.power_bound().zero(plan.shape.mean_points);
                let defined =
                    independent >= 2 && resolved && variance > (plan.accuracy.relative_noise() * p[k]).powi(2);
                // Independent modes of an average of A exponentials are Gamma(A): by the delta method the relative variance of
                // s^2 / mean^2 is 2/(N-1) + (6 + 4 - 8) / (A N), and as for the mean no more than `ring_variance` times as
                // much where tapers correlate modes.
                let relative =
                    plan.ring_variance() * (2.0 / (independent as f64 - 1.0) + 2.0 / (averaged * independent as f64));
                let [nu_lo, nu, nu_hi] = plan.rings.bounds[k];
                Ring {
                    nu_lo,
                    nu,
                    m: whole(nu / plan.rings.fundamental),
                    nu_hi,
                    nu_mean: nu_mean[k],
                    m_mean: nu_mean[k] / plan.rings.fundamental,
                    modes: plan.rings.modes[k],
                    independent_modes: independent,
                    p: p[k],
                    p_se: p_se[k],
                    band: Band::new(p[k], p_se[k], realizations, ordinates[k]),
                    anisotropy_db: match plan.conventions.anisotropy {
                        AnisotropyRule::Absent => None,
                        AnisotropyRule::AllModes if plan.conventions.bug_compatible && !resolved => Some(0.0),
                        _ => defined.then(|| 10.0 * (variance / (p[k] * p[k])).log10()),
                    },
                    anisotropy_db_se: defined.then(|| 10.0 / std::f64::consts::LN_10 * relative.sqrt()),
                }
            })
            .collect();
        Self {
            rings,
            anisotropy_reference_db: match plan.conventions.anisotropy {
                AnisotropyRule::AllModes if plan.conventions.bug_compatible && power.realizations > 1 => {
                    -(realizations.count as f64)
                }
                // 0 - 0 is 0, where -0 would be printed as such.
                _ => 0.0 - 10.0 * averaged.log10(),
            },
            realizations: realizations.effective,
            errors: match ErrorSource::of(power.realizations) {
                ErrorSource::Theory if clusters.is_some() => ErrorSource::ClusterTheory,
                errors => errors,
            },
        }
    }
}

/// The clusters that ring means of P show; none are looked for in a window, whose tapers smooth P.
fn clusters(plan: &WavePlan, power: &WavePower, p: &[f64], nu: &[f64], ordinates: &[f64]) -> Option<Clusters> {
    if plan.tapered().is_some() {
        return None;
    }
    let known = |k: usize| RingPower { nu: nu[k], p: p[k], ordinates: ordinates[k] * realizations(power).effective };
    let rings: Vec<RingPower> = (0..p.len()).map(known).filter(|ring| ring.nu > 0.0 && ring.ordinates > 0.0).collect();
    Clusters::of_rings(plan.domain.dim(), &rings)
}

/// Per ring, the mean of `|m / L|` over its members.
fn mean_frequencies(plan: &WavePlan) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); plan.rings.count];
    for (index, &ring) in plan.rings.ring_of.iter().enumerate().filter(|(_, ring)| **ring > 0) {
        let m = plan.waves.vector(index);
        let squared: f64 = m.iter().zip(plan.domain.sides()).map(|(m, side)| (m / side).powi(2)).sum();
        let (sum, members) = &mut sums[ring as usize - 1];
        *sum += f64::from(plan.rings.times[index]) * squared.sqrt();
        *members += f64::from(plan.rings.times[index]);
    }
    sums.into_iter().map(|(sum, members)| sum / members).collect()
}

/// `x` without the rounding of a product divided again.
fn whole(x: f64) -> f64 {
    if (x - x.round()).abs() <= 1e-9 * x { x.round() } else { x }
}

/// The theory's standard errors, where DC is a member of its ring: it is the same for all points, so that only the others
/// scatter.
fn without_dc(plan: &WavePlan, power: &WavePower, spectrum: &PowerSpectrum, p: &[f64], mut p_se: Vec<f64>) -> Vec<f64> {
    let dc = plan.waves.dc().filter(|&dc| plan.rings.ring_of[dc] > 0 && power.realizations == 1);
    if let Some(dc) = dc {
        let k = plan.rings.ring_of[dc] as usize - 1;
        let members = plan.rings.modes[k] as f64;
        let others = p[k] * members - f64::from(plan.rings.times[dc]) * spectrum.p[dc];
        p_se[k] = others.max(0.0) / members / (plan.rings.independent[k] as f64).sqrt();
    }
    p_se
}

/// Members of ring k that its spread is taken over.
fn spread_members(plan: &WavePlan, k: usize) -> f64 {
    match plan.conventions.anisotropy {
        AnisotropyRule::AllModes => plan.rings.modes[k] as f64,
        _ => plan.rings.independent[k] as f64,
    }
}

/// Per ring, the sum of `(P(m) - mean)^2` over those members: of a grid the independent ones are stored after DC, of a list
/// they are all.
fn spread(plan: &WavePlan, p: &[f64], mean: &[f64]) -> Vec<f64> {
    let mut spread = vec![0.0; plan.rings.count];
    let all = plan.conventions.anisotropy == AnisotropyRule::AllModes;
    let first = plan.waves.grid().map_or(0, |grid| if all { 0 } else { grid.dc() + 1 });
    for (index, (&p, &ring)) in p.iter().zip(&plan.rings.ring_of).enumerate().skip(first) {
        if ring > 0 {
            let k = ring as usize - 1;
            let times = if all { f64::from(plan.rings.times[index]) } else { 1.0 };
            spread[k] += times * (p - mean[k]).powi(2);
        }
    }
    spread
}

impl Analysis {
    /// Radial mean and anisotropy.
    pub fn radial(&self) -> Option<&RadialSpectrum> {
        self.get()
    }
}

//! Whether a device measures what theory says: realizations of processes whose P, g and variance of n are known in closed form, counted
//! and transformed by the device's own kernels, and held against those by Hotelling's T^2. A sum that cannot vary, as the peaks of a
//! lattice, is held to its bound.

mod stress;

use std::collections::BTreeMap;

pub use stress::{Stress, stress};

use crate::ball::unit_ball;
use crate::compute::{Compute, Device};
use crate::control::Control;
use crate::error::Result;
use crate::estimate::{Hotelling, Normalization, PairCorrelation, PowerSpectrum};
use crate::plan::{Accuracy, Correction, PairPlan, RadialBins, WaveGrid, WavePlan};
use crate::points::Domain;
use crate::samplers::Process;

/// How often a check fails that should hold.
const FALSE_ALARM: f64 = 1e-6;

/// Realizations that are summed to one sample: fewer runs of a kernel, and sums that are nearer to normal.
const GROUP: u64 = 10;

/// One claim that was looked at.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Check {
    /// Name and parameters of the process.
    pub sampler: String,
    /// Points per realization, or their expectation.
    pub n: u64,
    /// Dimension.
    pub dim: usize,
    /// Number of realizations.
    pub realizations: u64,
    /// What is claimed.
    pub claim: &'static str,
    /// The probability of what was measured, if the claim is true; of what cannot vary, 1 or 0.
    pub p_value: f64,
    /// Whether that is likely enough.
    pub holds: bool,
}

/// A process of the battery: name, parameters, n, dimension, the largest |m_j|, and whether only the full one has it.
type Case = (&'static str, &'static [&'static str], u64, usize, u32, bool);

const CASES: &[Case] = &[
    ("random", &[], 100, 2, 8, false),
    ("random", &[], 100, 3, 4, false),
    ("poisson", &[], 100, 2, 8, false),
    ("cell", &[], 64, 2, 8, true),
    ("grid", &["shift=random"], 64, 2, 20, false),
    ("hexagonal", &["shift=random"], 120, 2, 24, false),
    ("fcc", &["shift=random"], 108, 3, 8, false),
    ("bcc", &["shift=random"], 128, 3, 8, true),
    ("perturbed-grid", &[], 64, 2, 12, false),
    ("perturbed-grid", &[], 64, 3, 5, true),
    ("jittered", &[], 64, 1, 60, false),
    ("jittered", &[], 64, 2, 12, false),
    ("jittered", &[], 64, 3, 5, false),
    ("cmj", &[], 64, 2, 12, false),
    ("cmj", &["permutations=independent"], 64, 2, 12, true),
    ("lhs", &[], 64, 2, 12, false),
    ("halton", &["scramble=owen"], 81, 2, 12, true),
    ("sobol", &[], 64, 2, 16, false),
    ("sobol", &[], 64, 3, 5, true),
    ("pmj02", &[], 128, 2, 16, true),
    ("lattice", &[], 101, 2, 24, false),
    ("kronecker", &[], 100, 2, 12, false),
    ("matern-i", &[], 100, 2, 10, true),
    ("matern-ii", &[], 100, 2, 10, false),
    ("thomas", &[], 100, 2, 8, false),
    ("thomas", &["mu=5"], 100, 3, 4, true),
    ("matern-cluster", &[], 100, 2, 8, true),
    ("lgcp", &[], 100, 2, 8, true),
    ("gaussian-dpp", &[], 64, 2, 8, true),
    ("fourier-dpp", &[], 81, 2, 10, false),
    ("ginibre", &[], 64, 2, 8, false),
];

/// Runs the battery, or all of it; every check is told of as soon as it is known.
///
/// # Errors
/// What the device says; `Error::Cancelled`.
pub async fn run(device: &Device, full: bool, control: &Control, tell: &mut dyn FnMut(&Check)) -> Result<Vec<Check>> {
    let mut all = Vec::new();
    for &(name, given, n, dim, reach, _) in CASES.iter().filter(|case| full || !case.5) {
        let realizations = if full { 1000 } else { 400 };
        let process = Process::new(name, n, realizations, dim, 20, given)?;
        for (claim, p_value) in claims(&process, reach, device.compute(), control).await? {
            let sampler = std::iter::once(name).chain(given.iter().copied()).collect::<Vec<_>>().join(" ");
            let check = Check { sampler, n, dim, realizations, claim, p_value, holds: p_value >= FALSE_ALARM };
            tell(&check);
            all.push(check);
        }
    }
    Ok(all)
}

/// What is claimed of a process, with probabilities.
async fn claims(
    process: &Process,
    reach: u32,
    compute: &dyn Compute,
    control: &Control,
) -> Result<Vec<(&'static str, f64)>> {
    let domain = Domain::unit_torus(process.dim);
    let bins = RadialBins::linear(0.45, 8)?;
    let expected_pairs = expected_pairs(process, &bins);
    let mut samples: [Vec<Vec<f64>>; 3] = Default::default();
    let mut tolerance = 0.0f64;
    for first in (0..process.realizations).step_by(GROUP as usize) {
        let points = process.ensemble(first..process.realizations.min(first + GROUP), control)?;
        let (total, ordered) = (0..points.realizations())
            .map(|k| points.points_in(k) as f64)
            .fold((0.0, 0.0), |s, n| (s.0 + n, s.1 + n * (n - 1.0)));
        let grid = WaveGrid::new(&vec![reach; process.dim])?;
        let plan = WavePlan::new(&domain, grid, Accuracy::High, points.shape())?;
        let spectrum = PowerSpectrum::new(&plan, &compute.wave_power(&plan, &points, control).await?);
        let mut rings: BTreeMap<u32, f64> = BTreeMap::new();
        for (k, p) in spectrum.p.iter().enumerate() {
            let m = plan.waves.vector(k).map(|m| m as i32);
            if let Some(power) = process.power(m).filter(|_| m != [0; 3]) {
                let nu = m.iter().map(|&m| f64::from(m).powi(2)).sum::<f64>().sqrt();
                let ring = (8.0 * nu / (f64::from(reach) * (process.dim as f64).sqrt() + 1e-9)) as u32;
                *rings.entry(ring).or_default() += (p - power) * total;
                tolerance = tolerance
                    .max(Accuracy::High.power_bound().max_any(total) * (1.0 + power) * total * spectrum.p.len() as f64);
            }
        }
        samples[0].push(rings.into_values().collect());
        if let Some(expected) = &expected_pairs {
            let plan = PairPlan::new(&domain, bins.clone(), Correction::None, points.shape())?;
            let counts = compute.pair_counts(&plan, &points, control).await?;
            let counts = PairCorrelation::new(&plan, &counts, Normalization::Pairs).count;
            samples[1].push(counts.iter().zip(expected).map(|(c, e)| *c as f64 - e * ordered).collect());
        }
    }
    if let (false, Some(variance)) = (process.fixed_n, process.sampler.count_variance()) {
        for index in 0..process.realizations {
            let off = process.count(index, control)? as f64 - process.n as f64;
            samples[2].push(vec![off, off * off - variance]);
        }
    }
    let names = ["P over rings", "g in bins of r", "mean and variance of n"];
    Ok(names
        .into_iter()
        .zip(&samples)
        .filter_map(|(name, samples)| Some((name, probability(samples, tolerance)?)))
        .collect())
}

/// Pairs in every bin for every ordered pair there is, by the closed form, averaged over the shell in volume.
fn expected_pairs(process: &Process, bins: &RadialBins) -> Option<Vec<f64>> {
    // That of a log-Gaussian Cox process is what it tends to as its cells shrink.
    if process.name == "lgcp" {
        return None;
    }
    let dim = process.dim as f64;
    let ball = unit_ball(process.dim);
    let steps = 400;
    let shell = |lo: f64, hi: f64| {
        let (inner, outer) = (lo.powf(dim), hi.powf(dim));
        let radius = |i: i32| (inner + (outer - inner) * (f64::from(i) + 0.5) / f64::from(steps)).powf(1.0 / dim);
        let sum = (0..steps).map(|i| process.pair_correlation(radius(i))).sum::<Option<f64>>()?;
        Some(sum / f64::from(steps) * ball * (outer - inner))
    };
    bins.edges().windows(2).map(|bin| shell(bin[0], bin[1])).collect()
}

/// Of a mean of 0; of what never varies, whether it is 0 within the tolerance. `None` where there is nothing to look at.
fn probability(samples: &[Vec<f64>], tolerance: f64) -> Option<f64> {
    let first = samples.first().filter(|first| !first.is_empty())?;
    let spread = |r: usize| samples.iter().map(|s| (s[r] - first[r]).abs()).fold(0.0, f64::max);
    let free: Vec<usize> = (0..first.len()).filter(|&r| spread(r) > 4.0 * tolerance + 1e-9).collect();
    let fixed = (0..first.len()).filter(|r| !free.contains(r));
    if fixed.into_iter().any(|r| samples.iter().any(|s| s[r].abs() > 4.0 * tolerance + 1e-9)) {
        return Some(0.0);
    }
    let varied: Vec<Vec<f64>> = samples.iter().map(|s| free.iter().map(|&r| s[r]).collect()).collect();
    Some(Hotelling::new(&varied).map_or(1.0, |test| test.p_value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accumulate::{ComputedBy, LagCounts, PairCounts, WavePower};
    use crate::compute::Pending;
    use crate::compute::cpu::Cpu;
    use crate::plan::LagPlan;
    use crate::points::Ensemble;

    /// A device that loses one pair in fifty of one bin.
    pub(super) struct Forgetful(pub(super) Cpu);

    impl Compute for Forgetful {
        fn computed_by(&self) -> ComputedBy {
            self.0.computed_by()
        }

        fn pair_counts<'a>(
            &'a self,
            plan: &'a PairPlan,
            points: &'a Ensemble,
            control: &'a Control,
        ) -> Pending<'a, PairCounts> {
            Box::pin(async move {
                let mut counts = self.0.pair_counts(plan, points, control).await?;
                counts.counts[5] -= counts.counts[5] / 50;
                Ok(counts)
            })
        }

        fn lag_counts<'a>(
            &'a self,
            plan: &'a LagPlan,
            points: &'a Ensemble,
            control: &'a Control,
        ) -> Pending<'a, LagCounts> {
            self.0.lag_counts(plan, points, control)
        }

        fn wave_power<'a>(
            &'a self,
            plan: &'a WavePlan,
            points: &'a Ensemble,
            control: &'a Control,
        ) -> Pending<'a, WavePower> {
            self.0.wave_power(plan, points, control)
        }
    }

    #[test]
    fn a_device_that_loses_pairs_is_found() {
        let found = |compute: Box<dyn Compute>| {
            let process = Process::new("jittered", 64, 400, 2, 20, &[]).unwrap();
            let control = Control::default();
            crate::control::wait(claims(&process, 8, compute.as_ref(), &control)).unwrap()
        };
        let cpu = || Cpu::new(Some(1)).unwrap();
        assert!(found(Box::new(cpu())).iter().all(|(_, p)| *p >= FALSE_ALARM));
        let faulty = found(Box::new(Forgetful(cpu())));
        assert!(faulty[0].1 >= FALSE_ALARM && faulty[1].1 < FALSE_ALARM, "{faulty:?}");
    }

    #[test]
    fn what_cannot_vary_is_held_to_its_bound() {
        assert_eq!(probability(&[vec![0.0], vec![1e-10]], 0.0), Some(1.0));
        assert_eq!(probability(&[vec![1e-3], vec![1e-3]], 1e-6), Some(0.0));
        assert_eq!(probability(&[vec![]], 0.0), None);
    }
}

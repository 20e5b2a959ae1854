//! The raw sums of everything a plan asks for.

use super::Plan;
use crate::accumulate::ComputedBy;
use crate::accumulate::{CrossCounts, KernelSums, LagCounts, NeighborSums, PairCounts, WaveCovariance, WavePower};
use crate::compute::WithFallback;
use crate::control::Clock;
use crate::control::Control;
use crate::error::Result;
use crate::points::Ensemble;

/// Raw sums over realizations; what the plan does not ask for is `None`.
#[derive(Debug, Clone, Default)]
pub(super) struct Sums {
    pub(super) pairs: Option<PairCounts>,
    pub(super) cross: Option<CrossCounts>,
    pub(super) kernel: Option<KernelSums>,
    pub(super) lags: Option<LagCounts>,
    pub(super) rings: Option<LagCounts>,
    pub(super) waves: Option<WavePower>,
    pub(super) covariance: Option<WaveCovariance>,
    pub(super) neighbors: Option<NeighborSums>,
    /// Unordered pairs per bin of `Plan::psa`, of every realization.
    pub(super) psa: Vec<Vec<u64>>,
}

impl Sums {
    /// The sums of one batch. `tell` hears what is being done.
    pub(super) fn measure(
        plan: &Plan,
        batch: &Ensemble,
        device: &mut WithFallback<'_>,
        control: &Control,
        clock: &mut Clock,
        tell: &mut dyn FnMut(&'static str),
    ) -> Result<Self> {
        let mut stage = |name, work: &mut dyn FnMut() -> Result<()>| {
            tell(name);
            clock.time(name, work)
        };
        let mut sums = Self::default();
        if let Some(plan) = &plan.pairs {
            stage("pair_counts", &mut || {
                sums.pairs = Some(device.pair_counts(plan, batch, control)?);
                Ok(())
            })?;
        }
        if let Some(plan) = &plan.kernel {
            stage("kernel_sums", &mut || {
                sums.kernel = Some(device.kernel_sums(plan, batch, control)?);
                Ok(())
            })?;
        }
        if let Some(classes) = &plan.classes {
            stage("pair_counts (classes)", &mut || {
                sums.cross = classes.count(batch, device, control)?;
                Ok(())
            })?;
        }
        for (plan, sums) in [(&plan.lags, &mut sums.lags), (&plan.rings, &mut sums.rings)] {
            if let Some(plan) = plan {
                stage("lag_counts", &mut || {
                    *sums = Some(device.lag_counts(plan, batch, control)?);
                    Ok(())
                })?;
            }
        }
        if let Some(plan) = &plan.waves {
            stage("wave_power", &mut || {
                sums.waves = Some(device.wave_power(plan, batch, control)?);
                Ok(())
            })?;
        }
        if let Some(plan) = &plan.covariance {
            stage("wave_covariance", &mut || {
                sums.covariance = Some(device.wave_covariance(plan, batch, control)?);
                Ok(())
            })?;
        }
        if let Some(plan) = &plan.psa {
            stage("pair_counts (psa)", &mut || {
                for k in 0..batch.realizations() {
                    let counts = device.pair_counts(plan, &batch.slice(k..k + 1), control)?.counts;
                    sums.psa.push(counts.into_iter().map(|c| c / 2).collect());
                }
                Ok(())
            })?;
        }
        if let Some(plan) = &plan.neighbors {
            stage("neighbors", &mut || {
                sums.neighbors = Some(device.neighbors(plan, batch, control)?);
                Ok(())
            })?;
        }
        Ok(sums)
    }

    /// Adds the sums of the batch that follows.
    pub(super) fn merge(&mut self, next: Self) -> Result<()> {
        self.psa.extend(next.psa);
        merge(&mut self.pairs, next.pairs, |a, b| a.merge(&b))?;
        merge(&mut self.cross, next.cross, |a, b| a.merge(&b))?;
        merge(&mut self.kernel, next.kernel, |a, b| a.merge(b))?;
        merge(&mut self.lags, next.lags, |a, b| a.merge(&b))?;
        merge(&mut self.rings, next.rings, |a, b| a.merge(&b))?;
        merge(&mut self.waves, next.waves, |a, b| a.merge(b))?;
        merge(&mut self.covariance, next.covariance, |a, b| a.merge(b))?;
        merge(&mut self.neighbors, next.neighbors, |a, b| a.merge(&b))
    }

    /// Adds the sums of the realization that follows, to those of one leaf that is not full. Not of covariances: a leaf of
    /// those is one product.
    pub(super) fn append(&mut self, next: Self) -> Result<()> {
        let Self { pairs, cross, kernel, lags, rings, waves, covariance, neighbors, psa } = next;
        merge(&mut self.kernel, kernel, |a, b| a.append(b))?;
        merge(&mut self.waves, waves, |a, b| a.append(b))?;
        // The others are integers, or kept per realization: any order and any cut will do.
        self.merge(Self { pairs, cross, lags, rings, covariance, neighbors, psa, ..Self::default() })
    }

    /// Who computed them.
    pub(super) fn computed_by(&self) -> ComputedBy {
        let tags = [
            self.pairs.as_ref().map(|s| &s.computed_by),
            self.cross.as_ref().map(|s| &s.between.computed_by),
            self.kernel.as_ref().map(|s| &s.computed_by),
            self.lags.as_ref().map(|s| &s.computed_by),
            self.waves.as_ref().map(|s| &s.computed_by),
            self.covariance.as_ref().map(|s| &s.computed_by),
        ];
        let all = tags.into_iter().flatten().cloned().reduce(|a, b| a.merge(&b));
        all.unwrap_or_else(|| ComputedBy::new(crate::accumulate::Backend::Cpu, "cpu (k-d tree)"))
    }
}

pub(super) fn merge<T>(sum: &mut Option<T>, next: Option<T>, add: impl Fn(&mut T, T) -> Result<()>) -> Result<()> {
    match (sum.as_mut(), next) {
        (Some(sum), Some(next)) => add(sum, next),
        (None, next) => {
            *sum = next;
            Ok(())
        }
        (Some(_), None) => Ok(()),
    }
}

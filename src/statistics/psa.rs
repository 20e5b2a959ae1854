//! PSA's statistics of the spectrum, by its own route: from the distances of every realization.

use std::fmt;

use serde_json::{Value, json};

use super::group::{Ask, Group, Parts, Subject};
use super::pairs::identity;
use super::waves::Waves;
use crate::accumulate::{ComputedBy, PsaCounts};
use crate::compute::Session;
use crate::error::Result;
use crate::estimate::{Analysis, PsaStatistics};
use crate::plan::{Batch, Correction, DeviceCosts, PairPlan, RadialBins};
use crate::points::Ensemble;
use crate::request::Statistic;

/// Most bins of PSA's distances: as many Bessel functions squared. Reached at 100,000 points.
pub(crate) const MAX_BINS: usize = 32_000;

/// Most values of all realizations: 1 GiB.
const MAX_VALUES: u64 = 1 << 27;

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Psa {
    /// `None` where there are no pairs, or too many for its cubic sums.
    pairs: Option<PairPlan>,
    shape: crate::plan::EnsembleShape,
}

/// Plans them, where they are part of what is asked for.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    let Ask { request, domain, shape, .. } = *ask;
    if !request.conventions().pairs || parts.get::<Waves>().is_none() {
        return Ok(());
    }
    let bins = PsaStatistics::bins(shape.max_points);
    let few = bins <= MAX_BINS && bins as u64 * shape.realizations <= MAX_VALUES;
    let pairs = (shape.max_points >= 2 && few)
        .then(|| {
            let bins = RadialBins::linear(domain.shortest_side() / 2.0, bins)?;
            PairPlan::new(domain, bins, Correction::None, shape)
        })
        .transpose()?;
    parts.add(Psa { pairs, shape });
    Ok(())
}

impl Group for Psa {
    type Sums = PsaCounts;

    const NAME: &'static str = "PSA's statistics";
    const STAGE: &'static str = "pair_counts (psa)";
    const LAST_WORDS: bool = true;

    fn statistics(&self) -> Vec<Statistic> {
        Vec::new()
    }

    fn identity(&self) -> Value {
        json!({ "pairs": self.pairs.as_ref().map(identity) })
    }

    fn batch(&self) -> Batch {
        self.pairs.as_ref().map_or(Batch::all(self.shape), |pairs| pairs.batch)
    }

    fn seconds(&self, _: f64) -> f64 {
        self.pairs.as_ref().map_or(0.0, PairPlan::seconds)
    }

    fn suit(&mut self, device: &DeviceCosts) {
        self.pairs = self.pairs.take().map(|pairs| pairs.for_device(device.pairs));
    }

    fn none(&self, _: ComputedBy) -> PsaCounts {
        PsaCounts::default()
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<PsaCounts> {
        let mut sums = PsaCounts::default();
        if let Some(pairs) = &self.pairs {
            session.in_pieces(batch.realizations());
            for k in 0..batch.realizations() {
                let counts = session.pair_counts(pairs, &batch.slice(k..k + 1)).await?.counts;
                sums.add(batch.first_index() + k as u64, counts.into_iter().map(|c| c / 2).collect());
            }
        }
        Ok(sums)
    }

    fn estimate(&self, sums: &PsaCounts, subject: &Subject<'_>, found: &mut Analysis) {
        found.findings.add(PsaStatistics::new(subject.shape.max_points, &sums.of_realizations()));
    }

    fn warnings(&self, _: &PsaCounts, subject: &Subject<'_>, _: &Parts, found: &Analysis) -> Vec<String> {
        let why = if subject.shape.max_points < 2 { "they need pairs of points" } else { "too many sets or points" };
        let warning = format!("effective Nyquist frequency and oscillation by PSA's route are left out: {why}");
        found.psa().is_none().then_some(warning).into_iter().collect()
    }
}

impl fmt::Display for Psa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.pairs {
            Some(pairs) => write!(f, "for PSA's effective Nyquist frequency and oscillation: {pairs}"),
            None => Ok(()),
        }
    }
}

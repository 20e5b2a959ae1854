//! Products of the amplitudes of low frequencies.

use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, WaveCovariance};
use crate::compute::Session;
use crate::error::Result;
use crate::estimate::{AmplitudeCovariance, Analysis};
use crate::plan::{Batch, CovariancePlan};
use crate::points::Ensemble;
use crate::request::Statistic;
use crate::statistics::group::{Ask, Group, Parts, Subject};

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Covariance(CovariancePlan);

/// Plans them, if they are wanted.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    if ask.wants(Statistic::Covariance) {
        parts.add(Covariance(CovariancePlan::new(ask.domain, ask.request.covariance_frequency, ask.shape)?));
    }
    Ok(())
}

impl Group for Covariance {
    type Sums = WaveCovariance;

    const NAME: &'static str = "covariance";
    const STAGE: &'static str = "wave_covariance";
    const WHOLE_LEAVES: bool = true;

    fn statistics(&self) -> Vec<Statistic> {
        vec![Statistic::Covariance]
    }

    fn identity(&self) -> Value {
        json!({ "max_frequency": self.0.grid.max_frequency()[..self.0.grid.dim()] })
    }

    fn batch(&self) -> Batch {
        self.0.batch
    }

    fn seconds(&self, n: f64) -> f64 {
        let stored = self.0.stored() as f64;
        3e-10 * n * stored + 1e-9 * stored * stored
    }

    fn none(&self, by: ComputedBy) -> WaveCovariance {
        WaveCovariance::new(by, self.0.stored())
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<WaveCovariance> {
        session.wave_covariance(&self.0, batch).await
    }

    fn estimate(&self, sums: &WaveCovariance, _: &Subject<'_>, found: &mut Analysis) {
        found.findings.insert(AmplitudeCovariance::new(&self.0, sums));
    }

    fn warnings(&self, _: &WaveCovariance, subject: &Subject<'_>, _: &Parts, _: &Analysis) -> Vec<String> {
        let warning = "the covariance of amplitudes is an expectation over realizations: a single one shows s_m conj(s_l), which is \
                       not 0 for any process; -k or more files give an estimate with errors";
        (subject.shape.realizations == 1).then(|| warning.to_string()).into_iter().collect()
    }
}

impl fmt::Display for Covariance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

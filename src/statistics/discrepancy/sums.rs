//! What discrepancies are read off.

use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, DiscrepancySums};
use crate::compute::Session;
use crate::error::Result;
use crate::estimate::{Analysis, Discrepancies};
use crate::plan::{Batch, DiscrepancyPlan};
use crate::points::Ensemble;
use crate::request::Statistic;
use crate::statistics::group::{Ask, Group, Parts, Subject};

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scalars(DiscrepancyPlan);

/// Plans them, if they are wanted.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    if ask.wants(Statistic::Discrepancy) {
        parts.add(Scalars(DiscrepancyPlan::new(ask.domain, ask.shape)?));
    }
    Ok(())
}

impl Group for Scalars {
    type Sums = DiscrepancySums;

    const NAME: &'static str = "discrepancies";
    const STAGE: &'static str = "discrepancy";

    fn statistics(&self) -> Vec<Statistic> {
        vec![Statistic::Discrepancy]
    }

    fn identity(&self) -> Value {
        json!({})
    }

    fn batch(&self) -> Batch {
        self.0.batch
    }

    fn seconds(&self, n: f64) -> f64 {
        let dim = self.0.domain.dim() as f64;
        n * n / 2.0 * (1e-9 + 3e-9 * dim) + 2e-6 * n
    }

    fn none(&self, _: ComputedBy) -> DiscrepancySums {
        DiscrepancySums::default()
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<DiscrepancySums> {
        session.discrepancies(&self.0, batch).await
    }

    fn estimate(&self, sums: &DiscrepancySums, _: &Subject<'_>, found: &mut Analysis) {
        found.findings.add(Discrepancies::new(sums));
    }

    fn warnings(&self, _: &DiscrepancySums, subject: &Subject<'_>, _: &Parts, found: &Analysis) -> Vec<String> {
        let mut warnings = Vec::new();
        if subject.request.input.weight_column.is_some() {
            warnings.push("discrepancies count every point once, whatever its weight".into());
        }
        let loose = found.discrepancies().and_then(|d| Some((d.covering?.largest, d.covering_bound?)));
        if let Some((radius, bound)) = loose.filter(|(radius, bound)| *bound > radius * (1.0 + 1e-6)) {
            warnings.push(format!(
                "the covering radius is at least {radius} and at most {bound}: too many places are about equally far from all points to look at each"
            ));
        }
        warnings
    }
}

impl fmt::Display for Scalars {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

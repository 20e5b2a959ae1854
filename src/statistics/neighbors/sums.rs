//! Nearest neighbours, the empty space, bonds.

use std::fmt;

use serde_json::{Value, json};

use super::classes::NeighborClasses;
use crate::accumulate::{ComputedBy, NeighborSums};
use crate::compute::Session;
use crate::error::Result;
use crate::estimate::{Analysis, Neighbors};
use crate::plan::{Batch, NeighborPlan};
use crate::points::Ensemble;
use crate::request::Statistic;
use crate::statistics::group::{Ask, Group, Parts, Subject, digest};
use crate::statistics::pairs::Pairs;

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Neighborhood(NeighborPlan);

/// Plans them, if they are wanted; G and F at the edges of the bins of g, where there are any.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    if ask.wants(Statistic::Neighbors) {
        let bins = parts.get::<Pairs>().map(|pairs| &pairs.plan.bins);
        let plan = NeighborPlan::new(ask.domain, bins, ask.shape)?;
        let classes = (!ask.classes.is_empty()).then(|| NeighborClasses::new(ask, &plan)).transpose()?;
        parts.add(Neighborhood(plan));
        classes.into_iter().for_each(|classes| parts.add(classes));
    }
    Ok(())
}

/// What a realization of n points takes.
pub(super) fn seconds(plan: &NeighborPlan, n: f64) -> f64 {
    let points = n + plan.probes.len() as f64;
    let each = if plan.domain.dim() == 1 { 6e-8 } else { 2.8e-7 };
    each * points * points.max(2.0).log2()
}

impl Group for Neighborhood {
    type Sums = NeighborSums;

    const NAME: &'static str = "neighbours";
    const STAGE: &'static str = "neighbors";

    fn statistics(&self) -> Vec<Statistic> {
        vec![Statistic::Neighbors]
    }

    fn identity(&self) -> Value {
        let Self(plan) = self;
        json!({ "r": digest(plan.r.iter().copied()), "probes": plan.probes.counts, "bonds": plan.bonds })
    }

    fn batch(&self) -> Batch {
        self.0.batch
    }

    fn seconds(&self, n: f64) -> f64 {
        seconds(&self.0, n)
    }

    fn none(&self, _: ComputedBy) -> NeighborSums {
        NeighborSums::at(self.0.r.len())
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<NeighborSums> {
        session.neighbors(&self.0, batch).await
    }

    fn estimate(&self, sums: &NeighborSums, subject: &Subject<'_>, found: &mut Analysis) {
        found.findings.insert(Neighbors::new(&self.0, sums, subject.shape));
    }

    fn in_simulations(&self) -> Option<Self> {
        Some(Self(NeighborPlan { bonds: false, ..self.0.clone() }))
    }

    fn curve_values(&self) -> usize {
        // G and F.
        2 * self.0.r.len()
    }
}

impl fmt::Display for Neighborhood {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

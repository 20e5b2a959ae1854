//! Nearest neighbours of two classes of points.

use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, CrossNeighborSums, NeighborSums};
use crate::compute::Session;
use crate::error::Result;
use crate::estimate::{Analysis, CrossNeighbors};
use crate::plan::{Batch, NeighborPlan};
use crate::points::Ensemble;
use crate::request::Statistic;
use crate::statistics::classes::TwoClasses;
use crate::statistics::group::{Ask, Group, Subject, digest};

/// The two classes whose G, F and J are wanted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NeighborClasses {
    names: [String; 2],
    numbers: [u32; 2],
    plan: NeighborPlan,
}

impl NeighborClasses {
    /// Of the classes asked for.
    pub(super) fn new(ask: &Ask<'_>, plan: &NeighborPlan) -> Result<Self> {
        let TwoClasses { names, numbers } = TwoClasses::among(ask.classes, ask.request)?;
        Ok(Self { names, numbers, plan: NeighborPlan { bonds: false, ..plan.clone() } })
    }
}

impl Group for NeighborClasses {
    type Sums = CrossNeighborSums;

    const NAME: &'static str = "neighbours of two classes";
    const STAGE: &'static str = "neighbors (classes)";

    fn statistics(&self) -> Vec<Statistic> {
        Vec::new()
    }

    fn identity(&self) -> Value {
        json!({
            "classes": self.names,
            "r": digest(self.plan.r.iter().copied()),
            "probes": self.plan.probes.counts,
        })
    }

    fn batch(&self) -> Batch {
        self.plan.batch
    }

    fn seconds(&self, n: f64) -> f64 {
        2.0 * super::sums::seconds(&self.plan, n)
    }

    fn none(&self, _: ComputedBy) -> CrossNeighborSums {
        CrossNeighborSums(std::array::from_fn(|_| NeighborSums::at(self.plan.r.len())))
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<CrossNeighborSums> {
        let [a, b] = self.numbers;
        let mut sums = CrossNeighborSums::default();
        for (part, classes) in sums.0.iter_mut().zip([[a, a], [b, b], [a, b], [b, a]]) {
            let plan = NeighborPlan { classes: Some(classes), ..self.plan.clone() };
            *part = session.neighbors(&plan, batch).await?;
        }
        Ok(sums)
    }

    fn estimate(&self, sums: &CrossNeighborSums, _: &Subject<'_>, found: &mut Analysis) {
        found.findings.insert(CrossNeighbors::new(self.names.clone(), &self.plan, sums));
    }
}

impl fmt::Display for NeighborClasses {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.names;
        writeln!(f, "neighbours of the classes {a} and {b}: within each, from {a} to {b} and from {b} to {a}")
    }
}

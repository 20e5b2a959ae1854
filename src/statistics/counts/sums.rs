//! What counts are read off.

use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, CountSums};
use crate::compute::Session;
use crate::error::Result;
use crate::estimate::{Analysis, Counts};
use crate::plan::{Batch, CountExtent, CountPlan};
use crate::points::Ensemble;
use crate::request::Statistic;
use crate::statistics::group::{Ask, Group, Parts, Subject};

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct InBoxes(CountPlan);

/// Plans them, if they are wanted.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) {
    if ask.wants(Statistic::Counts) {
        parts.add(InBoxes(CountPlan::new(ask.domain, ask.shape)));
    }
}

impl Group for InBoxes {
    type Sums = CountSums;

    const NAME: &'static str = "counts";
    const STAGE: &'static str = "counts";

    fn statistics(&self) -> Vec<Statistic> {
        vec![Statistic::Counts]
    }

    fn identity(&self) -> Value {
        let number = |extent| match extent {
            CountExtent::Interval(steps) | CountExtent::Ball(steps) => steps,
            CountExtent::Cells(q) => q as u64,
        };
        let sizes: Vec<u64> = self.0.sizes.iter().map(|size| number(size.extent)).collect();
        json!({ "cells": self.0.cells, "centers": self.0.centers, "sizes": sizes })
    }

    fn batch(&self) -> Batch {
        self.0.batch
    }

    fn seconds(&self, n: f64) -> f64 {
        let plan = &self.0;
        let of = |extent| match extent {
            CountExtent::Interval(_) => 3e-8 * n,
            CountExtent::Cells(_) => 5e-9 * (plan.cells as f64).powi(plan.domain.dim() as i32),
            CountExtent::Ball(_) => 2e-10 * n * plan.center_count() as f64,
        };
        plan.sizes.iter().map(|size| of(size.extent)).sum()
    }

    fn none(&self, _: ComputedBy) -> CountSums {
        CountSums::new(self.0.sizes.len())
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<CountSums> {
        session.counts(&self.0, batch).await
    }

    fn estimate(&self, sums: &CountSums, _: &Subject<'_>, found: &mut Analysis) {
        found.findings.insert(Counts::new(&self.0, sums));
    }

    fn warnings(&self, _: &CountSums, subject: &Subject<'_>, _: &Parts, _: &Analysis) -> Vec<String> {
        let weighted = "counts count every point once, whatever its weight";
        let given = subject.request.input.weight_column.is_some();
        given.then(|| weighted.to_string()).into_iter().collect()
    }
}

impl fmt::Display for InBoxes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

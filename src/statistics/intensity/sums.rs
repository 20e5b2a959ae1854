//! Sums of kernels on a grid, and a pass before them where their bandwidth is to be found.

use std::any::Any;
use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, IntensityScores, IntensitySums};
use crate::compute::Session;
use crate::error::Result;
use crate::estimate::{Analysis, Intensity, IntensityChoice};
use crate::plan::{Batch, IntensityBandwidth, IntensityPlan, IntensitySearch};
use crate::points::Ensemble;
use crate::request::{Request, Statistic};
use crate::statistics::group::{Ask, Group, Part, PartSums, Parts, Subject, of};

/// What the bandwidth is found by.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Search(IntensitySearch);

/// The plan of the grid; until its bandwidth is found that is Scott's of uniform points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OnGrid {
    plan: IntensityPlan,
    rule: IntensityBandwidth,
    /// Whether the bandwidth is still to be found.
    searched: bool,
    found: Option<IntensityChoice>,
}

/// Plans them, if they are wanted.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    if !ask.wants(Statistic::Intensity) {
        return Ok(());
    }
    let rule = ask.request.input.intensity_bandwidth.unwrap_or(IntensityBandwidth::Scott);
    let plan = IntensityPlan::new(ask.domain, ask.request.intensity_grid, rule, ask.shape)?;
    let search = IntensitySearch::new(ask.domain, rule, ask.shape);
    let searched = search.is_some();
    search.into_iter().for_each(|search| parts.add(Search(search)));
    parts.add(OnGrid { plan, rule, searched, found: None });
    Ok(())
}

impl Group for Search {
    type Sums = IntensityScores;

    const NAME: &'static str = "intensity bandwidth";
    const STAGE: &'static str = "intensity (bandwidth)";

    fn statistics(&self) -> Vec<Statistic> {
        Vec::new()
    }

    fn identity(&self) -> Value {
        json!({ "bandwidths": self.0.bandwidths, "points": self.0.points })
    }

    fn batch(&self) -> Batch {
        self.0.batch
    }

    fn seconds(&self, n: f64) -> f64 {
        let dim = self.0.domain.dim() as f64;
        1e-8 * dim * n * n.min(self.0.points as f64) * self.0.bandwidths.len() as f64
    }

    fn none(&self, _: ComputedBy) -> IntensityScores {
        IntensityScores::new(self.0.bandwidths.len())
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<IntensityScores> {
        session.intensity_scores(&self.0, batch)
    }

    fn estimate(&self, _: &IntensityScores, _: &Subject<'_>, _: &mut Analysis) {}
}

impl Group for OnGrid {
    type Sums = IntensitySums;

    const NAME: &'static str = "intensity";
    const STAGE: &'static str = "intensity";

    fn statistics(&self) -> Vec<Statistic> {
        vec![Statistic::Intensity]
    }

    fn identity(&self) -> Value {
        let bandwidth = match self.rule {
            IntensityBandwidth::Given(bandwidth) => bandwidth.into(),
            rule => Value::from(rule.to_string()),
        };
        json!({ "cells": self.plan.cells, "bandwidth": bandwidth })
    }

    fn batch(&self) -> Batch {
        self.plan.batch
    }

    fn seconds(&self, n: f64) -> f64 {
        n * (4e-10 * self.plan.cell_count() as f64 + 1e-8 * self.plan.cells as f64)
    }

    fn none(&self, _: ComputedBy) -> IntensitySums {
        IntensitySums::new(self.plan.cell_count())
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<IntensitySums> {
        session.intensity(&self.plan, batch).await
    }

    fn estimate(&self, sums: &IntensitySums, _: &Subject<'_>, found: &mut Analysis) {
        let intensity = Intensity::new(&self.plan, sums);
        found.findings.add(intensity.map(|intensity| Intensity { choice: self.found, ..intensity }));
    }

    fn warnings(&self, _: &IntensitySums, subject: &Subject<'_>, _: &Parts, _: &Analysis) -> Vec<String> {
        let mut warnings = Vec::new();
        if subject.request.input.weight_column.is_some() {
            warnings.push("the intensity counts every point once, whatever its weight".into());
        }
        let plan = &self.plan;
        let cell = plan.domain.sides().iter().map(|side| side / plan.cells as f64).fold(0.0, f64::max);
        if plan.bandwidth < 0.5 * cell {
            warnings.push(format!(
                "the bandwidth of the intensity, {:.4e}, is less than half a cell of its grid, {cell:.4e} wide: points between the \
                 middles of cells are missed; a larger `intensity_grid` or `intensity_bandwidth` avoids it",
                plan.bandwidth
            ));
        }
        if let Some((found, [lo, hi])) = self.found.filter(|f| f.at_end).and_then(|f| Some((f, f.range?))) {
            warnings.push(format!(
                "likelihood cross-validation found no largest likelihood within bandwidths from {lo:.4e} to {hi:.4e}: {:.4e} is the \
                 end of that range",
                found.bandwidth
            ));
        }
        warnings
    }

    fn waits_for(&self) -> Option<&'static str> {
        self.searched.then_some(Search::NAME)
    }

    fn after(&self, sums: &dyn PartSums, search: &dyn Part, _: &Request) -> Result<Self> {
        let search: Option<&Search> = (search as &dyn Any).downcast_ref();
        let Some((Search(search), scores)) = search.zip(of::<IntensityScores>(sums)) else { return Ok(self.clone()) };
        let found = IntensityChoice::new(search, scores);
        let plan = found.map_or_else(|| self.plan.clone(), |found| self.plan.with_bandwidth(found.bandwidth));
        Ok(Self { plan, searched: false, found, ..self.clone() })
    }
}

impl fmt::Display for Search {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Display for OnGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.plan.fmt(f)
    }
}

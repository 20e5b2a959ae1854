//! Pairs by the vector between them.

use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, Decoder, Encoder, LagCounts, Sums};
use crate::compute::Session;
use crate::error::{Error, Result};
use crate::estimate::{Analysis, VectorCorrelation};
use crate::plan::{Batch, Correction, DEFAULT_LAG_BINS, DEFAULT_LAG_RINGS, LagGrid, LagPlan, LagReach};
use crate::points::Ensemble;
use crate::request::Statistic;
use crate::statistics::group::{Ask, Effort, Group, Parts, Subject, digest};
use crate::statistics::pairs::{correction, pairs_of};

/// Bins per axis of the grid behind lag rings.
const LAG_RING_GRID: usize = 128;

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lags {
    pub(crate) lags: LagPlan,
    /// The lag rings, on a finer grid of their own.
    lag_rings: Option<LagPlan>,
}

/// The sums of both.
#[derive(Debug, Clone)]
pub(crate) struct LagSums {
    lags: LagCounts,
    lag_rings: Option<LagCounts>,
}

/// Plans them, if they are wanted.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    if ask.wants(Statistic::PcfVector) {
        let lags = lags(ask)?;
        let lag_rings = lag_rings(ask, &lags)?;
        parts.add(Lags { lags, lag_rings });
    }
    Ok(())
}

/// The lags a request asks for. Corrections that are only for g(r) are left to it.
fn lags(ask: &Ask<'_>) -> Result<LagPlan> {
    let Ask { request, domain, shape, .. } = *ask;
    let reach = request.lag_max.unwrap_or_else(|| LagReach::usual(domain, shape.mean_points));
    let grid = LagGrid::new(domain, request.lag_bins.unwrap_or(DEFAULT_LAG_BINS), reach.limit())?;
    grid.check_cells(domain)?;
    let correction = match correction(request, domain) {
        Correction::Isotropic | Correction::Border if ask.wants(Statistic::Pcf) => Correction::Translation,
        other => other,
    };
    // Lag rings have a grid of their own.
    LagPlan::new(domain, grid, correction, (domain.dim() == 2).then_some(&[]), shape)
}

/// The lag rings, along which g of the vector is followed in 2D: by default at half, 1 and 2 closest-packing distances, as
/// far as they fit. Their cells are so small that g hardly changes within one, and the grid ends beyond the largest.
fn lag_rings(ask: &Ask<'_>, lags: &LagPlan) -> Result<Option<LagPlan>> {
    let (domain, shape) = (&lags.domain, lags.shape);
    let limit = domain.shortest_side() / if domain.is_torus() { 2.0 } else { 1.0 };
    let radii = match &ask.request.lag_rings {
        None if domain.dim() != 2 => return Ok(None),
        // Refused, in its own words.
        Some(radii) if domain.dim() != 2 => {
            return LagPlan::new(domain, lags.grid.clone(), lags.correction, Some(radii), shape).map(Some);
        }
        Some(radii) => radii.clone(),
        None => {
            let unit = domain.closest_packing_distance(shape.mean_points);
            DEFAULT_LAG_RINGS.map(|k| k * unit).into_iter().filter(|r| 1.02 * r < limit).collect()
        }
    };
    let largest = radii.iter().copied().fold(0.0, f64::max);
    if radii.is_empty() {
        return Ok(None);
    }
    let half = if largest > 0.0 { (1.02 * largest).min(limit) } else { limit };
    let grid = LagGrid::new(domain, LAG_RING_GRID, Some(half))?;
    LagPlan::new(domain, grid, lags.correction, Some(&radii), shape).map(Some)
}

impl Group for Lags {
    type Sums = LagSums;

    const NAME: &'static str = "g of the vector";
    const STAGE: &'static str = "lag_counts";

    fn statistics(&self) -> Vec<Statistic> {
        vec![Statistic::PcfVector]
    }

    fn identity(&self) -> Value {
        let of = |plan: &LagPlan| {
            let sectors = plan.sectors.iter().flat_map(|s| [s.r, s.theta]).flatten();
            json!({
                "bins": plan.grid.bins,
                "half": plan.grid.half,
                "correction": plan.correction,
                "sectors": digest(sectors),
            })
        };
        json!({ "lags": of(&self.lags), "rings": self.lag_rings.as_ref().map(of) })
    }

    fn batch(&self) -> Batch {
        let all = [Some(self.lags.batch), self.lag_rings.as_ref().map(|plan| plan.batch)];
        all.into_iter().flatten().min_by_key(|batch| batch.realizations).unwrap_or(self.lags.batch)
    }

    fn none(&self, by: ComputedBy) -> LagSums {
        let lag_rings = self.lag_rings.as_ref().map(|plan| LagCounts::new(by.clone(), plan));
        LagSums { lags: LagCounts::new(by, &self.lags), lag_rings }
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<LagSums> {
        session.in_pieces(if self.lag_rings.is_some() { 2 } else { 1 });
        let lags = session.lag_counts(&self.lags, batch).await?;
        let lag_rings = match &self.lag_rings {
            Some(lag_rings) => Some(session.lag_counts(lag_rings, batch).await?),
            None => None,
        };
        Ok(LagSums { lags, lag_rings })
    }

    fn estimate(&self, sums: &LagSums, subject: &Subject<'_>, found: &mut Analysis) {
        let of = |plan, sums| VectorCorrelation::new(plan, sums, subject.request.normalization);
        let lag_rings = self.lag_rings.as_ref().zip(sums.lag_rings.as_ref()).map(|(plan, sums)| of(plan, sums).sectors);
        let sectors = lag_rings.unwrap_or_default();
        found.findings.insert(VectorCorrelation { sectors, ..of(&self.lags, &sums.lags) });
    }

    fn effort(&self, n: u64) -> Effort {
        Effort { pairs: pairs_of(n), products: 0.0 }
    }

    fn seconds(&self, n: f64) -> f64 {
        let grids = if self.lag_rings.is_some() { 2.0 } else { 1.0 };
        1.2e-9 * grids * n * n / 2.0
    }
}

impl Sums for LagSums {
    fn merge(&mut self, other: Self) -> Result<()> {
        self.lags.merge(&other.lags)?;
        match (&mut self.lag_rings, &other.lag_rings) {
            (Some(lag_rings), Some(other)) => lag_rings.merge(other),
            (None, None) => Ok(()),
            _ => Err(Error::input("lag counts", "one part has rings, the other has none")),
        }
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.lags.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        out.value("rings", self.lag_rings.is_some());
        out.within("lags", |out| self.lags.encode(out));
        if let Some(lag_rings) = &self.lag_rings {
            out.within("rings", |out| lag_rings.encode(out));
        }
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let lag_rings: bool = from.read("rings")?;
        let lags = from.within("lags", LagCounts::decode)?;
        Ok(Self { lags, lag_rings: lag_rings.then(|| from.within("rings", LagCounts::decode)).transpose()? })
    }
}

impl fmt::Display for Lags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.lags.fmt(f)?;
        match &self.lag_rings {
            Some(lag_rings) => write!(f, "along rings: {lag_rings}"),
            None => Ok(()),
        }
    }
}

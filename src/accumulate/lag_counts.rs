//! Raw sums of `lag_counts`: integers only, so any order of additions gives the same sums.

use super::pair_counts::{PairHistogram, Ratios, Steps};
use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};
use crate::plan::LagPlan;

/// Sums over realizations of what the vector g and its errors need. Merging is exact and associative.
#[derive(Debug, Clone, PartialEq)]
pub struct LagCounts {
    /// Who computed them.
    pub computed_by: ComputedBy,
    /// Number of realizations.
    pub realizations: u64,
    /// The units of the sums below.
    pub steps: Steps,
    /// Ordered pairs per cell of the grid, x axis first.
    pub cells: Ratios,
    /// Ordered pairs per sector of the plan's rings.
    pub sectors: Ratios,
}

impl LagCounts {
    /// No realizations yet.
    pub fn new(computed_by: ComputedBy, plan: &LagPlan) -> Self {
        Self {
            computed_by,
            realizations: 0,
            steps: Steps::ONE,
            cells: Ratios::new(plan.grid.cells(), false),
            sectors: Ratios::new(plan.sectors.len(), false),
        }
    }

    /// Adds one realization: ordered pairs per cell.
    pub fn add(&mut self, plan: &LagPlan, histogram: &PairHistogram) {
        let count = |cell: usize| u128::from(histogram.counts[cell]);
        self.realizations += 1;
        self.cells.add(histogram, self.steps, count);
        self.sectors.add(histogram, self.steps, |s| plan.sectors[s].cells.iter().map(|&c| count(c as usize)).sum());
    }

    /// Adds other realizations of the same process, counted on the same grid.
    ///
    /// # Errors
    /// Sums of another shape.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        let kind = |c: &Self| (c.cells.sums.len(), c.sectors.sums.len());
        if kind(self) != kind(other) {
            let (a, b) = (self.cells.sums.len(), other.cells.sums.len());
            return Err(Error::input(
                "lag counts",
                format!("{a} cells cannot be merged with {b}, or the rings differ"),
            ));
        }
        self.computed_by = self.computed_by.merge(&other.computed_by);
        self.realizations += other.realizations;
        self.cells.merge(&other.cells);
        self.sectors.merge(&other.sectors);
        Ok(())
    }
}

impl Sums for LagCounts {
    fn merge(&mut self, other: Self) -> Result<()> {
        Self::merge(self, &other)
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        self.computed_by.encode(out);
        out.value("realizations", self.realizations);
        self.cells.encode("cells", out);
        self.sectors.encode("sectors", out);
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        Ok(Self {
            computed_by: ComputedBy::decode(from)?,
            realizations: from.count("realizations")?,
            steps: Steps::ONE,
            cells: Ratios::decode("cells", from)?,
            sectors: Ratios::decode("sectors", from)?,
        })
    }
}

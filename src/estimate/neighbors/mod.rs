//! Raw sums -> nearest-neighbour statistics.

mod bonds;
mod clark_evans;
mod cross;
mod distances;
mod functions;

pub use bonds::BondOrder;
pub use clark_evans::ClarkEvans;
pub use cross::CrossNeighbors;
pub use distances::NeighborDistances;
pub use functions::NeighborFunctions;

use crate::accumulate::NeighborSums;
use crate::estimate::Analysis;
use crate::plan::{EnsembleShape, NeighborPlan};

/// All that `neighbors` stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbors {
    /// Distances in a few numbers.
    pub distances: NeighborDistances,
    /// Their mean beside that of independent points, where that is known.
    pub clark_evans: Option<ClarkEvans>,
    /// Their distribution functions.
    pub functions: NeighborFunctions,
    /// Bond-orientational order, or why there is none.
    pub bonds: Result<BondOrder, &'static str>,
}

impl Neighbors {
    /// The estimates.
    pub fn new(plan: &NeighborPlan, sums: &NeighborSums, shape: EnsembleShape) -> Self {
        Self {
            distances: NeighborDistances::new(&sums.realizations),
            clark_evans: ClarkEvans::new(&sums.realizations, &plan.domain),
            functions: NeighborFunctions::new(plan, sums, shape),
            bonds: BondOrder::new(&sums.realizations),
        }
    }
}

impl Analysis {
    /// Nearest-neighbour statistics.
    pub fn neighbors(&self) -> Option<&Neighbors> {
        self.get()
    }
}

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

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Of the mean, from the spread of the values; `None` for fewer than two.
fn standard_error(values: &[f64]) -> Option<f64> {
    let mean = mean(values).filter(|_| values.len() >= 2)?;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    let k = values.len() as f64;
    Some((squares / (k * (k - 1.0))).sqrt())
}

impl Analysis {
    /// Nearest-neighbour statistics.
    pub fn neighbors(&self) -> Option<&Neighbors> {
        self.get()
    }
}

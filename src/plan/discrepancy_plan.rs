//! The plan for discrepancies.

use std::fmt;

use super::{Batch, EnsembleShape, refuse_polygon};
use crate::error::Result;
use crate::points::Domain;

/// Everything decided about discrepancies before any is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscrepancyPlan {
    /// The domain, scaled to the unit cube by all but the distances.
    pub domain: Domain,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

impl DiscrepancyPlan {
    /// Of points in a torus or a box.
    ///
    /// # Errors
    /// A polygon, which is no cube.
    pub fn new(domain: &Domain, shape: EnsembleShape) -> Result<Self> {
        refuse_polygon(domain, "discrepancy")?;
        // Coordinates in the unit cube, their integers, sorted into a tree.
        Ok(Self { domain: domain.clone(), batch: Batch::new(shape, shape.max_points * 96) })
    }
}

impl fmt::Display for DiscrepancyPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "discrepancies: star, centred, wrap-around, mixture, diaphony; all pairs in f64")?;
        writeln!(f, "  nets in base 2 where n is a power of 2; covering radius by branch and bound")
    }
}

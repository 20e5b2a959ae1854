//! Nearest-neighbour distances (being written).

/// Distances to the nearest neighbour.
#[derive(Debug, Clone, PartialEq)]
pub struct NeighborDistances {
    /// Smallest over all realizations, in the domain's length unit; `None` if no realization has two points.
    pub minimum: Option<f64>,
    /// Mean over points, then over realizations.
    pub mean: Option<f64>,
    /// Standard error of `mean` across realizations (K >= 2).
    pub mean_se: Option<f64>,
    /// `minimum` in units of the closest-packing distance.
    pub minimum_relative: Option<f64>,
    /// `mean` in units of the closest-packing distance.
    pub mean_relative: Option<f64>,
}

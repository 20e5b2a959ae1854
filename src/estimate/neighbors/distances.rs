//! Nearest-neighbour distances in a few numbers.
//!
//! `d_i = min_(j != i) |x_i - x_j|`, minimum image on a torus, plain in a window, without edge correction: near the edge of
//! a window d_i is too long on average. Reported are the least d_i and their mean, also relative to the distance in the
//! closest packing of as many points (Lagae, Dutre, "A Comparison of Methods for Generating Poisson Disk Distributions",
//! CGF 2008).

use crate::accumulate::{Distances, RealizationNeighbors};
use crate::estimate::{mean, standard_error};

/// Nearest-neighbour distances of a batch, over the realizations that have two points or more. Means over realizations
/// count every one alike, whatever its n: they are not ratios of sums, unlike elsewhere in `estimate`.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct NeighborDistances {
    /// Smallest over all realizations, in the domain's length unit; `None` if no realization has two points.
    pub minimum: Option<f64>,
    /// Mean over realizations of the minimum of each.
    pub mean_minimum: Option<f64>,
    /// Standard error of `mean_minimum` across realizations (K >= 2).
    pub mean_minimum_se: Option<f64>,
    /// Mean over realizations of the mean over the points of each.
    pub mean: Option<f64>,
    /// Standard error of `mean` across realizations (K >= 2).
    pub mean_se: Option<f64>,
    /// As `minimum`, each realization in units of the closest-packing distance of its n.
    pub minimum_relative: Option<f64>,
    /// As `mean_minimum`, likewise.
    pub mean_minimum_relative: Option<f64>,
    /// As `mean`, likewise.
    pub mean_relative: Option<f64>,
}

impl NeighborDistances {
    pub(super) fn new(realizations: &[RealizationNeighbors]) -> Self {
        let all: Vec<Distances> = realizations.iter().filter_map(|r| r.distances).collect();
        let each = |f: fn(&Distances) -> f64| all.iter().map(f).collect::<Vec<_>>();
        let least = |values: Vec<f64>| values.into_iter().reduce(f64::min);
        let (minima, means) = (each(|d| d.minimum), each(|d| d.mean));
        let relative_minima = each(|d| d.minimum / d.closest_packing);
        Self {
            mean_minimum: mean(&minima),
            mean_minimum_se: standard_error(&minima),
            minimum: least(minima),
            mean: mean(&means),
            mean_se: standard_error(&means),
            mean_minimum_relative: mean(&relative_minima),
            minimum_relative: least(relative_minima),
            mean_relative: mean(&each(|d| d.mean / d.closest_packing)),
        }
    }
}

//! The index of Clark and Evans: the mean nearest-neighbour distance beside that of independent points.

use crate::accumulate::RealizationNeighbors;
use crate::estimate::{mean, standard_error};
use crate::points::Domain;

/// The index of a batch (Clark and Evans, "Distance to nearest neighbor as a measure of spatial relationships in
/// populations", Ecology 35, 1954): 1 for independent points, below it where they cluster, above it where they keep apart,
/// 2.149 for the triangular lattice.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ClarkEvans {
    /// Mean over realizations of `mean d / E d`, `d` the distances from points to the nearest other.
    pub index: f64,
    /// Its standard error across realizations (K >= 2).
    pub index_se: Option<f64>,
    /// How many standard errors of independent points the means of d are from what they expect, over all realizations.
    pub z: f64,
}

/// What n independent points expect of the mean of d, and its standard error.
///
/// On a torus `E d = Gamma(1 + 1/d) / (lambda v)^(1/d)`, v the unit ball, and `var = c / (n lambda^(2/d))`. As neighbours
/// share their distance, c is not the variance of one: 1/6 in 1D by hand, in 2D as found by Donnelly ("Simulations to
/// determine the variance and edge effect of total nearest-neighbour distance", 1978), in 3D by simulation of 2e4 sets. In
/// a rectangle it is Donnelly's correction for distances that are too long near its sides. In other windows none is known.
fn expected(domain: &Domain, n: f64) -> Option<(f64, f64)> {
    let (measure, sides) = (domain.measure(), domain.sides());
    if !domain.is_torus() {
        let &[a, b] = sides else { return None };
        if domain.as_polygon().is_some() {
            return None;
        }
        let border = 2.0 * (a + b);
        let mean = 0.5 * (measure / n).sqrt() + (0.0514 + 0.041 / n.sqrt()) * border / n;
        return Some((mean, (0.0703 * measure / (n * n) + 0.037 * border * (measure / n.powi(5)).sqrt()).sqrt()));
    }
    let (mean, variance): (f64, f64) =
        [(0.5, 1.0 / 6.0), (0.5, 0.0703), (0.553_960_278_365_090_2, 0.0509)][sides.len() - 1];
    let spacing = (measure / n).powf(1.0 / sides.len() as f64);
    Some((mean * spacing, (variance / n).sqrt() * spacing))
}

impl ClarkEvans {
    /// `None` where no realization has two points, or in a window that is no rectangle.
    pub(super) fn new(realizations: &[RealizationNeighbors], domain: &Domain) -> Option<Self> {
        let each = realizations.iter().filter_map(|r| Some((r.distances?.mean, expected(domain, r.n as f64)?)));
        let each: Vec<_> = each.collect();
        let ratios: Vec<f64> = each.iter().map(|(d, (mean, _))| d / mean).collect();
        // In units of what each expects, so that few points do not outweigh many.
        let variance: f64 = each.iter().map(|(_, (mean, se))| (se / mean).powi(2)).sum();
        let index = mean(&ratios)?;
        let beyond: f64 = ratios.iter().map(|ratio| ratio - 1.0).sum();
        Some(Self { index, index_se: standard_error(&ratios), z: beyond / variance.sqrt() })
    }
}

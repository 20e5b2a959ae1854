//! What `summary.json` says of g of the vector.

use serde::Serialize;

use crate::display::{LAG_QUANTILE, lag_color_range};
use crate::estimate::{Analysis, ErrorSource, Normalization};
use crate::plan::Correction;

#[derive(Serialize)]
pub(super) struct VectorOut {
    bins: Vec<usize>,
    /// Lags are in [-H, H) per axis, in length units.
    half_widths: Vec<f64>,
    ordered_pairs: u64,
    normalization: Normalization,
    correction: Correction,
    errors: ErrorSource,
    rings: Vec<f64>,
    /// g at the ends of the colours of the picture, which are symmetric about 1; beyond them it is clipped.
    picture_range: Option<[f64; 2]>,
    /// The part of cells within the range, unless that would exceed [0, 2].
    picture_quantile: Option<f64>,
}

/// Of the grid and its picture.
pub(super) fn vector(a: &Analysis) -> Option<VectorOut> {
    a.vector().map(|v| VectorOut {
        bins: vec![v.grid.bins; v.grid.dim()],
        half_widths: v.grid.half.clone(),
        ordered_pairs: v.count.iter().sum(),
        normalization: v.normalization,
        correction: v.correction,
        errors: v.errors,
        rings: v.sectors.chunk_by(|a, b| a.r == b.r).map(|ring| ring[0].r[1]).collect(),
        picture_range: (v.grid.dim() > 1).then(|| lag_color_range(v)),
        picture_quantile: (v.grid.dim() > 1).then_some(LAG_QUANTILE),
    })
}

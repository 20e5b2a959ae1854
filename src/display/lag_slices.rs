//! g on planes through lag 0, as pictures and readouts show it.

use crate::estimate::VectorCorrelation;
use crate::plan::LagGrid;

/// Of all cells, the part whose |g - 1| is within the colours' range, unless the range would exceed 1.
pub(crate) const LAG_QUANTILE: f64 = 0.999;

/// g at the two ends of the colours: symmetric about 1, as far as all but a few cells reach, at most [0, 2].
pub(crate) fn lag_color_range(vector: &VectorCorrelation) -> [f64; 2] {
    let mut off: Vec<f64> = vector.g.iter().map(|g| (g - 1.0).abs()).filter(|d| d.is_finite()).collect();
    off.sort_by(f64::total_cmp);
    let reach = off.get((off.len().saturating_sub(1) as f64 * LAG_QUANTILE).round() as usize).copied().unwrap_or(1.0);
    let reach = reach.clamp(1e-6, 1.0);
    [1.0 - reach, 1.0 + reach]
}

/// Axes to the right and upward of each panel.
pub(crate) fn lag_planes(dim: usize) -> &'static [[usize; 2]] {
    match dim {
        1 => &[],
        2 => &[[0, 1]],
        _ => &[[0, 1], [0, 2], [1, 2]],
    }
}

/// g in a plane of the grid; in 3D the mean over the bins of the third axis that touch lag 0, whose expected counts are
/// equal, so that it is the ratio of their sums.
pub(crate) fn lag_slice(vector: &VectorCorrelation, axes: [usize; 2], place: [usize; 2]) -> f64 {
    let [a, b] = lag_slice_cells(&vector.grid, axes, place);
    0.5 * (vector.g[a] + vector.g[b])
}

/// The cells of `lag_slice`; twice the same where there is only one.
pub(crate) fn lag_slice_cells(grid: &LagGrid, [right, up]: [usize; 2], [x, y]: [usize; 2]) -> [usize; 2] {
    let strides = grid.strides();
    let cell = x * strides[right] + y * strides[up];
    if grid.dim() == 2 {
        return [cell; 2];
    }
    let depth = strides[3 - right - up];
    [cell + (grid.bins - 1) / 2 * depth, cell + grid.bins / 2 * depth]
}

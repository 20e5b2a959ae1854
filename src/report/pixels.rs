//! Pictures for a screen, not encoded: one pixel per mode of P, or per cell of lags of g.

use super::color_map::ColorMap;
use super::figure;
use super::spectrum_image::{DC, middle};
use super::tone_map::ToneMap;
use super::vector_image::{panels, range, slice};
use crate::analysis::Analysis;

/// A picture, row by row from the top, i.e. from the highest y.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixels {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// 8-bit sRGB, 3 bytes a pixel.
    pub rgb: Vec<u8>,
    /// From the left edge of the picture to the right, and from the lower to the upper: frequencies in cycles per unit length, or
    /// lags in the domain's length unit.
    pub extent: [[f64; 2]; 2],
    /// Which axes of the domain are to the right and upward.
    pub axes: [usize; 2],
}

/// P on the grid, a pixel per mode with `nu = m / L` at its centre, DC grey; in 3D the plane m_z = 0. At most `|m| <= 1023` per
/// axis. `None` in 1D, for a list of wave vectors, and where the grid was not asked for.
pub fn spectrum_pixels(analysis: &Analysis, tone_map: ToneMap, colors: ColorMap) -> Option<Pixels> {
    let spectrum = analysis.spectrum.as_ref().filter(|_| analysis.grid_wanted)?;
    let grid = spectrum.waves.grid().filter(|grid| grid.dim() >= 2)?;
    let [h0, h1] = middle(grid);
    let n = analysis.shape.mean_points;
    let color = |m0, m1| match (m0, m1) {
        (0, 0) => DC,
        _ => colors.color(tone_map.tone(spectrum.p[grid.half_index([m0, m1, 0])], n)),
    };
    let half = |axis: usize, h: i32| (f64::from(h) + 0.5) / analysis.domain.sides()[axis];
    Some(Pixels {
        width: 2 * h0 as usize + 1,
        height: 2 * h1 as usize + 1,
        rgb: (-h1..=h1).rev().flat_map(|m1| (-h0..=h0).flat_map(move |m0| color(m0, m1))).collect(),
        extent: [[-half(0, h0), half(0, h0)], [-half(1, h1), half(1, h1)]],
        axes: [0, 1],
    })
}

/// g on the grid of lags, a pixel per cell, with the middle of the colours at g = 1 and their ends at `1 -+ reach` (by default as
/// far as all but a few cells reach). `plane` is 0 in 2D; in 3D the slices through lag 0 are 0: (h_x, h_y), 1: (h_x, h_z),
/// 2: (h_y, h_z). `None` in 1D and for a plane there is not.
pub fn vector_pixels(analysis: &Analysis, reach: Option<f64>, colors: ColorMap, plane: usize) -> Option<Pixels> {
    let vector = analysis.vector.as_ref()?;
    let (bins, half) = (vector.grid.bins, &vector.grid.half);
    let axes = *panels(vector.grid.dim()).get(plane)?;
    let [low, high] = ends(analysis, reach)?;
    let color = |x, y| colors.color((slice(vector, axes, [x, y]) - low) / (high - low));
    Some(Pixels {
        width: bins,
        height: bins,
        rgb: (0..bins).rev().flat_map(|y| (0..bins).flat_map(move |x| color(x, y))).collect(),
        extent: axes.map(|axis| [-half[axis], half[axis]]),
        axes,
    })
}

/// g at the two ends of the colours.
fn ends(analysis: &Analysis, reach: Option<f64>) -> Option<[f64; 2]> {
    let vector = analysis.vector.as_ref()?;
    Some(reach.filter(|r| *r > 0.0).map_or_else(|| range(vector), |reach| [1.0 - reach, 1.0 + reach]))
}

/// How far from 1 g reaches in all but a few cells.
pub fn vector_reach(analysis: &Analysis) -> Option<f64> {
    ends(analysis, None).map(|[_, high]| high - 1.0)
}

/// The colour bar of `vector_pixels`: places from 0 to 1, and the g that they stand for.
pub fn vector_ticks(analysis: &Analysis, reach: Option<f64>) -> Option<Vec<(f64, String)>> {
    let [low, high] = ends(analysis, reach)?;
    let place = |(g, text): (f64, String)| ((g - low) / (high - low), text);
    Some(figure::ticks(&(low.max(0.0)..high), 6).into_iter().map(place).collect())
}

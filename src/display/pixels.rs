//! Pictures for a screen, not encoded: one pixel per mode of P, or per cell of lags of g.

use std::ops::Range;

use super::color_map::ColorMap;
use super::lag_slices::{lag_color_range, lag_planes, lag_slice};
use super::ticks;
use super::tone_map::ToneMap;
use crate::estimate::Analysis;
use crate::plan::WaveGrid;

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

/// A grid may be far larger than any screen; a picture shows at most `|m| <= HALF_SIDE` per axis, so that one mode stays
/// at least one pixel and the page stays a few MB.
const HALF_SIDE: u32 = 1023;

/// P above this is an isolated peak: far above what one realization of `n` points without peaks shows.
pub(crate) fn peak(n: f64) -> f64 {
    n.sqrt().max(32.0)
}

/// DC is n, not a fluctuation: a grey that means nothing.
pub(crate) const DC: [u8; 3] = [128; 3];

/// The largest m_x and m_y that are shown.
pub(crate) fn middle(grid: &WaveGrid) -> [i32; 2] {
    let [f0, f1, _] = grid.max_frequency();
    [f0, f1].map(|f| f.min(HALF_SIDE) as i32)
}

/// How many cells a pixel covers along each axis, and how many pixels there are along one of `cells`, where there is room for
/// `most` per axis.
fn blocks(cells: [usize; 2], most: usize) -> (usize, [usize; 2]) {
    let block = cells[0].max(cells[1]).div_ceil(most.max(1)).max(1);
    (block, cells.map(|cells| cells.div_ceil(block)))
}

/// P on the grid, a pixel per mode with `nu = m / L` at its centre, DC grey; in 3D the plane m_z = 0. At most `|m| <= 1023` per
/// axis. Where there is room for `most` pixels per axis only, a pixel covers several modes: their mean, or the largest if that
/// is an isolated peak, so that peaks are seen at any size. `white` is the number of points at the upper end of the
/// `ToneMap::Reinhard`, by default its own; frequencies beyond `reach`, in cycles per unit length, are left out. `None` in 1D, for a list of wave vectors, and where the grid was not asked for.
pub fn spectrum_pixels(
    analysis: &Analysis,
    tone_map: ToneMap,
    white: Option<f64>,
    colors: ColorMap,
    reach: Option<f64>,
    most: usize,
) -> Option<Pixels> {
    let spectrum = analysis.spectrum().filter(|_| analysis.grid_wanted)?;
    let grid = spectrum.waves.grid().filter(|grid| grid.dim() >= 2)?;
    let n = analysis.shape.mean_points;
    Some(grid_pixels(middle(grid), analysis.domain.sides(), reach, most, |columns, rows| {
        if columns.contains(&0) && rows.contains(&0) {
            return DC;
        }
        let (mut sum, mut highest) = (0.0, 0.0f64);
        for m1 in rows.clone() {
            for m0 in columns.clone() {
                let p = spectrum.p[grid.half_index([m0, m1, 0])];
                (sum, highest) = (sum + p, highest.max(p));
            }
        }
        let seen = if highest > peak(n) { highest } else { sum / (rows.len() * columns.len()) as f64 };
        colors.color(tone_map.tone(seen, white.unwrap_or(n)))
    }))
}

/// A picture of a grid of frequencies up to `half` in a domain, whose pixels have the `color` of the modes that they cover: m_x, m_y.
pub(super) fn grid_pixels(
    mut half: [i32; 2],
    sides: &[f64],
    reach: Option<f64>,
    most: usize,
    color: impl Fn(Range<i32>, Range<i32>) -> [u8; 3],
) -> Pixels {
    for (half, side) in half.iter_mut().zip(sides) {
        // A cast of what is too large saturates.
        *half = reach.map_or(*half, |reach| (*half).min((reach * side).floor() as i32).max(1));
    }
    let cells = half.map(|h| 2 * h as usize + 1);
    let (block, [width, height]) = blocks(cells, most);
    // The modes of a pixel along an axis.
    let modes = |axis: usize, k: usize| {
        let first = (k * block) as i32 - half[axis];
        first..(first + block as i32).min(half[axis] + 1)
    };
    let color = |x: usize, y: usize| color(modes(0, x), modes(1, y));
    let ends = |axis: usize, pixels: usize| {
        let low = -f64::from(half[axis]) - 0.5;
        [low, low + (pixels * block) as f64].map(|m| m / sides[axis])
    };
    Pixels {
        width,
        height,
        rgb: (0..height).rev().flat_map(|y| (0..width).flat_map(move |x| color(x, y))).collect(),
        extent: [ends(0, width), ends(1, height)],
        axes: [0, 1],
    }
}

/// g on the grid of lags, a pixel per cell, with the middle of the colours at g = 1 and their ends at `1 -+ reach` (by default as
/// far as all but a few cells reach). Where there is room for `most` pixels per axis only, a pixel is the mean of several
/// cells. `plane` is 0 in 2D; in 3D the slices through lag 0 are 0: (h_x, h_y), 1: (h_x, h_z), 2: (h_y, h_z). `None` in 1D
/// and for a plane there is not.
pub fn vector_pixels(
    analysis: &Analysis,
    reach: Option<f64>,
    colors: ColorMap,
    plane: usize,
    most: usize,
) -> Option<Pixels> {
    let vector = analysis.vector()?;
    let (bins, half) = (vector.grid.bins, &vector.grid.half);
    let axes = *lag_planes(vector.grid.dim()).get(plane)?;
    let [low, high] = ends(analysis, reach)?;
    let (block, [width, height]) = blocks([bins; 2], most);
    let cells = |k: usize| k * block..((k + 1) * block).min(bins);
    let color = |x, y| {
        let all = || cells(y).flat_map(|y| cells(x).map(move |x| lag_slice(vector, axes, [x, y])));
        colors.color((all().sum::<f64>() / all().count() as f64 - low) / (high - low))
    };
    let end = |axis: usize| -half[axis] + (width * block) as f64 * vector.grid.width(axis);
    Some(Pixels {
        width,
        height,
        rgb: (0..height).rev().flat_map(|y| (0..width).flat_map(move |x| color(x, y))).collect(),
        extent: axes.map(|axis| [-half[axis], if block == 1 { half[axis] } else { end(axis) }]),
        axes,
    })
}

/// g at the two ends of the colours.
fn ends(analysis: &Analysis, reach: Option<f64>) -> Option<[f64; 2]> {
    let vector = analysis.vector()?;
    Some(reach.filter(|r| *r > 0.0).map_or_else(|| lag_color_range(vector), |reach| [1.0 - reach, 1.0 + reach]))
}

/// How far from 1 g reaches in all but a few cells.
pub fn vector_reach(analysis: &Analysis) -> Option<f64> {
    ends(analysis, None).map(|[_, high]| high - 1.0)
}

/// The colour bar of `vector_pixels`: places from 0 to 1, and the g that they stand for.
pub fn vector_ticks(analysis: &Analysis, reach: Option<f64>) -> Option<Vec<(f64, String)>> {
    let [low, high] = ends(analysis, reach)?;
    let place = |(g, text): (f64, String)| ((g - low) / (high - low), text);
    Some(ticks::ticks(&(low.max(0.0)..high), 6).into_iter().map(place).collect())
}

//! `pcf_vector.png`: g on the grid of lags in colours that part at g = 1, lag 0 at the centre, the y axis up.

use super::spectrum_image::encode;
use crate::display::{diverging, panels, range, slice};
use crate::estimate::VectorCorrelation;

/// Pixels a panel is magnified towards, by a whole factor.
const TARGET: f64 = 640.0;
/// White pixels between panels.
const GAP: u32 = 16;
/// The picture and what it shows.
pub(super) struct VectorImage {
    pub(super) png: Vec<u8>,
    pub(super) width: u32,
    pub(super) height: u32,
    /// What is seen.
    pub(super) caption: String,
    /// g at the ends of the colours.
    pub(super) range: [f64; 2],
}

/// `None` in one dimension, where there is nothing that g(r) does not show.
pub(super) fn render(vector: &VectorCorrelation) -> Result<Option<VectorImage>, png::EncodingError> {
    let grid = &vector.grid;
    let panels = panels(grid.dim());
    if panels.is_empty() {
        return Ok(None);
    }
    let [low, high] = range(vector);
    let bins = grid.bins;
    let widest = (0..grid.dim()).map(|k| grid.width(k)).fold(0.0, f64::max);
    let longest = widest * bins as f64;
    // Pixels per cell along an axis: cells keep their shape as far as whole pixels allow.
    let pixels = |axis: usize| ((TARGET * grid.width(axis) / longest).round() as u32).max(1);
    let size = |axis: usize| pixels(axis) * bins as u32;
    let width = panels.iter().map(|p| size(p[0])).sum::<u32>() + GAP * (panels.len() as u32 - 1);
    let height = panels.iter().map(|p| size(p[1])).max().unwrap_or(1);

    let mut image = vec![255u8; 3 * (width * height) as usize];
    let mut left = 0;
    for &[right, up] in panels {
        let (dx, dy) = (pixels(right), pixels(up));
        for y in 0..size(up) {
            for x in 0..size(right) {
                let g = slice(vector, [right, up], [(x / dx) as usize, bins - 1 - (y / dy) as usize]);
                let at = 3 * (y * width + left + x) as usize;
                image[at..at + 3].copy_from_slice(&diverging((g - low) / (high - low)));
            }
        }
        left += size(right) + GAP;
    }

    let range = |axis: usize| format!("[-{0}, {0})", grid.half[axis]);
    let mut caption = format!("lags h_x in {} to the right, h_y in {} upward, lag 0 at the centre", range(0), range(1));
    if grid.dim() == 3 {
        let thick = if bins.is_multiple_of(2) { "the mean of the two slices" } else { "the slice" };
        caption = format!(
            "central slices ({thick} at lag 0 of the third axis): from left to right (h_x, h_y), (h_x, h_z) and (h_y, h_z), \
             the first to the right, the second upward, over {}, {} and {}",
            range(0),
            range(1),
            range(2)
        );
    }
    let scale = scale_text([low, high]);
    let title = "Pair correlation function g(h)";
    let png = encode(&image, [width, height], title, &format!("{caption}. {scale}"))?;
    Ok(Some(VectorImage { png, width, height, caption, range: [low, high] }))
}

/// What the colours mean, in ASCII.
fn scale_text([low, high]: [f64; 2]) -> String {
    format!("Colours: blue g <= {low:.4}, white g = 1, red g >= {high:.4} (Moreland 2009)")
}

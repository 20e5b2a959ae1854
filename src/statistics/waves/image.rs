//! `spectrum.png`: P on the frequency grid in colours, DC at the centre, the y axis up.

use super::figures::DEFINITION;
use crate::display::{DC, ToneMap, escape, human, inhomogeneous_caption, middle, paper, peak, sequential};
use crate::estimate::Analysis;
use crate::statistics::{Bar, Cells, Image};

/// What a colour means, in words; the same text is in the file and in the page.
pub(crate) fn tone_text() -> String {
    format!("{}; colour map: viridis, from dark blue through green to yellow", ToneMap::Reinhard.definition())
}

/// Pixels a small grid is magnified towards, by whole factors.
const TARGET: f64 = 1024.0;

/// No side of a picture is shorter than this part of the other.
const THINNEST: f64 = 0.25;

/// Pixels that an isolated peak has at least per axis, however large the grid.
const PEAK: u32 = 5;

/// Pixels per mode along both axes: modes keep their shape in frequency per unit length, as far as whole pixels allow, and the
/// picture is not too thin to be seen.
fn pixels(modes: [u32; 2], sides: [f64; 2]) -> [u32; 2] {
    let modes = modes.map(f64::from);
    let longest = (modes[0] / sides[0]).max(modes[1] / sides[1]);
    let mut pixels = sides.map(|side| (TARGET / side / longest).floor().max(1.0));
    let extent = |axis: usize| modes[axis] * pixels[axis];
    let longer = extent(0).max(extent(1));
    for axis in 0..2 {
        if modes[axis] * pixels[axis] < THINNEST * longer {
            pixels[axis] = (THINNEST * longer / modes[axis]).ceil();
        }
    }
    pixels.map(|p| p as u32)
}

/// `None` for a list, and in one dimension, where the radial curve already shows all.
pub(crate) fn image(analysis: &Analysis) -> Option<Image> {
    let (spectrum, grid) = analysis.grid_of_power().filter(|(_, grid)| grid.dim() >= 2)?;
    let (sides, n) = (analysis.domain.sides(), analysis.shape.mean_points);
    let [f0, f1, _] = grid.max_frequency();
    let [h0, h1] = middle(grid);
    let (columns, rows) = (2 * h0 as u32 + 1, 2 * h1 as u32 + 1);
    let [dx, dy] = pixels([columns, rows], [sides[0], sides[1]]);
    let (width, height) = (columns * dx, rows * dy);

    let tone = |p: f64| ToneMap::Reinhard.tone(p, n);
    let p = |m0: i32, m1: i32| spectrum.p[grid.half_index([m0, m1, 0])];
    // A row of modes is a row of pixels, several times.
    let mut image: Vec<u8> = Vec::with_capacity(3 * (width * height) as usize);
    let mut peaks = Vec::new();
    for m1 in (-h1..=h1).rev() {
        let start = image.len();
        for m0 in -h0..=h0 {
            let is_dc = (m0, m1) == (0, 0);
            let tone = tone(p(m0, m1));
            let color = if is_dc { DC } else { sequential(tone) };
            (0..dx).for_each(|_| image.extend(color));
            if p(m0, m1) > peak(n) && !is_dc {
                peaks.push(((m0 + h0) as u32 * dx + dx / 2, (h1 - m1) as u32 * dy + dy / 2, tone));
            }
        }
        let row = start..image.len();
        (1..dy).for_each(|_| image.extend_from_within(row.clone()));
    }
    // As large as leaves most of the picture to the rest; the highest last, and the centre stays grey.
    let room = (f64::from(width) * f64::from(height) / 4.0 / peaks.len().max(1) as f64).sqrt();
    let reach = PEAK.min(room as u32) / 2;
    if dx.min(dy) < PEAK {
        peaks.sort_by(|a, b| a.2.total_cmp(&b.2));
        let around = |at: u32, end: u32| at.saturating_sub(reach)..(at + reach + 1).min(end);
        let dc = [h0 as u32 * dx..(h0 as u32 + 1) * dx, h1 as u32 * dy..(h1 as u32 + 1) * dy];
        for &(x, y, v) in &peaks {
            let color = sequential(v);
            for y in around(y, height) {
                for x in around(x, width).filter(|x| !(dc[0].contains(x) && dc[1].contains(&y))) {
                    let at = 3 * (y * width + x) as usize;
                    image[at..at + 3].copy_from_slice(&color);
                }
            }
        }
    }

    let mut caption = format!("modes m_x = -{h0}..{h0} to the right, m_y = -{h1}..{h1} upward, ");
    if grid.dim() == 3 {
        caption.push_str("the slice m_z = 0, ");
    }
    if h0 < f0 as i32 || h1 < f1 as i32 {
        caption.push_str("the middle of a larger grid, ");
    }
    let each = if dx * dy == 1 { "one pixel".into() } else { format!("{dx} x {dy} pixels") };
    caption.push_str(&format!("each mode {each}, DC (the centre) drawn grey"));
    if !peaks.is_empty() && dx.min(dy) < PEAK && reach > 0 {
        let wide = 2 * reach + 1;
        caption.push_str(&format!(", peaks above P = {} at least {wide} pixels wide", human(peak(n))));
    }
    Some(Image {
        rgb: image,
        size: [width, height],
        title: "Power spectrum P(m)",
        description: format!("{caption}. Tone map: {}", tone_text()),
        seen: caption,
        alt: "Power spectrum on the frequency grid",
        bar: Bar::Sequential(ToneMap::Reinhard.ticks(n)),
        cells: vec![Cells::of_modes([h0, h1], "P(m)", |[m0, m1]| p(m0, m1))],
    })
}

/// `spectrum_grey.png`: the same as papers print it.
pub(super) fn grey(analysis: &Analysis) -> Option<Image> {
    let picture = paper::pixels(analysis, usize::MAX)?;
    let modes = [picture.width as u32, picture.height as u32];
    let sides = analysis.domain.sides();
    let zoom @ [dx, dy] = pixels(modes, [sides[0], sides[1]]);
    let size = [0, 1].map(|axis| modes[axis] * zoom[axis]);
    let mut rgb = Vec::with_capacity(3 * (size[0] * size[1]) as usize);
    for row in picture.rgb.chunks_exact(3 * picture.width) {
        let start = rgb.len();
        row.chunks_exact(3).for_each(|color| (0..dx).for_each(|_| rgb.extend_from_slice(color)));
        let row = start..rgb.len();
        (1..dy).for_each(|_| rgb.extend_from_within(row.clone()));
    }
    let half = modes.map(|modes| modes / 2);
    let seen = format!(
        "modes m_x = -{0}..{0} to the right, m_y = -{1}..{1} upward, up to {2} cycles per mean spacing, DC (the centre) masked",
        half[0],
        half[1],
        paper::REACH
    );
    Some(Image {
        rgb,
        size,
        title: "Power spectrum P(m)",
        description: format!("{seen}. Tone map: {}, grey", paper::TONES.definition()),
        seen,
        alt: "Power spectrum on the frequency grid, in grey",
        bar: Bar::Sequential(paper::TONES.ticks(1.0)),
        // It has no place in the page.
        cells: Vec::new(),
    })
}

/// What the picture shows.
pub(super) fn caption(a: &Analysis, seen: &str) -> Option<String> {
    let (seen, tones) = (escape(seen), escape(&tone_text()));
    Some(format!("{DEFINITION} on the frequency grid: {seen}. Tone map: {tones}.{}", inhomogeneous_caption(a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unequal_grids_are_neither_thin_nor_huge() {
        assert_eq!(pixels([2001, 7], [1.0, 1.0]), [1, 72]);
        assert_eq!(pixels([103, 103], [1.0, 1.0]), [9, 9]);
        assert_eq!(pixels([401, 101], [4.0, 1.0]), [2, 10]);
        assert_eq!(pixels([2047, 2047], [1.0, 1.0]), [1, 1]);
        assert_eq!(pixels([3, 2047], [1.0, 1.0]), [171, 1]);
    }
}

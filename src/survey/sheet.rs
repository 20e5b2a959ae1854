//! The contact sheet: a square of cells, one per pair of axes. Above the diagonal P(m), below it the points of the first
//! realization, on it the number of the axis.

use std::fmt::Write as _;

use base64::Engine as _;

use super::{Survey, View};
use crate::display::escape;
use crate::report;
use crate::statistics::Svg;

/// Width of the sheet, and the least and largest side of a cell, in px.
const WIDTH: f64 = 1000.0;
const SIDES: [f64; 2] = [56.0, 240.0];
const GAP: f64 = 6.0;
const MARGIN: f64 = 20.0;
const TOP: f64 = 66.0;

/// The sheet as SVG.
pub(super) fn svg(survey: &Survey) -> Svg {
    let axes = survey.dim as f64;
    let side = ((WIDTH - 2.0 * MARGIN) / axes - GAP).clamp(SIDES[0], SIDES[1]);
    let extent = axes * (side + GAP) - GAP;
    let (width, height) = ((extent + 2.0 * MARGIN).max(640.0), TOP + extent + 46.0);
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0}" height="{height:.0}" viewBox="0 0 {width:.0} {height:.0}" font-family="Helvetica, Arial, sans-serif" fill="#222">
<rect width="100%" height="100%" fill="#fff"/>
<text x="{MARGIN}" y="28" font-size="18" font-weight="bold">Projections on pairs of axes</text>
<text x="{MARGIN}" y="48" font-size="13">{}</text>
"##,
        escape(&survey.subject)
    );
    let corner = |column: usize, row: usize| [MARGIN + column as f64 * (side + GAP), TOP + row as f64 * (side + GAP)];
    for view in &survey.each {
        let &[a, b] = view.axes.as_slice() else { continue };
        points(&mut svg, view, corner(a, b), side);
        power(&mut svg, view, corner(b, a), side)?;
    }
    for axis in 0..survey.dim {
        let [x, y] = corner(axis, axis).map(|c| c + side / 2.0);
        let _ = writeln!(
            svg,
            r#"<text x="{x:.1}" y="{:.1}" font-size="{:.0}" text-anchor="middle">{}</text>"#,
            y + side / 10.0,
            (side / 4.0).clamp(14.0, 34.0),
            axis + 1
        );
    }
    let words = "Below the diagonal: points of the first realization, the axis of the column to the right, that of the row upwards. Above it:";
    let more = "P(m), from 0, black, to 2, white, up to 4 cycles per mean spacing, the axis of the row to the right, that of the column upwards.";
    for (k, line) in [words, more].into_iter().enumerate() {
        let y = TOP + extent + 20.0 + 15.0 * k as f64;
        let _ = writeln!(svg, r#"<text x="{MARGIN}" y="{y:.0}" font-size="11">{line}</text>"#);
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn frame(svg: &mut String, [x, y]: [f64; 2], side: f64) {
    let _ = writeln!(
        svg,
        r##"<rect x="{x:.1}" y="{y:.1}" width="{side:.1}" height="{side:.1}" fill="none" stroke="#777" stroke-width="0.8"/>"##
    );
}

fn points(svg: &mut String, view: &View, corner: [f64; 2], side: f64) {
    // Enough to see where they are, however many.
    let radius = (0.22 * side / (view.points.len().max(1) as f64).sqrt()).clamp(0.35, 1.6);
    let _ = write!(svg, r#"<path d=""#);
    for [u, v] in &view.points {
        let (x, y) = (corner[0] + u * side, corner[1] + (1.0 - v) * side);
        let _ = write!(svg, "M{x:.2} {y:.2}h0");
    }
    let _ = writeln!(svg, r##"" stroke="#000" stroke-width="{:.2}" stroke-linecap="round"/>"##, 2.0 * radius);
    frame(svg, corner, side);
}

fn power(
    svg: &mut String,
    view: &View,
    corner: [f64; 2],
    side: f64,
) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    if let Some(picture) = &view.picture {
        let size = [picture.width as u32, picture.height as u32];
        let png = report::png(&picture.rgb, size, "P(m)", "Power spectrum of a projection")?;
        let data = base64::engine::general_purpose::STANDARD.encode(png);
        let [x, y] = corner;
        let _ = writeln!(
            svg,
            r#"<image x="{x:.1}" y="{y:.1}" width="{side:.1}" height="{side:.1}" preserveAspectRatio="none" image-rendering="pixelated" href="data:image/png;base64,{data}"/>"#
        );
    }
    frame(svg, corner, side);
    Ok(())
}

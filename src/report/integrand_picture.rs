//! Integrands as pictures: a curve in 1D, values in colours in 2D, the middle slice in 3D.

use std::path::{Path, PathBuf};

use super::picture_figure::{Inset, svg as framed};
use super::{plot, png, svg};
use crate::display::figure::{BLUE, Figure, Layer, Of, Stroke};
use crate::display::{ColorMap, escape, integrand_pixels, integrand_range, ticks};
use crate::error::{Error, Result};
use crate::integrand::Integrand;
use crate::statistics::Svg;

/// Places along a side.
const SIDE: usize = 256;
/// Places along a curve.
const STEPS: usize = 2000;

/// Draws each into `dir`, which is created: `NAME.svg`. What is there is kept without `force`.
///
/// # Errors
/// What the file system says, a picture that is there among it.
pub fn draw_integrands(dir: &Path, integrands: &[&Integrand], force: bool) -> Result<Vec<PathBuf>> {
    let each = integrands.iter().map(|integrand| {
        let path = dir.join(format!("{}.svg", integrand.entry().name));
        let drawn = if integrand.dim() == 1 { curve(integrand) } else { slice(integrand) };
        let drawn = drawn.map_err(|error| Error::file(&path, std::io::Error::other(error)))?;
        plot::write(&path, drawn.as_bytes(), force)?;
        Ok(path)
    });
    each.collect()
}

/// What stands under the title: its integrals.
fn note(integrand: &Integrand) -> String {
    format!("I = {:.6}, int f² = {:.6}", integrand.integral(), integrand.square_integral())
}

fn curve(integrand: &Integrand) -> Svg {
    let at = |i: usize| (i as f64 + 0.5) / STEPS as f64;
    let points: Vec<(f64, f64)> = (0..STEPS).map(|i| (at(i), integrand.value(&[at(i)]))).collect();
    let [low, high] = integrand_range(&points.iter().map(|p| p.1).collect::<Vec<_>>());
    let room = 0.05 * (high - low);
    let line = Layer::Line {
        name: String::new(),
        color: BLUE,
        width: 2.0,
        stroke: Stroke::Solid,
        runs: vec![points],
        of: Of::Points,
    };
    svg::svg(&Figure {
        title: "Integrand f(x)".into(),
        subject: escape(integrand.spec()),
        note: note(integrand),
        x_label: "x / L".into(),
        y_label: "f".into(),
        x: 0.0..1.0,
        y: low - room..high + room,
        log_x: false,
        log_y: false,
        top: None,
        layers: vec![line],
        numbers: None,
    })
}

fn slice(integrand: &Integrand) -> Svg {
    let (colors, extent) = (ColorMap::Viridis, [[0.0, 1.0]; 2]);
    let picture = integrand_pixels(integrand, colors, [0, 1], extent, SIDE).ok_or("a line has no picture")?;
    let [low, high] = picture.range;
    let part = |v: f64| (v - low) / (high - low);
    let png = png::encode(&picture.pixels.rgb, [SIDE as u32; 2], "f(x)", "one pixel per cell, y up")?;
    let inset = Inset { png, extent, labels: ["x / L_x".into(), "y / L_y".into()] };
    let bar: Vec<(f64, String)> = ticks(&(low..high), 6).into_iter().map(|(v, text)| (part(v), text)).collect();
    let title = if integrand.dim() == 3 { "Integrand f(x, y, 1/2)" } else { "Integrand f(x, y)" };
    let caption = "Values at the centres of 256 x 256 cells.";
    framed([title, &escape(integrand.spec()), &note(integrand)], caption, &[inset], colors, "f", &bar)
}

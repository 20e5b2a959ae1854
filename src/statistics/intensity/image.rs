//! `intensity.png`: lambda(x, y) in colours, true to scale, the y axis up; in 3D the plane in the middle.

use crate::display::{DC, escape, human, sequential};
use crate::estimate::Analysis;
use crate::statistics::{At, Bar, Cells, Image, Steps};

/// Pixels of the longer side, about.
const TARGET: f64 = 640.0;

/// No side is shorter than this part of the other.
const THINNEST: f64 = 0.25;

/// `None` in one dimension.
pub(super) fn image(analysis: &Analysis) -> Option<Image> {
    let (found, sides) = (analysis.intensity()?, analysis.domain.sides());
    let (cells, dim) = (found.cells, sides.len());
    if dim < 2 {
        return None;
    }
    let [least, largest] = found.range()?;
    let longest = sides[0].max(sides[1]);
    // Whole pixels per cell.
    let zoom = [0, 1].map(|a| (TARGET * (sides[a] / longest).max(THINNEST) / cells as f64).round().max(1.0) as usize);
    let depth = if dim == 3 { cells } else { 1 };
    let tone = |lambda: f64| if largest > least { (lambda - least) / (largest - least) } else { 0.5 };
    let at = |x: usize, y: usize| (x * cells + y) * depth + depth / 2;
    let color = |x: usize, y: usize| {
        let cell = at(x, y);
        if found.inside[cell] { sequential(tone(found.lambda[cell])) } else { DC }
    };
    let (width, height) = (cells * zoom[0], cells * zoom[1]);
    let pixels = (0..height).rev().flat_map(|y| (0..width).map(move |x| (x / zoom[0], y / zoom[1])));
    let rgb = pixels.flat_map(|(x, y)| color(x, y)).collect();
    let plane = if dim == 3 { ", in the plane through the middle of z" } else { "" };
    let outside = if analysis.domain.as_polygon().is_some() { "; outside the window grey" } else { "" };
    let seen = format!(
        "x to the right, y up{plane}, {cells} x {cells} cells of {} x {} pixels; linear from {} to {} points per unit{outside}",
        zoom[0],
        zoom[1],
        human(least),
        human(largest)
    );
    let ticks = (0..=4).map(|k| f64::from(k) / 4.0).map(|t| (t, human(least + t * (largest - least)))).collect();
    let origin = analysis.domain.origin();
    let along = |axis: usize| {
        let step = sides[axis] / cells as f64;
        let first = origin[axis] + 0.5 * step;
        let (first, step) = if axis == 0 { (first, step) } else { (origin[axis] + sides[axis] - 0.5 * step, -step) };
        Steps { name: ["x", "y"][axis].into(), at: At::Even { first, step, count: cells, each: 1 } }
    };
    let inside = |cell: usize| if found.inside[cell] { found.lambda[cell] } else { f64::NAN };
    let values = (0..cells).rev().flat_map(|y| (0..cells).map(move |x| at(x, y))).map(inside).collect();
    let shown = Cells { place: [0.0, 0.0, 1.0, 1.0], axes: [along(0), along(1)], quantity: "λ", values };
    Some(Image {
        rgb,
        size: [width as u32, height as u32],
        title: "Intensity",
        description: format!("{}; colour map: viridis", seen.replace('−', "-")),
        seen,
        alt: "Intensity on a grid",
        bar: Bar::Sequential(ticks),
        cells: vec![shown],
    })
}

/// What the picture shows.
pub(super) fn caption(a: &Analysis, seen: &str) -> Option<String> {
    let found = a.intensity()?;
    let edges = if a.domain.is_torus() {
        "wrapped around the torus"
    } else {
        "divided by the part of the kernel that is in the window"
    };
    Some(format!(
        "<i>λ</i>(<b>x</b>) = ∑<sub><i>j</i></sub> <i>k</i>(<b>x</b> − <b>x</b><sub><i>j</i></sub>), mean over realizations, with a \
         Gaussian kernel <i>k</i> of standard deviation {}, {edges}: {}. Over the whole domain <i>n</i>/|<i>D</i>| is {}.",
        human(found.bandwidth),
        escape(seen),
        human(found.mean)
    ))
}

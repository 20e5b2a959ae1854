//! Pictures of g of the vector: on the grid of lags, in colours that part at g = 1, lag 0 at the centre, the y axis up; and along
//! rings, by direction.

use crate::display::figure::{BLUE, Figure, GREEN, Layer, ORANGE, Of, PURPLE, SKY, Stroke, VERMILION, band_runs, runs};
use crate::display::{
    Units, about_one, diverging, error_note, escape, human, lag_color_range, lag_planes, lag_slice, size,
};
use crate::estimate::{Analysis, Normalization, VectorCorrelation};
use crate::plan::Correction;
use crate::statistics::axes;
use crate::statistics::layers::half_turn;
use crate::statistics::{At, Bar, Cells, Image, Steps, cell};

/// Pixels a panel is magnified towards, by a whole factor.
const TARGET: f64 = 640.0;
/// White pixels between panels.
const GAP: u32 = 16;

/// `None` in one dimension, where there is nothing that g(r) does not show.
pub(super) fn image(analysis: &Analysis) -> Option<Image> {
    let vector = analysis.vector()?;
    let grid = &vector.grid;
    let panels = lag_planes(grid.dim());
    if panels.is_empty() {
        return None;
    }
    let [low, high] = lag_color_range(vector);
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
    let mut cells = Vec::new();
    for &[right, up] in panels {
        let (dx, dy) = (pixels(right), pixels(up));
        for y in 0..size(up) {
            for x in 0..size(right) {
                let g = lag_slice(vector, [right, up], [(x / dx) as usize, bins - 1 - (y / dy) as usize]);
                let at = 3 * (y * width + left + x) as usize;
                image[at..at + 3].copy_from_slice(&diverging((g - low) / (high - low)));
            }
        }
        let part = |x: u32, of: u32| f64::from(x) / f64::from(of);
        let along = |axis: usize, sign: f64| {
            let (step, count) = (sign * grid.width(axis), bins);
            let first = sign * (0.5 * grid.width(axis) - grid.half[axis]);
            Steps { name: format!("h_{}", ["x", "y", "z"][axis]), at: At::Even { first, step, count, each: 1 } }
        };
        let places = (0..bins).rev().flat_map(|y| (0..bins).map(move |x| [x, y]));
        cells.push(Cells {
            place: [part(left, width), 0.0, part(left + size(right), width), part(size(up), height)],
            axes: [along(right, 1.0), along(up, -1.0)],
            quantity: "g(h)",
            values: places.map(|place| lag_slice(vector, [right, up], place)).collect(),
        });
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
    Some(Image {
        rgb: image,
        size: [width, height],
        title: "Pair correlation function g(h)",
        description: format!("{caption}. {}", scale_text([low, high])),
        seen: caption,
        alt: "Pair correlation function on the grid of lags",
        bar: Bar::AboutOne([low, high]),
        cells,
    })
}

/// What the colours mean, in ASCII.
fn scale_text([low, high]: [f64; 2]) -> String {
    format!("Colours: blue g <= {low:.4}, white g = 1, red g >= {high:.4} (Moreland 2009)")
}

/// g of the vector in a formula.
fn definition(vector: &VectorCorrelation) -> String {
    let gamma = match vector.correction {
        Correction::None => "|<i>D</i>| times its volume",
        _ => "the integral over the cell of the set covariance |<i>D</i> ∩ (<i>D</i> + <b>h</b>)|",
    };
    let pairs = match vector.normalization {
        Normalization::Pairs => "<i>n</i>(<i>n</i> − 1)",
        Normalization::Intensity => "<i>n</i><sup>2</sup>",
    };
    format!(
        "<i>g</i>(<b>h</b>) = |<i>D</i>|<sup>2</sup> ∑<sub><i>k</i></sub> <i>c<sub>k</sub></i> / (<i>V</i> \
         ∑<sub><i>k</i></sub> {pairs}): <i>c<sub>k</sub></i> ordered pairs of realization <i>k</i> whose lag <b>h</b>, the \
         vector between the points, is in the cell, and <i>V</i> {gamma}"
    )
}

/// What the picture of the grid shows.
pub(super) fn image_caption(a: &Analysis, seen: &str) -> Option<String> {
    let vector = a.vector()?;
    let [low, high] = lag_color_range(vector).map(human);
    Some(format!(
        "{}: {}. Colours are clipped at {low} and {high}, symmetric about 1.",
        definition(vector),
        escape(seen)
    ))
}

/// In one dimension there is no picture.
pub(super) fn words(a: &Analysis) -> Option<String> {
    let vector = a.vector().filter(|v| lag_planes(v.grid.dim()).is_empty())?;
    Some(format!("{}. In one dimension it is <i>g</i>(<i>r</i>) at <i>r</i> = |<i>h</i>|.", definition(vector)))
}

/// g against direction along every ring, with bands. Opposite directions are the same, so 0 to 180 degrees are all.
pub(super) fn angular(analysis: &Analysis) -> Option<Figure> {
    let vector = analysis.vector()?;
    let values: Vec<(f64, f64)> = vector.sectors.iter().filter_map(|s| Some((s.g?, s.g_se?))).collect();
    let ends: Vec<f64> = values.iter().flat_map(|&(g, se)| [g - se, g + se]).filter(|v| v.is_finite()).collect();
    let y = about_one(&ends)?;
    let mut layers = vec![Layer::Level { name: "g = 1".into(), y: 1.0 }];
    let colors = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY];
    for (ring, color) in vector.sectors.chunk_by(|a, b| a.r == b.r).zip(colors.into_iter().cycle()) {
        let samples: Vec<_> = half_turn(ring, |s| s.theta).map(|(x, s)| (x, s.g.zip(s.g_se))).collect();
        let band = samples.iter().map(|&(x, y)| (x, y.map(|(g, se)| (g - se, g + se))));
        layers.push(Layer::Band { name: String::new(), color, runs: band_runs(band) });
        let name = format!("r = {}", human(ring[0].r[1]));
        let line = runs(samples.iter().map(|&(x, y)| (x, y.map(|y| y.0))));
        let of = Of::Rows("g", "r", cell(ring[0].r[1]));
        layers.push(Layer::Line { name, color, width: 1.6, stroke: Stroke::Solid, runs: line, of });
    }
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::PCF_ANGULAR.title.into(),
        subject: analysis.subject.clone(),
        note: format!("{} · {}", size(analysis), error_note(vector.errors, "Poisson counts")),
        x_label: axes::PCF_ANGULAR.x_label(&units),
        y_label: axes::PCF_ANGULAR.y_label(&units),
        x: 0.0..180.0,
        y,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::PCF_ANGULAR.numbers(),
    })
}

/// What the picture of rings shows.
pub(super) fn angular_caption(_: &Analysis, _: &str) -> Option<String> {
    Some(
        "The same along rings, by direction: ordered pairs over expected ones in the cells of a finer grid whose \
         centres lie in a ring and a sector. Opposite directions are the same. An isotropic pattern has level lines, up to \
         what <i>g</i> changes from cell to cell: finer cells make that less."
        .into(),
    )
}

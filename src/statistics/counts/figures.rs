//! The picture of the index of dispersion, and its caption.

use super::name;
use crate::display::figure::{BLUE, Figure, INK, Layer, Of, Stroke, VERMILION, band_runs, runs};
use crate::display::{Units, error_note, extent, size};
use crate::estimate::{Analysis, CountDispersion};
use crate::plan::CountShape;
use crate::statistics::axes;

/// Variance over mean against size, on logarithmic axes.
pub(super) fn dispersion(analysis: &Analysis) -> Option<Figure> {
    let counts = analysis.counts()?;
    let dim = analysis.domain.dim();
    let mut layers = vec![Layer::Level { name: "Poisson: 1".into(), y: 1.0 }];
    let mut shown = vec![1.0];
    let mut ends = (f64::INFINITY, 0f64);
    for (shape, color) in [(CountShape::Box, BLUE), (CountShape::Ball, VERMILION)] {
        let sizes: Vec<&CountDispersion> = counts.sizes.iter().filter(|s| s.shape == shape).collect();
        let Some((first, last)) = sizes.first().zip(sizes.last()) else { continue };
        ends = (ends.0.min(first.size), ends.1.max(last.size));
        shown.extend(sizes.iter().filter_map(|s| s.dispersion.filter(|d| *d > 0.0)));
        let at = |s: &&CountDispersion| (s.size, s.size, s.size);
        let band = |s: &&CountDispersion| {
            let (d, se) = s.dispersion.zip(s.dispersion_se)?;
            (d > 0.0).then(|| ((d - se).max(0.01 * d), d + se))
        };
        layers.push(Layer::Band {
            name: format!("{} ±1 s.e.", name(shape, dim)),
            color,
            runs: band_runs(sizes.iter().map(|s| (at(s), band(s)))),
        });
        let line = |name: String, color, column, stroke, of: fn(&CountDispersion) -> Option<f64>| Layer::Line {
            name,
            color,
            width: 1.6,
            stroke,
            runs: runs(sizes.iter().map(|s| (at(s), of(s).filter(|d| *d > 0.0)))),
            of: Of::Rows(column, "shape", shape.name().into()),
        };
        layers.push(line(name(shape, dim).into(), color, "dispersion", Stroke::Solid, |s| s.dispersion));
        if shape == CountShape::Box {
            layers.push(line("as many independent points".into(), INK, "random", Stroke::Dashed, |s| Some(s.random)));
        }
    }
    let units = Units::of(analysis).escaped();
    let (lowest, highest) = extent(&shown)?;
    let errors = counts.errors.map_or("no errors: one realization".into(), |errors| error_note(errors, ""));
    Some(Figure {
        title: axes::COUNTS.title.into(),
        subject: analysis.subject.clone(),
        note: format!("{} · {errors}", size(analysis)),
        x_label: axes::COUNTS.x_label(&units),
        y_label: axes::COUNTS.y_label(&units),
        x: ends.0..ends.1,
        y: (0.7 * lowest).max(1e-6 * highest)..1.5 * highest,
        log_x: true,
        log_y: true,
        top: None,
        layers,
        numbers: axes::COUNTS.numbers(),
    })
    .filter(|_| ends.0 < ends.1)
}

/// What the picture shows.
pub(super) fn caption(a: &Analysis, _: &str) -> Option<String> {
    let counts = a.counts()?;
    let balls = counts.largest(CountShape::Ball).map_or("", |_| " (the radius of a ball)");
    let where_put =
        if a.domain.is_torus() { "" } else { " Only places from which they do not reach out of the window count." };
    Some(format!(
        "Variance of the number of points <i>N</i> over its mean, against the side of what they are counted in{balls}. It is 1 for \
         a Poisson process; 1 − |<i>B</i>|/|<i>D</i>| for a fixed number of independent points; more for clusters; of hyperuniform \
         points it falls towards 0 as sizes grow.{where_put}"
    ))
}

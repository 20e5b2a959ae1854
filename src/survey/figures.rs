//! Scalars and spectra of prefixes against the number of points.

use std::borrow::Cow;

use super::{Survey, View};
use crate::accumulate::DISCREPANCIES;
use crate::display::escape;
use crate::display::figure::{
    BLUE, Figure, GREEN, INK, Layer, Numbers, ORANGE, Of, PURPLE, Rgb, SKY, Stroke, VERMILION,
};
use crate::statistics::cell;

/// Curves that a figure of spectra has at most: more cannot be told apart.
const MOST: usize = 7;

const COLORS: [Rgb; MOST] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, INK];

/// Both figures with the names of their files, as far as there is something to draw.
pub(super) fn drawn(survey: &Survey) -> Vec<(&'static str, Figure)> {
    let figures = [("prefixes.svg", scalars(survey)), ("prefixes_radial.svg", radial(survey))];
    figures.into_iter().filter_map(|(name, figure)| Some((name, figure?))).collect()
}

fn line(name: String, color: Rgb, points: Vec<(f64, f64)>, of: Of) -> Layer {
    Layer::Line { name, color, width: 2.0, stroke: Stroke::Solid, runs: vec![points], of }
}

/// Discrepancies, least distance and covering radius, on logarithmic scales.
fn scalars(survey: &Survey) -> Option<Figure> {
    let names = ["star L₂", "centred L₂", "wrap-around L₂", "mixture L₂", "diaphony"];
    let of = |kind: usize| -> Vec<(f64, f64)> {
        let one = |v: &View| Some((v.n, v.discrepancies.as_ref()?.each[kind].mean));
        survey.each.iter().filter_map(one).filter(|(_, y)| *y > 0.0).collect()
    };
    let curves: Vec<_> = (0..DISCREPANCIES.len()).map(of).collect();
    let all: Vec<(f64, f64)> = curves.iter().flatten().copied().collect();
    let ends =
        |values: &mut dyn Iterator<Item = f64>| values.fold([f64::INFINITY, 0f64], |[a, b], v| [a.min(v), b.max(v)]);
    let ([x0, x1], [y0, y1]) = (ends(&mut all.iter().map(|p| p.0)), ends(&mut all.iter().map(|p| p.1)));
    let each = curves.into_iter().zip(names).zip(COLORS).zip(DISCREPANCIES);
    let layers =
        each.map(|(((curve, name), color), column)| line(name.into(), color, curve, Of::Column(column.into())));
    (x0 < x1).then(|| Figure {
        title: Cow::Borrowed("Discrepancies of prefixes"),
        subject: escape(&survey.subject),
        note: "mean over realizations".into(),
        x_label: "number of points n".into(),
        y_label: "discrepancy".into(),
        x: x0..x1,
        y: y0 / 1.5..y1 * 1.5,
        log_x: true,
        log_y: true,
        top: None,
        layers: layers.collect(),
        numbers: Some(Numbers { table: "prefixes.csv", x: "n", x_factor: 1.0 }),
    })
}

/// The radial mean of P of some prefixes, spread evenly among them, against the frequency in units of `lambda^(1/d)`.
fn radial(survey: &Survey) -> Option<Figure> {
    let views: Vec<&View> = survey.each.iter().filter(|view| view.p.len() > 1).collect();
    let shown = views.len().min(MOST);
    let chosen = (0..shown).map(|k| views[if shown > 1 { k * (views.len() - 1) / (shown - 1) } else { 0 }]);
    let curves: Vec<_> = chosen.map(|v| (v.n, v.p.iter().map(|row| (row[1], row[2])).collect::<Vec<_>>())).collect();
    let end = curves.iter().flat_map(|c| c.1.last()).map(|p| p.0).fold(0.0, f64::max);
    let top = curves.iter().flat_map(|c| &c.1).map(|p| p.1).fold(1.0, f64::max);
    let level = Layer::Level { name: "independent points".into(), y: 1.0 };
    let of = |n: f64| Of::Rows("p", "n", cell(n));
    let lines = curves.into_iter().zip(COLORS).map(|((n, curve), color)| line(format!("n = {n}"), color, curve, of(n)));
    (end > 0.0).then(|| Figure {
        title: Cow::Borrowed("Radial mean of P of prefixes"),
        subject: escape(&survey.subject),
        note: format!("{shown} of {} prefixes", views.len()),
        x_label: format!(
            "frequency ν in units of λ{}",
            if survey.dim == 1 {
                ""
            } else if survey.dim == 2 {
                "^(1/2)"
            } else {
                "^(1/3)"
            }
        ),
        y_label: "P".into(),
        x: 0.0..end.min(4.0),
        y: 0.0..(1.05 * top).min(4.0),
        log_x: false,
        log_y: false,
        top: None,
        layers: std::iter::once(level).chain(lines).collect(),
        numbers: Some(Numbers { table: "prefixes_radial.csv", x: "nu_relative", x_factor: 1.0 }),
    })
}

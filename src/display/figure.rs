//! Pictures of curves as data: what is drawn in them. The palette, and how samples become lines and bands.

use std::borrow::Cow;
use std::ops::Range;

use super::Interval;
use crate::named::named;

/// 8-bit sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rgb(pub(crate) u8, pub(crate) u8, pub(crate) u8);

/// As SVG has it.
impl std::fmt::Display for Rgb {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "rgb({},{},{})", self.0, self.1, self.2)
    }
}

/// The palette (Okabe and Ito 2008, told apart by colour-blind readers) and the greys around it.
pub(crate) const BLUE: Rgb = Rgb(0, 114, 178);
pub(crate) const VERMILION: Rgb = Rgb(213, 94, 0);
pub(crate) const GREEN: Rgb = Rgb(0, 158, 115);
pub(crate) const PURPLE: Rgb = Rgb(204, 121, 167);
pub(crate) const ORANGE: Rgb = Rgb(230, 159, 0);
pub(crate) const SKY: Rgb = Rgb(86, 180, 233);
pub(crate) const INK: Rgb = Rgb(34, 34, 34);
pub(crate) const GREY: Rgb = Rgb(125, 125, 125);

/// Colours of curves in turn.
pub(crate) const IN_TURN: [Rgb; 7] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, INK];

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Whole.
    Solid,
    /// In dashes.
    Dashed,
    /// In dots.
    Dotted,
}

named!(Stroke: Solid = "solid", Dashed = "dashed", Dotted = "dotted");

impl Stroke {
    /// Lengths of dashes and of what is between them in px; none where it is whole.
    pub(crate) fn dashes(self) -> Option<(f64, f64)> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some((7.0, 4.5)),
            Self::Dotted => Some((1.8, 3.2)),
        }
    }
}

/// What is drawn, in this order.
pub(crate) enum Layer {
    /// A filled band between two curves.
    Band { name: String, color: Rgb, runs: Vec<Vec<[f64; 3]>> },
    /// A curve.
    Line { name: String, color: Rgb, width: f64, stroke: Stroke, runs: Vec<Vec<(f64, f64)>>, of: Of },
    /// A horizontal reference.
    Level { name: String, y: f64 },
    /// A vertical hint with its label (SVG text).
    Hint { x: f64, label: String },
}

/// Where the numbers of a curve stand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Of {
    /// In no table: they are what is drawn.
    Points,
    /// In a column of the figure's table.
    Column(Cow<'static, str>),
    /// In a column, in the rows that have this text in another column: (column, other, text).
    Rows(&'static str, &'static str, String),
}

/// The table that has the numbers of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Numbers {
    pub(crate) table: &'static str,
    /// The column of the abscissa; where there is none, halfway between its `_lo` and its `_hi`.
    pub(crate) x: &'static str,
    /// What of the abscissa is a unit of the axis.
    pub(crate) x_factor: f64,
}

/// A second scale on top: a tick at `t` stands at `t * unit` on the x axis.
pub(crate) struct TopAxis {
    pub(crate) label: String,
    pub(crate) unit: f64,
}

/// A picture of curves. Labels are SVG text, i.e. already escaped.
pub(crate) struct Figure {
    pub(crate) title: Cow<'static, str>,
    pub(crate) subject: String,
    pub(crate) note: String,
    pub(crate) x_label: String,
    pub(crate) y_label: String,
    pub(crate) x: Range<f64>,
    pub(crate) y: Range<f64>,
    pub(crate) log_x: bool,
    /// Only for a range that starts above 0; what is 0 leaves the frame at the bottom.
    pub(crate) log_y: bool,
    pub(crate) top: Option<TopAxis>,
    pub(crate) layers: Vec<Layer>,
    pub(crate) numbers: Option<Numbers>,
}

/// The runs of defined samples. A lone one is a step over its whole interval, so that it can be seen.
pub(crate) fn runs(samples: impl IntoIterator<Item = (Interval, Option<f64>)>) -> Vec<Vec<(f64, f64)>> {
    let banded = samples.into_iter().map(|(x, y)| (x, y.map(|y| (y, y))));
    let strip = |run: Vec<[f64; 3]>| run.into_iter().map(|[x, y, _]| (x, y)).collect();
    band_runs(banded).into_iter().map(strip).collect()
}

/// As `runs`, for pairs of values.
pub(crate) fn band_runs(samples: impl IntoIterator<Item = (Interval, Option<(f64, f64)>)>) -> Vec<Vec<[f64; 3]>> {
    let mut all: Vec<Vec<(Interval, f64, f64)>> = vec![Vec::new()];
    for (x, y) in samples {
        match (y, all.last_mut()) {
            (Some((a, b)), Some(run)) if a.is_finite() && b.is_finite() => run.push((x, a, b)),
            _ => all.push(Vec::new()),
        }
    }
    let points = |run: Vec<(Interval, f64, f64)>| match run[..] {
        [((lo, _, hi), a, b)] => vec![[lo, a, b], [hi, a, b]],
        _ => run.into_iter().map(|((_, x, _), a, b)| [x, a, b]).collect(),
    };
    all.into_iter().filter(|r| !r.is_empty()).map(points).collect()
}

/// A subscript. Its size is in px: not every program that reads SVG knows per cent.
pub(crate) fn sub(content: &str) -> String {
    format!(r#"<tspan dy="3.5" font-size="10.5">{content}</tspan><tspan dy="-3.5">&#8203;</tspan>"#)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lone_sample_is_a_step() {
        let x = |k: f64| (k, k + 0.5, k + 1.0);
        let runs = runs([(x(0.0), None), (x(1.0), Some(2.0)), (x(2.0), Some(f64::NAN)), (x(3.0), None)]);
        assert_eq!(runs, [vec![(1.0, 2.0), (2.0, 2.0)]]);
    }
}

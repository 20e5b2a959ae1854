//! g(r), P(nu) and anisotropy as polylines along two axes, and the frame that suits them.

use super::Panel;
use super::ranges::extent;
use super::samples::{Sample, Samples};
use super::units::{Axis, AxisScale, FrequencyUnit, LengthUnit};
use crate::estimate::Analysis;

/// A place on a panel, as drawn.
pub type Drawn = [f64; 2];

/// What a panel of curves draws of one analysis. Where a value is undefined lines and bands break; what has no logarithm, as 0, leaves
/// the frame at the bottom.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// The estimate.
    pub line: Vec<Vec<Drawn>>,
    /// One standard error on either side of it, (x, low, high); of anisotropy, what an isotropic spectrum scatters by. On a
    /// logarithmic scale an end at or below 0 is at the bottom of the frame.
    pub band: Vec<Vec<[f64; 3]>>,
    /// The closed form, where there is one.
    pub closed_form: Vec<Vec<Drawn>>,
    /// What complete randomness would be: 1, or of anisotropy `-10 log10 K` dB.
    pub reference: Option<f64>,
    /// The scale of the points along the first axis, and its symbol: the closest-packing distance, or one cycle per mean spacing.
    pub landmark: Option<(f64, String)>,
    /// What to show of it.
    pub frame: Frame,
}

/// The part of a plot that is seen, as drawn: (low, high) per axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// To the right.
    pub x: [f64; 2],
    /// Upward.
    pub y: [f64; 2],
}

impl Frame {
    /// One that shows both.
    pub fn union(self, other: Self) -> Self {
        let both = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self { x: both(self.x, other.x), y: both(self.y, other.y) }
    }

    /// This one `factor` times as large, per axis, with a place in it where it is.
    #[must_use]
    pub fn zoomed(self, about: [f64; 2], factor: [f64; 2]) -> Self {
        let ends = |ends: [f64; 2], k: usize| ends.map(|end| about[k] + (end - about[k]) / factor[k]);
        Self { x: ends(self.x, 0), y: ends(self.y, 1) }
    }

    /// This one where it still suits what is `wanted`, so that curves stand still while their errors shrink: x is the same, and
    /// upward nothing wanted is cut off that does not fill three fifths of it.
    pub fn kept(self, wanted: Self) -> Self {
        let height = |frame: Self| frame.y[1] - frame.y[0];
        let inside = self.y[0] <= wanted.y[0] && wanted.y[1] <= self.y[1];
        if self.x == wanted.x && inside && height(wanted) >= 0.6 * height(self) { self } else { wanted }
    }
}

impl Trace {
    /// The range upward of what is drawn between two places to the right, with some room; `None` where nothing is.
    pub fn fit(&self, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
        let all = self.line.iter().chain(&self.closed_form).flatten();
        let seen: Vec<f64> = all.filter(|place| (low..=high).contains(&place[0])).map(|place| place[1]).collect();
        let (lowest, highest) = extent(&seen)?;
        // Not after what leaves the frame at the bottom.
        let lowest = lowest.max(self.frame.y[0]).min(highest);
        let room = 0.06 * (highest - lowest).max(1e-9 * highest.abs()).max(f64::MIN_POSITIVE);
        Some([lowest - room, highest + room])
    }
}

impl Panel {
    /// What it draws in lines; `None` where the analysis has none, or the panel is none of curves.
    pub fn trace(self, analysis: &Analysis, x: Axis, y: Axis) -> Option<Trace> {
        let Samples { all: samples, reference, range } = self.samples(analysis)?;
        let drawn: Vec<f64> = samples.iter().filter_map(|s| x.forward(s.interval.1)).collect();
        let first = drawn.first()?;
        let from_zero = x.scale() == AxisScale::Linear && samples[0].interval.1 >= 0.0;
        let x_frame = [if from_zero { 0.0 } else { *first }, *drawn.last()?];
        let y_frame = match y.scale() {
            AxisScale::Linear => [y.in_unit(range.start), y.in_unit(range.end)],
            AxisScale::Log | AxisScale::Decibel => positive(&samples, y).unwrap_or([-1.0, 1.0]),
        };
        // A frame of no width would show nothing.
        let wide = |[low, high]: [f64; 2]| if low < high { [low, high] } else { [low - 0.5, low + 0.5] };
        let frame = Frame { x: wide(x_frame), y: wide(y_frame) };
        let below = frame.y[0] - 0.1 * (frame.y[1] - frame.y[0]);
        let place = |at: f64, value: Option<f64>| Some([x.forward(at)?, y.forward(value?).unwrap_or(below)]);
        let band = |s: &Sample| {
            let (low, high) = s.band?;
            let high = y.forward(high)?;
            Some([x.forward(s.interval.1)?, y.forward(low).unwrap_or(frame.y[0].min(high)), high])
        };
        Some(Trace {
            line: pieces(samples.iter().map(|s| place(s.interval.1, s.value))),
            band: pieces(samples.iter().map(band)),
            closed_form: pieces(samples.iter().map(|s| place(s.interval.1, s.closed_form))),
            reference: y.forward(reference),
            landmark: self.landmark(analysis).and_then(|(at, symbol)| Some((x.forward(at)?, symbol))),
            frame,
        })
    }

    /// Why an analysis has no such curve.
    pub fn without_curve(self, analysis: &Analysis) -> &'static str {
        let rings = matches!(self, Self::Radial | Self::Anisotropy);
        if self == Self::Anisotropy && analysis.domain.dim() == 1 {
            "in one dimension a ring is a single mode, which has no anisotropy"
        } else if rings && analysis.spectrum().is_some_and(|s| s.waves.grid().is_none()) {
            "the wave vectors of a list form no rings"
        } else {
            "these settings give no such curve"
        }
    }

    /// Why an analysis has no such picture.
    pub fn without_picture(self, analysis: &Analysis) -> &'static str {
        let listed = analysis.spectrum().is_some_and(|s| s.waves.grid().is_none());
        if analysis.domain.dim() == 1 {
            "in one dimension there is no picture: the curves show all"
        } else if self == Self::Spectrum && listed {
            "the wave vectors of a list form no grid"
        } else if self == Self::Spectrum && analysis.spectrum().is_none() {
            "only the frequencies that rings need are measured, which form no grid"
        } else {
            "these settings give no such picture"
        }
    }

    fn landmark(self, analysis: &Analysis) -> Option<(f64, String)> {
        let (domain, n) = (&analysis.domain, analysis.shape.mean_points);
        match self {
            Self::Pcf => {
                let unit = LengthUnit::PackingDistance;
                Some((unit.size(domain, n), unit.symbol(domain.dim(), analysis.unit)))
            }
            Self::Radial | Self::Anisotropy if !analysis.conventions.foreign => {
                let unit = FrequencyUnit::SqrtN;
                Some((unit.size(domain, n), unit.symbol(domain, analysis.unit)))
            }
            _ => None,
        }
    }
}

/// What is positive by rounding alone does not set a range: 12 decades below the largest value.
const LOWEST: f64 = 1e-12;

/// The range of the positive values and closed forms, with complete randomness and some room.
fn positive(samples: &[Sample], y: Axis) -> Option<[f64; 2]> {
    let values: Vec<f64> = samples.iter().flat_map(|s| [s.value, s.closed_form]).flatten().chain([1.0]).collect();
    let (_, largest) = extent(&values.iter().copied().filter(|v| v.is_finite()).collect::<Vec<_>>())?;
    let drawn = values.into_iter().filter(|v| *v > LOWEST * largest).filter_map(|v| y.forward(v));
    let (low, high) = extent(&drawn.collect::<Vec<_>>())?;
    let room = (0.05 * (high - low)).max(y.forward(1.3)?);
    Some([low - room, high + room])
}

/// Runs of what is defined.
fn pieces<T: Copy>(places: impl Iterator<Item = Option<T>>) -> Vec<Vec<T>> {
    let places: Vec<Option<T>> = places.collect();
    let runs = places.split(Option::is_none).filter(|run| !run.is_empty());
    runs.map(|run| run.iter().flatten().copied().collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_stand_still_until_they_do_not_suit() {
        let frame = |top: f64| Frame { x: [0.0, 1.0], y: [0.0, top] };
        assert_eq!(frame(2.0).kept(frame(1.5)), frame(2.0));
        assert_eq!(frame(2.0).kept(frame(1.0)), frame(1.0));
        assert_eq!(frame(2.0).kept(frame(2.1)), frame(2.1));
        let wider = Frame { x: [0.0, 2.0], ..frame(1.9) };
        assert_eq!(frame(2.0).kept(wider), wider);
        assert_eq!(frame(2.0).union(Frame { x: [-1.0, 0.5], y: [0.1, 3.0] }), Frame { x: [-1.0, 1.0], y: [0.0, 3.0] });
    }

    #[test]
    fn frames_zoom_about_a_place_and_fit_what_is_seen() {
        let frame = Frame { x: [0.0, 4.0], y: [0.0, 1.0] };
        assert_eq!(frame.zoomed([1.0, 0.5], [2.0, 1.0]), Frame { x: [0.5, 2.5], y: [0.0, 1.0] });
        let line = vec![vec![[0.0, 9.0], [1.0, 1.0], [2.0, 3.0], [3.0, -9.0]]];
        let trace = Trace { line, band: Vec::new(), closed_form: Vec::new(), reference: None, landmark: None, frame };
        let [low, high] = trace.fit([0.5, 2.5]).unwrap();
        assert!((low - 0.88).abs() < 1e-12 && (high - 3.12).abs() < 1e-12, "{low} {high}");
        assert_eq!(trace.fit([0.2, 0.8]), None);
    }

    #[test]
    fn what_is_undefined_breaks_a_line() {
        let places = [Some(1), None, None, Some(2), Some(3), None];
        assert_eq!(pieces(places.into_iter()), [vec![1], vec![2, 3]]);
    }
}

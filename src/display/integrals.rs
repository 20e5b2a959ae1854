//! Errors of integrals as they are drawn: variances over that of as many random points, and where they come from.

use super::figure::{BLUE, GREEN, INK, Rgb, VERMILION};
use super::trace::{Drawn, Frame};
use super::units::{Axis, AxisScale};
use super::{human, ticks, with_error};
use crate::estimate::{Analysis, IntegrationError, Measured};
use crate::named::named;

/// What a variance is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Predicted from the power spectrum, with its tail.
    Spectral,
    /// Predicted from pairs.
    Spatial,
    /// Observed over random shifts of each realization.
    Shifted,
    /// Observed as points are.
    AsIs,
}

named!(Form: Spectral = "spectral", Spatial = "spatial", Shifted = "shifted", AsIs = "as it is");

impl Form {
    /// The same in more words.
    pub fn title(self) -> &'static str {
        match self {
            Self::Spectral => "predicted, spectral with its tail",
            Self::Spatial => "predicted, spatial",
            Self::Shifted => "observed, shifted",
            Self::AsIs => "observed, as it is",
        }
    }

    /// The colour where all are of one set of points.
    pub(crate) fn color(self) -> Rgb {
        match self {
            Self::Spectral => BLUE,
            Self::Spatial => GREEN,
            Self::Shifted => VERMILION,
            Self::AsIs => INK,
        }
    }

    /// Whether it is predicted.
    pub fn is_predicted(self) -> bool {
        matches!(self, Self::Spectral | Self::Spatial)
    }

    fn of(self, e: &IntegrationError) -> Option<Measured> {
        match self {
            Self::Spectral => Some(e.closed),
            Self::Spatial => e.spatial,
            Self::Shifted => Some(e.shifted),
            Self::AsIs => e.observed,
        }
    }
}

/// One variance of one integrand.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBar {
    /// What it is.
    pub form: Form,
    /// Over that of as many random points, `n V / v0`.
    pub value: f64,
    /// Both ends of two standard errors; where there is none, the value.
    pub ends: [f64; 2],
    /// Value and error in the same unit: `0.031 ± 0.002`.
    pub brief: String,
    /// What it is, itself and in that unit.
    pub text: String,
}

/// All variances of one integrand.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBars {
    /// The integrand.
    pub spec: String,
    /// In the order of `Form::ALL`, those that there are.
    pub each: Vec<ErrorBar>,
    /// What the integral is, its bias, and how far predicted and observed are apart.
    pub text: Vec<String>,
}

/// What is less than this, of what random points have, is 0 but for rounding.
const ROUNDING: f64 = 1e-12;

/// Variances of all integrands.
pub fn error_bars(analysis: &Analysis) -> Vec<ErrorBars> {
    let n = analysis.shape.mean_points;
    let bars = |e: &IntegrationError| {
        let relative = |x: f64| if e.v0 > 0.0 { x * n / e.v0 } else { 0.0 };
        let bar = |form: Form| {
            let measured = form.of(e)?;
            let (value, se) = (relative(measured.value), measured.se.map(relative));
            let value = if value < ROUNDING { 0.0 } else { value };
            let reach = 2.0 * se.unwrap_or(0.0);
            let brief = with_error(value, se);
            let text = format!("{}: {} ({brief} v₀/n)", form.title(), with_error(measured.value, measured.se));
            Some(ErrorBar { form, value, ends: [value - reach, value + reach], brief, text })
        };
        let z = e.z.map(|z| format!("shifted is {} standard errors from what is predicted", human(z)));
        let integral =
            format!("I = {}, mean of estimates {}", human(e.integrand.integral()), with_error(e.mean.value, e.mean.se));
        ErrorBars {
            spec: e.integrand.spec().into(),
            each: Form::ALL.iter().copied().filter_map(bar).collect(),
            text: std::iter::once(integral).chain(z).collect(),
        }
    };
    analysis.integration().map_or_else(Vec::new, |found| found.each.iter().map(bars).collect())
}

/// A logarithmic range of variances over that of random points, 1 among them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decades {
    low: f64,
    high: f64,
}

impl Decades {
    /// One that shows them all, in steps, so that it stands still while errors shrink.
    pub fn of<'a>(all: impl IntoIterator<Item = &'a ErrorBars>) -> Self {
        let all = all.into_iter().flat_map(|bars| &bars.each).filter(|bar| bar.value > 0.0);
        // An end may be at 0 or below.
        let ends = all.map(|bar| [bar.ends[0].max(0.25 * bar.value), bar.ends[1]]);
        let (low, high) = ends.fold((1.0f64, 1.0f64), |(low, high), v| (low.min(v[0]), high.max(v[1])));
        let step = |x: f64| 4.0 * x.log10();
        Self { low: (step(low) - 0.3).floor() / 4.0, high: (step(high) + 0.3).ceil() / 4.0 }
    }

    /// Where a value is between the ends, 0 at the lower one, never beyond.
    pub fn place(self, value: f64) -> f64 {
        if value > 0.0 { ((value.log10() - self.low) / (self.high - self.low)).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Places of round numbers, and these.
    pub fn ticks(self) -> Vec<(f64, String)> {
        let all = ticks::log_ticks(&(10f64.powf(self.low)..10f64.powf(self.high)));
        all.into_iter().map(|(value, text)| (self.place(value), text)).collect()
    }
}

/// What the predicted variance comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Frequencies up to |m|.
    Frequencies,
    /// Single points, and pairs up to a distance.
    Distances,
}

/// What the variance of an integral comes from, summed along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Share {
    /// The integrand.
    pub spec: String,
    /// As drawn.
    pub line: Vec<Drawn>,
}

/// The same of all integrands.
#[derive(Debug, Clone, PartialEq)]
pub struct Shares {
    /// Their axes.
    pub axes: [Axis; 2],
    /// A curve each, in their order: empty where there is none.
    pub each: Vec<Share>,
    /// What to show of them.
    pub frame: Frame,
}

impl Origin {
    /// What is drawn, and over what.
    pub fn definition(self) -> &'static str {
        match self {
            Self::Frequencies => "The predicted variance of frequencies up to |m|, over all of it with the tail.",
            Self::Distances => {
                "The predicted variance of single points and of pairs up to |r|, over that of single points alone: what correlation takes \
                 away, and where."
            }
        }
    }

    /// What an analysis says; `None` where no integrand has a curve.
    pub fn shares(self, analysis: &Analysis) -> Option<Shares> {
        let found = analysis.integration()?;
        let sums = |e| match self {
            Self::Frequencies => frequency_sums(e),
            Self::Distances => distance_sums(e),
        };
        let all: Vec<Vec<Drawn>> = found.each.iter().map(sums).collect();
        let end =
            |least: f64, ends: fn(&[Drawn]) -> Option<f64>| all.iter().filter_map(|s| ends(s)).fold(least, f64::max);
        let ys = || all.iter().flatten().map(|place| place[1]);
        let (axes, x, y) = match self {
            Self::Frequencies => {
                let end = end(2.0, |sums| sums.iter().find(|p| p[1] > 0.99).or(sums.last()).map(|p| p[0]));
                let axis = Axis::named("|m|", "|m| (cycles per side)", AxisScale::Log);
                let y = Axis::named("share", "share of the variance", AxisScale::Linear);
                ([axis, y], [0.0, (1.05 * end).log10()], [0.0, 1.05])
            }
            Self::Distances => {
                // As far as they still change.
                let end = end(0.05, |sums| {
                    let last = sums.last()?[1];
                    sums.iter().rev().find(|p| (p[1] - last).abs() > 0.01 * (1.0 + last.abs())).map(|p| p[0])
                });
                let axis = Axis::named("|r|", "|r| (sides of the box)", AxisScale::Linear);
                let y = Axis::named("n V / v₀", "variance, of as many random points", AxisScale::Linear);
                ([axis, y], [0.0, 1.2 * end], [1.05 * ys().fold(0.0, f64::min), 1.05 * ys().fold(1.0, f64::max)])
            }
        };
        let drawn = |sums: &Vec<Drawn>| {
            sums.iter().filter_map(|p| Some([axes[0].forward(p[0])?, axes[1].forward(p[1])?])).collect::<Vec<_>>()
        };
        let name = |e: &IntegrationError| e.integrand.spec().to_string();
        let each: Vec<Share> =
            found.each.iter().zip(&all).map(|(e, sums)| Share { spec: name(e), line: drawn(sums) }).collect();
        each.iter().any(|share| share.line.len() > 1).then_some(Shares { axes, each, frame: Frame { x, y } })
    }
}

impl Shares {
    /// What the curve of an integrand is at a drawn place to the right, as drawn there and in words.
    pub fn at(&self, integrand: usize, x: f64) -> Option<(Drawn, String)> {
        let line = &self.each.get(integrand)?.line;
        let place = *line.get(line.partition_point(|p| p[0] <= x).checked_sub(1)?)?;
        let [along, value] = [self.axes[0].backward(place[0])?, self.axes[1].backward(place[1])?];
        let [x, y] = [(0, along), (1, value)].map(|(k, v)| format!("{} = {}", self.axes[k].symbol(), human(v)));
        Some((place, format!("{y} up to {x}")))
    }
}

/// (|m|, the share of the predicted variance that frequencies up to it have).
pub(crate) fn frequency_sums(e: &IntegrationError) -> Vec<Drawn> {
    let whole = e.closed.value - e.count_term;
    if whole <= 0.0 {
        return Vec::new();
    }
    let mut sum = 0.0;
    let ring = |ring: &crate::estimate::RingShare| {
        sum += ring.variance;
        [ring.m, sum / whole]
    };
    e.rings.iter().map(ring).collect()
}

/// (|r|, the predicted variance of points and of pairs up to there over that of points).
pub(crate) fn distance_sums(e: &IntegrationError) -> Vec<Drawn> {
    if e.alone <= 0.0 || e.lags.is_empty() {
        return Vec::new();
    }
    let mut sum = e.alone;
    let shells = e.lags.iter().map(|shell| {
        sum += shell.variance;
        [shell.hi, sum / e.alone]
    });
    std::iter::once([0.0, 1.0]).chain(shells).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_stand_still_and_hold_what_there_is() {
        let bars = |value: f64| ErrorBars {
            spec: "disk".into(),
            each: vec![ErrorBar {
                form: Form::Spectral,
                value,
                ends: [value; 2],
                brief: String::new(),
                text: String::new(),
            }],
            text: Vec::new(),
        };
        let range = |value: f64| Decades::of(&[bars(value)]);
        assert_eq!(range(0.013), range(0.015));
        for value in [1e-9, 0.3, 1.0, 50.0] {
            let range = range(value);
            assert!([value, 1.0].iter().all(|v| (0.005..0.995).contains(&range.place(*v))), "{value}: {range:?}");
            assert!(range.ticks().iter().all(|(place, _)| (0.0..=1.0).contains(place)));
        }
        assert_eq!(range(0.0), range(1.0));
        assert_eq!((range(0.1).place(0.0), range(0.1).place(1e9)), (0.0, 1.0));
    }
}

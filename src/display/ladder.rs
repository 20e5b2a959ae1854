//! The variance of an integral against the number of points, on logarithmic scales: what the figure of `convergence` and the viewer draw.

use std::ops::Range;

use super::trace::Frame;
use super::units::{Axis, AxisScale};
use super::{human, with_error};
use crate::estimate::{Measured, PowerLaw};
use crate::named::named;

/// What a variance is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rung {
    /// Predicted.
    Predicted,
    /// Observed as points are.
    Observed,
    /// Observed over random shifts.
    Shifted,
}

named!(Rung: Predicted = "predicted", Observed = "observed", Shifted = "shifted");

/// The variances at a number of points.
#[derive(Debug, Clone, PartialEq)]
pub struct LadderAt {
    /// The number of points.
    pub n: f64,
    /// In the order of `Rung::ALL`; `None` where there is none.
    pub variances: [Option<Measured>; 3],
    /// The slope of what is predicted, from the number of points before.
    pub slope: Option<Measured>,
}

/// Variances of an integral over the points of one sampler, or of files, n rising.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Whose points they are.
    pub name: String,
    /// The integrand.
    pub spec: String,
    /// At each number of points.
    pub points: Vec<LadderAt>,
    /// Fits of the variances, in the order of `Rung::ALL`; `None` of fewer than two points.
    pub laws: [Option<PowerLaw>; 3],
    /// The slope to be expected.
    pub expected: Option<f64>,
}

/// A variance as it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RungMark {
    /// What it is: a disc, a ring or a cross.
    pub rung: Rung,
    /// The number of points.
    pub n: f64,
    /// The variance.
    pub value: f64,
    /// Both ends of two standard errors, within the frame.
    pub ends: [f64; 2],
    /// How far beside n it stands, so that each can be seen: -1, 0 or 1.
    pub beside: f64,
}

impl Ladder {
    /// The slopes in words.
    pub fn text(&self) -> String {
        let slope = |(rung, law): (&Rung, &Option<PowerLaw>)| {
            law.map(|law| format!("{rung} {}", with_error(law.slope, Some(law.slope_se))))
        };
        let mut slopes: Vec<String> = Rung::ALL.iter().zip(&self.laws).filter_map(slope).collect();
        if !slopes.is_empty() {
            slopes.extend(self.expected.map(|slope| format!("expected {}", human(slope))));
        }
        if slopes.is_empty() { String::new() } else { format!("slope {}", slopes.join(", ")) }
    }

    /// What there is at the number of points that is drawn nearest to a place along the axis, with that place.
    pub fn at(&self, drawn: f64) -> Option<(f64, String)> {
        let far = |at: &LadderAt| (at.n.log10() - drawn).abs();
        let at = self.points.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        let value = |(rung, v): (&Rung, &Option<Measured>)| v.map(|v| format!("{rung} {}", with_error(v.value, v.se)));
        let values: Vec<String> = Rung::ALL.iter().zip(&at.variances).filter_map(value).collect();
        let slope = at.slope.map_or(String::new(), |s| format!(", local slope {}", with_error(s.value, s.se)));
        Some((at.n.log10(), format!("n = {}: {}{slope}", human(at.n), values.join(", "))))
    }

    fn law(&self, rung: Rung) -> Option<PowerLaw> {
        Rung::ALL.iter().zip(self.laws).find(|(other, _)| **other == rung)?.1
    }
}

/// Slopes to compare with.
const REFERENCES: [(f64, &str); 3] = [(-1.0, "−1"), (-1.5, "−3/2"), (-2.0, "−2")];

/// The range of n and of variances that is seen, and what is drawn in it.
#[derive(Debug, Clone, PartialEq)]
pub struct LadderFrame {
    /// Numbers of points.
    pub n: Range<f64>,
    /// Variances.
    pub v: Range<f64>,
    /// The least and the largest n, and the largest variance.
    seen: [f64; 3],
}

impl LadderFrame {
    /// What is drawn.
    pub const DEFINITION: &'static str = "Variance against the number of points, of the sampler at its own n and at halves of it: predicted (discs) \
         with its fit, observed as points are (rings) and over random shifts (crosses), with two standard errors; dashed lines have \
         slopes to compare with.";

    /// One that shows them all; `None` where no variance is above 0.
    pub fn of<'a>(all: impl IntoIterator<Item = &'a Ladder>) -> Option<Self> {
        let ends = |ends: [f64; 2], v: f64| if v > 0.0 { [ends[0].min(v), ends[1].max(v)] } else { ends };
        let (mut n, mut v) = ([f64::INFINITY, 0.0], [f64::INFINITY, 0.0]);
        for at in all.into_iter().flat_map(|ladder| &ladder.points) {
            n = ends(n, at.n);
            v = at.variances.iter().flatten().fold(v, |v, one| ends(v, one.value));
        }
        let [[n0, n1], [v0, v1]] = [n, v];
        let range = |n0: f64, n1: f64| n0 / 1.25..n1.max(1.2 * n0) * (n1 / n0).powf(0.15);
        (v0 <= v1 && n0 <= n1).then(|| Self { n: range(n0, n1), v: v0 / 2.5..v1 * 2.5, seen: [n0, n1, v1] })
    }

    /// The axes of a plot.
    pub fn axes() -> [Axis; 2] {
        [
            Axis::named("n", "number of points n", AxisScale::Log),
            Axis::named("V", "variance of the integral", AxisScale::Log),
        ]
    }

    /// The same as drawn along these.
    pub fn frame(&self) -> Frame {
        let drawn = |range: &Range<f64>| [range.start.log10(), range.end.log10()];
        Frame { x: drawn(&self.n), y: drawn(&self.v) }
    }

    /// A line of the power `slope` through a point from n to n, as far as it is seen; its two ends.
    fn line(&self, at: [f64; 2], slope: f64, mut span: Range<f64>) -> [[f64; 2]; 2] {
        let value = |n: f64| at[1] * (n / at[0]).powf(slope);
        // Where it leaves through the bottom or the top.
        let cross = |v: f64| at[0] * (v / at[1]).powf(1.0 / slope);
        for (v, outside) in [(self.v.start, value(span.end) < self.v.start), (self.v.end, value(span.end) > self.v.end)]
        {
            if outside {
                span.end = cross(v);
            }
        }
        for (v, outside) in
            [(self.v.start, value(span.start) < self.v.start), (self.v.end, value(span.start) > self.v.end)]
        {
            if outside {
                span.start = cross(v);
            }
        }
        [span.start, span.end].map(|n| [n, value(n)])
    }

    /// Lines to compare slopes with, and what they are called at their second ends: they leave one point, above all that is drawn.
    pub fn references(&self) -> [([[f64; 2]; 2], &'static str); 3] {
        let [n0, n1, v1] = self.seen;
        REFERENCES.map(|(slope, name)| (self.line([n0, v1 * 1.6], slope, n0..n1 * (n1 / n0).powf(0.05)), name))
    }

    /// The fit of what is predicted.
    pub fn fit(&self, ladder: &Ladder) -> Option<[[f64; 2]; 2]> {
        let law = ladder.law(Rung::Predicted)?;
        let [from, to] = law.range;
        let line = self.line([from, law.at(from)], law.slope, from..to);
        (line[0][0] < line[1][0]).then_some(line)
    }

    /// Variances above 0 with their errors.
    pub fn marks<'a>(&'a self, ladder: &'a Ladder) -> impl Iterator<Item = RungMark> + 'a {
        ladder.points.iter().flat_map(move |at| {
            let mark = move |(rung, measured): (&Rung, &Option<Measured>)| {
                let v = measured.filter(|v| v.value > 0.0)?;
                let reach = 2.0 * v.se.unwrap_or(0.0);
                let ends = [v.value - reach, v.value + reach].map(|end| end.clamp(self.v.start, self.v.end));
                let beside = match rung {
                    Rung::Predicted => 0.0,
                    Rung::Observed => 1.0,
                    Rung::Shifted => -1.0,
                };
                Some(RungMark { rung: *rung, n: at.n, value: v.value, ends, beside })
            };
            Rung::ALL.iter().zip(&at.variances).filter_map(mark)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// V = 8 / n^2 at 16, 64 and 256, as is nothing at 64, shifted at none.
    fn ladder() -> Ladder {
        let measured = |value: f64| Some(Measured { value, se: Some(0.1 * value) });
        let at = |n: f64| LadderAt {
            n,
            variances: [measured(8.0 / n / n), measured(if n == 64.0 { 0.0 } else { 9.0 / n / n }), None],
            slope: None,
        };
        let points: Vec<LadderAt> = [16.0, 64.0, 256.0].map(at).into();
        let predicted: Vec<crate::estimate::VarianceAt> = (points.iter())
            .map(|at| crate::estimate::VarianceAt { n: at.n, variance: at.variances[0].unwrap() })
            .collect();
        let laws = [PowerLaw::fit(&predicted), None, None];
        Ladder { name: "jittered".into(), spec: "gaussian".into(), points, laws, expected: Some(-2.0) }
    }

    #[test]
    fn all_is_in_the_frame_and_lines_have_their_slopes() {
        let ladder = ladder();
        let frame = LadderFrame::of([&ladder]).unwrap();
        let inside = |[n, v]: [f64; 2]| {
            (frame.n.start..=frame.n.end).contains(&n) && v >= 0.999 * frame.v.start && v <= 1.001 * frame.v.end
        };
        let slope = |[a, b]: [[f64; 2]; 2]| (b[1] / a[1]).ln() / (b[0] / a[0]).ln();
        for ((line, _), wanted) in frame.references().into_iter().zip([-1.0, -1.5, -2.0]) {
            assert!(line.into_iter().all(inside) && (slope(line) - wanted).abs() < 1e-9, "{line:?}");
        }
        let fit = frame.fit(&ladder).unwrap();
        assert!((slope(fit) + 2.0).abs() < 1e-9 && (fit[0][1] * 32.0 - 1.0).abs() < 1e-9, "{fit:?}");
        let marks: Vec<RungMark> = frame.marks(&ladder).collect();
        assert_eq!(marks.iter().filter(|mark| mark.rung == Rung::Predicted).count(), 3);
        assert_eq!(marks.iter().filter(|mark| mark.rung == Rung::Observed).count(), 2, "0 has no place");
        assert!(
            marks.iter().all(|mark| inside([mark.n, mark.value]) && (mark.ends[1] / mark.value - 1.2).abs() < 1e-9)
        );
        assert_eq!(ladder.text(), "slope predicted −2 ± 0.051, expected −2");
        let (place, text) = ladder.at(1.9).unwrap();
        assert!(place == 64f64.log10() && text.starts_with("n = 64: predicted 0.00195"), "{text}");
    }

    #[test]
    fn one_number_of_points_has_room_and_none_has_no_frame() {
        let mut ladder = ladder();
        ladder.points.truncate(1);
        let frame = LadderFrame::of([&ladder]).unwrap();
        assert!(frame.n.start < 16.0 && frame.n.end > 16.0);
        ladder.points[0].variances = [Some(Measured { value: 0.0, se: None }), None, None];
        assert!(LadderFrame::of([&ladder]).is_none() && LadderFrame::of([]).is_none());
    }
}

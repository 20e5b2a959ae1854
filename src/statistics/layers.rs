//! What several figures draw alike.

use crate::display::figure::{INK, Layer, Of, Stroke, runs};
use crate::display::{Interval, Samples, escape, extent, human, shortened};
use crate::estimate::Analysis;

/// The closed form, where there is one.
pub(crate) fn closed_form(analysis: &Analysis, samples: &Samples, known: bool) -> Option<Layer> {
    let name = match analysis.closed_form.name.as_str() {
        "" => "closed form".into(),
        name => format!("closed form: {}", escape(&shortened(name, 28))),
    };
    known.then(|| Layer::Line {
        name,
        color: INK,
        width: 1.4,
        stroke: Stroke::Dashed,
        runs: runs(samples.closed_form()),
        of: Of::Points,
    })
}

/// Says so where values lie above the axis, or where there is none.
pub(crate) fn cut(values: impl Iterator<Item = f64> + Clone, top: f64) -> String {
    if !values.clone().any(f64::is_finite) {
        return " · undefined everywhere".into();
    }
    let above: Vec<f64> = values.filter(|&v| v > top).collect();
    match extent(&above) {
        Some((_, largest)) => format!(" · ▲ {} above the frame, up to {}", above.len(), human(largest)),
        None => String::new(),
    }
}

/// The directions of sectors in degrees, from 0 to 180: opposite directions are the same, so one about 0 is at both ends.
pub(crate) fn half_turn<S>(sectors: &[S], theta: impl Fn(&S) -> [f64; 3]) -> impl Iterator<Item = (Interval, &S)> {
    let first = sectors.first().filter(|s| theta(s)[1] == 0.0).map(|s| (180.0, s));
    sectors.iter().map(|s| (0.0, s)).chain(first).map(move |(turn, s)| {
        let [lo, at, hi] = theta(s).map(|t| t.to_degrees() + turn);
        ((lo.max(0.0), at, hi.min(180.0)), s)
    })
}

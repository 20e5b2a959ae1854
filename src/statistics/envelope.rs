//! Envelopes of simulations: table, what is drawn of them, and what is said of them.

use std::fmt::Write as _;

use serde::Serialize;

use super::{Keys, Output, Room, Table};
use crate::display::figure::{GREY, Layer, band_runs};
use crate::display::{Interval, escape, human};
use crate::estimate::{Analysis, Envelope};

/// Envelopes in a report.
pub(crate) struct Here;

impl Room for Here {
    fn outputs(&self) -> &'static [Output] {
        const { &[Output::table("envelope.csv", table)] }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        let out = a.envelopes().map(|e| EnvelopesOut {
            simulations: e.simulations,
            given: e.given.as_deref(),
            pointwise_significance: e.pointwise_significance(),
            curves: e
                .curves
                .iter()
                .map(|c| EnvelopeOut { curve: c.observed.name, alpha: c.alpha, p: c.p, p_interval: c.p_interval })
                .collect(),
        });
        keys.add("envelope", &out)
    }
}

#[derive(Serialize)]
struct EnvelopesOut<'a> {
    simulations: u64,
    /// Files of simulations; null for complete spatial randomness.
    given: Option<&'a str>,
    /// The probability that independent points leave the pointwise envelope at one r.
    pointwise_significance: f64,
    curves: Vec<EnvelopeOut>,
}

#[derive(Serialize)]
struct EnvelopeOut {
    curve: &'static str,
    /// Level of the global envelope.
    alpha: f64,
    p: f64,
    p_interval: [f64; 2],
}

/// `envelope.csv`: every curve after the other, in the units of its own table.
fn table(analysis: &Analysis) -> Option<Table> {
    let curves = &analysis.envelopes()?.curves;
    let column = |of: fn(&Envelope) -> &[f64]| curves.iter().flat_map(move |c| of(c).iter().copied());
    let names = curves.iter().flat_map(|c| std::iter::repeat_n(c.observed.name.to_string(), c.observed.r.len()));
    Some(
        Table::new()
            .text("curve", names)
            .floats("r", column(|c| &c.observed.r))
            .floats("observed", column(|c| &c.observed.values))
            .floats("lo", column(|c| &c.pointwise[0]))
            .floats("hi", column(|c| &c.pointwise[1]))
            .floats("global_lo", column(|c| &c.global[0]))
            .floats("global_hi", column(|c| &c.global[1])),
    )
}

/// The global envelope of what is simulated, `of` which function where that is not plain.
pub(crate) fn global_band(a: &Analysis, of: &str, intervals: &[Interval], envelope: &Envelope) -> Layer {
    let given = a.envelopes().is_some_and(|e| e.given.is_some());
    let name = format!("{of}{}, global", if given { "simulated" } else { "random" });
    let range = |(&lo, &hi): (&f64, &f64)| lo.is_finite().then_some((lo, hi));
    let band = envelope.global[0].iter().zip(&envelope.global[1]).map(range);
    Layer::Band { name, color: GREY, runs: band_runs(intervals.iter().copied().zip(band)) }
}

/// What the envelopes of these curves say.
pub(crate) fn caption(a: &Analysis, names: &[&str]) -> String {
    let Some(e) = a.envelopes() else { return String::new() };
    let (of, one, what) = match &e.given {
        None => ("of complete spatial randomness with as many points".into(), "a random pattern", "randomness"),
        Some(given) => (format!("given ({})", escape(given)), "a pattern like them", "them"),
    };
    let mut text = format!(
        " {} simulations {of}: at one <i>r</i> chosen beforehand, {one} leaves their range with probability {}.",
        e.simulations,
        human(e.pointwise_significance())
    );
    for c in e.curves.iter().filter(|c| names.contains(&c.observed.name)) {
        let [lo, hi] = c.p_interval;
        let name = match c.observed.name {
            "g" => "<i>g</i>",
            "g_kernel" => "the smoothed <i>g</i>",
            "k" => "<i>K</i>",
            "l_minus_r" => "<i>L</i> − <i>r</i>",
            "neighbor_g" => "<i>G</i>",
            "neighbor_f" => "<i>F</i>",
            other => other,
        };
        let verdict = if c.p <= c.alpha { "differs from" } else { "agrees with" };
        let _ = write!(
            text,
            " Over all <i>r</i>, {name} {verdict} {what} at the {} % level (global rank envelope test by extreme rank \
             length: <i>p</i> = {}, by extreme rank alone {} to {}).",
            human(100.0 * c.alpha),
            human(c.p),
            human(lo),
            human(hi)
        );
    }
    text
}

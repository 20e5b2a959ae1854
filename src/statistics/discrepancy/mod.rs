//! Discrepancies, nets in base 2, least distance and covering radius.

mod sums;
mod tables;

use serde::Serialize;

use super::group::{Ask, Parts};
use super::{Keys, Output, Room, Row, across, in_units};
use crate::accumulate::DISCREPANCIES;
use crate::display::{human, with_error};
use crate::error::Result;
use crate::estimate::{Analysis, Discrepancies, Discrepancy, Length, NetQuality};

/// Discrepancies in a report.
pub(crate) struct Here;

/// As they are called.
const NAMES: [&str; DISCREPANCIES.len()] = ["Star", "Centred", "Wrap-around", "Mixture", "Diaphony"];

/// What `summary.json` says.
#[derive(Serialize)]
struct DiscrepancyOut {
    star_l2: Discrepancy,
    centered_l2: Discrepancy,
    wrap_around_l2: Discrepancy,
    mixture_l2: Discrepancy,
    diaphony: Discrepancy,
    minimum_distance: Option<Length>,
    covering_radius: Option<Length>,
    covering_radius_bound: Option<f64>,
    t: Option<NetQuality>,
}

impl DiscrepancyOut {
    fn of(found: &Discrepancies) -> Self {
        let [star_l2, centered_l2, wrap_around_l2, mixture_l2, diaphony] = found.each;
        Self {
            star_l2,
            centered_l2,
            wrap_around_l2,
            mixture_l2,
            diaphony,
            minimum_distance: found.minimum,
            covering_radius: found.covering,
            covering_radius_bound: found.covering_bound,
            t: found.t,
        }
    }
}

/// In words: `2`, or `1 to 3, mean 2.1`.
fn quality(t: NetQuality) -> String {
    match t.least == t.largest {
        true => t.least.to_string(),
        false => format!("{} to {}, mean {}", t.least, t.largest, human(t.mean)),
    }
}

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        sums::plan(ask, parts)
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::table("discrepancy.csv", tables::discrepancies).shown(
                    "discrepancies",
                    &["realization", "star_l2", "centered_l2", "wrap_around_l2", "mixture_l2", "diaphony", "t"],
                ),
                Output::table("elementary_intervals.csv", tables::intervals),
            ]
        }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("discrepancy", &a.discrepancies().map(DiscrepancyOut::of))
    }

    fn scalars(&self, a: &Analysis) -> Vec<Row> {
        let Some(found) = a.discrepancies() else { return Vec::new() };
        let mut rows = Vec::new();
        for (name, one) in NAMES.into_iter().zip(&found.each) {
            let what = if name == "Diaphony" { "" } else { " <i>L</i><sub>2</sub> discrepancy" };
            let (value, squared) = (with_error(one.mean, one.mean_se), with_error(one.squared, one.squared_se));
            rows.push((format!("{name}{what}"), format!("{value}; squared {squared}")));
        }
        if let Some(radius) = found.covering {
            let text = format!("{}{}", with_error(radius.mean, radius.mean_se), in_units(a));
            rows.push(("Covering radius".into(), text));
        }
        if let Some(t) = found.t {
            rows.push(("<i>t</i> of a (<i>t</i>, <i>m</i>, <i>d</i>)-net in base 2".into(), quality(t)));
        }
        rows
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let across_them = |d: &Discrepancies| d.each[0].mean_se.map(|_| across(a, "the realization's value"));
        let text = a.discrepancies().and_then(across_them);
        text.map(|text| ("discrepancies, covering radius".into(), text)).into_iter().collect()
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let Some(found) = a.discrepancies() else { return Vec::new() };
        let value = |(name, one): (&str, &Discrepancy)| {
            format!("{} {}", name.to_lowercase(), with_error(one.mean, one.mean_se))
        };
        let mut lines = vec![format!(
            "discrepancies (L2): {}",
            NAMES.into_iter().zip(&found.each).map(value).collect::<Vec<_>>().join(", ")
        )];
        let radius =
            found.covering.map(|r| format!("covering radius {}{}", with_error(r.mean, r.mean_se), in_units(a)));
        let t = found.t.map(|t| format!("net in base 2 with t = {}", quality(t)));
        let rest: Vec<String> = radius.into_iter().chain(t).collect();
        lines.extend((!rest.is_empty()).then(|| rest.join("; ")));
        lines
    }
}

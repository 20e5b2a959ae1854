//! Errors of integrals: predicted from power and from pairs, observed as points are and shifted, and where they come from.

mod figures;
mod sums;
mod tables;

use serde_json::{Value, json};

use super::group::{Ask, Parts};
use super::{Keys, Make, Output, Place, Room, Row, Turn, across};
use crate::display::{escape, human, with_error};
use crate::error::Result;
use crate::estimate::{Analysis, IntegrationError, Measured};

/// Integration in a report.
pub(crate) struct Here;

fn number(m: Measured) -> Value {
    json!({ "value": m.value, "se": m.se })
}

fn row(e: &IntegrationError) -> Value {
    json!({
        "integrand": e.integrand.spec(),
        "exact": e.integrand.integral(),
        "square_integral": e.integrand.square_integral(),
        "v0": e.v0,
        "mean": number(e.mean),
        "bias": number(e.bias),
        "var_observed": e.observed.map(number),
        "mse": e.mse,
        "var_shifted": number(e.shifted),
        "var_spatial": e.spatial.map(number),
        "var_spectral": number(e.spectral),
        "tail": e.tail,
        "tail_axes": e.tail_axes,
        "tail_bound": e.tail_bound,
        "count_term": e.count_term,
        "phase": number(e.phase),
        "phase_low": e.phase_low,
        "z": e.z,
    })
}

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        sums::plan(ask, parts)
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            let caption = |a: &Analysis, _: &str| {
                a.integration().map(|_| {
                    "Predicted and observed variance of each integral in units of the variance of as many random points; predictions are \
                     of randomly shifted points."
                        .to_string()
                })
            };
            let sources = |a: &Analysis, _: &str| {
                a.integration()
                    .map(|_| "The part of the predicted variance that frequencies up to |<i>m</i>| add.".to_string())
            };
            &[
                Output::table("variance.csv", tables::variance).shown(
                    "integration error",
                    &[
                        "integrand",
                        "exact",
                        "bias",
                        "var_observed",
                        "var_shifted",
                        "var_spatial",
                        "var_spectral",
                        "tail",
                        "z",
                    ],
                ),
                Output::table("attribution.csv", tables::attribution),
                Output::table("attribution_modes.csv", tables::modes),
                Output::array("estimates.npy", tables::estimates),
                Output::array("stationarised.npy", tables::stationarised),
                Output {
                    name: "variance.svg",
                    turn: Turn::Figure,
                    make: Make::Svg(|a| a.integration().map(|found| figures::variance(a, found))),
                    place: Some(Place { heading: "Integration error", caption }),
                    shown: None,
                },
                Output::figure("attribution.svg", figures::attribution, "Integration error", sources),
            ]
        }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        let out = a.integration().map(|found| {
            json!({
                "intensity": found.placed.as_ref().map(|(density, _)| density.spec()),
                "by": found.placed.as_ref().map(|(_, by)| by.name()),
                "estimator": found.estimator.name(),
                "realizations": found.realizations,
                "left_out": found.left_out,
                "spatial_method": tables::method(found),
                "max_frequency": found.max_frequency,
                "axis_frequency": found.axis_frequency,
                "low_frequency": found.low_frequency,
                "shifts": found.shifts,
                "integrands": found.each.iter().map(row).collect::<Vec<_>>(),
            })
        });
        keys.add("integration", &out)
    }

    fn scalars(&self, a: &Analysis) -> Vec<Row> {
        let Some(found) = a.integration() else { return Vec::new() };
        let row = |e: &IntegrationError| {
            let all = found.predicted(e);
            let gain = e.v0 / all.value;
            let as_many = if all.value > 0.0 { format!("; as {} random points", human(gain)) } else { String::new() };
            let text = format!(
                "predicted {}, observed shifted {}{as_many}",
                with_error(all.value, all.se),
                with_error(e.shifted.value, e.shifted.se)
            );
            (format!("Variance of {}", escape(e.integrand.spec())), text)
        };
        found.each.iter().map(row).collect()
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let text = a.integration().map(|found| match found.realizations {
            1 => "theory, for a single realization: exponential power at every frequency".to_string(),
            _ => across(a, "the realization's value"),
        });
        text.map(|text| ("integration errors".into(), text)).into_iter().collect()
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let Some(found) = a.integration() else { return Vec::new() };
        let line = |e: &IntegrationError| {
            let all = found.predicted(e);
            let observed = e.observed.map_or("undefined".into(), |o| with_error(o.value, o.se));
            format!(
                "{}: I {} (bias {}), variance predicted {}, shifted {}, as is {observed}{}",
                e.integrand.spec(),
                human(e.integrand.integral()),
                with_error(e.bias.value, e.bias.se),
                with_error(all.value, all.se),
                with_error(e.shifted.value, e.shifted.se),
                e.z.map_or(String::new(), |z| format!(", z {}", human(z)))
            )
        };
        let how = format!("integration, estimator {}, {} shifts:", found.estimator.name(), found.shifts);
        let placed = found.placed.as_ref().map(|(density, by)| {
            format!("points are as dense as {}, by {by}; g, P and shifts are of points before that", density.spec())
        });
        let how = std::iter::once(how).chain(placed);
        how.chain(found.each.iter().map(line)).collect()
    }
}

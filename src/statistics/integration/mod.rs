//! Errors of integrals: predicted from power and from pairs, observed as points are and shifted, and where they come from.

mod figures;
mod sums;
mod tables;

use serde_json::{Value, json};

use super::group::{Ask, Parts};
use super::{Keys, Make, Output, Place, Room, Row, Turn, across};
use crate::display::{escape, human, with_error};
use crate::error::Result;
use crate::estimate::{Analysis, IntegrationError, Measured, ModeShare};
use crate::plan::By;

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
        "removal": e.removal.map(|r| json!({
            "variance": r.variance,
            "error": r.error,
            "mse_predicted": r.as_is.map(number),
            "z_as_is": r.z_as_is,
        })),
        "phase": number(e.phase),
        "phase_low": e.phase_low,
        "var_low": e.var_low,
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
            let distances = |a: &Analysis, _: &str| {
                a.integration().map(|_| {
                    "The predicted variance of single points and of pairs up to a distance, over that of single points alone: what correlation takes away, and where."
                        .to_string()
                })
            };
            let modes = |a: &Analysis, _: &str| {
                a.integration().map(|_| {
                    "|<i>f</i><sub><b>m</b></sub>|<sup>2</sup> <i>P</i>(<b>m</b>) / <i>v</i><sub>0</sub> over frequencies, with \
                     <i>v</i><sub>0</sub> = ∫<i>f</i><sup>2</sup> − <i>I</i><sup>2</sup>: what each adds to the variance, over that of as many \
                     random points. The sum over all of them is the prediction without its tail."
                        .to_string()
                })
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
                        "count_term",
                        "removal",
                        "z",
                    ],
                ),
                Output::table("attribution.csv", tables::attribution),
                Output::table("attribution_modes.csv", tables::modes),
                Output::table("attribution_lags.csv", tables::lags),
                Output::array("estimates.npy", tables::estimates),
                Output::array("stationarised.npy", tables::stationarised),
                Output {
                    name: "variance.svg",
                    turn: Turn::Figure,
                    make: Make::Svg(|a| a.integration().map(|_| figures::variance(a))),
                    place: Some(Place { heading: "Integration error", caption }),
                    shown: None,
                },
                Output::figure("attribution.svg", figures::attribution, "Integration error", sources),
                Output::figure("attribution_lags.svg", figures::lags, "Integration error", distances),
                Output {
                    name: "attribution_map.svg",
                    turn: Turn::Image,
                    make: Make::Maps(figures::maps),
                    place: Some(Place { heading: "Integration error", caption: modes }),
                    shown: None,
                },
            ]
        }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        let out = a.integration().map(|found| {
            json!({
                "intensity": found.placed.as_ref().map(|p| &p.spec),
                "by": found.placed.as_ref().and_then(|p| p.by).map(|by| by.name()),
                "estimator": found.estimator.name(),
                "realizations": found.realizations,
                "left_out": found.left_out,
                "points": found.placed.as_ref().map(|p| number(p.points)),
                "expected_points": found.placed.as_ref().map(|p| p.expected),
                "spatial_method": tables::method(found),
                "asked_frequency": found.asked_frequency,
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
        let tops = |e: &IntegrationError| {
            let whole = found.predicted(e).value;
            let name = |mode: &ModeShare| {
                let m: Vec<String> = mode.m[..a.domain.dim()].iter().map(i32::to_string).collect();
                format!(
                    "  m = ±({}): {:.2} % of the variance, |f_m|² {}, P {}",
                    m.join(", "),
                    100.0 * mode.variance / whole,
                    human(mode.coefficient),
                    human(mode.p)
                )
            };
            e.modes.iter().filter(|_| found.top.is_some() && whole > 0.0).map(name).collect::<Vec<_>>()
        };
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
        let placed = found.placed.as_ref().map(|p| {
            let number =
                format!("{} per realization, {} expected", with_error(p.points.value, p.points.se), human(p.expected));
            match p.by {
                Some(By::Removal) => {
                    format!("points are kept by {}: {number}; g, P and phase are of their parents", p.spec)
                }
                Some(_) => {
                    format!("points are as dense as {}, by warp; g, P and shifts are of points before that", p.spec)
                }
                None => format!("points weigh one over {}: {number}", p.spec),
            }
        });
        std::iter::once(how)
            .chain(placed)
            .chain(found.each.iter().flat_map(|e| std::iter::once(line(e)).chain(tops(e))))
            .collect()
    }
}

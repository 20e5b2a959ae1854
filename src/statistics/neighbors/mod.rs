//! Nearest neighbours: distances, G, F and J, and bond order.

mod classes;
mod figures;
mod summary;
mod sums;
mod tables;

use super::group::{Ask, Parts};
use super::{Keys, Output, Room, Row, across, in_units};
use crate::display::{Units, human, packing_symbol, with_error};
use crate::error::Result;
use crate::estimate::{Analysis, Curve, ErrorSource};

pub(crate) use sums::Neighborhood;

/// Neighbours in a report.
pub(crate) struct Here;

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        sums::plan(ask, parts)
    }

    fn curves(&self, a: &Analysis) -> Vec<Curve> {
        let Some(functions) = a.neighbors().map(|n| &n.functions) else { return Vec::new() };
        let curve = |name, values: &[Option<f64>]| Curve {
            name,
            r: functions.r.clone(),
            values: values.iter().map(|v| v.unwrap_or(f64::NAN)).collect(),
        };
        vec![curve("neighbor_g", &functions.g), curve("neighbor_f", &functions.f)]
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::table("neighbor_functions.csv", tables::functions).shown(
                    "nearest-neighbour and empty-space functions",
                    &["r", "g_function", "g_function_se", "f_function", "f_function_se", "j_function", "poisson"],
                ),
                Output::table("neighbor_functions_cross.csv", tables::cross)
                    .shown("J functions of two classes", &["r", "j_function_"]),
                Output::figure("neighbor_functions.svg", figures::functions, "Nearest neighbours", figures::caption),
                Output::figure(
                    "neighbor_functions_cross.svg",
                    figures::cross,
                    "Nearest neighbours of two classes",
                    figures::cross_caption,
                ),
            ]
        }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("neighbors", &summary::neighbors(a))?;
        keys.add("cross_neighbors", &summary::cross(a))
    }

    fn scalars(&self, a: &Analysis) -> Vec<Row> {
        let (d, which) = packing_symbol(a.domain.dim());
        let symbol = format!("<i>{d}</i><sub>{which}</sub>");
        let mut rows = Vec::new();
        if let Some(neighbors) = a.neighbors() {
            let nn = &neighbors.distances;
            let relative = |r: Option<f64>| r.map_or(String::new(), |r| format!(" ({} {symbol})", human(r)));
            let length = Units::of(a).escaped().length;
            let value = |v: Option<f64>, se, r| {
                v.map_or("undefined: no realization has two points".into(), |v| {
                    format!("{} {length}{}", with_error(v, se), relative(r))
                })
            };
            rows.push(("Smallest nearest-neighbour distance".into(), value(nn.minimum, None, nn.minimum_relative)));
            if a.shape.realizations >= 2 {
                let mean = value(nn.mean_minimum, nn.mean_minimum_se, nn.mean_minimum_relative);
                rows.push(("The smallest of each realization, mean".into(), mean));
            }
            rows.push(("Mean nearest-neighbour distance".into(), value(nn.mean, nn.mean_se, nn.mean_relative)));
            if let Some(clark_evans) = &neighbors.clark_evans {
                let index = with_error(clark_evans.index, clark_evans.index_se);
                let text = format!("{index}; <i>z</i> = {} against independent points", human(clark_evans.z));
                rows.push(("Clark–Evans index".into(), text));
            }
            if let Ok(bonds) = &neighbors.bonds {
                let [local, global] = [(bonds.local, bonds.local_se), (bonds.global, bonds.global_se)]
                    .map(|(value, se)| with_error(value, se));
                let shares = bonds.with_5_6_7_neighbors.map(human).join(", ");
                rows.push(("Bond order, mean of |<i>ψ</i><sub>6</sub>|".into(), local));
                rows.push(("Bond order, |mean of <i>ψ</i><sub>6</sub>|".into(), global));
                rows.push(("Shares of points with 5, 6, 7 neighbours".into(), shares));
            }
        }
        rows
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let mut rows = Vec::new();
        if let Some(neighbors) = a.neighbors() {
            if neighbors.distances.mean_se.is_some() {
                rows.push(("nearest-neighbour distances, bond order".into(), across(a, "the realization's value")));
            }
            let text = match neighbors.functions.errors {
                ErrorSource::AcrossRealizations => across(a, "each distance's <i>G</i> and <i>F</i>"),
                _ => {
                    "theory, for a single realization: binomial, as if the distances of all points were independent; for \
                     <i>F</i> as of only as many test points as there are points"
                        .into()
                }
            };
            rows.push(("<i>G</i>(<i>r</i>), <i>F</i>(<i>r</i>)".into(), text));
        }
        rows
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(neighbors) = a.neighbors() {
            let nn = &neighbors.distances;
            let value = |x: Option<f64>, se| x.map_or("undefined".into(), |x| with_error(x, se));
            let relative =
                nn.mean_relative.map_or(String::new(), |r| format!(" ({} of the closest packing)", human(r)));
            let (minimum, mean) = (value(nn.minimum, None), value(nn.mean, nn.mean_se));
            let unit = in_units(a);
            lines.push(format!("nearest neighbour: smallest {minimum}{unit}, mean {mean}{unit}{relative}"));
            if let Some(clark_evans) = &neighbors.clark_evans {
                let index = with_error(clark_evans.index, clark_evans.index_se);
                lines.push(format!(
                    "Clark-Evans index {index}, z = {} against independent points",
                    human(clark_evans.z)
                ));
            }
            if let Ok(bonds) = &neighbors.bonds {
                let (local, global) =
                    (with_error(bonds.local, bonds.local_se), with_error(bonds.global, bonds.global_se));
                lines.push(format!("bond order: mean |ψ₆| {local}, |mean ψ₆| {global}"));
            }
        }
        lines
    }
}

//! One room per statistic, with all that there is to it: the groups of sums it is read off (their part of the request, plan,
//! sums, identity, estimates, warnings), and what a report shows of it (tables, arrays, pictures with their captions, its part
//! of `summary.json`, its scalars and what its error bars are).
//!
//! A new statistic is a room here, one line of `ROOMS`, and its stems in compute, accumulate and estimate.

pub(crate) mod axes;
mod classes;
mod convention;
mod counts;
mod covariance;
mod discrepancy;
mod envelope;
pub(crate) mod group;
mod integration;
mod intensity;
mod keys;
mod lags;
mod layers;
pub(crate) mod measured;
mod neighbors;
mod output;
mod pairs;
mod psa;
mod table;
pub(crate) mod targets;
pub(crate) mod waves;

pub(crate) use keys::Keys;
pub use output::{Array, Values};
pub(crate) use output::{At, Bar, Cells, Image, Make, Map, Output, Place, Shown, Steps, Svg, Turn};
pub(crate) use table::cell;
pub use table::{Column, Table};

use crate::error::Result;
use crate::estimate::{Analysis, Curve};
use group::{Ask, Parts};

/// A name and a value, both HTML.
pub(crate) type Row = (String, String);

/// What a room measures, and what it shows in a report; nothing of what was not measured.
pub(crate) trait Room: Sync {
    /// Adds the plans of its groups of sums, if they are asked for.
    fn plan(&self, _: &Ask<'_>, _: &mut Parts) -> Result<()> {
        Ok(())
    }

    /// Every estimated function of it that has an envelope.
    fn curves(&self, _: &Analysis) -> Vec<Curve> {
        Vec::new()
    }

    /// The files it may write; their pictures stand in the page in this order.
    fn outputs(&self) -> &'static [Output] {
        &[]
    }

    /// Heading and text (HTML) where there can be no picture.
    fn words(&self, _: &Analysis) -> Option<(&'static str, String)> {
        None
    }

    /// Adds its keys to the summary, `null` where nothing was measured.
    fn summary(&self, _: &Analysis, _: &mut Keys<'_>) -> serde_json::Result<()> {
        Ok(())
    }

    /// What to see at a glance.
    fn scalars(&self, _: &Analysis) -> Vec<Row> {
        Vec::new()
    }

    /// What its error bars are.
    fn errors(&self, _: &Analysis) -> Vec<Row> {
        Vec::new()
    }

    /// How exact its sums are.
    fn accuracy(&self, _: &Analysis) -> Option<Row> {
        None
    }

    /// Lines for a terminal.
    fn headline(&self, _: &Analysis) -> Vec<String> {
        Vec::new()
    }
}

/// Every room, in the order of the page and of the summary.
pub(crate) const ROOMS: &[&dyn Room] = &[
    &pairs::Here,
    &envelope::Here,
    &lags::Here,
    &waves::Here,
    &covariance::Here,
    &convention::Here,
    &neighbors::Here,
    &discrepancy::Here,
    &integration::Here,
    &counts::Here,
    &intensity::Here,
    &targets::Here,
];

/// Behind a length on a terminal: the name of its unit, if it has one.
fn in_units(a: &Analysis) -> String {
    a.unit.map_or(String::new(), |unit| format!(" {unit}"))
}

/// What an error across realizations is.
fn across(a: &Analysis, what: &str) -> String {
    format!(
        "standard error of {what} across the {} realizations (of a ratio of sums, where <i>n</i> varies)",
        a.shape.realizations
    )
}

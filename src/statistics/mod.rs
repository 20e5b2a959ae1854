//! One room per group of sums, with all that a report shows of it: tables, arrays, pictures with their captions, its part of
//! `summary.json`, its scalars and what its error bars are.

mod convention;
mod covariance;
mod envelope;
mod keys;
mod lags;
mod layers;
mod neighbors;
mod output;
mod pairs;
mod table;
pub(crate) mod waves;

pub(crate) use keys::Keys;
pub(crate) use output::{Array, Bar, Image, Make, Output, Place, Svg, Turn, Values};
pub(crate) use table::Table;

use crate::estimate::Analysis;

/// A name and a value, both HTML.
pub(crate) type Row = (String, String);

/// What a room shows in a report; nothing of what was not measured.
pub(crate) trait Section: Sync {
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
pub(crate) const SECTIONS: &[&dyn Section] = &[
    &pairs::Shown,
    &envelope::Shown,
    &lags::Shown,
    &waves::Shown,
    &covariance::Shown,
    &convention::Shown,
    &neighbors::Shown,
];

/// What an error across realizations is.
fn across(a: &Analysis, what: &str) -> String {
    format!(
        "standard error of {what} across the {} realizations (of a ratio of sums, where <i>n</i> varies)",
        a.shape.realizations
    )
}

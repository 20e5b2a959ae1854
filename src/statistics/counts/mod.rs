//! Numbers of points in boxes and balls: mean, variance, index of dispersion against size.

mod figures;
mod sums;

use serde::Serialize;

use super::group::{Ask, Parts};
use super::{Keys, Output, Room, Row, Table, across, in_units};
use crate::display::{human, with_error};
use crate::error::Result;
use crate::estimate::{Analysis, CountDispersion, Counts, ErrorSource};
use crate::plan::CountShape;

/// Counts in a report.
pub(crate) struct Here;

/// What `summary.json` says: the sizes, and what was found at the largest.
#[derive(Serialize)]
struct CountsOut<'a> {
    errors: Option<ErrorSource>,
    sizes: usize,
    largest_box: Option<&'a CountDispersion>,
    largest_ball: Option<&'a CountDispersion>,
}

/// What a shape is called in so many dimensions.
fn name(shape: CountShape, dim: usize) -> &'static str {
    match (shape, dim) {
        (CountShape::Box, 1) => "intervals",
        (CountShape::Box, _) => "boxes",
        (CountShape::Ball, 2) => "disks",
        (CountShape::Ball, _) => "balls",
    }
}

/// The largest box and the largest ball.
fn largest(counts: &Counts) -> impl Iterator<Item = &CountDispersion> {
    [CountShape::Box, CountShape::Ball].into_iter().filter_map(|shape| counts.largest(shape))
}

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        sums::plan(ask, parts);
        Ok(())
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::table("counts.csv", table)
                    .shown("counts", &["shape", "size", "mean", "variance", "dispersion", "dispersion_se", "random"]),
                Output::figure("counts.svg", figures::dispersion, "Counts in boxes and balls", figures::caption),
            ]
        }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        let out = a.counts().map(|counts| CountsOut {
            errors: counts.errors,
            sizes: counts.sizes.len(),
            largest_box: counts.largest(CountShape::Box),
            largest_ball: counts.largest(CountShape::Ball),
        });
        keys.add("counts", &out)
    }

    fn scalars(&self, a: &Analysis) -> Vec<Row> {
        let row = |one: &CountDispersion| {
            let (name, of) = (name(one.shape, a.domain.dim()), human(one.measure));
            let value = with_error(one.dispersion?, one.dispersion_se);
            Some((
                format!("Index of dispersion in {name} of measure {of}"),
                format!("{value}; independent points {}", human(one.random)),
            ))
        };
        a.counts().into_iter().flat_map(largest).filter_map(row).collect()
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let Some(counts) = a.counts() else { return Vec::new() };
        let text = match counts.errors {
            Some(_) => across(a, "the ratio of sums"),
            None => "none: a single realization".into(),
        };
        vec![("counts".into(), text)]
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let one = |one: &CountDispersion| {
            let value = with_error(one.dispersion?, one.dispersion_se);
            let size = if one.shape == CountShape::Ball { "radius" } else { "side" };
            let name = name(one.shape, a.domain.dim());
            Some(format!(
                "{value} in {name} of {size} {}{} (independent points {})",
                human(one.size),
                in_units(a),
                human(one.random)
            ))
        };
        let all: Vec<String> = a.counts().into_iter().flat_map(largest).filter_map(one).collect();
        (!all.is_empty()).then(|| format!("variance/mean of counts: {}", all.join(", "))).into_iter().collect()
    }
}

/// `counts.csv`: a row per size; size in length units, measure in their power, the rest numbers of points.
fn table(a: &Analysis) -> Option<Table> {
    let sizes = &a.counts()?.sizes;
    let floats = |of: fn(&CountDispersion) -> f64| sizes.iter().map(of);
    let optional = |of: fn(&CountDispersion) -> Option<f64>| sizes.iter().map(of);
    Some(
        Table::new()
            .text("shape", sizes.iter().map(|s| s.shape.name().to_string()))
            .floats("size", floats(|s| s.size))
            .floats("measure", floats(|s| s.measure))
            .floats("mean", floats(|s| s.mean))
            .optional("mean_se", optional(|s| s.mean_se))
            .floats("variance", floats(|s| s.variance))
            .optional("variance_se", optional(|s| s.variance_se))
            .optional("dispersion", optional(|s| s.dispersion))
            .optional("dispersion_se", optional(|s| s.dispersion_se))
            .floats("random", floats(|s| s.random)),
    )
}

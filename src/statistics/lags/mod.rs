//! g of the vector between two points.

mod counts;
mod figures;
mod summary;
mod tables;

use super::group::{Ask, Parts};
use super::{Array, Keys, Output, Room, Row, Turn, Values, across};
use crate::error::{Result, plural};
use crate::estimate::{Analysis, ErrorSource, VectorCorrelation};

pub(crate) use counts::Lags;

/// Lags in a report.
pub(crate) struct Here;

const HEADING: &str = "Pair correlation function of the vector";

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        counts::plan(ask, parts)
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::table("pcf_angular.csv", tables::angular),
                Output::array("pcf_vector.npy", g).turn(Turn::ArrayOfLags),
                Output::array("pcf_vector_se.npy", g_se).turn(Turn::ArrayOfLags),
                Output::array("pcf_vector_counts.npy", counts).turn(Turn::ArrayOfLags),
                Output::image("pcf_vector.png", figures::image, HEADING, figures::image_caption)
                    .turn(Turn::ImageOfLags),
                Output::figure("pcf_angular.svg", figures::angular, HEADING, figures::angular_caption),
            ]
        }
    }

    fn words(&self, a: &Analysis) -> Option<(&'static str, String)> {
        Some((HEADING, figures::words(a)?))
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("vector_correlation", &summary::vector(a))
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let mut rows = Vec::new();
        if let Some(vector) = a.vector() {
            let text = match vector.errors {
                ErrorSource::AcrossRealizations => across(a, "each cell's <i>g</i>, and of each sector's"),
                _ => {
                    "theory, for a single realization: Poisson counts of unordered pairs, a cell and its mirror image being one"
                        .into()
                }
            };
            rows.push(("<i>g</i>(<b>h</b>)".into(), text));
        }
        rows
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(vector) = a.vector() {
            let pairs: u64 = vector.count.iter().sum();
            let bins = vec![vector.grid.bins.to_string(); vector.grid.dim()].join(" x ");
            lines.push(format!("g(h): {bins} cells of lags, {}", plural(pairs, "ordered pair")));
        }
        lines
    }
}

/// One value per cell of lags, x axis first.
fn cells<'a>(vector: &VectorCorrelation, values: Values<'a>) -> Array<'a> {
    Array { shape: vec![vector.grid.bins as u64; vector.grid.dim()], values }
}

fn g(a: &Analysis) -> Option<Array<'_>> {
    let vector = a.vector()?;
    Some(cells(vector, Values::Real(Box::new(vector.g.iter().copied()))))
}

/// With one realization the errors are of theory, cell by cell.
fn g_se(a: &Analysis) -> Option<Array<'_>> {
    let vector = a.vector().filter(|_| a.shape.realizations >= 2)?;
    Some(cells(vector, Values::Real(Box::new(vector.g_se.iter().copied()))))
}

/// Ordered pairs.
fn counts(a: &Analysis) -> Option<Array<'_>> {
    let vector = a.vector()?;
    Some(cells(vector, Values::Integer(Box::new(vector.count.iter().copied()))))
}

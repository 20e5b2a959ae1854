//! The intensity on a grid: its array, picture and numbers.

mod image;
mod sums;

use serde::Serialize;

use super::group::{Ask, Parts};
use super::{Array, Keys, Output, Room, Row, Values, across, in_units};
use crate::display::human;
use crate::error::Result;
use crate::estimate::{Analysis, ErrorSource, Intensity};

/// The intensity in a report.
pub(crate) struct Here;

/// What `summary.json` says.
#[derive(Serialize)]
struct IntensityOut {
    bandwidth: f64,
    cells: usize,
    mean: f64,
    least: f64,
    largest: f64,
    integral: f64,
    errors: Option<ErrorSource>,
}

impl IntensityOut {
    fn of(found: &Intensity) -> Option<Self> {
        let [least, largest] = found.range()?;
        let Intensity { bandwidth, cells, mean, integral, errors, .. } = *found;
        Some(Self { bandwidth, cells, mean, least, largest, integral, errors })
    }
}

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        sums::plan(ask, parts)
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::array("intensity.npy", lambda),
                Output::array("intensity_se.npy", lambda_se),
                Output::image("intensity.png", image::image, "Intensity", image::caption),
            ]
        }
    }

    fn words(&self, a: &Analysis) -> Option<(&'static str, String)> {
        let found = a.intensity().filter(|_| a.domain.dim() == 1)?;
        let [least, largest] = found.range()?.map(human);
        Some((
            "Intensity",
            format!("<i>λ</i>(<i>x</i>) is from {least} to {largest}; in one dimension there is no picture."),
        ))
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("intensity", &a.intensity().and_then(IntensityOut::of))
    }

    fn scalars(&self, a: &Analysis) -> Vec<Row> {
        let Some((found, [least, largest])) = a.intensity().and_then(|found| Some((found, found.range()?))) else {
            return Vec::new();
        };
        let text = format!(
            "{} to {}, over all {}; bandwidth {}",
            human(least),
            human(largest),
            human(found.mean),
            human(found.bandwidth)
        );
        vec![("Intensity <i>λ</i>(<i>x</i>)".into(), text)]
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let Some(found) = a.intensity() else { return Vec::new() };
        let text = match found.errors {
            Some(_) => across(a, "the mean"),
            None => "none: a single realization".into(),
        };
        vec![("intensity".into(), text)]
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let Some((found, [least, largest])) = a.intensity().and_then(|found| Some((found, found.range()?))) else {
            return Vec::new();
        };
        vec![format!(
            "intensity: {} to {}, n/|D| = {}; bandwidth {}{}",
            human(least),
            human(largest),
            human(found.mean),
            human(found.bandwidth),
            in_units(a)
        )]
    }
}

fn array<'a>(a: &Analysis, values: &'a [f64]) -> Option<Array<'a>> {
    let shape = vec![a.intensity()?.cells as u64; a.domain.dim()];
    Some(Array { shape, values: Values::Real(Box::new(values.iter().copied())) })
}

/// x slowest.
fn lambda(a: &Analysis) -> Option<Array<'_>> {
    array(a, &a.intensity()?.lambda)
}

fn lambda_se(a: &Analysis) -> Option<Array<'_>> {
    array(a, a.intensity()?.lambda_se.as_ref()?)
}

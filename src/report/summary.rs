//! `summary.json`: everything but the arrays, as docs/summary.schema.json has it. Keys keep the order in which they are added; what is undefined is `null`.

use serde::{Serialize, Serializer};

use super::outputs::sections;
use crate::estimate::Analysis;
use crate::plan::PowerBound;
use crate::points::Boundary;
use crate::points::polygon::{Polygon, Ring};
use crate::statistics::Keys;

/// Raised when a key changes its meaning or goes away; new keys do not raise it.
pub(super) const SCHEMA: u32 = 2;

#[derive(Serialize)]
struct Sizes {
    min: u64,
    mean: f64,
    max: u64,
}

#[derive(Serialize)]
struct DomainOut<'a> {
    boundary: Boundary,
    origin: &'a [f64],
    sides: &'a [f64],
    #[serde(skip_serializing_if = "Option::is_none")]
    polygon: Option<&'a [Vec<Ring>]>,
    measure: f64,
    /// For the mean number of points, in length units.
    closest_packing_distance: f64,
}

#[derive(Serialize)]
struct AccuracyOut {
    name: &'static str,
    power_bound: PowerBound,
}

/// An object whose keys keep the order of the list.
struct InOrder<'a, V>(&'a [(String, V)]);

impl<V: Serialize> Serialize for InOrder<'_, V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(k, v)| (k, v)))
    }
}

/// Stages once each, their times added.
fn added(timings: &[(&'static str, f64)]) -> Vec<(String, f64)> {
    let mut out: Vec<(String, f64)> = Vec::with_capacity(timings.len());
    for (stage, seconds) in timings {
        match out.iter_mut().find(|(s, _)| s == stage) {
            Some((_, sum)) => *sum += seconds,
            None => out.push(((*stage).into(), *seconds)),
        }
    }
    out
}

/// The file's bytes.
pub(super) fn json(a: &Analysis, files: Vec<&'static str>) -> serde_json::Result<Vec<u8>> {
    let mut json = serde_json::Serializer::pretty(Vec::new());
    let mut keys = Keys::new(&mut json)?;
    keys.add("schema", &SCHEMA)?;
    keys.add("program", env!("CARGO_PKG_NAME"))?;
    keys.add("version", env!("CARGO_PKG_VERSION"))?;
    keys.add("subject", &a.subject)?;
    keys.add("input", &a.input)?;
    keys.add("parameters", &InOrder(&a.parameters))?;
    keys.add("n", &Sizes { min: a.min_points, mean: a.shape.mean_points, max: a.shape.max_points })?;
    keys.add("k", &a.shape.realizations)?;
    keys.add("d", &a.domain.dim())?;
    let domain = DomainOut {
        boundary: a.domain.boundary(),
        origin: a.domain.origin(),
        sides: a.domain.sides(),
        polygon: a.domain.as_polygon().map(Polygon::parts),
        measure: a.domain.measure(),
        closest_packing_distance: a.domain.closest_packing_distance(a.shape.mean_points),
    };
    keys.add("domain", &domain)?;
    keys.add("plan", &a.plan)?;
    keys.add("device", &a.computed_by.device())?;
    keys.add("backends", &a.computed_by.backends)?;
    // Pair counts are exact at either setting, so without a spectrum there is nothing to bound.
    let bounded = a.spectrum().is_some();
    let accuracy = bounded.then(|| AccuracyOut { name: a.accuracy.name(), power_bound: a.accuracy.power_bound() });
    keys.add("accuracy", &accuracy)?;
    keys.add("inhomogeneous", &a.inhomogeneity())?;
    for section in sections() {
        section.summary(a, &mut keys)?;
    }
    keys.add("duplicates", &a.duplicates)?;
    keys.add("closed_form", &(!a.closed_form.name.is_empty()).then_some(&a.closed_form.name))?;
    keys.add("warnings", &a.warnings)?;
    keys.add("files", &files)?;
    keys.add("timings_seconds", &InOrder(&added(&a.timings)))?;
    keys.end()?;
    let mut bytes = json.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

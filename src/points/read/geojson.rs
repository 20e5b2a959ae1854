//! GeoJSON: `Point` and `MultiPoint`, alone, as features or collections of them. Coordinates are x and y, z where every position has it;
//! properties of features are further columns.

use std::collections::HashMap;

use ::geojson::{Feature, GeoJson, Geometry, GeometryValue, JsonObject, JsonValue, Position};

use super::columns::Column;
use super::table::{Described, Field, Table};
use super::{Apart, Columns, MarkedPoints};
use crate::error::{Error, Result, plural};

/// Whether a text that begins with a brace is GeoJSON.
pub(super) fn is(head: &str) -> bool {
    ["\"Feature", "\"coordinates\""].iter().any(|word| head.contains(word)) && !head.contains("\"Topology\"")
}

/// What is said of positions that are degrees by the standard: of 2016 it knows nothing else; the one before had a member `crs`.
pub(super) fn degrees<'a>(json: &GeoJson, mut positions: impl Iterator<Item = &'a [f64]>) -> Option<&'static str> {
    let members = match json {
        GeoJson::Geometry(geometry) => geometry.foreign_members.as_ref(),
        GeoJson::Feature(feature) => feature.foreign_members.as_ref(),
        GeoJson::FeatureCollection(all) => all.foreign_members.as_ref(),
    };
    let on_globe = |p: &[f64]| matches!(p, [x, y, ..] if x.abs() <= 180.0 && y.abs() <= 90.0);
    (members.is_none_or(|m| !m.contains_key("crs")) && positions.all(on_globe)).then_some(
        "GeoJSON without a `crs` is by its standard in degrees of longitude and latitude; if this is, project it: \
         distances between degrees mean little",
    )
}

/// A feature, or a geometry that is one.
struct Row<'a> {
    positions: Vec<&'a Position>,
    properties: Option<&'a JsonObject>,
}

pub(super) fn read(name: &str, text: &str, columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let fail = |reason: String| Error::input(name, reason);
    let json: GeoJson = text.parse().map_err(|e| fail(format!("is no GeoJSON: {e}")))?;
    let mut rows = Vec::new();
    let mut without = 0;
    match &json {
        GeoJson::Geometry(geometry) => {
            rows.push(Row { positions: positions(geometry).map_err(fail)?, properties: None })
        }
        GeoJson::Feature(feature) => rows.extend(row(feature).map_err(fail)?),
        GeoJson::FeatureCollection(all) => {
            for (k, feature) in all.features.iter().enumerate() {
                let found = row(feature).map_err(|reason| Error::input(format!("{name}, feature {k}"), reason))?;
                without += u64::from(found.is_none());
                rows.extend(found);
            }
        }
    }
    let every = || rows.iter().flat_map(|row| row.positions.iter().copied());
    if let Some(short) = every().find(|position| position.len() < 2) {
        return Err(fail(format!("has a position of {}; expected x and y", plural(short.len() as u64, "number"))));
    }
    let high = every().filter(|position| position.len() > 2).count();
    let dim = if high > 0 && high == every().count() { 3 } else { 2 };
    let mut names: Vec<String> = ["x", "y", "z"][..dim].iter().map(|name| name.to_string()).collect();
    let mut known = HashMap::new();
    for key in rows.iter().filter_map(|row| row.properties).flat_map(|properties| properties.keys()) {
        if !known.contains_key(key.as_str()) {
            known.insert(key.as_str(), names.len());
            names.push(key.clone());
        }
    }
    let mut chosen = columns.clone();
    if chosen.coordinates.is_empty() {
        // A property of the name x is none.
        chosen.coordinates = (1..=dim).map(Column::Number).collect();
    }
    let mut table = Table::new(name, &chosen, &names, None)?;
    for row in &rows {
        for position in &row.positions {
            table.row(None, |k| match (position.as_slice().get(k).filter(|_| k < dim), row.properties) {
                (Some(&x), _) => Field::Number(x),
                (None, Some(properties)) => value(properties.get(&names[k])),
                (None, None) => Field::Nothing,
            })?;
        }
    }
    table.end_set();
    let mut notes = Vec::new();
    if without > 0 {
        notes.push(format!("{} without a geometry left out", plural(without, "feature")));
    }
    if high > 0 && dim == 2 {
        notes.push(format!(
            "{} of {} have a height, which was left out",
            plural(high as u64, "point"),
            every().count()
        ));
    }
    notes.extend(degrees(&json, every().map(|position| position.as_slice())).map(String::from));
    table.finish(Described { format: "GeoJSON".into(), apart: Apart::Files, notes, ..Described::default() })
}

fn row(feature: &Feature) -> Result<Option<Row<'_>>, String> {
    let row = |geometry| Ok(Row { positions: positions(geometry)?, properties: feature.properties.as_ref() });
    feature.geometry.as_ref().map(row).transpose()
}

fn positions(geometry: &Geometry) -> Result<Vec<&Position>, String> {
    match &geometry.value {
        GeometryValue::Point { coordinates } => Ok(vec![coordinates]),
        GeometryValue::MultiPoint { coordinates } => Ok(coordinates.iter().collect()),
        other => Err(format!("is a {}; expected a Point or a MultiPoint", other.type_name())),
    }
}

fn value(value: Option<&JsonValue>) -> Field<'_> {
    match value {
        Some(JsonValue::Number(number)) => number.as_f64().map_or(Field::Nothing, Field::Number),
        Some(JsonValue::String(text)) => Field::Text(text.as_str().into()),
        Some(JsonValue::Bool(flag)) => Field::Text(flag.to_string().into()),
        Some(JsonValue::Null | JsonValue::Array(_) | JsonValue::Object(_)) | None => Field::Nothing,
    }
}

//! Outlines of windows: WKT, GeoJSON, or the vertices of one ring as points are read. By content: WKT begins with a word, GeoJSON
//! with a brace.

use std::path::Path;

use ::geojson::{GeoJson, GeometryValue, Position};
use wkt::Wkt;
use wkt::types::Coord;

use super::geojson::degrees;
use super::{Columns, ReadOptions, read_bytes};
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::points::polygon::Ring;
use crate::setting::Setting;

/// Reads `--window-polygon`: the window, and what the user should know about the file.
///
/// # Errors
/// What the file system says; what is no polygon, by its line or ring.
pub fn read_polygon(path: &Path) -> Result<(Domain, Vec<String>)> {
    polygon_of_bytes(path, &crate::input::read(path)?)
}

/// The same of the bytes of a file, which `path` is the name of.
///
/// # Errors
/// What is no polygon, by its line or ring.
pub fn polygon_of_bytes(path: &Path, bytes: &[u8]) -> Result<(Domain, Vec<String>)> {
    let place = path.display().to_string();
    let fail = |reason: String| Error::input(&place, reason);
    let text = std::str::from_utf8(bytes).ok().map(|text| text.trim_start_matches('\u{feff}').trim());
    let (parts, notes) = match text {
        Some("") => return Err(fail(format!("is empty; {EXPECTED}"))),
        Some(text) if text.starts_with('{') => of_geojson(text).map_err(fail)?,
        Some(text) if is_wkt(text) => (of_wkt(text).map_err(fail)?, Vec::new()),
        _ => of_vertices(path, bytes)?,
    };
    let domain = Domain::polygon(parts).map_err(|e| match e {
        Error::Setting { setting: Setting::WindowPolygon, value, reason } if value == "polygon" => fail(reason),
        Error::Setting { setting: Setting::WindowPolygon, value, reason } => {
            Error::input(format!("{place}, {value}"), reason)
        }
        Error::Setting { value, reason, .. } => fail(format!("its bounding box {value}: {reason}")),
        other => other,
    })?;
    let notes = notes.into_iter().map(|note| if note.starts_with(&place) { note } else { format!("{place}: {note}") });
    Ok((domain, notes.collect()))
}

const EXPECTED: &str =
    "expected a WKT POLYGON or MULTIPOLYGON, a GeoJSON Polygon or MultiPolygon, or x and y of one vertex per line";

/// Whether a text begins as WKT does, perhaps with the number of a reference system.
fn is_wkt(text: &str) -> bool {
    const WORDS: [&str; 7] =
        ["POLYGON", "MULTIPOLYGON", "POINT", "LINESTRING", "MULTIPOINT", "MULTILINESTRING", "GEOMETRYCOLLECTION"];
    let text = without_srid(text);
    let word: String = text.chars().take_while(char::is_ascii_alphabetic).collect();
    WORDS.contains(&word.to_ascii_uppercase().as_str())
}

/// `SRID=25832;` stands before a geometry in the WKT of PostGIS.
fn without_srid(text: &str) -> &str {
    match text.get(..5) {
        Some(start) if start.eq_ignore_ascii_case("srid=") => {
            text.split_once(';').map_or(text, |(_, rest)| rest.trim())
        }
        _ => text,
    }
}

fn of_wkt(text: &str) -> Result<Vec<Vec<Ring>>, String> {
    let ring = |line: &wkt::types::LineString<f64>| line.coords().iter().map(|c: &Coord<f64>| [c.x, c.y]).collect();
    let rings = |polygon: &wkt::types::Polygon<f64>| polygon.rings().iter().map(ring).collect::<Vec<Ring>>();
    let wkt: Wkt<f64> = without_srid(text).parse().map_err(|e: &str| format!("is no WKT: {e}; {EXPECTED}"))?;
    let parts: Vec<Vec<Ring>> = match &wkt {
        Wkt::Polygon(polygon) => vec![rings(polygon)],
        Wkt::MultiPolygon(all) => all.polygons().iter().map(rings).collect(),
        other => {
            let word = other.to_string();
            let word = word.split(['(', ' ']).next().unwrap_or_default();
            return Err(format!("is a {word}; {EXPECTED}"));
        }
    };
    Ok(parts)
}

fn of_geojson(text: &str) -> Result<(Vec<Vec<Ring>>, Vec<String>), String> {
    let json: GeoJson = text.parse().map_err(|e| format!("is no GeoJSON: {e}; {EXPECTED}"))?;
    let geometry = match &json {
        GeoJson::Geometry(geometry) => Some(geometry),
        GeoJson::Feature(feature) => feature.geometry.as_ref(),
        GeoJson::FeatureCollection(all) => {
            if all.features.len() != 1 {
                let n = all.features.len();
                return Err(format!(
                    "is a FeatureCollection of {n} features; expected one, a Polygon or a MultiPolygon"
                ));
            }
            all.features[0].geometry.as_ref()
        }
    };
    let geometry = geometry.ok_or_else(|| format!("is a feature without a geometry; {EXPECTED}"))?;
    let polygon =
        |rings: &Vec<Vec<Position>>| rings.iter().map(|ring| of_positions(ring)).collect::<Result<Vec<Ring>, _>>();
    let parts = match &geometry.value {
        GeometryValue::Polygon { coordinates } => vec![polygon(coordinates)?],
        GeometryValue::MultiPolygon { coordinates } => coordinates.iter().map(polygon).collect::<Result<_, _>>()?,
        other => return Err(format!("is a {}; {EXPECTED}", other.type_name())),
    };
    let every = parts.iter().flatten().flatten().map(|vertex| vertex.as_slice());
    let notes = degrees(&json, every).map(String::from).into_iter().collect();
    Ok((parts, notes))
}

fn of_positions(ring: &[Position]) -> Result<Ring, String> {
    let vertex = |p: &Position| match p.as_slice() {
        [x, y, ..] => Ok([*x, *y]),
        few => Err(format!("has a position of {} numbers; expected x and y", few.len())),
    };
    ring.iter().map(vertex).collect()
}

/// One ring, read as points are: headers, separators, encodings.
fn of_vertices(path: &Path, bytes: &[u8]) -> Result<(Vec<Vec<Ring>>, Vec<String>)> {
    let place = path.display().to_string();
    let options = ReadOptions { dim: Some(2), raw: None };
    let sets =
        read_bytes(&place, &super::extension(path), bytes, &options, &Columns::default()).map_err(|e| match e {
            Error::Input { place, reason } => {
                Error::input(place, format!("{reason} (the file of a window: {EXPECTED})"))
            }
            other => other,
        })?;
    let [set] = sets.as_slice() else {
        let reason = format!("{} rings of vertices; expected one: holes and parts need WKT or GeoJSON", sets.len());
        return Err(Error::input(place, reason));
    };
    if set.points.dim != 2 {
        let reason = format!("{} numbers per vertex; expected x and y", set.points.dim);
        return Err(Error::input(set.points.place(0), reason));
    }
    let ring = set.points.coordinates.as_chunks::<2>().0.to_vec();
    Ok((vec![vec![ring]], set.reading.notes.clone()))
}

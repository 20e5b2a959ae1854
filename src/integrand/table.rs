//! A table of values: constant on equal cells.

use std::path::Path;
use std::sync::Arc;

use super::cells::Cells;
use super::entry::{Entry, Given};
use super::image::MOST_CELLS;
use super::shape::Shape;
use super::spec::{Parameter, Takes};
use crate::error::{Error, Result};
use crate::points::read::array_of_bytes;

pub(super) static ENTRY: Entry = Entry {
    formulas: "as of an image, in any dimension",
    source: "as of steps",
    parameters: &[Parameter::new(
        "file",
        "",
        Takes::Path,
        "NPY, one axis per dimension, x first; in 1D also text: the last number of each line",
    )],
    example: "table:file=values.npy",
    ..Entry::new("table", "values of a file on equal cells", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let path = Path::new(given.text("file")?);
    let bytes = crate::input::read(path)?;
    let wrong = |reason: String| Error::input(path.display().to_string(), reason);
    let is_npy = bytes.starts_with(b"\x93NUMPY");
    let (shape, values) = match (is_npy, given.dim) {
        (true, dim) => npy(&path.display().to_string(), &bytes, dim)?,
        (false, 1) => text(&bytes).map_err(wrong)?,
        (false, dim) => return Err(wrong(format!("this is no NPY; expected one with {dim} axes (text is for 1D)"))),
    };
    if values.len() < 2 {
        return Err(wrong(format!("{} values; expected two or more", values.len())));
    }
    if let Some(at) = values.iter().position(|v| !v.is_finite()) {
        let index = [at / (shape[1] * shape[2]), at / shape[2] % shape[1], at % shape[2]];
        let place: Vec<String> = index[..given.dim].iter().map(usize::to_string).collect();
        return Err(wrong(format!("value [{}] is {}; expected finite values", place.join(", "), values[at])));
    }
    Ok(Arc::new(Cells::new(shape, values)))
}

fn npy(name: &str, bytes: &[u8], dim: usize) -> Result<([usize; 3], Vec<f64>)> {
    let wrong = |reason: String| Error::input(name, reason);
    let (given, values) = array_of_bytes(name, bytes)?;
    if given.len() != dim {
        let words = given.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        return Err(wrong(format!("shape ({words}); expected {dim} axes, x first")));
    }
    if values.len() > MOST_CELLS {
        return Err(wrong(format!("too many values; expected at most {MOST_CELLS}")));
    }
    let mut shape = [1; 3];
    shape[..dim].copy_from_slice(&given);
    Ok((shape, values))
}

fn text(bytes: &[u8]) -> Result<([usize; 3], Vec<f64>), String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "neither NPY nor text; expected one of these".to_string())?;
    let mut values = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let Some(last) = line.split(|c: char| c.is_whitespace() || ",;".contains(c)).rfind(|word| !word.is_empty())
        else {
            continue;
        };
        match last.parse() {
            Ok(value) => values.push(value),
            // A header.
            Err(_) if values.is_empty() => {}
            Err(_) => return Err(format!("line {}: {last:?}; expected a number", i + 1)),
        }
    }
    if values.len() > MOST_CELLS {
        return Err(format!("{} values; expected at most {MOST_CELLS}", values.len()));
    }
    Ok(([values.len(), 1, 1], values))
}

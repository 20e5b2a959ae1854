//! `.npz`: a zip archive of `.npy` arrays. One array is the points; several are realizations where their names differ in a number
//! alone (each may be several, if its shape is (K, n, d)), in the natural order of their names; arrays x, y and z are coordinates.
//! Anything else is chosen by name, because arrays of speeds, of weights and of points look alike.

use std::io::{Cursor, Read};

use super::{Apart, Columns, MarkedPoints, Rows, Sets, foreign, natural_key, npy};
use crate::error::{Error, Result, plural};

/// The first entry of an archive, and the end of an empty one.
pub(super) const MAGICS: [&[u8]; 2] = [b"PK\x03\x04", b"PK\x05\x06"];

/// An array of the archive: its name and its `.npy` file.
struct Array {
    name: String,
    content: Vec<u8>,
}

impl Array {
    fn shape(&self) -> Vec<u64> {
        npy::shape(&self.content).unwrap_or_default()
    }

    /// `x (60,)`
    fn shown(&self) -> String {
        let sides: Vec<_> = self.shape().iter().map(u64::to_string).collect();
        format!("{} ({}{})", self.name, sides.join(", "), if sides.len() == 1 { "," } else { "" })
    }
}

pub(super) fn read(name: &str, bytes: &[u8], dim: Option<usize>, columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let fail = |reason: String| Error::input(name, reason);
    let arrays = open(name, bytes)?;
    let chosen: Vec<&Array> = match columns.arrays.as_slice() {
        [] => by_themselves(&arrays, dim, columns).map_err(fail)?,
        names => names.iter().map(|wanted| find(&arrays, wanted)).collect::<Result<_, _>>().map_err(fail)?,
    };
    let flat = chosen.iter().all(|array| array.shape().len() == 1);
    let numbered_names = alike(&chosen) && (dim == Some(1) || !flat);
    let asked = !columns.arrays.is_empty();
    // Of one length, and each a column: coordinates.
    if flat && (!numbered_names || asked) && (chosen.len() > 1 || beside(&arrays, &chosen, columns).count() > 0) {
        return columns_of(name, &arrays, &chosen, columns);
    }
    if let ([one], 1..) = (chosen.as_slice(), beside(&arrays, &chosen, columns).count()) {
        return columns_of(name, &arrays, &[*one], columns);
    }
    let mut sets = Vec::new();
    for array in &chosen {
        let place = format!("{name}, array {}", array.name);
        let mut read = npy::read(&place, &array.content, columns)?;
        read.format = format!("NPZ, {}", read.format);
        if chosen.len() > 1 {
            read.apart = Apart::Arrays;
        }
        sets.extend(super::numbered(&place, read, columns)?);
    }
    if chosen.len() == 1 && arrays.len() > 1 {
        note_rest(&mut sets, &arrays, &chosen);
    }
    Ok(sets)
}

/// All arrays of the archive, in the natural order of their names.
fn open(name: &str, bytes: &[u8]) -> Result<Vec<Array>> {
    let damaged = |place: &str, e: &dyn std::fmt::Display| Error::input(place, format!("damaged zip archive: {e}"));
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|e| damaged(name, &e))?;
    let names: Result<Vec<String>, _> = archive.file_names().map(|entry| entry.map(|e| e.into_owned())).collect();
    let mut entries = names.map_err(|e| damaged(name, &e))?;
    if let Some(reason) = foreign::named_archive(&entries) {
        return Err(Error::input(name, reason));
    }
    entries.retain(|entry| !entry.ends_with('/'));
    entries.sort_by_cached_key(|entry| natural_key(entry));
    if entries.is_empty() {
        return Err(Error::input(name, "no arrays in this archive"));
    }
    let mut arrays = Vec::new();
    for entry in entries {
        let Some(array) = entry.strip_suffix(".npy") else {
            let reason = format!("a zip archive, but its entry {entry:?} is not a .npy array; expected .npz");
            return Err(Error::input(name, reason));
        };
        let place = format!("{name}, array {array}");
        let mut content = Vec::new();
        // The size that the archive claims is not trusted: the buffer grows with what is there.
        let mut file = archive.by_name(&entry).map_err(|e| damaged(&place, &e))?;
        file.read_to_end(&mut content).map_err(|e| damaged(&place, &e))?;
        if !content.starts_with(npy::MAGIC) {
            return Err(Error::input(place, "not a .npy array"));
        }
        arrays.push(Array { name: array.to_string(), content });
    }
    Ok(arrays)
}

fn find<'a>(arrays: &'a [Array], wanted: &str) -> Result<&'a Array, String> {
    let exact = arrays.iter().find(|array| array.name == wanted);
    exact
        .or_else(|| arrays.iter().find(|array| array.name.eq_ignore_ascii_case(wanted)))
        .ok_or_else(|| format!("`array` {wanted}: no array of that name; there are {}", shown(arrays)))
}

fn shown(arrays: &[Array]) -> String {
    arrays.iter().map(Array::shown).collect::<Vec<_>>().join(", ")
}

/// Whether the names differ in a number alone.
fn alike(arrays: &[&Array]) -> bool {
    let stem = |array: &Array| array.name.trim_end_matches(|c: char| c.is_ascii_digit()).to_string();
    let numbered = arrays.iter().all(|array| array.name.ends_with(|c: char| c.is_ascii_digit()));
    arrays.len() < 2 || (numbered && arrays.iter().all(|array| stem(array) == stem(arrays[0])))
}

/// The arrays that are points where nobody chose any.
fn by_themselves<'a>(arrays: &'a [Array], dim: Option<usize>, columns: &Columns) -> Result<Vec<&'a Array>, String> {
    // Those that flags name hold something else.
    let all: Vec<&Array> = arrays.iter().filter(|array| !is_named(array, columns)).collect();
    if let [one] = all.as_slice() {
        return Ok(vec![one]);
    }
    let axis = |name: &str| all.iter().copied().find(|array| array.name.eq_ignore_ascii_case(name));
    let axes: Vec<&Array> = ["x", "y", "z"].into_iter().map_while(axis).collect();
    let same = |a: &Array, b: &Array| a.shape().len() == 1 && a.shape() == b.shape();
    if axes.len() == all.len() && axes.iter().all(|array| same(array, axes[0])) {
        return Ok(axes);
    }
    let flat = all.iter().all(|array| array.shape().len() == 1);
    if alike(&all) && (!flat || dim == Some(1)) {
        return Ok(all);
    }
    let choose = match columns.rows {
        Rows::WaveVectors { .. } => "expected one array",
        Rows::Points if alike(&all) => {
            "`array` with one name per coordinate makes them one set; a domain of one axis, realizations in 1D"
        }
        Rows::Points => "`array` NAME chooses the points, or one array per coordinate, as in x,y",
    };
    Err(format!("holds {}: {}; {choose}", plural(arrays.len() as u64, "array"), shown(arrays)))
}

/// Whether a flag names an array as a column.
fn is_named(array: &Array, columns: &Columns) -> bool {
    let marks = [columns.weight.as_ref(), columns.class.as_ref(), columns.realization()];
    let is =
        |column: &super::Column| matches!(column, super::Column::Name(name) if name.eq_ignore_ascii_case(&array.name));
    marks.into_iter().flatten().any(is)
}

/// Arrays that flags name as columns, besides those of points.
fn beside<'a>(
    arrays: &'a [Array],
    chosen: &'a [&'a Array],
    columns: &'a Columns,
) -> impl Iterator<Item = &'a Array> + use<'a> {
    let is_chosen = |array: &Array| chosen.iter().any(|c| c.name == array.name);
    arrays.iter().filter(move |array| is_named(array, columns) && !is_chosen(array))
}

/// One set of points whose columns are arrays: of coordinates, and those that flags name.
fn columns_of(name: &str, arrays: &[Array], chosen: &[&Array], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let plain = Columns { rows: columns.rows, coordinates: vec![super::Column::Number(1)], ..Columns::default() };
    let all: Vec<&Array> = chosen.iter().copied().chain(beside(arrays, chosen, columns)).collect();
    let (mut names, mut parts, mut digits, mut format) = (Vec::new(), Vec::new(), None, String::new());
    for array in &all {
        let place = format!("{name}, array {}", array.name);
        if array.shape().len() > 2 {
            let reason = format!("{}: beside others, arrays of one set have the shape (n,) or (n, d)", array.shown());
            return Err(Error::input(place, reason));
        }
        let part = npy::read(&place, &array.content, &plain)?;
        match part.width {
            1 => names.push(array.name.clone()),
            d => names.extend((1..=d).map(|k| format!("{}[{}]", array.name, k - 1))),
        }
        if chosen.iter().any(|c| c.name == array.name) {
            digits = digits.into_iter().chain(part.digits).min();
            format = format!("NPZ, {}", part.format);
        }
        parts.push((part.width, part.sets.into_iter().next().unwrap_or_default()));
    }
    let rows = parts.first().map_or(0, |(width, values)| values.len() / width);
    if parts.iter().any(|(width, values)| values.len() / width != rows) {
        let shown: Vec<_> = all.iter().map(|array| array.shown()).collect();
        let reason = format!("arrays of one set must have as many rows each, found {}", shown.join(", "));
        return Err(Error::input(name, reason));
    }
    let width = parts.iter().map(|(width, _)| width).sum();
    let row =
        |j: usize| parts.iter().flat_map(move |(width, values)| values[j * width..(j + 1) * width].iter().copied());
    let sets = vec![(0..rows).flat_map(row).collect()];
    let set = Sets { width, sets, first: None, names, format, apart: Apart::Files, digits };
    let mut sets = super::numbered(name, set, columns)?;
    note_rest(&mut sets, arrays, &all);
    Ok(sets)
}

/// Names the arrays that were not used.
fn note_rest(sets: &mut [MarkedPoints], arrays: &[Array], used: &[&Array]) {
    let rest = arrays.iter().filter(|array| !used.iter().any(|u| u.name == array.name));
    let rest: Vec<String> = rest.map(|array| array.name.clone()).collect();
    let Some(first) = sets.first().filter(|_| !rest.is_empty()) else { return };
    let mut reading = (*first.reading).clone();
    reading.unused.extend(rest.into_iter().map(|name| format!("array {name}")));
    let reading = std::sync::Arc::new(reading);
    sets.iter_mut().for_each(|set| set.reading = reading.clone());
}

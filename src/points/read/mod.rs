//! Readers, one per format, and which of them reads a file; `walk` finds the files. What a file holds is decided by its content
//! first and by its name only where the content says nothing:
//!
//! 1. `--raw` given: raw numbers, whatever the file looks like.
//! 2. `\x93NUMPY`, `PK`, `UTK!` at the start: `.npy`, `.npz`, UTK `.bin`.
//! 3. Formats whose columns have names: PLY, VTK, XYZ, LAMMPS dumps, GeoJSON, Parquet and Arrow.
//! 4. Formats of other trades, which are named and refused.
//! 5. Bytes that are text, in UTF-8 or UTF-16: text or CSV, whatever the name.
//! 6. Other bytes: `.rps`, `.f32` and `.f64` by name. Without a telling name they are taken for `.rps` only if every
//!    number is one that PSA could have written (a fraction in [0, 1)); anything else is an error, never a guess.

#[cfg(feature = "tables")]
mod columnar;
mod columns;
mod foreign;
mod geojson;
mod lammps;
mod npy;
mod npz;
mod ply;
mod polygon;
mod raw;
mod reading;
mod stated;
mod table;
mod text;
mod utk;
mod vtk;
mod walk;
mod xyz;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::input;
use crate::points::RawPoints;

use columns::Marks;
pub use columns::{Column, Columns, MarkedPoints, Rows, Separator, TypedColumns};
pub(crate) use npy::array_of_bytes;
pub use polygon::{polygon_of_bytes, read_polygon};
pub use raw::{RawElement, RawLayout};
pub use reading::{Apart, Input, LeftOut, Reading};
pub use stated::StatedBox;
pub(crate) use text::{has_decimal_comma, is_decimal_comma};
pub(crate) use walk::{
    Broken, Found, OnBroken, PointFile, each_piece, extension, folders_left_out, is_stdin, lasts, paths,
};
use walk::{KNOWN_EXTENSIONS, natural_key};

/// What the command line says about its input files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The number of coordinates per point, if a flag fixed it.
    pub dim: Option<usize>,
    /// `--raw`: the files hold nothing but numbers, in this layout.
    pub raw: Option<RawLayout>,
}

/// How a scan begins, which stands for files and holds no points itself.
pub(crate) const SCAN: &str = "{\"pairwave_scan\":";

/// Reads every realization of every file, in order. An input is a file, a directory (its files in natural order,
/// hidden files and subdirectories left out), a pattern with `*`, `?` or `[...]`, or `-` for standard input.
///
/// # Errors
/// Names the file, line or point, what was found and what would be right.
pub fn read_all(inputs: &[PathBuf], options: &ReadOptions) -> Result<Vec<RawPoints>> {
    let marked = read_marked(inputs, options, &Columns::default())?;
    Ok(marked.into_iter().map(|set| set.points).collect())
}

/// The same, with the columns that hold no coordinates.
///
/// # Errors
/// As `read_all`.
pub fn read_marked(inputs: &[PathBuf], options: &ReadOptions, columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let mut batch = Vec::new();
    each_piece(inputs, options, columns, OnBroken::Stop, |found| {
        if let Found::Piece(_, piece) = found {
            batch.extend(piece);
        }
        Ok(())
    })?;
    Ok(batch)
}

/// Every realization of one file, at least one.
fn read_file(path: &Path, options: &ReadOptions, columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let (name, bytes) = read_whole(path)?;
    read_bytes(&name, &extension(path), &bytes, options, columns)
}

/// What a file is called, and its bytes.
pub(crate) fn read_whole(path: &Path) -> Result<(String, Vec<u8>)> {
    if !is_stdin(path) {
        return Ok((path.display().to_string(), input::read(path)?));
    }
    Ok(("standard input".to_owned(), input::read_stdin()?))
}

/// Every realization of bytes that are a file's, at least one.
pub(crate) fn read_bytes(
    name: &str,
    extension: &str,
    bytes: &[u8],
    options: &ReadOptions,
    columns: &Columns,
) -> Result<Vec<MarkedPoints>> {
    if bytes.is_empty() {
        return Err(Error::input(name, "the file is empty"));
    }
    if let Some(layout) = options.raw {
        return raw::read(name, bytes, layout, columns);
    }
    if bytes.starts_with(npy::MAGIC) {
        return numbered(name, npy::read(name, bytes, columns)?, columns);
    }
    if npz::MAGICS.iter().any(|magic| bytes.starts_with(magic)) {
        return npz::read(name, bytes, options.dim, columns);
    }
    if bytes.starts_with(&utk::MAGIC) {
        if columns.count() > 0 {
            return Err(Error::input(
                name,
                "a UTK .bin holds coordinates only; weights, classes and numbers of realizations need another format",
            ));
        }
        return numbered(name, utk::read(name, bytes, columns)?, columns);
    }
    if let Some(read) = tabled(name, bytes, columns) {
        return read;
    }
    let place = |reason: String| Error::input(name, reason);
    if let Some(reason) = foreign::named(bytes, extension) {
        return Err(place(reason));
    }
    if !columns.arrays.is_empty() {
        return Err(place("`array` chooses arrays of an .npz archive, which this file is not".into()));
    }
    if let Some(encoding) = text::utf16(bytes) {
        let (decoded, damaged) = encoding.decode_with_bom_removal(bytes);
        if damaged {
            return Err(place(format!("text in {}, but damaged: some of it is no character", encoding.name())));
        }
        if let Some(read) = tabled(name, decoded.as_bytes(), columns) {
            return read;
        }
        if let Some(reason) = foreign::named(decoded.as_bytes(), extension) {
            return Err(place(reason));
        }
        return text::read(name, decoded.as_bytes(), options.dim, columns, encoding.name());
    }
    if text::is_text(bytes) {
        return text::read(name, bytes, options.dim, columns, "");
    }
    let element = match extension {
        "rps" => return raw::read(name, bytes, RawLayout::RPS, columns),
        "f32" => RawElement::F32,
        "f64" => RawElement::F64,
        _ if KNOWN_EXTENSIONS.contains(&extension) || !raw::could_be_rps(bytes) => {
            return Err(unknown(name, columns.rows));
        }
        _ => return raw::read(name, bytes, RawLayout::RPS, columns),
    };
    match options.dim {
        Some(dim) => raw::read(name, bytes, RawLayout::new(element, dim + columns.count())?, columns),
        None => {
            let reason = format!("raw numbers do not say how many make a point; give `raw` {extension}x2 (or x1, x3)");
            Err(Error::input(name, reason))
        }
    }
}

/// Every realization of bytes whose format names its columns, if they are of such a format.
fn tabled(name: &str, bytes: &[u8], columns: &Columns) -> Option<Result<Vec<MarkedPoints>>> {
    /// So many bytes of a text are looked at.
    const HEAD: usize = 1 << 13;
    if ply::MAGICS.iter().any(|magic| bytes.starts_with(magic)) {
        return Some(ply::read(name, bytes, columns));
    }
    if bytes.starts_with(vtk::MAGIC) {
        return Some(vtk::read(name, bytes, columns));
    }
    #[cfg(feature = "tables")]
    if [columnar::PARQUET, columnar::ARROW].iter().any(|magic| bytes.starts_with(magic)) {
        return Some(columnar::read(name, bytes, columns));
    }
    if !text::is_text(bytes) {
        return None;
    }
    let bytes = bytes.strip_prefix(text::UTF8_MARK).unwrap_or(bytes);
    let start = bytes.trim_ascii_start();
    let head = &bytes[..bytes.len().min(HEAD)];
    if start.starts_with(lammps::START) {
        return Some(lammps::read(name, bytes, columns));
    }
    if start.starts_with(b"{") && geojson::is(&String::from_utf8_lossy(head)) {
        let text = std::str::from_utf8(bytes).map_err(|_| Error::input(name, "GeoJSON that is no UTF-8"));
        return Some(text.and_then(|text| geojson::read(name, text, columns)));
    }
    let lines: Vec<&[u8]> = text::Lines(head).take(3).collect();
    xyz::is(&lines).then(|| xyz::read(name, bytes, columns))
}

fn unknown(name: &str, rows: Rows) -> Error {
    let raw = match rows {
        Rows::Points => "need `raw` f32x2 or the like",
        Rows::WaveVectors { .. } => "need a name that ends in .f32 or .f64",
    };
    Error::input(name, format!("neither text nor .npy, .npz or UTK .bin (no such header); raw numbers {raw}"))
}

/// Several arrays of `n * width` numbers: what the binary readers deliver.
struct Sets {
    width: usize,
    sets: Vec<Vec<f64>>,
    /// The number of the first, where these are some of many.
    first: Option<u64>,
    /// The names of the columns, if there are any.
    names: Vec<String>,
    /// As in a reading.
    format: String,
    apart: Apart,
    digits: Option<u32>,
}

/// One set is called by its file; several are numbered from 0.
fn numbered(name: &str, all: Sets, columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let Sets { width, sets, first, names, format, apart, digits } = all;
    let fail = |reason: String| Error::input(name, reason);
    let bytes: Vec<&[u8]> = names.iter().map(String::as_bytes).collect();
    let marks = columns.find(width, &bytes).map_err(fail)?;
    let taken = marks.coordinates(width);
    if !(1..=columns.most_axes()).contains(&taken.len()) {
        let reason = match taken.len() {
            0 => "no column is left for coordinates".to_string(),
            n => {
                let most = columns.most_axes();
                format!("{n} columns are left for coordinates, expected 1 to {most}; `columns` chooses, as in 1,2")
            }
        };
        return Err(fail(reason));
    }
    let called = |k: usize| names.get(k).cloned().unwrap_or_else(|| (k + 1).to_string());
    let realization = columns.realization.as_ref().and(marks.realization);
    if columns.realization == Some(Separator::BlankLines) {
        return Err(fail("`realization_column` blank-lines is about text, which this file is not".into()));
    }
    if let Some(column) = realization.filter(|_| sets.len() > 1) {
        let reason = format!("`realization_column` {}: its arrays are realizations already", called(column));
        return Err(fail(reason));
    }
    let mut reading = Reading {
        format,
        columns: taken.iter().map(|&k| called(k)).collect(),
        unused: (0..width).filter(|k| !taken.contains(k) && !marks.contain(*k)).map(called).collect(),
        apart: realization.map_or(apart, |k| Apart::Column(called(k))),
        digits,
        stated: None,
        notes: Vec::new(),
    };
    let single = sets.len() == 1 && first.is_none();
    let source = |k: usize| {
        if single { name.to_owned() } else { format!("{name}, realization {}", first.unwrap_or(0) + k as u64) }
    };
    let mut done = Vec::new();
    for (k, coordinates) in sets.into_iter().enumerate() {
        let all = RawPoints { dim: width, coordinates, source: source(k), lines: Vec::new() };
        let (set, keys) = MarkedPoints::split(all, &marks, Arc::default())?;
        match realization {
            Some(column) => done.extend(by_value(set, &keys, &format!("realization {}", called(column)))),
            None => done.push(set),
        }
    }
    if marks.coordinates.is_empty() && names.is_empty() && first.unwrap_or(0) == 0 {
        match suspicious(&done, |k| Some(called(taken[k]))) {
            Some(Ok(note)) => reading.notes.push(format!("{name}: {note}")),
            Some(Err(reason)) if columns.rows == Rows::Points => return Err(fail(reason)),
            _ => {}
        }
    }
    let reading = Arc::new(reading);
    done.iter_mut().for_each(|set| set.reading = reading.clone());
    Ok(done)
}

/// Points apart by a number each has.
fn by_value(set: MarkedPoints, values: &[f64], what: &str) -> Vec<MarkedPoints> {
    let (mut known, mut names) = (HashMap::new(), Vec::new());
    let key = |value: &f64| {
        // 0 has two signs.
        *known.entry((value + 0.0).to_bits()).or_insert_with(|| {
            names.push(value.to_string());
            names.len() as u32 - 1
        })
    };
    let keys: Vec<u32> = values.iter().map(key).collect();
    set.apart(&keys, &names, what)
}

/// A column among coordinates that nobody named which numbers the points or their realizations: why it is refused, or what is
/// said of it. `name` has the columns that may be such.
fn suspicious(sets: &[MarkedPoints], name: impl Fn(usize) -> Option<String>) -> Option<Result<String, String>> {
    const FEWEST: usize = 4;
    let set = &sets.first()?.points;
    let dim = set.dim;
    if dim < 2 || set.len() < FEWEST {
        return None;
    }
    let whole = |axis: usize| set.coordinates.chunks_exact(dim).all(|point| point[axis].fract() == 0.0);
    for axis in (0..dim).filter(|&axis| whole(axis)) {
        let Some(called) = name(axis) else { continue };
        let values = || set.coordinates.chunks_exact(dim).map(move |point| point[axis]);
        let others: Vec<usize> = (0..dim).filter(|&other| other != axis).collect();
        let all_whole = others.iter().all(|&other| whole(other));
        let listed = |axes: &[usize]| {
            let names: Vec<_> = axes.iter().map(|&axis| name(axis).unwrap_or((axis + 1).to_string())).collect();
            names.join(",")
        };
        let (without, with) = (listed(&others), listed(&(0..dim).collect::<Vec<_>>()));
        let first = set.coordinates[axis];
        if (first == 0.0 || first == 1.0) && values().enumerate().all(|(j, v)| v == first + j as f64) {
            let what = format!("column {called} counts the rows ({first}, {}, {}, ...)", first + 1.0, first + 2.0);
            return Some(match dim == 2 && all_whole {
                true => Ok(format!("{what} and was read as a coordinate; `columns` {without} leaves it out")),
                false => Err(format!("{what}; `columns` {without} leaves it out, {with} takes it for a coordinate")),
            });
        }
        let mut steps = values().zip(values().skip(1)).map(|(a, b)| b - a);
        let (mut blocks, mut step) = (1, 0.0);
        let even = steps.all(|s| {
            blocks += usize::from(s != 0.0);
            step = if step == 0.0 { s } else { step };
            s == 0.0 || s == step
        });
        if even
            && step > 0.0
            && blocks > 1
            && FEWEST * blocks <= set.len()
            && !all_whole
            && (axis == 0 || axis + 1 == dim)
        {
            let what = format!("column {called} has {blocks} whole numbers, each in a block, as frames have");
            let choose = format!("`realization_column` {called} makes each a realization");
            return Some(match axis == 0 && dim == 3 {
                true => Err(format!(
                    "{what}; {choose}, `columns` {without} leaves it out, {with} takes it for a coordinate"
                )),
                false => {
                    Ok(format!("{what}, and was read as a coordinate; {choose}, `columns` {without} leaves it out"))
                }
            });
        }
        if dim < 3 || others.iter().any(|&other| whole(other)) {
            continue;
        }
        // Whole numbers beside two fractions.
        let mut steps = values().zip(values().skip(1)).map(|(a, b)| b - a);
        let step = values().nth(1).map_or(0.0, |second| second - first);
        if step != 0.0 && steps.all(|s| s == step) {
            let last = first + 2.0 * step;
            return Some(Ok(format!(
                "column {called} counts by {step} ({first}, {}, {last}, ...) and was read as a coordinate; `columns` {without} leaves it out",
                first + step
            )));
        }
        let most = set.len() / FEWEST;
        let mut distinct = HashSet::new();
        if values().all(|value| {
            distinct.insert(value.to_bits());
            distinct.len() <= most
        }) && (2..=most).contains(&distinct.len())
        {
            let many = distinct.len();
            return Some(Ok(format!(
                "column {called} has {many} values, all whole, beside fractions, as classes and frames have, and was read as a coordinate; `columns` {without} leaves it out, and `class_column` {called} or `realization_column` {called} says what it is"
            )));
        }
    }
    None
}

/// The type of the numbers in a binary file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Element {
    F16,
    F32,
    F64,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
}

impl Element {
    /// As messages name it.
    fn name(self) -> &'static str {
        match self {
            Self::F16 => "float16",
            Self::F32 => "float32",
            Self::F64 => "float64",
            Self::I8 => "int8",
            Self::I16 => "int16",
            Self::I32 => "int32",
            Self::I64 => "int64",
            Self::U8 => "uint8",
            Self::U16 => "uint16",
            Self::U32 => "uint32",
            Self::U64 => "uint64",
        }
    }

    /// Binary digits of a number, where they are fewer than those of f64.
    fn digits(self) -> Option<u32> {
        match self {
            Self::F16 => Some(11),
            Self::F32 => Some(24),
            _ => None,
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::F16 | Self::I16 | Self::U16 => 2,
            Self::F32 | Self::I32 | Self::U32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }

    /// Every number of `bytes`, as f64: exact but for integers beyond 2^53, which are rounded to nearest.
    fn decode(self, bytes: &[u8], big_endian: bool) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.decode_onto(&mut numbers, bytes, big_endian);
        numbers
    }

    /// Appends the same to `into`.
    fn decode_onto(self, into: &mut Vec<f64>, bytes: &[u8], big_endian: bool) {
        macro_rules! numbers {
            ($type:ty, $to_f64:expr) => {{
                let (chunks, _) = bytes.as_chunks::<{ size_of::<$type>() }>();
                let from = if big_endian { <$type>::from_be_bytes } else { <$type>::from_le_bytes };
                into.extend(chunks.iter().map(|&chunk| $to_f64(from(chunk))));
            }};
        }
        match self {
            Self::F16 => numbers!(half::f16, half::f16::to_f64),
            Self::F32 => numbers!(f32, f64::from),
            Self::F64 => numbers!(f64, f64::from),
            Self::I8 => numbers!(i8, f64::from),
            Self::I16 => numbers!(i16, f64::from),
            Self::I32 => numbers!(i32, f64::from),
            Self::I64 => numbers!(i64, |x| x as f64),
            Self::U8 => numbers!(u8, f64::from),
            Self::U16 => numbers!(u16, f64::from),
            Self::U32 => numbers!(u32, f64::from),
            Self::U64 => numbers!(u64, |x| x as f64),
        }
    }
}

/// Checks that `data` holds exactly `count` numbers, without trusting `count`: a header may claim anything.
fn check_length(name: &str, what: &str, count: Option<u64>, element: Element, data: &[u8]) -> Result<()> {
    let found = data.len() as u64;
    let Some(expected) = count.and_then(|n| n.checked_mul(element.bytes() as u64)) else {
        return Err(Error::input(name, format!("{what} is more than any file can hold")));
    };
    if found < expected {
        let reason = format!("truncated: {what} needs {expected} bytes of data, found {found}");
        return Err(Error::input(name, reason));
    }
    if found > expected {
        let reason = format!("{what} needs {expected} bytes of data, found {} more after them", found - expected);
        return Err(Error::input(name, reason));
    }
    Ok(())
}

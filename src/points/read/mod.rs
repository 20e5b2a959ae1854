//! Readers, one per format. What a file holds is decided by its content first and by its name only where the content
//! says nothing:
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
mod xyz;

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::error::{Error, Result, plural};
use crate::input;
use crate::points::RawPoints;
use crate::setting::Setting;

use columns::Marks;
pub use columns::{Column, Columns, MarkedPoints, Rows, Separator, TypedColumns};
pub(crate) use npy::array_of_bytes;
pub use polygon::{polygon_of_bytes, read_polygon};
pub use raw::{RawElement, RawLayout};
pub use reading::{Apart, Input, LeftOut, Reading};
pub use stated::StatedBox;
pub(crate) use text::{has_decimal_comma, is_decimal_comma};

/// What the command line says about its input files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// The number of coordinates per point, if a flag fixed it.
    pub dim: Option<usize>,
    /// `--raw`: the files hold nothing but numbers, in this layout.
    pub raw: Option<RawLayout>,
}

/// File names that a directory may hold besides those without an extension.
const KNOWN_EXTENSIONS: [&str; 21] = [
    "csv",
    "tsv",
    "txt",
    "dat",
    "xy",
    "xyz",
    "npy",
    "npz",
    "rps",
    "bin",
    "f32",
    "f64",
    "ply",
    "extxyz",
    "lammpstrj",
    "dump",
    "vtk",
    "geojson",
    "parquet",
    "arrow",
    "feather",
];

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

/// Where realizations lie: a file that is read at once, or one of whose rows some can be read.
#[derive(Debug)]
pub(crate) enum PointFile {
    Whole(PathBuf),
    Rows(npy::Rows),
}

/// Bytes of a piece of a large file.
const PIECE: u64 = 64 << 20;

impl PointFile {
    pub(crate) fn open(path: PathBuf, options: &ReadOptions, columns: &Columns) -> Self {
        let in_rows = options.raw.is_none() && columns.realization.is_none() && lasts(&path);
        let rows = in_rows.then(|| npy::Rows::open(&path, columns)).flatten();
        rows.map_or(Self::Whole(path), Self::Rows)
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::Whole(path) => path,
            Self::Rows(rows) => rows.path(),
        }
    }

    /// Whether it can be read again.
    pub(crate) fn lasts(&self) -> bool {
        !matches!(self, Self::Whole(path) if !lasts(path))
    }

    /// The ranges of realizations that fit into memory; of a file that is read at once, one.
    fn ranges(&self) -> impl Iterator<Item = std::ops::Range<u64>> + use<> {
        let (all, at_once) = match self {
            Self::Whole(_) => (1, 1),
            Self::Rows(rows) => (rows.realizations(), (PIECE / (8 * rows.numbers()).max(1)).max(1)),
        };
        (0..all.div_ceil(at_once)).map(move |k| k * at_once..((k + 1) * at_once).min(all))
    }

    /// The realizations of a range, counted within the file; all of them where it is read at once.
    pub(crate) fn read(
        &self,
        range: std::ops::Range<u64>,
        options: &ReadOptions,
        columns: &Columns,
    ) -> Result<Vec<MarkedPoints>> {
        match self {
            Self::Whole(path) => read_file(path, options, columns),
            Self::Rows(rows) => rows.read(range, columns),
        }
    }
}

/// What is found while files are read.
pub(crate) enum Found<'a> {
    /// All realizations of a file that may be left out, before the first is handed over: whether they can be used.
    Asked(&'a [MarkedPoints]),
    /// Realizations, and their file with the last of them.
    Piece(Option<PointFile>, Vec<MarkedPoints>),
    /// A file that is left out.
    Broken(Broken),
}

/// A file that cannot be used.
pub(crate) struct Broken {
    pub(crate) file: PathBuf,
    pub(crate) error: Error,
    /// Points like its own, without any, where it is another number of coordinates that is wrong.
    pub(crate) like: Option<RawPoints>,
}

/// What is done about files that cannot be used.
pub(crate) enum OnBroken {
    /// The first is an error.
    Stop,
    /// They are left out; points are like these, or like the first that are there.
    LeaveOut { like: Option<RawPoints> },
}

/// Whether it is the content of a file that is wrong, or the file itself.
fn is_of_a_file(error: &Error) -> bool {
    matches!(error, Error::Input { .. } | Error::File { .. })
}

/// Hands every realization of every file to `each`, in order and in pieces that fit into memory.
pub(crate) fn each_piece(
    inputs: &[PathBuf],
    options: &ReadOptions,
    columns: &Columns,
    on_broken: OnBroken,
    mut each: impl FnMut(Found<'_>) -> Result<()>,
) -> Result<()> {
    let form = "expected files, a directory, a pattern such as 'set_*.npy', or - for standard input";
    if inputs.is_empty() {
        return Err(Error::setting(Setting::Files, "(none)", form));
    }
    if inputs.iter().filter(|p| is_stdin(p)).count() > 1 {
        return Err(Error::setting(Setting::Files, "- -", "standard input can be read only once"));
    }
    let (keep_going, mut first) = match on_broken {
        OnBroken::Stop => (false, None),
        OnBroken::LeaveOut { like } => (true, like),
    };
    let mut known = HashMap::new();
    for input in inputs {
        let listed = match expand(input, options) {
            Err(error) if keep_going && is_of_a_file(&error) => vec![(input.clone(), Err(error))],
            listed => listed?,
        };
        if !keep_going && let Some(at) = listed.iter().position(|(_, whether)| whether.is_err()) {
            return listed.into_iter().nth(at).map_or(Ok(()), |(_, whether)| whether);
        }
        for (path, whether) in listed {
            if let Err(error) = whether {
                each(Found::Broken(Broken { file: path, error, like: None }))?;
                continue;
            }
            if let Ok(place) = fs::canonicalize(&path)
                && let Some(before) = known.insert(place, path.clone())
            {
                let as_what = if before == path { String::new() } else { format!(" (before as {})", before.display()) };
                let reason = format!("is given twice{as_what}: its realizations would count twice; give it once");
                return Err(Error::input(path.display().to_string(), reason));
            }
            let file = PointFile::open(path.clone(), options, columns);
            let mut ready = None;
            if keep_going {
                match usable(&file, options, columns, first.as_ref(), &mut each) {
                    Ok(Usable::Yes(piece)) => ready = piece,
                    Ok(Usable::No(error, like)) => {
                        each(Found::Broken(Broken { file: path, error, like }))?;
                        continue;
                    }
                    Err(error) => return Err(error),
                }
            }
            let mut ranges = file.ranges().peekable();
            let mut file = Some(file);
            while let Some(range) = ranges.next() {
                let piece = match (ready.take(), &file) {
                    (Some(piece), _) => piece,
                    (None, Some(file)) => file.read(range, options, columns)?,
                    (None, None) => break,
                };
                for set in &piece {
                    check_dim(&set.points, first.as_ref(), options)?;
                    first.get_or_insert_with(|| without_points(&set.points));
                }
                // Handed over with the last piece: until then it is read from here.
                let done = if ranges.peek().is_none() { file.take() } else { None };
                each(Found::Piece(done, piece))?;
            }
        }
    }
    Ok(())
}

fn without_points(set: &RawPoints) -> RawPoints {
    RawPoints { dim: set.dim, coordinates: Vec::new(), source: set.source.clone(), lines: Vec::new() }
}

/// Whether all of a file can be used.
enum Usable {
    /// It can; what was read, if it is read at once.
    Yes(Option<Vec<MarkedPoints>>),
    /// Why not, and points like its own if it is their coordinates.
    No(Error, Option<RawPoints>),
}

fn usable(
    file: &PointFile,
    options: &ReadOptions,
    columns: &Columns,
    first: Option<&RawPoints>,
    each: &mut impl FnMut(Found<'_>) -> Result<()>,
) -> Result<Usable> {
    let no = |error, like| if is_of_a_file(&error) { Ok(Usable::No(error, like)) } else { Err(error) };
    let mut last = None;
    for range in file.ranges() {
        let piece = match file.read(range, options, columns) {
            Ok(piece) => piece,
            Err(error) => return no(error, None),
        };
        for set in &piece {
            if let Err(error) = check_dim(&set.points, first, options) {
                return no(error, Some(without_points(&set.points)));
            }
        }
        if let Err(error) = each(Found::Asked(&piece)) {
            return no(error, None);
        }
        last = Some(piece);
    }
    Ok(Usable::Yes(last.filter(|_| matches!(file, PointFile::Whole(_)))))
}

fn check_dim(set: &RawPoints, first: Option<&RawPoints>, options: &ReadOptions) -> Result<()> {
    if let Some(dim) = options.dim.filter(|&dim| dim != set.dim) {
        let axes = plural(dim as u64, "axis");
        let choose = if set.dim > dim { "; `columns` chooses fewer, as in " } else { "" };
        let fewer = if set.dim > dim { ["1", "1,2"][dim.clamp(1, 2) - 1] } else { "" };
        let reason = format!("{} per point, but `sides` or `window` has {axes}{choose}{fewer}", coordinates(set.dim));
        return Err(Error::input(&set.source, reason));
    }
    match first {
        Some(first) if first.dim != set.dim => {
            let reason = format!("{} per point, but {} has {}", coordinates(set.dim), first.source, first.dim);
            Err(Error::input(&set.source, reason))
        }
        _ => Ok(()),
    }
}

fn coordinates(dim: usize) -> String {
    plural(dim as u64, "coordinate")
}

pub(crate) fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Whether what is there can be read again: no pipe.
pub(crate) fn lasts(path: &Path) -> bool {
    !is_stdin(path) && !input::is_stream(path)
}

/// The files that inputs stand for, as far as they can be found.
pub(crate) fn paths(inputs: &[PathBuf]) -> Vec<PathBuf> {
    let listed = inputs.iter().filter_map(|input| expand(input, &ReadOptions::default()).ok());
    listed.flatten().map(|(path, _)| path).filter(|path| !is_stdin(path)).collect()
}

/// What is said of folders within directories that are given: they are not read.
pub(crate) fn folders_left_out(inputs: &[PathBuf]) -> Vec<String> {
    let said = |dir: &PathBuf| {
        let count = folders(dir);
        (count > 0).then(|| {
            let (many, were) = (plural(count, "folder"), if count == 1 { "was" } else { "were" });
            format!("{}: {many} within it {were} not read; give them as well, or '{0}/*/*'", dir.display())
        })
    };
    inputs.iter().filter_map(said).collect()
}

/// How many folders a directory holds, but for hidden ones.
fn folders(dir: &Path) -> u64 {
    let within = |entry: &fs::DirEntry| entry.path().is_dir() && !is_hidden(&entry.path());
    fs::read_dir(dir).map_or(0, |entries| entries.flatten().filter(within).count() as u64)
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

/// A file, or what is wrong with its name.
type Listed = (PathBuf, Result<()>);

/// The files that one input stands for.
fn expand(input: &Path, options: &ReadOptions) -> Result<Vec<Listed>> {
    let itself = || Ok(vec![(input.to_owned(), Ok(()))]);
    if is_stdin(input) {
        return itself();
    }
    match fs::metadata(input) {
        Ok(data) if data.is_dir() => directory(input, options),
        Ok(_) => itself(),
        // The shell expands patterns, but not when quoted, and not on Windows.
        Err(error) => match input.to_str().filter(|text| text.contains(['*', '?', '['])) {
            Some(pattern) => matches(input, pattern),
            None => Err(Error::file(input, error)),
        },
    }
}

fn matches(input: &Path, pattern: &str) -> Result<Vec<Listed>> {
    let place = input.display().to_string();
    let options = glob::MatchOptions { require_literal_leading_dot: true, ..Default::default() };
    let found = glob::glob_with(pattern, options).map_err(|e| Error::input(&place, format!("not a pattern: {e}")))?;
    let mut paths = Vec::new();
    for path in found {
        let path = path.map_err(|e| Error::file(e.path().to_owned(), e.into()))?;
        if path.is_file() {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(Error::input(place, "no file matches this pattern"));
    }
    sort_naturally(&mut paths);
    Ok(paths.into_iter().map(|path| (path, Ok(()))).collect())
}

fn directory(dir: &Path, options: &ReadOptions) -> Result<Vec<Listed>> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(dir).map_err(|e| Error::file(dir, e))? {
        let path = entry.map_err(|e| Error::file(dir, e))?.path();
        if is_hidden(&path) || path.is_dir() {
            continue;
        }
        paths.push(path);
    }
    if paths.is_empty() {
        let reason = match folders(dir) {
            0 => "no files in this directory".to_string(),
            n => format!(
                "no files in this directory, only {}; give those, or '{}/*/*'",
                plural(n, "folder"),
                dir.display()
            ),
        };
        return Err(Error::input(dir.display().to_string(), reason));
    }
    sort_naturally(&mut paths);
    let listed = |path: PathBuf| {
        let extension = extension(&path);
        let whether = if input::is_stream(&path) {
            let reason =
                "is a pipe or a device, which is not read as one of a directory; expected files, or it by itself";
            Err(Error::input(path.display().to_string(), reason))
        } else if options.raw.is_none() && !extension.is_empty() && !KNOWN_EXTENSIONS.contains(&extension.as_str()) {
            let known = KNOWN_EXTENSIONS.join(", .");
            let reason =
                format!("not a kind of file that holds points; expected .{known}, or name the files one by one");
            Err(Error::input(path.display().to_string(), reason))
        } else {
            Ok(())
        };
        (path, whether)
    };
    Ok(paths.into_iter().map(listed).collect())
}

pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn sort_naturally(paths: &mut [PathBuf]) {
    paths.sort_by_cached_key(|path| natural_key(&path.to_string_lossy()));
}

/// A key that orders `set_2` before `set_10`: runs of digits compare as numbers, however long they are, and the text
/// itself decides between `set_1` and `set_01`.
fn natural_key(name: &str) -> (Vec<(String, usize, String)>, String) {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, tail) = rest.split_at(digits);
        let end = tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len());
        let (number, tail) = tail.split_at(end);
        let number = number.trim_start_matches('0');
        parts.push((text.to_owned(), number.len(), number.to_owned()));
        rest = tail;
    }
    (parts, name.to_owned())
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

//! The walk over files: what inputs stand for, piece by piece, and what is done about files that cannot be used.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::columns::{Columns, MarkedPoints};
use super::{ReadOptions, npy, read_file};
use crate::error::{Error, Result, plural};
use crate::input;
use crate::points::RawPoints;
use crate::setting::Setting;

/// File names that a directory may hold besides those without an extension.
pub(super) const KNOWN_EXTENSIONS: [&str; 21] = [
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
pub(super) fn natural_key(name: &str) -> (Vec<(String, usize, String)>, String) {
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

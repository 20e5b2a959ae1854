//! Writers, one per format, chosen by the file name. A file appears whole or not at all.

#[cfg(feature = "tables")]
mod columnar;
mod npy;
mod npz;
mod ply;
mod raw;
mod text;
mod utk;
mod xyz;

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use crate::error::{Error, Result};
use crate::points::RawPoints;
use crate::setting::Setting;
use crate::stage;

pub(super) use utk::SETS_DIFFER as UTK_SETS_DIFFER;

type Output<'a> = BufWriter<&'a mut File>;

/// One format being written: told each realization in turn, then that it was the last.
trait Format {
    /// Adds realization `k`. An `Err(Ok(reason))` says what the format cannot hold.
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal>;
    /// Completes the file.
    fn finish(&mut self) -> io::Result<()>;
}

/// Why a realization was not written.
enum Refusal {
    /// The format cannot hold it.
    Format(String),
    /// The disk would not take it.
    Disk(io::Error),
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::Disk(error)
    }
}

/// Writes `realizations` to `path` in the format of its extension: `.csv`, `.txt`, `.npy`, `.npz`, `.ply`, `.xyz`, `.rps`, `.bin`
/// (UTK), `.f32` or `.f64`; with the feature `tables` also `.parquet`, `.arrow` or `.feather`. All but `.rps` and `.f32` keep every bit. An existing file is replaced only with `force`.
///
/// # Errors
/// An ending of no known format, a file that is there already, what the file system says.
pub fn write(path: &Path, realizations: &mut dyn Iterator<Item = Result<RawPoints>>, force: bool) -> Result<()> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    if path.is_dir() {
        return Err(Error::setting(Setting::Out, path.display(), "is a directory; expected a file name"));
    }
    if crate::input::is_stream(path) {
        return Err(Error::setting(Setting::Out, path.display(), "is a pipe or a device; expected a file name"));
    }
    if !force && path.exists() {
        return Err(exists(path));
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    stage::sweep(folder, |_| false);
    let mut file = stage::file_within(folder).map_err(|e| Error::file(path, e))?;

    let output = BufWriter::with_capacity(1 << 20, file.as_file_mut());
    let mut format: Box<dyn Format + '_> = match extension.as_str() {
        "csv" => Box::new(text::Text::new(output, text::Style::Csv)),
        "txt" => Box::new(text::Text::new(output, text::Style::Blanks)),
        "npy" => Box::new(npy::Npy::new(output)),
        "npz" => Box::new(npz::Npz::new(output)),
        "bin" => Box::new(utk::Utk::new(output)),
        #[cfg(feature = "tables")]
        "parquet" => Box::new(columnar::Columnar::new(output, columnar::Kind::Parquet)),
        #[cfg(feature = "tables")]
        "arrow" | "feather" => Box::new(columnar::Columnar::new(output, columnar::Kind::Arrow)),
        #[cfg(not(feature = "tables"))]
        "parquet" | "arrow" | "feather" => {
            let reason = "this pairwave was built without Parquet and Arrow; build it with `--features tables`";
            return Err(Error::setting(Setting::Out, path.display(), reason));
        }
        "ply" => Box::new(ply::Ply(output)),
        "xyz" | "extxyz" => Box::new(xyz::Xyz(output)),
        "rps" => Box::new(raw::Raw::new(output, raw::Kind::Rps)),
        "f32" => Box::new(raw::Raw::new(output, raw::Kind::F32)),
        "f64" => Box::new(raw::Raw::new(output, raw::Kind::F64)),
        _ => {
            let reason =
                "expected a file name that ends in .csv, .txt, .npy, .npz, .ply, .xyz, .rps, .bin, .f32 or .f64";
            return Err(Error::setting(Setting::Out, path.display(), reason));
        }
    };
    let mut dim = None;
    let mut count = 0;
    for set in realizations {
        let set = set?;
        check(&set, *dim.get_or_insert(set.dim))?;
        format.add(count, &set).map_err(|refusal| match refusal {
            Refusal::Format(reason) => Error::setting(Setting::Out, path.display(), reason),
            Refusal::Disk(error) => Error::file(path, error),
        })?;
        count += 1;
    }
    if count == 0 {
        return Err(Error::setting(Setting::Out, path.display(), "there are no realizations to write"));
    }
    format.finish().map_err(|e| Error::file(path, e))?;
    drop(format);
    let persisted = if force { file.persist(path) } else { file.persist_noclobber(path) };
    match persisted {
        Ok(_) => Ok(()),
        Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => Err(exists(path)),
        Err(e) => Err(Error::file(path, e.error)),
    }
}

/// One realization as the text of a `.csv` file, as `write` writes it.
///
/// # Errors
/// What cannot be written.
pub fn csv(set: &RawPoints) -> Result<Vec<u8>> {
    check(set, set.dim)?;
    let mut bytes = Vec::new();
    let mut format = text::Text::new(&mut bytes, text::Style::Csv);
    let written = format.add(0, set).and_then(|()| Ok(format.finish()?));
    match written {
        Ok(()) => Ok(bytes),
        Err(Refusal::Format(reason)) => Err(Error::input(&set.source, reason)),
        Err(Refusal::Disk(error)) => Err(Error::file(&set.source, error)),
    }
}

fn exists(path: &Path) -> Error {
    Error::setting(Setting::Out, path.display(), "exists already; `force` replaces it")
}

/// The names of coordinates: x, y and z, of more x1, x2, ...
fn axis_names(dim: usize) -> Vec<String> {
    match dim {
        1..=3 => ["x", "y", "z"][..dim].iter().map(|name| name.to_string()).collect(),
        _ => (1..=dim).map(|k| format!("x{k}")).collect(),
    }
}

/// As many coordinates as a sampler makes.
const MOST_AXES: usize = 16;

/// What no format should hold, because no reader takes it back.
fn check(set: &RawPoints, dim: usize) -> Result<()> {
    if set.dim != dim || !(1..=MOST_AXES).contains(&dim) || !set.coordinates.len().is_multiple_of(dim) {
        let reason = format!("points of {} coordinates in a file of {dim}-dimensional points", set.dim);
        return Err(Error::input(&set.source, reason));
    }
    match set.coordinates.iter().position(|x| !x.is_finite()) {
        Some(at) => Err(Error::input(set.place(at / dim), format!("{} is not finite", set.coordinates[at]))),
        None => Ok(()),
    }
}

/// The message for a format that needs every realization to have the same number of points.
fn unequal(k: u64, found: usize, expected: u64) -> Refusal {
    Refusal::Format(format!(
        "realization {k} has {found} points, those before it {expected}; .npz, .csv and .txt hold unequal realizations"
    ))
}

/// The message for a format that holds one realization.
fn single() -> Refusal {
    Refusal::Format("this format holds one realization; .npy, .npz, .bin, .csv and .txt hold several".to_owned())
}

/// The f32 nearest to `x`, but below 1 where `x` is: rounding must not carry a point out of [0, 1).
fn narrow(x: f64) -> f32 {
    let nearest = x as f32;
    if x < 1.0 && nearest >= 1.0 { 1.0 - f32::EPSILON / 2.0 } else { nearest }
}

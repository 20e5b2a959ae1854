//! 6. An analysis -> tables, files, pictures and one page. `Analysis` is the only input, but for pictures of integrands.
//!
//! The same `Analysis` gives the same bytes; wall times, which are part of it, appear in `summary.json` and
//! `report.html` only.

mod columns;
mod headline;
mod html;
mod integrand_picture;
mod npy;
mod npz;
mod outputs;
pub mod panel;
mod picture_figure;
mod plot;
mod png;
mod points_picture;
mod result_dir;
mod summary;
mod svg;
mod terminal;

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

pub use crate::statistics::{Array, Column, Table, Values as ArrayValues};
pub(crate) use columns::{Columns, Place};
pub use headline::headline;
pub(crate) use html::{Curve, Curves, Numbers, Page, Values};
pub use integrand_picture::draw_integrands;
pub(crate) use plot::{Additions, Seen, Stored};
pub use plot::{Format, Plot, Plotted};
pub(crate) use png::encode as png;
pub(crate) use result_dir::Files;
pub(crate) use svg::svg;
pub(crate) use terminal::some_columns;
pub use terminal::{numbers, plots};

use rayon::prelude::*;
use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::estimate::Analysis;
use crate::request::Request;
use crate::setting::Setting;
use crate::statistics::{Make, Output};
use outputs::Made;

/// The page, and what marks a result.
pub(crate) const PAGE: &str = "report.html";
const SUMMARY: &str = "summary.json";

/// The raw sums of a result, or of a run that is not over.
pub const SUMS: &str = "partial.sums";

/// The settings that a result was made by, where a command line was.
pub const SETTINGS: &str = "run.toml";

/// How a run was asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Asked {
    /// The line that was typed.
    pub command: String,
    /// The content of a file of settings that does it again.
    pub settings: Option<String>,
}

/// What is written beside the files of an analysis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beside<'a> {
    /// Its raw sums, as bytes.
    pub sums: Option<&'a [u8]>,
    /// The content of a file of settings that does it again.
    pub settings: Option<&'a str>,
    /// Whether all numbers are in one file too, `results.npz`.
    pub npz: bool,
}

/// All numbers of a result in one file.
const NUMBERS: &str = "results.npz";

/// Every name this room may write.
fn names() -> Vec<&'static str> {
    outputs::all()
        .iter()
        .map(|output| output.name)
        .chain(OF_SURVEYS)
        .chain(OF_CONVERGENCE)
        .chain(OF_COMPARISON)
        .chain(OF_BENCHMARK)
        .chain([NUMBERS, SUMS, SETTINGS, PAGE, SUMMARY])
        .collect()
}

/// Whether a file has the name of one that a result has.
pub(crate) fn is_own(path: &Path) -> bool {
    path.file_name().and_then(|name| name.to_str()).is_some_and(|name| names().contains(&name))
}

/// What a survey writes.
const OF_SURVEYS: [&str; 9] = [
    "projections.csv",
    "projections_pcf.csv",
    "projections_radial.csv",
    "projections.svg",
    "prefixes.csv",
    "prefixes_pcf.csv",
    "prefixes_radial.csv",
    "prefixes.svg",
    "prefixes_radial.svg",
];

/// What a run over numbers of points writes.
const OF_CONVERGENCE: [&str; 4] = ["convergence.csv", "slopes.csv", "ranks.csv", "convergence.svg"];

/// What a benchmark writes.
const OF_BENCHMARK: [&str; 9] = [
    "calibration.csv",
    "skipped.csv",
    "bench.csv",
    "efficiency.csv",
    "growth.csv",
    "growth_exponents.csv",
    "bench.svg",
    "efficiency.svg",
    "growth.svg",
];

/// What a comparison of results writes.
const OF_COMPARISON: [&str; 1] = ["comparison.csv"];

/// Writes files of the names that a result may have, as `write` does, and a summary: `own` is what it holds of its kind of run, an object.
///
/// # Errors
/// As `write`.
pub(crate) fn write_files(
    dir: &Path,
    force: bool,
    asked: &Asked,
    warnings: &[String],
    own: Value,
    make: impl FnOnce(&mut Files<'_>),
) -> Result<Vec<PathBuf>> {
    result_dir::write(&names(), dir, force, |files| {
        make(files);
        if let Some(settings) = &asked.settings {
            files.add(SETTINGS, |file| file.write_all(settings.as_bytes()));
        }
        let names: Vec<_> = files.names().into_iter().chain([SUMMARY]).collect();
        let mut summary = json!({
            "schema": summary::SCHEMA,
            "program": env!("CARGO_PKG_NAME"),
            "version": env!("CARGO_PKG_VERSION"),
            "parameters": { "command": asked.command },
            "warnings": warnings,
            "files": names,
        });
        if let (Some(all), Value::Object(own)) = (summary.as_object_mut(), own) {
            all.extend(own);
        }
        files.add(SUMMARY, |file| {
            serde_json::to_writer_pretty(&mut *file, &summary)?;
            file.write_all(b"\n")
        });
    })
}

/// Whether a result could be written to `dir`, asked before the long work. Leaves nothing behind.
///
/// # Errors
/// Why nothing can be written there.
pub fn check_out(dir: &Path, force: bool) -> Result<()> {
    if !force && dir.join(SUMS).is_file() && !dir.join(SUMMARY).exists() {
        let reason = "holds a run that is not over: `resume` goes on with it, `force` starts anew";
        return Err(Error::setting(Setting::Out, dir.display(), reason));
    }
    result_dir::check_out(&names(), dir, force)
}

/// Whether the file that a setting names could be written, asked before the long work.
///
/// # Errors
/// A file that is there already, without `force`; a place where there can be none.
pub fn check_file(setting: Setting, path: &Path, force: bool) -> Result<()> {
    plot::check_file(setting, path, force)
}

/// Whether a file or directory that is to be written is none of those that are read, nor the result that a file is of.
///
/// # Errors
/// The one that would be replaced.
pub fn check_not_read(out: &Path, read: &[PathBuf]) -> Result<()> {
    let Ok(out) = out.canonicalize() else { return Ok(()) };
    let all = read.iter().cloned().chain(crate::points::read::paths(read));
    let of_result = |path: &Path| path.parent() == Some(&out) && is_own(path);
    match all.filter_map(|path| path.canonicalize().ok()).find(|path| *path == out || of_result(path)) {
        Some(path) => {
            Err(Error::setting(Setting::Out, path.display(), "is read, and would be replaced; expected another"))
        }
        None => Ok(()),
    }
}

/// Writes a file whole, and its directory if there is none.
///
/// # Errors
/// What the file system says.
pub fn write_file(path: &Path, bytes: &[u8], force: bool) -> Result<()> {
    plot::write(path, bytes, force)
}

/// Whether a result in `dir` would replace what a request reads, or lie among its points.
///
/// # Errors
/// The file or folder, by its name.
pub fn check_inputs(dir: &Path, request: &Request) -> Result<()> {
    let Ok(out) = dir.canonicalize() else { return Ok(()) };
    let refuse = |reason: String| Err(Error::setting(Setting::Out, dir.display(), reason));
    for folder in request.input.files.iter().filter(|input| input.is_dir()) {
        if folder.canonicalize().is_ok_and(|folder| folder == out) {
            return refuse(
                "is read as points; a result among them would be read as points too; expected another directory".into(),
            );
        }
    }
    let lists = request.edges.iter().chain(&request.frequencies).cloned();
    for path in crate::points::read::paths(&request.input.files).into_iter().chain(lists) {
        let Ok(path) = path.canonicalize() else { continue };
        let name = path.file_name().and_then(|name| name.to_str()).filter(|name| names().contains(name));
        if let Some(name) = name.filter(|_| path.parent() == Some(&out)) {
            return refuse(format!("holds {name}, which is read and would be replaced; expected another directory"));
        }
    }
    Ok(())
}

/// Every output with its content.
fn all_made(analysis: &Analysis) -> Vec<(&'static Output, io::Result<Option<Made<'_>>>)> {
    let of = |output: &&'static Output| (*output, outputs::made(output, analysis));
    outputs::all().par_iter().map(of).collect()
}

/// The names of the files that results of an analysis may have, tables first; beside them `results.npz`, the page and the summary.
pub fn file_names() -> Vec<&'static str> {
    outputs::all().iter().map(|output| output.name).collect()
}

/// What the table `name`, without its ending, holds; none where there is no such table.
pub fn table(name: &str, analysis: &Analysis) -> Option<Table> {
    outputs::all().into_iter().find_map(|output| match output.make {
        Make::Table(make) if output.name.strip_suffix(".csv") == Some(name) => make(analysis),
        _ => None,
    })
}

/// What the array `name`, without its ending, holds; none where there is no such array.
pub fn array<'a>(name: &str, analysis: &'a Analysis) -> Option<Array<'a>> {
    outputs::all().into_iter().find_map(|output| match output.make {
        Make::Array(make) if output.name.strip_suffix(".npy") == Some(name) => make(analysis),
        _ => None,
    })
}

/// The bytes of the file `name`, as `write` writes it; none where there is nothing to be in it.
///
/// # Errors
/// What cannot be drawn.
pub fn file(name: &str, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
    let failed = |e: Box<dyn std::error::Error + Send + Sync>| Error::file(name, io::Error::other(e));
    match name {
        SUMMARY => summary::json(analysis, Vec::new()).map(Some).map_err(|e| failed(e.into())),
        PAGE => {
            let mut pictures = BTreeMap::new();
            for (output, made) in all_made(analysis) {
                let picture = made.map_err(|e| failed(e.into()))?.and_then(|(_, picture)| picture);
                picture.into_iter().for_each(|picture| _ = pictures.insert(output.name, picture));
            }
            html::page(analysis, &pictures).map(|page| Some(page.into_bytes())).map_err(failed)
        }
        name => outputs::bytes(name, analysis),
    }
}

/// Writes everything `analysis` holds into `dir` and returns the paths, `summary.json` last. `dir` is created; a result
/// already there is refused without `force` and replaced with it, files of other names staying as they are. The files
/// appear whole or not at all.
///
/// # Errors
/// As `check_out`; what the file system says. Nothing is left half-written.
pub fn write(dir: &Path, analysis: &Analysis, force: bool) -> Result<Vec<PathBuf>> {
    write_with(dir, analysis, Beside::default(), force)
}

/// The same with something beside it. What files hold is made on the threads of the pool that this is called in.
///
/// # Errors
/// As `write`.
pub fn write_with(dir: &Path, analysis: &Analysis, beside: Beside<'_>, force: bool) -> Result<Vec<PathBuf>> {
    result_dir::write(&names(), dir, force, |files| {
        let mut pictures = BTreeMap::new();
        for (output, made) in all_made(analysis) {
            match made {
                Ok(None) => {}
                Ok(Some((content, picture))) => {
                    files.add(output.name, |file| content.write(file));
                    picture.into_iter().for_each(|picture| _ = pictures.insert(output.name, picture));
                }
                Err(e) => files.add(output.name, |_| Err(e)),
            }
        }
        if beside.npz {
            files.add(NUMBERS, |file| npz::write(analysis, file));
        }
        if let Some(sums) = beside.sums {
            files.add(SUMS, |file| file.write_all(sums));
        }
        if let Some(settings) = beside.settings {
            files.add(SETTINGS, |file| file.write_all(settings.as_bytes()));
        }
        files.add(PAGE, |file| file.write_all(html::page(analysis, &pictures).map_err(io::Error::other)?.as_bytes()));
        let names = files.names().into_iter().chain([SUMMARY]).collect();
        files.add(SUMMARY, |file| file.write_all(&summary::json(analysis, names).map_err(io::Error::other)?));
    })
}

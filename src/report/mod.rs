//! 6. An analysis -> tables, files, pictures and one page. `Analysis` is the only input.
//!
//! The same `Analysis` gives the same bytes; wall times, which are part of it, appear in `summary.json` and
//! `report.html` only.

mod covariance_image;
mod figure;
mod headline;
mod html;
mod npy;
pub mod panel;
mod picture_figure;
mod plots;
mod points_picture;
mod spectrum_image;
mod spectrum_numbers;
mod spectrum_plots;
mod summary;
mod table;
mod vector_image;

pub use headline::headline;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rustfft::num_complex::Complex;

use crate::display::Panel;
use crate::error::{Error, Result};
use crate::estimate::Analysis;

/// Marks a result; last to arrive and first to go, so that where it is, all of its result is.
const SUMMARY: &str = "summary.json";

/// Every name this module may write. With `force`, only these are ever replaced or removed.
const FILES: &[&str] = &[
    "pcf.csv",
    "pcf_angular.csv",
    "pcf_cross.csv",
    "k_function.csv",
    "envelope.csv",
    "spectrum_radial.csv",
    "spectrum_list.csv",
    "spectrum_axes.csv",
    "spectrum_angular.csv",
    "spectrum_from_pcf.csv",
    "pcf_from_spectrum.csv",
    "neighbor_functions.csv",
    "covariance.npy",
    "covariance_se.npy",
    "spectrum.npy",
    "spectrum_se.npy",
    "pcf_vector.npy",
    "pcf_vector_se.npy",
    "pcf_vector_counts.npy",
    "pcf.svg",
    "pcf_cross.svg",
    "k_function.svg",
    "pcf_vector.png",
    "pcf_angular.svg",
    "spectrum_radial.svg",
    "anisotropy.svg",
    "spectrum_axes.svg",
    "spectrum_angular.svg",
    "neighbor_functions.svg",
    "spectrum.png",
    "covariance.png",
    "points.svg",
    "report.html",
    SUMMARY,
];

/// Whether a result could be written to `dir`, asked before the long work. Leaves nothing behind.
pub fn check_out(dir: &Path, force: bool) -> Result<()> {
    let setting = |reason: String| Err(Error::setting("--out", dir.display(), reason));
    if dir.as_os_str().is_empty() {
        return setting("expected a directory".into());
    }
    match fs::metadata(dir) {
        Ok(found) if !found.is_dir() => {
            return setting("is a file; expected a directory, or a path to create one".into());
        }
        Ok(_) => {
            if let Some(name) = FILES.iter().find(|f| dir.join(f).is_dir()) {
                return setting(format!("holds a directory {name}, where a file would go; expected another directory"));
            }
            let ours = |name: &str| !force && dir.join(name).symlink_metadata().is_ok();
            if ours(SUMMARY) {
                return setting("holds a result already; --force replaces it".into());
            }
            // Not a result, perhaps somebody's own file of that name: no reason to lose it.
            if let Some(name) = FILES.iter().find(|f| ours(f)) {
                return setting(format!("holds a file {name} already; --force replaces it"));
            }
        }
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            if dir.symlink_metadata().is_ok() {
                return setting("is a link to nothing; expected a directory, or a path to create one".into());
            }
        }
        Err(e) => return setting(format!("cannot be used: {e}")),
    }
    // The one honest test of permission is to create something where the result will be created.
    let ground = existing_part(dir);
    match tempfile::Builder::new().prefix(".pairwave-").tempdir_in(&ground) {
        Ok(_) => Ok(()),
        Err(e) => {
            // The error itself names the temporary directory, which would only puzzle.
            setting(format!("cannot create files in {}: {}", ground.display(), io::Error::from(e.kind())))
        }
    }
}

/// Writes everything `analysis` holds into `dir` and returns the paths, `summary.json` last. `dir` is created; a result
/// already there is refused without `force` and replaced with it, files of other names staying as they are. The files
/// appear whole or not at all.
pub fn write(dir: &Path, analysis: &Analysis, force: bool) -> Result<Vec<PathBuf>> {
    check_out(dir, force)?;
    let at = |path: &Path| {
        let path = path.to_path_buf();
        move |e| Error::file(path, e)
    };
    // Same file system, so that moving is renaming: beside a new DIR, inside an existing one (which may be a mount
    // point, or the only place where writing is allowed).
    let exists = dir.is_dir();
    let parent = dir.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let ground = if exists { dir } else { parent };
    let created = NewDirectories::create(ground).map_err(at(ground))?;
    let stage = tempfile::Builder::new().prefix(".pairwave-").tempdir_in(ground).map_err(at(dir))?;
    // A directory of its own inside: temporary directories are private, results get the usual permissions.
    let new = stage.path().join("new");
    fs::create_dir(&new).map_err(at(dir))?;

    let mut names = Vec::new();
    for (name, result) in render(analysis, &new) {
        result.map_err(at(&dir.join(name)))?;
        names.push(name);
    }
    if exists {
        let old = stage.path().join("old");
        fs::create_dir(&old).map_err(at(dir))?;
        replace(dir, &new, &old, &names)?;
    } else {
        fs::rename(&new, dir).map_err(at(dir))?;
    }
    created.keep();
    Ok(names.into_iter().map(|name| dir.join(name)).collect())
}

/// Swaps our files in `dir` for the new ones; on failure everything is put back.
fn replace(dir: &Path, new: &Path, old: &Path, names: &[&'static str]) -> Result<()> {
    let mut moved: Vec<(PathBuf, PathBuf)> = Vec::new();
    let away = FILES.iter().rev().filter(|f| dir.join(f).symlink_metadata().is_ok());
    let moves = away.map(|f| (dir.join(f), old.join(f))).chain(names.iter().map(|f| (new.join(f), dir.join(f))));
    // Collected first: what is there must be asked before anything moves.
    for (from, to) in moves.collect::<Vec<_>>() {
        if let Err(e) = fs::rename(&from, &to) {
            for (from, to) in moved.iter().rev() {
                // Nothing better can be done about a second failure than to go on with the rest.
                let _ = fs::rename(to, from);
            }
            return Err(Error::file(if from.starts_with(new) { to } else { from }, e));
        }
        moved.push((from, to));
    }
    Ok(())
}

/// Directories made on the way to DIR, removed again unless kept.
struct NewDirectories(Vec<PathBuf>);

impl NewDirectories {
    fn create(path: &Path) -> io::Result<Self> {
        let mut missing: Vec<PathBuf> = Vec::new();
        for p in path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()) {
            missing.push(p.into());
        }
        let guard = Self(missing);
        fs::create_dir_all(path)?;
        Ok(guard)
    }

    fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for NewDirectories {
    fn drop(&mut self) {
        for path in &self.0 {
            // Only if empty, and only to tidy up: another's files in it are a reason to let it stand.
            let _ = fs::remove_dir(path);
        }
    }
}

/// The nearest ancestor of `dir` (or itself) that exists.
fn existing_part(dir: &Path) -> PathBuf {
    let found = dir.ancestors().find(|p| !p.as_os_str().is_empty() && p.exists());
    found.unwrap_or(Path::new(".")).into()
}

/// Writes every file into `dir`, in the order of `FILES`; stops at the first that fails.
fn render(analysis: &Analysis, dir: &Path) -> Vec<(&'static str, io::Result<()>)> {
    let mut files = Written { dir, done: Vec::new() };
    files.add("pcf.csv", panel::table(Panel::Pcf, analysis).map(|t| t.csv()));
    files.add("pcf_cross.csv", table::cross(analysis).map(|t| t.csv()));
    files.add("k_function.csv", table::k_function(analysis).map(|t| t.csv()));
    files.add("envelope.csv", table::envelope(analysis).map(|t| t.csv()));
    files.add("pcf_angular.csv", table::angular(analysis).map(|t| t.csv()));
    files.add("spectrum_radial.csv", panel::table(Panel::Radial, analysis).map(|t| t.csv()));
    files.add("spectrum_list.csv", panel::table(Panel::Spectrum, analysis).map(|t| t.csv()));
    files.add("spectrum_axes.csv", table::axes(analysis).map(|t| t.csv()));
    files.add("spectrum_angular.csv", table::sectors(analysis).map(|t| t.csv()));
    files.add("spectrum_from_pcf.csv", table::spectrum_from_pcf(analysis).map(|t| t.csv()));
    files.add("pcf_from_spectrum.csv", table::pcf_from_spectrum(analysis).map(|t| t.csv()));
    files.add("neighbor_functions.csv", table::neighbor_functions(analysis).map(|t| t.csv()));
    if let Some(write) = panel::array(Panel::Spectrum, analysis) {
        files.stream("spectrum.npy", |file| write(file));
    }
    let spectrum = analysis.spectrum().filter(|_| analysis.grid_wanted);
    if let Some((spectrum, grid)) = spectrum.and_then(|s| Some((s, s.waves.grid()?))) {
        // With one realization the error of a mode is the mode itself; a file would only repeat it.
        if analysis.shape.realizations >= 2 {
            let lacks_last = analysis.convention.lacks_last_plane();
            files.stream("spectrum_se.npy", |file| npy::grid(grid, &spectrum.p_se, lacks_last, file));
        }
    }
    if let Some(covariance) = analysis.covariance() {
        let (modes, c) = (covariance.modes(), &covariance.c);
        files.stream("covariance.npy", |file| npy::matrix(modes, c.iter().map(|&[re, im]| Complex { re, im }), file));
        if let Some(c_se) = &covariance.c_se {
            files.stream("covariance_se.npy", |file| npy::matrix(modes, c_se.iter().copied(), file));
        }
    }
    if let Some(write) = panel::array(Panel::Vector, analysis) {
        files.stream("pcf_vector.npy", |file| write(file));
    }
    if let Some(vector) = analysis.vector() {
        if analysis.shape.realizations >= 2 {
            files.stream("pcf_vector_se.npy", |file| npy::lags(&vector.grid, &vector.g_se, file));
        }
        files.stream("pcf_vector_counts.npy", |file| npy::lags(&vector.grid, &vector.count, file));
    }
    let mut pictures = html::Pictures {
        pcf: files.picture("pcf.svg", panel::curves(Panel::Pcf, analysis)),
        cross: files.picture("pcf_cross.svg", plots::cross(analysis)),
        k_function: files.picture("k_function.svg", plots::k_function(analysis)),
        pcf_angular: files.picture("pcf_angular.svg", plots::pcf_angular(analysis)),
        spectrum_radial: files.picture("spectrum_radial.svg", panel::curves(Panel::Radial, analysis)),
        anisotropy: files.picture("anisotropy.svg", panel::curves(Panel::Anisotropy, analysis)),
        spectrum_axes: files.picture("spectrum_axes.svg", spectrum_plots::axes(analysis)),
        spectrum_angular: files.picture("spectrum_angular.svg", spectrum_plots::angular(analysis)),
        neighbor_functions: files.picture("neighbor_functions.svg", plots::neighbor_functions(analysis)),
        ..Default::default()
    };
    match panel::spectrum_image(analysis) {
        Ok(Some(image)) => {
            files.add("spectrum.png", Some(Ok(&image.png)));
            pictures.spectrum = Some(image);
        }
        Ok(None) => {}
        Err(e) => files.add("spectrum.png", Some(Err::<&[u8], _>(e))),
    }
    if let Some(covariance) = analysis.covariance() {
        match covariance_image::render(covariance) {
            Ok(image) => {
                files.add("covariance.png", Some(Ok(&image.png)));
                pictures.covariance = Some(image);
            }
            Err(e) => files.add("covariance.png", Some(Err::<&[u8], _>(io::Error::other(e)))),
        }
    }
    match panel::vector_image(analysis) {
        Ok(Some(image)) => {
            files.add("pcf_vector.png", Some(Ok(&image.png)));
            pictures.pcf_vector = Some(image);
        }
        Ok(None) => {}
        Err(e) => files.add("pcf_vector.png", Some(Err::<&[u8], _>(e))),
    }
    pictures.points = files.picture("points.svg", panel::curves(Panel::Points, analysis));
    files.add("report.html", Some(Ok(html::page(analysis, &pictures))));
    let names = files.done.iter().map(|f| f.0).chain([SUMMARY]).collect();
    files.add(SUMMARY, Some(summary::json(analysis, names).map_err(io::Error::other)));
    files.done
}

/// Files written so far. After a failure nothing more is.
struct Written<'a> {
    dir: &'a Path,
    done: Vec<(&'static str, io::Result<()>)>,
}

impl Written<'_> {
    fn failed(&self) -> bool {
        self.done.last().is_some_and(|f| f.1.is_err())
    }

    fn add(&mut self, name: &'static str, content: Option<io::Result<impl AsRef<[u8]>>>) {
        let Some(content) = content else { return };
        if !self.failed() {
            let result = content.and_then(|bytes| fs::write(self.dir.join(name), bytes));
            self.done.push((name, result));
        }
    }

    fn picture<E: Into<Box<dyn std::error::Error + Send + Sync>>>(
        &mut self,
        name: &'static str,
        svg: Option<Result<String, E>>,
    ) -> Option<String> {
        match svg? {
            Ok(svg) => {
                self.add(name, Some(Ok(&svg)));
                Some(svg)
            }
            Err(e) => {
                self.add(name, Some(Err::<&[u8], _>(io::Error::other(e))));
                None
            }
        }
    }

    /// Grids may be GiB: straight to the file.
    fn stream(&mut self, name: &'static str, write: impl FnOnce(&mut io::BufWriter<fs::File>) -> io::Result<()>) {
        if !self.failed() {
            let result = fs::File::create(self.dir.join(name)).and_then(|file| {
                let mut file = io::BufWriter::new(file);
                write(&mut file)?;
                io::Write::flush(&mut file)
            });
            self.done.push((name, result));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A move that fails half way through is undone.
    #[test]
    fn a_failed_replacement_restores_the_old_result() {
        let root = tempfile::tempdir().unwrap();
        let [dir, new, old] = ["dir", "new", "old"].map(|name| root.path().join(name));
        for path in [&dir, &new, &old] {
            fs::create_dir(path).unwrap();
        }
        for (path, text) in [(dir.join("pcf.csv"), "old g"), (dir.join(SUMMARY), "old"), (new.join("pcf.csv"), "new g")]
        {
            fs::write(path, text).unwrap();
        }
        // The new summary was never written.
        assert!(replace(&dir, &new, &old, &["pcf.csv", SUMMARY]).is_err());
        assert_eq!(fs::read_to_string(dir.join("pcf.csv")).unwrap(), "old g");
        assert_eq!(fs::read_to_string(dir.join(SUMMARY)).unwrap(), "old");

        fs::write(new.join(SUMMARY), "new").unwrap();
        replace(&dir, &new, &old, &["pcf.csv", SUMMARY]).unwrap();
        assert_eq!(fs::read_to_string(dir.join("pcf.csv")).unwrap(), "new g");
        assert_eq!(fs::read_to_string(dir.join(SUMMARY)).unwrap(), "new");
    }
}

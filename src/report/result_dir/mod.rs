//! A directory that holds a result, whole or not at all; of what, it does not know.

mod recovery;
mod swap;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::setting::Setting;
use crate::stage::{self, Stage};

/// Whether a result could be written to `dir`, asked before the long work. Leaves nothing behind, and puts in order what a
/// killed run left there. `names` are all that the result may consist of, the last the one that marks it.
pub(super) fn check_out(names: &[&'static str], dir: &Path, force: bool) -> Result<()> {
    [dir, parent(dir)].into_iter().for_each(|ground| stage::sweep(ground, |left| recovery::done(left, names)));
    check_names(names, dir, force)?;
    // The one honest test of permission is to create something where the result will be created.
    let ground = existing_part(dir);
    match Stage::within(&ground) {
        Ok(_) => Ok(()),
        Err(e) => {
            // The error itself names the temporary directory, which would only puzzle.
            let reason = format!("cannot create files in {}: {}", ground.display(), io::Error::from(e.kind()));
            Err(Error::setting(Setting::Out, dir.display(), reason))
        }
    }
}

/// Whether `dir` is free for a result, or may be replaced.
fn check_names(names: &[&'static str], dir: &Path, force: bool) -> Result<()> {
    let setting = |reason: String| Err(Error::setting(Setting::Out, dir.display(), reason));
    if dir.as_os_str().is_empty() {
        return setting("expected a directory".into());
    }
    match fs::metadata(dir) {
        Ok(found) if !found.is_dir() => {
            return setting("is a file; expected a directory, or a path to create one".into());
        }
        Ok(_) => {
            if let Some(name) = names.iter().find(|f| dir.join(f).is_dir()) {
                return setting(format!("holds a directory {name}, where a file would go; expected another directory"));
            }
            let ours = |name: &str| !force && dir.join(name).symlink_metadata().is_ok();
            if names.last().is_some_and(|mark| ours(mark)) {
                return setting("holds a result already; `force` replaces it".into());
            }
            // Not a result, perhaps somebody's own file of that name: no reason to lose it.
            if let Some(name) = names.iter().find(|f| ours(f)) {
                return setting(format!("holds a file {name} already; `force` replaces it"));
            }
        }
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            if dir.symlink_metadata().is_ok() {
                return setting("is a link to nothing; expected a directory, or a path to create one".into());
            }
        }
        Err(e) => return setting(format!("cannot be used: {e}")),
    }
    Ok(())
}

/// Writes a result into `dir` and returns its paths. `dir` is created; a result already there is refused without `force` and
/// replaced with it: of files that are there only those in `names` are ever replaced or removed. Whatever happens to this
/// process, there is the old result or the new one; where a directory cannot be swapped (`swap`), the next run sees to that.
/// Of two that write into one directory, one after the other is done, and the second finds what the first wrote.
pub(super) fn write(
    names: &[&'static str],
    dir: &Path,
    force: bool,
    make: impl FnOnce(&mut Files<'_>),
) -> Result<Vec<PathBuf>> {
    // What has come there since `check_out` is no mistake of whoever asked.
    let free = || match check_names(names, dir, force) {
        Err(Error::Setting { reason, .. }) => Err(Error::input(dir.display().to_string(), reason)),
        other => other,
    };
    free()?;
    let at = |path: &Path| {
        let path = path.to_path_buf();
        move |e| Error::file(path, e)
    };
    // What a link leads to is replaced, not the link.
    let place = fs::canonicalize(dir).unwrap_or_else(|_| dir.to_path_buf());
    let ground = parent(&place);
    let created = NewDirectories::create(ground).map_err(at(ground))?;
    // On the same file system, so that moving is renaming.
    let stage = match swap::possible(&place) {
        true => Stage::within(ground).or_else(|e| if place.is_dir() { Stage::within(&place) } else { Err(e) }),
        false => Stage::within(&place),
    };
    let stage = stage.map_err(at(dir))?;
    // A directory of its own inside: temporary directories are private, results get the usual permissions.
    let new = stage.path().join("new");
    fs::create_dir(&new).map_err(at(dir))?;

    let mut files = Files { dir: &new, done: Vec::new() };
    make(&mut files);
    let mut written = Vec::new();
    for (name, result) in files.done {
        result.map_err(at(&dir.join(name)))?;
        written.push(name);
    }
    let turn = stage::turn(ground);
    free()?;
    if !place.is_dir() {
        fs::rename(&new, &place).map_err(at(dir))?;
    } else if stage.path().parent() == Some(&place) || swap::swap(names, &place, stage.path()).is_err() {
        recovery::replace(names, &place, stage.path(), &written).map_err(at(dir))?;
    }
    // The result is there; a note that stays is read by the next run.
    let _ = recovery::settle(stage.path());
    drop(turn);
    created.keep();
    Ok(written.into_iter().map(|name| dir.join(name)).collect())
}

/// The directory that holds `dir`.
fn parent(dir: &Path) -> &Path {
    dir.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Files written so far. After a failure nothing more is.
pub(crate) struct Files<'a> {
    dir: &'a Path,
    done: Vec<(&'static str, io::Result<()>)>,
}

impl Files<'_> {
    /// Writes a file, straight to the disk: it may be GiB.
    pub(crate) fn add(&mut self, name: &'static str, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if self.done.last().is_none_or(|last| last.1.is_ok()) {
            let result = fs::File::create(self.dir.join(name)).and_then(|file| {
                let mut file = io::BufWriter::with_capacity(1 << 18, file);
                write(&mut file)?;
                file.flush()
            });
            self.done.push((name, result));
        }
    }

    /// The names of all that are there.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        self.done.iter().map(|file| file.0).collect()
    }
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

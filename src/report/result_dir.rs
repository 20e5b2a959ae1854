//! A directory that holds a result, whole or not at all; of what, it does not know.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::setting::Setting;

/// Whether a result could be written to `dir`, asked before the long work. Leaves nothing behind.
/// `names` are all that the result may consist of, the last the one that marks it.
pub(super) fn check_out(names: &[&'static str], dir: &Path, force: bool) -> Result<()> {
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

/// Writes a result into `dir` and returns its paths. `dir` is created; a result already there is refused without `force` and
/// replaced with it: of files that are there only those in `names` are ever replaced or removed. The files appear whole or not
/// at all. Of `names`, those that there is something to write for are written in this order, so that the last to arrive and the first
/// to go is the one that marks the result: where it is, all of the result is.
pub(super) fn write(
    names: &[&'static str],
    dir: &Path,
    force: bool,
    make: impl FnOnce(&mut Files<'_>),
) -> Result<Vec<PathBuf>> {
    check_out(names, dir, force)?;
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

    let mut files = Files { dir: &new, done: Vec::new() };
    make(&mut files);
    let mut written = Vec::new();
    for (name, result) in files.done {
        result.map_err(at(&dir.join(name)))?;
        written.push(name);
    }
    if exists {
        let old = stage.path().join("old");
        fs::create_dir(&old).map_err(at(dir))?;
        replace(names, dir, &new, &old, &written)?;
    } else {
        fs::rename(&new, dir).map_err(at(dir))?;
    }
    created.keep();
    Ok(written.into_iter().map(|name| dir.join(name)).collect())
}

/// Files written so far. After a failure nothing more is.
pub(super) struct Files<'a> {
    dir: &'a Path,
    done: Vec<(&'static str, io::Result<()>)>,
}

impl Files<'_> {
    /// Writes a file, straight to the disk: it may be GiB.
    pub(super) fn add(&mut self, name: &'static str, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if self.done.last().is_none_or(|last| last.1.is_ok()) {
            let result = fs::File::create(self.dir.join(name)).and_then(|file| {
                let mut file = io::BufWriter::new(file);
                write(&mut file)?;
                file.flush()
            });
            self.done.push((name, result));
        }
    }

    /// The names of all that are there.
    pub(super) fn names(&self) -> Vec<&'static str> {
        self.done.iter().map(|file| file.0).collect()
    }
}

/// Swaps our files in `dir`, of all that there may be, for the new ones; on failure everything is put back.
fn replace(all: &[&'static str], dir: &Path, new: &Path, old: &Path, names: &[&'static str]) -> Result<()> {
    let mut moved: Vec<(PathBuf, PathBuf)> = Vec::new();
    let away = all.iter().rev().filter(|f| dir.join(f).symlink_metadata().is_ok());
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

#[cfg(test)]
mod tests {
    use super::*;

    const MARK: &str = "summary.json";

    /// A move that fails half way through is undone.
    #[test]
    fn a_failed_replacement_restores_the_old_result() {
        let root = tempfile::tempdir().unwrap();
        let [dir, new, old] = ["dir", "new", "old"].map(|name| root.path().join(name));
        for path in [&dir, &new, &old] {
            fs::create_dir(path).unwrap();
        }
        for (path, text) in [(dir.join("pcf.csv"), "old g"), (dir.join(MARK), "old"), (new.join("pcf.csv"), "new g")] {
            fs::write(path, text).unwrap();
        }
        // The new summary was never written.
        assert!(replace(&["pcf.csv", MARK], &dir, &new, &old, &["pcf.csv", MARK]).is_err());
        assert_eq!(fs::read_to_string(dir.join("pcf.csv")).unwrap(), "old g");
        assert_eq!(fs::read_to_string(dir.join(MARK)).unwrap(), "old");

        fs::write(new.join(MARK), "new").unwrap();
        replace(&["pcf.csv", MARK], &dir, &new, &old, &["pcf.csv", MARK]).unwrap();
        assert_eq!(fs::read_to_string(dir.join("pcf.csv")).unwrap(), "new g");
        assert_eq!(fs::read_to_string(dir.join(MARK)).unwrap(), "new");
    }
}

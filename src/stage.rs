//! What is being written, beside its place and under a name of its own, until it is whole. A stage is locked for as long as its
//! writer lives, so that the next writer can tell what a killed one left behind.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempDir};

const PREFIX: &str = ".pairwave-";

/// A directory to write in.
#[derive(Debug)]
pub(crate) struct Stage {
    dir: TempDir,
    /// Where a directory can be locked.
    _lock: Option<File>,
}

impl Stage {
    /// In `ground`.
    pub(crate) fn within(ground: &Path) -> io::Result<Self> {
        loop {
            let dir = tempfile::Builder::new().prefix(PREFIX).tempdir_in(ground)?;
            let lock = File::open(dir.path()).and_then(|file| file.lock().map(|()| file)).ok();
            // Before it was locked another writer may have swept it away.
            if dir.path().is_dir() {
                return Ok(Self { dir, _lock: lock });
            }
        }
    }

    pub(crate) fn path(&self) -> &Path {
        self.dir.path()
    }
}

/// A file to write to, with the usual permissions, in `ground`.
pub(crate) fn file_within(ground: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX);
    // A temporary file is private by default; this one becomes an ordinary file under the user's umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let file = builder.tempfile_in(ground)?;
        let _ = file.as_file().lock();
        if file.path().exists() {
            return Ok(file);
        }
    }
}

/// What killed writers left in `ground`: files are removed, directories handed to `done`, which says whether they may go. Those
/// that cannot be locked are still in use, or on a file system where nobody can tell.
pub(crate) fn sweep(ground: &Path, done: impl Fn(&Path) -> bool) {
    let Ok(entries) = fs::read_dir(ground) else { return };
    let ours = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX));
    for path in entries.flatten().map(|entry| entry.path()).filter(ours) {
        let Ok(file) = File::open(&path) else { continue };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock | TryLockError::Error(_)) => continue,
        }
        // What cannot be removed stays; the next writer tries again.
        let _ = match path.is_dir() {
            true if done(&path) => fs::remove_dir_all(&path),
            true => Ok(()),
            false => fs::remove_file(&path),
        };
    }
}

/// One writer at a time puts things into `ground`, until this is dropped; where it cannot be locked, all of them.
pub(crate) fn turn(ground: &Path) -> Option<File> {
    File::open(ground).and_then(|file| file.lock().map(|()| file)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_nobody_holds_is_swept() {
        let root = tempfile::tempdir().unwrap();
        let stage = Stage::within(root.path()).unwrap();
        let file = file_within(root.path()).unwrap();
        for name in ["left", "kept", "other"] {
            let prefix = if name == "other" { "" } else { PREFIX };
            fs::create_dir(root.path().join(format!("{prefix}{name}"))).unwrap();
        }
        fs::write(root.path().join(format!("{PREFIX}file")), "half").unwrap();
        sweep(root.path(), |path| path.ends_with(format!("{PREFIX}left")));
        let mut left: Vec<_> = fs::read_dir(root.path()).unwrap().map(|e| e.unwrap().path()).collect();
        let mut expected = vec![stage.path().to_path_buf(), file.path().to_path_buf()];
        expected.extend([root.path().join(format!("{PREFIX}kept")), root.path().join("other")]);
        left.sort();
        expected.sort();
        assert_eq!(left, expected);
    }
}

//! A directory replaced by another in one step of the file system.

use std::fs;
use std::io;
use std::path::Path;

/// Whether `dir` could be swapped with a directory beside it, or is not there yet. Not if something is mounted there, nor if
/// it is where this process (and so the user's shell) works, which would stay behind in the old one.
pub(super) fn possible(dir: &Path) -> bool {
    let Ok(found) = fs::metadata(dir) else { return true };
    if std::env::current_dir().and_then(fs::canonicalize).is_ok_and(|here| here.starts_with(dir)) {
        return false;
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let Some(Ok(above)) = dir.parent().map(fs::metadata) else { return false };
        // Another owner or group could not be given to the new one.
        let ours = |above: &fs::Metadata| {
            let mode = found.mode() & 0o2000 == 0;
            (above.dev(), mode) == (found.dev(), true) && found.uid() == rustix::process::geteuid().as_raw()
        };
        ours(&above)
    }
    #[cfg(not(unix))]
    {
        let _ = found;
        false
    }
}

/// Swaps `dir` with `new` in the stage, and takes back what is not ours, all entries but `names`. After an error everything
/// is where it was.
pub(super) fn swap(names: &[&str], dir: &Path, stage: &Path) -> io::Result<()> {
    let new = stage.join("new");
    fs::set_permissions(&new, fs::metadata(dir)?.permissions())?;
    super::recovery::note(stage, dir, None)?;
    exchange(&new, dir)?;
    take_back(names, &new, dir).inspect_err(|_| {
        // Nothing better can be done about a second failure.
        let _ = take_back(names, dir, &new).and_then(|()| exchange(&new, dir));
    })
}

/// Moves all entries but `names` from one directory to another, where they are not.
pub(super) fn take_back(names: &[&str], from: &Path, to: &Path) -> io::Result<()> {
    for entry in fs::read_dir(from)? {
        let name = entry?.file_name();
        if !names.iter().any(|ours| name == **ours) {
            fs::rename(from.join(&name), to.join(&name))?;
        }
    }
    Ok(())
}

#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
fn exchange(a: &Path, b: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, a, CWD, b, RenameFlags::EXCHANGE)?)
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

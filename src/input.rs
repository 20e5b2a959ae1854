//! Files that a user names, read whole: a pipe once and as far as memory goes, a device, which may have no end, not at all.

use std::fs::File;
use std::io::{self, IsTerminal, Read};
use std::path::Path;

use crate::error::{Error, Result};
use crate::memory::Memory;

/// The bytes of a file or of a pipe.
///
/// # Errors
/// What the file system says; a device; a pipe that holds more than memory has room for.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let failed = |e| Error::file(path, e);
    let mut file = File::open(path).map_err(failed)?;
    let kind = file.metadata().map_err(failed)?.file_type();
    if kind.is_file() {
        let mut bytes = Vec::new();
        return file.read_to_end(&mut bytes).map(|_| bytes).map_err(failed);
    }
    whole(&path.display().to_string(), file, is_device(kind)).map_err(failed)?
}

/// The same of a file of text.
///
/// # Errors
/// As `read`; what is no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let invalid =
        |_| Error::file(path, io::Error::new(io::ErrorKind::InvalidData, "stream did not contain valid UTF-8"));
    String::from_utf8(read(path)?).map_err(invalid)
}

/// The bytes of standard input.
pub(crate) fn read_stdin() -> Result<Vec<u8>> {
    let name = "standard input";
    let stdin = io::stdin();
    let device = !stdin.is_terminal() && kind_of_stdin().is_some_and(is_device);
    whole(name, stdin.lock(), device).map_err(|e| Error::file(name, e))?
}

/// Whether there is something that is neither file nor directory: what is read of it is gone.
pub(crate) fn is_stream(path: &Path) -> bool {
    path.metadata().is_ok_and(|data| !data.is_file() && !data.is_dir())
}

/// All bytes of what has no length. More than memory has room for, or any of a device, are an error.
fn whole(name: &str, from: impl Read, device: bool) -> io::Result<Result<Vec<u8>>> {
    let most = if device { Memory(0) } else { Memory::of_machine() };
    let mut bytes = Vec::new();
    from.take(most.0.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 <= most.0 {
        return Ok(Ok(bytes));
    }
    let reason = match device {
        true => "is a device, which may have no end; expected a file or a pipe".to_string(),
        false => format!("holds more than {most}, half of the memory; expected a file, of which parts can be read"),
    };
    Ok(Err(Error::input(name, reason)))
}

#[cfg(unix)]
fn is_device(kind: std::fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: std::fs::FileType) -> bool {
    false
}

#[cfg(unix)]
fn kind_of_stdin() -> Option<std::fs::FileType> {
    use std::os::fd::AsFd;
    let file = File::from(io::stdin().as_fd().try_clone_to_owned().ok()?);
    file.metadata().ok().map(|data| data.file_type())
}

#[cfg(not(unix))]
fn kind_of_stdin() -> Option<std::fs::FileType> {
    None
}

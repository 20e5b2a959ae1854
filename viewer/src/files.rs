//! Files, behind one small interface: a browser will have another.

use std::path::PathBuf;

/// Reading and writing on behalf of a person.
pub trait Files {
    /// The text of a file.
    fn read(&self, path: &std::path::Path) -> Result<String, String>;
    /// Writes a file that is not there yet.
    fn write(&self, path: &std::path::Path, bytes: &[u8]) -> Result<(), String>;
    /// Where exports go unless told otherwise.
    fn folder(&self) -> PathBuf;
}

/// Those of the computer.
pub struct LocalFiles;

impl Files for LocalFiles {
    fn read(&self, path: &std::path::Path) -> Result<String, String> {
        std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
    }

    fn write(&self, path: &std::path::Path, bytes: &[u8]) -> Result<(), String> {
        let file = std::fs::OpenOptions::new().write(true).create_new(true).open(path);
        file.and_then(|mut f| std::io::Write::write_all(&mut f, bytes)).map_err(|e| format!("{}: {e}", path.display()))
    }

    fn folder(&self) -> PathBuf {
        std::env::current_dir().unwrap_or_default()
    }
}

//! Files, behind one small interface: a browser will have another.

use std::path::PathBuf;

/// What to ask for.
pub enum Choice {
    /// Point files.
    Points,
    /// A folder of them.
    Folder,
    /// A session.
    Session,
}

/// What came of it.
pub enum Answer {
    /// Files of points, or a folder.
    Points(Vec<PathBuf>),
    /// A session.
    Session {
        /// Its file.
        path: PathBuf,
        /// Its text.
        text: String,
    },
    /// Written there.
    Saved(PathBuf),
    /// Why not.
    Failed(String),
}

/// Reading and writing on behalf of a person.
pub trait Files {
    /// Asks for files; the answer comes with `answers`, perhaps much later.
    fn choose(&mut self, what: Choice);
    /// Asks where to, and writes.
    fn save(&mut self, name: &str, bytes: Vec<u8>);
    /// What came of what was asked for.
    fn answers(&mut self) -> Vec<Answer>;
}

/// Those of the computer.
pub struct LocalFiles;

impl Files for LocalFiles {
    fn choose(&mut self, _: Choice) {}
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn answers(&mut self) -> Vec<Answer> {
        Vec::new()
    }
}

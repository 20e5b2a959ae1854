//! Files, behind one small interface: a browser will have another.

use std::path::{Path, PathBuf};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// Files of points.
    Points,
    /// A folder of them.
    Folder,
    /// A session.
    Session,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// These were chosen.
    Points(Vec<PathBuf>),
    /// A session was chosen, and read.
    Session {
        /// Where it is.
        path: PathBuf,
        /// What is in it.
        text: String,
    },
    /// It was written, to there.
    Saved(PathBuf),
    /// It could not be read or written, for this reason.
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
#[derive(Default)]
pub struct LocalFiles {
    answers: Vec<Answer>,
}

impl Files for LocalFiles {
    fn choose(&mut self, _: Choice) {}

    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        let path = std::path::absolute(Path::new(name)).unwrap_or_else(|_| name.into());
        self.answers.push(match std::fs::write(&path, bytes) {
            Ok(()) => Answer::Saved(path),
            Err(e) => Answer::Failed(format!("{}: {e}", path.display())),
        });
    }

    fn answers(&mut self) -> Vec<Answer> {
        std::mem::take(&mut self.answers)
    }
}

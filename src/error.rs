//! One error type. Every variant names the input at fault, its value, and what would be accepted.

use std::path::PathBuf;

/// The result type of the library.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A number as a person would type it: plain, or with an exponent where plain digits would fill the line.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() || (1e-6..1e16).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

/// Numbers in a list, as typed.
pub(crate) fn numbers(list: impl IntoIterator<Item = f64>) -> String {
    list.into_iter().map(number).collect::<Vec<_>>().join(",")
}

/// What went wrong, with which input.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A setting is impossible or contradicts another. The command line exits with code 2.
    #[error("{flag} {value}: {reason}")]
    Setting {
        /// The flag as a user types it, e.g. `--r-max`.
        flag: &'static str,
        /// The value given (or the default taken).
        value: String,
        /// Why it cannot be used and what would be accepted.
        reason: String,
    },

    /// The content of an input file is wrong.
    #[error("{place}: {reason}")]
    Input {
        /// `FILE`, `FILE:LINE` or `FILE, realization K, point J`.
        place: String,
        /// What was found and what would be accepted.
        reason: String,
    },

    /// A file or directory could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The path as given.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },

    /// No usable compute device of the kind asked for.
    #[error("--device {asked}: {reason}")]
    NoDevice {
        /// What was asked for.
        asked: String,
        /// What was found instead and what would work.
        reason: String,
    },

    /// The compute device failed while working (lost, out of memory, timed out, rejected a command).
    #[error("{device}: {what}: {reason}")]
    Device {
        /// The adapter's name.
        device: String,
        /// What it was asked to do (the kernel's name).
        what: &'static str,
        /// Its own message.
        reason: String,
    },

    /// The work was cancelled by the user.
    #[error("cancelled")]
    Cancelled,
}

impl Error {
    /// A wrong or contradictory setting.
    pub fn setting(flag: &'static str, value: impl ToString, reason: impl Into<String>) -> Self {
        Self::Setting { flag, value: value.to_string(), reason: reason.into() }
    }

    /// Wrong content at `place` of an input.
    pub fn input(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Input { place: place.into(), reason: reason.into() }
    }

    /// A file system error at `path`.
    pub fn file(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::File { path: path.into(), source }
    }

    /// The exit code of the command line: 2 for usage, 1 for data or device, 130 after Ctrl-C (as shells do).
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Setting { .. } => 2,
            Self::Cancelled => 130,
            _ => 1,
        }
    }
}

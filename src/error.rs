//! One error type. Every variant names the input at fault, its value, and what would be accepted.

use std::path::{Path, PathBuf};

use crate::setting::{Setting, renamed};

/// The result type of the library.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// `1 point`, `2 points`.
pub(crate) fn plural(n: u64, noun: &str) -> String {
    match (n, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "axis") => format!("{n} axes"),
        _ => format!("{n} {noun}s"),
    }
}

/// A number as a person would type it: plain, or with an exponent where plain digits would fill the line.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() || (1e-6..1e16).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

/// Numbers in a list, as typed.
pub(crate) fn numbers(list: impl IntoIterator<Item = f64>) -> String {
    list.into_iter().map(number).collect::<Vec<_>>().join(",")
}

/// What went wrong, with which input. Settings are named as the fields of `Request`; [`Error::told`] has other names for them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is impossible or contradicts another. The command line exits with code 2.
    #[error("{setting} {value}: {reason}")]
    Setting {
        /// Which one.
        setting: Setting,
        /// The value given (or the default taken).
        value: String,
        /// Why it cannot be used and what would be accepted. Other settings are mentioned as `` `r_max` ``.
        reason: String,
    },

    /// Arguments of `pairwave analyze` that make no request. The command line exits with code 2.
    #[error("pairwave analyze {arguments}: {reason}")]
    Arguments {
        /// What was typed.
        arguments: String,
        /// Why it cannot be used, in one line.
        reason: String,
    },

    /// The content of an input file is wrong.
    #[error("{place}: {reason}")]
    Input {
        /// `FILE`, `FILE:LINE` or `FILE, realization K, point J`.
        place: String,
        /// What was found and what would be accepted. Settings are mentioned as `` `r_max` ``.
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
    #[error("{} {asked}: {reason}", Setting::Device)]
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

    /// A run ended before its end, and something is kept of it.
    #[error("{error}; {kept}")]
    Unfinished {
        /// What ended it.
        error: Box<Error>,
        /// What is kept where, and how to go on. Settings are mentioned as `` `resume` ``.
        kept: String,
    },
}

impl Error {
    /// A wrong or contradictory setting.
    pub fn setting(setting: Setting, value: impl ToString, reason: impl Into<String>) -> Self {
        Self::Setting { setting, value: value.to_string(), reason: reason.into() }
    }

    /// The same error with `setting` as it was typed, if that is at fault: values are checked in other forms too.
    pub(crate) fn typed_as(self, setting: Setting, typed: impl ToString) -> Self {
        match self {
            Self::Setting { setting: at_fault, reason, .. } if at_fault == setting => {
                Self::setting(setting, typed, reason)
            }
            other => other,
        }
    }

    /// A mistake in the content of a file that `setting` named: what is wrong is wrong in that file.
    pub(crate) fn in_file(self, setting: Setting, path: &Path) -> Self {
        match self {
            Self::Setting { reason, .. } => Self::setting(setting, path.display(), reason),
            other => other,
        }
    }

    /// The message with settings under the names that `name` has for them: the flags of a command line, keywords.
    pub fn told(&self, name: impl Fn(Setting) -> &'static str) -> String {
        self.told_by(&name)
    }

    fn told_by(&self, name: &dyn Fn(Setting) -> &'static str) -> String {
        match self {
            Self::Setting { setting, value, reason } => {
                format!("{} {value}: {}", name(*setting), renamed(reason, name))
            }
            Self::NoDevice { asked, reason } => format!("{} {asked}: {reason}", name(Setting::Device)),
            Self::Input { place, reason } => format!("{place}: {}", renamed(reason, name)),
            Self::Unfinished { error, kept } => format!("{}; {}", error.told_by(name), renamed(kept, name)),
            other => other.to_string(),
        }
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
            Self::Setting { .. } | Self::Arguments { .. } => 2,
            Self::Cancelled => 130,
            Self::Unfinished { error, .. } => error.exit_code(),
            _ => 1,
        }
    }
}

//! Results as they lie in directories: the summary, and where the tables are.

use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value as Json;

use crate::error::{Error, Result};
use crate::plan::Convention;
use crate::points::UnitName;
use crate::report::SUMMARY;
use crate::report::columns::{Columns, Curve};
use crate::setting::Setting;
use crate::statistics::axes::{DRAWN, Drawn};

/// A directory that holds a result.
pub(crate) struct Stored {
    pub(super) dir: PathBuf,
    summary: Json,
}

/// What of a result its curves depend on, besides the points: keys of the summary, and what they are called.
const COMPARED: [(&str, &str); 15] = [
    ("/parameters/unit", "length unit"),
    ("/d", "dimension"),
    ("/domain/boundary", "domain"),
    ("/domain/sides", "sides of the domain"),
    ("/parameters/normalization", "normalization"),
    ("/parameters/correction", "edge correction"),
    ("/parameters/kernel", "kernel"),
    ("/pair_correlation/kernel/bandwidth", "bandwidth"),
    ("/parameters/convention", "convention"),
    ("/parameters/bug-compatible", "bugs of the convention"),
    ("/parameters/taper", "taper"),
    ("/parameters/tapers", "number of tapers"),
    ("/parameters/debias", "debiasing"),
    ("/parameters/weight-column", "weights"),
    ("/inhomogeneous/intensity", "intensity"),
];

impl Stored {
    /// Reads the summary of a result.
    pub(crate) fn open(dir: &Path) -> Result<Self> {
        let path = dir.join(SUMMARY);
        let no_result = |found: &str| {
            let reason = format!("{found}; expected a directory written by pairwave analyze `out`, with its {SUMMARY}");
            Error::input(dir.display().to_string(), reason)
        };
        let text = std::fs::read_to_string(&path).map_err(|e| match e.kind() {
            io::ErrorKind::NotFound if dir.is_dir() => no_result(&format!("has no {SUMMARY}")),
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory if dir.exists() => no_result("is no directory"),
            _ => Error::file(if dir.exists() { &path } else { dir }, e),
        })?;
        let summary: Json = serde_json::from_str(&text)
            .map_err(|e| Error::input(path.display().to_string(), format!("no JSON: {e}")))?;
        match summary["program"].as_str() {
            Some(env!("CARGO_PKG_NAME")) => Ok(Self { dir: dir.into(), summary }),
            _ => Err(no_result(&format!("has a {SUMMARY} of another program"))),
        }
    }

    /// Where it is.
    pub(crate) fn dir(&self) -> &Path {
        &self.dir
    }

    /// Whether its points are those of another: of one sampler and seed, or of the same files.
    pub(crate) fn shares_points_with(&self, other: &Self) -> bool {
        const SAME: [Setting; 7] = [
            Setting::Files,
            Setting::Sampler,
            Setting::Points,
            Setting::Dim,
            Setting::Seed,
            Setting::Params,
            Setting::Sides,
        ];
        let value = |of: &Self, setting: Setting| match of.summary["parameters"].get(setting.name()) {
            Some(value) => value.to_string(),
            None => setting.row().and_then(|row| row.default).unwrap_or("").to_string(),
        };
        let drawn = [Setting::Files, Setting::Sampler].into_iter().any(|setting| !value(self, setting).is_empty());
        drawn && SAME.into_iter().all(|setting| value(self, setting) == value(other, setting))
    }

    /// A value of the summary, by its pointer.
    pub(crate) fn value(&self, pointer: &str) -> Option<&Json> {
        self.summary.pointer(pointer)
    }

    /// All of the summary.
    pub(super) fn summary(&self) -> &Json {
        &self.summary
    }

    /// A table of it, if it is there.
    pub(crate) fn table(&self, name: &str) -> Result<Option<Columns>> {
        let path = self.dir.join(name);
        let text = match std::fs::read(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(Error::file(path, e)),
        };
        Columns::read(path, &text).map(Some)
    }

    /// The curves of a figure, or why there are none.
    pub(super) fn curves(&self, drawn: &Drawn) -> Result<Result<Vec<Curve>, String>> {
        match self.table(drawn.table)? {
            Some(table) => table.curves(drawn),
            None => Ok(Err(format!("{} has no {}", self.dir.display(), drawn.table))),
        }
    }

    /// The figures that can be drawn of it.
    pub(super) fn figures(&self) -> Result<Vec<&'static Drawn>> {
        let mut found = Vec::new();
        for drawn in DRAWN {
            if self.curves(drawn)?.is_ok() {
                found.push(drawn);
            }
        }
        Ok(found)
    }

    /// The name of its length unit.
    pub(super) fn unit(&self) -> Option<UnitName> {
        self.summary.pointer("/parameters/unit")?.as_str()?.parse().ok()
    }

    /// Whose rings it has.
    pub(super) fn convention(&self) -> Convention {
        let name = self.summary.pointer("/parameters/convention").and_then(Json::as_str);
        name.and_then(|name| name.parse().ok()).unwrap_or_default()
    }

    /// Whether its envelopes are of simulations that were given.
    pub(super) fn envelope_is_given(&self) -> bool {
        self.summary.pointer("/envelope/given").is_some_and(|given| !given.is_null())
    }

    /// What was measured otherwise than in another, in words.
    pub(crate) fn differences(&self, other: &Self) -> Vec<String> {
        let value = |of: &Self, key| match of.summary.pointer(key) {
            None | Some(Json::Null) => "left out".into(),
            Some(Json::String(text)) => text.clone(),
            Some(value) => value.to_string(),
        };
        let both = COMPARED.iter().map(|(key, name)| (name, value(self, key), value(other, key)));
        let (here, there) = (self.dir.display(), other.dir.display());
        both.filter(|(_, a, b)| a != b).map(|(name, a, b)| format!("{name}: {here}: {a}; {there}: {b}")).collect()
    }
}

//! Results as they lie in directories: the summary and the tables, read again.

use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value as Json;

use crate::display::Interval;
use crate::error::{Error, Result, plural};
use crate::plan::Convention;
use crate::points::UnitName;
use crate::report::SUMMARY;
use crate::statistics::axes::{DRAWN, Drawn};
use crate::statistics::measured::{Cells, number};

/// A directory that holds a result.
pub(crate) struct Stored {
    pub(super) dir: PathBuf,
    summary: Json,
}

/// A table as text.
pub(crate) struct Columns {
    path: PathBuf,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

/// A curve of a table: its name among others, and where each value stands, with its error.
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) samples: Vec<(Interval, Option<f64>, Option<f64>)>,
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
        const SAME: [&str; 7] = ["files", "sampler", "points", "dim", "seed", "params", "sides"];
        let drawn = ["files", "sampler"].iter().any(|key| self.summary["parameters"].get(key).is_some());
        drawn && SAME.iter().all(|key| self.summary["parameters"].get(key) == other.summary["parameters"].get(key))
    }

    /// A value of the summary, by its pointer.
    pub(crate) fn value(&self, pointer: &str) -> Option<&Json> {
        self.summary.pointer(pointer)
    }

    /// A table of it, if it is there.
    pub(crate) fn table(&self, name: &str) -> Result<Option<Columns>> {
        let path = self.dir.join(name);
        let text = match std::fs::read(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(Error::file(path, e)),
        };
        let mut reader = csv::Reader::from_reader(text.as_slice());
        let broken = |e: csv::Error| {
            let line = e.position().map_or(String::new(), |position| format!(":{}", position.line()));
            let reason = match e.kind() {
                csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                    format!(
                        "has {}; expected {expected_len}, one for each column of the first line",
                        plural(*len, "cell")
                    )
                }
                csv::ErrorKind::Utf8 { .. } => "is no UTF-8".into(),
                _ => e.to_string(),
            };
            Error::input(format!("{}{line}", path.display()), reason)
        };
        let header = reader.headers().map_err(broken)?.iter().map(str::to_string).collect();
        let rows = reader.records().collect::<csv::Result<_>>().map_err(broken)?;
        Ok(Some(Columns { path, header, rows }))
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

impl Columns {
    /// Its cells, by columns.
    pub(crate) fn cells(&self) -> Cells<'_> {
        let column = |k: usize| self.rows.iter().map(|row| row.get(k).unwrap_or_default()).collect();
        Cells::new(self.header.iter().enumerate().map(|(k, name)| (name.as_str(), column(k))))
    }

    /// What is wrong with a row.
    pub(crate) fn fault(&self, row: usize, why: String) -> Error {
        let line = self.rows.get(row).and_then(csv::StringRecord::position).map_or(0, csv::Position::line);
        Error::input(format!("{}:{line}", self.path.display()), why)
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|h| h == name)
    }

    /// The number in a cell; none where it is empty.
    fn number(&self, row: usize, column: usize) -> Result<Option<f64>> {
        let cell = self.rows[row].get(column).unwrap_or_default();
        number(cell).map_err(|why| self.fault(row, format!("column {} {why}", self.header[column])))
    }

    /// The curves of a figure, or why there are none.
    fn curves(&self, drawn: &Drawn) -> Result<Result<Vec<Curve>, String>> {
        let without = |column: &str| Ok(Err(format!("{} has no column {column}", self.path.display())));
        let x = drawn.x_column;
        let ends = self.find(&format!("{x}_lo")).zip(self.find(&format!("{x}_hi")));
        if ends.is_none() && self.find(x).is_none() {
            return without(x);
        }
        let group = match drawn.group {
            Some(name) if self.find(name).is_none() => return without(name),
            name => name.and_then(|name| self.find(name)),
        };
        let mut abscissae = Vec::with_capacity(self.rows.len());
        for row in 0..self.rows.len() {
            let at = |column: Option<usize>| match column {
                Some(column) => Ok(self.number(row, column)?.map(|x| x / drawn.x_factor)),
                None => Ok(None),
            };
            let (lo, x, hi) = (at(ends.map(|e| e.0))?, at(self.find(x))?, at(ends.map(|e| e.1))?);
            let middle = x.or_else(|| Some(0.5 * (lo? + hi?)));
            abscissae.push(middle.map(|x| (lo.unwrap_or(x), x, hi.unwrap_or(x))));
        }
        let mut curves: Vec<Curve> = Vec::new();
        for (wanted, name) in drawn.curves {
            let prefix = wanted.ends_with('_');
            let is = |h: &str| if prefix { h.starts_with(wanted) && !h.ends_with("_se") } else { h == *wanted };
            let columns: Vec<usize> = (0..self.header.len()).filter(|&k| is(&self.header[k])).collect();
            if columns.is_empty() {
                return without(&if prefix { format!("{wanted}…") } else { (*wanted).into() });
            }
            for column in columns {
                let header = &self.header[column];
                // L - r errs as L does.
                let errors = format!("{}_se", header.replacen("l_minus_r", "l", 1));
                let errors = self.find(&errors).filter(|_| drawn.bands);
                let own = if prefix { header[wanted.len()..].replace('_', " – ") } else { (*name).to_string() };
                let mut last: Option<&str> = None;
                for (row, &x) in abscissae.iter().enumerate() {
                    let of = group.map(|group| self.rows[row].get(group).unwrap_or_default());
                    if row == 0 || of != last {
                        let name = match (drawn.group, of) {
                            (Some(group), Some(of)) => format!("{group} = {}", of.get(..8).unwrap_or(of)),
                            _ => own.clone(),
                        };
                        curves.push(Curve { name, samples: Vec::new() });
                        last = of;
                    }
                    let (Some(x), Some(curve)) = (x, curves.last_mut()) else { continue };
                    let error = errors.map_or(Ok(None), |column| self.number(row, column))?;
                    curve.samples.push((x, self.number(row, column)?, error));
                }
            }
        }
        let defined = curves.iter().any(|c| c.samples.iter().any(|s| s.1.is_some()));
        Ok(if defined { Ok(curves) } else { Err(format!("{} has no values of it", self.path.display())) })
    }

    /// A column of numbers, if it is there, where its rows are of one curve.
    pub(crate) fn column(&self, name: &str) -> Result<Option<Vec<Option<f64>>>> {
        let Some(column) = self.find(name) else { return Ok(None) };
        (0..self.rows.len()).map(|row| self.number(row, column)).collect::<Result<_>>().map(Some)
    }

    /// r and the ends of the global envelope of a curve.
    pub(super) fn envelope(&self, curve: &str) -> Result<Vec<[Option<f64>; 3]>> {
        let [Some(of), Some(r), Some(lo), Some(hi)] = ["curve", "r", "global_lo", "global_hi"].map(|c| self.find(c))
        else {
            return Ok(Vec::new());
        };
        let rows = (0..self.rows.len()).filter(|&row| self.rows[row].get(of) == Some(curve));
        rows.map(|row| Ok([self.number(row, r)?, self.number(row, lo)?, self.number(row, hi)?])).collect()
    }
}

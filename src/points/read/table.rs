//! Tables whose columns have names, of formats other than text: what their columns hold is decided as by the header of a text.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use super::columns::{Separator, check_weight};
use super::text::{Layout, number, shown};
use super::{Apart, Columns, MarkedPoints, Reading, StatedBox};
use crate::error::{Error, Result};
use crate::points::RawPoints;

/// What stands in a field of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Field<'a> {
    Number(f64),
    Text(Cow<'a, str>),
    Nothing,
}

impl<'a> Field<'a> {
    /// Bytes of a text, quoted or not.
    pub(super) fn text(bytes: &'a [u8]) -> Self {
        Self::Text(String::from_utf8_lossy(bytes))
    }

    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x),
            Self::Text(text) => number(text.trim().as_bytes()),
            Self::Nothing => None,
        }
    }

    /// As a class or the value of a realization; `None` where nothing stands.
    fn label(self) -> Option<Cow<'a, str>> {
        match self {
            // 0 has two signs.
            Self::Number(x) => Some((x + 0.0).to_string().into()),
            Self::Text(text) => Some(text).filter(|text| !text.is_empty()),
            Self::Nothing => None,
        }
    }

    fn shown(&self) -> String {
        match self {
            Self::Number(x) => format!("\"{x}\""),
            Self::Text(text) => shown(text.as_bytes()),
            Self::Nothing => "nothing".into(),
        }
    }
}

/// What is said of a table besides its columns.
#[derive(Debug, Default)]
pub(super) struct Described {
    /// As in a reading.
    pub(super) format: String,
    /// What tells realizations apart where there are several.
    pub(super) apart: Apart,
    pub(super) digits: Option<u32>,
    /// The box that the file states.
    pub(super) stated: Option<Result<StatedBox, String>>,
    /// What else the file holds.
    pub(super) rest: Vec<String>,
    /// Each behind the name of the file.
    pub(super) notes: Vec<String>,
}

fn empty(name: &str, dim: usize) -> MarkedPoints {
    MarkedPoints {
        points: RawPoints { dim, coordinates: Vec::new(), source: name.into(), lines: Vec::new() },
        weights: Vec::new(),
        labels: Vec::new(),
        reading: Arc::default(),
    }
}

/// Rows on their way into points.
pub(super) struct Table<'a> {
    name: &'a str,
    chosen: &'a Columns,
    pub(super) layout: Layout,
    sets: Vec<MarkedPoints>,
    now: MarkedPoints,
    /// The values of the column that tells realizations apart: of each row, and in the order of their first points.
    keys: Vec<u32>,
    realizations: Vec<String>,
    known: HashMap<String, u32>,
}

impl<'a> Table<'a> {
    /// A table with columns of these names, which `line` says, where there are lines.
    pub(super) fn new(name: &'a str, chosen: &'a Columns, names: &[String], line: Option<u64>) -> Result<Self> {
        let place = line.map_or(name.to_string(), |line| format!("{name}:{line}"));
        if chosen.realization == Some(Separator::BlankLines) {
            return Err(Error::input(name, "`realization_column` blank-lines is about text, which this file is not"));
        }
        if !chosen.arrays.is_empty() {
            return Err(Error::input(name, "`array` chooses arrays of an .npz archive, which this file is not"));
        }
        let bytes: Vec<&[u8]> = names.iter().map(String::as_bytes).collect();
        let layout =
            Layout::of_names(chosen, &bytes, line.unwrap_or(0)).map_err(|reason| Error::input(place, reason))?;
        Ok(Self {
            name,
            chosen,
            now: empty(name, layout.columns.len()),
            layout,
            sets: Vec::new(),
            keys: Vec::new(),
            realizations: Vec::new(),
            known: HashMap::new(),
        })
    }

    /// Whether a column is looked at.
    #[cfg(feature = "tables")]
    pub(super) fn takes(&self, column: usize) -> bool {
        let Layout { columns, marks, frames, .. } = &self.layout;
        columns.contains(&column) || marks.contain(column) || frames.as_ref().is_some_and(|(k, _)| *k == column)
    }

    /// The names of the coordinates.
    pub(super) fn axes(&self) -> impl Iterator<Item = &str> {
        self.layout.columns.iter().map(|&k| self.layout.names[k].as_str())
    }

    /// Takes a row, in its line where there are lines.
    pub(super) fn row<'f>(&mut self, line: Option<u64>, mut field: impl FnMut(usize) -> Field<'f>) -> Result<()> {
        let now = &mut self.now;
        let (name, layout) = (self.name, &mut self.layout);
        let j = now.points.len();
        let fail = |reason: String| {
            let place = line.map_or_else(|| format!("{name}, point {j}"), |line| format!("{name}:{line}"));
            Err(Error::input(place, reason))
        };
        let expected = |field: &Field, column: usize, layout: &Layout| {
            let what = if field.number().is_some() { "is not finite" } else { "is not a number" };
            format!("{} {what}; expected a number in column {}", field.shown(), layout.name(column))
        };
        for &column in &layout.columns {
            let field = field(column);
            match field.number() {
                Some(x) if x.is_finite() => now.points.coordinates.push(x),
                _ => return fail(expected(&field, column, layout)),
            }
        }
        if let Some(column) = layout.marks.weight {
            let field = field(column);
            let Some(weight) = field.number() else { return fail(expected(&field, column, layout)) };
            if let Err(reason) = check_weight(weight, layout.marks.intensity) {
                return fail(reason);
            }
            now.weights.push(weight);
        }
        if let Some(column) = layout.marks.class {
            match field(column).label() {
                Some(label) => now.labels.push(label.into_owned()),
                None => return fail(format!("no class in column {}", layout.name(column))),
            }
        }
        if let Some(column) = layout.marks.realization {
            let Some(label) = field(column).label() else {
                return fail(format!("no realization in column {}", layout.name(column)));
            };
            let key = match self.known.get(label.as_ref()) {
                Some(&key) => key,
                None => {
                    let key = self.realizations.len() as u32;
                    self.realizations.push(label.to_string());
                    self.known.insert(label.into_owned(), key);
                    key
                }
            };
            self.keys.push(key);
        }
        layout.see_frame(|column| field(column).label().unwrap_or_default().into_owned().into_bytes().into());
        now.points.lines.extend(line);
        Ok(())
    }

    /// What follows is another realization.
    pub(super) fn end_set(&mut self) {
        let next = empty(self.name, self.now.points.dim);
        self.sets.push(std::mem::replace(&mut self.now, next));
    }

    /// All realizations, each of which has ended.
    pub(super) fn finish(mut self, described: Described) -> Result<Vec<MarkedPoints>> {
        let fail = |reason: String| Err(Error::input(self.name, reason));
        let points: usize = self.sets.iter().map(|set| set.points.len()).sum();
        if points == 0 {
            return fail(format!("no {}s", self.chosen.rows.one()));
        }
        let column = self.layout.marks.realization.map(|k| self.layout.name(k));
        match (&column, self.sets.len()) {
            (Some(column), 1) => {
                let whole = self.sets.remove(0);
                self.sets = whole.apart(&self.keys, &self.realizations, &format!("realization {column}"));
            }
            (Some(column), _) => {
                return fail(format!("`realization_column` {column}: {} already", described.apart.words()));
            }
            (None, 1) => {}
            (None, _) => {
                for (k, set) in self.sets.iter_mut().enumerate() {
                    set.points.source = format!("{}, realization {k}", self.name);
                }
            }
        }
        let Described { format, apart, digits, stated, rest, notes } = described;
        let mut notes: Vec<String> = notes.into_iter().map(|note| format!("{}: {note}", self.name)).collect();
        let said = self.layout.notes(points, self.sets.len(), self.chosen);
        notes.extend(said.into_iter().map(|note| format!("{}: {note}", self.name)));
        match self.layout.suspicious(&self.sets, self.chosen) {
            Some(Ok(note)) => notes.push(format!("{}: {note}", self.name)),
            Some(Err(reason)) => return fail(reason),
            None => {}
        }
        let mut unused = self.layout.unused();
        unused.extend(rest);
        let reading = Arc::new(Reading {
            format,
            columns: self.layout.columns.iter().map(|&k| self.layout.name(k)).collect(),
            unused,
            apart: column.map(Apart::Column).unwrap_or(if self.sets.len() > 1 { apart } else { Apart::Files }),
            digits,
            stated,
            notes,
        });
        self.sets.iter_mut().for_each(|set| set.reading = reading.clone());
        Ok(self.sets)
    }
}

/// Lines of a file with their numbers, and what is left behind them.
pub(super) struct Cursor<'a> {
    lines: super::text::Lines<'a>,
    /// Of the line that was read last.
    pub(super) line: u64,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { lines: super::text::Lines(bytes), line: 0 }
    }

    /// What was not read yet.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.lines.0
    }

    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        let line = self.lines.next()?;
        self.line += 1;
        Some(line)
    }

    /// The next line that is not blank.
    pub(super) fn next_filled(&mut self) -> Option<&'a [u8]> {
        loop {
            let line = self.next()?.trim_ascii();
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// Goes on at `rest`, which a line of this number is before.
    pub(super) fn go_on(&mut self, rest: &'a [u8], line: u64) {
        (self.lines, self.line) = (super::text::Lines(rest), line);
    }

    pub(super) fn fail<T>(&self, name: &str, reason: impl Into<String>) -> Result<T> {
        Err(Error::input(format!("{name}:{}", self.line), reason))
    }
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

//! Which columns hold what: coordinates, weights, classes, and what tells realizations apart.

use std::str::FromStr;
use std::sync::Arc;

use super::Reading;
use crate::error::{Error, Result, plural};
use crate::points::RawPoints;
use crate::setting::Setting;

/// A column as typed: its number from 1, or its name in a header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Counted from 1.
    Number(usize),
    /// As in the header, in any case.
    Name(String),
}

impl FromStr for Column {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.parse() {
            Ok(0) => Err("columns are counted from 1"),
            Ok(number) => Ok(Self::Number(number)),
            Err(_) if text.is_empty() => Err("expected a name or a number from 1"),
            Err(_) => Ok(Self::Name(text.to_owned())),
        }
    }
}

/// What the rows of a file are, for messages.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Rows {
    /// Points.
    #[default]
    Points,
    /// Wave vectors of `--frequencies`.
    WaveVectors {
        /// Integers m, cycles per side, rather than nu, cycles per unit length.
        per_side: bool,
    },
}

impl Rows {
    /// One of them.
    pub(super) fn one(self) -> &'static str {
        match self {
            Self::Points => "point",
            Self::WaveVectors { .. } => "wave vector",
        }
    }

    /// What the column of the first axis is called.
    pub(super) fn first_axis(self) -> &'static str {
        self.axes().split(',').next().unwrap_or_default()
    }

    /// What the columns of coordinates are called.
    pub(super) fn axes(self) -> &'static str {
        match self {
            Self::Points => "x, y[, z]",
            Self::WaveVectors { per_side: true } => "m_x, m_y[, m_z]",
            Self::WaveVectors { per_side: false } => "nu_x, nu_y[, nu_z]",
        }
    }

    /// What a number of one is.
    pub(super) fn number(self) -> &'static str {
        match self {
            Self::Points => "coordinate",
            Self::WaveVectors { .. } => "number",
        }
    }
}

/// What tells the realizations of a file apart, where the user says so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Separator {
    /// The values of a column.
    Column(Column),
    /// Blank lines.
    BlankLines,
}

/// Columns as typed, each a name or a number from 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TypedColumns<'a> {
    /// `--columns`: those of the coordinates, as a line of CSV.
    pub columns: Option<&'a str>,
    /// `--realization-column`, or `blank-lines`.
    pub realization: Option<&'a str>,
    /// `--weight-column`.
    pub weight: Option<&'a str>,
    /// `--intensity-column`, in place of weights.
    pub intensity: Option<&'a str>,
    /// `--class-column`.
    pub class: Option<&'a str>,
    /// `--array`: names of arrays, as a line of CSV.
    pub array: Option<&'a str>,
    /// Whether points may have more than 3 coordinates.
    pub many_axes: bool,
}

/// What the rows are, and what which columns hold.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Columns {
    /// What a row is.
    pub rows: Rows,
    /// `--columns`: the coordinates; none where the file decides.
    pub coordinates: Vec<Column>,
    /// `--realization-column`: what differs between realizations.
    pub realization: Option<Separator>,
    /// `--weight-column` or `--intensity-column`: finite numbers.
    pub weight: Option<Column>,
    /// Whether those are intensities.
    pub intensity: bool,
    /// `--class-column`: text, or numbers that serve as text.
    pub class: Option<Column>,
    /// `--array`: the arrays of an archive that hold points; none where the archive decides.
    pub arrays: Vec<String>,
    /// Whether points may have more than 3 coordinates, up to `MOST_AXES`.
    pub many_axes: bool,
}

/// Coordinates that a point has at most, where it may have many.
pub(crate) const MOST_AXES: usize = 16;

fn most_axes(many: bool) -> usize {
    if many { MOST_AXES } else { 3 }
}

/// The same as indices from 0.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Marks {
    /// Empty where nobody said which they are.
    pub(super) coordinates: Vec<usize>,
    pub(super) realization: Option<usize>,
    pub(super) weight: Option<usize>,
    /// Whether weights are intensities.
    pub(super) intensity: bool,
    pub(super) class: Option<usize>,
}

impl Marks {
    /// Whether column `index` holds no coordinate.
    pub(super) fn contain(&self, index: usize) -> bool {
        [self.weight, self.class, self.realization].contains(&Some(index))
    }

    /// The columns that hold coordinates: those that were named, or all that hold nothing else.
    pub(super) fn coordinates(&self, width: usize) -> Vec<usize> {
        match self.coordinates.is_empty() {
            true => (0..width).filter(|&k| !self.contain(k)).collect(),
            false => self.coordinates.clone(),
        }
    }
}

/// Values separated by commas; what holds a comma stands in quotes.
fn listed(setting: Setting, text: &str) -> Result<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).trim(csv::Trim::All).from_reader(text.as_bytes());
    let refuse = || Error::setting(setting, text, "expected names or numbers, separated by commas");
    let record = reader.records().next().ok_or_else(refuse)?.map_err(|_| refuse())?;
    let values: Vec<String> = record.iter().map(String::from).collect();
    if values.iter().any(String::is_empty) { Err(refuse()) } else { Ok(values) }
}

impl Columns {
    /// How many coordinates a point may have.
    pub(super) fn most_axes(&self) -> usize {
        most_axes(self.many_axes)
    }

    /// From what was typed.
    ///
    /// # Errors
    /// Columns counted from 0 or without a name, more than three of coordinates, one twice.
    pub fn new(typed: &TypedColumns<'_>) -> Result<Self> {
        let one = |setting, text: &str| text.parse().map_err(|e: &str| Error::setting(setting, text, e));
        let parse = |setting, typed: Option<&str>| typed.map(|text| one(setting, text)).transpose();
        let mut coordinates: Vec<Column> = Vec::new();
        if let Some(text) = typed.columns {
            for name in listed(Setting::Columns, text)? {
                let column: Column = name.parse().map_err(|e: &str| Error::setting(Setting::Columns, text, e))?;
                if coordinates.contains(&column) {
                    return Err(Error::setting(Setting::Columns, text, format!("names column {name} twice")));
                }
                coordinates.push(column);
            }
            let most = most_axes(typed.many_axes);
            if coordinates.len() > most {
                let expected = if typed.many_axes { format!("1 to {most}") } else { "1, 2 or 3".into() };
                let more = if typed.many_axes { "" } else { "; `projections` takes more" };
                let reason = format!("expected {expected} columns, found {}{more}", coordinates.len());
                return Err(Error::setting(Setting::Columns, text, reason));
            }
        }
        let intensity = typed.intensity.is_some();
        if let Some((intensity, _)) = typed.intensity.zip(typed.weight) {
            return Err(Error::setting(Setting::IntensityColumn, intensity, "cannot be used with `weight_column`"));
        }
        let of_weights = of_weights(intensity);
        let realization = match typed.realization {
            Some(BLANK_LINES) => Some(Separator::BlankLines),
            other => parse(Setting::RealizationColumn, other)?.map(Separator::Column),
        };
        let arrays = typed.array.map(|text| listed(Setting::Array, text)).transpose()?.unwrap_or_default();
        if let Some(twice) = (1..arrays.len()).find(|&k| arrays[..k].contains(&arrays[k])) {
            let reason = format!("names array {} twice", arrays[twice]);
            return Err(Error::setting(Setting::Array, typed.array.unwrap_or_default(), reason));
        }
        Ok(Self {
            rows: Rows::Points,
            coordinates,
            realization,
            weight: parse(of_weights, typed.intensity.or(typed.weight))?,
            intensity,
            class: parse(Setting::ClassColumn, typed.class)?,
            arrays,
            many_axes: typed.many_axes,
        })
    }

    /// The column that tells realizations apart.
    pub(super) fn realization(&self) -> Option<&Column> {
        match &self.realization {
            Some(Separator::Column(column)) => Some(column),
            _ => None,
        }
    }

    /// How many hold no coordinates.
    pub(super) fn count(&self) -> usize {
        let marks = [self.weight.as_ref(), self.class.as_ref(), self.realization()];
        marks.into_iter().flatten().count()
    }

    /// Whether anything is said about columns.
    pub(super) fn any(&self) -> bool {
        self.count() > 0 || !self.coordinates.is_empty()
    }

    /// Their indices among columns with these names, of which there may be none, or why they are not there.
    pub(super) fn find(&self, width: usize, names: &[&[u8]]) -> Result<Marks, String> {
        let index = |setting: Setting, column: &Column| match column {
            Column::Number(number) if *number <= width => Ok(number - 1),
            Column::Number(number) => {
                Err(format!("`{setting}` {number}: there is no such column, only {}", plural(width as u64, "column")))
            }
            Column::Name(wanted) => {
                // A name as it stands goes before one without its unit.
                let whole = |name: &[u8]| name.eq_ignore_ascii_case(wanted.as_bytes());
                let bare = |name: &[u8]| without_unit(name).eq_ignore_ascii_case(wanted.as_bytes());
                let mut found: Vec<usize> = (0..names.len()).filter(|&i| whole(names[i])).collect();
                if found.is_empty() {
                    found = (0..names.len()).filter(|&i| bare(names[i])).collect();
                }
                match found.as_slice() {
                    [index] => Ok(*index),
                    [_, ..] => Err(format!("`{setting}` {wanted}: two columns have that name")),
                    [] if names.is_empty() => {
                        Err(format!("`{setting}` {wanted}: no header names the columns; expected a number from 1"))
                    }
                    [] => {
                        let names: Vec<_> = names.iter().map(|n| String::from_utf8_lossy(n)).collect();
                        Err(format!("`{setting}` {wanted}: no column of that name; there are {}", names.join(", ")))
                    }
                }
            }
        };
        let one = |setting, column: Option<&Column>| column.map(|column| index(setting, column)).transpose();
        let marks = Marks {
            coordinates: self.coordinates.iter().map(|c| index(Setting::Columns, c)).collect::<Result<_, _>>()?,
            realization: one(Setting::RealizationColumn, self.realization())?,
            weight: one(of_weights(self.intensity), self.weight.as_ref())?,
            intensity: self.intensity,
            class: one(Setting::ClassColumn, self.class.as_ref())?,
        };
        let mut taken: Vec<(usize, Setting)> = marks.coordinates.iter().map(|&k| (k, Setting::Columns)).collect();
        for (mark, setting) in [
            (marks.weight, of_weights(self.intensity)),
            (marks.class, Setting::ClassColumn),
            (marks.realization, Setting::RealizationColumn),
        ] {
            taken.extend(mark.map(|k| (k, setting)));
        }
        for (i, (k, setting)) in taken.iter().enumerate() {
            if let Some((_, other)) = taken[..i].iter().find(|(other, _)| other == k) {
                return Err(match other == setting {
                    true => format!("`{setting}` names column {} twice", k + 1),
                    false => format!("`{other}` and `{setting}` are the same column"),
                });
            }
        }
        Ok(marks)
    }
}

/// The setting that names the column of weights.
fn of_weights(intensity: bool) -> Setting {
    if intensity { Setting::IntensityColumn } else { Setting::WeightColumn }
}

/// What stands for blank lines where a column is expected.
const BLANK_LINES: &str = "blank-lines";

/// A name without the unit in brackets or parentheses at its end: `x [m]` is x.
pub(super) fn without_unit(name: &[u8]) -> &[u8] {
    let name = name.trim_ascii();
    let open = match name.last() {
        Some(b']') => b'[',
        Some(b')') => b'(',
        _ => return name,
    };
    match name.iter().rposition(|&b| b == open) {
        Some(at) if at > 0 => name[..at].trim_ascii(),
        _ => name,
    }
}

/// A realization with what else its file says about each point.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkedPoints {
    /// The points.
    pub points: RawPoints,
    /// One per point, if there is a column of them.
    pub weights: Vec<f64>,
    /// One per point, if there is a column of them.
    pub labels: Vec<String>,
    /// How it was read.
    pub reading: Arc<Reading>,
}

impl MarkedPoints {
    /// Sorts out the columns of points whose coordinates still hold all of them. Returns also the values that tell realizations
    /// apart.
    pub(super) fn split(all: RawPoints, marks: &Marks, reading: Arc<Reading>) -> Result<(Self, Vec<f64>)> {
        let width = all.dim;
        let columns = marks.coordinates(width);
        let mut split = Self {
            points: RawPoints { dim: columns.len(), coordinates: Vec::new(), ..all },
            weights: Vec::new(),
            labels: Vec::new(),
            reading,
        };
        let mut keys = Vec::new();
        if columns.len() == width && columns.is_sorted() {
            split.points.coordinates = all.coordinates;
            return Ok((split, keys));
        }
        let rows = || all.coordinates.chunks_exact(width);
        split.points.coordinates = rows().flat_map(|row| columns.iter().map(|&k| row[k])).collect();
        for (j, row) in rows().enumerate() {
            if let Some(k) = marks.weight {
                split.weights.push(row[k]);
                check_weight(row[k], marks.intensity).map_err(|reason| Error::input(split.points.place(j), reason))?;
            }
            if let Some(k) = marks.class {
                split.labels.push(row[k].to_string());
            }
            if let Some(k) = marks.realization {
                if row[k].is_nan() {
                    return Err(Error::input(split.points.place(j), "the number of its realization is NaN"));
                }
                keys.push(row[k]);
            }
        }
        Ok((split, keys))
    }

    /// The points with each key as a realization, in the order of their first points.
    pub(super) fn apart(self, keys: &[u32], names: &[String], what: &str) -> Vec<Self> {
        let Self { points, weights, labels, reading } = self;
        let empty = |name: &String| Self {
            points: RawPoints {
                dim: points.dim,
                coordinates: Vec::new(),
                source: format!("{}, {what} {name}", points.source),
                lines: Vec::new(),
            },
            weights: Vec::new(),
            labels: Vec::new(),
            reading: reading.clone(),
        };
        let mut sets: Vec<Self> = names.iter().map(empty).collect();
        let mut labels = labels.into_iter();
        for (j, (&key, point)) in keys.iter().zip(points.coordinates.chunks_exact(points.dim)).enumerate() {
            let set = &mut sets[key as usize];
            set.points.coordinates.extend_from_slice(point);
            set.points.lines.extend(points.lines.get(j));
            set.weights.extend(weights.get(j));
            set.labels.extend(labels.next());
        }
        sets
    }
}

/// What weights may be.
pub(super) fn check_weight(weight: f64, intensity: bool) -> Result<(), String> {
    match weight.is_finite() {
        true => Ok(()),
        false if intensity => Err(format!("the intensity there is {weight}; expected a finite number above 0")),
        false => Err(format!("weight {weight}; weights must be finite")),
    }
}

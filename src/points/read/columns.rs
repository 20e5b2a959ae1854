//! Columns that hold no coordinates: weights and classes of points.

use std::str::FromStr;

use super::plural;
use crate::error::{Error, Result};
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
    WaveVectors,
}

impl Rows {
    /// One of them.
    pub(super) fn one(self) -> &'static str {
        match self {
            Self::Points => "point",
            Self::WaveVectors => "wave vector",
        }
    }

    /// What a number of one is.
    pub(super) fn number(self) -> &'static str {
        match self {
            Self::Points => "coordinate",
            Self::WaveVectors => "number",
        }
    }
}

/// What the rows are, and which columns are no coordinates.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Columns {
    /// What a row is.
    pub rows: Rows,
    /// `--weight-column`: finite numbers.
    pub weight: Option<Column>,
    /// `--class-column`: text, or numbers that serve as text.
    pub class: Option<Column>,
}

/// The same as indices from 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Marks {
    pub(super) weight: Option<usize>,
    pub(super) class: Option<usize>,
}

impl Marks {
    /// Whether column `index` holds no coordinate.
    pub(super) fn contain(&self, index: usize) -> bool {
        self.weight == Some(index) || self.class == Some(index)
    }
}

impl Columns {
    /// From what was typed.
    ///
    /// # Errors
    /// Columns counted from 0 or without a name.
    pub fn new(weight: Option<&str>, class: Option<&str>) -> Result<Self> {
        let parse = |setting, typed: Option<&str>| {
            typed.map(|text| text.parse().map_err(|e: &str| Error::setting(setting, text, e))).transpose()
        };
        Ok(Self {
            rows: Rows::Points,
            weight: parse(Setting::WeightColumn, weight)?,
            class: parse(Setting::ClassColumn, class)?,
        })
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        usize::from(self.weight.is_some()) + usize::from(self.class.is_some())
    }

    /// Their indices among columns with these names, of which there may be none, or why they are not there.
    pub(super) fn find(&self, width: usize, names: &[&[u8]]) -> Result<Marks, String> {
        let find = |setting: Setting, column: &Option<Column>| match column {
            None => Ok(None),
            Some(Column::Number(number)) if *number <= width => Ok(Some(number - 1)),
            Some(Column::Number(number)) => {
                Err(format!("`{setting}` {number}: there is no such column, only {}", plural(width as u64, "column")))
            }
            Some(Column::Name(wanted)) => {
                let same = |name: &&[u8]| name.eq_ignore_ascii_case(wanted.as_bytes());
                let mut found = (0..names.len()).filter(|&i| same(&names[i]));
                match (found.next(), found.next()) {
                    (Some(index), None) => Ok(Some(index)),
                    (Some(_), Some(_)) => Err(format!("`{setting}` {wanted}: two columns have that name")),
                    (None, _) if names.is_empty() => {
                        Err(format!("`{setting}` {wanted}: no header names the columns; expected a number from 1"))
                    }
                    (None, _) => {
                        let names: Vec<_> = names.iter().map(|n| String::from_utf8_lossy(n)).collect();
                        Err(format!("`{setting}` {wanted}: no column of that name; there are {}", names.join(", ")))
                    }
                }
            }
        };
        let marks = Marks {
            weight: find(Setting::WeightColumn, &self.weight)?,
            class: find(Setting::ClassColumn, &self.class)?,
        };
        if marks.weight.is_some() && marks.weight == marks.class {
            return Err("`weight_column` and `class_column` are the same column".into());
        }
        Ok(marks)
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
}

impl MarkedPoints {
    /// Sorts out the columns of points whose coordinates still hold all of them.
    pub(super) fn split(all: RawPoints, marks: Marks) -> Result<Self> {
        let width = all.dim;
        let mut split = Self {
            points: RawPoints {
                dim: (0..width).filter(|&k| !marks.contain(k)).count(),
                coordinates: Vec::new(),
                ..all
            },
            weights: Vec::new(),
            labels: Vec::new(),
        };
        for (j, row) in all.coordinates.chunks_exact(width).enumerate() {
            for (k, &value) in row.iter().enumerate() {
                if marks.weight == Some(k) {
                    split.weights.push(value);
                    check_weight(value).map_err(|reason| Error::input(split.points.place(j), reason))?;
                } else if marks.class == Some(k) {
                    split.labels.push(value.to_string());
                } else {
                    split.points.coordinates.push(value);
                }
            }
        }
        Ok(split)
    }
}

/// What weights may be.
pub(super) fn check_weight(weight: f64) -> Result<(), String> {
    if weight.is_finite() {
        return Ok(());
    }
    Err(format!("weight {weight}; weights must be finite"))
}

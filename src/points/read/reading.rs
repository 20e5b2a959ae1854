//! What a reader took of a file: what the first line of a run says, and what the user should know.

use serde::{Deserialize, Serialize};

use super::StatedBox;

/// By what the realizations of a file are told apart.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Apart {
    /// By nothing: the file is one.
    #[default]
    Files,
    /// By lines that are only a comment.
    Comments,
    /// By blank lines.
    BlankLines,
    /// By the values of a column.
    Column(String),
    /// By the first axis of an array.
    FirstAxis,
    /// Each is an array.
    Arrays,
    /// By the sets of a UTK file.
    Sets,
    /// By the frames of a trajectory.
    Frames,
}

impl Apart {
    pub(super) fn words(&self) -> String {
        match self {
            Self::Files => "each file is one realization".into(),
            Self::Comments => "realizations told apart by comment lines".into(),
            Self::BlankLines => "realizations told apart by blank lines".into(),
            Self::Column(name) => format!("realizations told apart by column {name}"),
            Self::FirstAxis => "realizations are the first axis of the array".into(),
            Self::Arrays => "each array is one realization".into(),
            Self::Sets => "realizations are the sets of the file".into(),
            Self::Frames => "realizations are the frames of the file".into(),
        }
    }
}

/// What was taken of one file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Reading {
    /// In words: `CSV, header in line 1`.
    pub format: String,
    /// The columns that hold coordinates, by name or by number from 1.
    pub columns: Vec<String>,
    /// Those that were not used.
    pub unused: Vec<String>,
    /// How realizations were told apart.
    pub apart: Apart,
    /// Binary digits of a stored number, where they are fewer than those of f64.
    pub digits: Option<u32>,
    /// The box that the file states, or why that is none.
    pub stated: Option<Result<StatedBox, String>>,
    /// What the user should know, each with its file.
    pub notes: Vec<String>,
}

/// A file that was left out, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOut {
    /// As it was given or found.
    pub file: String,
    /// What is wrong with it.
    pub reason: String,
}

/// What was read of all files.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Files or streams.
    pub files: u64,
    /// Their formats in words, each once.
    pub formats: Vec<String>,
    /// The columns that hold coordinates, by name or by number from 1; of the first file.
    pub columns: Vec<String>,
    /// Columns that were not used; of the first file.
    pub unused_columns: Vec<String>,
    /// How realizations were told apart, in words.
    pub realizations: Vec<String>,
    /// How many points lay outside the box and were folded into it; `null` where that was not asked for.
    pub wrapped: Option<u64>,
    /// Files that could not be used and were left out, where that was asked for.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
}

/// Of this many files what is said of each is kept; of the rest, that there are more.
const MOST: usize = 10;

impl Input {
    /// Takes another file into account, or another piece of one. Returns how it differs from the first, if it does.
    pub(crate) fn see(&mut self, reading: &Reading) -> Option<String> {
        // Where a header stands is no difference.
        let kind = |format: &str| match format.split_once(", header in line ") {
            Some((start, rest)) => format!("{start}, header{}", rest.trim_start_matches(|c: char| c.is_ascii_digit())),
            None => format.to_string(),
        };
        let mut difference = None;
        if self.columns.is_empty() {
            (self.columns, self.unused_columns) = (reading.columns.clone(), reading.unused.clone());
        } else if let Some(first) = self.formats.first()
            && (kind(first) != kind(&reading.format)
                || (&self.columns, &self.unused_columns) != (&reading.columns, &reading.unused))
        {
            let taken = |format: &str, columns: &[String], unused: &[String]| {
                let formats = vec![format.to_string()];
                Self { formats, columns: columns.to_vec(), unused_columns: unused.to_vec(), ..Self::default() }.taken()
            };
            difference = Some(format!(
                "read as {}, unlike the first file: {}",
                taken(&reading.format, &reading.columns, &reading.unused),
                taken(first, &self.columns, &self.unused_columns)
            ));
        }
        let words = reading.apart.words();
        for (all, one) in [(&mut self.formats, &reading.format), (&mut self.realizations, &words)] {
            if !all.contains(one) && all.len() < MOST {
                all.push(one.clone());
            }
        }
        difference
    }

    /// `text, header in line 1, columns x, y (not used: id); each file is one realization`.
    pub fn words(&self) -> String {
        format!("{}; {}", self.taken(), self.realizations.join("; "))
    }

    /// The same without how realizations were told apart.
    pub(crate) fn taken(&self) -> String {
        let mut words = self.formats.join(" and ");
        if !self.columns.is_empty() {
            let noun = if self.columns.len() == 1 { "column" } else { "columns" };
            words += &format!(", {noun} {}", self.columns.join(", "));
        }
        if !self.unused_columns.is_empty() {
            words += &format!(" (not used: {})", self.unused_columns.join(", "));
        }
        words
    }
}

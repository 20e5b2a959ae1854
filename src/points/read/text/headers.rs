//! Headers: which names stand for what, and what the lines below them look like.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use super::super::columns::without_unit;
use super::super::{Columns, MarkedPoints, Marks, Rows, suspicious};
use super::Parser;
use super::lines::{
    decimal_comma, delimiter, has_decimal_comma, is_blank, number, shown, split_decimals, split_loosely,
    split_strictly, unquoted,
};
use super::rows::{MOST_FRAMES, RowNames};
use crate::error::Result;

/// What the lines of a file look like, known from its header or from its first point.
pub(in crate::points::read) struct Layout {
    /// Fields per line.
    pub(in crate::points::read) width: usize,
    /// Which fields are x, y, z.
    pub(in crate::points::read) columns: Vec<usize>,
    /// Which are something else.
    pub(in crate::points::read) marks: Marks,
    /// `None`: any separator. Otherwise the one of the header, because other columns may hold blanks or nothing.
    pub(super) delimiter: Option<u8>,
    /// The line it was learned from.
    pub(in crate::points::read) line: u64,
    /// The names of the columns, if there are any.
    pub(in crate::points::read) names: Vec<String>,
    /// Whether a header names them, which may be one name short.
    pub(super) header: bool,
    /// The names of rows before the first column, where the header is a name short.
    pub(super) row_names: Option<RowNames>,
    /// A column that is not used and could tell realizations apart, with its values.
    pub(in crate::points::read) frames: Option<(usize, HashSet<Vec<u8>>)>,
}

impl Layout {
    /// The name of a column, or its number from 1.
    pub(in crate::points::read) fn name(&self, k: usize) -> String {
        // A header may be one name short.
        let name = (k + self.names.len()).checked_sub(self.width).and_then(|k| self.names.get(k));
        name.filter(|n| !n.is_empty()).cloned().unwrap_or_else(|| (k + 1).to_string())
    }

    /// Whether a header of so many names says the same as the first one.
    pub(super) fn is_named_so(&self, names: usize, columns: &[usize]) -> bool {
        let known = if self.names.is_empty() { self.width } else { self.names.len() };
        let short = self.width - known;
        known == names && self.columns.iter().copied().eq(columns.iter().map(|k| k + short))
    }

    /// What columns of these names hold.
    pub(in crate::points::read) fn of_names(chosen: &Columns, names: &[&[u8]], line: u64) -> Result<Self, String> {
        let width = names.len();
        if width == 0 {
            return Err("no columns".into());
        }
        let marks = chosen.find(width, names)?;
        let bare: Vec<&[u8]> = names.iter().map(|name| without_unit(name)).collect();
        let rows = chosen.rows;
        let by_flag = rows == Rows::Points;
        let flag = if by_flag { "; `columns` names others" } else { "" };
        let columns = if !marks.coordinates.is_empty() {
            marks.coordinates.clone()
        } else {
            let named = named_columns(&bare, rows).map_err(|twice| format!("two columns are named {twice}{flag}"))?;
            if let Some(twice) = named.iter().find(|&&k| marks.contain(k)) {
                return Err(format!("column {} is a coordinate, not a weight or a class{flag}", twice + 1));
            }
            let others: Vec<usize> = (0..width).filter(|&k| !marks.contain(k)).collect();
            if !named.is_empty() {
                named
            } else if others.len() > chosen.most_axes() {
                let all = names.iter().map(|n| String::from_utf8_lossy(n)).collect::<Vec<_>>().join(",");
                let choose = if by_flag { ", or `columns` with the names of those meant" } else { "" };
                return Err(format!(
                    "{width} columns, none named {}; expected columns named {}, or 1 to 3 columns{choose}, in {}",
                    rows.first_axis(),
                    rows.axes(),
                    shown(all.as_bytes())
                ));
            } else {
                // A number of the point or of its realization must not pass for a coordinate.
                let label = others.iter().find(|&&k| is_label(bare[k]) || (width > 1 && is_frame(bare[k])));
                let numbered = numbers_columns(&names[1..]) && names[0].is_empty();
                match label {
                    Some(&label) if !numbered || label > 0 => {
                        let choose = if by_flag { ", or `columns` with the names of those meant" } else { "" };
                        return Err(format!(
                            "a column named {} and none named {}; expected columns named {}{choose}",
                            shown(names[label]),
                            rows.first_axis(),
                            rows.axes()
                        ));
                    }
                    Some(_) => others[1..].to_vec(),
                    None => others,
                }
            }
        };
        if columns.is_empty() {
            return Err("no column is left for coordinates".into());
        }
        let unused = |k: &usize| !columns.contains(k) && !marks.contain(*k);
        let frames = (0..width).filter(unused).find(|&k| is_frame(bare[k])).map(|k| (k, HashSet::new()));
        let names = names.iter().map(|n| String::from_utf8_lossy(n).into_owned()).collect();
        Ok(Self { width, columns, marks, delimiter: None, line, names, header: true, row_names: None, frames })
    }

    /// Columns that hold nothing that was taken.
    pub(in crate::points::read) fn unused(&self) -> Vec<String> {
        let unused = |k: &usize| !self.columns.contains(k) && !self.marks.contain(*k);
        (0..self.width).filter(unused).map(|k| self.name(k)).collect()
    }

    /// Takes a value of the column that could tell realizations apart into account.
    pub(in crate::points::read) fn see_frame<'a>(&mut self, value: impl FnOnce(usize) -> Cow<'a, [u8]>) {
        if let Some((column, values)) = &mut self.frames
            && values.len() < MOST_FRAMES
        {
            let value = value(*column);
            if !values.contains(value.as_ref()) {
                values.insert(value.into_owned());
            }
        }
    }

    /// What should be known of the columns: one of frames that is not used, degrees.
    pub(in crate::points::read) fn notes(&self, points: usize, sets: usize, chosen: &Columns) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some((column, values)) = self.frames.as_ref().filter(|_| chosen.realization.is_none()) {
            let (column, values) = (self.name(*column), values.len());
            if values > 1 && values < points {
                let many = if values < MOST_FRAMES { values.to_string() } else { format!("more than {values}") };
                let one = one_or_more(sets);
                notes.push(format!(
                    "column {column} has {many} values and was not used: {points} points are {one}; `realization_column` {column} makes each value one"
                ));
            }
        }
        if let Some(k) = self.columns.iter().find(|&&k| self.names.get(k).is_some_and(|n| is_degrees(n))) {
            notes.push(format!(
                "column {} holds degrees by its name; distances in degrees differ with direction and latitude: convert to metres first (UTM or another projection)",
                self.name(*k)
            ));
        }
        notes
    }

    /// A column among the coordinates that may be none, unless it is named as an axis.
    pub(in crate::points::read) fn suspicious(
        &self,
        sets: &[MarkedPoints],
        chosen: &Columns,
    ) -> Option<Result<String, String>> {
        if !chosen.coordinates.is_empty() || chosen.rows != Rows::Points {
            return None;
        }
        suspicious(sets, |k| {
            let column = self.columns[k];
            let named_axis = self.names.get(column).is_some_and(|n| {
                named_columns(&[without_unit(n.as_bytes())], chosen.rows).is_ok_and(|c| !c.is_empty())
                    || ["y", "z"].iter().any(|a| n.eq_ignore_ascii_case(a))
            });
            (!named_axis).then(|| self.name(column))
        })
    }
}

/// How many realizations, in words.
pub(super) fn one_or_more(sets: usize) -> String {
    if sets == 1 { "one realization".into() } else { format!("{sets} realizations") }
}

impl Parser<'_> {
    /// Whether a first line names columns.
    pub(super) fn is_header(&self, content: &[u8]) -> bool {
        let (fields, _) = header_fields(content, self.separator);
        let named = |f: &Range<usize>| could_be_name(&content[f.clone()]);
        fields.iter().all(named) && fields.iter().any(|f| !f.is_empty())
    }

    /// `,0,1`: as pandas numbers columns beside an index.
    pub(super) fn numbers_columns_beside_index(&self, content: &[u8]) -> bool {
        let (fields, _) = header_fields(content, self.separator);
        let names: Vec<&[u8]> = fields.iter().map(|f| unquoted(&content[f.clone()])).collect();
        names.len() > 1 && names[0].is_empty() && names[1] == b"0" && numbers_columns(&names[1..])
    }

    pub(super) fn header(&mut self, line: u64, content: &[u8]) -> Result<()> {
        let (fields, delimiter) = header_fields(content, self.separator);
        let names: Vec<&[u8]> = fields.iter().map(|f| unquoted(&content[f.clone()])).collect();
        let mut layout = match Layout::of_names(self.marks, &names, line) {
            Ok(layout) => layout,
            Err(reason) => return self.fail(line, reason),
        };
        if let Some(known) = self.layout.as_ref().filter(|l| !l.is_named_so(names.len(), &layout.columns)) {
            return self.fail(line, format!("this header differs from the columns of line {}", known.line));
        }
        if self.layout.is_some() {
            // Of the first it is known whether it was a name short.
            return Ok(());
        }
        let only_coordinates = layout.columns.len() == names.len();
        layout.delimiter = delimiter.filter(|_| !only_coordinates).or(self.separator);
        self.layout = Some(layout);
        Ok(())
    }

    /// All columns of `width` that are no marks: the coordinates where no header names them.
    fn coordinates_beside(&self, width: usize, marks: &Marks, line: u64) -> Result<Vec<usize>> {
        let columns = marks.coordinates(width);
        if columns.is_empty() {
            return self.fail(line, "no column is left for coordinates");
        }
        Ok(columns)
    }

    /// The names of so many columns in a comment above the data, the last that names coordinates, else the last of so many
    /// words.
    fn names_in_comments(&self, width: usize) -> Vec<&[u8]> {
        let names = self.comments.iter().rev().map(|comment| {
            let (fields, _) = header_fields(comment, None);
            fields.into_iter().map(|f| unquoted(&comment[f])).collect::<Vec<_>>()
        });
        let fitting: Vec<_> = names.filter(|names| names.len() == width).collect();
        let meant = fitting.iter().position(|names| are_names(names, self.marks.rows));
        fitting.into_iter().nth(meant.unwrap_or(0)).unwrap_or_default()
    }

    /// The layout of a file without header, from its first point.
    pub(super) fn learn(&mut self, line: u64, content: &[u8]) -> Result<Layout> {
        // Where columns are chosen, the others may hold blanks or nothing.
        let delimiter = if self.marks.any() && self.separator.is_none() { delimiter(content) } else { self.separator };
        if let Some(delimiter) = delimiter {
            split_strictly(content, delimiter, &mut self.fields);
        } else if has_decimal_comma(content) && !split_decimals(content, &mut self.fields) {
            return self.fail(line, decimal_comma(content));
        }
        let width = self.fields.len();
        let names = self.names_in_comments(width);
        let marks = match self.marks.find(width, &names) {
            Ok(marks) => marks,
            Err(reason) => return self.fail(line, reason),
        };
        let bare: Vec<&[u8]> = names.iter().map(|name| without_unit(name)).collect();
        let columns = match named_columns(&bare, self.marks.rows) {
            _ if !marks.coordinates.is_empty() => marks.coordinates.clone(),
            Ok(columns) if !columns.is_empty() && !columns.iter().any(|&k| marks.contain(k)) => columns,
            _ => self.coordinates_beside(width, &marks, line)?,
        };
        if columns.len() > self.marks.most_axes() {
            // Text in the first line is the likelier mistake.
            let text = self.fields.iter().map(|f| &content[f.clone()]).find(|f| number(unquoted(f)).is_none());
            let choose = if self.marks.rows == Rows::Points { ", or `columns` 1,2" } else { "" };
            let reason = match text {
                Some(text) => format!("{} is not a number; expected 1, 2 or 3 numbers per line{choose}", shown(text)),
                None => format!(
                    "{width} numbers in a line, expected 1, 2 or 3, or a header that names columns x, y[, z]{choose}: {}",
                    shown(content)
                ),
            };
            return self.fail(line, reason);
        }
        let unused = |k: &usize| !columns.contains(k) && !marks.contain(*k);
        let frames = (0..bare.len()).filter(unused).find(|&k| is_frame(bare[k])).map(|k| (k, HashSet::new()));
        let meant = are_names(&names, self.marks.rows);
        let names = names.iter().filter(|_| meant).map(|n| String::from_utf8_lossy(n).into_owned()).collect();
        Ok(Layout { width, columns, marks, delimiter, line, names, header: false, row_names: None, frames })
    }
}

/// The fields of a header, without the empty ones at its end, and what separates them. Where blanks separate, a unit in brackets
/// or parentheses belongs to the name before it.
fn header_fields(content: &[u8], separator: Option<u8>) -> (Vec<Range<usize>>, Option<u8>) {
    let mut fields = Vec::new();
    let delimiter = separator.or_else(|| delimiter(content));
    match delimiter {
        Some(delimiter) => split_strictly(content, delimiter, &mut fields),
        None => {
            split_loosely(&without_units(content), &mut fields);
            for k in 0..fields.len() {
                let (end, next) = (fields[k].end, fields.get(k + 1).map_or(content.len(), |f| f.start));
                let unit = content[end..next].trim_ascii_start();
                let close = match unit.first() {
                    Some(b'[') => b']',
                    Some(b'(') => b')',
                    _ => continue,
                };
                if content[fields[k].start] != b'"'
                    && let Some(at) = unit.iter().position(|&b| b == close)
                {
                    fields[k].end = next - unit.len() + at + 1;
                }
            }
        }
    }
    while fields.last().is_some_and(Range::is_empty) {
        fields.pop();
    }
    (fields, delimiter)
}

/// Blanks in place of units in brackets or parentheses that follow a name.
fn without_units(content: &[u8]) -> Vec<u8> {
    let mut out = content.to_vec();
    let (mut quoted, mut open, mut after_name) = (false, None, false);
    for at in 0..content.len() {
        let b = content[at];
        quoted ^= b == b'"';
        match (b, open) {
            _ if quoted => {}
            (b'[' | b'(', None) if after_name => open = Some((at, if b == b'[' { b']' } else { b')' })),
            (b, Some((start, close))) if b == close => {
                out[start..=at].fill(b' ');
                open = None;
            }
            _ => {}
        }
        after_name |= !is_blank(b) && b != b'[';
    }
    out
}

/// Whether names are the numbers of columns, from 0 or from 1.
pub(super) fn numbers_columns(names: &[&[u8]]) -> bool {
    let counts = |from: usize| names.iter().enumerate().all(|(k, name)| *name == (from + k).to_string().as_bytes());
    !names.is_empty() && (counts(0) || counts(1))
}

/// Whether `field` can stand in a header: text that is not a number and not a word for a missing one.
fn could_be_name(field: &[u8]) -> bool {
    let name = unquoted(field);
    let missing = [b"na".as_slice(), b"n/a", b"null", b"none"].iter().any(|word| name.eq_ignore_ascii_case(word));
    let start = name.first().is_none_or(|&b| b.is_ascii_alphabetic() || b == b'_' || !b.is_ascii());
    start && !missing && number(name).is_none()
}

/// A name in small letters and digits alone.
fn plain(name: &[u8]) -> String {
    name.iter().filter(|b| b.is_ascii_alphanumeric()).map(|b| b.to_ascii_lowercase() as char).collect()
}

/// Whether a column of this name numbers the points, or classes of them: it must not pass for a coordinate where no column is named x.
fn is_label(name: &[u8]) -> bool {
    name.is_empty()
        || [
            "id",
            "index",
            "idx",
            "no",
            "nr",
            "number",
            "label",
            "row",
            "fid",
            "objectid",
            "pointid",
            "obs",
            "observation",
            "case",
            "class",
            "type",
            "species",
            "kind",
            "category",
            "group",
            "cluster",
            "mark",
        ]
        .contains(&plain(name).as_str())
}

/// Whether a column of this name tells realizations apart.
fn is_frame(name: &[u8]) -> bool {
    const NAMES: [&str; 25] = [
        "frame",
        "frames",
        "timestep",
        "time",
        "t",
        "step",
        "snapshot",
        "realization",
        "realisation",
        "replicate",
        "replication",
        "rep",
        "batch",
        "run",
        "trial",
        "set",
        "sample",
        "simulation",
        "sim",
        "iteration",
        "iter",
        "image",
        "slice",
        "epoch",
        "experiment",
    ];
    let name = plain(name);
    let bare = ["id", "number", "index", "idx", "no", "nr"].iter().find_map(|end| name.strip_suffix(end));
    NAMES.contains(&name.as_str()) || bare.is_some_and(|bare| NAMES.contains(&bare))
}

/// Whether a column of this name holds degrees.
pub(super) fn is_degrees(name: &str) -> bool {
    let bare = without_unit(name.as_bytes());
    let unit = &name.trim_ascii()[bare.len()..];
    // Those of a thermometer are no angles.
    let of_heat = |unit: &str| unit.ends_with(['c', 'f', 'k']);
    let in_degrees = |unit: &str, plain: &str| (plain.starts_with("deg") || unit.contains('\u{b0}')) && !of_heat(plain);
    if in_degrees(unit, &plain(unit.as_bytes())) {
        return true;
    }
    let name = plain(bare);
    ["longitude", "latitude"].iter().any(|word| name.contains(word))
        || ["lon", "lat", "lng", "long", "ra", "dec", "lonwgs84", "latwgs84"].contains(&name.as_str())
        || ["deg", "degree", "degrees"].iter().any(|end| name.ends_with(end))
        || bare.ends_with("\u{b0}".as_bytes())
}

/// Whether the words of a comment are names of columns: they name those that are taken, or places on a globe.
fn are_names(names: &[&[u8]], rows: Rows) -> bool {
    let bare: Vec<&[u8]> = names.iter().map(|name| without_unit(name)).collect();
    let degrees = names.iter().filter(|name| is_degrees(&String::from_utf8_lossy(name))).count();
    let taken = || named_columns(&bare, rows).is_ok_and(|columns| !columns.is_empty());
    bare.iter().all(|name| could_be_name(name)) && (taken() || degrees >= names.len().clamp(1, 2))
}

/// The columns of coordinates that names tell, in the order of the axes: x, y, z of points; m_x, nu_y and the like of wave vectors.
/// None if the first axis is not there; or the name that is there twice.
pub(super) fn named_columns(names: &[&[u8]], rows: Rows) -> Result<Vec<usize>, String> {
    // Other stems are taken as well, so that their unit can be refused by name.
    let stems: &[&str] = match rows {
        Rows::Points => &[""],
        Rows::WaveVectors { per_side: true } => &["m", "nu", "f", "", "k", "q", "omega"],
        Rows::WaveVectors { per_side: false } => &["nu", "f", "m", "", "k", "q", "omega"],
    };
    let called: Vec<String> = match rows {
        Rows::Points => names.iter().map(|name| String::from_utf8_lossy(name).to_lowercase()).collect(),
        Rows::WaveVectors { .. } => names.iter().map(|name| wave_name(name)).collect(),
    };
    for stem in stems {
        let mut columns = Vec::new();
        for axis in ["x", "y", "z"] {
            let wanted = format!("{stem}{axis}");
            let mut named = (0..names.len()).filter(|&k| called[k] == wanted);
            match (named.next(), named.next()) {
                (Some(_), Some(_)) => return Err(wanted),
                (Some(column), None) => columns.push(column),
                (None, _) if axis == "x" => break,
                (None, _) => {}
            }
        }
        if !columns.is_empty() {
            return Ok(columns);
        }
    }
    Ok(Vec::new())
}

/// The name of a frequency in small letters and digits alone.
fn wave_name(name: &[u8]) -> String {
    let name = String::from_utf8_lossy(name).to_lowercase().replace('\u{3bd}', "nu").replace('\u{3c9}', "omega");
    plain(name.as_bytes())
}

//! Text and CSV as people have them: one point per line, numbers separated by blanks, tabs, commas, semicolons or
//! parentheses; an optional header; PSA's leading point count.
//!
//! A `#` starts a comment. A line that is only a comment separates realizations when data stands before and after it,
//! so UTK's files, numpy's `# x y` headers and commented files all read as meant. A row that was put behind a `#` does not.
//!
//! Nothing is repaired: an empty field, a decimal comma that may be something else or a line of another width is an error
//! with its line, because the alternative is a wrong coordinate. What could be meant otherwise is said in a note.

mod headers;
mod lines;
mod rows;

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use encoding_rs::Encoding;

use super::columns::Separator;
use super::{Apart, Columns, MarkedPoints, Reading};
use crate::error::{Error, Result, plural};
pub(super) use headers::Layout;
use headers::one_or_more;
pub(super) use lines::{Lines, number, shown};
pub(crate) use lines::{has_decimal_comma, is_decimal_comma};
use lines::{is_blank, separator_line, split_comment, split_decimals, split_loosely, split_strictly, unquoted};

pub(super) const UTF8_MARK: &[u8] = b"\xef\xbb\xbf";
/// How much of a file decides whether it is text.
const HEAD: usize = 1 << 16;

/// Whether `bytes` look like text: no control characters but white space, and mostly ASCII (a comment may be Latin-1).
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let control = |&b: &u8| b == 0x7f || (b < 0x20 && !matches!(b, b'\t' | b'\n' | 0x0b | 0x0c | b'\r' | 0x1a));
    let foreign = head.iter().filter(|b| !b.is_ascii()).count();
    !head.iter().any(control) && (foreign <= head.len() / 4 || std::str::from_utf8(head).is_ok())
}

/// UTF-16, if `bytes` are text in it, with a mark or without: points are digits, so most pairs of bytes are ASCII and 0.
pub(super) fn utf16(bytes: &[u8]) -> Option<&'static Encoding> {
    let (pairs, _) = bytes[..bytes.len().min(HEAD)].as_chunks::<2>();
    let pairs = match pairs {
        [[0xff, 0xfe] | [0xfe, 0xff], rest @ ..] => rest,
        all => all,
    };
    let plain = |b: u8| matches!(b, b'\t' | b'\n' | b'\r' | b' '..=b'~');
    let little = pairs.iter().filter(|&&[lo, hi]| hi == 0 && plain(lo)).count();
    let big = pairs.iter().filter(|&&[hi, lo]| hi == 0 && plain(lo)).count();
    let encoding = if little > big { encoding_rs::UTF_16LE } else { encoding_rs::UTF_16BE };
    (4 * little.max(big) > 3 * pairs.len()).then_some(encoding)
}

/// Every realization in the text `bytes` of file `name`. `dim` tells a lone leading integer from a point in 1-D.
/// `encoding` is what they were in, if that is worth a word.
pub(super) fn read(
    name: &str,
    bytes: &[u8],
    dim: Option<usize>,
    marks: &Columns,
    encoding: &'static str,
) -> Result<Vec<MarkedPoints>> {
    let mut parser = Parser { encoding, ..Parser::new(name, dim, marks) };
    for (number, line) in (1..).zip(Lines(bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes))) {
        parser.line(number, line)?;
    }
    parser.finish()
}

/// PSA's first line: how many points follow.
#[derive(Clone, Copy)]
struct Announced {
    points: u64,
    line: u64,
}

/// How many of something there were, and the line of the first.
#[derive(Default)]
struct Seen {
    count: u64,
    first: u64,
}

impl Seen {
    fn add(&mut self, line: u64, count: u64) {
        if self.count == 0 {
            self.first = line;
        }
        self.count += count;
    }
}

struct Parser<'a> {
    name: &'a str,
    encoding: &'static str,
    dim: Option<usize>,
    /// Which columns are what.
    marks: &'a Columns,
    sets: Vec<MarkedPoints>,
    layout: Option<Layout>,
    /// The comment lines above the first point, which may name the columns (`# id x y`).
    comments: Vec<Vec<u8>>,
    fields: Vec<Range<usize>>,
    /// `sep=;`
    separator: Option<u8>,
    /// The first lines with a decimal comma and with a decimal point, where both could be.
    decimals: [Option<u64>; 2],
    // The set being read:
    coordinates: Vec<f64>,
    weights: Vec<f64>,
    labels: Vec<String>,
    keys: Vec<u32>,
    lines: Vec<u64>,
    announced: Option<Announced>,
    /// A lone integer whose meaning (a count, or a point in 1-D) the next line decides.
    undecided: Option<Announced>,
    header_seen: bool,
    /// The values of the column that tells realizations apart, in the order of their first points.
    realizations: Vec<String>,
    known: HashMap<Vec<u8>, u32>,
    /// Blank lines, and rows of empty fields, since the last point.
    blank: Seen,
    empty: Seen,
    // What is said of the file:
    blocks: Seen,
    empty_at_end: Seen,
    commented: Seen,
    separators: Seen,
    /// The line of a first point that could number the columns.
    numbering: Option<u64>,
    notes: Vec<String>,
}

impl<'a> Parser<'a> {
    fn new(name: &'a str, dim: Option<usize>, marks: &'a Columns) -> Self {
        Self {
            name,
            encoding: "",
            dim,
            marks,
            sets: Vec::new(),
            layout: None,
            comments: Vec::new(),
            fields: Vec::new(),
            separator: None,
            decimals: [None; 2],
            coordinates: Vec::new(),
            weights: Vec::new(),
            labels: Vec::new(),
            keys: Vec::new(),
            lines: Vec::new(),
            announced: None,
            undecided: None,
            header_seen: false,
            realizations: Vec::new(),
            known: HashMap::new(),
            blank: Seen::default(),
            empty: Seen::default(),
            blocks: Seen::default(),
            empty_at_end: Seen::default(),
            commented: Seen::default(),
            separators: Seen::default(),
            numbering: None,
            notes: Vec::new(),
        }
    }

    fn fail<T>(&self, line: u64, reason: impl Into<String>) -> Result<T> {
        Err(Error::input(format!("{}:{line}", self.name), reason))
    }

    fn line(&mut self, number: u64, line: &[u8]) -> Result<()> {
        if number == 1
            && let Some(separator) = separator_line(line)
        {
            self.separator = Some(separator);
            return Ok(());
        }
        let (content, comment) = split_comment(line);
        let delimiter = self.layout.as_ref().map_or(self.separator, |l| l.delimiter);
        let hole = split_loosely(content, &mut self.fields);
        if self.fields.iter().all(|f| unquoted(&content[f.clone()]).is_empty()) {
            return self.nothing(number, content, comment);
        }
        let at_start = self.lines.is_empty() && self.announced.is_none() && self.undecided.is_none();
        if at_start && !self.header_seen && (self.is_header(content) || self.numbers_columns_beside_index(content)) {
            self.header_seen = true;
            return self.header(number, content);
        }
        // Commas within numbers that semicolons or tabs separate.
        let commas = delimiter.is_none() && split_decimals(content, &mut self.fields);
        if let Some(delimiter) = delimiter {
            split_strictly(content, delimiter, &mut self.fields);
            let width = self.layout.as_ref().map_or(0, |l| l.width);
            while self.fields.len() > width && self.fields.last().is_some_and(Range::is_empty) {
                self.fields.pop();
            }
        } else if hole && !commas && (self.layout.is_some() || !self.marks.any()) {
            return self.fail(number, format!("an empty field in {}", shown(content)));
        } else if at_start && !self.header_seen && self.announcement(number, content) {
            return Ok(());
        }
        self.point(number, content)
    }

    /// A line without a field.
    fn nothing(&mut self, number: u64, content: &[u8], comment: Option<&[u8]>) -> Result<()> {
        if content.iter().any(|&b| !is_blank(b) || Some(b) == self.separator) {
            self.empty.add(number, 1);
            return Ok(());
        }
        let Some(comment) = comment else {
            self.blank.add(number, 1);
            return Ok(());
        };
        if self.is_row(comment) {
            self.commented.add(number, 1);
            return Ok(());
        }
        if !self.lines.is_empty() && self.marks.realization.is_none() {
            self.separators.add(number, 1);
            self.end_set()?;
        }
        // Points in 1-D have no comment after the first; a count may.
        self.announced = self.announced.or(self.undecided.take());
        if self.layout.is_none() {
            self.comments.push(comment.to_vec());
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<MarkedPoints>> {
        let header = self.header_seen && self.lines.is_empty();
        self.end_set()?;
        if self.sets.is_empty() {
            let rows = self.marks.rows.one();
            let reason = match header {
                true => format!("a header but no {rows}s"),
                false => format!("no {rows}s: only blank lines and comments"),
            };
            return Err(Error::input(self.name, reason));
        }
        let column = self.layout.as_ref().and_then(|l| l.marks.realization.map(|k| l.name(k)));
        if let (Some(column), [_]) = (&column, self.sets.as_slice()) {
            let whole = self.sets.remove(0);
            self.sets = whole.apart(&self.keys, &self.realizations, &format!("realization {column}"));
            // A number of the columns has none left.
            self.sets.retain(|set| !set.points.is_empty());
        } else if self.sets.len() > 1 {
            for (k, set) in self.sets.iter_mut().enumerate() {
                set.points.source = format!("{}, realization {k}", self.name);
            }
        }
        let reading = Arc::new(self.reading(column)?);
        self.sets.iter_mut().for_each(|set| set.reading = reading.clone());
        Ok(self.sets)
    }

    /// What is said about the file.
    fn reading(&mut self, column: Option<String>) -> Result<Reading> {
        let mut reading = Reading { notes: std::mem::take(&mut self.notes), ..Reading::default() };
        let Some(layout) = &self.layout else { return Ok(reading) };
        let points: usize = self.sets.iter().map(|set| set.points.len()).sum();
        let one = one_or_more(self.sets.len());
        let name = self.name;
        let mut note = |line: u64, text: String| reading.notes.push(format!("{name}:{line}: {text}"));
        let Seen { count, first } = self.empty_at_end;
        if count > 0 {
            note(first, format!("{} of empty fields left out, after the points", plural(count, "row")));
        }
        let Seen { count, first } = self.commented;
        if count > 0 {
            let rows = plural(count, "row");
            note(first, format!("{rows} behind a # left out; a comment that is a row does not separate realizations"));
        }
        let Seen { count, first } = self.blocks;
        if count > 0 && self.marks.realization.is_none() && 2 * count < points as u64 {
            let blocks = plural(count + 1, "block");
            note(
                first,
                format!(
                    "blank lines leave {blocks} of points, read as {one}; `realization_column` blank-lines makes each block a realization"
                ),
            );
        }
        layout.notes(points, self.sets.len(), self.marks).into_iter().for_each(|text| note(layout.line, text));
        match layout.suspicious(&self.sets, self.marks) {
            Some(Ok(text)) => note(layout.line, text),
            Some(Err(reason)) => return self.fail(layout.line, reason),
            None => {}
        }
        let commas = if self.decimals[0].is_some() { ", decimal commas" } else { "" };
        let header = match layout.header {
            true => format!(", header in line {}", layout.line),
            false => String::new(),
        };
        let rows = if layout.header && layout.width > layout.names.len() && !layout.names.is_empty() {
            ", rows with names"
        } else {
            ""
        };
        let encoding = if self.encoding.is_empty() { String::new() } else { format!(" in {}", self.encoding) };
        reading.format = format!("text{encoding}{header}{rows}{commas}");
        reading.columns = layout.columns.iter().map(|&k| layout.name(k)).collect();
        reading.unused = layout.unused();
        reading.apart = match column {
            Some(column) => Apart::Column(column),
            None if self.marks.realization == Some(Separator::BlankLines) => Apart::BlankLines,
            None if self.sets.len() > 1 => Apart::Comments,
            None => Apart::Files,
        };
        Ok(reading)
    }
}

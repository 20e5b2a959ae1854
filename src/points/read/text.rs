//! Text and CSV as people have them: one point per line, numbers separated by blanks, tabs, commas, semicolons or
//! parentheses; an optional header; PSA's leading point count.
//!
//! A `#` starts a comment. A line that is only a comment separates realizations when data stands before and after it,
//! so UTK's files, numpy's `# x y` headers and commented files all read as meant.
//!
//! Nothing is repaired: an empty field, a decimal comma or a line of another width is an error with its line, because
//! the alternative is a wrong coordinate.

use std::ops::Range;

use super::columns::check_weight;
use super::{Columns, MarkedPoints, Marks, plural};
use crate::error::{Error, Result};
use crate::points::RawPoints;

const UTF8_MARK: &[u8] = b"\xef\xbb\xbf";
/// How much of a file decides whether it is text.
const HEAD: usize = 1 << 16;

/// Whether `bytes` look like text: no control characters but white space, and mostly ASCII (a comment may be Latin-1).
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    let control = |&b: &u8| b == 0x7f || (b < 0x20 && !matches!(b, b'\t' | b'\n' | 0x0b | 0x0c | b'\r' | 0x1a));
    let foreign = head.iter().filter(|b| !b.is_ascii()).count();
    !head.iter().any(control) && (foreign <= head.len() / 4 || std::str::from_utf8(head).is_ok())
}

/// Whether `bytes` are text in UTF-16, with a mark or without: points are digits, so most pairs of bytes are ASCII and 0.
pub(super) fn is_utf16(bytes: &[u8]) -> bool {
    let (pairs, _) = bytes[..bytes.len().min(HEAD)].as_chunks::<2>();
    let pairs = match pairs {
        [[0xff, 0xfe] | [0xfe, 0xff], rest @ ..] => rest,
        all => all,
    };
    let plain = |b: u8| matches!(b, b'\t' | b'\n' | b'\r' | b' '..=b'~');
    let little = pairs.iter().filter(|&&[lo, hi]| hi == 0 && plain(lo)).count();
    let big = pairs.iter().filter(|&&[hi, lo]| hi == 0 && plain(lo)).count();
    4 * little.max(big) > 3 * pairs.len()
}

/// Every realization in the text `bytes` of file `name`. `dim` tells a lone leading integer from a point in 1-D.
pub(super) fn read(name: &str, bytes: &[u8], dim: Option<usize>, marks: &Columns) -> Result<Vec<MarkedPoints>> {
    let mut parser = Parser::new(name, dim, marks);
    for (number, line) in (1..).zip(Lines(bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes))) {
        parser.line(number, line)?;
    }
    parser.finish()
}

/// Lines ended by `\n`, `\r\n` or a lone `\r`.
struct Lines<'a>(&'a [u8]);

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.0.is_empty() {
            return None;
        }
        let end = self.0.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.0.len());
        let (line, rest) = self.0.split_at(end);
        let ending = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
        self.0 = &rest[ending..];
        Some(line)
    }
}

/// What the lines of a file look like, known from its header or from its first point.
struct Layout {
    /// Fields per line.
    width: usize,
    /// Which fields are x, y, z.
    columns: Vec<usize>,
    /// Which are the weight and the class.
    marks: Marks,
    /// `None`: any separator. Otherwise the one of the header, because other columns may hold blanks or nothing.
    delimiter: Option<u8>,
    /// The line it was learned from.
    line: u64,
}

/// PSA's first line: how many points follow.
#[derive(Clone, Copy)]
struct Announced {
    points: u64,
    line: u64,
}

struct Parser<'a> {
    name: &'a str,
    dim: Option<usize>,
    /// Which columns are no coordinates.
    marks: &'a Columns,
    sets: Vec<MarkedPoints>,
    layout: Option<Layout>,
    /// The last comment line, which may name the columns (`# id x y`).
    comment: Vec<u8>,
    fields: Vec<Range<usize>>,
    // The set being read:
    coordinates: Vec<f64>,
    weights: Vec<f64>,
    labels: Vec<String>,
    lines: Vec<u64>,
    announced: Option<Announced>,
    /// A lone integer whose meaning (a count, or a point in 1-D) the next line decides.
    undecided: Option<Announced>,
    header_seen: bool,
}

impl<'a> Parser<'a> {
    fn new(name: &'a str, dim: Option<usize>, marks: &'a Columns) -> Self {
        Self {
            name,
            dim,
            marks,
            sets: Vec::new(),
            layout: None,
            comment: Vec::new(),
            fields: Vec::new(),
            coordinates: Vec::new(),
            weights: Vec::new(),
            labels: Vec::new(),
            lines: Vec::new(),
            announced: None,
            undecided: None,
            header_seen: false,
        }
    }

    fn fail<T>(&self, line: u64, reason: impl Into<String>) -> Result<T> {
        Err(Error::input(format!("{}:{line}", self.name), reason))
    }

    fn line(&mut self, number: u64, line: &[u8]) -> Result<()> {
        let (content, comment) = split_comment(line);
        let delimiter = self.layout.as_ref().and_then(|l| l.delimiter);
        let hole = split_loosely(content, &mut self.fields);
        if self.fields.is_empty() {
            if let Some(comment) = comment {
                if !self.lines.is_empty() {
                    self.end_set()?;
                }
                // Points in 1-D have no comment after the first; a count may.
                self.announced = self.announced.or(self.undecided.take());
                self.comment = comment.to_vec();
            }
            return Ok(());
        }
        let at_start = self.lines.is_empty() && self.announced.is_none() && self.undecided.is_none();
        if at_start && !self.header_seen && self.fields.iter().all(|f| could_be_name(&content[f.clone()])) {
            self.header_seen = true;
            return self.header(number, content);
        }
        if let Some(delimiter) = delimiter {
            split_strictly(content, delimiter, &mut self.fields);
            let width = self.layout.as_ref().map_or(0, |l| l.width);
            while self.fields.len() > width && self.fields.last().is_some_and(Range::is_empty) {
                self.fields.pop();
            }
        } else if hole {
            return self.fail(number, format!("an empty field in {}", shown(content)));
        } else if at_start && !self.header_seen && self.announcement(number, content) {
            return Ok(());
        }
        self.point(number, content)
    }

    /// Takes a lone integer on the first line of a set for PSA's point count, unless points are known to be 1-D.
    fn announcement(&mut self, line: u64, content: &[u8]) -> bool {
        let width = self.layout.as_ref().map(|l| l.width).or(self.dim);
        let [field] = self.fields.as_slice() else { return false };
        let Ok(text) = std::str::from_utf8(&content[field.clone()]) else { return false };
        let Ok(points) = text.parse() else { return false };
        let announced = Some(Announced { points, line });
        match width {
            Some(1) => return false,
            Some(_) => self.announced = announced,
            None => self.undecided = announced,
        }
        true
    }

    fn header(&mut self, line: u64, content: &[u8]) -> Result<()> {
        let delimiter = [b';', b',', b'\t'].into_iter().find(|d| content.contains(d));
        let mut fields = Vec::new();
        match delimiter {
            Some(delimiter) => split_strictly(content, delimiter, &mut fields),
            None => _ = split_loosely(content, &mut fields),
        }
        while fields.last().is_some_and(Range::is_empty) {
            fields.pop();
        }
        let names: Vec<&[u8]> = fields.iter().map(|f| unquoted(&content[f.clone()])).collect();
        let columns = match named_columns(&names) {
            Ok(columns) => columns,
            Err(twice) => return self.fail(line, format!("two columns are named {twice}")),
        };
        let width = names.len();
        let marks = match self.marks.find(width, &names) {
            Ok(marks) => marks,
            Err(reason) => return self.fail(line, reason),
        };
        if let Some(twice) = columns.iter().find(|&&k| marks.contain(k)) {
            return self.fail(line, format!("column {} is a coordinate, not a weight or a class", twice + 1));
        }
        let only_coordinates = (columns.is_empty() && self.marks.count() == 0) || columns.len() == width;
        if columns.is_empty() && width > 3 + self.marks.count() {
            let reason = format!("{width} columns, none named x; expected columns named x, y[, z], or 1 to 3 columns");
            return self.fail(line, format!("{reason}, in {}", shown(content)));
        }
        if columns.is_empty()
            && let Some((_, label)) = names.iter().enumerate().find(|&(k, n)| is_label(n) && !marks.contain(k))
        {
            let reason = format!("a column named {} and none named x; expected columns named x, y[, z]", shown(label));
            return self.fail(line, reason);
        }
        let columns = if columns.is_empty() { self.coordinates_beside(width, marks, line)? } else { columns };
        if let Some(known) = self.layout.as_ref().filter(|l| l.width != width || l.columns != columns) {
            return self.fail(line, format!("this header differs from the columns of line {}", known.line));
        }
        let delimiter = delimiter.filter(|_| !only_coordinates);
        self.layout = Some(Layout { width, columns, marks, delimiter, line });
        Ok(())
    }

    /// All columns of `width` that are no marks: the coordinates where no header names them.
    fn coordinates_beside(&self, width: usize, marks: Marks, line: u64) -> Result<Vec<usize>> {
        let columns: Vec<usize> = (0..width).filter(|&k| !marks.contain(k)).collect();
        if columns.is_empty() {
            return self.fail(line, "no column is left for coordinates");
        }
        Ok(columns)
    }

    fn point(&mut self, line: u64, content: &[u8]) -> Result<()> {
        if self.layout.is_none() {
            self.layout = Some(self.learn(line, content)?);
        }
        if let Some(first) = self.undecided.take() {
            // The next line has decided: one number per line means that the integer was a point as well.
            if self.fields.len() == 1 {
                self.coordinates.push(first.points as f64);
                self.lines.push(first.line);
            } else {
                self.announced = Some(first);
            }
        }
        let Some(layout) = &self.layout else { return Ok(()) };
        if self.fields.len() != layout.width {
            if has_decimal_comma(content) {
                return self.fail(line, decimal_comma(content));
            }
            let found = plural(self.fields.len() as u64, "field");
            let reason = format!("{found}, expected {} as in line {}: {}", layout.width, layout.line, shown(content));
            return self.fail(line, reason);
        }
        for &column in &layout.columns {
            let field = unquoted(&content[self.fields[column].clone()]);
            match number(field) {
                Some(x) if x.is_finite() => self.coordinates.push(x),
                _ => return self.fail(line, self.not_a_number(field, column)),
            }
        }
        if let Some(column) = layout.marks.weight {
            let field = unquoted(&content[self.fields[column].clone()]);
            let Some(weight) = number(field) else { return self.fail(line, self.not_a_number(field, column)) };
            if let Err(reason) = check_weight(weight) {
                return self.fail(line, reason);
            }
            self.weights.push(weight);
        }
        if let Some(column) = layout.marks.class {
            let field = unquoted(&content[self.fields[column].clone()]);
            if field.is_empty() {
                return self.fail(line, format!("no class in column {}", column + 1));
            }
            // Within quotes a quote is written twice.
            self.labels.push(String::from_utf8_lossy(field).replace("\"\"", "\""));
        }
        self.lines.push(line);
        Ok(())
    }

    fn not_a_number(&self, field: &[u8], column: usize) -> String {
        if is_decimal_comma(field) {
            return decimal_comma(field);
        }
        let what = match number(field) {
            Some(_) => "is not finite",
            None => "is not a number",
        };
        let expected = match &self.layout {
            Some(layout) if layout.columns.len() == layout.width => {
                format!("expected {} per line as in line {}", plural(layout.width as u64, "number"), layout.line)
            }
            Some(layout) => format!("expected a number in column {}, named in line {}", column + 1, layout.line),
            None => "expected 1, 2 or 3 numbers per line".to_owned(),
        };
        format!("{} {what}; {expected}", shown(field))
    }

    /// The layout of a file without header, from its first point.
    fn learn(&self, line: u64, content: &[u8]) -> Result<Layout> {
        if has_decimal_comma(content) {
            return self.fail(line, decimal_comma(content));
        }
        let width = self.fields.len();
        let mut fields = Vec::new();
        split_loosely(&self.comment, &mut fields);
        let names: Vec<&[u8]> = fields.iter().map(|f| unquoted(&self.comment[f.clone()])).collect();
        let names = if names.len() == width { names } else { Vec::new() };
        let marks = match self.marks.find(width, &names) {
            Ok(marks) => marks,
            Err(reason) => return self.fail(line, reason),
        };
        let columns = match named_columns(&names) {
            Ok(columns) if !columns.is_empty() && !columns.iter().any(|&k| marks.contain(k)) => columns,
            _ => self.coordinates_beside(width, marks, line)?,
        };
        if columns.len() > 3 {
            // Text in the first line is the likelier mistake.
            let text = self.fields.iter().map(|f| &content[f.clone()]).find(|f| number(unquoted(f)).is_none());
            let reason = match text {
                Some(text) => format!("{} is not a number; expected 1, 2 or 3 numbers per line", shown(text)),
                None => format!(
                    "{width} numbers in a line, expected 1, 2 or 3, or a header that names columns x, y[, z]: {}",
                    shown(content)
                ),
            };
            return self.fail(line, reason);
        }
        Ok(Layout { width, columns, marks, delimiter: None, line })
    }

    fn end_set(&mut self) -> Result<()> {
        let found = self.lines.len() as u64;
        if let Some(announced) = self.announced.take().or(self.undecided.take())
            && announced.points != found
        {
            let reason = format!("announces {}, found {found}", plural(announced.points, self.marks.rows.one()));
            return self.fail(announced.line, reason);
        }
        self.header_seen = false;
        if found > 0 {
            let dim = self.layout.as_ref().map_or(1, |l| l.columns.len());
            let coordinates = std::mem::take(&mut self.coordinates);
            let lines = std::mem::take(&mut self.lines);
            self.sets.push(MarkedPoints {
                points: RawPoints { dim, coordinates, source: self.name.to_owned(), lines },
                weights: std::mem::take(&mut self.weights),
                labels: std::mem::take(&mut self.labels),
            });
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
        if self.sets.len() > 1 {
            for (k, set) in self.sets.iter_mut().enumerate() {
                set.points.source = format!("{}, realization {k}", self.name);
            }
        }
        Ok(self.sets)
    }
}

/// The line before its first `#` outside quotes, and what follows that `#`.
fn split_comment(line: &[u8]) -> (&[u8], Option<&[u8]>) {
    let mut quoted = false;
    let start = line.iter().position(|&b| {
        quoted ^= b == b'"';
        b == b'#' && !quoted
    });
    match start {
        Some(start) => (&line[..start], Some(&line[start + 1..])),
        None => (line, None),
    }
}

fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | 0x0b | 0x0c | 0x1a | b'(' | b')')
}

/// Fields between blanks, tabs, parentheses, commas and semicolons. Returns whether a field is missing: a comma or
/// semicolon before the first field, or two of them between fields.
fn split_loosely(content: &[u8], fields: &mut Vec<Range<usize>>) -> bool {
    fields.clear();
    let (mut marks, mut hole, mut at) = (1, false, 0);
    while at < content.len() {
        let b = content[at];
        if is_blank(b) {
            at += 1;
        } else if b == b',' || b == b';' {
            marks += 1;
            at += 1;
        } else {
            let start = at;
            if b == b'"' {
                at += 1;
                while at < content.len() && content[at] != b'"' {
                    at += 1;
                }
            }
            while at < content.len() && !is_blank(content[at]) && content[at] != b',' && content[at] != b';' {
                at += 1;
            }
            hole |= marks > 1;
            marks = 0;
            fields.push(start..at);
        }
    }
    hole
}

/// Fields between `delimiter`s outside quotes, trimmed; empty ones included.
fn split_strictly(content: &[u8], delimiter: u8, fields: &mut Vec<Range<usize>>) {
    fields.clear();
    let (mut quoted, mut start) = (false, 0);
    for at in 0..=content.len() {
        let b = content.get(at).copied();
        quoted ^= b == Some(b'"');
        if b.is_none() || (b == Some(delimiter) && !quoted) {
            let blanks = |part: &[u8]| part.iter().take_while(|b| b.is_ascii_whitespace()).count();
            let first = start + blanks(&content[start..at]);
            let trailing = content[first..at].iter().rev().take_while(|b| b.is_ascii_whitespace()).count();
            fields.push(first..at - trailing);
            start = at + 1;
        }
    }
}

fn unquoted(field: &[u8]) -> &[u8] {
    field.strip_prefix(b"\"").and_then(|f| f.strip_suffix(b"\"")).unwrap_or(field).trim_ascii()
}

/// A number as Rust, C, Python or Fortran (`1.5d-3`) write it, rounded to nearest. Also `nan` and `inf`, so that the
/// message can tell them from text.
fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let fortran = || text.contains(['d', 'D']).then(|| text.replace(['d', 'D'], "e").parse().ok()).flatten();
    text.parse().ok().or_else(fortran)
}

/// Whether `field` can stand in a header: text that is not a number and not a word for a missing one.
fn could_be_name(field: &[u8]) -> bool {
    let name = unquoted(field);
    let missing = [b"na".as_slice(), b"n/a", b"null", b"none"].iter().any(|word| name.eq_ignore_ascii_case(word));
    let start = name.first().is_none_or(|&b| b.is_ascii_alphabetic() || b == b'_' || !b.is_ascii());
    start && !missing && number(name).is_none()
}

/// Whether a column of this name numbers the points: it must not pass for a coordinate where no column is named x.
fn is_label(name: &[u8]) -> bool {
    [b"".as_slice(), b"id", b"index", b"no"].iter().any(|label| name.eq_ignore_ascii_case(label))
}

/// The columns named x, y, z among `names`, none if there is no x; or the name that is there twice.
fn named_columns(names: &[&[u8]]) -> Result<Vec<usize>, &'static str> {
    let mut columns = Vec::new();
    for axis in ["x", "y", "z"] {
        let mut named = (0..names.len()).filter(|&i| names[i].eq_ignore_ascii_case(axis.as_bytes()));
        match (named.next(), named.next()) {
            (Some(_), Some(_)) => return Err(axis),
            (Some(column), None) => columns.push(column),
            (None, _) if axis == "x" => return Ok(columns),
            (None, _) => {}
        }
    }
    Ok(columns)
}

/// `-0,25`: digits, a comma, digits and perhaps an exponent.
fn is_decimal_comma(field: &[u8]) -> bool {
    let field = field.strip_prefix(b"-").or(field.strip_prefix(b"+")).unwrap_or(field);
    let mut halves = field.splitn(2, |&b| b == b',');
    let (Some(whole), Some(rest)) = (halves.next(), halves.next()) else { return false };
    let digits = rest.iter().take_while(|b| b.is_ascii_digit()).count();
    let exponent = &rest[digits..];
    let has_exponent = matches!(exponent.first(), Some(b'e' | b'E' | b'd' | b'D')) && !exponent.contains(&b',');
    !whole.is_empty() && whole.iter().all(u8::is_ascii_digit) && digits > 0 && (exponent.is_empty() || has_exponent)
}

/// Whether commas stand inside numbers that something else separates, as in `0,5;0,25` and `0,5 0,25`.
fn has_decimal_comma(content: &[u8]) -> bool {
    if !content.contains(&b',') {
        return false;
    }
    let semicolon = content.contains(&b';');
    let separator = |&b: &u8| if semicolon { b == b';' } else { is_blank(b) };
    let fields = content.split(separator).map(|f| f.trim_ascii_start().trim_ascii_end()).filter(|f| !f.is_empty());
    let (mut count, mut decimal) = (0, false);
    for field in fields {
        count += 1;
        decimal |= is_decimal_comma(field);
    }
    count > 1 && decimal
}

fn decimal_comma(content: &[u8]) -> String {
    format!("decimal comma in {}; write numbers with a point, as 0.5", shown(content))
}

/// `content` for a message: quoted, shortened, without control characters.
fn shown(content: &[u8]) -> String {
    const LONGEST: usize = 40;
    let content = content.trim_ascii();
    let text = String::from_utf8_lossy(&content[..content.len().min(4 * LONGEST)]);
    let mut short: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > LONGEST {
        short.push_str("...");
    }
    format!("\"{short}\"")
}

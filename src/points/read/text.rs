//! Text and CSV as people have them: one point per line, numbers separated by blanks, tabs, commas, semicolons or
//! parentheses; an optional header; PSA's leading point count.
//!
//! A `#` starts a comment. A line that is only a comment separates realizations when data stands before and after it,
//! so UTK's files, numpy's `# x y` headers and commented files all read as meant. A row that was put behind a `#` does not.
//!
//! Nothing is repaired: an empty field, a decimal comma that may be something else or a line of another width is an error
//! with its line, because the alternative is a wrong coordinate. What could be meant otherwise is said in a note.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use encoding_rs::Encoding;

use super::columns::{Separator, check_weight, without_unit};
use super::{Apart, Columns, MarkedPoints, Marks, Reading, Rows, plural};
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

/// Lines ended by `\n`, `\r\n` or a lone `\r`.
pub(super) struct Lines<'a>(pub(super) &'a [u8]);

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
    /// Which are something else.
    marks: Marks,
    /// `None`: any separator. Otherwise the one of the header, because other columns may hold blanks or nothing.
    delimiter: Option<u8>,
    /// The line it was learned from.
    line: u64,
    /// The names of the columns, if there are any.
    names: Vec<String>,
    /// Whether a header names them, which may be one name short.
    header: bool,
    /// A column that is not used and could tell realizations apart, with its values.
    frames: Option<(usize, HashSet<Vec<u8>>)>,
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
    /// The last comment line, which may name the columns (`# id x y`).
    comment: Vec<u8>,
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
            comment: Vec::new(),
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
        self.comment = comment.to_vec();
        Ok(())
    }

    /// Whether a comment is a row like those that are no comments.
    fn is_row(&self, comment: &[u8]) -> bool {
        let Some(layout) = &self.layout else { return false };
        let start = comment.iter().position(|&b| b != b'#').unwrap_or(comment.len());
        let comment = &comment[start..];
        let mut fields = Vec::new();
        match layout.delimiter {
            Some(delimiter) => split_strictly(comment, delimiter, &mut fields),
            None => _ = split_decimals(comment, &mut fields) || split_loosely(comment, &mut fields),
        }
        if fields.len() < layout.width {
            return false;
        }
        let mut values = Vec::new();
        for &column in &layout.columns {
            let field = unquoted(&comment[fields[column].clone()]);
            let word = field.split(u8::is_ascii_whitespace).next().unwrap_or_default();
            match number(word).or_else(|| decimal_comma_number(word)).filter(|x| x.is_finite()) {
                Some(value) => values.push(value),
                None => return false,
            }
        }
        // Whole numbers among others are the number of a set, or its size.
        let whole = |values: &[f64]| values.iter().all(|x| x.fract() == 0.0);
        !whole(&values) || (values.len() > 1 && !self.coordinates.is_empty() && whole(&self.coordinates))
    }

    /// Whether a first line names columns.
    fn is_header(&self, content: &[u8]) -> bool {
        let (content, fields, _) = header_fields(content, self.separator);
        let named = |f: &Range<usize>| could_be_name(&content[f.clone()]);
        fields.iter().all(named) && fields.iter().any(|f| !f.is_empty())
    }

    /// `,0,1`: as pandas numbers columns beside an index.
    fn numbers_columns_beside_index(&self, content: &[u8]) -> bool {
        let (content, fields, _) = header_fields(content, self.separator);
        let names: Vec<&[u8]> = fields.iter().map(|f| unquoted(&content[f.clone()])).collect();
        names.len() > 1 && names[0].is_empty() && names[1] == b"0" && numbers_columns(&names[1..])
    }

    /// Takes a lone integer on the first line of a set for PSA's point count, unless points are known to be 1-D.
    fn announcement(&mut self, line: u64, content: &[u8]) -> bool {
        let width = self.layout.as_ref().map(|l| l.width).or(self.dim.map(|dim| dim + self.marks.count()));
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
        let (content, fields, delimiter) = header_fields(content, self.separator);
        let names: Vec<&[u8]> = fields.iter().map(|f| unquoted(&content[f.clone()])).collect();
        let mut layout = match self.named(&names, line) {
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

    /// What columns of these names hold.
    fn named(&self, names: &[&[u8]], line: u64) -> Result<Layout, String> {
        let width = names.len();
        let marks = self.marks.find(width, names)?;
        let bare: Vec<&[u8]> = names.iter().map(|name| without_unit(name)).collect();
        let by_flag = self.marks.rows == Rows::Points;
        let flag = if by_flag { "; `columns` names others" } else { "" };
        let columns = if !marks.coordinates.is_empty() {
            marks.coordinates.clone()
        } else {
            let named = named_columns(&bare).map_err(|twice| format!("two columns are named {twice}{flag}"))?;
            if let Some(twice) = named.iter().find(|&&k| marks.contain(k)) {
                return Err(format!("column {} is a coordinate, not a weight or a class{flag}", twice + 1));
            }
            let others: Vec<usize> = (0..width).filter(|&k| !marks.contain(k)).collect();
            if !named.is_empty() {
                named
            } else if others.len() > 3 {
                let all = names.iter().map(|n| String::from_utf8_lossy(n)).collect::<Vec<_>>().join(",");
                let choose = if by_flag { ", or `columns` with the names of those meant" } else { "" };
                return Err(format!(
                    "{width} columns, none named x; expected columns named x, y[, z], or 1 to 3 columns{choose}, in {}",
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
                            "a column named {} and none named x; expected columns named x, y[, z]{choose}",
                            shown(names[label])
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
        Ok(Layout { width, columns, marks, delimiter: None, line, names, header: true, frames })
    }

    /// All columns of `width` that are no marks: the coordinates where no header names them.
    fn coordinates_beside(&self, width: usize, marks: &Marks, line: u64) -> Result<Vec<usize>> {
        let columns = marks.coordinates(width);
        if columns.is_empty() {
            return self.fail(line, "no column is left for coordinates");
        }
        Ok(columns)
    }

    /// A header that is one name short of the first row: the rows have names, as R writes them.
    fn take_row_names(&mut self, content: &[u8], line: u64) -> Result<()> {
        let Some(layout) = self.layout.as_ref().filter(|l| l.header && self.sets.is_empty() && self.lines.is_empty())
        else {
            return Ok(());
        };
        let first = &content[self.fields.first().cloned().unwrap_or_default()];
        let text = number(unquoted(first)).is_none();
        let whole = unquoted(first).iter().all(u8::is_ascii_digit);
        if self.fields.len() != layout.names.len() + 1 || layout.width != layout.names.len() || !(text || whole) {
            return Ok(());
        }
        let names: Vec<Vec<u8>> =
            [Vec::new()].into_iter().chain(layout.names.iter().map(|n| n.clone().into())).collect();
        let names: Vec<&[u8]> = names.iter().map(Vec::as_slice).collect();
        let marks = match self.marks.find(names.len(), &names) {
            Ok(marks) => marks,
            Err(reason) => return self.fail(line, reason),
        };
        if let Some(layout) = &mut self.layout {
            layout.width += 1;
            layout.columns = match marks.coordinates.is_empty() {
                true => layout.columns.iter().map(|k| k + 1).collect(),
                false => marks.coordinates.clone(),
            };
            layout.marks = marks;
            layout.frames = layout.frames.take().map(|(k, values)| (k + 1, values));
        }
        Ok(())
    }

    fn point(&mut self, line: u64, content: &[u8]) -> Result<()> {
        if self.empty.count > 0 && (!self.lines.is_empty() || !self.sets.is_empty() || self.header_seen) {
            let reason = "a row of empty fields with points after it; fill it in, or delete it";
            return self.fail(self.empty.first, reason);
        }
        self.between_blocks()?;
        if self.layout.is_none() {
            self.layout = Some(self.learn(line, content)?);
        }
        self.take_row_names(content, line)?;
        if let Some(first) = self.undecided.take() {
            // The next line has decided: one number per line means that the integer was a point as well.
            if self.fields.len() == 1 {
                self.coordinates.push(first.points as f64);
                self.lines.push(first.line);
                if first.points == 0 {
                    self.numbering = Some(first.line);
                }
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
        // Commas that separate fields are none within a number.
        let may_comma = content.contains(&b';') || content.contains(&b'\t');
        let may_comma = may_comma && layout.delimiter != Some(b',');
        let mut decimals = [false; 2];
        let mut value = |field: &[u8]| {
            let comma = if may_comma { decimal_comma_number(field) } else { None };
            decimals[0] |= comma.is_some();
            decimals[1] |= field.contains(&b'.');
            comma.or_else(|| number(field))
        };
        for &column in &layout.columns {
            let field = unquoted(&content[self.fields[column].clone()]);
            match value(field) {
                Some(x) if x.is_finite() => self.coordinates.push(x),
                _ => return self.fail(line, self.not_a_number(field, column)),
            }
        }
        if let Some(column) = layout.marks.weight {
            let field = unquoted(&content[self.fields[column].clone()]);
            let Some(weight) = value(field) else { return self.fail(line, self.not_a_number(field, column)) };
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
        if let Some(column) = layout.marks.realization {
            let field = unquoted(&content[self.fields[column].clone()]);
            if field.is_empty() {
                return self.fail(line, format!("no realization in column {}", column + 1));
            }
            let next = self.realizations.len() as u32;
            let key = *self.known.entry(field.to_vec()).or_insert(next);
            if key == next {
                self.realizations.push(String::from_utf8_lossy(field).into_owned());
            }
            self.keys.push(key);
        }
        for (seen, here) in self.decimals.iter_mut().zip(decimals) {
            *seen = seen.or(here.then_some(line));
        }
        if may_comma && let [Some(comma), Some(point)] = self.decimals {
            let reason =
                format!("decimal commas (line {comma}) and decimal points (line {point}) in one file; write points");
            return self.fail(line, reason);
        }
        if let Some((column, values)) = self.layout.as_mut().and_then(|l| l.frames.as_mut()) {
            let field = &content[self.fields[*column].clone()];
            if values.len() < MOST_FRAMES && !values.contains(field) {
                values.insert(field.to_vec());
            }
        }
        if self.lines.is_empty() && self.sets.is_empty() && !self.header_seen && self.fields.len() > 1 {
            let names: Vec<&[u8]> = self.fields.iter().map(|f| unquoted(&content[f.clone()])).collect();
            self.numbering = numbers_columns(&names).then_some(line);
        }
        self.lines.push(line);
        Ok(())
    }

    /// What blank lines before a point mean.
    fn between_blocks(&mut self) -> Result<()> {
        if self.blank.count > 0 && !self.lines.is_empty() {
            self.blocks.add(self.blank.first, 1);
            if self.marks.realization == Some(Separator::BlankLines) {
                self.end_set()?;
            }
        }
        self.blank = Seen::default();
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
            Some(layout) if layout.names.is_empty() => format!("expected a number in column {}", column + 1),
            Some(layout) => format!("expected a number in column {}, named in line {}", column + 1, layout.line),
            None => "expected 1, 2 or 3 numbers per line".to_owned(),
        };
        format!("{} {what}; {expected}", shown(field))
    }

    /// The layout of a file without header, from its first point.
    fn learn(&mut self, line: u64, content: &[u8]) -> Result<Layout> {
        // Where columns are chosen, the others may hold blanks or nothing.
        let delimiter = if self.marks.any() && self.separator.is_none() { delimiter(content) } else { self.separator };
        if let Some(delimiter) = delimiter {
            split_strictly(content, delimiter, &mut self.fields);
        } else if has_decimal_comma(content) && !split_decimals(content, &mut self.fields) {
            return self.fail(line, decimal_comma(content));
        }
        let width = self.fields.len();
        let (comment, fields, _) = header_fields(&self.comment, None);
        let names: Vec<&[u8]> = fields.iter().map(|f| unquoted(&comment[f.clone()])).collect();
        let names = if names.len() == width { names } else { Vec::new() };
        let marks = match self.marks.find(width, &names) {
            Ok(marks) => marks,
            Err(reason) => return self.fail(line, reason),
        };
        let bare: Vec<&[u8]> = names.iter().map(|name| without_unit(name)).collect();
        let columns = match named_columns(&bare) {
            _ if !marks.coordinates.is_empty() => marks.coordinates.clone(),
            Ok(columns) if !columns.is_empty() && !columns.iter().any(|&k| marks.contain(k)) => columns,
            _ => self.coordinates_beside(width, &marks, line)?,
        };
        if columns.len() > 3 {
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
        // Names are names if they name what was taken.
        let meant = bare.iter().all(|name| could_be_name(name)) && named_columns(&bare).is_ok_and(|c| !c.is_empty());
        let names = names.iter().filter(|_| meant).map(|n| String::from_utf8_lossy(n).into_owned()).collect();
        Ok(Layout { width, columns, marks, delimiter, line, names, header: false, frames })
    }

    fn end_set(&mut self) -> Result<()> {
        if self.empty.count > 0 {
            self.empty_at_end.add(self.empty.first, self.empty.count);
            self.empty = Seen::default();
        }
        self.blank = Seen::default();
        let found = self.lines.len() as u64;
        if let Some(announced) = self.announced.take().or(self.undecided.take())
            && announced.points != found
        {
            let reason = format!("announces {}, found {found}", plural(announced.points, self.marks.rows.one()));
            return self.fail(announced.line, reason);
        }
        self.header_seen = false;
        if found > 0 {
            self.decide_numbering()?;
            let dim = self.layout.as_ref().map_or(1, |l| l.columns.len());
            let coordinates = std::mem::take(&mut self.coordinates);
            let lines = std::mem::take(&mut self.lines);
            self.sets.push(MarkedPoints {
                points: RawPoints { dim, coordinates, source: self.name.to_owned(), lines },
                weights: std::mem::take(&mut self.weights),
                labels: std::mem::take(&mut self.labels),
                reading: Arc::default(),
            });
        }
        Ok(())
    }

    /// Whether a first line such as `0,1` numbers the columns or is a point: it is none where hardly any other coordinate is
    /// a whole number.
    fn decide_numbering(&mut self) -> Result<()> {
        let Some(line) = self.numbering.take() else { return Ok(()) };
        let Some(layout) = &mut self.layout else { return Ok(()) };
        let dim = layout.columns.len();
        let others = &self.coordinates[dim..];
        let whole = others.iter().filter(|x| x.fract() == 0.0).count();
        let said: Vec<String> = self.coordinates[..dim].iter().map(f64::to_string).collect();
        let as_point = said.iter().map(|k| format!("{k}.0")).collect::<Vec<_>>().join(",");
        let said = said.join(",");
        if others.is_empty() || (layout.width == 1 && whole == others.len()) {
            return Ok(());
        }
        let header = layout.width > 1 && 10 * whole <= others.len();
        if self.marks.rows == Rows::WaveVectors {
            let reason = format!(
                "line {line}, {said}, may number the columns or be a wave vector; delete it, or write 0.0 for 0"
            );
            return if header { self.fail(line, reason) } else { Ok(()) };
        }
        let note = if header {
            layout.header = true;
            self.coordinates.drain(..dim);
            self.lines.remove(0);
            self.weights.drain(..1.min(self.weights.len()));
            self.labels.drain(..1.min(self.labels.len()));
            // The value of the header's own is nobody's realization.
            if !self.keys.is_empty() {
                self.keys.remove(0);
            }
            format!("was taken for the numbers of the columns, not for a point; written as {as_point} it is a point")
        } else {
            "was taken for a point; if it numbers the columns, delete it or write x,y".into()
        };
        self.notes.push(format!("{}:{line}: the first line, {said}, {note}", self.name));
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
        let one = match self.sets.len() {
            1 => "one realization".to_string(),
            k => format!("{k} realizations"),
        };
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
        if let Some((column, values)) = layout.frames.as_ref().filter(|_| self.marks.realization.is_none()) {
            let (column, values) = (layout.name(*column), values.len());
            if values > 1 && values < points {
                let many = if values < MOST_FRAMES { values.to_string() } else { format!("more than {values}") };
                note(
                    layout.line,
                    format!(
                        "column {column} has {many} values and was not used: {points} points are {one}; `realization_column` {column} makes each value one"
                    ),
                );
            }
        }
        if let Some(k) = layout.columns.iter().find(|&&k| layout.names.get(k).is_some_and(|n| is_degrees(n))) {
            note(
                layout.line,
                format!(
                    "column {} holds degrees by its name; distances in degrees differ with direction and latitude: convert to metres first (UTM or another projection)",
                    layout.name(*k)
                ),
            );
        }
        let chosen = !self.marks.coordinates.is_empty();
        if !chosen
            && self.marks.rows == Rows::Points
            && let Some(found) = super::suspicious(&self.sets, |k| {
                let column = layout.columns[k];
                let named_axis = layout.names.get(column).is_some_and(|n| {
                    named_columns(&[without_unit(n.as_bytes())]).is_ok_and(|c| !c.is_empty())
                        || ["y", "z"].iter().any(|a| n.eq_ignore_ascii_case(a))
                });
                (!named_axis).then(|| layout.name(column))
            })
        {
            match found {
                Ok(text) => note(layout.line, text),
                Err(reason) => return self.fail(layout.line, reason),
            }
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
        let unused = |k: &usize| !layout.columns.contains(k) && !layout.marks.contain(*k);
        reading.unused = (0..layout.width).filter(unused).map(|k| layout.name(k)).collect();
        reading.apart = match column {
            Some(column) => Apart::Column(column),
            None if self.marks.realization == Some(Separator::BlankLines) => Apart::BlankLines,
            None if self.sets.len() > 1 => Apart::Comments,
            None => Apart::Files,
        };
        Ok(reading)
    }
}

/// Of a column that could tell realizations apart so many values are looked at.
const MOST_FRAMES: usize = 1 << 16;

impl Layout {
    /// The name of a column, or its number from 1.
    fn name(&self, k: usize) -> String {
        // A header may be one name short.
        let name = (k + self.names.len()).checked_sub(self.width).and_then(|k| self.names.get(k));
        name.filter(|n| !n.is_empty()).cloned().unwrap_or_else(|| (k + 1).to_string())
    }

    /// Whether a header of so many names says the same as the first one.
    fn is_named_so(&self, names: usize, columns: &[usize]) -> bool {
        let known = if self.names.is_empty() { self.width } else { self.names.len() };
        let short = self.width - known;
        known == names && self.columns.iter().copied().eq(columns.iter().map(|k| k + short))
    }
}

/// The separator that the first line of a file for Excel sets: `sep=;`.
fn separator_line(line: &[u8]) -> Option<u8> {
    let line = unquoted(line.trim_ascii());
    match line.get(..4)?.eq_ignore_ascii_case(b"sep=") {
        true => match &line[4..] {
            [one @ (b',' | b';' | b'|' | b':')] => Some(*one),
            // White space at the end of the line was trimmed.
            [] | b"\\t" => Some(b'\t'),
            _ => None,
        },
        false => None,
    }
}

/// What separates the fields of a header, where something other than blanks does.
fn delimiter(content: &[u8]) -> Option<u8> {
    let mut quoted = false;
    let outside: Vec<u8> = content
        .iter()
        .copied()
        .filter(|&b| {
            quoted ^= b == b'"';
            !quoted
        })
        .collect();
    [b';', b',', b'\t'].into_iter().find(|d| outside.contains(d))
}

/// The fields of a header, without the empty ones at its end, and what separates them. Units in brackets or parentheses are no
/// fields of their own where blanks separate.
fn header_fields(content: &[u8], separator: Option<u8>) -> (std::borrow::Cow<'_, [u8]>, Vec<Range<usize>>, Option<u8>) {
    let mut fields = Vec::new();
    let delimiter = separator.or_else(|| delimiter(content));
    let content = match delimiter {
        Some(delimiter) => {
            split_strictly(content, delimiter, &mut fields);
            std::borrow::Cow::Borrowed(content)
        }
        None => {
            let content = without_units(content);
            split_loosely(&content, &mut fields);
            std::borrow::Cow::Owned(content)
        }
    };
    while fields.last().is_some_and(Range::is_empty) {
        fields.pop();
    }
    (content, fields, delimiter)
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
fn numbers_columns(names: &[&[u8]]) -> bool {
    let counts = |from: usize| names.iter().enumerate().all(|(k, name)| *name == (from + k).to_string().as_bytes());
    !names.is_empty() && (counts(0) || counts(1))
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

/// A name in small letters and digits alone.
fn plain(name: &[u8]) -> String {
    name.iter().filter(|b| b.is_ascii_alphanumeric()).map(|b| b.to_ascii_lowercase() as char).collect()
}

/// Whether a column of this name numbers the points: it must not pass for a coordinate where no column is named x.
fn is_label(name: &[u8]) -> bool {
    name.is_empty()
        || ["id", "index", "idx", "no", "nr", "number", "label", "row", "fid", "objectid", "pointid"]
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
fn is_degrees(name: &str) -> bool {
    let name = plain(name.as_bytes());
    ["longitude", "latitude"].iter().any(|word| name.contains(word))
        || ["lon", "lat", "lng", "long", "ra", "dec", "deg", "londeg", "latdeg", "lonwgs84", "latwgs84"]
            .contains(&name.as_str())
        || name.ends_with("degrees")
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
    format!(
        "decimal comma in {}; write numbers with a point, as 0.5, or separate them by semicolons or tabs",
        shown(content)
    )
}

/// A number with a decimal comma.
fn decimal_comma_number(field: &[u8]) -> Option<f64> {
    if !is_decimal_comma(field) {
        return None;
    }
    let point: Vec<u8> = field.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
    number(&point)
}

/// Fields between semicolons, or tabs where there are none, if they are numbers and one of them has a decimal comma. Where not,
/// `fields` stays as it was.
fn split_decimals(content: &[u8], fields: &mut Vec<Range<usize>>) -> bool {
    let Some(separator) = [b';', b'\t'].into_iter().find(|b| content.contains(b)).filter(|_| content.contains(&b','))
    else {
        return false;
    };
    let mut found = Vec::new();
    split_strictly(content, separator, &mut found);
    while found.last().is_some_and(Range::is_empty) {
        found.pop();
    }
    let field = |f: &Range<usize>| unquoted(&content[f.clone()]);
    let decimal = found.iter().any(|f| is_decimal_comma(field(f)));
    let all = found.iter().all(|f| is_decimal_comma(field(f)) || number(field(f)).is_some());
    if decimal && all {
        *fields = found;
    }
    decimal && all
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

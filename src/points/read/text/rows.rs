//! What a row of points must be, and where a realization ends.

use std::collections::HashSet;
use std::sync::Arc;

use super::super::columns::{Separator, check_weight};
use super::super::{MarkedPoints, Rows};
use super::headers::numbers_columns;
use super::lines::{
    decimal_comma, decimal_comma_number, has_decimal_comma, is_decimal_comma, number, shown, split_decimals,
    split_loosely, split_strictly, unquoted,
};
use super::{Announced, Parser, Seen};
use crate::error::{Result, plural};
use crate::points::RawPoints;

/// Of a column that could tell realizations apart so many values are looked at.
pub(super) const MOST_FRAMES: usize = 1 << 16;

/// The names of the rows of one realization.
pub(super) struct RowNames {
    /// How many there were, as long as they count 1, 2, 3...
    counted: u64,
    /// All of them, once they do not.
    seen: HashSet<Vec<u8>>,
    /// Whether every row may be numbers with decimal commas: digits between commas.
    may_be_commas: bool,
}

impl Default for RowNames {
    fn default() -> Self {
        Self { counted: 0, seen: HashSet::new(), may_be_commas: true }
    }
}

impl RowNames {
    /// Whether a field can name a row: text, or a whole number.
    fn could_be(field: &[u8]) -> bool {
        let name = unquoted(field);
        !name.is_empty() && (number(name).is_none() || name.iter().all(u8::is_ascii_digit)) && !is_decimal_comma(name)
    }

    /// Whether no row had this name before.
    fn is_new(&mut self, field: &[u8]) -> bool {
        let name = unquoted(field);
        if self.seen.is_empty() {
            if name == (self.counted + 1).to_string().as_bytes() {
                self.counted += 1;
                return true;
            }
            self.seen.extend((1..=self.counted).map(|k| k.to_string().into_bytes()));
        }
        self.seen.insert(name.to_vec())
    }
}

impl Parser<'_> {
    /// Whether a comment is a row like those that are no comments.
    pub(super) fn is_row(&self, comment: &[u8]) -> bool {
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

    /// Takes a lone integer on the first line of a set for PSA's point count, unless points are known to be 1-D.
    pub(super) fn announcement(&mut self, line: u64, content: &[u8]) -> bool {
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

    /// A header that is one name short of the first row: the rows have names, as R writes them.
    fn take_row_names(&mut self, content: &[u8], line: u64) -> Result<()> {
        let Some(layout) = self.layout.as_ref().filter(|l| l.header && self.sets.is_empty() && self.lines.is_empty())
        else {
            return Ok(());
        };
        if self.fields.len() != layout.names.len() + 1 || layout.width != layout.names.len() {
            return Ok(());
        }
        let first = &content[self.fields.first().cloned().unwrap_or_default()];
        if !RowNames::could_be(first) {
            return self.fail(line, self.unnamed_column(&format!("{} is not the name of a row", shown(first))));
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
            layout.row_names = Some(RowNames::default());
        }
        Ok(())
    }

    /// Looks at the name of a row: each row has another.
    fn row_name(&mut self, content: &[u8], line: u64) -> Result<()> {
        let layout = self.layout.as_mut().filter(|layout| layout.width == self.fields.len());
        let Some(names) = layout.and_then(|l| l.row_names.as_mut()) else { return Ok(()) };
        let field = &content[self.fields.first().cloned().unwrap_or_default()];
        let digits = |field: &[u8]| field.iter().all(|b| b.is_ascii_digit() || matches!(b, b'-' | b'+'));
        names.may_be_commas &= content.contains(&b',') && self.fields.iter().all(|f| digits(&content[f.clone()]));
        let why = if !RowNames::could_be(field) {
            "is not the name of a row"
        } else if !names.is_new(field) {
            "stands first in two rows, so it names neither"
        } else {
            return Ok(());
        };
        self.fail(line, self.unnamed_column(&format!("{} {why}", shown(field))))
    }

    /// What is said of rows that have a field more than the header has names, and why that is no name of a row.
    fn unnamed_column(&self, why: &str) -> String {
        let names = self.layout.as_ref().map_or(0, |l| l.names.len());
        format!(
            "{}, the header names {names}, and {why}; decimal commas? write points, or semicolons between numbers; a class or \
             a frame needs a name in the header",
            plural(names as u64 + 1, "field")
        )
    }

    pub(super) fn point(&mut self, line: u64, content: &[u8]) -> Result<()> {
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
        self.row_name(content, line)?;
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
            if let Err(reason) = check_weight(weight, layout.marks.intensity) {
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
        if let Some(layout) = &mut self.layout {
            layout.see_frame(|column| content[self.fields[column].clone()].into());
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

    pub(super) fn end_set(&mut self) -> Result<()> {
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
        if let Some(names) = self.layout.as_mut().and_then(|l| l.row_names.as_mut()) {
            let may_be_commas = found > 0 && names.may_be_commas;
            *names = RowNames::default();
            if may_be_commas {
                let reason = self.unnamed_column("no number has a decimal point");
                return self.fail(self.lines[0], reason);
            }
        }
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
        if self.marks.rows != Rows::Points {
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
}

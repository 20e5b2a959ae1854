//! XYZ and extended XYZ, the text of molecules and atoms: a count, a comment, a row of each, frame after frame. A frame is a realization.
//! Of extended XYZ the comment names the columns (`Properties`) and the box (`Lattice`, `Origin`, `pbc`).

use super::stated::StatedBox;
use super::table::{Cursor, Described, Field, Table, words};
use super::text::{number, shown};
use super::{Apart, Columns, MarkedPoints};
use crate::error::Result;

/// Whether the first lines of a text are those of a frame.
pub(super) fn is(lines: &[&[u8]]) -> bool {
    let [count, comment, rest @ ..] = lines else { return false };
    if count_of(count).is_none() {
        return false;
    }
    let comment = String::from_utf8_lossy(comment);
    if property(&comment, "Properties").is_some() || property(&comment, "Lattice").is_some() {
        return true;
    }
    let row: Vec<&[u8]> = rest.first().map(|row| words(row).collect()).unwrap_or_default();
    let is_number = |word: &&[u8]| number(word).is_some();
    row.len() >= 4 && row[1..4].iter().all(is_number) && (!is_number(&row[0]) || comment.trim().is_empty())
}

fn count_of(line: &[u8]) -> Option<u64> {
    std::str::from_utf8(line).ok()?.trim().parse().ok()
}

/// The value of `key=value` in a comment, in quotes or braces if it has blanks.
fn property<'a>(comment: &'a str, key: &str) -> Option<&'a str> {
    let mut rest = comment;
    loop {
        let (before, after) = rest.split_once('=')?;
        let found = before.split_whitespace().next_back().is_some_and(|word| word.eq_ignore_ascii_case(key));
        let after = after.trim_start();
        let close = match after.chars().next()? {
            '"' => Some('"'),
            '\'' => Some('\''),
            '{' => Some('}'),
            '[' => Some(']'),
            _ => None,
        };
        let (value, left) = match close {
            Some(close) => after[1..].split_once(close)?,
            None => after.split_at(after.find(char::is_whitespace).unwrap_or(after.len())),
        };
        if found {
            return Some(value);
        }
        rest = left;
    }
}

/// The numbers of a value, `1 0 0` or `1,0,0`.
fn numbers(value: &str) -> Option<Vec<f64>> {
    let words = value.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    words.map(|word| number(word.as_bytes()).filter(|x| x.is_finite())).collect()
}

/// `species:S:1:pos:R:3`: the names of the columns; those of positions are x, y and z.
fn column_names(properties: &str) -> Option<Vec<String>> {
    /// More than any file has.
    const MOST: usize = 1 << 10;
    let parts: Vec<&str> = properties.trim().split(':').collect();
    let mut names = Vec::new();
    for part in parts.chunks(3) {
        let [name, kind, count] = part else { return None };
        let count: usize = count.parse().ok().filter(|count| (1..=MOST).contains(count))?;
        if !matches!(*kind, "S" | "R" | "I" | "L") || names.len() + count > MOST {
            return None;
        }
        match (*name, count) {
            ("pos", 1..=3) => names.extend(["x", "y", "z"][..count].iter().map(|axis| axis.to_string())),
            (name, 1) => names.push(name.to_string()),
            (name, count) => names.extend((0..count).map(|k| format!("{name}[{k}]"))),
        }
    }
    Some(names)
}

/// The ranges of the box, and along which axes it is periodic.
type Cell = ([(f64, f64); 3], [bool; 3]);

/// The box of a comment, or why it is none that is used here.
fn cell(comment: &str) -> Result<Option<Cell>, String> {
    let Some(lattice) = property(comment, "Lattice") else { return Ok(None) };
    let vectors = numbers(lattice).filter(|vectors| vectors.len() == 9);
    let vectors = vectors.ok_or_else(|| format!("Lattice {}; expected 9 numbers", shown(lattice.as_bytes())))?;
    if let Some(k) = (0..9).find(|k| k % 4 != 0 && vectors[*k] != 0.0) {
        return Err(format!(
            "Lattice {} is not orthogonal: {} of vector {} is {}; `window` gives the window they are in",
            shown(lattice.as_bytes()),
            ["x", "y", "z"][k % 3],
            k / 3 + 1,
            vectors[k]
        ));
    }
    let origin = property(comment, "Origin").and_then(numbers).filter(|o| o.len() == 3).unwrap_or(vec![0.0; 3]);
    let periodic = property(comment, "pbc").map(|pbc| {
        let is = |word: &str| matches!(word.to_ascii_lowercase().as_str(), "t" | "true" | "1");
        pbc.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()).map(is).collect::<Vec<_>>()
    });
    // A lattice is one of periods where nothing else is said.
    let periodic = periodic.and_then(|p| <[bool; 3]>::try_from(p).ok()).unwrap_or([true; 3]);
    Ok(Some((std::array::from_fn(|a| (origin[a], origin[a] + vectors[4 * a])), periodic)))
}

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let mut cursor = Cursor::new(bytes);
    let mut table: Option<Table<'_>> = None;
    let (mut extended, mut stated, mut properties) = (false, Ok(None), None);
    let mut frames = 0u64;
    while let Some(line) = cursor.next_filled() {
        let (start, Some(count)) = (cursor.line, count_of(line)) else {
            let reason = format!("{}; expected the number of rows of frame {frames}", shown(line));
            return cursor.fail(name, reason);
        };
        let Some(comment) = cursor.next() else { return cursor.fail(name, "truncated: a count and nothing behind it") };
        let comment = String::from_utf8_lossy(comment).into_owned();
        let of_frame = property(&comment, "Properties").map(str::to_string);
        let named = of_frame.as_deref().map(|p| {
            column_names(p).ok_or_else(|| {
                format!("Properties {}; expected NAME:TYPE:COUNT of each, TYPE S, R, I or L", shown(p.as_bytes()))
            })
        });
        let mut named = match named.transpose() {
            Ok(named) => named,
            Err(reason) => return cursor.fail(name, reason),
        };
        let of_cell = cell(&comment);
        if frames == 0 {
            (extended, stated) = (named.is_some() || matches!(of_cell, Ok(Some(_)) | Err(_)), of_cell);
            properties = of_frame;
        } else {
            if of_frame != properties {
                return cursor.fail(name, "the columns of this frame are not those of the first");
            }
            if of_cell != stated && stated.is_ok() {
                stated = Err(format!(
                    "the box of frame {frames} (line {start}) is not that of the first; `sides` or `window` sets one for all"
                ));
            }
        }
        for row in 0..count {
            let Some(line) = cursor.next().filter(|line| !line.trim_ascii().is_empty()) else {
                let reason = format!("truncated: frame {frames} has {count} rows by its count, and there are {row}");
                return cursor.fail(name, reason);
            };
            let fields: Vec<&[u8]> = words(line).collect();
            let into = match &mut table {
                Some(table) => table,
                None => {
                    let names = named.take().unwrap_or_else(|| plain_names(&fields));
                    let line = if extended { start + 1 } else { cursor.line };
                    table.insert(Table::new(name, columns, &names, Some(line))?)
                }
            };
            if fields.len() != into.layout.width {
                let reason = format!(
                    "{} fields, expected {} as in the first frame: {}",
                    fields.len(),
                    into.layout.width,
                    shown(line)
                );
                return cursor.fail(name, reason);
            }
            into.row(Some(cursor.line), |k| Field::text(fields[k]))?;
        }
        match &mut table {
            Some(table) => table.end_set(),
            None => return cursor.fail(name, "its first frame has no rows"),
        }
        frames += 1;
    }
    let Some(table) = table else { return cursor.fail(name, "no frames") };
    let stated =
        stated.map(|cell| cell.and_then(|(ranges, periodic)| StatedBox::along(table.axes(), ranges, Some(periodic))));
    let format = if extended { "extended XYZ" } else { "XYZ" };
    table.finish(Described {
        format: format.into(),
        apart: Apart::Frames,
        stated: stated.transpose(),
        ..Described::default()
    })
}

/// The element, x, y, z, and numbers for what follows.
fn plain_names(fields: &[&[u8]]) -> Vec<String> {
    let known = ["species", "x", "y", "z"];
    (0..fields.len()).map(|k| known.get(k).map_or_else(|| (k + 1).to_string(), |name| name.to_string())).collect()
}

//! PLY, ascii or binary in either order of bytes: the element `vertex`. Its scalar properties are the columns; lists among them, and the
//! other elements, are left out.

use super::table::{Cursor, Described, Field, Table, words};
use super::text::shown;
use super::{Apart, Columns, Element, MarkedPoints};
use crate::error::{Error, Result};

pub(super) const MAGICS: [&[u8]; 2] = [b"ply\n", b"ply\r"];

/// How the numbers are written.
#[derive(Clone, Copy, PartialEq)]
enum Coding {
    Ascii,
    Binary { big_endian: bool },
}

struct Property {
    name: String,
    element: Element,
    /// The type of the length of a list.
    list: Option<Element>,
}

struct Part {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

const POINTS: &str = "vertex";

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let mut cursor = Cursor::new(bytes);
    let (coding, parts) = header(name, &mut cursor)?;
    let Some(at) = parts.iter().position(|part| part.name == POINTS) else {
        let names = parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>().join(", ");
        return Err(Error::input(name, format!("PLY without an element vertex; its elements are {names}")));
    };
    let vertex = &parts[at];
    let is_list = |property: &&Property| property.list.is_some();
    let names: Vec<String> =
        vertex.properties.iter().filter(|property| !is_list(property)).map(|p| p.name.clone()).collect();
    let mut table = Table::new(name, columns, &names, None)?;
    match coding {
        Coding::Ascii => ascii(name, &mut cursor, &parts[..=at], &mut table)?,
        Coding::Binary { big_endian } => binary(name, cursor.rest(), big_endian, &parts[..=at], &mut table)?,
    }
    table.end_set();
    let scalars: Vec<&Property> = vertex.properties.iter().filter(|property| !is_list(property)).collect();
    let digits = table.layout.columns.iter().filter_map(|&k| scalars[k].element.digits()).min();
    let lists = vertex.properties.iter().filter(is_list).map(|list| format!("list {}", list.name));
    let others = parts.iter().filter(|part| part.name != POINTS).map(|part| format!("element {}", part.name));
    let format = match coding {
        Coding::Ascii => "PLY, ascii",
        Coding::Binary { big_endian: false } => "PLY, binary little-endian",
        Coding::Binary { big_endian: true } => "PLY, binary big-endian",
    };
    table.finish(Described {
        format: format.into(),
        apart: Apart::Files,
        // Text has all the digits that were written.
        digits: digits.filter(|_| coding != Coding::Ascii),
        rest: lists.chain(others).collect(),
        ..Described::default()
    })
}

fn header(name: &str, cursor: &mut Cursor<'_>) -> Result<(Coding, Vec<Part>)> {
    let (mut coding, mut parts) = (None, Vec::<Part>::new());
    cursor.next();
    loop {
        let Some(line) = cursor.next() else { return cursor.fail(name, "PLY without end_header") };
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_whitespace().collect();
        let strange = |expected: &str| format!("{}; expected {expected}", shown(line.as_bytes()));
        match words.as_slice() {
            ["end_header"] => break,
            [] | ["comment" | "obj_info", ..] => {}
            ["format", "ascii", _] => coding = Some(Coding::Ascii),
            ["format", "binary_little_endian", _] => coding = Some(Coding::Binary { big_endian: false }),
            ["format", "binary_big_endian", _] => coding = Some(Coding::Binary { big_endian: true }),
            ["element", element, count] => {
                let Ok(count) = count.parse() else { return cursor.fail(name, strange("element NAME COUNT")) };
                if parts.iter().any(|part| part.name == *element) {
                    return cursor.fail(name, format!("two elements {element}"));
                }
                parts.push(Part { name: element.to_string(), count, properties: Vec::new() });
            }
            ["property", rest @ ..] => {
                let property = match rest {
                    ["list", length, of, property] => {
                        let length =
                            number_type(length).filter(|length| !matches!(length, Element::F32 | Element::F64));
                        length.zip(number_type(of)).map(|(length, of)| (*property, of, Some(length)))
                    }
                    [of, property] => number_type(of).map(|of| (*property, of, None)),
                    _ => None,
                };
                let Some(((property, element, list), part)) = property.zip(parts.last_mut()) else {
                    let types = "char, uchar, short, ushort, int, uint, float or double";
                    let form =
                        format!("property TYPE NAME or property list TYPE TYPE NAME of an element, with TYPE {types}");
                    return cursor.fail(name, strange(&form));
                };
                part.properties.push(Property { name: property.to_string(), element, list });
            }
            _ => {
                return cursor.fail(name, strange("format, element, property, comment or end_header"));
            }
        }
    }
    // Every row has a byte at least: what is counted cannot be more than there is.
    if let Some(part) = parts.iter().find(|part| part.count > 0 && part.properties.is_empty()) {
        return cursor.fail(name, format!("the element {} has no properties", part.name));
    }
    match coding {
        Some(coding) => Ok((coding, parts)),
        None => cursor.fail(name, "PLY without a format; expected ascii, binary_little_endian or binary_big_endian"),
    }
}

fn number_type(name: &str) -> Option<Element> {
    Some(match name {
        "char" | "int8" => Element::I8,
        "uchar" | "uint8" => Element::U8,
        "short" | "int16" => Element::I16,
        "ushort" | "uint16" => Element::U16,
        "int" | "int32" => Element::I32,
        "uint" | "uint32" => Element::U32,
        "float" | "float32" => Element::F32,
        "double" | "float64" => Element::F64,
        _ => return None,
    })
}

/// A line for each row.
fn ascii(name: &str, cursor: &mut Cursor<'_>, parts: &[Part], table: &mut Table<'_>) -> Result<()> {
    for part in parts {
        for row in 0..part.count {
            let Some(line) = cursor.next_filled() else { return Err(truncated(name, part, row)) };
            if part.name != POINTS {
                continue;
            }
            let mut fields = words(line);
            let mut scalars = Vec::new();
            let mut whole = true;
            for property in &part.properties {
                let field = fields.next();
                whole &= field.is_some();
                let field = field.unwrap_or_default();
                if property.list.is_none() {
                    scalars.push(field);
                    continue;
                }
                let length: Option<usize> = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
                let Some(length) = length else {
                    return cursor
                        .fail(name, format!("{} is not the length of the list {}", shown(field), property.name));
                };
                whole &= length == 0 || fields.nth(length - 1).is_some();
            }
            if !whole || fields.next().is_some() {
                let many = if whole { "more" } else { "fewer" };
                let reason = format!("{many} numbers than the element {POINTS} has properties: {}", shown(line));
                return cursor.fail(name, reason);
            }
            table.row(Some(cursor.line), |k| Field::text(scalars[k]))?;
        }
    }
    Ok(())
}

fn binary(name: &str, bytes: &[u8], big_endian: bool, parts: &[Part], table: &mut Table<'_>) -> Result<()> {
    let mut rest = bytes;
    let mut take = |count: usize| {
        let (taken, left) = rest.split_at_checked(count)?;
        rest = left;
        Some(taken)
    };
    let mut scalars = Vec::new();
    for part in parts {
        for row in 0..part.count {
            scalars.clear();
            for property in &part.properties {
                let cut = || truncated(name, part, row);
                let Some(length) = property.list else {
                    let number = take(property.element.bytes()).ok_or_else(cut)?;
                    property.element.decode_onto(&mut scalars, number, big_endian);
                    continue;
                };
                let mut count = Vec::new();
                length.decode_onto(&mut count, take(length.bytes()).ok_or_else(cut)?, big_endian);
                // A length below 0 is one of 0 here, and what follows does not fit.
                let count = count.first().map_or(0, |&count| count as usize);
                take(count.saturating_mul(property.element.bytes())).ok_or_else(cut)?;
            }
            if part.name == POINTS {
                table.row(None, |k| Field::Number(scalars[k]))?;
            }
        }
    }
    Ok(())
}

fn truncated(name: &str, part: &Part, row: u64) -> Error {
    Error::input(name, format!("truncated: its header says {} {}, and there are {row}", part.count, part.name))
}

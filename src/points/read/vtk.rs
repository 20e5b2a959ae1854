//! Legacy files of VTK, ascii or binary: the points of `POLYDATA` and `UNSTRUCTURED_GRID`, with the data of points as further columns.

use super::table::{Cursor, Described, Field, Table, words};
use super::text::{number, shown};
use super::{Apart, Columns, Element, MarkedPoints};
use crate::error::{Error, Result};

pub(super) const MAGIC: &[u8] = b"# vtk DataFile";

struct Reader<'a> {
    cursor: Cursor<'a>,
    binary: bool,
}

/// Why numbers could not be read.
type Missing = String;

impl<'a> Reader<'a> {
    /// The words of the next line that is not blank.
    fn line(&mut self) -> Option<Vec<&'a str>> {
        let line = self.cursor.next_filled()?;
        Some(words(line).map(|word| std::str::from_utf8(word).unwrap_or_default()).collect())
    }

    /// So many numbers of a type, which end where a line does.
    fn numbers(&mut self, count: u64, element: Element) -> Result<Vec<f64>, Missing> {
        let mut numbers = Vec::new();
        if self.binary {
            let rest = self.cursor.rest();
            let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(element.bytes()));
            let Some((taken, left)) = bytes.and_then(|bytes| rest.split_at_checked(bytes)) else {
                return Err(format!("truncated: {count} numbers by the header, and {} bytes", rest.len()));
            };
            element.decode_onto(&mut numbers, taken, true);
            self.cursor.go_on(left, self.cursor.line);
            return Ok(numbers);
        }
        while (numbers.len() as u64) < count {
            let Some(line) = self.cursor.next_filled() else {
                return Err(format!("truncated: {count} numbers by the header, and {}", numbers.len()));
            };
            for word in words(line) {
                numbers.push(number(word).ok_or_else(|| format!("{} is not a number", shown(word)))?);
            }
        }
        match numbers.len() as u64 == count {
            true => Ok(numbers),
            false => Err(format!("more numbers than the {count} of the header")),
        }
    }

    /// Passes by what ends with a blank line.
    fn metadata(&mut self) {
        while self.cursor.next().is_some_and(|line| !line.trim_ascii().is_empty()) {}
    }
}

/// Columns of numbers that stand side by side.
struct Array {
    names: Vec<String>,
    numbers: Vec<f64>,
}

impl Array {
    fn new(name: &str, width: u64, numbers: Vec<f64>) -> Self {
        let names = match width {
            1 => vec![name.to_string()],
            _ => (0..width).map(|k| format!("{name}[{k}]")).collect(),
        };
        Self { names, numbers }
    }
}

/// Numbers per point that are read at most.
const WIDEST: u64 = 1 << 10;

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let mut reader = Reader { cursor: Cursor::new(bytes), binary: false };
    // The magic, and a title.
    reader.cursor.next();
    reader.cursor.next();
    let coding = reader.line().unwrap_or_default();
    reader.binary = match coding.as_slice() {
        ["ASCII"] => false,
        ["BINARY"] => true,
        other => {
            let reason = format!("{}; expected ASCII or BINARY", shown(other.join(" ").as_bytes()));
            return reader.cursor.fail(name, reason);
        }
    };
    let kind = match reader.line().unwrap_or_default().as_slice() {
        ["DATASET", kind @ ("POLYDATA" | "UNSTRUCTURED_GRID")] => kind.to_string(),
        other => {
            let found = shown(other.join(" ").as_bytes());
            return reader.cursor.fail(name, format!("{found}; expected DATASET POLYDATA or UNSTRUCTURED_GRID"));
        }
    };
    let found = parts(&mut reader);
    let (points, element, arrays, mut notes, rest) = match found {
        Ok(found) => found,
        Err(reason) => return Err(Error::input(format!("{name}:{}", reader.cursor.line), reason)),
    };
    let axes = Array { names: ["x", "y", "z"].map(String::from).into(), numbers: points };
    let count = axes.numbers.len() / 3;
    // Data that were cut short are none.
    let (whole, cut): (Vec<Array>, Vec<Array>) =
        arrays.into_iter().partition(|array| array.numbers.len() == count * array.names.len());
    notes.extend(cut.iter().map(|array| format!("{} was not read: it is not of every point", array.names.join(", "))));
    let all: Vec<Array> = [axes].into_iter().chain(whole).collect();
    let places: Vec<(usize, usize)> =
        all.iter().enumerate().flat_map(|(a, array)| (0..array.names.len()).map(move |k| (a, k))).collect();
    let names: Vec<String> = all.iter().flat_map(|array| array.names.iter().cloned()).collect();
    let mut table = Table::new(name, columns, &names, None)?;
    for j in 0..count {
        table.row(None, |k| {
            let (a, k) = places[k];
            Field::Number(all[a].numbers[j * all[a].names.len() + k])
        })?;
    }
    table.end_set();
    let of_points = table.layout.columns.iter().all(|&k| k < 3);
    let coding = if reader.binary { "binary" } else { "ascii" };
    table.finish(Described {
        format: format!("VTK {kind}, {coding}"),
        apart: Apart::Files,
        digits: element.digits().filter(|_| reader.binary && of_points),
        rest,
        notes,
        ..Described::default()
    })
}

/// Points, the type of their numbers, their data, what is to be said, and what was left out.
type Parts = (Vec<f64>, Element, Vec<Array>, Vec<String>, Vec<String>);

fn parts(reader: &mut Reader<'_>) -> Result<Parts, Missing> {
    let (mut points, mut arrays, mut notes, mut rest) = (None, Vec::new(), Vec::new(), Vec::new());
    // Of what the data are: so many points, or cells.
    let (mut count, mut of_points) = (0, false);
    while let Some(line) = reader.line() {
        let number = |at: usize| line.get(at).and_then(|word| word.parse::<u64>().ok());
        let kind = |at: usize| line.get(at).and_then(|word| number_type(word));
        let strange = || format!("{} is not understood", shown(line.join(" ").as_bytes()));
        match (line[0], points.is_some()) {
            ("POINTS", false) => {
                let (n, element) = number(1).zip(kind(2)).ok_or_else(strange)?;
                points = Some((reader.numbers(n.checked_mul(3).ok_or_else(strange)?, element)?, element));
            }
            ("VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" | "CELLS", _) => {
                rest.push(line[0].to_lowercase());
                cells(reader, number(1).zip(number(2)).ok_or_else(strange)?)?;
            }
            ("CELL_TYPES", _) => _ = reader.numbers(number(1).ok_or_else(strange)?, Element::I32)?,
            ("METADATA", _) => reader.metadata(),
            ("POINT_DATA" | "CELL_DATA", _) => {
                (count, of_points) = (number(1).ok_or_else(strange)?, line[0] == "POINT_DATA");
                if !of_points {
                    rest.push("data of cells".into());
                }
            }
            (_, false) => return Err(format!("{}; expected POINTS", shown(line.join(" ").as_bytes()))),
            _ => match data(reader, &line, count) {
                Ok(found) => arrays.extend(found.into_iter().filter(|_| of_points)),
                // Points were read, and what is behind them is another's.
                Err(reason) => {
                    notes.push(format!("{} and what follows it was not read: {reason}", line[0]));
                    break;
                }
            },
        }
    }
    let (points, element) = points.ok_or("no POINTS")?;
    Ok((points, element, arrays, notes, rest))
}

/// Passes cells by: `n` of `size` numbers, or, since version 5, their offsets and points.
fn cells(reader: &mut Reader<'_>, (n, size): (u64, u64)) -> Result<(), Missing> {
    let (rest, at) = (reader.cursor.rest(), reader.cursor.line);
    let listed = |word: &str, count: u64, reader: &mut Reader<'_>| match reader.line().as_deref() {
        Some([first, of]) if *first == word => {
            let of = number_type(of).ok_or_else(|| format!("{word} of {of}"))?;
            reader.numbers(count, of).map(|_| true)
        }
        _ => Ok(false),
    };
    if listed("OFFSETS", n, reader)? {
        return match listed("CONNECTIVITY", size, reader)? {
            true => Ok(()),
            false => Err("OFFSETS without CONNECTIVITY".into()),
        };
    }
    reader.cursor.go_on(rest, at);
    reader.numbers(size, Element::I32).map(drop)
}

/// The arrays that a line of data begins.
fn data(reader: &mut Reader<'_>, line: &[&str], count: u64) -> Result<Vec<Array>, Missing> {
    let strange = || format!("{} is not understood", shown(line.join(" ").as_bytes()));
    let name = *line.get(1).ok_or_else(strange)?;
    let number = |at: usize| line.get(at).and_then(|word| word.parse::<u64>().ok());
    let kind = |at: usize| line.get(at).and_then(|word| number_type(word));
    let (width, element) = match line[0] {
        "SCALARS" => {
            // The name of a table of colours stands before the numbers.
            let (rest, at) = (reader.cursor.rest(), reader.cursor.line);
            if reader.line().is_none_or(|line| line[0] != "LOOKUP_TABLE") {
                reader.cursor.go_on(rest, at);
            }
            (if line.len() > 3 { number(3) } else { Some(1) }, kind(2))
        }
        "VECTORS" | "NORMALS" => (Some(3), kind(2)),
        "TENSORS" => (Some(9), kind(2)),
        "TEXTURE_COORDINATES" => (number(2), kind(3)),
        "GLOBAL_IDS" | "PEDIGREE_IDS" => (Some(1), kind(2)),
        // Fractions in text, bytes else.
        "COLOR_SCALARS" => (number(2), Some(Element::U8)),
        "LOOKUP_TABLE" => {
            array(reader, name, Some(4), number(2), Some(Element::U8)).ok_or_else(strange)??;
            return Ok(Vec::new());
        }
        "FIELD" => {
            let mut all = Vec::new();
            let mut left = number(2).ok_or_else(strange)?;
            while left > 0 {
                let line = reader.line().ok_or("truncated")?;
                if line[0] == "METADATA" {
                    reader.metadata();
                    continue;
                }
                let [name, width, tuples, of] = line[..] else { return Err(strange()) };
                let of = number_type(of).ok_or_else(|| format!("array {name} of {of}"))?;
                all.push(array(reader, name, width.parse().ok(), tuples.parse().ok(), Some(of)).ok_or_else(strange)??);
                left -= 1;
            }
            return Ok(all);
        }
        _ => return Err("no data that are known".into()),
    };
    Ok(vec![array(reader, name, width, Some(count), element).ok_or_else(strange)??])
}

/// `count` rows of `width` numbers; `None` where one of the sizes is none.
fn array(
    reader: &mut Reader<'_>,
    name: &str,
    width: Option<u64>,
    count: Option<u64>,
    element: Option<Element>,
) -> Option<Result<Array, Missing>> {
    let width = width.filter(|width| (1..=WIDEST).contains(width))?;
    let numbers = reader.numbers(count?.checked_mul(width)?, element?);
    Some(numbers.map(|numbers| Array::new(name, width, numbers)))
}

fn number_type(name: &str) -> Option<Element> {
    Some(match name.to_ascii_lowercase().as_str() {
        "char" | "signed_char" | "vtktypeint8" => Element::I8,
        "unsigned_char" | "vtktypeuint8" => Element::U8,
        "short" | "vtktypeint16" => Element::I16,
        "unsigned_short" | "vtktypeuint16" => Element::U16,
        "int" | "vtktypeint32" => Element::I32,
        "unsigned_int" | "vtktypeuint32" => Element::U32,
        "long" | "vtktypeint64" | "vtkidtype" => Element::I64,
        "unsigned_long" | "vtktypeuint64" => Element::U64,
        "float" => Element::F32,
        "double" => Element::F64,
        _ => return None,
    })
}

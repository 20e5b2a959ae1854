//! `.npy`, versions 1 to 3: magic, version, header length, a Python dictionary as text, data.
//!
//! The dictionary is read here rather than by a library because its shape decides how much is allocated and because
//! every message names what was found; the general parsers recurse on hostile nesting and multiply shapes unchecked.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::{Apart, Columns, Element, MarkedPoints, Sets, check_length, numbered};
use crate::error::{Error, Result, plural};

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

struct Header<'a> {
    dtype: &'a str,
    element: Element,
    big_endian: bool,
    fortran: bool,
    shape: Vec<u64>,
}

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Sets> {
    let fail = |reason: String| Error::input(name, reason);
    let (text, data) = split(bytes).map_err(fail)?;
    let Header { dtype, element, big_endian, fortran, shape } = parse(text).map_err(fail)?;
    let shown = show_shape(&shape);
    let (k, n, d) = sizes(&shape, columns).map_err(fail)?;
    let count = shape.iter().try_fold(1, |product: u64, &side| product.checked_mul(side));
    check_length(name, &format!("shape {shown} of {dtype}"), count, element, data)?;
    if k == 0 || (n == 0 && k > 1) {
        return Err(fail(format!("shape {shown} holds no {}s", columns.rows.one())));
    }
    let flat = element.decode(data, big_endian);
    // All three sizes are at most the number of elements that the data holds, so they fit.
    let (k, n, d) = (k as usize, n as usize, d as usize);
    let sets = if fortran {
        let set = |s| (0..n).flat_map(|i| (0..d).map(move |a| s + k * (i + n * a))).map(|at| flat[at]).collect();
        (0..k).map(set).collect()
    } else if k == 1 {
        vec![flat]
    } else {
        flat.chunks_exact(n * d).map(<[f64]>::to_vec).collect()
    };
    Ok(Sets { sets, ..described(element, &shape, None) })
}

/// The sizes and the numbers of an array of any shape, the last axis fastest.
///
/// # Errors
/// What is no array of numbers, or not all of one.
pub(crate) fn array_of_bytes(name: &str, bytes: &[u8]) -> Result<(Vec<usize>, Vec<f64>)> {
    let fail = |reason: String| Error::input(name, reason);
    if !bytes.starts_with(MAGIC) {
        return Err(fail("not a .npy array".into()));
    }
    let (text, data) = split(bytes).map_err(fail)?;
    let Header { dtype, element, big_endian, fortran, shape } = parse(text).map_err(fail)?;
    let count = shape.iter().try_fold(1, |product: u64, &side| product.checked_mul(side));
    check_length(name, &format!("shape {} of {dtype}", show_shape(&shape)), count, element, data)?;
    let mut values = element.decode(data, big_endian);
    let sides: Vec<usize> = shape.iter().map(|&side| side as usize).collect();
    if fortran {
        // Where the first axis is fastest the axes stand in reverse order.
        let place = |at: usize| {
            let (mut rest, mut place) = (at, vec![0; sides.len()]);
            for (axis, &side) in sides.iter().enumerate().rev() {
                (place[axis], rest) = (rest % side, rest / side);
            }
            place.iter().zip(&sides).rev().fold(0, |at, (i, side)| at * side + i)
        };
        values = (0..values.len()).map(|at| values[place(at)]).collect();
    }
    Ok((sides, values))
}

/// What is said of an array of this shape, without its numbers.
fn described(element: Element, shape: &[u64], first: Option<u64>) -> Sets {
    Sets {
        width: if shape.len() == 1 { 1 } else { shape.last().map_or(1, |&d| d as usize) },
        sets: Vec::new(),
        first,
        names: Vec::new(),
        format: format!("NPY of {}", element.name()),
        apart: if shape.len() == 3 { Apart::FirstAxis } else { Apart::Files },
        digits: element.digits(),
    }
}

/// The shape of an array, if its header can be read.
pub(super) fn shape(bytes: &[u8]) -> Option<Vec<u64>> {
    let (text, _) = split(bytes).ok()?;
    parse(text).ok().map(|header| header.shape)
}

/// An array in C order whose realizations are read when they are needed, and never lie in memory as they are stored.
#[derive(Debug)]
pub(crate) struct Rows {
    path: PathBuf,
    data: u64,
    element: Element,
    big_endian: bool,
    shape: Vec<u64>,
    /// K, n and d.
    sizes: [u64; 3],
}

/// Numbers that are decoded at a time.
const BLOCK: usize = 1 << 16;

impl Rows {
    /// Where they are.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// `None` for what is another file or array, or a damaged one: `read` says what is wrong with it.
    pub(super) fn open(path: &Path, columns: &Columns) -> Option<Self> {
        const FRONT: u64 = 1 << 17;
        let file = File::open(path).ok()?;
        let length = file.metadata().ok()?.len();
        let mut front = Vec::new();
        file.take(FRONT).read_to_end(&mut front).ok()?;
        let (text, rest) = front.starts_with(MAGIC).then(|| split(&front).ok()).flatten()?;
        let Header { element, big_endian, fortran, shape, .. } = parse(text).ok()?;
        let (k, n, d) = sizes(&shape, columns).ok()?;
        let data = (front.len() - rest.len()) as u64;
        let bytes = k.checked_mul(n)?.checked_mul(d)?.checked_mul(element.bytes() as u64)?;
        let whole = !fortran && k > 0 && n > 0 && d > 0 && data.checked_add(bytes)? == length;
        whole.then(|| Self { path: path.to_owned(), data, element, big_endian, shape, sizes: [k, n, d] })
    }

    /// How many realizations it holds.
    pub(super) fn realizations(&self) -> u64 {
        self.sizes[0]
    }

    /// Numbers in each of them.
    pub(super) fn numbers(&self) -> u64 {
        self.sizes[1] * self.sizes[2]
    }

    /// Some of them.
    pub(super) fn read(&self, range: Range<u64>, columns: &Columns) -> Result<Vec<MarkedPoints>> {
        let (numbers, size) = (self.numbers() as usize, self.element.bytes());
        let fail = |e| Error::file(&self.path, e);
        let mut file = File::open(&self.path).map_err(fail)?;
        file.seek(SeekFrom::Start(self.data + range.start * self.numbers() * size as u64)).map_err(fail)?;
        let mut bytes = vec![0; BLOCK.min(numbers) * size];
        let mut sets = Vec::new();
        for k in range.clone() {
            let mut set = Vec::new();
            set.try_reserve_exact(numbers).map_err(|_| fail(ErrorKind::OutOfMemory.into()))?;
            while set.len() < numbers {
                let block = &mut bytes[..BLOCK.min(numbers - set.len()) * size];
                file.read_exact(block).map_err(|e| match e.kind() {
                    ErrorKind::UnexpectedEof => {
                        let reason =
                            format!("is shorter than when it was first read: realization {k} is not there any more");
                        Error::input(self.path.display().to_string(), reason)
                    }
                    _ => fail(e),
                })?;
                self.element.decode_onto(&mut set, block, self.big_endian);
            }
            sets.push(set);
        }
        // One alone is called by its file.
        let first = (self.realizations() > 1).then_some(range.start);
        let sets = Sets { sets, ..described(self.element, &self.shape, first) };
        numbered(&self.path.display().to_string(), sets, columns)
    }
}

/// Header text and data.
fn split(bytes: &[u8]) -> Result<(&str, &[u8]), String> {
    let truncated = || "truncated: the file ends within the .npy header".to_owned();
    let version = *bytes.get(6).ok_or_else(truncated)?;
    let (start, length) = match version {
        1 => match bytes.get(8..10) {
            Some(&[a, b]) => (10, usize::from(u16::from_le_bytes([a, b]))),
            _ => return Err(truncated()),
        },
        2 | 3 => match bytes.get(8..12) {
            Some(&[a, b, c, d]) => (12, u32::from_le_bytes([a, b, c, d]) as usize),
            _ => return Err(truncated()),
        },
        other => return Err(format!(".npy version {other}; expected 1, 2 or 3")),
    };
    let (header, data) = bytes[start..].split_at_checked(length).ok_or_else(truncated)?;
    let text = std::str::from_utf8(header).map_err(|_| damaged("it is not text"))?;
    Ok((text, data))
}

fn damaged(why: &str) -> String {
    format!("damaged .npy header: {why}; expected 'descr', 'fortran_order' and 'shape'")
}

fn parse(text: &str) -> Result<Header<'_>, String> {
    let value = |key: &str| {
        let at = text.find(&format!("'{key}'")).or_else(|| text.find(&format!("\"{key}\"")));
        let rest = at.and_then(|at| text[at + key.len() + 2..].trim_start().strip_prefix(':'));
        rest.map(str::trim_start).ok_or_else(|| damaged(&format!("no '{key}'")))
    };
    let descr = value("descr")?;
    let Some(quote) = descr.chars().next().filter(|c| matches!(c, '\'' | '"')) else {
        let end = descr.find("'fortran_order'").unwrap_or(descr.len());
        let shown: String = descr[..end].trim_end_matches([',', ' ']).chars().take(60).collect();
        return Err(format!("a structured array, dtype {shown}; expected plain numbers, shape (n, d)"));
    };
    let dtype = descr[1..].split(quote).next().unwrap_or_default();
    let (element, big_endian) = element(dtype)?;
    let order = value("fortran_order")?;
    let fortran = match (order.starts_with("True"), order.starts_with("False")) {
        (true, _) => true,
        (_, true) => false,
        _ => return Err(damaged("'fortran_order' is neither True nor False")),
    };
    let shape = value("shape")?.strip_prefix('(').and_then(|rest| rest.split(')').next());
    let sides: Option<Vec<u64>> = shape.and_then(|inside| {
        let sides = inside.split(',').map(str::trim).filter(|side| !side.is_empty());
        // Python 2 wrote long integers as 5L.
        sides.map(|side| side.strip_suffix('L').unwrap_or(side).parse().ok()).collect()
    });
    let shape = sides.ok_or_else(|| damaged("'shape' is not a tuple of sizes"))?;
    Ok(Header { dtype, element, big_endian, fortran, shape })
}

fn element(dtype: &str) -> Result<(Element, bool), String> {
    let (order, kind) = match dtype.as_bytes().first() {
        Some(order @ (b'<' | b'>' | b'|' | b'=')) => (*order, &dtype[1..]),
        _ => (b'=', dtype),
    };
    let big_endian = order == b'>' || (order == b'=' && cfg!(target_endian = "big"));
    let element = match kind {
        "f2" => Element::F16,
        "f4" => Element::F32,
        "f8" => Element::F64,
        "i1" => Element::I8,
        "i2" => Element::I16,
        "i4" => Element::I32,
        "i8" => Element::I64,
        "u1" => Element::U8,
        "u2" => Element::U16,
        "u4" => Element::U32,
        "u8" => Element::U64,
        _ => {
            let what = match kind.as_bytes().first() {
                Some(b'b') => "booleans",
                Some(b'c') => "complex numbers",
                Some(b'U' | b'S' | b'a') => "strings",
                Some(b'O') => "Python objects",
                Some(b'M' | b'm') => "times",
                _ => "an unsupported type",
            };
            let shown: String = dtype.chars().take(20).collect();
            return Err(format!("dtype {shown:?} is {what}; expected f2, f4, f8, i1 to i8 or u1 to u8"));
        }
    };
    Ok((element, big_endian))
}

/// (K, n, d) of a shape, some of the d columns being no coordinates.
fn sizes(shape: &[u64], columns: &Columns) -> Result<(u64, u64, u64), String> {
    let (k, n, d) = match *shape {
        [n] => (1, n, 1),
        [n, d] => (1, n, d),
        [k, n, d] => (k, n, d),
        _ => {
            let reason = "expected (n, d) or (K, n, d) with d = 1, 2 or 3, or (n,) for d = 1";
            return Err(format!("shape {}; {reason}", show_shape(shape)));
        }
    };
    let marks = columns.count() as u64;
    if (1 + marks..=columns.most_axes() as u64 + marks).contains(&d) || (d > 0 && !columns.coordinates.is_empty()) {
        return Ok((k, n, d));
    }
    if marks > 0 {
        let reason = format!("expected {} to {} columns: coordinates, and those the flags name", 1 + marks, 3 + marks);
        return Err(format!("shape {} has {}; {reason}", show_shape(shape), plural(d, "column")));
    }
    let hint = match columns.rows {
        _ if (1..=3).contains(&n) && shape.len() > 1 => "; it seems to be transposed",
        super::Rows::Points if d > 3 => {
            "; `columns` chooses them, as in 1,2, and `projections` measures up to 16 by pairs"
        }
        _ => "",
    };
    Err(format!(
        "shape {} has {d} {}s per {}; expected (n, d) or (K, n, d) with d = 1, 2 or 3{hint}",
        show_shape(shape),
        columns.rows.number(),
        columns.rows.one()
    ))
}

/// As Python shows it.
fn show_shape(shape: &[u64]) -> String {
    match shape {
        [n] => format!("({n},)"),
        _ => format!("({})", shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")),
    }
}

//! Numbers and nothing else: `--raw f32x2`, and PSA's `.rps`, which is `f32x2` without being told. Little endian, one
//! realization per file.

use std::fmt;
use std::str::FromStr;

use super::{Apart, Columns, Element, MarkedPoints, Sets, numbered};
use crate::error::{Error, Result, plural};
use crate::setting::Setting;

/// The number type of a raw file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RawElement {
    /// 32-bit floats.
    F32,
    /// 64-bit floats.
    F64,
}

/// `--raw f32x2`: element type and numbers per point: its coordinates, and its weight or class where flags say so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawLayout {
    element: RawElement,
    width: usize,
}

/// Most numbers per point: coordinates, and what else there may be.
const WIDEST: usize = 9;

impl RawLayout {
    /// PSA's `.rps`.
    pub const RPS: Self = Self { element: RawElement::F32, width: 2 };

    /// `width` numbers of type `element` per point.
    ///
    /// # Errors
    /// A number of columns that no point has.
    pub fn new(element: RawElement, width: usize) -> Result<Self> {
        let layout = Self { element, width };
        if (1..=WIDEST).contains(&width) { Ok(layout) } else { Err(wrong(&layout.to_string())) }
    }

    /// The number type.
    pub fn element(&self) -> RawElement {
        self.element
    }

    /// Numbers per point.
    pub fn width(&self) -> usize {
        self.width
    }
}

/// As typed.
impl fmt::Display for RawLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let element = match self.element {
            RawElement::F32 => "f32",
            RawElement::F64 => "f64",
        };
        write!(f, "{element}x{}", self.width)
    }
}

impl FromStr for RawLayout {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let (element, dim) = text.split_once('x').ok_or_else(|| wrong(text))?;
        let element = match element {
            "f32" => RawElement::F32,
            "f64" => RawElement::F64,
            _ => return Err(wrong(text)),
        };
        match dim {
            "1" | "2" | "3" | "4" | "5" | "6" | "7" | "8" | "9" => {
                Self::new(element, usize::from(dim.as_bytes()[0] - b'0'))
            }
            _ => Err(wrong(text)),
        }
    }
}

fn wrong(text: &str) -> Error {
    Error::setting(
        Setting::Raw,
        text,
        "expected f32x1, f32x2, f32x3, f64x1, f64x2 or f64x3 (type x coordinates per point), or up to x9 where `columns` and the like say what the numbers are",
    )
}

pub(super) fn read(name: &str, bytes: &[u8], layout: RawLayout, columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let left = layout.width.saturating_sub(columns.count());
    if !(1..=columns.most_axes()).contains(&left) && (columns.coordinates.is_empty() || left == 0) {
        return Err(wrong(&layout.to_string()));
    }
    let element = match layout.element {
        RawElement::F32 => Element::F32,
        RawElement::F64 => Element::F64,
    };
    let point = element.bytes() * layout.width;
    let left_over = bytes.len() % point;
    if left_over != 0 {
        let reason = format!(
            "{} are not a whole number of {layout} {}s of {point} bytes: {left_over} left over",
            plural(bytes.len() as u64, "byte"),
            columns.rows.one(),
        );
        return Err(Error::input(name, reason));
    }
    let sets = Sets {
        width: layout.width,
        sets: vec![element.decode(bytes, false)],
        first: None,
        names: Vec::new(),
        format: format!("raw {layout}"),
        apart: Apart::Files,
        digits: element.digits(),
    };
    numbered(name, sets, columns)
}

/// Whether `bytes` are pairs of fractions, as in `.rps`. An f64 in [2^-7, 1) read as two f32 gives one at or above 1,
/// so f64 points do not pass for them.
pub(super) fn could_be_rps(bytes: &[u8]) -> bool {
    let (numbers, rest) = bytes.as_chunks::<4>();
    let fraction = |&b: &[u8; 4]| {
        let x = f32::from_le_bytes(b);
        (0.0..1.0).contains(&x) && (x == 0.0 || x.is_normal())
    };
    rest.is_empty() && numbers.len() % 2 == 0 && numbers.iter().all(fraction)
}

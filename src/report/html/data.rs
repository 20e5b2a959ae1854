//! The numbers behind a page, as JSON that its script reads: tables as their CSV, curves as places in them, pictures as values.

use std::io;
use std::ops::Range;

use base64::Engine as _;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::super::columns::{Columns, Place};
use super::super::svg;
use crate::display::figure::{Figure, Layer, Of, Rgb, Stroke};
use crate::display::untagged;
use crate::statistics::{At, Cells, cell};

/// Rows of a table that are shown. Of one with more than twice as many the page has only these, and of the others one for each px
/// of the figure.
const FIRST: usize = 1000;

/// Values of a picture that are kept in single precision; those of a larger one have three digits.
const SINGLE: usize = 1 << 17;

/// A curve as it can be read off.
pub(crate) struct Curve {
    /// As in the legend, SVG text.
    pub(crate) name: String,
    pub(crate) color: Rgb,
    pub(crate) stroke: Stroke,
    pub(crate) values: Values,
}

/// Where the values of a curve are.
pub(crate) enum Values {
    /// In no table.
    Points(Vec<(f64, f64)>),
    /// In the table of that number of the figure.
    Cells(usize, Place),
}

/// The curves of a figure of a report, whose numbers are in its table.
pub(super) fn curves(figure: &Figure, table: Option<&Columns>) -> Vec<Curve> {
    let of = |layer: &Layer| {
        let Layer::Line { name, color, stroke, runs, of, .. } = layer else { return None };
        let placed = table.zip(figure.numbers).and_then(|(table, numbers)| table.place(of, numbers.x));
        let values = match (of, placed) {
            (Of::Points, _) => Values::Points(runs.iter().flatten().copied().collect()),
            (_, Some(place)) => Values::Cells(0, place),
            (_, None) => return None,
        };
        Some(Curve { name: name.clone(), color: *color, stroke: *stroke, values })
    };
    figure.layers.iter().filter_map(of).collect()
}

/// What a page has of a table.
pub(super) struct Sheet {
    /// The rows it has.
    kept: Vec<usize>,
    json: Value,
}

impl Sheet {
    /// Of a table with the name of its file, whose rows stand in a figure at these px, if they do.
    pub(super) fn new(name: &str, table: &Columns, px: impl Fn(usize) -> Option<f64>) -> io::Result<Self> {
        let rows = table.len();
        let mut last = None;
        let new_px = |row: &usize| {
            let px = px(*row).map(f64::round);
            std::mem::replace(&mut last, px) != px
        };
        let kept: Vec<usize> = match rows {
            _ if rows <= 2 * FIRST => (0..rows).collect(),
            _ => (0..FIRST).chain((FIRST..rows).filter(new_px)).collect(),
        };
        let csv = table.csv(&kept)?;
        Ok(Self { json: json!({ "name": name, "rows": rows, "first": rows.min(FIRST), "csv": csv }), kept })
    }

    pub(super) fn json(&self) -> &Value {
        &self.json
    }

    /// Those of some rows that it has, by their turn in it.
    fn range(&self, rows: &Range<usize>) -> [usize; 2] {
        [rows.start, rows.end].map(|row| self.kept.partition_point(|kept| *kept < row))
    }
}

/// A figure of curves: its frame, its axes, and where the values are; `sheets` are its tables and their numbers in the page.
pub(super) fn figure(
    figure: &Figure,
    grouped: bool,
    factor: f64,
    curves: &[Curve],
    sheets: &[(usize, &Sheet)],
) -> Value {
    let curve = |curve: &Curve| {
        let mut all = json!({
            "name": untagged(&curve.name),
            "color": svg::hex(curve.color),
            "dashes": curve.stroke.dashes().map(|(dash, gap)| format!("{dash} {gap}")),
        });
        match &curve.values {
            Values::Points(points) => {
                let px = |point: &(f64, f64)| svg::place_of(figure, point.0).round();
                let mut kept = points.clone();
                if kept.len() > 2 * FIRST {
                    kept.dedup_by(|b, a| px(a) == px(b));
                }
                all["points"] = kept.into_iter().map(|(x, y)| json!([cell(x), cell(y)])).collect();
            }
            Values::Cells(table, place) => {
                all["table"] = json!(table);
                all["x"] = json!(place.x);
                all["y"] = json!(place.y);
                all["error"] = json!(place.error);
                all["rows"] = json!(sheets[*table].1.range(&place.rows));
            }
        }
        all
    };
    json!({
        "frame": svg::frame_of(figure, grouped),
        "x": [figure.x.start, figure.x.end],
        "y": [figure.y.start, figure.y.end],
        "log": [figure.log_x, figure.log_y],
        "label": untagged(&figure.x_label),
        "factor": factor,
        "tables": sheets.iter().map(|(number, _)| number).collect::<Vec<_>>(),
        "curves": curves.iter().map(curve).collect::<Vec<_>>(),
    })
}

/// Pictures: each its element among those of the figure, and its values.
pub(super) fn cells(all: &[(usize, &Cells)], tables: &[usize]) -> Value {
    let steps = |at: &At| match at {
        At::Even { first, step, count, each } => json!({ "first": first, "step": step, "count": count, "each": each }),
        At::Named(names) => json!({ "names": names, "count": names.len() }),
    };
    let one = |&(element, cells): &(usize, &Cells)| {
        let axes: Vec<Value> =
            cells.axes.iter().map(|axis| json!({ "name": axis.name, "at": steps(&axis.at) })).collect();
        let (digits, values) = packed(&cells.values);
        json!({
            "element": element,
            "place": cells.place,
            "axes": axes,
            "quantity": cells.quantity,
            "digits": digits,
            "values": values,
        })
    };
    json!({ "cells": all.iter().map(one).collect::<Vec<_>>(), "tables": tables })
}

/// Values as text: their digits, and their bytes in base 64. Of what is its own image about its centre, as P is, the first half.
fn packed(values: &[f64]) -> (u32, String) {
    // The two of a pair were summed apart and may differ by rounding.
    let same = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * a.abs() || a.is_nan() && b.is_nan();
    let mirrored = values.iter().zip(values.iter().rev()).all(same);
    let kept = if mirrored { &values[..values.len().div_ceil(2)] } else { values };
    let (digits, bytes): (u32, Vec<u8>) = if kept.len() <= SINGLE {
        (7, kept.iter().flat_map(|v| (*v as f32).to_le_bytes()).collect())
    } else {
        let codes: Vec<u16> = kept.par_iter().map(|v| three_digits(*v)).collect();
        (3, codes.into_iter().flat_map(u16::to_le_bytes).collect())
    };
    (digits, base64::engine::general_purpose::STANDARD.encode(bytes))
}

/// A number of three digits d and a power of ten e from -20 to 14 as 1 + 900 (e + 20) + d - 100, its sign as the highest bit; 0 is 0, and what is
/// no number is all bits.
fn three_digits(value: f64) -> u16 {
    if !value.is_finite() {
        return u16::MAX;
    }
    let (text, sign) = (format!("{:.2e}", value.abs()), if value < 0.0 { 0x8000 } else { 0 });
    let parts = text.split_once('e').and_then(|(d, e)| Some((d.replace('.', "").parse().ok()?, e.parse().ok()?)));
    match parts {
        Some((digits @ 100..=999u16, power @ -20..=14i16)) => sign | (1 + 900 * (power + 20) as u16 + digits - 100),
        Some((100..=999, 15..)) => sign | (900 * 35),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_those_of_the_number() {
        let number = |code: u16| {
            let (sign, code) = (if code & 0x8000 == 0 { 1.0 } else { -1.0 }, code & 0x7fff);
            let (e, d) = (i32::from((code - 1) / 900) - 22, f64::from((code - 1) % 900 + 100));
            sign * d * 10f64.powi(e)
        };
        for value in [1.0, -1.0, 9.994, 9.996, 1.234e-20, 9.99e14, 0.0123] {
            assert!((number(three_digits(value)) / value - 1.0).abs() < 0.0051, "{value}");
        }
        assert_eq!([0.0, 1e-30, f64::NAN].map(three_digits), [0, 0, u16::MAX]);
        assert_eq!(number(three_digits(1e99)), 9.99e14);
    }

    #[test]
    fn pictures_that_are_their_own_image_are_half() {
        let bytes = |values: &[f64]| packed(values).1.len();
        assert_eq!(bytes(&[1.0, 2.0, 3.0, 2.0, 1.0, 0.0]), 32);
        assert_eq!(bytes(&[1.0, 2.0, f64::NAN, 2.0, 1.0]), 16);
        assert_eq!(packed(&vec![1.0; 2 * SINGLE + 2]).0, 3);
    }
}

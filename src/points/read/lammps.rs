//! Dumps of LAMMPS as text: `ITEM: TIMESTEP`, `NUMBER OF ATOMS`, `BOX BOUNDS`, `ATOMS`. A timestep is a realization; the box is the domain,
//! a torus where it is periodic (`pp`), a window where it is not. Positions are `x y z`, else unwrapped `xu`, scaled `xs` or both.

use super::columns::Column;
use super::stated::{StatedBox, axis_of};
use super::table::{Cursor, Described, Field, Table, words};
use super::text::{number, shown};
use super::{Apart, Columns, MarkedPoints};
use crate::error::Result;

pub(super) const START: &[u8] = b"ITEM:";

/// A box, and whether it is periodic along each axis, where that is said.
#[derive(Clone, PartialEq)]
struct Cell {
    ranges: [(f64, f64); 3],
    periodic: Option<[bool; 3]>,
    /// The first tilt that is not 0.
    tilt: Option<(&'static str, f64)>,
}

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let mut cursor = Cursor::new(bytes);
    let mut chosen = columns.clone();
    let mut start = 0;
    // The columns of the first step say which of them are positions.
    let mut ahead = Cursor::new(bytes);
    while let Some(line) = ahead.next() {
        if let Some(names) = item(line).and_then(|item| item.strip_prefix("ATOMS")) {
            start = ahead.line;
            if chosen.coordinates.is_empty() {
                chosen.coordinates = positions(names);
            }
            break;
        }
    }
    let mut table: Option<Table<'_>> = None;
    let (mut atoms, mut cell, mut first_cell, mut names) = (None, None::<Cell>, None, String::new());
    let mut differs = None;
    let mut steps = 0u64;
    while let Some(line) = cursor.next_filled() {
        let Some(item) = item(line) else {
            return cursor.fail(name, format!("{}; expected ITEM: and what follows", shown(line)));
        };
        match item.split_whitespace().collect::<Vec<_>>().as_slice() {
            ["TIMESTEP" | "TIME" | "UNITS"] => _ = cursor.next(),
            ["NUMBER", "OF", "ATOMS"] => {
                let line = cursor.next().unwrap_or_default();
                atoms = std::str::from_utf8(line).ok().and_then(|text| text.trim().parse::<u64>().ok());
                if atoms.is_none() {
                    return cursor.fail(name, format!("{}; expected the number of atoms", shown(line)));
                }
            }
            ["BOX", "BOUNDS", flags @ ..] => cell = Some(bounds(name, &mut cursor, flags)?),
            ["ATOMS", listed @ ..] => {
                let Some(count) = atoms.take() else { return cursor.fail(name, "atoms without their number") };
                let joined = listed.join(" ");
                let into = match &mut table {
                    Some(_) if joined != names => {
                        return cursor.fail(name, format!("columns {joined}; those of the first step are {names}"));
                    }
                    Some(table) => table,
                    None => {
                        let columns: Vec<String> = listed.iter().map(|name| name.to_string()).collect();
                        names = joined;
                        table.insert(Table::new(name, &chosen, &columns, Some(start))?)
                    }
                };
                if steps == 0 {
                    first_cell = cell.clone();
                } else if cell != first_cell && differs.is_none() {
                    differs = Some(format!(
                        "the box of step {steps} (line {}) is not that of the first; `sides` or `window` sets one for all",
                        cursor.line
                    ));
                }
                let scaled: Vec<Option<(f64, f64)>> = match scales(listed, into, cell.as_ref()) {
                    Ok(scaled) => scaled,
                    Err(reason) => return cursor.fail(name, reason),
                };
                for row in 0..count {
                    let Some(line) = cursor.next().filter(|line| !line.trim_ascii().is_empty()) else {
                        let reason =
                            format!("truncated: step {steps} has {count} atoms by its number, and there are {row}");
                        return cursor.fail(name, reason);
                    };
                    let fields: Vec<&[u8]> = words(line).collect();
                    if fields.len() != listed.len() {
                        let expected = listed.len();
                        let reason = format!("{} fields, expected {expected}: {}", fields.len(), shown(line));
                        return cursor.fail(name, reason);
                    }
                    into.row(Some(cursor.line), |k| match (scaled[k], number(fields[k])) {
                        (Some((low, side)), Some(x)) => Field::Number(low + x * side),
                        _ => Field::text(fields[k]),
                    })?;
                }
                into.end_set();
                steps += 1;
            }
            _ => {
                let reason = format!("{}; expected TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS or ATOMS", shown(line));
                return cursor.fail(name, reason);
            }
        }
    }
    let Some(table) = table else { return cursor.fail(name, "a LAMMPS dump without ITEM: ATOMS") };
    let stated = match (differs, first_cell) {
        (Some(reason), _) => Some(Err(reason)),
        (None, Some(Cell { tilt: Some((name, tilt)), .. })) => {
            Some(Err(format!("its box is triclinic ({name} = {tilt}); `window` gives the window they are in")))
        }
        (None, Some(Cell { ranges, periodic, tilt: None })) => StatedBox::along(table.axes(), ranges, periodic).map(Ok),
        (None, None) => None,
    };
    table.finish(Described { format: "LAMMPS dump".into(), apart: Apart::Frames, stated, ..Described::default() })
}

/// What follows `ITEM:`.
fn item(line: &[u8]) -> Option<&str> {
    std::str::from_utf8(line).ok()?.trim().strip_prefix("ITEM:").map(str::trim)
}

/// The columns of positions, where there are no x, y and z.
fn positions(names: &str) -> Vec<Column> {
    let names: Vec<&str> = names.split_whitespace().collect();
    let of = |end: &str| {
        ["x", "y", "z"].map(|axis| format!("{axis}{end}")).into_iter().filter(|n| names.contains(&n.as_str()))
    };
    let found = ["", "u", "s", "su"].into_iter().find(|end| names.contains(&format!("x{end}").as_str()));
    found.into_iter().filter(|end| !end.is_empty()).flat_map(of).map(Column::Name).collect()
}

/// `xlo xhi`, perhaps with a tilt, of three axes.
fn bounds(name: &str, cursor: &mut Cursor<'_>, flags: &[&str]) -> Result<Cell> {
    let (tilted, flags) = match flags {
        ["xy", "xz", "yz", flags @ ..] => (true, flags),
        ["abc", "origin", ..] => {
            return cursor.fail(name, "a general triclinic box (abc origin) is not read; write an orthogonal one");
        }
        flags => (false, flags),
    };
    let periodic = <[&str; 3]>::try_from(flags).ok().map(|flags| flags.map(|flag| flag == "pp"));
    let mut cell = Cell { ranges: [(0.0, 0.0); 3], periodic, tilt: None };
    for axis in 0..3 {
        let line = cursor.next().unwrap_or_default();
        let numbers: Option<Vec<f64>> = words(line).map(|word| number(word).filter(|x| x.is_finite())).collect();
        match numbers.as_deref() {
            Some([low, high]) if !tilted => cell.ranges[axis] = (*low, *high),
            Some([low, high, tilt]) if tilted => {
                cell.ranges[axis] = (*low, *high);
                if *tilt != 0.0 {
                    cell.tilt = cell.tilt.or(Some((["xy", "xz", "yz"][axis], *tilt)));
                }
            }
            _ => {
                let form = if tilted { "low, high and tilt" } else { "low and high" };
                return cursor.fail(name, format!("{}; expected {form} of axis {}", shown(line), axis + 1));
            }
        }
    }
    Ok(cell)
}

/// Of each column its lower end and its side, where it holds fractions of the box.
fn scales(names: &[&str], table: &Table<'_>, cell: Option<&Cell>) -> Result<Vec<Option<(f64, f64)>>, String> {
    let scale = |(k, name): (usize, &&str)| {
        let axis = axis_of(name).filter(|_| name.ends_with(['s']) || name.ends_with("su"));
        let Some(axis) = axis.filter(|_| table.layout.columns.contains(&k)) else { return Ok(None) };
        let cell = cell.ok_or_else(|| format!("column {name} holds fractions of a box that is not there"))?;
        if let Some((tilt, value)) = cell.tilt {
            return Err(format!(
                "column {name} holds fractions of a triclinic box ({tilt} = {value}), which are not read"
            ));
        }
        let (low, high) = cell.ranges[axis];
        Ok(Some((low, high - low)))
    };
    names.iter().enumerate().map(scale).collect()
}

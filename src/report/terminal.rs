//! What was found, on a terminal: scalars, a few rows of each table, and curves in braille.

use std::fmt::Write as _;
use std::ops::Range;

use super::html::glance;
use super::outputs::all;
use crate::display::figure::{Figure, Layer, Stroke};
use crate::display::{Panel, Units, log_ticks, ticks, untagged};
use crate::estimate::Analysis;
use crate::statistics::{Make, Shown, Table};

/// Rows of a table that are shown.
const ROWS: usize = 16;

/// Lines of a plot, each four dots high.
const LINES: usize = 12;
/// Columns left of a plot, for its numbers.
const GUTTER: usize = 9;

/// The scalars, then some rows of each table: all from the first to the last where there are few, else evenly among them.
/// Numbers have four digits, whole ones all, and columns stand below each other, with blanks between them.
pub fn numbers(a: &Analysis) -> String {
    let scalars: Vec<[String; 2]> = glance(a).iter().map(|(name, value)| [untagged(name), untagged(value)]).collect();
    let mut text = String::new();
    let width = scalars.iter().map(|row| row[0].chars().count()).max().unwrap_or(0);
    for [name, value] in &scalars {
        let _ = writeln!(text, "{name:width$}  {value}");
    }
    for output in all() {
        if let (Make::Table(make), Some(shown)) = (output.make, output.shown)
            && let Some(table) = make(a)
        {
            rows(&mut text, a, &shown, &table);
        }
    }
    text
}

/// Some rows of a table below its heading.
fn rows(text: &mut String, a: &Analysis, shown: &Shown, table: &Table) {
    let columns: Vec<_> = table.columns().filter(|(name, _)| shown.has(name)).collect();
    let Some(&(first, cells)) = columns.first().filter(|column| !column.1.is_empty()) else { return };
    let units = Units::of(a);
    let unit = if first.starts_with("nu") { units.rings } else { units.own_length };
    let last = cells.len() - 1;
    let taken: Vec<usize> = match cells.len() {
        n if n <= ROWS => (0..n).collect(),
        _ => (0..ROWS).map(|row| (row * last + (ROWS - 1) / 2) / (ROWS - 1)).collect(),
    };
    let symbol = first.split('_').next().unwrap_or(first);
    let _ = writeln!(text, "\n# {}, {symbol} in {unit}: {} of {} rows", shown.heading, taken.len(), cells.len());
    aligned(text, &columns, &taken);
}

/// Some columns of a table below a heading, every row.
pub(crate) fn some_columns(heading: &str, names: &[&str], table: &Table) -> String {
    let columns: Vec<_> = table.columns().filter(|(name, _)| names.contains(name)).collect();
    let rows = columns.first().map_or(0, |(_, cells)| cells.len());
    let mut text = format!("# {heading}\n");
    aligned(&mut text, &columns, &(0..rows).collect::<Vec<_>>());
    text
}

/// Rows of columns that stand below each other.
fn aligned(text: &mut String, columns: &[(&str, &[String])], taken: &[usize]) {
    let column = |&(name, cells): &(&str, &[String])| -> Vec<String> {
        let cells = taken.iter().map(|&row| cells.get(row).map_or("-".into(), |cell| four_digits(cell)));
        let cells: Vec<_> = std::iter::once(name.to_string()).chain(cells).collect();
        let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        cells.into_iter().map(|cell| format!("{cell:>width$}")).collect()
    };
    let columns: Vec<_> = columns.iter().map(column).collect();
    for row in 0..=taken.len() {
        let line: Vec<_> = columns.iter().map(|column| column[row].as_str()).collect();
        let _ = writeln!(text, "{}", line.join("  "));
    }
}

/// A cell with four significant digits, as any program reads it; a whole number, which counts something, with all of them; a dash
/// where it is empty.
fn four_digits(cell: &str) -> String {
    let Ok(x) = cell.parse::<f64>() else { return if cell.is_empty() { "-".into() } else { cell.into() } };
    if x.fract() == 0.0 && x.abs() < 1e12 {
        return format!("{x}");
    }
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// g(r) and the radial mean of P, those that are there, in a terminal of so many columns.
pub fn plots(a: &Analysis, columns: usize) -> String {
    let mut text = String::new();
    for output in all() {
        let wanted = [Panel::Pcf, Panel::Radial].iter().any(|panel| output.name == format!("{}.svg", panel.slug()));
        if let (Make::Figure(make), true) = (output.make, wanted)
            && let Some(figure) = make(a)
        {
            text.push('\n');
            plot(&mut text, &figure, columns.clamp(40, 100) - GUTTER - 1);
        }
    }
    text
}

/// An axis of so many dots.
struct Dots {
    range: Range<f64>,
    log: bool,
    count: usize,
}

impl Dots {
    /// Where a value falls; outside the axis beyond its dots.
    fn at(&self, value: f64) -> f64 {
        let place = |v: f64| if self.log { v.max(self.range.start * 1e-3).ln() } else { v };
        let (start, end) = (place(self.range.start), place(self.range.end));
        (place(value) - start) / (end - start) * (self.count - 1) as f64
    }

    /// Round numbers, and the cells of `per` dots that they fall into.
    fn ticks(&self, per: usize, target: u32) -> Vec<(usize, String)> {
        let ticks = if self.log { log_ticks(&self.range) } else { ticks(&self.range, target) };
        ticks.into_iter().map(|(t, label)| (self.at(t).round().max(0.0) as usize / per, label)).collect()
    }
}

/// Every dot of a line of cells, two by four dots each.
struct Canvas {
    width: usize,
    cells: Vec<u8>,
}

impl Canvas {
    /// Sets a dot, counted from the bottom left.
    fn dot(&mut self, x: usize, y: usize) {
        /// Bits of a braille character, from its top row down.
        const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
        if x < 2 * self.width && y < 4 * LINES {
            let down = 4 * LINES - 1 - y;
            self.cells[down / 4 * self.width + x / 2] |= BITS[down % 4][x % 2];
        }
    }
}

/// The first solid curve of a figure and its level, in braille, with round numbers along the axes.
fn plot(text: &mut String, figure: &Figure, width: usize) {
    let x = Dots { range: figure.x.clone(), log: figure.log_x, count: 2 * width };
    let y = Dots { range: figure.y.clone(), log: figure.log_y, count: 4 * LINES };
    let mut canvas = Canvas { width, cells: vec![0; width * LINES] };
    let curve = figure.layers.iter().find_map(|layer| match layer {
        Layer::Line { stroke: Stroke::Solid, runs, .. } => Some(runs),
        _ => None,
    });
    for pair in curve.into_iter().flatten().flat_map(|run| run.windows(2)) {
        let [from, to] = [pair[0], pair[1]].map(|(u, v)| [x.at(u), y.at(v).clamp(-1.0, (4 * LINES) as f64)]);
        let steps = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()).ceil().clamp(1.0, 4096.0) as usize;
        for step in 0..=steps {
            let t = step as f64 / steps as f64;
            let [u, v] = [0, 1].map(|axis| (from[axis] + t * (to[axis] - from[axis])).round());
            if u >= 0.0 && v >= 0.0 {
                canvas.dot(u as usize, v as usize);
            }
        }
    }
    for layer in &figure.layers {
        if let Layer::Level { y: level, .. } = layer
            && figure.y.contains(level)
        {
            (0..x.count).step_by(4).for_each(|u| canvas.dot(u, y.at(*level).round() as usize));
        }
    }
    let _ = writeln!(text, "{}", untagged(&figure.title));
    let rows = y.ticks(4, 4);
    for (line, cells) in canvas.cells.chunks(width).enumerate() {
        let tick = rows.iter().find(|(row, _)| LINES - 1 - row == line);
        let (label, mark) = tick.map_or(("", '│'), |(_, label)| (label.as_str(), '┤'));
        let dots: String = cells.iter().map(|&bits| char::from_u32(0x2800 + u32::from(bits)).unwrap_or(' ')).collect();
        let _ = writeln!(text, "{label:>GUTTER$}{mark}{dots}");
    }
    let columns = x.ticks(2, (width / 12) as u32);
    let axis: String = (0..width).map(|c| if columns.iter().any(|t| t.0 == c) { '┬' } else { '─' }).collect();
    let _ = writeln!(text, "{:GUTTER$}└{axis}", "");
    // A label that would touch the one before is left out.
    let mut labels = String::new();
    for (column, label) in &columns {
        let start = (GUTTER + 1 + column).saturating_sub(label.chars().count() / 2);
        let free = labels.chars().count();
        if free == 0 || start > free {
            let _ = write!(labels, "{:1$}{label}", "", start - free);
        }
    }
    let label = untagged(&figure.x_label);
    let _ = writeln!(text, "{labels}\n{:1$}{label}", "", GUTTER + 1 + width.saturating_sub(label.chars().count()) / 2);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_four_digits_that_any_program_reads() {
        for (cell, text) in [
            ("0.123456", "0.1235"),
            ("512158", "512158"),
            ("16384.0", "16384"),
            ("512158.3", "512200"),
            ("1e-9", "1e-9"),
            ("1.23456e12", "1.235e12"),
            ("0", "0"),
            ("", "-"),
            ("chi-squared", "chi-squared"),
        ] {
            assert_eq!(four_digits(cell), text);
        }
    }

    #[test]
    fn a_curve_is_drawn_where_its_values_are() {
        let figure = Figure {
            title: "a line".into(),
            subject: String::new(),
            note: String::new(),
            x_label: "x".into(),
            y_label: "y".into(),
            x: 0.0..1.0,
            y: 0.0..1.0,
            log_x: false,
            log_y: false,
            top: None,
            layers: vec![Layer::Line {
                name: String::new(),
                color: crate::display::figure::BLUE,
                width: 1.0,
                stroke: Stroke::Solid,
                runs: vec![vec![(0.0, 0.0), (1.0, 1.0)]],
                of: crate::display::figure::Of::Points,
            }],
            numbers: None,
        };
        let mut text = String::new();
        plot(&mut text, &figure, 24);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[0], "a line");
        // A diagonal: in every line two cells, one step further to the right in the line above.
        let places = |line: &str| line.chars().skip(GUTTER + 1).position(|c| c != '\u{2800}');
        let found: Vec<_> = lines[1..=LINES].iter().map(|line| places(line).unwrap()).collect();
        assert_eq!(found, (0..LINES).map(|line| 2 * (LINES - 1 - line)).collect::<Vec<_>>(), "{text}");
        assert!(lines[1].starts_with("      1.0┤") && lines[LINES].starts_with("        0┤"), "{text}");
    }
}

//! Against what the values of a table are drawn.

use crate::display::Units;
use crate::error::Result;
use crate::report::Columns;
use crate::statistics::axes::{DRAWN, Drawn};
use crate::statistics::measured::{Measured, Written, number};

/// The abscissa of a table.
pub(super) struct Axis {
    drawn: Option<&'static Drawn>,
    /// Its name where it has a column of its own.
    pub(super) column: &'static str,
    /// What of it is a unit of the axis.
    pub(super) factor: f64,
    /// Whether it may be logarithmic.
    pub(super) log: bool,
}

/// That of a table, by the name of its file without the ending: as its figures have it. Wave vectors of a list are drawn by their length.
pub(super) fn of(stem: &str) -> Axis {
    let drawn = DRAWN.into_iter().find(|drawn| drawn.table.strip_suffix(".csv") == Some(stem));
    match drawn {
        Some(drawn) => Axis { drawn: Some(drawn), column: drawn.x_column, factor: drawn.x_factor, log: drawn.log_x },
        None => Axis { drawn: None, column: "nu", factor: 1.0, log: true },
    }
}

impl Axis {
    /// The label, in these units.
    pub(super) fn label(&self, units: &Units) -> String {
        self.drawn.map_or_else(|| format!("frequency |ν| ({})", units.cycles), |drawn| drawn.x_label(units))
    }

    /// The abscissa of each row of a table, where it has one.
    pub(super) fn places(&self, measured: &Measured, table: &Columns) -> Result<Vec<Option<f64>>> {
        if let Some(places) = table.column(self.column)? {
            return Ok(places);
        }
        let ends = [format!("{}_lo", self.column), format!("{}_hi", self.column)].map(|name| table.column(&name));
        if let [Some(lo), Some(hi)] = [&ends[0], &ends[1]].map(|end| end.as_ref().ok().and_then(Option::as_ref)) {
            return Ok(lo.iter().zip(hi).map(|(lo, hi)| Some(0.5 * ((*lo)? + (*hi)?))).collect());
        }
        let cells = table.written();
        let vector: Vec<&[&str]> = measured.vector_columns(&cells);
        let length = |row: usize| {
            let squares = vector.iter().map(|column| number(column[row]).ok().flatten().map(|x| x * x));
            squares.sum::<Option<f64>>().filter(|_| !vector.is_empty()).map(f64::sqrt)
        };
        Ok((0..table.len()).map(length).collect())
    }

    /// What tells the curve of each row from others in the figure: `axis = x`; nothing where there is one.
    pub(super) fn curves(&self, cells: &Written<'_>, rows: usize) -> Vec<String> {
        let group = self.drawn.and_then(|drawn| drawn.group);
        match group.and_then(|name| Some((name, cells.find(name)?))) {
            Some((name, cells)) => cells.iter().map(|cell| format!("{name} = {}", super::shorter(cell))).collect(),
            None => vec![String::new(); rows],
        }
    }
}

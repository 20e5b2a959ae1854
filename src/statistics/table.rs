//! Tables: named columns, and the CSV files made of them.

use std::borrow::Cow;

use crate::estimate::Band;

/// The name of a column.
pub(crate) type Name = Cow<'static, str>;

/// Named columns of equal length, as a file of a result has them.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    columns: Vec<(Name, Vec<String>)>,
}

/// What a column holds, a value for each row.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// Numbers, NaN where one is undefined.
    Real(Vec<f64>),
    /// Counts.
    Integer(Vec<u64>),
    /// Words.
    Text(Vec<String>),
}

/// A float as the shortest decimal that reads back as the same f64, zero without a sign; undefined or infinite: empty.
pub(crate) fn cell(x: f64) -> String {
    if x.is_finite() { format!("{:?}", x + 0.0) } else { String::new() }
}

impl Table {
    /// Without columns.
    pub(crate) fn new() -> Self {
        Self { columns: Vec::new() }
    }

    /// Real numbers.
    pub(crate) fn floats(mut self, name: impl Into<Name>, values: impl IntoIterator<Item = f64>) -> Self {
        self.columns.push((name.into(), values.into_iter().map(cell).collect()));
        self
    }

    /// Real numbers, empty where undefined.
    pub(crate) fn optional(self, name: impl Into<Name>, values: impl IntoIterator<Item = Option<f64>>) -> Self {
        self.floats(name, values.into_iter().map(|v| v.unwrap_or(f64::NAN)))
    }

    /// Counts.
    pub(crate) fn integers(mut self, name: impl Into<Name>, values: impl IntoIterator<Item = u64>) -> Self {
        self.columns.push((name.into(), values.into_iter().map(|v| v.to_string()).collect()));
        self
    }

    /// Words.
    pub(crate) fn text(mut self, name: impl Into<Name>, values: impl IntoIterator<Item = String>) -> Self {
        self.columns.push((name.into(), values.into_iter().collect()));
        self
    }

    /// `p_lo`, `p_hi`, and in `p_band` what they rest on.
    pub(crate) fn bands(self, bands: impl Iterator<Item = Option<Band>> + Clone) -> Self {
        self.optional("p_lo", bands.clone().map(|b| Some(b?.lo)))
            .optional("p_hi", bands.clone().map(|b| Some(b?.hi)))
            .text("p_band", bands.map(|b| b.map_or(String::new(), |b| b.law.name().to_string())))
    }

    /// Names and cells of its columns.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.columns.iter().map(|(name, cells)| (name.as_ref(), cells.as_slice()))
    }

    /// How many rows it has.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(|column| column.1.len()).max().unwrap_or(0)
    }

    /// Its columns by name. Numbers are those that were written, to the bit.
    pub fn values(&self) -> impl Iterator<Item = (&str, Column)> {
        let rows = self.rows();
        self.columns.iter().map(move |(name, texts)| {
            let cells = (0..rows).map(|row| texts.get(row).map_or("", String::as_str));
            // A real number has a point or an exponent.
            let column = if texts.len() == rows && texts.iter().all(|text| text.parse::<u64>().is_ok()) {
                Column::Integer(cells.map(|cell| cell.parse().unwrap_or(0)).collect())
            } else if texts.iter().all(|text| text.is_empty() || text.parse::<f64>().is_ok()) {
                Column::Real(cells.map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
            } else {
                Column::Text(cells.map(str::to_string).collect())
            };
            (name.as_ref(), column)
        })
    }

    /// The table as CSV: one header line, then one line per row.
    pub(crate) fn csv(&self) -> std::io::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.columns.iter().map(|c| c.0.as_ref()))?;
        for row in 0..self.rows() {
            // A column that is too short leaves cells empty; the reader sees a hole, not a shifted table.
            writer.write_record(self.columns.iter().map(|c| c.1.get(row).map_or("", String::as_str)))?;
        }
        writer.into_inner().map_err(|e| e.into_error())
    }
}

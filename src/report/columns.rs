//! Tables as they are in files: columns of text.

use std::io;
use std::ops::Range;
use std::path::PathBuf;

use crate::display::Interval;
use crate::display::figure::Of;
use crate::error::{Error, Result, plural};
use crate::statistics::axes::Drawn;
use crate::statistics::measured::{Written, number};

/// A table as text.
pub(crate) struct Columns {
    path: PathBuf,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

/// A curve of a table: its name among others, where it stands, and where each value stands, with its error.
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) place: Place,
    pub(super) samples: Vec<(Interval, Option<f64>, Option<f64>)>,
}

/// Where the values of a curve stand in a table: columns and rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place {
    /// The abscissa, or both ends of it.
    pub(crate) x: Vec<usize>,
    pub(crate) y: usize,
    /// The standard error.
    pub(crate) error: Option<usize>,
    pub(crate) rows: Range<usize>,
}

impl Columns {
    /// Its cells, by columns.
    pub(crate) fn written(&self) -> Written<'_> {
        let column = |k: usize| self.rows.iter().map(|row| row.get(k).unwrap_or_default()).collect();
        Written::new(self.header.iter().enumerate().map(|(k, name)| (name.as_str(), column(k))))
    }

    /// What is wrong with a row.
    pub(crate) fn fault(&self, row: usize, why: String) -> Error {
        let line = self.rows.get(row).and_then(csv::StringRecord::position).map_or(0, csv::Position::line);
        Error::input(format!("{}:{line}", self.path.display()), why)
    }

    /// Reads a CSV file of these bytes.
    pub(crate) fn read(path: PathBuf, text: &[u8]) -> Result<Self> {
        let mut reader = csv::Reader::from_reader(text);
        let broken = |e: csv::Error| {
            let line = e.position().map_or(String::new(), |position| format!(":{}", position.line()));
            let reason = match e.kind() {
                csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                    format!(
                        "has {}; expected {expected_len}, one for each column of the first line",
                        plural(*len, "cell")
                    )
                }
                csv::ErrorKind::Utf8 { .. } => "is no UTF-8".into(),
                _ => e.to_string(),
            };
            Error::input(format!("{}{line}", path.display()), reason)
        };
        let header = reader.headers().map_err(broken)?.iter().map(str::to_string).collect();
        let rows = reader.records().collect::<csv::Result<_>>().map_err(broken)?;
        Ok(Self { path, header, rows })
    }

    /// The number of its rows.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Some of its rows, as its file has them.
    pub(super) fn csv(&self, rows: &[usize]) -> io::Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.header)?;
        rows.iter().try_for_each(|&row| writer.write_record(&self.rows[row]))?;
        String::from_utf8(writer.into_inner().map_err(|e| e.into_error())?).map_err(io::Error::other)
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|h| h == name)
    }

    /// The columns of both ends of an abscissa.
    fn ends(&self, x: &str) -> Option<(usize, usize)> {
        self.find(&format!("{x}_lo")).zip(self.find(&format!("{x}_hi")))
    }

    /// The columns of an abscissa: one, or both of its ends, between which it lies.
    fn x_columns(&self, x: &str) -> Option<Vec<usize>> {
        self.find(x).map(|column| vec![column]).or_else(|| self.ends(x).map(|(lo, hi)| vec![lo, hi]))
    }

    /// The abscissa of a row, by its columns.
    pub(super) fn abscissa(&self, row: usize, columns: &[usize]) -> Option<f64> {
        let number = |&column: &usize| self.rows[row].get(column)?.parse::<f64>().ok();
        let all: Option<Vec<f64>> = columns.iter().map(number).collect();
        all.filter(|all| !all.is_empty()).map(|all| all.iter().sum::<f64>() / all.len() as f64)
    }

    /// The column of the standard error of another; L - r errs as L does.
    fn error_of(&self, column: &str) -> Option<usize> {
        self.find(&format!("{}_se", column.replacen("l_minus_r", "l", 1)))
    }

    /// Where the numbers of a curve over an abscissa are, if they are here.
    pub(super) fn place(&self, of: &Of, x: &str) -> Option<Place> {
        let (column, rows) = match of {
            Of::Points => return None,
            Of::Column(column) => (column.as_ref(), 0..self.rows.len()),
            Of::Rows(column, other, text) => {
                let other = self.find(other)?;
                let is = |row: &csv::StringRecord| row.get(other) == Some(text);
                (*column, self.rows.iter().position(is)?..self.rows.iter().rposition(is)? + 1)
            }
        };
        Some(Place { x: self.x_columns(x)?, y: self.find(column)?, error: self.error_of(column), rows })
    }

    /// The number in a cell; none where it is empty.
    fn number(&self, row: usize, column: usize) -> Result<Option<f64>> {
        let cell = self.rows[row].get(column).unwrap_or_default();
        number(cell).map_err(|why| self.fault(row, format!("column {} {why}", self.header[column])))
    }

    /// The curves of a figure, or why there are none.
    pub(super) fn curves(&self, drawn: &Drawn) -> Result<Result<Vec<Curve>, String>> {
        let without = |column: &str| Ok(Err(format!("{} has no column {column}", self.path.display())));
        let x = drawn.x_column;
        let ends = self.ends(x);
        if ends.is_none() && self.find(x).is_none() {
            return without(x);
        }
        let x_columns = self.x_columns(x).unwrap_or_default();
        let group = match drawn.group {
            Some(name) if self.find(name).is_none() => return without(name),
            name => name.and_then(|name| self.find(name)),
        };
        let mut abscissae = Vec::with_capacity(self.rows.len());
        for row in 0..self.rows.len() {
            let at = |column: Option<usize>| match column {
                Some(column) => Ok(self.number(row, column)?.map(|x| x / drawn.x_factor)),
                None => Ok(None),
            };
            let (lo, x, hi) = (at(ends.map(|e| e.0))?, at(self.find(x))?, at(ends.map(|e| e.1))?);
            let middle = x.or_else(|| Some(0.5 * (lo? + hi?)));
            abscissae.push(middle.map(|x| (lo.unwrap_or(x), x, hi.unwrap_or(x))));
        }
        let mut curves: Vec<Curve> = Vec::new();
        for (wanted, name) in drawn.curves {
            let prefix = wanted.ends_with('_');
            let is = |h: &str| if prefix { h.starts_with(wanted) && !h.ends_with("_se") } else { h == *wanted };
            let columns: Vec<usize> = (0..self.header.len()).filter(|&k| is(&self.header[k])).collect();
            if columns.is_empty() {
                return without(&if prefix { format!("{wanted}…") } else { (*wanted).into() });
            }
            for column in columns {
                let header = &self.header[column];
                let error = self.error_of(header);
                let errors = error.filter(|_| drawn.bands);
                let own = if prefix { header[wanted.len()..].replace('_', " – ") } else { (*name).to_string() };
                let mut last: Option<&str> = None;
                for (row, &x) in abscissae.iter().enumerate() {
                    let of = group.map(|group| self.rows[row].get(group).unwrap_or_default());
                    if row == 0 || of != last {
                        let name = match (drawn.group, of) {
                            (Some(group), Some(of)) => format!("{group} = {}", of.get(..8).unwrap_or(of)),
                            _ => own.clone(),
                        };
                        let place = Place { x: x_columns.clone(), y: column, error, rows: row..row };
                        curves.push(Curve { name, samples: Vec::new(), place });
                        last = of;
                    }
                    curves.last_mut().into_iter().for_each(|curve| curve.place.rows.end = row + 1);
                    let (Some(x), Some(curve)) = (x, curves.last_mut()) else { continue };
                    let error = errors.map_or(Ok(None), |column| self.number(row, column))?;
                    curve.samples.push((x, self.number(row, column)?, error));
                }
            }
        }
        let defined = curves.iter().any(|c| c.samples.iter().any(|s| s.1.is_some()));
        Ok(if defined { Ok(curves) } else { Err(format!("{} has no values of it", self.path.display())) })
    }

    /// A column of numbers, if it is there, where its rows are of one curve.
    pub(crate) fn column(&self, name: &str) -> Result<Option<Vec<Option<f64>>>> {
        let Some(column) = self.find(name) else { return Ok(None) };
        (0..self.rows.len()).map(|row| self.number(row, column)).collect::<Result<_>>().map(Some)
    }

    /// r and the ends of the global envelope of a curve.
    pub(super) fn envelope(&self, curve: &str) -> Result<Vec<[Option<f64>; 3]>> {
        let [Some(of), Some(r), Some(lo), Some(hi)] = ["curve", "r", "global_lo", "global_hi"].map(|c| self.find(c))
        else {
            return Ok(Vec::new());
        };
        let rows = (0..self.rows.len()).filter(|&row| self.rows[row].get(of) == Some(curve));
        rows.map(|row| Ok([self.number(row, r)?, self.number(row, lo)?, self.number(row, hi)?])).collect()
    }
}

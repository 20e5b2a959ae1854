//! Results side by side: the difference of every value that has a standard error, in standard errors, and whether any of them is more than chance.
//!
//! Values of two results are compared row by row where their tables have the same bins, rings, wave vectors or integrands. A difference over the
//! root of the sum of both squared errors has, where the results agree, Student's distribution with the degrees of freedom of Welch (1947): an
//! error across K realizations has K - 1, one of theory has infinitely many. Rows are many and depend on each other, so p is corrected by Holm's
//! (1979) step-down rule, which holds under any dependence: within each column of values, then over columns and results by their smallest.

mod axis;
mod beside;
mod page;
mod text;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

pub use beside::{beside, check_beside, unmarked};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::error::{Error, Result};
use crate::report::{self, Asked, Columns, Stored};
use crate::setting::Setting;
use crate::statistics::Table;
use crate::statistics::measured::{Column, MEASURED, Measured, Written, number};

/// The level of significance where none is asked for.
pub const ALPHA: f64 = 0.01;

/// Results, the first of which the others are compared with.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Comparison {
    /// The directories of the results.
    pub results: Vec<String>,
    /// Level of the test over everything.
    pub alpha: f64,
    /// Whether any other result differs from the first at that level.
    pub differ: bool,
    /// Each column of values of each other result, in the order of the tables.
    pub columns: Vec<Compared>,
    /// What could not be compared, and what to know of what was.
    pub notes: Vec<String>,
    /// Each value.
    #[serde(skip)]
    pub values: Vec<Difference>,
}

/// A column of values of two results.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Compared {
    /// The other result, from 1.
    pub with: usize,
    /// Its table and its name, `pcf.g`.
    pub figure: String,
    /// Rows that both have, with errors.
    pub rows: usize,
    /// The largest difference of them, in standard errors; infinite (null in JSON) where values without error differ.
    pub z: f64,
    /// Where it is.
    pub place: String,
    /// Both values there.
    pub values: [f64; 2],
    /// The smallest p of its rows, corrected for their number.
    pub p: f64,
    /// The same, corrected for all columns and results.
    pub p_of_all: f64,
}

/// A value of two results.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Difference {
    /// The other result, from 1.
    pub with: usize,
    /// Table and column.
    pub figure: String,
    /// What tells the row from others.
    pub place: String,
    /// The distance, frequency or direction of the row, as its table has it; none of what is along no axis.
    pub x: Option<f64>,
    /// What tells its curve from others in a figure, `axis = x`; empty where there is one.
    pub curve: String,
    /// The values with their errors, of the first and the other result.
    pub values: [(f64, f64); 2],
    /// The other less the first, in standard errors of the difference.
    pub z: f64,
    /// Degrees of freedom of its error; infinite for errors of theory.
    pub degrees: f64,
    /// Probability of one as large where both are alike.
    pub p: f64,
    /// Corrected for the rows of its column.
    pub p_adjusted: f64,
}

/// Compares results with the first of them, at a level of significance.
///
/// # Errors
/// What is no result or no table; results that have nothing in common; `alpha` beyond 0 to 1.
pub fn compare(dirs: &[PathBuf], alpha: f64) -> Result<Comparison> {
    if !(alpha > 0.0 && alpha < 1.0) {
        return Err(Error::setting(Setting::Alpha, alpha, "expected a level of significance between 0 and 1, as 0.01"));
    }
    let results = dirs.iter().map(|dir| Stored::open(dir)).collect::<Result<Vec<_>>>()?;
    let Some((first, others)) = results.split_first().filter(|(_, others)| !others.is_empty()) else {
        return Err(Error::input("compare", "expected two results or more"));
    };
    let mut found = Comparison {
        results: dirs.iter().map(|dir| dir.display().to_string()).collect(),
        alpha,
        differ: false,
        columns: Vec::new(),
        notes: Vec::new(),
        values: Vec::new(),
    };
    for (k, other) in others.iter().enumerate() {
        found.add(k + 1, first, other)?;
    }
    let least: Vec<f64> = found.columns.iter().map(|column| column.p).collect();
    for (column, p) in found.columns.iter_mut().zip(holm(&least)) {
        column.p_of_all = p;
    }
    found.differ = found.columns.iter().any(|column| column.p_of_all <= alpha);
    Ok(found)
}

impl Comparison {
    /// Compares one more result with the first.
    fn add(&mut self, with: usize, first: &Stored, other: &Stored) -> Result<()> {
        let (before, noted, there) = (self.columns.len(), self.notes.len(), other.dir().display().to_string());
        self.notes.extend(first.differences(other).into_iter().map(|what| format!("measured otherwise: {what}")));
        if first.shares_points_with(other) {
            self.notes.push(format!(
                "{there} is of the same points as {}: errors that both have alike are not seen in their difference",
                first.dir().display()
            ));
        }
        for measured in &MEASURED {
            let file = format!("{}.csv", measured.stem);
            let (a, b) = match (first.table(&file)?, other.table(&file)?) {
                (Some(a), Some(b)) => (a, b),
                (None, None) => continue,
                (None, Some(_)) => {
                    self.notes.push(format!("{file}: {} does not have it", first.dir().display()));
                    continue;
                }
                (Some(_), None) => {
                    self.notes.push(format!("{file}: {there} does not have it"));
                    continue;
                }
            };
            self.tables(with, measured, [&a, &b], [freedom(first), freedom(other)])?;
        }
        if self.columns.len() == before {
            let why = self.notes[noted..].join("; ");
            let reason = format!("has no bins, rings or integrands in common with {}: {why}", first.dir().display());
            return Err(Error::input(there, reason));
        }
        Ok(())
    }

    /// Compares the tables of a name.
    fn tables(&mut self, with: usize, measured: &Measured, both: [&Columns; 2], freedom: [f64; 2]) -> Result<()> {
        let [a, b] = both.map(Columns::written);
        let keys = [&a, &b].map(|cells| places(measured, cells));
        let rows: HashMap<&str, usize> =
            keys[1].iter().enumerate().map(|(row, place)| (place.0.as_str(), row)).collect();
        let common: Vec<(usize, usize)> =
            keys[0].iter().enumerate().filter_map(|(row, place)| Some((row, *rows.get(place.0.as_str())?))).collect();
        let stem = measured.stem;
        let alone = [keys[0].len() - common.len(), keys[1].len().saturating_sub(common.len())];
        if common.is_empty() {
            self.notes
                .push(format!("{stem}.csv: no row of one is a row of the other: their bins or frequencies differ"));
            return Ok(());
        }
        if alone != [0, 0] {
            self.notes.push(format!(
                "{stem}.csv: {} rows are compared; {} are in the first alone, {} in the other alone",
                common.len(),
                alone[0],
                alone[1]
            ));
        }
        let axis = axis::of(stem);
        let (along, curves) = (axis.places(measured, both[0])?, axis.curves(&a, both[0].len()));
        let others = measured.columns(&b);
        let mine = measured.columns(&a);
        let has = |columns: &[Column<'_>], name: &str| columns.iter().any(|column| column.name == name);
        for (columns, against, which) in [(&mine, &others, "first"), (&others, &mine, "other")] {
            let alone = columns.iter().filter(|column| !has(against, column.name));
            self.notes.extend(alone.map(|column| format!("{stem}.{} is in the {which} alone", column.name)));
        }
        for column in mine {
            let Some(other) = others.iter().find(|other| other.name == column.name) else { continue };
            if column.follows_realizations() && freedom[0] != freedom[1] {
                let name = column.name;
                self.notes.push(format!(
                    "{stem}.{name} falls with the number of realizations, and is not compared: they differ"
                ));
                continue;
            }
            let start = self.values.len();
            let figure = format!("{stem}.{}", column.name);
            let scale = [(both[0], &column), (both[1], other)].map(|(table, column)| column.scale(table.len()));
            let scale = scale[0].max(scale[1]);
            for &(i, j) in &common {
                let found = [(both[0], &column, i), (both[1], other, j)].map(
                    |(table, column, row): (&Columns, &Column<'_>, usize)| {
                        column.at(row).map_err(|why| table.fault(row, why))
                    },
                );
                let [x, y] = found;
                let (Some((x, Some(x_se))), Some((y, Some(y_se)))) = (x?, y?) else { continue };
                let Tested { z, degrees, p } = difference([(x, x_se), (y, y_se)], freedom, scale);
                self.values.push(Difference {
                    with,
                    figure: figure.clone(),
                    place: keys[0][i].1.clone(),
                    x: along[i],
                    curve: curves[i].clone(),
                    values: [(x, x_se), (y, y_se)],
                    z,
                    degrees,
                    p,
                    p_adjusted: 1.0,
                });
            }
            let mine = &mut self.values[start..];
            let adjusted = holm(&mine.iter().map(|value| value.p).collect::<Vec<_>>());
            mine.iter_mut().zip(adjusted).for_each(|(value, p)| value.p_adjusted = p);
            let largest = mine.iter().min_by(|a, b| a.p.total_cmp(&b.p).then(b.z.abs().total_cmp(&a.z.abs())));
            if let Some(largest) = largest {
                self.columns.push(Compared {
                    with,
                    figure,
                    rows: mine.len(),
                    z: largest.z,
                    place: largest.place.clone(),
                    values: largest.values.map(|value| value.0),
                    p: largest.p_adjusted,
                    p_of_all: 1.0,
                });
            }
        }
        Ok(())
    }

    /// Every value, as a table.
    pub fn table(&self) -> Table {
        let all = &self.values;
        let end = |which: usize| move |value: &Difference| value.values[which];
        let difference = |value: &Difference| value.values[1].0 - value.values[0].0;
        Table::new()
            .text("result", all.iter().map(|value| self.results[value.with].clone()))
            .text("figure", all.iter().map(|value| value.figure.clone()))
            .text("place", all.iter().map(|value| value.place.clone()))
            .floats("first", all.iter().map(end(0)).map(|value| value.0))
            .floats("first_se", all.iter().map(end(0)).map(|value| value.1))
            .floats("other", all.iter().map(end(1)).map(|value| value.0))
            .floats("other_se", all.iter().map(end(1)).map(|value| value.1))
            .floats("difference", all.iter().map(difference))
            .floats("z", all.iter().map(|value| value.z))
            .floats("p", all.iter().map(|value| value.p))
            .floats("p_adjusted", all.iter().map(|value| value.p_adjusted))
    }

    /// Writes the table of every value, a page with all figures of the results over each other, and a summary into a directory.
    ///
    /// # Errors
    /// As `report::write`.
    pub fn write(&self, dir: &Path, asked: &Asked, force: bool) -> Result<Vec<PathBuf>> {
        let dirs: Vec<PathBuf> = self.results.iter().map(PathBuf::from).collect();
        let page = report::Plot::page_with(&dirs, &dir.join(report::PAGE), self)?;
        let own = serde_json::json!({ "comparison": self });
        report::write_files(dir, force, asked, &self.notes, own, |files| {
            let table = self.table().csv();
            files.add("comparison.csv", |file| file.write_all(&table?));
            files.add(report::PAGE, |file| file.write_all(page.as_bytes()));
        })
    }
}

/// Degrees of freedom of the errors of a result.
fn freedom(of: &Stored) -> f64 {
    match of.value("/k").and_then(serde_json::Value::as_u64) {
        Some(k) if k > 1 => (k - 1) as f64,
        _ => f64::INFINITY,
    }
}

/// What tells each row of a table from the others: to be looked up, and in words.
fn places(measured: &Measured, cells: &Written<'_>) -> Vec<(String, String)> {
    let columns = measured.key_columns(cells);
    let rows = columns.first().map_or(0, |(_, cells)| cells.len());
    // Ends of bins may differ by the rounding of what they were computed from.
    let alike = |cell: &str| match number(cell) {
        Ok(Some(x)) => format!("{x:.9e}"),
        _ => cell.to_string(),
    };
    let place = |row: usize| {
        let cells = || columns.iter().map(|(name, cells)| (*name, cells[row]));
        let key: Vec<String> = cells().map(|(_, cell)| alike(cell)).collect();
        let words: Vec<String> = cells().map(|(name, cell)| in_words(name, &shorter(cell))).collect();
        (key.join(","), words.join("").trim_start_matches([',', ' ']).to_string())
    };
    (0..rows).map(place).collect()
}

/// `, r 0.1`, and of an interval ` to 0.2` behind it.
fn in_words(name: &str, cell: &str) -> String {
    match (name.strip_suffix("_lo"), name.ends_with("_hi")) {
        (Some(name), _) => format!(", {name} {cell}"),
        (None, true) => format!(" to {cell}"),
        (None, false) => format!(", {name} {cell}"),
    }
}

/// A number with the digits that a reader needs.
fn shorter(cell: &str) -> String {
    match number(cell) {
        Ok(Some(x)) if cell.len() > 8 => crate::display::human(x),
        _ => cell.to_string(),
    }
}

/// A difference in standard errors, their degrees of freedom, and its p.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tested {
    z: f64,
    degrees: f64,
    p: f64,
}

/// The law of a difference in standard errors where there is none: Student's, or the normal one of errors of theory.
enum Law {
    Student(StudentsT),
    Normal(Normal),
}

impl Law {
    fn of(degrees: f64) -> Self {
        let student = StudentsT::new(0.0, 1.0, degrees).ok().filter(|_| degrees.is_finite());
        student.map_or_else(|| Self::Normal(Normal::standard()), Self::Student)
    }
}

/// Probability of a difference of z standard errors, or a larger one, where there is none.
fn probability(z: f64, degrees: f64) -> f64 {
    let tail = match Law::of(degrees) {
        Law::Student(law) => law.cdf(-z.abs()),
        Law::Normal(law) => law.cdf(-z.abs()),
    };
    if z.is_finite() { (2.0 * tail).min(1.0) } else { 0.0 }
}

/// The standard errors whose probability is this.
fn critical(p: f64, degrees: f64) -> f64 {
    match Law::of(degrees) {
        Law::Student(law) => -law.inverse_cdf(0.5 * p),
        Law::Normal(law) => -law.inverse_cdf(0.5 * p),
    }
}

/// The difference of two values in standard errors, and its p. What is no more than rounding is none.
fn difference([(a, a_se), (b, b_se)]: [(f64, f64); 2], freedom: [f64; 2], scale: f64) -> Tested {
    /// Of the values of a column: how well two ways of computing them agree, P by `accuracy` fast of uniform points.
    const ROUNDING: f64 = 1e-5;
    // Errors that are rounding of values which are all alike.
    let [a_se, b_se] = [(a, a_se), (b, b_se)].map(|(x, se)| if se <= 1e-12 * x.abs().max(scale) { 0.0 } else { se });
    if a == b || a_se == 0.0 && b_se == 0.0 && (b - a).abs() <= ROUNDING * scale {
        return Tested { z: 0.0, degrees: freedom[0].min(freedom[1]), p: 1.0 };
    }
    // Values that are all alike say little of how they vary: where nothing was counted, something might have been.
    let ([a_se, b_se], of_one) = match (a_se > 0.0, b_se > 0.0) {
        (false, true) => ([b_se; 2], Some(freedom[1])),
        (true, false) => ([a_se; 2], Some(freedom[0])),
        _ => ([a_se, b_se], None),
    };
    let (a2, b2) = (a_se * a_se, b_se * b_se);
    let z = (b - a) / (a2 + b2).sqrt();
    let welch = || (a2 + b2) * (a2 + b2) / (a2 * a2 / freedom[0] + b2 * b2 / freedom[1]);
    let degrees = of_one.unwrap_or_else(welch);
    Tested { z, degrees, p: probability(z, degrees) }
}

/// p-values corrected for their number by Holm's step-down rule.
fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let (mut corrected, mut largest) = (vec![1.0; p.len()], 0.0f64);
    for (rank, &at) in order.iter().enumerate() {
        largest = largest.max(((p.len() - rank) as f64 * p[at]).min(1.0));
        corrected[at] = largest;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_is_that_of_welch_and_holm() {
        // Welch's test of means 20.6 and 22.1 with variances of the means 0.5 and 0.4 and 14 and 9 degrees: t = 1.5811, 23.0 degrees.
        let Tested { z, p, .. } = difference([(20.6, 0.5f64.sqrt()), (22.1, 0.4f64.sqrt())], [14.0, 9.0], 0.0);
        assert!((z - 1.581_139).abs() < 1e-5, "{z}");
        let degrees = 0.81 / (0.25 / 14.0 + 0.16 / 9.0);
        let exact = 2.0 * StudentsT::new(0.0, 1.0, degrees).unwrap().cdf(-1.581_138_830_084_19);
        assert!((p - exact).abs() < 1e-9, "{p} {exact}");
        // Errors of theory: normal.
        let Tested { p, .. } = difference([(0.0, 0.6), (1.959_963_985, 0.8)], [f64::INFINITY; 2], 0.0);
        assert!((p - 0.05).abs() < 1e-8, "{p}");
        // One error stands for both, with the degrees of freedom that it has; rounding is no difference.
        let Tested { z, p, .. } = difference([(1.0, 0.0), (2.0, 0.3)], [99.0, 3.0], 0.0);
        let exact = 2.0 * StudentsT::new(0.0, 1.0, 3.0).unwrap().cdf(-z);
        assert!((z - 2.357_022_603).abs() < 1e-8 && (p - exact).abs() < 1e-12, "{z} {p}");
        let zp = |both, freedom, scale| {
            let found = difference(both, freedom, scale);
            (found.z, found.p)
        };
        assert_eq!(zp([(0.485, 0.0), (0.485 + 1e-9, 1e-18)], [3.0; 2], 1.0), (0.0, 1.0));
        assert_eq!(zp([(1.0, 0.0), (1.0, 0.0)], [9.0; 2], 0.0), (0.0, 1.0));
        assert_eq!(zp([(1.0, 0.0), (2.0, 0.0)], [9.0; 2], 0.0), (f64::INFINITY, 0.0));
        let Tested { z, .. } = difference([(0.0, 0.0), (2.0, 1.0)], [9.0; 2], 0.0);
        assert!((z - 2.0f64.sqrt()).abs() < 1e-15, "{z}");
        assert_eq!(holm(&[0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02]);
        assert_eq!(holm(&[0.5, 0.6]), [1.0, 1.0]);
    }

    #[test]
    fn critical_values_are_those_whose_p_is_the_level() {
        assert!((critical(0.05, f64::INFINITY) - 1.959_963_985).abs() < 1e-8);
        // Tables of Student's law.
        assert!((critical(0.05, 10.0) - 2.228_139).abs() < 1e-5 && (critical(0.01, 4.0) - 4.604_095).abs() < 1e-5);
        for degrees in [3.0, 17.3, 118.7, f64::INFINITY] {
            for p in [0.05, 1e-4, 1e-7] {
                assert!((probability(critical(p, degrees), degrees) / p - 1.0).abs() < 1e-6, "{degrees} {p}");
            }
        }
    }
}

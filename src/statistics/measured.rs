//! Values with standard errors in the tables of a result: what tells rows apart, and which columns are values.

use super::{Make, ROOMS, Table};
use crate::estimate::Analysis;

/// What tells a row of a table from the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Key {
    /// A word or an integer, as it stands there.
    Word(&'static str),
    /// A place in an interval, `r_lo` to `r_hi`.
    Within(&'static str),
    /// A place; the nearest there is.
    Nearest(&'static str),
    /// A vector: every column that begins so.
    Vector(&'static str),
}

/// A table of values with standard errors, columns `x` and `x_se`.
#[derive(Debug)]
pub(crate) struct Measured {
    /// Of its file, without the ending.
    pub(crate) stem: &'static str,
    pub(crate) keys: &'static [Key],
    /// The columns of values, that which is meant where none is named first. `g_` is all that begin like it.
    values: &'static [&'static str],
}

const R: &[Key] = &[Key::Within("r")];
const AT_R: &[Key] = &[Key::Nearest("r")];

/// All of them, in the order of the page.
pub(crate) static MEASURED: [Measured; 12] = [
    Measured { stem: "pcf", keys: R, values: &["g", "g_kernel"] },
    Measured { stem: "pcf_cross", keys: R, values: &["g_"] },
    Measured { stem: "k_function", keys: AT_R, values: &["k", "l"] },
    Measured { stem: "k_function_cross", keys: AT_R, values: &["k_", "l_"] },
    Measured { stem: "pcf_angular", keys: &[Key::Within("r"), Key::Within("theta")], values: &["g"] },
    Measured { stem: "spectrum_radial", keys: &[Key::Within("nu")], values: &["p", "anisotropy_db"] },
    Measured { stem: "spectrum_axes", keys: &[Key::Word("axis"), Key::Word("m")], values: &["p"] },
    Measured { stem: "spectrum_angular", keys: &[Key::Within("theta")], values: &["p", "ratio"] },
    Measured { stem: "spectrum_list", keys: &[Key::Vector("nu_")], values: &["p"] },
    Measured { stem: "neighbor_functions", keys: AT_R, values: &["g_function", "f_function"] },
    Measured {
        stem: "variance",
        keys: &[Key::Word("integrand")],
        values: &[
            "var_spectral",
            "var_spatial",
            "var_shifted",
            "var_observed",
            "mse_predicted",
            "mean",
            "bias",
            "phase",
        ],
    },
    Measured {
        stem: "counts",
        keys: &[Key::Word("shape"), Key::Nearest("size")],
        values: &["dispersion", "variance", "mean"],
    },
];

/// Columns of a table as they are written.
pub(crate) struct Written<'a>(Vec<(&'a str, Vec<&'a str>)>);

/// A value with its standard error, if that is known.
pub(crate) type WithError = (f64, Option<f64>);

/// A column of values, with their errors.
pub(crate) struct Column<'a> {
    pub(crate) name: &'a str,
    values: &'a [&'a str],
    errors: &'a [&'a str],
}

impl<'a> Written<'a> {
    /// Names and cells of columns.
    pub(crate) fn new(columns: impl IntoIterator<Item = (&'a str, Vec<&'a str>)>) -> Self {
        Self(columns.into_iter().collect())
    }

    /// The cells of a column.
    pub(crate) fn find(&self, name: &str) -> Option<&[&'a str]> {
        self.0.iter().find(|(column, _)| *column == name).map(|(_, cells)| cells.as_slice())
    }
}

impl Table {
    fn written(&self) -> Written<'_> {
        Written::new(self.columns().map(|(name, cells)| (name, cells.iter().map(String::as_str).collect())))
    }
}

/// The number in a cell; none where it is empty.
pub(crate) fn number(cell: &str) -> Result<Option<f64>, String> {
    match cell.parse::<f64>() {
        _ if cell.is_empty() => Ok(None),
        Ok(x) if x.is_finite() => Ok(Some(x)),
        _ => Err(format!("holds {cell}; expected a number, or nothing")),
    }
}

impl<'a> Column<'a> {
    /// Whether the value itself, not its error alone, follows from how many realizations there are: anisotropy is what they leave of chance.
    pub(crate) fn follows_realizations(&self) -> bool {
        self.name == "anisotropy_db"
    }

    /// The largest magnitude of its values.
    pub(crate) fn scale(&self, rows: usize) -> f64 {
        let values = (0..rows).filter_map(|row| self.at(row).ok().flatten());
        values.fold(0.0, |largest, (value, _)| value.abs().max(largest))
    }

    /// The value in a row with its error; none where there is none.
    pub(crate) fn at(&self, row: usize) -> Result<Option<WithError>, String> {
        let cell = |cells: &[&str]| number(cells.get(row).copied().unwrap_or_default());
        let value = cell(self.values).map_err(|why| format!("column {} {why}", self.name))?;
        let error = cell(self.errors).map_err(|why| format!("column {}_se {why}", self.name))?;
        Ok(value.map(|value| (value, error)))
    }
}

impl Measured {
    /// By the name of its file, with or without the ending.
    pub(crate) fn named(stem: &str) -> Option<&'static Self> {
        MEASURED.iter().find(|measured| measured.stem == stem.trim_end_matches(".csv"))
    }

    /// The table of an analysis, if it has it.
    pub(crate) fn table(&self, a: &Analysis) -> Option<Table> {
        let mut outputs = ROOMS.iter().flat_map(|room| room.outputs());
        match outputs.find(|output| output.name.strip_suffix(".csv") == Some(self.stem))?.make {
            Make::Table(make) => make(a),
            _ => None,
        }
    }

    /// The columns of values there are, the one that is meant where none is named first.
    pub(crate) fn columns<'a>(&self, cells: &'a Written<'a>) -> Vec<Column<'a>> {
        let with_errors = |(name, values): &'a (&'a str, Vec<&'a str>)| {
            Some(Column { name, values, errors: cells.find(&format!("{name}_se"))? })
        };
        let named = |name: &str, wanted: &str| match wanted.ends_with('_') {
            true => name.starts_with(wanted) && !name.starts_with("l_minus_r"),
            false => name == wanted,
        };
        let of = |wanted| cells.0.iter().filter(move |(name, _)| named(name, wanted)).filter_map(with_errors);
        self.values.iter().flat_map(|wanted| of(*wanted)).collect()
    }

    /// The columns whose cells tell its rows apart.
    pub(crate) fn key_columns<'a, 'b>(&self, cells: &'b Written<'a>) -> Vec<(&'a str, &'b [&'a str])> {
        let is = |name: &str| {
            self.keys.iter().any(|key| match key {
                Key::Word(of) | Key::Nearest(of) => name == *of,
                Key::Within(of) => name.strip_prefix(of).is_some_and(|end| matches!(end, "_lo" | "_hi")),
                Key::Vector(of) => name.starts_with(of),
            })
        };
        cells.0.iter().filter(|(name, _)| is(name)).map(|(name, cells)| (*name, cells.as_slice())).collect()
    }

    /// The columns of its vectors, if it is of vectors.
    pub(crate) fn vector_columns<'a, 'b>(&self, cells: &'b Written<'a>) -> Vec<&'b [&'a str]> {
        let is = |name: &str| self.keys.iter().any(|key| matches!(key, Key::Vector(of) if name.starts_with(of)));
        cells.0.iter().filter(|(name, _)| is(name)).map(|(_, cells)| cells.as_slice()).collect()
    }

    /// The row of a place: one word or number for each key, separated by commas.
    pub(crate) fn row(&self, cells: &Written<'_>, place: &str) -> Result<usize, String> {
        let rows = cells.0.first().map_or(0, |(_, cells)| cells.len());
        let mut left: Vec<usize> = (0..rows).collect();
        let vector = |of: &str| cells.0.iter().filter(|(name, _)| name.starts_with(of)).count();
        let words: usize = self.keys.iter().map(|key| if let Key::Vector(of) = key { vector(of) } else { 1 }).sum();
        // The last takes the rest: specifications of integrands have commas.
        let mut given = place.splitn(words, ',').map(str::trim);
        let told: Vec<String> = self.keys.iter().map(|key| key.words()).collect();
        let mut next = || given.next().ok_or_else(|| format!("expected {}", told.join(",")));
        let parsed =
            |text: &str| number(text).ok().flatten().ok_or_else(|| format!("has no place {text:?}; expected a number"));
        let of = |name: &str| cells.find(name).ok_or_else(|| format!("there is no column {name}"));
        for key in self.keys {
            match key {
                Key::Word(name) => {
                    let (cells, word) = (of(name)?, next()?);
                    left.retain(|&row| cells[row] == word);
                }
                Key::Within(name) => {
                    let (lo, hi) = (of(&format!("{name}_lo"))?, of(&format!("{name}_hi"))?);
                    let x = parsed(next()?)?;
                    let end = |cells: &[&str], row: usize| number(cells[row]).ok().flatten().unwrap_or(f64::NAN);
                    left.retain(|&row| end(lo, row) <= x && x < end(hi, row));
                }
                Key::Nearest(name) => {
                    let (cells, x) = (of(name)?, parsed(next()?)?);
                    let far = |row: usize| number(cells[row]).ok().flatten().map_or(f64::INFINITY, |at| (at - x).abs());
                    let least = left.iter().map(|&row| far(row)).fold(f64::INFINITY, f64::min);
                    // No farther than its neighbours are.
                    let ends = left.iter().filter_map(|&row| number(cells[row]).ok().flatten());
                    let (lo, hi) =
                        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), at| (lo.min(at), hi.max(at)));
                    left.retain(|&row| far(row) == least && (lo - 1e-9 * lo.abs()..=hi + 1e-9 * hi.abs()).contains(&x));
                }
                Key::Vector(of) => {
                    for (_, cells) in cells.0.iter().filter(|(name, _)| name.starts_with(of)) {
                        let x = parsed(next()?)?;
                        let same = |at: f64| (at - x).abs() <= 1e-9 * x.abs().max(1.0);
                        left.retain(|&row| number(cells[row]).ok().flatten().is_some_and(same));
                    }
                }
            }
        }
        left.first().copied().ok_or_else(|| {
            let all = self.words(cells);
            format!("has no row there; expected {}: {all}", told.join(","))
        })
    }

    /// What the keys of its rows may be.
    fn words(&self, cells: &Written<'_>) -> String {
        const SOME: usize = 8;
        let one = |name: &str, ends: [&str; 2]| {
            let numbers = |end: &str| {
                let cells = cells.find(&format!("{name}{end}")).unwrap_or_default();
                cells.iter().filter_map(|cell| number(cell).ok().flatten()).collect::<Vec<_>>()
            };
            let least = numbers(ends[0]).into_iter().fold(f64::INFINITY, f64::min);
            let most = numbers(ends[1]).into_iter().fold(f64::NEG_INFINITY, f64::max);
            format!("{name} from {least} to {most}")
        };
        let each = self.keys.iter().map(|key| match key {
            Key::Word(name) => {
                let mut words: Vec<&str> = Vec::new();
                for word in cells.find(name).unwrap_or_default() {
                    if !words.contains(word) {
                        words.push(word);
                    }
                }
                let more = if words.len() > SOME { ", …" } else { "" };
                words.truncate(SOME);
                format!("{name} {}{more}", words.join(" or "))
            }
            Key::Within(name) => one(name, ["_lo", "_hi"]),
            Key::Nearest(name) => one(name, ["", ""]),
            Key::Vector(name) => format!("a vector of the list ({name}x, …)"),
        });
        each.collect::<Vec<_>>().join(", ")
    }

    /// A value of an analysis: the name of its column, the value, its error.
    pub(crate) fn value(
        &self,
        a: &Analysis,
        column: Option<&str>,
        place: &str,
    ) -> Result<(String, Option<WithError>), String> {
        let table = self.table(a).ok_or_else(|| format!("the run has no {}.csv", self.stem))?;
        let cells = table.written();
        let columns = self.columns(&cells);
        let names = || columns.iter().map(|column| column.name).collect::<Vec<_>>().join(", ");
        let Some(found) = columns.iter().find(|of| column.is_none_or(|column| column == of.name)) else {
            return Err(format!("{}.csv has no such column of values; expected {}", self.stem, names()));
        };
        let row = self.row(&cells, place).map_err(|why| format!("{}.csv {why}", self.stem))?;
        Ok((found.name.to_string(), found.at(row)?))
    }
}

/// The median over the first table there is of the error of the column that is meant by it, with the name of the column.
pub(crate) fn median_error(a: &Analysis) -> Option<(&'static str, f64)> {
    MEASURED.iter().find_map(|measured| {
        let table = measured.table(a)?;
        let cells = table.written();
        let column = measured.columns(&cells).into_iter().next()?;
        let mut errors: Vec<f64> = (0..column.values.len()).filter_map(|row| column.at(row).ok()??.1).collect();
        errors.sort_unstable_by(f64::total_cmp);
        let name = measured.values[0];
        Some((name.trim_end_matches('_'), *errors.get(errors.len() / 2)?))
    })
}

impl Key {
    fn words(self) -> String {
        match self {
            Self::Word(name) | Self::Within(name) | Self::Nearest(name) => name.to_uppercase(),
            Self::Vector(name) => format!("{}X,…", name.to_uppercase()),
        }
    }
}

//! Numbers of a result that are to be known to an error, and when they are.
//!
//! A run that ends as soon as an estimated standard error is small enough ends too early where it is underestimated, and the interval about the
//! value holds the truth less often than it says. So looks are few, at numbers of realizations that are fixed beforehand (64, then an eighth
//! more each time, whole leaves), and the error that is looked at, and stated, is two standard deviations of an estimated standard error above
//! the estimate: `s.e. (1 + 2 / sqrt(2 K))`, of K values whose kurtosis is that of a normal law. Both vanish as K grows: such rules are
//! consistent and efficient (Chow & Robbins 1965).

use std::fmt;
use std::str::FromStr;

use super::measured::{MEASURED, Measured};
use super::{Keys, Room};
use crate::display::human;
use crate::error::plural;
use crate::estimate::Analysis;

/// The first look, in realizations.
const FIRST: u64 = 64;

/// A number of a result that is to be known to an error: `pcf@0.05:0.01`, `spectrum_radial.p@20:2%`, `variance.var_spectral@disk:5%`,
/// `spectrum@3,-4:0.1`.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// As it was typed.
    typed: String,
    figure: String,
    what: What,
    error: f64,
    /// Whether the error is a fraction of the value.
    relative: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum What {
    /// A value of a table: its stem, its column if it is named, its place.
    Cell(&'static str, Option<String>, String),
    /// P at a wave vector of the grid.
    Mode(Vec<i32>),
}

/// How a target stands.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Standing {
    /// The number, as it was asked for.
    pub figure: String,
    /// The column that it stands in.
    pub column: String,
    /// Its value.
    pub value: f64,
    /// Its standard error, as the table has it.
    pub standard_error: Option<f64>,
    /// Its standard error with what it may have been underestimated by.
    pub stated_error: Option<f64>,
    /// The error that was asked for.
    pub target: f64,
    /// Realizations that it was read off.
    pub realizations: u64,
    /// How often it was looked at.
    pub looks: u64,
    /// Whether it is known to the error that was asked for.
    pub reached: bool,
}

/// How the targets of a run stand at its end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Standings(pub(crate) Vec<Standing>);

/// Targets in a report.
pub(super) struct Here;

impl Room for Here {
    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("until_error", &a.get::<Standings>().map(|standings| &standings.0))
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let all = a.get::<Standings>().map_or(&[][..], |standings| &standings.0);
        all.iter()
            .filter(|standing| standing.reached)
            .map(|standing| format!("reached: {}", standing.words()))
            .collect()
    }
}

/// The next look after so many realizations.
pub(crate) fn next_look(k: u64) -> u64 {
    if k < FIRST { FIRST } else { (k + k / 8).div_ceil(16) * 16 }
}

/// The look at or after so many realizations, and how many were before it.
pub(crate) fn look_from(k: u64) -> (u64, u64) {
    let (mut look, mut before) = (FIRST, 0);
    while look < k {
        (look, before) = (next_look(look), before + 1);
    }
    (look, before)
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected =
            "expected TABLE@PLACE:ERROR, as pcf@0.05:0.01, spectrum_radial@20:2% or variance.var_spectral@disk:5%";
        let (figure, error) = text.rsplit_once(':').ok_or(expected)?;
        let (name, place) = figure.split_once('@').ok_or(expected)?;
        let (digits, relative) = error.strip_suffix('%').map_or((error, false), |digits| (digits, true));
        let error: f64 = digits.trim().parse().ok().filter(|e: &f64| *e > 0.0 && e.is_finite()).ok_or_else(|| {
            format!("the error {error} is none; expected a number above 0, or one with % of the value; {expected}")
        })?;
        let (stem, column) = match name.strip_suffix(".csv").unwrap_or(name).split_once('.') {
            Some((stem, column)) => (stem, Some(column.to_string())),
            None => (name.strip_suffix(".csv").unwrap_or(name), None),
        };
        let what = if stem == "spectrum" {
            let m = place.split(',').map(|m| m.trim().parse().ok()).collect::<Option<Vec<i32>>>();
            What::Mode(
                m.filter(|m| (1..=3).contains(&m.len()))
                    .ok_or_else(|| format!("{place} is no wave vector; expected integers, as spectrum@3,-4"))?,
            )
        } else {
            let measured = Measured::named(stem).ok_or_else(|| {
                let names: Vec<_> = MEASURED.iter().map(|measured| measured.stem).collect();
                format!("{stem} is no table of values with errors; expected spectrum, {}", names.join(", "))
            })?;
            What::Cell(measured.stem, column, place.to_string())
        };
        let error = if relative { error / 100.0 } else { error };
        Ok(Self { typed: text.into(), figure: figure.into(), what, error, relative })
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.typed)
    }
}

impl Target {
    /// How it stands, or why there is no such number.
    pub(crate) fn standing(&self, a: &Analysis, looks: u64) -> Result<Standing, String> {
        let (column, found) = match &self.what {
            What::Cell(stem, column, place) => match Measured::named(stem) {
                Some(measured) => measured.value(a, column.as_deref(), place)?,
                None => return Err(format!("the run has no {stem}.csv")),
            },
            What::Mode(m) => ("p".into(), Some(mode(a, m)?)),
        };
        let k = a.shape.realizations;
        let (value, se) = found.map_or((f64::NAN, None), |(value, se)| (value, se));
        let stated = se.map(|se| se * (1.0 + 2.0 / (2.0 * k as f64).sqrt()));
        let target = if self.relative { self.error * value.abs() } else { self.error };
        // Of values that are all alike nothing is known of how they vary.
        let reached = stated.is_some_and(|stated| stated > 0.0 && stated <= target);
        Ok(Standing {
            figure: self.figure.clone(),
            column,
            value,
            standard_error: se,
            stated_error: stated,
            target,
            realizations: k,
            looks,
            reached,
        })
    }
}

/// P at a wave vector of the grid.
fn mode(a: &Analysis, m: &[i32]) -> Result<(f64, Option<f64>), String> {
    let (spectrum, grid) = a.grid_of_power().ok_or("the run has no P on a grid")?;
    let most = grid.max_frequency_of_axes();
    if m.len() != most.len() || m.iter().zip(most).any(|(m, most)| m.unsigned_abs() > *most) {
        let numbers = |list: Vec<String>| list.join(",");
        let given = numbers(m.iter().map(i32::to_string).collect());
        let ends = numbers(most.iter().map(u32::to_string).collect());
        return Err(format!("{given} is no wave vector of the grid; expected {} integers up to {ends}", most.len()));
    }
    let at = grid.half_index(std::array::from_fn(|axis| m.get(axis).copied().unwrap_or(0)));
    Ok((spectrum.p[at], Some(spectrum.p_se[at])))
}

impl Standing {
    /// The stated error over what was asked for.
    pub(crate) fn ratio(&self) -> Option<f64> {
        Some(self.stated_error? / self.target).filter(|ratio| ratio.is_finite() && *ratio > 0.0)
    }

    /// `pcf@0.05 (g): 0.9983, error 0.0097 of 0.01 after 7 looks`
    fn words(&self) -> String {
        let error = self.stated_error.map_or("unknown".into(), human);
        let looks = plural(self.looks, "look");
        format!(
            "{} ({}): {}, error {error} of {} after {looks}",
            self.figure,
            self.column,
            human(self.value),
            human(self.target)
        )
    }

    /// What to say where it is not reached.
    pub(crate) fn short_of(&self) -> String {
        let needed = self.ratio().map(|ratio| (self.realizations as f64 * ratio * ratio).ceil());
        let needed = needed.map_or(String::new(), |k| format!("; about {k} realizations would do"));
        format!("{} was asked for and is not reached: {}{needed}", self.figure, self.words())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_what_is_typed() {
        for typed in
            ["pcf@0.05:0.01", "spectrum_radial.p@20:2%", "variance.var_spectral@disk:r=0.2:5%", "spectrum@3,-4:0.1"]
        {
            assert_eq!(typed.parse::<Target>().map(|target| target.to_string()), Ok(typed.to_string()));
        }
        for (typed, why) in [
            ("pcf:0.01", "expected TABLE@PLACE:ERROR"),
            ("pcf@0.05", "expected TABLE@PLACE:ERROR"),
            ("pcf@0.05:0", "the error 0 is none"),
            ("pcf@0.05:x%", "the error x% is none"),
            ("pfc@0.05:1", "pfc is no table"),
            ("spectrum@1,b:1", "1,b is no wave vector"),
        ] {
            let error = typed.parse::<Target>().err().unwrap_or_default();
            assert!(error.contains(why), "{typed}: {error}");
        }
    }

    #[test]
    fn looks_are_at_whole_leaves_an_eighth_apart() {
        let looks: Vec<u64> = std::iter::successors(Some(FIRST), |k| Some(next_look(*k))).take(6).collect();
        assert_eq!(looks, [64, 80, 96, 112, 128, 144]);
        assert_eq!(next_look(1600), 1808);
        assert_eq!((look_from(0), look_from(64), look_from(65)), ((64, 0), (64, 0), (80, 1)));
    }
}

//! What the registry knows of a process, and what a process of one n, one dimension and one set of parameters can do.

use std::ops::RangeInclusive;
use std::sync::Arc;

use serde_json::{Value, json};

use super::parameters::{Accepts, Parameter, ParameterValues};
use super::size::Size;
use super::{Realization, nearest_names};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::setting::Setting;

/// A point process on the unit torus with its n, dimension and parameters, ready to be drawn from.
pub trait Sampler: Send + Sync {
    /// The points of one realization: coordinates in [0, 1), point by point. Random numbers come from the realization's
    /// stream alone. What takes long asks the control whether to go on, at least every 50 ms.
    ///
    /// # Errors
    /// What cannot be drawn; `Error::Cancelled`.
    fn generate(&self, realization: &Realization, control: &Control) -> Result<Vec<f64>>;

    /// The number of points of one realization, where it is drawn: what `generate` would give, found sooner.
    ///
    /// # Errors
    /// What cannot be drawn; `Error::Cancelled`.
    fn count(&self, realization: &Realization, control: &Control) -> Result<u64> {
        Ok((self.generate(realization, control)?.len() / realization.dim) as u64)
    }

    /// g at distance `r` in [0, 1/2], averaged over directions and normalized by E[n (n - 1)]; `None` where no closed form
    /// is known or g is not a function (a lattice).
    fn pair_correlation(&self, _r: f64) -> Option<f64> {
        None
    }

    /// P at integer `m != 0`, one component per axis, exact at this n; `None` where no closed form is known.
    fn power(&self, _m: &[i32]) -> Option<f64> {
        None
    }

    /// The variance of the number of points; 0 where it is fixed, `None` where it is not known.
    fn count_variance(&self) -> Option<f64> {
        Some(0.0)
    }
}

/// Kinds of processes, in the order of lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Independent points and grids.
    Independent,
    /// One point, or a law, per stratum.
    Stratified,
    /// Nets, sequences and lattices.
    LowDiscrepancy,
    /// Hard cores and blue noise.
    BlueNoise,
    /// Clusters, Cox and determinantal processes.
    Clusters,
}

impl Family {
    /// In words, for headings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent points and grids",
            Self::Stratified => "stratified",
            Self::LowDiscrepancy => "low discrepancy",
            Self::BlueNoise => "hard cores and blue noise",
            Self::Clusters => "clusters, Cox and determinantal processes",
        }
    }
}

/// What n is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Number {
    /// Every realization has exactly n points.
    Fixed,
    /// So it has, and they are the first n of a sequence: n is no part of a realization's identity.
    Sequence,
    /// The number is drawn; n is its expectation, exactly.
    Expected,
}

/// What a sampler is made of.
#[derive(Debug)]
pub struct Given<'a> {
    /// Number of points, or its expectation.
    pub n: u64,
    /// Number of axes.
    pub dim: usize,
    /// A value for each of its parameters.
    pub values: &'a ParameterValues,
}

/// Makes a process of its n, dimension and parameters, which are checked here and nowhere else.
pub type Make = fn(&Given<'_>) -> Result<Arc<dyn Sampler>>;

/// One line of the registry.
pub struct Entry {
    /// The name on the command line.
    pub name: &'static str,
    /// Other names of the same.
    pub aliases: &'static [&'static str],
    /// Its family.
    pub family: Family,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Author and year.
    pub source: &'static str,
    /// What is known of it in closed form: formulas in plain text, empty where nothing is.
    pub formulas: &'static str,
    /// A notice that goes with what it is made of.
    pub notice: &'static str,
    /// What n is.
    pub number: Number,
    /// Which n there are.
    pub size: Size,
    /// In how many dimensions.
    pub dims: RangeInclusive<usize>,
    /// Its own parameters, `--param name=value`; `shift` is every sampler's.
    pub parameters: &'static [Parameter],
    /// Whether all realizations would be the same set, which `shift=auto` therefore shifts.
    pub same_every_time: fn(&ParameterValues) -> bool,
    /// Makes it.
    pub make: Make,
}

/// The parameter of every sampler.
pub const SHIFT: Parameter = Parameter::new(
    "shift",
    "auto",
    Accepts::OneOf(&["auto", "none", "random"]),
    "random: one uniform shift modulo 1 per realization (Cranley & Patterson 1976); auto: only where all realizations would be the same set",
)
.no_identity();

impl Entry {
    /// A line to be completed: fixed n of any size in 1 to 3 dimensions.
    pub(super) const fn new(name: &'static str, family: Family, summary: &'static str, make: Make) -> Self {
        Self {
            name,
            aliases: &[],
            family,
            summary,
            source: "",
            formulas: "",
            notice: "",
            number: Number::Fixed,
            size: Size::ANY,
            dims: 1..=3,
            parameters: &[],
            same_every_time: |_| false,
            make,
        }
    }

    /// What there is to know about it.
    pub fn json(&self) -> Value {
        json!({
            "name": self.name,
            "aliases": self.aliases,
            "family": self.family,
            "summary": self.summary,
            "source": self.source,
            "formulas": self.formulas,
            "fixed_n": self.fixed_n(),
            "sequence": self.number == Number::Sequence,
            "n": self.size.words,
            "dims": self.dims.clone().collect::<Vec<_>>(),
            "parameters": self.all_parameters().collect::<Vec<_>>(),
        })
    }

    /// Whether every realization has exactly n points.
    pub fn fixed_n(&self) -> bool {
        self.number != Number::Expected
    }

    /// Its own parameters and `shift`.
    pub fn all_parameters(&self) -> impl Iterator<Item = &'static Parameter> {
        self.parameters.iter().chain([&SHIFT])
    }

    /// The numbers of points nearest to `n` from below and above that can be had, itself where it can.
    pub fn nearest(&self, n: u64, dim: usize) -> [Option<u64>; 2] {
        [self.size.below(n, dim), self.size.above(n, dim)]
    }

    /// The number of points nearest to `n` that can be had; of two the larger.
    pub fn nearest_size(&self, n: u64, dim: usize) -> u64 {
        let ends = self.nearest(n, dim).into_iter().flatten();
        ends.min_by_key(|end| (end.abs_diff(n), u64::MAX - end)).unwrap_or(1)
    }

    /// The process with this n, dimension and these parameters.
    ///
    /// # Errors
    /// A dimension, a number of points or parameters that cannot be had, and what can.
    pub fn of(&self, n: u64, dim: usize, values: &ParameterValues) -> Result<Arc<dyn Sampler>> {
        if !self.dims.contains(&dim) {
            let (least, most) = (*self.dims.start(), *self.dims.end());
            let reason = match most - least {
                0 => format!("{} is there in {least} dimensions only", self.name),
                1 => format!("{}: expected {least} or {most}", self.name),
                2 => format!("{}: expected {least}, {} or {most}", self.name, least + 1),
                _ => format!("{}: expected {least} to {most}", self.name),
            };
            return Err(Error::setting(Setting::Dim, dim, reason));
        }
        self.size.check(self.name, n, dim)?;
        (self.make)(&Given { n, dim, values })
    }

    /// Whether a set of points is moved by one uniform vector.
    pub(super) fn shifts(&self, values: &ParameterValues) -> Result<bool> {
        Ok(match values.word("shift")? {
            "random" => true,
            "none" => false,
            _ => (self.same_every_time)(values),
        })
    }
}

/// The line of `name`, which may be an alias.
///
/// # Errors
/// A name that is not known, with the nearest that is.
pub(super) fn find_in(entries: &[&'static Entry], name: &str) -> Result<&'static Entry> {
    let known = |entry: &&&'static Entry| entry.name == name || entry.aliases.contains(&name);
    entries.iter().find(known).copied().ok_or_else(|| {
        let all: Vec<&str> =
            entries.iter().flat_map(|e| std::iter::once(e.name).chain(e.aliases.iter().copied())).collect();
        let hint = nearest_names(name, &all).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
        let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
        Error::setting(Setting::Sampler, name, format!("no such sampler{hint}; expected one of {}", names.join(", ")))
    })
}

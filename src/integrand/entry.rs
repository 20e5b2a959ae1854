//! What the registry knows of an integrand, and how one is made.

use std::ops::RangeInclusive;
use std::sync::Arc;

use serde_json::json;

use super::shape::Shape;
use super::spec::{Parameter, Takes, Values};
use crate::error::{Error, Result};
use crate::samplers::nearest_names;
use crate::setting::Setting;

/// What an integrand is made of.
pub(super) struct Given<'a> {
    /// Number of axes.
    pub(super) dim: usize,
    /// A value for each of its parameters.
    pub(super) values: &'a Values,
}

impl Given<'_> {
    /// The number of a parameter.
    pub(super) fn number(&self, name: &'static str) -> Result<f64> {
        self.values.number(name)
    }

    /// The text of a parameter.
    pub(super) fn text(&self, name: &'static str) -> Result<&str> {
        self.values.text(name)
    }

    /// The numbers of the axes' parameters, 0 on axes the box lacks.
    pub(super) fn axes(&self, names: [&'static str; 3]) -> Result<[f64; 3]> {
        let mut all = [0.0; 3];
        for (x, name) in all.iter_mut().zip(names).take(self.dim) {
            *x = self.number(name)?;
        }
        Ok(all)
    }

    /// The axis that a parameter `axis` names.
    pub(super) fn axis(&self) -> Result<usize> {
        let name = self.text("axis")?;
        let axis = AXES.iter().position(|axis| *axis == name).unwrap_or(0);
        if axis < self.dim {
            return Ok(axis);
        }
        Err(wrong(format!("axis={name}: there are {} in {}D", AXES[..self.dim].join(", "), self.dim)))
    }
}

/// The names of the axes.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// Makes an integrand of its dimension and parameters, which are checked here and nowhere else.
pub(super) type Make = fn(&Given<'_>) -> Result<Arc<dyn Shape>>;

/// One line of the registry.
pub struct Entry {
    /// The name on the command line.
    pub name: &'static str,
    /// Other names of the same.
    pub aliases: &'static [&'static str],
    /// What it is, in one line.
    pub summary: &'static str,
    /// What is known of it in closed form, in plain text.
    pub formulas: &'static str,
    /// Where that is from.
    pub source: &'static str,
    /// In how many dimensions.
    pub dims: RangeInclusive<usize>,
    /// Its parameters, `key=value`.
    pub parameters: &'static [Parameter],
    /// Whether its integrals, f_m and a(r) are exact to rounding.
    pub closed: bool,
    /// A specification that shows what it is, where the defaults do not.
    pub example: &'static str,
    pub(super) make: Make,
}

impl Entry {
    /// What there is to know about it, and about one that was made.
    pub fn json(&self, made: Option<&super::Integrand>) -> serde_json::Value {
        let values = made.map(|f| {
            json!({
                "integrand": f.spec(),
                "dim": f.dim(),
                "integral": f.integral(),
                "square_integral": f.square_integral(),
                "variance": f.variance(),
                "integral_error": f.integral_error(),
                "coefficient_error": f.coefficient_error(),
                "autocorrelation_error": f.autocorrelation_error(),
                // Infinity is no number of JSON.
                "smoothness": Some(f.smoothness()).filter(|c| c.is_finite()),
            })
        });
        json!({
            "name": self.name,
            "aliases": self.aliases,
            "summary": self.summary,
            "source": self.source,
            "formulas": self.formulas,
            "closed": self.closed,
            "dims": self.dims.clone().collect::<Vec<_>>(),
            "parameters": self.parameters,
            "values": values,
        })
    }

    /// A line to be completed: closed, in 1 to 3 dimensions, without parameters.
    pub(super) const fn new(name: &'static str, summary: &'static str, make: Make) -> Self {
        Self {
            name,
            aliases: &[],
            summary,
            formulas: "",
            source: "",
            dims: 1..=3,
            parameters: &[],
            closed: true,
            example: "",
            make,
        }
    }

    /// The parameters that there are in this dimension.
    pub fn parameters(&self, dim: usize) -> impl Iterator<Item = &'static Parameter> {
        self.parameters.iter().filter(move |p| p.from_dim <= dim)
    }

    /// Whether it is made of a file.
    pub fn needs_file(&self) -> bool {
        self.parameters.iter().any(|p| p.takes == Takes::Path)
    }

    /// In how many dimensions, in words.
    pub fn in_dims(&self) -> String {
        match (self.dims.start(), self.dims.end()) {
            (least, most) if least == most => format!("{least}D"),
            (least, most) if least + 1 == *most => format!("{least}D or {most}D"),
            (least, most) => format!("{least}D to {most}D"),
        }
    }
}

/// An integrand that cannot be: why, and what could.
pub(super) fn wrong(reason: impl Into<String>) -> Error {
    Error::setting(Setting::Integrand, "", reason)
}

/// Whether numbers hold the squares of the variances of what has these integrals, of it and of its square.
pub(super) fn in_range(integral: f64, square: f64) -> Result<()> {
    if (1e-120..=1e120).contains(&square) || (integral == 0.0 && square == 0.0) {
        return Ok(());
    }
    let square = if square.is_nan() { f64::INFINITY } else { square };
    Err(wrong(format!(
        "the integral of its square is {square:e}: the squares of variances of it are no numbers; expected one between 1e-120 and 1e120, such as of the same in other units"
    )))
}

/// The line of `name` in a list, which may be an alias.
pub(super) fn find_in(entries: &'static [&'static Entry], name: &str) -> Result<&'static Entry> {
    let known = |entry: &&&'static Entry| entry.name == name || entry.aliases.contains(&name);
    entries.iter().find(known).copied().ok_or_else(|| {
        let all: Vec<&str> =
            entries.iter().flat_map(|e| std::iter::once(e.name).chain(e.aliases.iter().copied())).collect();
        let hint = nearest_names(name, &all).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
        let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
        Error::setting(
            Setting::Integrand,
            name,
            format!("no such integrand{hint}; expected one of {}", names.join(", ")),
        )
    })
}

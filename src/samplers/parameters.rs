//! Parameters of a process: what they accept, and the values given.

use std::fmt;

use super::{Sampler, nearest};
use crate::error::{Error, Result};
use crate::setting::Setting;

/// One parameter of a process.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// The key of `--param key=value`.
    pub name: &'static str,
    /// The value taken when none is given, as a user would type it.
    pub default: &'static str,
    /// What it accepts; prints as text.
    pub accepts: Accepts,
    /// What it does, with units.
    pub help: &'static str,
}

/// The values a parameter accepts.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Accepts {
    /// A number above the first and at most the second.
    Above(f64, f64),
    /// A number between the two, both included.
    Between(f64, f64),
    /// One of these words.
    OneOf(&'static [&'static str]),
}

impl fmt::Display for Accepts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Above(low, high) => write!(f, "a number above {low} and at most {high}"),
            Self::Between(low, high) => write!(f, "a number from {low} to {high}"),
            Self::OneOf(words) => write!(f, "{}", words.join(" or ")),
        }
    }
}

impl Accepts {
    fn parse(&self, text: &str) -> Option<Value> {
        let number = || text.parse::<f64>().ok();
        match *self {
            Self::Above(low, high) => number().filter(|&x| low < x && x <= high).map(Value::Number),
            Self::Between(low, high) => number().filter(|&x| low <= x && x <= high).map(Value::Number),
            Self::OneOf(words) => words.iter().find(|&&w| w == text).map(|&w| Value::Word(w)),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Value {
    Number(f64),
    Word(&'static str),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => write!(f, "{x}"),
            Self::Word(w) => f.write_str(w),
        }
    }
}

/// A value for every parameter of one process.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterValues {
    /// In the order of declaration.
    values: Vec<(&'static str, Value)>,
}

impl ParameterValues {
    /// The defaults of a process.
    ///
    /// # Errors
    /// None for a sampler whose defaults can be parsed.
    pub fn defaults(sampler: &dyn Sampler) -> Result<Self> {
        Self::parse(sampler, &[] as &[&str])
    }

    /// The values in `given` (`key=value` each), defaults for the rest.
    ///
    /// # Errors
    /// A parameter that the sampler does not have, has twice, or that cannot have this value.
    pub fn parse(sampler: &dyn Sampler, given: &[impl AsRef<str>]) -> Result<Self> {
        let mut texts: Vec<Option<&str>> = vec![None; sampler.parameters().len()];
        for pair in given.iter().map(AsRef::as_ref) {
            let Some((key, value)) = pair.split_once('=') else {
                return Err(Error::setting(Setting::Params, pair, "expected key=value"));
            };
            let (key, value) = (key.trim(), value.trim());
            let Some(slot) = sampler.parameters().iter().position(|p| p.name == key) else {
                return Err(Error::setting(Setting::Params, pair, unknown(sampler, key)));
            };
            if texts[slot].replace(value).is_some() {
                return Err(Error::setting(Setting::Params, pair, format!("{key} is given twice")));
            }
        }
        let values = sampler.parameters().iter().zip(texts).map(|(p, text)| {
            let text = text.unwrap_or(p.default);
            let value = p.accepts.parse(text).ok_or_else(|| {
                let reason = format!("{} of {} is {} (default {})", p.name, sampler.name(), p.accepts, p.default);
                Error::setting(Setting::Params, format!("{}={text}", p.name), reason)
            })?;
            Ok((p.name, value))
        });
        Ok(Self { values: values.collect::<Result<_>>()? })
    }

    /// The number called `name`.
    ///
    /// # Errors
    /// Values of another sampler.
    pub fn number(&self, name: &'static str) -> Result<f64> {
        match self.get(name)? {
            Value::Number(x) => Ok(x),
            Value::Word(w) => Err(Error::setting(Setting::Params, format!("{name}={w}"), "expected a number")),
        }
    }

    /// The word called `name`.
    ///
    /// # Errors
    /// Values of another sampler.
    pub fn word(&self, name: &'static str) -> Result<&'static str> {
        match self.get(name)? {
            Value::Word(w) => Ok(w),
            Value::Number(x) => Err(Error::setting(Setting::Params, format!("{name}={x}"), "expected a word")),
        }
    }

    /// `key=value` for every parameter, in the order of declaration, defaults written out: equal text, equal points.
    pub fn canonical(&self) -> impl Iterator<Item = String> {
        self.values.iter().map(|(name, value)| format!("{name}={value}"))
    }

    fn get(&self, name: &'static str) -> Result<Value> {
        let found = self.values.iter().find(|(key, _)| *key == name);
        found.map(|(_, value)| *value).ok_or_else(|| {
            Error::setting(
                Setting::Params,
                name,
                "these values were made for another sampler, which has no such parameter",
            )
        })
    }
}

fn unknown(sampler: &dyn Sampler, key: &str) -> String {
    let (name, parameters) = (sampler.name(), sampler.parameters());
    if parameters.is_empty() {
        return format!("{name} has no parameters");
    }
    let names: Vec<_> = parameters.iter().map(|p| p.name).collect();
    let hint = nearest(key, &names).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
    let known: Vec<_> =
        parameters.iter().map(|p| format!("{} ({}, default {})", p.name, p.accepts, p.default)).collect();
    format!("{name} has no parameter {key}{hint}; expected {}", known.join(", "))
}

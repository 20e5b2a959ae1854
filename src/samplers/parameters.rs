//! Parameters of a process: what they accept, and the values given.

use std::fmt;

use super::entry::{Entry, SHIFT};
use super::nearest_names;
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
    /// Whether the random numbers depend on it.
    pub identity: bool,
}

impl Parameter {
    pub(super) const fn new(name: &'static str, default: &'static str, accepts: Accepts, help: &'static str) -> Self {
        Self { name, default, accepts, help, identity: true }
    }

    /// Sets that differ in it alone share their random numbers.
    pub(super) const fn no_identity(self) -> Self {
        Self { identity: false, ..self }
    }
}

/// The values a parameter accepts.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Accepts {
    /// A number above the first and at most the second.
    Above(f64, f64),
    /// A number between the two, both included.
    Between(f64, f64),
    /// A whole number between the two, both included.
    Whole(u64, u64),
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// This word, or a whole number between the two, both included.
    WordOrWhole(&'static str, u64, u64),
}

impl fmt::Display for Accepts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Above(low, high) => write!(f, "a number above {low} and at most {high}"),
            Self::Between(low, high) => write!(f, "a number from {low} to {high}"),
            Self::Whole(low, high) => write!(f, "a whole number from {low} to {high}"),
            Self::OneOf([all @ .., last]) if all.len() > 1 => write!(f, "{} or {last}", all.join(", ")),
            Self::OneOf(words) => write!(f, "{}", words.join(" or ")),
            Self::WordOrWhole(word, low, high) => write!(f, "{word} or a whole number from {low} to {high}"),
        }
    }
}

impl Accepts {
    /// The number that a text is, if it is one that is accepted.
    pub(crate) fn number(&self, text: &str) -> Option<f64> {
        match self.parse(text)? {
            Value::Number(x) => Some(x),
            Value::Whole(x) => Some(x as f64),
            Value::Word(_) => None,
        }
    }

    fn parse(&self, text: &str) -> Option<Value> {
        let number = || text.parse::<f64>().ok();
        let whole = |low, high| text.parse::<u64>().ok().filter(|&x| low <= x && x <= high).map(Value::Whole);
        match *self {
            Self::Above(low, high) => number().filter(|&x| low < x && x <= high).map(Value::Number),
            Self::Between(low, high) => number().filter(|&x| low <= x && x <= high).map(Value::Number),
            Self::Whole(low, high) => whole(low, high),
            Self::OneOf(words) => words.iter().find(|&&w| w == text).map(|&w| Value::Word(w)),
            Self::WordOrWhole(word, ..) if word == text => Some(Value::Word(word)),
            Self::WordOrWhole(_, low, high) => whole(low, high),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Value {
    Number(f64),
    Whole(u64),
    Word(&'static str),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => write!(f, "{x}"),
            Self::Whole(x) => write!(f, "{x}"),
            Self::Word(w) => f.write_str(w),
        }
    }
}

/// A value for every parameter of one process, `shift` included.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParameterValues {
    /// In the order of declaration.
    values: Vec<(&'static Parameter, Value)>,
}

impl ParameterValues {
    /// The values in `given` (`key=value` each), defaults for the rest.
    ///
    /// # Errors
    /// A parameter that the sampler does not have, has twice, or that cannot have this value.
    pub fn parse(entry: &Entry, given: &[impl AsRef<str>]) -> Result<Self> {
        let parameters: Vec<_> = entry.all_parameters().collect();
        let mut texts: Vec<Option<&str>> = vec![None; parameters.len()];
        for pair in given.iter().map(AsRef::as_ref) {
            let Some((key, value)) = pair.split_once('=') else {
                return Err(Error::setting(Setting::Params, pair, "expected key=value"));
            };
            let (key, value) = (key.trim(), value.trim());
            let Some(slot) = parameters.iter().position(|p| p.name == key) else {
                return Err(Error::setting(Setting::Params, pair, unknown(entry, key)));
            };
            if texts[slot].replace(value).is_some() {
                return Err(Error::setting(Setting::Params, pair, format!("{key} is given twice")));
            }
        }
        let values = parameters.into_iter().zip(texts).map(|(p, text)| {
            let text = text.unwrap_or(p.default);
            let value = p.accepts.parse(text).ok_or_else(|| {
                let reason = format!("{} of {} is {} (default {})", p.name, entry.name, p.accepts, p.default);
                Error::setting(Setting::Params, format!("{}={text}", p.name), reason)
            })?;
            Ok((p, value))
        });
        Ok(Self { values: values.collect::<Result<_>>()? })
    }

    /// The number called `name`.
    ///
    /// # Errors
    /// No such number.
    pub fn number(&self, name: &'static str) -> Result<f64> {
        match self.get(name)? {
            Value::Number(x) => Ok(x),
            other => Err(Error::setting(Setting::Params, format!("{name}={other}"), "expected a number")),
        }
    }

    /// The word called `name`.
    ///
    /// # Errors
    /// No such word.
    pub fn word(&self, name: &'static str) -> Result<&'static str> {
        match self.get(name)? {
            Value::Word(w) => Ok(w),
            other => Err(Error::setting(Setting::Params, format!("{name}={other}"), "expected a word")),
        }
    }

    /// The whole number called `name`, `None` where it is a word.
    ///
    /// # Errors
    /// No such whole number.
    pub fn whole(&self, name: &'static str) -> Result<Option<u64>> {
        match self.get(name)? {
            Value::Whole(x) => Ok(Some(x)),
            Value::Word(_) => Ok(None),
            other => Err(Error::setting(Setting::Params, format!("{name}={other}"), "expected a whole number")),
        }
    }

    /// `key=value` for every parameter but `shift`, in the order of declaration, defaults written out.
    pub fn canonical(&self) -> impl Iterator<Item = String> {
        self.values.iter().filter(|(p, _)| p.name != SHIFT.name).map(|(p, value)| format!("{}={value}", p.name))
    }

    /// Those that the random numbers depend on.
    pub(super) fn identity(&self) -> impl Iterator<Item = String> {
        self.values.iter().filter(|(p, _)| p.identity).map(|(p, value)| format!("{}={value}", p.name))
    }

    fn get(&self, name: &'static str) -> Result<Value> {
        let found = self.values.iter().find(|(p, _)| p.name == name);
        found.map(|(_, value)| *value).ok_or_else(|| {
            Error::setting(
                Setting::Params,
                name,
                "these values were made for another sampler, which has no such parameter",
            )
        })
    }
}

fn unknown(entry: &Entry, key: &str) -> String {
    let names: Vec<_> = entry.all_parameters().map(|p| p.name).collect();
    let hint = nearest_names(key, &names).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
    let known: Vec<_> =
        entry.all_parameters().map(|p| format!("{} ({}, default {})", p.name, p.accepts, p.default)).collect();
    format!("{} has no parameter {key}{hint}; expected {}", entry.name, known.join(", "))
}

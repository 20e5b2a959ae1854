//! Specifications: NAME or NAME:key=value,key=value,...

use std::fmt;

use super::entry::{AXES, Entry, wrong};
use crate::error::Result;
use crate::samplers::{Accepts, nearest_names};

/// One parameter of an integrand.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// The key of `key=value`; empty where all that follows the name is the value.
    pub name: &'static str,
    /// The value taken when none is given; empty where one must be.
    pub default: &'static str,
    /// What it accepts; prints as text.
    pub takes: Takes,
    /// What it is, with units.
    pub help: &'static str,
    /// The dimension from which on it is there.
    pub from_dim: usize,
    /// Whether it is one of a group, one per axis, that are 0 as soon as any of them is given.
    pub together: bool,
}

/// The values a parameter accepts.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Takes {
    /// A number, or a word.
    One(Accepts),
    /// Numbers between semicolons.
    Numbers,
    /// The path of a file.
    Path,
    /// An expression of x, y, z.
    Expression,
}

impl fmt::Display for Takes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(accepts) => accepts.fmt(f),
            Self::Numbers => f.write_str("numbers between semicolons"),
            Self::Path => f.write_str("the path of a file"),
            Self::Expression => f.write_str("an expression of x, y and z"),
        }
    }
}

impl Parameter {
    pub(super) const fn new(name: &'static str, default: &'static str, takes: Takes, help: &'static str) -> Self {
        Self { name, default, takes, help, from_dim: 1, together: false }
    }

    pub(super) const fn number(
        name: &'static str,
        default: &'static str,
        accepts: Accepts,
        help: &'static str,
    ) -> Self {
        Self::new(name, default, Takes::One(accepts), help)
    }

    /// There from this dimension on.
    pub(super) const fn only_from(self, dim: usize) -> Self {
        Self { from_dim: dim, ..self }
    }

    /// One of those that are 0 where another is given.
    pub(super) const fn together(self) -> Self {
        Self { together: true, ..self }
    }

    /// As it is typed: with its default, or with a word for what it takes.
    pub fn shown(&self) -> String {
        let value = match (self.takes, self.default) {
            (Takes::Path, "") => "PATH",
            (Takes::Expression, "") => "EXPRESSION",
            (_, default) => default,
        };
        if self.name.is_empty() { value.into() } else { format!("{}={value}", self.name) }
    }

    /// The value that a text is, written as a person would; and its number.
    fn read(&self, entry: &Entry, text: &str) -> Result<(String, f64)> {
        if self.name.is_empty() && text.is_empty() {
            return Err(wrong(format!("{} needs {}: {}", entry.name, self.takes, entry.example)));
        }
        let expected = || {
            let default = if self.default.is_empty() { String::new() } else { format!(" (default {})", self.default) };
            wrong(format!("{}={text}: {} of {} is {}{default}", self.name, self.name, entry.name, self.takes))
        };
        match self.takes {
            Takes::One(Accepts::OneOf(words)) if words.contains(&text) => Ok((text.into(), f64::NAN)),
            Takes::One(Accepts::OneOf(_)) => Err(expected()),
            Takes::One(accepts) => {
                let number = accepts.number(text).ok_or_else(expected)?;
                Ok((number.to_string(), number))
            }
            Takes::Numbers | Takes::Path | Takes::Expression if text.is_empty() => Err(expected()),
            Takes::Numbers | Takes::Path | Takes::Expression => Ok((text.into(), f64::NAN)),
        }
    }
}

/// `c` of an axis, in [0, 1].
pub(super) const fn place(axis: usize, default: &'static str) -> Parameter {
    Parameter::number(AXES[axis], default, Accepts::Between(0.0, 1.0), "centre").only_from(axis + 1)
}

/// A value for every parameter of one integrand in one dimension.
pub(super) struct Values {
    values: Vec<(&'static Parameter, String, f64)>,
}

impl Values {
    /// What stands behind the name of `entry` in a specification.
    pub(super) fn parse(entry: &Entry, dim: usize, text: &str) -> Result<Self> {
        let there: Vec<&'static Parameter> = entry.parameters(dim).collect();
        if let [only] = there.as_slice()
            && only.name.is_empty()
        {
            let (text, number) = only.read(entry, text.trim())?;
            return Ok(Self { values: vec![(only, text, number)] });
        }
        let mut texts: Vec<Option<String>> = vec![None; there.len()];
        let mut last = None;
        for part in text.split(',').filter(|part| !part.trim().is_empty()) {
            let key = part.split_once('=').map(|(key, value)| (key.trim(), value.trim()));
            let slot = key.and_then(|(key, _)| there.iter().position(|p| p.name == key));
            match (key, slot, last) {
                (Some((key, value)), Some(slot), _) => {
                    if texts[slot].replace(value.into()).is_some() {
                        return Err(wrong(format!("{key} is given twice")));
                    }
                    last = Some(slot);
                }
                // A path may have commas and equal signs of its own.
                (_, None, Some(slot)) if there[slot].takes == Takes::Path => {
                    if let Some(path) = &mut texts[slot] {
                        *path += ",";
                        *path += part;
                    }
                }
                (Some((key, _)), ..) => return Err(wrong(unknown(entry, dim, key))),
                (None, ..) => return Err(wrong(format!("{}: expected key=value", part.trim()))),
            }
        }
        let one_given = there.iter().zip(&texts).any(|(p, text)| p.together && text.is_some());
        let values = there.into_iter().zip(texts).map(|(p, text)| {
            let default = if p.together && one_given { "0" } else { p.default };
            let text = text.unwrap_or_else(|| default.into());
            if text.is_empty() {
                return Err(wrong(format!("{} needs {}={}", entry.name, p.name, p.takes)));
            }
            let (text, number) = p.read(entry, &text)?;
            Ok((p, text, number))
        });
        Ok(Self { values: values.collect::<Result<_>>()? })
    }

    fn get(&self, name: &'static str) -> Result<(&str, f64)> {
        let found = self.values.iter().find(|(p, ..)| p.name == name);
        found.map(|(_, text, number)| (text.as_str(), *number)).ok_or_else(|| wrong(format!("no {name}")))
    }

    pub(super) fn number(&self, name: &'static str) -> Result<f64> {
        Ok(self.get(name)?.1)
    }

    pub(super) fn text(&self, name: &'static str) -> Result<&str> {
        Ok(self.get(name)?.0)
    }

    /// `NAME:key=value,...` with all parameters, defaults written out.
    pub(super) fn canonical(&self, name: &str) -> String {
        let pair = |(p, text, _): &(&Parameter, String, f64)| match p.name {
            "" => text.clone(),
            key => format!("{key}={text}"),
        };
        let all: Vec<String> = self.values.iter().map(pair).collect();
        if all.is_empty() { name.into() } else { format!("{name}:{}", all.join(",")) }
    }
}

fn unknown(entry: &Entry, dim: usize, key: &str) -> String {
    if let Some(later) = entry.parameters.iter().find(|p| p.name == key) {
        return format!("{key} of {} is there from {}D on, this is {dim}D", entry.name, later.from_dim);
    }
    let there: Vec<&Parameter> = entry.parameters(dim).collect();
    let names: Vec<&str> = there.iter().map(|p| p.name).collect();
    let hint = nearest_names(key, &names).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
    let known: Vec<String> = there.iter().map(|p| format!("{} ({}, default {})", p.name, p.takes, p.default)).collect();
    match known.as_slice() {
        [] => format!("{} has no parameters", entry.name),
        _ => format!("{} has no parameter {key}{hint}; expected {}", entry.name, known.join(", ")),
    }
}

//! Values on equal cells of an interval.

use std::sync::Arc;

use super::entry::{Entry, Given, wrong};
use super::factors::{Factor, Steps};
use super::separable::Separable;
use super::shape::Shape;
use super::spec::{Parameter, Takes};
use crate::error::Result;

/// More are a table.
const MOST: usize = 4096;

pub(super) static ENTRY: Entry = Entry {
    formulas: "f_m = sinc(m/N) exp(-pi i m/N) DFT(v)[m mod N]/N; a(r) linear between lags j/N of the cyclic autocorrelation of v",
    source: "Oppenheim & Schafer 2010",
    dims: 1..=1,
    parameters: &[Parameter::new("values", "1;3;-2;5;0.5", Takes::Numbers, "one per cell, from 0 on")],
    ..Entry::new("steps", "values on equal cells of [0, 1)", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let values = given.text("values")?.split(';').enumerate().map(|(i, text)| {
        let number = text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        number.ok_or_else(|| wrong(format!("value {} is {:?}; expected a number", i + 1, text.trim())))
    });
    let values: Vec<f64> = values.collect::<Result<_>>()?;
    if values.len() > MOST {
        let reason = format!("{} values; expected at most {MOST} (table:file=PATH takes more)", values.len());
        return Err(wrong(reason));
    }
    Ok(Arc::new(Separable::product(vec![Factor::Steps(Steps::new(values))])))
}

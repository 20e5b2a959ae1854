//! A checkerboard.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::factors::{Factor, Steps};
use super::separable::Separable;
use super::shape::Shape;
use super::spec::Parameter;
use crate::error::Result;
use crate::samplers::Accepts;

pub(super) static ENTRY: Entry = Entry {
    formulas: "1/2 + 1/2 of the product of steps of +1 and -1 along every axis",
    source: "as of steps",
    parameters: &[Parameter::number("cells", "4", Accepts::Whole(1, 4096), "cells per side")],
    ..Entry::new("checker", "1 where the numbers of the cell add up to an even number, else 0", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let cells = given.number("cells")? as usize;
    let steps = Steps::new((0..cells).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect());
    let factors = vec![Factor::Steps(steps); given.dim];
    Ok(Arc::new(Separable::product(factors).with_offset(0.5, 0.5)))
}

//! A ramp, which jumps by 1 at the wrap.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::factors::Factor;
use super::separable::Separable;
use super::shape::Shape;
use super::spec::{Parameter, Takes};
use crate::error::Result;
use crate::samplers::Accepts;

pub(super) static ENTRY: Entry = Entry {
    formulas: "f_m = i/(2 pi m) on the axis; a(r) = 1/3 - r (1 - r)/2, r in [0, 1)",
    source: "Abramowitz & Stegun 23.1 (Bernoulli's polynomials)",
    parameters: &[Parameter::new("axis", "x", Takes::One(Accepts::OneOf(&["x", "y", "z"])), "the axis it depends on")],
    ..Entry::new("ramp", "a coordinate itself", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let mut factors = vec![Factor::One; given.dim];
    factors[given.axis()?] = Factor::Power(1);
    Ok(Arc::new(Separable::product(factors)))
}

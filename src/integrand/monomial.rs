//! Products of powers of the coordinates.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::factors::Factor;
use super::separable::Separable;
use super::shape::Shape;
use super::spec::Parameter;
use crate::error::Result;
use crate::samplers::Accepts;

const fn power(name: &'static str, default: &'static str, axis: usize) -> Parameter {
    Parameter::number(name, default, Accepts::Whole(0, 20), "power of the coordinate").only_from(axis + 1).together()
}

pub(super) static ENTRY: Entry = Entry {
    formulas: "f_m = prod F_p, F_p = i/(2 pi m) (1 - p F_(p-1)), F_0 = 0 (m = 0: 1/(p + 1)); a(r) = prod sum_k C(p,k) [r^(p-k) s^(p+k+1) + s^(p-k) r^(p+k+1)]/(p + k + 1), s = 1 - r",
    source: "integration by parts; binomial theorem",
    parameters: &[power("x", "2", 0), power("y", "1", 1), power("z", "0", 2)],
    ..Entry::new("monomial", "x^p y^q z^s; an axis left out where another is given has power 0", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let powers = given.axes(["x", "y", "z"])?;
    let factor = |&p: &f64| if p == 0.0 { Factor::One } else { Factor::Power(p as u32) };
    Ok(Arc::new(Separable::product(powers[..given.dim].iter().map(factor).collect())))
}

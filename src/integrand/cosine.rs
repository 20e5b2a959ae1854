//! Products of cosines: four Fourier coefficients that are not 0 in 2D.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::factors::Factor;
use super::separable::Separable;
use super::shape::Shape;
use super::spec::Parameter;
use crate::error::Result;
use crate::samplers::Accepts;

const fn frequency(name: &'static str, default: &'static str, axis: usize) -> Parameter {
    let help = "periods per side; 0: no factor";
    Parameter::number(name, default, Accepts::Whole(0, 1 << 22), help).only_from(axis + 1).together()
}

pub(super) static ENTRY: Entry = Entry {
    formulas: "f_m = prod 1/2 at m = +-k, times exp(+-i phase); a(r) = prod cos(2 pi k r)/2",
    source: "Bracewell 2000",
    parameters: &[
        frequency("x", "2", 0),
        frequency("y", "1", 1),
        frequency("z", "0", 2),
        Parameter::number("phase", "0.3", Accepts::Between(-100.0, 100.0), "of the first factor, in radians"),
    ],
    ..Entry::new(
        "cosine",
        "cos(2 pi k x + phase) cos(2 pi l y); an axis left out where another is given has factor 1",
        make,
    )
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let mut phase = given.number("phase")?;
    let mut factor = |&k: &f64| match k as u32 {
        0 => Factor::One,
        k => Factor::Cosine { k, phase: std::mem::take(&mut phase) },
    };
    let factors = given.axes(["x", "y", "z"])?[..given.dim].iter().map(&mut factor).collect();
    Ok(Arc::new(Separable::product(factors)))
}

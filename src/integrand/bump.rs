//! A bump of bounded support, with as many derivatives as wanted.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::radial::Radial;
use super::shape::Shape;
use super::spec::{Parameter, place};
use crate::error::Result;
use crate::samplers::Accepts;

pub(super) static ENTRY: Entry = Entry {
    source: "Sonine's integral: Abramowitz & Stegun 11.4.10; Wendland 2005; a(r): Gauss quadrature of the lens, exact to rounding",
    formulas: "f_m = q! pi^-q R^d (R|m|)^(-d/2-q) J_(d/2+q)(2 pi R |m|) exp(-2 pi i m.c); I = pi^(d/2) R^d q!/Gamma(q+1+d/2), int f^2 with 2 q",
    parameters: &[
        Parameter::number("r", "0.3", Accepts::Above(0.0, 0.5), "radius"),
        Parameter::number("q", "2", Accepts::Whole(1, 8), "power; q - 1 derivatives are continuous"),
        place(0, "0.5"),
        place(1, "0.5"),
        place(2, "0.5"),
    ],
    ..Entry::new("bump", "(1 - |x - c|^2/r^2)^q inside a ball, 0 outside, by the nearest image", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let q = given.number("q")? as u32;
    Ok(Arc::new(Radial::new(given.dim, given.number("r")?, given.axes(["x", "y", "z"])?, q)))
}

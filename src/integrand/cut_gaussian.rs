//! A Gaussian that ends at the sides of the box.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::factors::Factor;
use super::separable::Separable;
use super::shape::Shape;
use super::spec::{Parameter, place};
use crate::error::Result;
use crate::samplers::Accepts;

const fn sigma(name: &'static str, default: &'static str, axis: usize) -> Parameter {
    let help = "standard deviation along an axis, as a fraction of the side";
    Parameter::number(name, default, Accepts::Above(0.0, 100.0), help).only_from(axis + 1)
}

pub(super) static ENTRY: Entry = Entry {
    formulas: "f_m = prod s sqrt(pi/2) exp(-2 pi i m c) [E(b) - E(a)], a, b = (0, 1 less c)/(s sqrt 2), E(u) = exp(-q^2) erf(u + i q), q = sqrt 2 pi s m; a(r): erf on both sides of the wrap",
    source: "Faddeeva's function: Abramowitz & Stegun 7.1; Johnson 2012",
    parameters: &[
        sigma("sigma", "0.2", 0),
        sigma("sigma-y", "0.25", 1),
        sigma("sigma-z", "0.3", 2),
        place(0, "0.3"),
        place(1, "0.6"),
        place(2, "0.5"),
    ],
    ..Entry::new("cut-gaussian", "exp(-(x - c)^2/2 sigma^2) along every axis, peak 1, not wrapped", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let sigmas = given.axes(["sigma", "sigma-y", "sigma-z"])?;
    let centers = given.axes(["x", "y", "z"])?;
    let factor = |(sigma, center)| Factor::CutGaussian { sigma, center };
    Ok(Arc::new(Separable::product(sigmas.into_iter().zip(centers).take(given.dim).map(factor).collect())))
}

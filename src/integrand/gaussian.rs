//! A Gaussian that wraps.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::factors::Factor;
use super::separable::Separable;
use super::shape::Shape;
use super::spec::{Parameter, place};
use crate::error::Result;
use crate::samplers::Accepts;

pub(super) static ENTRY: Entry = Entry {
    formulas: "f_m = prod sqrt(2 pi) s exp(-2 pi^2 s^2 m^2 - 2 pi i m c); a(r) = prod sqrt(pi) s sum_j exp(-(r + j)^2/4 s^2)",
    source: "Poisson's summation formula; Mardia & Jupp 2000",
    parameters: &[
        Parameter::number("sigma", "0.1", Accepts::Above(0.0, 1.0), "standard deviation, as a fraction of the side"),
        place(0, "0.4"),
        place(1, "0.55"),
        place(2, "0.5"),
    ],
    ..Entry::new("gaussian", "exp(-|x - c|^2/2 sigma^2), peak 1, summed over images", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let sigma = given.number("sigma")?;
    let centers = given.axes(["x", "y", "z"])?;
    let factors = centers[..given.dim].iter().map(|&center| Factor::Gaussian { sigma, center }).collect();
    Ok(Arc::new(Separable::product(factors)))
}

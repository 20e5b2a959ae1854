//! A disk, ball or interval about a centre, which wraps.

use std::sync::Arc;

use super::entry::{Entry, Given};
use super::radial::Radial;
use super::shape::Shape;
use super::spec::{Parameter, place};
use crate::error::Result;
use crate::samplers::Accepts;

pub(super) static ENTRY: Entry = Entry {
    aliases: &["ball"],
    source: "Bracewell 2000; overlap of two circles: Weisstein; of two spheres: Torquato 2002",
    formulas: "f_m = (R/|m|)^(d/2) J_(d/2)(2 pi R |m|) exp(-2 pi i m.c); a(r) = 2 R - r (1D), 2 R^2 acos(r/2R) - r/2 sqrt(4 R^2 - r^2) (2D), pi (4 R + r)(2 R - r)^2/12 (3D), summed over images",
    parameters: &[
        Parameter::number("r", "0.25", Accepts::Above(0.0, 0.5), "radius"),
        place(0, "0.5"),
        place(1, "0.5"),
        place(2, "0.5"),
    ],
    ..Entry::new("disk", "1 closer than r to a point, by the nearest image (3D: a ball)", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    Ok(Arc::new(Radial::new(given.dim, given.number("r")?, given.axes(["x", "y", "z"])?, 0)))
}

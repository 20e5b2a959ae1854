//! Boxes, half-open: of two ends per axis, up to a place on one axis, or an interval.

use std::sync::Arc;

use super::entry::{Entry, Given, wrong};
use super::factors::Factor;
use super::separable::Separable;
use super::shape::Shape;
use super::spec::{Parameter, Takes};
use crate::error::Result;
use crate::samplers::Accepts;

const FORMULAS: &str = "f_m = prod w sinc(w m) exp(-pi i m (lo + hi)), w = hi - lo; a(r) = prod max(w - |r|, 0) + max(w + |r| - 1, 0), |r| <= 1/2";
const SOURCE: &str = "Bracewell 2000";

const fn end(name: &'static str, default: &'static str, axis: usize) -> Parameter {
    let help = "an end, as a fraction of the side";
    Parameter::number(name, default, Accepts::Between(0.0, 1.0), help).only_from(axis + 1)
}

pub(super) static BOX: Entry = Entry {
    formulas: FORMULAS,
    source: SOURCE,
    parameters: &[
        end("x0", "0.13", 0),
        end("x1", "0.58", 0),
        end("y0", "0.21", 1),
        end("y1", "0.87", 1),
        end("z0", "0.17", 2),
        end("z1", "0.79", 2),
    ],
    ..Entry::new("box", "1 on [x0, x1) x [y0, y1) x [z0, z1)", make_box)
};

pub(super) static STEP: Entry = Entry {
    formulas: FORMULAS,
    source: SOURCE,
    parameters: &[
        Parameter::new("axis", "x", Takes::One(Accepts::OneOf(&["x", "y", "z"])), "the axis it depends on"),
        Parameter::number("at", "0.3", Accepts::Above(0.0, 1.0), "where it ends"),
    ],
    ..Entry::new("step", "1 on [0, at) of one axis", make_step)
};

pub(super) static INTERVAL: Entry = Entry {
    formulas: FORMULAS,
    source: SOURCE,
    dims: 1..=1,
    parameters: &[end("x0", "0.21", 0), end("x1", "0.77", 0)],
    ..Entry::new("interval", "1 on [x0, x1)", make_box)
};

fn interval(lo: f64, hi: f64) -> Factor {
    if lo == 0.0 && hi == 1.0 { Factor::One } else { Factor::Interval { lo, hi } }
}

fn make_box(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let mut factors = Vec::new();
    for [from, to] in [["x0", "x1"], ["y0", "y1"], ["z0", "z1"]].into_iter().take(given.dim) {
        let (lo, hi) = (given.number(from)?, given.number(to)?);
        if lo >= hi {
            return Err(wrong(format!("{from}={lo},{to}={hi} is empty; expected {from} below {to}")));
        }
        factors.push(interval(lo, hi));
    }
    Ok(Arc::new(Separable::product(factors)))
}

fn make_step(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let mut factors = vec![Factor::One; given.dim];
    factors[given.axis()?] = interval(0.0, given.number("at")?);
    Ok(Arc::new(Separable::product(factors)))
}

//! One side of a line or plane.

use std::sync::Arc;

use super::entry::{Entry, Given, wrong};
use super::half_space::HalfSpace;
use super::shape::Shape;
use super::spec::Parameter;
use crate::error::Result;
use crate::samplers::Accepts;

pub(super) static ENTRY: Entry = Entry {
    aliases: &["half-space"],
    formulas: "f_m = i/(2 pi |m|^2) sum over edges (m_x dy - m_y dx) exp(-2 pi i m.mid) sinc(m.(dx, dy)), counter-clockwise (3D: over faces, of their own edges); a(r) = sum over the 2^d boxes of the wrap of the measure where n.x < min(c, c - n.t)",
    source: "divergence theorem: Lee & Mittra 1983",
    dims: 2..=3,
    parameters: &[
        Parameter::number("angle", "0.6", Accepts::Between(-10.0, 10.0), "of the normal to the x axis, in radians"),
        Parameter::number(
            "offset",
            "0.5",
            Accepts::Between(-2.0, 2.0),
            "distance of the line from the origin, along the normal",
        ),
        Parameter::number("tilt", "0", Accepts::Between(-10.0, 10.0), "of the normal out of the x-y plane, in radians")
            .only_from(3),
    ],
    ..Entry::new("half-plane", "1 where x cos angle + y sin angle < offset", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let (angle, offset) = (given.number("angle")?, given.number("offset")?);
    let tilt = if given.dim == 3 { given.number("tilt")? } else { 0.0 };
    let normal = [angle.cos() * tilt.cos(), angle.sin() * tilt.cos(), tilt.sin()];
    let (least, most) = normal.iter().fold((0.0, 0.0), |(least, most), n| (least + n.min(0.0), most + n.max(0.0)));
    if offset <= least || most <= offset {
        let what = if offset <= least { "none" } else { "all" };
        let reason =
            format!("offset={offset} leaves {what} of the box; expected one above {least:.4} and below {most:.4}");
        return Err(wrong(reason));
    }
    Ok(Arc::new(HalfSpace::new(given.dim, normal, offset)))
}

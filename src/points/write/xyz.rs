//! `.xyz`, the extended form: a frame for each realization, with x, y and z, those that points do not have as 0.

use std::io::{self, Write};

use super::ply::in_space;
use super::{Format, Output, Refusal};
use crate::points::RawPoints;

pub(super) struct Xyz<'a>(pub(super) Output<'a>);

impl Format for Xyz<'_> {
    fn add(&mut self, _: u64, set: &RawPoints) -> Result<(), Refusal> {
        writeln!(self.0, "{}\nProperties=species:S:1:pos:R:3", set.len())?;
        for point in set.coordinates.chunks_exact(set.dim) {
            let [x, y, z] = in_space(point, ".xyz")?;
            // Debug writes the shortest text that reads back as the same number.
            writeln!(self.0, "X {x:?} {y:?} {z:?}")?;
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

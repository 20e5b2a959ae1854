//! `.ply`, binary: x, y and z of one realization, those that points do not have as 0, because what draws PLY wants all three.

use std::io::{self, Write};

use super::{Format, Output, Refusal, npy, single};
use crate::points::RawPoints;

pub(super) struct Ply<'a>(pub(super) Output<'a>);

impl Format for Ply<'_> {
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal> {
        if k > 0 {
            return Err(single());
        }
        let n = set.len();
        writeln!(self.0, "ply\nformat binary_little_endian 1.0\nelement vertex {n}")?;
        writeln!(self.0, "property double x\nproperty double y\nproperty double z\nend_header")?;
        for point in set.coordinates.chunks_exact(set.dim) {
            npy::write_numbers(&mut self.0, &in_space(point, ".ply")?)?;
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// A point with all three coordinates.
pub(super) fn in_space(point: &[f64], format: &str) -> Result<[f64; 3], Refusal> {
    if point.len() > 3 {
        return Err(Refusal::Format(format!("{format} holds points in space, these have {} coordinates", point.len())));
    }
    Ok(std::array::from_fn(|axis| point.get(axis).copied().unwrap_or(0.0)))
}

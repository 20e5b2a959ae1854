//! Numbers and nothing else, little endian: `.rps` (PSA, f32 pairs), `.f32`, `.f64`. One realization.

use std::io::{self, Write};

use super::{Format, Output, Refusal, narrow, npy, single};
use crate::points::RawPoints;

pub(super) enum Kind {
    Rps,
    F32,
    F64,
}

pub(super) struct Raw<'a> {
    output: Output<'a>,
    kind: Kind,
}

impl<'a> Raw<'a> {
    pub(super) fn new(output: Output<'a>, kind: Kind) -> Self {
        Self { output, kind }
    }
}

impl Format for Raw<'_> {
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal> {
        if k > 0 {
            return Err(single());
        }
        if set.is_empty() {
            return Err(Refusal::Format("a realization without points would be an empty file".to_owned()));
        }
        match self.kind {
            Kind::Rps if set.dim != 2 => {
                let reason = format!(".rps holds points in the plane, these have {} coordinates", set.dim);
                return Err(Refusal::Format(reason));
            }
            Kind::Rps | Kind::F32 => {
                let mut numbers = set.coordinates.iter().map(|&x| narrow(x).to_le_bytes());
                numbers.try_for_each(|bytes| self.output.write_all(&bytes))?;
            }
            Kind::F64 => npy::write_numbers(&mut self.output, &set.coordinates)?,
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}

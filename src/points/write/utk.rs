//! UTK's `.bin`, f64; the header is described at its reader.

use std::io::{self, Seek, SeekFrom, Write};

use super::{Format, Output, Refusal, npy, unequal};
use crate::points::RawPoints;

/// In the first spare byte of the header: these sets were written one by one. UTK's own writer, which repeats the
/// first set m times, leaves 0; its reader ignores the byte.
pub(in crate::points) const SETS_DIFFER: u8 = 1;
const F64: u8 = 5;

pub(super) struct Utk<'a> {
    output: Output<'a>,
    sets: u32,
    n: u32,
    dim: u32,
}

impl<'a> Utk<'a> {
    pub(super) fn new(output: Output<'a>) -> Self {
        Self { output, sets: 0, n: 0, dim: 0 }
    }
}

impl Format for Utk<'_> {
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal> {
        let too_large = || Refusal::Format("a UTK .bin counts in 32 bits; .npy holds more".to_owned());
        if k == 0 {
            // The number of sets is known at the end.
            self.output.write_all(&[0; 20])?;
            self.n = u32::try_from(set.len()).map_err(|_| too_large())?;
            self.dim = set.dim as u32;
        } else if set.len() as u64 != u64::from(self.n) {
            return Err(unequal(k, set.len(), u64::from(self.n)));
        }
        self.sets = self.sets.checked_add(1).ok_or_else(too_large)?;
        Ok(npy::write_numbers(&mut self.output, &set.coordinates)?)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.output.seek(SeekFrom::Start(0))?;
        self.output.write_all(b"UTK!")?;
        self.output.write_all(&[F64, SETS_DIFFER, 0, 0])?;
        for number in [self.sets, self.n, self.dim] {
            self.output.write_all(&number.to_le_bytes())?;
        }
        self.output.flush()
    }
}

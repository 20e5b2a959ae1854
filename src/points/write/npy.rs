//! `.npy`: f64, shape (n, d) for one realization, (K, n, d) for several.

use std::io::{self, Seek, SeekFrom, Write};

use super::{Format, Output, Refusal, unequal};
use crate::points::RawPoints;

/// Long enough for any shape, and a multiple of 64 as numpy wants it.
const HEADER: usize = 128;

pub(super) struct Npy<'a> {
    output: Output<'a>,
    sets: u64,
    n: u64,
    dim: usize,
}

impl<'a> Npy<'a> {
    pub(super) fn new(output: Output<'a>) -> Self {
        Self { output, sets: 0, n: 0, dim: 0 }
    }
}

impl Format for Npy<'_> {
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal> {
        if k == 0 {
            // Shape and header are known at the end.
            self.output.write_all(&[0; HEADER])?;
            (self.n, self.dim) = (set.len() as u64, set.dim);
        } else if set.len() as u64 != self.n {
            return Err(unequal(k, set.len(), self.n));
        }
        self.sets += 1;
        Ok(write_numbers(&mut self.output, &set.coordinates)?)
    }

    fn finish(&mut self) -> io::Result<()> {
        let shape = match self.sets {
            1 => format!("({}, {})", self.n, self.dim),
            k => format!("({k}, {}, {})", self.n, self.dim),
        };
        self.output.seek(SeekFrom::Start(0))?;
        self.output.write_all(&header(&shape))?;
        self.output.flush()
    }
}

/// A version 1 header of `HEADER` bytes for C-ordered f64.
pub(super) fn header(shape: &str) -> Vec<u8> {
    let dictionary = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend(((HEADER - 10) as u16).to_le_bytes());
    header.extend(dictionary.bytes());
    header.resize(HEADER - 1, b' ');
    header.push(b'\n');
    header
}

pub(super) fn write_numbers(output: &mut impl Write, numbers: &[f64]) -> io::Result<()> {
    numbers.iter().try_for_each(|x| output.write_all(&x.to_le_bytes()))
}

//! `.npz`: one f64 array (n, d) per realization, `set_0` onwards, stored without compression (random digits do not
//! compress).

use std::io;

use zip::write::SimpleFileOptions;

use super::{Format, Output, Refusal, npy};
use crate::points::RawPoints;

pub(super) struct Npz<'a> {
    /// `None` once finished.
    archive: Option<zip::ZipWriter<Output<'a>>>,
}

impl<'a> Npz<'a> {
    pub(super) fn new(output: Output<'a>) -> Self {
        Self { archive: Some(zip::ZipWriter::new(output)) }
    }
}

impl Format for Npz<'_> {
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal> {
        let Some(archive) = &mut self.archive else { return Ok(()) };
        let large = set.coordinates.len() >= 1 << 28;
        let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored).large_file(large);
        archive.start_file(format!("set_{k}.npy"), options).map_err(io::Error::from)?;
        let mut bytes = npy::header(&format!("({}, {})", set.len(), set.dim));
        npy::write_numbers(&mut bytes, &set.coordinates)?;
        Ok(io::Write::write_all(archive, &bytes)?)
    }

    fn finish(&mut self) -> io::Result<()> {
        match self.archive.take() {
            Some(archive) => io::Write::flush(&mut archive.finish().map_err(io::Error::from)?),
            None => Ok(()),
        }
    }
}

//! All numbers of a result in one file: its arrays as they are called, and the columns of its tables as `table/column`.

use std::io::{self, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::{npy, outputs};
use crate::estimate::Analysis;
use crate::statistics::{Array, Column, Make, Values};

/// Writes the archive.
pub(super) fn write(analysis: &Analysis, file: &mut dyn Write) -> io::Result<()> {
    let mut archive = ZipWriter::new_stream(file);
    for output in outputs::all() {
        let name = output.name.split('.').next().unwrap_or_default();
        match output.make {
            Make::Table(make) => {
                let Some(table) = make(analysis) else { continue };
                for (column, cells) in table.values() {
                    let values = match cells {
                        Column::Real(cells) => Values::Real(Box::new(cells.into_iter())),
                        Column::Integer(cells) => Values::Integer(Box::new(cells.into_iter())),
                        Column::Text(_) => continue,
                    };
                    let shape = vec![table.rows() as u64];
                    add(&mut archive, &format!("{name}/{column}"), Array { shape, values })?;
                }
            }
            Make::Array(make) => {
                if let Some(array) = make(analysis) {
                    add(&mut archive, name, array)?;
                }
            }
            Make::Figure(_) | Make::Image(_) | Make::Svg(_) | Make::Maps(_) => {}
        }
    }
    archive.finish()?.into_inner().flush()
}

fn add<W: Write + Seek>(archive: &mut ZipWriter<W>, name: &str, array: Array<'_>) -> io::Result<()> {
    // Complex numbers have 16 bytes.
    let large =
        array.shape.iter().try_fold(16, |bytes: u64, &side| bytes.checked_mul(side)).is_none_or(|b| b >> 31 > 0);
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated).large_file(large);
    archive.start_file(format!("{name}.npy"), options)?;
    npy::write(array, archive)
}

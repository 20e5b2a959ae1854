//! Arrays as .npy files, in C order.

use std::io;

use npyz::WriterBuilder;

use crate::statistics::{Array, Values};

/// Writes an array, value by value.
pub(super) fn write(array: Array<'_>, file: impl io::Write) -> io::Result<()> {
    match array.values {
        Values::Real(values) => write_values(&array.shape, values, file),
        Values::Integer(values) => write_values(&array.shape, values, file),
        Values::Complex(values) => write_values(&array.shape, values, file),
    }
}

fn write_values<T: npyz::AutoSerialize>(
    shape: &[u64],
    values: impl Iterator<Item = T>,
    file: impl io::Write,
) -> io::Result<()> {
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(shape).writer(file).begin_nd()?;
    writer.extend(values)?;
    writer.finish()
}

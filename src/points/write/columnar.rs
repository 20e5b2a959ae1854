//! `.parquet`, `.arrow` and `.feather`: columns x, y and z, and the number of each point's realization.

use std::io;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt64Array};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::file::properties::WriterProperties;

use super::{Format, Output, Refusal, axis_names};
use crate::points::RawPoints;

/// Which of the two.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Parquet,
    Arrow,
}

enum Writer<'a> {
    /// Columns are known with the first points.
    Waiting(Kind, Output<'a>),
    Parquet(ArrowWriter<Output<'a>>),
    Arrow(FileWriter<Output<'a>>),
    Done,
}

pub(super) struct Columnar<'a>(Writer<'a>);

impl<'a> Columnar<'a> {
    pub(super) fn new(output: Output<'a>, kind: Kind) -> Self {
        Self(Writer::Waiting(kind, output))
    }
}

fn failed(error: impl std::error::Error + Send + Sync + 'static) -> Refusal {
    Refusal::Disk(io::Error::other(error))
}

impl Format for Columnar<'_> {
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal> {
        if set.is_empty() {
            let reason =
                format!("realization {k} has no points, which a table cannot show; .npz holds empty realizations");
            return Err(Refusal::Format(reason));
        }
        let mut fields: Vec<Field> =
            axis_names(set.dim).into_iter().map(|name| Field::new(name, DataType::Float64, false)).collect();
        fields.push(Field::new("realization", DataType::UInt64, false));
        let schema = Arc::new(Schema::new(fields));
        let axis = |axis: usize| {
            let values = set.coordinates.iter().skip(axis).step_by(set.dim).copied();
            Arc::new(Float64Array::from_iter_values(values)) as ArrayRef
        };
        let mut columns: Vec<ArrayRef> = (0..set.dim).map(axis).collect();
        columns.push(Arc::new(UInt64Array::from_value(k, set.len())));
        let batch = RecordBatch::try_new(schema.clone(), columns).map_err(failed)?;
        if let Writer::Waiting(..) = self.0
            && let Writer::Waiting(kind, output) = std::mem::replace(&mut self.0, Writer::Done)
        {
            self.0 = match kind {
                Kind::Parquet => {
                    // Random digits neither repeat nor compress.
                    let plain = WriterProperties::builder().set_dictionary_enabled(false).build();
                    Writer::Parquet(ArrowWriter::try_new(output, schema, Some(plain)).map_err(failed)?)
                }
                Kind::Arrow => Writer::Arrow(FileWriter::try_new(output, &schema).map_err(failed)?),
            };
        }
        match &mut self.0 {
            Writer::Parquet(writer) => writer.write(&batch).map_err(failed),
            Writer::Arrow(writer) => writer.write(&batch).map_err(failed),
            Writer::Waiting(..) | Writer::Done => Ok(()),
        }
    }

    fn finish(&mut self) -> io::Result<()> {
        match std::mem::replace(&mut self.0, Writer::Done) {
            Writer::Parquet(writer) => {
                let mut output = writer.into_inner().map_err(io::Error::other)?;
                io::Write::flush(&mut output)
            }
            Writer::Arrow(mut writer) => {
                writer.finish().map_err(io::Error::other)?;
                io::Write::flush(writer.get_mut())
            }
            Writer::Waiting(..) | Writer::Done => Ok(()),
        }
    }
}

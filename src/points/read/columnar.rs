//! Parquet and Arrow IPC (Feather): tables in columns. Of nested columns only their names are read.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use arrow_array::cast::AsArray;
use arrow_array::{Array, ArrayRef, RecordBatch, types};
use arrow_ipc::reader::FileReader;
use arrow_schema::{DataType, Schema};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use super::table::{Described, Field, Table};
use super::{Apart, Columns, MarkedPoints};
use crate::error::{Error, Result};

pub(super) const PARQUET: &[u8] = b"PAR1";
pub(super) const ARROW: &[u8] = b"ARROW1";

/// A column of a piece of a table.
enum Values {
    Numbers(Vec<Option<f64>>),
    Text(Vec<Option<String>>),
}

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    // Their libraries take the structure of a file at its word in places.
    let read = catch_unwind(AssertUnwindSafe(|| match bytes.starts_with(PARQUET) {
        true => parquet(name, bytes, columns),
        false => arrow(name, bytes, columns),
    }));
    read.unwrap_or_else(|_| Err(damaged(name, &"its structure is not that of its header")))
}

fn damaged(name: &str, reason: &dyn std::fmt::Display) -> Error {
    Error::input(name, format!("damaged Parquet or Arrow file: {reason}"))
}

fn parquet(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(bytes::Bytes::copy_from_slice(bytes))
        .map_err(|e| damaged(name, &e))?;
    let schema = builder.schema().clone();
    let mut table = table(name, columns, &schema)?;
    let wanted = wanted(&table, &schema);
    let mask = ProjectionMask::roots(builder.parquet_schema(), wanted.iter().copied());
    let reader = builder.with_projection(mask).build().map_err(|e| damaged(name, &e))?;
    for batch in reader {
        rows(name, &batch.map_err(|e| damaged(name, &e))?, &wanted, &mut table)?;
    }
    finish(table, &schema, "Parquet")
}

fn arrow(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let whole = FileReader::try_new(Cursor::new(bytes), None).map_err(|e| damaged(name, &e))?;
    let schema = whole.schema();
    let mut table = table(name, columns, &schema)?;
    let wanted = wanted(&table, &schema);
    let reader = FileReader::try_new(Cursor::new(bytes), Some(wanted.clone())).map_err(|e| damaged(name, &e))?;
    for batch in reader {
        rows(name, &batch.map_err(|e| damaged(name, &e))?, &wanted, &mut table)?;
    }
    finish(table, &schema, "Arrow IPC")
}

fn table<'a>(name: &'a str, columns: &'a Columns, schema: &Schema) -> Result<Table<'a>> {
    let names: Vec<String> = schema.fields().iter().map(|field| field.name().clone()).collect();
    Table::new(name, columns, &names, None)
}

/// The columns that are looked at, in the order of the file.
fn wanted(table: &Table<'_>, schema: &Schema) -> Vec<usize> {
    (0..schema.fields().len()).filter(|&k| table.takes(k)).collect()
}

fn rows(name: &str, batch: &RecordBatch, wanted: &[usize], table: &mut Table<'_>) -> Result<()> {
    let mut columns = Vec::with_capacity(wanted.len());
    for (&k, column) in wanted.iter().zip(batch.columns()) {
        let values = values(column).ok_or_else(|| {
            let reason =
                format!("column {} holds {}; expected numbers or text", table.layout.name(k), column.data_type());
            Error::input(name, reason)
        })?;
        columns.push((k, values));
    }
    for j in 0..batch.num_rows() {
        table.row(None, |k| match columns.iter().find(|(known, _)| *known == k).map(|(_, values)| values) {
            Some(Values::Numbers(numbers)) => numbers[j].map_or(Field::Nothing, Field::Number),
            Some(Values::Text(texts)) => texts[j].as_deref().map_or(Field::Nothing, |text| Field::Text(text.into())),
            None => Field::Nothing,
        })?;
    }
    Ok(())
}

/// The values of a column of numbers or text; `None` of any other.
fn values(column: &ArrayRef) -> Option<Values> {
    macro_rules! numbers {
        ($type:ident, $to_f64:expr) => {
            Values::Numbers(column.as_primitive_opt::<types::$type>()?.iter().map(|x| x.map($to_f64)).collect())
        };
    }
    Some(match column.data_type() {
        DataType::Float64 => numbers!(Float64Type, |x| x),
        DataType::Float32 => numbers!(Float32Type, f64::from),
        DataType::Float16 => numbers!(Float16Type, half::f16::to_f64),
        DataType::Int64 => numbers!(Int64Type, |x| x as f64),
        DataType::Int32 => numbers!(Int32Type, f64::from),
        DataType::Int16 => numbers!(Int16Type, f64::from),
        DataType::Int8 => numbers!(Int8Type, f64::from),
        DataType::UInt64 => numbers!(UInt64Type, |x| x as f64),
        DataType::UInt32 => numbers!(UInt32Type, f64::from),
        DataType::UInt16 => numbers!(UInt16Type, f64::from),
        DataType::UInt8 => numbers!(UInt8Type, f64::from),
        DataType::Utf8 => texts(column.as_string_opt::<i32>()?.iter()),
        DataType::LargeUtf8 => texts(column.as_string_opt::<i64>()?.iter()),
        DataType::Utf8View => texts(column.as_string_view_opt()?.iter()),
        DataType::Boolean => {
            Values::Text(column.as_boolean_opt()?.iter().map(|flag| flag.map(|flag| flag.to_string())).collect())
        }
        DataType::Dictionary(..) => {
            let dictionary = column.as_any_dictionary_opt()?;
            let (keys, known) = (dictionary.keys(), values(dictionary.values())?);
            let empty = dictionary.values().is_empty();
            let places = if empty { vec![0; keys.len()] } else { dictionary.normalized_keys() };
            let at = |j: usize| (!empty && !keys.is_null(j)).then(|| places[j]);
            match known {
                Values::Numbers(known) => Values::Numbers((0..keys.len()).map(|j| known[at(j)?]).collect()),
                Values::Text(known) => Values::Text((0..keys.len()).map(|j| known[at(j)?].clone()).collect()),
            }
        }
        _ => return None,
    })
}

fn texts<'a>(texts: impl Iterator<Item = Option<&'a str>>) -> Values {
    Values::Text(texts.map(|text| text.map(str::to_string)).collect())
}

fn finish(mut table: Table<'_>, schema: &Schema, format: &str) -> Result<Vec<MarkedPoints>> {
    table.end_set();
    let digits = |k: &usize| match schema.field(*k).data_type() {
        DataType::Float16 => Some(11),
        DataType::Float32 => Some(24),
        _ => None,
    };
    let digits = table.layout.columns.iter().filter_map(digits).min();
    table.finish(Described { format: format.into(), apart: Apart::Files, digits, ..Described::default() })
}

//! Parquet and Arrow IPC, where they are built in.

use std::sync::Arc;

use arrow_array::{
    ArrayRef, BooleanArray, DictionaryArray, Float32Array, Float64Array, Int64Array, LargeStringArray, RecordBatch,
    StringArray, StringViewArray, types::Int32Type,
};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{DataType, Field, Schema, TimeUnit};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, GzipLevel, ZstdLevel};
use parquet::file::properties::WriterProperties;

use crate::shared::{read, read_typed};
use pairwave::points::RawPoints;
use pairwave::points::read::{Columns, TypedColumns, read_marked};
use pairwave::points::write::write;

fn batch(columns: Vec<(&str, ArrayRef)>) -> RecordBatch {
    let fields: Vec<Field> = columns.iter().map(|(name, a)| Field::new(*name, a.data_type().clone(), true)).collect();
    let arrays = columns.into_iter().map(|(_, array)| array).collect();
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays).unwrap()
}

fn parquet(batch: &RecordBatch, compression: Compression) -> Vec<u8> {
    let mut bytes = Vec::new();
    let properties =
        WriterProperties::builder().set_compression(compression).set_max_row_group_row_count(Some(2)).build();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties)).unwrap();
    writer.write(batch).unwrap();
    writer.close().unwrap();
    bytes
}

fn arrow(batch: &RecordBatch) -> Vec<u8> {
    let mut writer = FileWriter::try_new(Vec::new(), &batch.schema()).unwrap();
    writer.write(&batch.slice(0, 1)).unwrap();
    writer.write(&batch.slice(1, batch.num_rows() - 1)).unwrap();
    writer.finish().unwrap();
    writer.into_inner().unwrap()
}

fn trees() -> RecordBatch {
    let species: DictionaryArray<Int32Type> = ["oak", "elm", "oak"].into_iter().collect();
    batch(vec![
        ("id", Arc::new(Int64Array::from(vec![7, 8, 9]))),
        ("y", Arc::new(Float32Array::from(vec![0.25, 0.5, 1.0]))),
        ("species", Arc::new(species)),
        ("x", Arc::new(Float64Array::from(vec![0.1, 0.2, 0.3]))),
        ("note", Arc::new(StringArray::from(vec![Some("a"), None, Some("")]))),
        ("plot", Arc::new(LargeStringArray::from(vec!["p", "q", "p"]))),
        ("old", Arc::new(BooleanArray::from(vec![true, false, true]))),
        ("w", Arc::new(Float64Array::from(vec![Some(2.0), None, Some(3.0)]))),
        ("seen", Arc::new(arrow_array::TimestampSecondArray::from(vec![1, 2, 3]))),
        ("frame", Arc::new(StringViewArray::from(vec!["0", "1", "1"]))),
    ])
}

#[test]
fn columns_are_chosen_as_in_text() {
    let trees = trees();
    assert_eq!(trees.schema().field(8).data_type(), &DataType::Timestamp(TimeUnit::Second, None));
    let zstd = Compression::ZSTD(ZstdLevel::default());
    let gzip = Compression::GZIP(GzipLevel::default());
    let mut files = vec![(arrow(&trees), "Arrow IPC")];
    for compression in [Compression::UNCOMPRESSED, Compression::SNAPPY, gzip, Compression::LZ4_RAW, zstd] {
        files.push((parquet(&trees, compression), "Parquet"));
    }
    for (bytes, format) in files {
        let none = TypedColumns::default();
        let sets = read_typed("a.parquet", &bytes, none).unwrap();
        let reading = &sets[0].reading;
        assert_eq!((sets.len(), reading.format.as_str(), reading.digits), (1, format, Some(24)));
        assert_eq!(sets[0].points.coordinates, [0.1, 0.25, 0.2, 0.5, 0.3, 1.0]);
        assert_eq!(reading.columns, ["x", "y"]);
        assert_eq!(reading.unused, ["id", "species", "note", "plot", "old", "w", "seen", "frame"]);
        assert!(reading.notes[0].contains("column frame has 2 values and was not used: 3 points are one realization"));
        let sets = read_typed("a", &bytes, TypedColumns { class: Some("species"), realization: Some("plot"), ..none });
        let sets = sets.unwrap();
        assert_eq!(sets.iter().map(|s| s.labels.join(",")).collect::<Vec<_>>(), ["oak,oak", "elm"]);
        let set = read_typed("a", &bytes, TypedColumns { columns: Some("4,id"), class: Some("old"), ..none }).unwrap();
        assert_eq!((&set[0].points.coordinates[..2], &set[0].labels[0][..]), (&[0.1, 7.0][..], "true"));
        let fails = |typed| read_typed("a.parquet", &bytes, typed).unwrap_err();
        assert_eq!(
            fails(TypedColumns { weight: Some("w"), ..none }),
            "a.parquet, point 1: nothing is not a number; expected a number in column w"
        );
        assert_eq!(fails(TypedColumns { class: Some("note"), ..none }), "a.parquet, point 1: no class in column note");
        assert!(
            fails(TypedColumns { weight: Some("seen"), ..none }).starts_with("a.parquet: column seen holds Timestamp")
        );
        assert!(
            fails(TypedColumns { weight: Some("mass"), ..none }).contains("no column of that name; there are id, y, ")
        );
        // Cut short anywhere, and with bits flipped.
        for at in (0..bytes.len()).step_by(7) {
            assert!(read("a.parquet", &bytes[..at]).is_err(), "{at}");
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x55;
            drop(read("a.parquet", damaged));
        }
    }
}

#[test]
fn written_tables_read_back_bit_for_bit() {
    let folder = tempfile::TempDir::new().unwrap();
    let set = |n: usize, dim: usize, seed: u64| {
        let number = |k: usize| f64::from_bits((k as u64 + 1).wrapping_mul(seed + 0x9e37_79b9_7f4a_7c15) >> 2);
        RawPoints { dim, coordinates: (0..n * dim).map(number).collect(), source: "s".into(), lines: vec![] }
    };
    for name in ["a.parquet", "a.arrow", "a.feather"] {
        for dim in 1..=3 {
            let sets = [set(9, dim, 1), set(4, dim, 2), set(1, dim, 3)];
            let path = folder.path().join(format!("{dim}{name}"));
            write(&path, &mut sets.iter().cloned().map(Ok), false).unwrap();
            let typed = TypedColumns { realization: Some("realization"), ..TypedColumns::default() };
            let back = read_marked(&[path], &crate::shared::NO_OPTIONS, &Columns::new(&typed).unwrap()).unwrap();
            let bits = |set: &RawPoints| set.coordinates.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(
                back.iter().map(|s| bits(&s.points)).collect::<Vec<_>>(),
                sets.iter().map(bits).collect::<Vec<_>>()
            );
        }
        let empty = RawPoints { dim: 2, coordinates: vec![], source: "e".into(), lines: vec![] };
        let refused = write(&folder.path().join(format!("e{name}")), &mut [Ok(empty)].into_iter(), false).unwrap_err();
        assert!(refused.to_string().contains("realization 0 has no points, which a table cannot show"), "{refused}");
    }
}

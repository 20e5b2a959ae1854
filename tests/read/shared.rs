//! Shared by the tests of this room.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use npyz::WriterBuilder as _;
use pairwave::points::RawPoints;
use pairwave::points::read::{Columns, MarkedPoints, ReadOptions, TypedColumns, read_all, read_marked};
use tempfile::TempDir;

pub const NO_OPTIONS: ReadOptions = ReadOptions { dim: None, raw: None };

/// One file in a folder of its own.
pub struct Input {
    pub folder: TempDir,
    pub path: PathBuf,
}

pub fn input(name: &str, bytes: impl AsRef<[u8]>) -> Input {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    Input { folder, path }
}

pub fn read_with(input: &Input, options: &ReadOptions) -> Result<Vec<RawPoints>, String> {
    let folder = format!("{}/", input.folder.path().display());
    read_all(std::slice::from_ref(&input.path), options).map_err(|e| e.to_string().replace(&folder, ""))
}

pub fn read(name: &str, bytes: impl AsRef<[u8]>) -> Result<Vec<RawPoints>, String> {
    read_with(&input(name, bytes), &NO_OPTIONS)
}

/// What is read where columns are named, and how.
pub fn read_typed(name: &str, bytes: impl AsRef<[u8]>, typed: TypedColumns<'_>) -> Result<Vec<MarkedPoints>, String> {
    let input = input(name, bytes);
    let folder = format!("{}/", input.folder.path().display());
    Columns::new(&typed)
        .and_then(|columns| read_marked(std::slice::from_ref(&input.path), &NO_OPTIONS, &columns))
        .map_err(|e| e.to_string().replace(&folder, ""))
}

/// What is said about a file, without the folder it lies in.
pub fn notes(name: &str, bytes: impl AsRef<[u8]>) -> Vec<String> {
    let sets = read_typed(name, bytes, TypedColumns::default()).unwrap();
    let bare = |note: &String| note.split_once(name).map_or(note.clone(), |(_, rest)| rest.to_string());
    sets[0].reading.notes.iter().map(bare).collect()
}

/// Sets as (dim, coordinates).
pub fn content(sets: &[RawPoints]) -> Vec<(usize, Vec<f64>)> {
    sets.iter().map(|s| (s.dim, s.coordinates.clone())).collect()
}

pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// A `.npy` file as npyz writes it.
pub fn npy<T: npyz::Serialize + Copy>(dtype: &str, order: npyz::Order, shape: &[u64], values: &[T]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let dtype = npyz::DType::Plain(dtype.parse().unwrap());
    let options = npyz::WriteOptions::new().dtype(dtype).shape(shape).order(order).writer(&mut bytes);
    let mut writer = options.begin_nd().unwrap();
    writer.extend(values.iter().copied()).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A version 1 header as any program might write it.
pub fn npy_header(dictionary: &str, data: usize) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((dictionary.len() as u16).to_le_bytes());
    bytes.extend(dictionary.bytes());
    bytes.extend(vec![0; data]);
    bytes
}

pub fn npy_f64(shape: &str, data: usize) -> Vec<u8> {
    npy_header(&format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"), data)
}

pub fn zipped(entries: &[(&str, &[u8])], method: zip::CompressionMethod) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in entries {
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

pub fn utk(code: u8, spare: u8, [m, n, d]: [u32; 3], data: &[u8]) -> Vec<u8> {
    let mut bytes = b"UTK!".to_vec();
    bytes.extend([code, spare, 0, 0]);
    bytes.extend([m, n, d].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend(data);
    bytes
}

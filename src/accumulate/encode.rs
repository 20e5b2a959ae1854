//! Raw sums as bytes and back: named arrays behind a header in JSON, little-endian, with a checksum.
//!
//! ```text
//! magic "pairwave"   version u32   length of the header u64   header (JSON, UTF-8)   arrays   checksum u128
//! ```
//!
//! The header says where each array lies: `"arrays": [[name, type, elements], …]`, in the order of the bytes, one after the
//! other without gaps; types are `u64`, `u128` and `f64`. The checksum is XXH3-128 of everything before it. A file that is
//! cut short, damaged or of another kind is refused before any number of it is used.

use serde_json::{Map, Value, json};
use xxhash_rust::xxh3::xxh3_128;

use crate::error::{Error, Result};

/// How every file begins.
const MAGIC: &[u8; 8] = b"pairwave";

/// Raised when an older program would misread what a newer one writes.
const VERSION: u32 = 2;

/// Bytes in front of the header and after the arrays.
const FRONT: usize = 8 + 4 + 8;
const CHECKSUM: usize = 16;

/// Numbers on their way into a file.
#[derive(Debug, Default)]
pub struct Encoder {
    prefix: String,
    values: Map<String, Value>,
    arrays: Vec<Value>,
    bytes: Vec<u8>,
}

impl Encoder {
    /// Within `work`, all names are behind `name`.
    pub fn within<T>(&mut self, name: &str, work: impl FnOnce(&mut Self) -> T) -> T {
        let length = self.prefix.len();
        self.prefix.push_str(name);
        self.prefix.push('/');
        let done = work(self);
        self.prefix.truncate(length);
        done
    }

    /// A value of the header.
    pub fn value(&mut self, name: &str, value: impl Into<Value>) {
        self.values.insert(format!("{}{name}", self.prefix), value.into());
    }

    /// An array of integers.
    pub fn u64s(&mut self, name: &str, values: impl IntoIterator<Item = u64>) {
        self.array(name, "u64", values.into_iter().map(u64::to_le_bytes));
    }

    /// An array of wide integers.
    pub fn u128s(&mut self, name: &str, values: impl IntoIterator<Item = u128>) {
        self.array(name, "u128", values.into_iter().map(u128::to_le_bytes));
    }

    /// An array of numbers, to the bit.
    pub fn f64s(&mut self, name: &str, values: impl IntoIterator<Item = f64>) {
        self.array(name, "f64", values.into_iter().map(f64::to_le_bytes));
    }

    fn array<const N: usize>(&mut self, name: &str, kind: &str, values: impl Iterator<Item = [u8; N]>) {
        let before = self.bytes.len();
        values.for_each(|value| self.bytes.extend_from_slice(&value));
        let elements = (self.bytes.len() - before) / N;
        self.arrays.push(json!([format!("{}{name}", self.prefix), kind, elements]));
    }

    /// The file.
    pub fn finish(self) -> Vec<u8> {
        let header = json!({ "values": self.values, "arrays": self.arrays }).to_string();
        let mut file = Vec::with_capacity(FRONT + header.len() + self.bytes.len() + CHECKSUM);
        file.extend_from_slice(MAGIC);
        file.extend_from_slice(&VERSION.to_le_bytes());
        file.extend_from_slice(&(header.len() as u64).to_le_bytes());
        file.extend_from_slice(header.as_bytes());
        file.extend_from_slice(&self.bytes);
        let checksum = xxh3_128(&file);
        file.extend_from_slice(&checksum.to_le_bytes());
        file
    }
}

/// Numbers of a file, by name.
#[derive(Debug)]
pub struct Decoder<'a> {
    place: String,
    prefix: String,
    values: Map<String, Value>,
    arrays: Vec<(String, String, usize)>,
    bytes: &'a [u8],
}

impl<'a> Decoder<'a> {
    /// Checks the whole file. `place` is its name, for errors.
    ///
    /// # Errors
    /// `Error::Input` if it is no file of sums, of another version, cut short or damaged.
    pub fn new(place: &str, file: &'a [u8]) -> Result<Self> {
        let refuse = |reason: String| Error::input(place, reason);
        if !file.starts_with(MAGIC) {
            return Err(refuse("holds no sums of pairwave: it does not begin with `pairwave`".into()));
        }
        let cut = || refuse(format!("is cut short: {} bytes are no whole file of sums", file.len()));
        let number = |at: usize, len: usize| -> Option<u64> {
            let bytes = file.get(at..at + len)?;
            Some(bytes.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b)))
        };
        let version = number(8, 4).ok_or_else(cut)?;
        if version != u64::from(VERSION) {
            return Err(refuse(format!("is of version {version} of the format; this program reads version {VERSION}")));
        }
        let header = number(12, 8).and_then(|n| usize::try_from(n).ok()).ok_or_else(cut)?;
        let end = file.len().checked_sub(CHECKSUM).ok_or_else(cut)?;
        let text = FRONT.checked_add(header).filter(|&e| e <= end).and_then(|e| file.get(FRONT..e)).ok_or_else(cut)?;
        if xxh3_128(&file[..end]).to_le_bytes() != file[end..] {
            return Err(refuse("is damaged or cut short: its checksum does not fit".into()));
        }
        let strange = |what: &str| refuse(format!("has a header without {what}"));
        let header: Value =
            serde_json::from_slice(text).map_err(|e| refuse(format!("has a header that is no JSON: {e}")))?;
        let values = header["values"].as_object().ok_or_else(|| strange("values"))?.clone();
        let mut arrays = Vec::new();
        let mut wanted = 0u128;
        for row in header["arrays"].as_array().ok_or_else(|| strange("a list of arrays"))? {
            let (Some(name), Some(kind), Some(elements)) = (row[0].as_str(), row[1].as_str(), row[2].as_u64()) else {
                return Err(strange("names, types and lengths of its arrays"));
            };
            wanted += u128::from(elements) * width(kind).ok_or_else(|| strange("types that are known"))? as u128;
            arrays.push((name.to_string(), kind.to_string(), elements as usize));
        }
        let bytes = &file[FRONT + text.len()..end];
        if wanted != bytes.len() as u128 {
            return Err(refuse(format!("has {} bytes of arrays where its header says {wanted}", bytes.len())));
        }
        Ok(Self { place: place.to_string(), prefix: String::new(), values, arrays, bytes })
    }

    /// Within `work`, all names are behind `name`.
    pub fn within<T>(&mut self, name: &str, work: impl FnOnce(&mut Self) -> T) -> T {
        let length = self.prefix.len();
        self.prefix.push_str(name);
        self.prefix.push('/');
        let done = work(self);
        self.prefix.truncate(length);
        done
    }

    /// An error about what the file holds.
    pub fn error(&self, reason: impl Into<String>) -> Error {
        Error::input(&self.place, reason)
    }

    /// A value of the header.
    ///
    /// # Errors
    /// A name or a type that the file does not have.
    pub fn value(&self, name: &str) -> Result<&Value> {
        let name = format!("{}{name}", self.prefix);
        self.values.get(&name).ok_or_else(|| self.error(format!("lacks the value {name}")))
    }

    /// A value of the header that is a count.
    ///
    /// # Errors
    /// No such value, or one that is no count.
    pub fn count(&self, name: &str) -> Result<u64> {
        let value = self.value(name)?;
        value.as_u64().ok_or_else(|| self.error(format!("{name} is {value}; expected a count")))
    }

    /// A value of the header of any type that can be read from JSON.
    ///
    /// # Errors
    /// No such value, or one of another type.
    pub fn read<T: serde::de::DeserializeOwned>(&self, name: &str) -> Result<T> {
        let value = self.value(name)?.clone();
        serde_json::from_value(value).map_err(|e| self.error(format!("{name}: {e}")))
    }

    /// An array of integers.
    ///
    /// # Errors
    /// A name or a type that the file does not have.
    pub fn u64s(&self, name: &str) -> Result<Vec<u64>> {
        self.array(name, "u64", u64::from_le_bytes)
    }

    /// An array of wide integers.
    ///
    /// # Errors
    /// A name or a type that the file does not have.
    pub fn u128s(&self, name: &str) -> Result<Vec<u128>> {
        self.array(name, "u128", u128::from_le_bytes)
    }

    /// An array of numbers.
    ///
    /// # Errors
    /// A name or a type that the file does not have.
    pub fn f64s(&self, name: &str) -> Result<Vec<f64>> {
        self.array(name, "f64", f64::from_le_bytes)
    }

    /// An array of numbers of which there must be so many.
    ///
    /// # Errors
    /// As `f64s`, and another number of elements.
    pub fn f64s_of(&self, name: &str, len: usize) -> Result<Vec<f64>> {
        let values = self.f64s(name)?;
        self.check_len(name, values.len(), len)?;
        Ok(values)
    }

    /// Refuses another number of elements.
    ///
    /// # Errors
    /// Another number of elements.
    pub fn check_len(&self, name: &str, found: usize, wanted: usize) -> Result<()> {
        let reason = || format!("{}{name} has {found} elements; expected {wanted}", self.prefix);
        if found == wanted { Ok(()) } else { Err(self.error(reason())) }
    }

    fn array<T, const N: usize>(&self, name: &str, kind: &str, value: fn([u8; N]) -> T) -> Result<Vec<T>> {
        let name = format!("{}{name}", self.prefix);
        let mut start = 0;
        for (other, of, elements) in &self.arrays {
            let end = start + elements * width(of).unwrap_or(0);
            if *other == name && of == kind {
                let (values, _) = self.bytes[start..end].as_chunks::<N>();
                return Ok(values.iter().map(|&bytes| value(bytes)).collect());
            }
            start = end;
        }
        Err(self.error(format!("lacks the array {name} of {kind}")))
    }
}

/// Bytes of a number.
fn width(kind: &str) -> Option<usize> {
    match kind {
        "u64" | "f64" => Some(8),
        "u128" => Some(16),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> Vec<u8> {
        let mut out = Encoder::default();
        out.value("k", 7);
        out.within("waves", |out| {
            out.f64s("q", [0.1, f64::NAN, -0.0, 1e300]);
            out.u128s("c", [u128::MAX, 3]);
        });
        out.u64s("n", [1, u64::MAX]);
        out.finish()
    }

    #[test]
    fn numbers_read_back_to_the_bit() {
        let file = file();
        let mut read = Decoder::new("a.sums", &file).unwrap();
        assert_eq!((read.count("k").unwrap(), read.u64s("n").unwrap()), (7, vec![1, u64::MAX]));
        let bits = |v: Vec<f64>| v.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        read.within("waves", |read| {
            assert_eq!(bits(read.f64s("q").unwrap()), bits(vec![0.1, f64::NAN, -0.0, 1e300]));
            assert_eq!(read.u128s("c").unwrap(), [u128::MAX, 3]);
            assert!(read.u64s("c").unwrap_err().to_string().contains("waves/c"), "another type");
            assert!(read.f64s_of("q", 5).unwrap_err().to_string().contains("expected 5"));
        });
        assert!(read.f64s("q").unwrap_err().to_string().starts_with("a.sums: lacks"));
    }

    #[test]
    fn every_cut_and_every_flipped_bit_is_refused() {
        let file = file();
        for length in 0..file.len() {
            assert!(Decoder::new("a", &file[..length]).is_err(), "cut at {length}");
        }
        for at in 0..8 * file.len() {
            let mut damaged = file.clone();
            damaged[at / 8] ^= 1 << (at % 8);
            assert!(Decoder::new("a", &damaged).is_err(), "bit {at}");
        }
        let longer = [file.as_slice(), &[0]].concat();
        assert!(Decoder::new("a", &longer).is_err());
        let error = Decoder::new("x.csv", b"0.1,0.2").unwrap_err().to_string();
        assert!(error.contains("x.csv") && error.contains("no sums of pairwave"), "{error}");
    }
}

//! `.npz`: a zip archive of `.npy` arrays, each a realization (or several, if its shape is (K, n, d)), in the natural
//! order of their names.

use std::io::{Cursor, Read};

use super::{Columns, MarkedPoints, natural_key, npy};
use crate::error::{Error, Result};

/// The first entry of an archive, and the end of an empty one.
pub(super) const MAGICS: [&[u8]; 2] = [b"PK\x03\x04", b"PK\x05\x06"];

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Vec<MarkedPoints>> {
    let damaged = |place: &str, e: &dyn std::fmt::Display| Error::input(place, format!("damaged zip archive: {e}"));
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|e| damaged(name, &e))?;
    let names: Result<Vec<String>, _> = archive.file_names().map(|entry| entry.map(|e| e.into_owned())).collect();
    let mut entries = names.map_err(|e| damaged(name, &e))?;
    entries.retain(|entry| !entry.ends_with('/'));
    entries.sort_by_cached_key(|entry| natural_key(entry));
    if entries.is_empty() {
        return Err(Error::input(name, "no arrays in this archive"));
    }
    let mut sets = Vec::new();
    for entry in entries {
        let Some(array) = entry.strip_suffix(".npy") else {
            let reason = format!("a zip archive, but its entry {entry:?} is not a .npy array; expected .npz");
            return Err(Error::input(name, reason));
        };
        let place = format!("{name}, array {array}");
        let mut content = Vec::new();
        // The size that the archive claims is not trusted: the buffer grows with what is there.
        let mut file = archive.by_name(&entry).map_err(|e| damaged(&place, &e))?;
        file.read_to_end(&mut content).map_err(|e| damaged(&place, &e))?;
        if !content.starts_with(npy::MAGIC) {
            return Err(Error::input(place, "not a .npy array"));
        }
        sets.extend(super::numbered(&place, npy::read(&place, &content, columns)?, columns)?);
    }
    Ok(sets)
}

//! The keys of `summary.json`, one after the other.

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer as _};
use serde_json::Serializer;
use serde_json::ser::PrettyFormatter;

/// What writes the file. Floats are the shortest decimals that read back the same; NaN is null.
pub(crate) type Json = Serializer<Vec<u8>, PrettyFormatter<'static>>;

/// An object whose keys keep the order in which they are added.
pub(crate) struct Keys<'a>(<&'a mut Json as serde::Serializer>::SerializeMap);

impl<'a> Keys<'a> {
    /// Opens the object.
    pub(crate) fn new(json: &'a mut Json) -> serde_json::Result<Self> {
        json.serialize_map(None).map(Self)
    }

    /// Adds a key.
    pub(crate) fn add<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> serde_json::Result<()> {
        self.0.serialize_entry(key, value)
    }

    /// Closes the object.
    pub(crate) fn end(self) -> serde_json::Result<()> {
        self.0.end()
    }
}

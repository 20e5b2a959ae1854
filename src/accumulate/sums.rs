//! What all raw sums can do.

use std::any::Any;
use std::fmt::Debug;

use super::{ComputedBy, Decoder, Encoder};
use crate::error::Result;

/// Raw sums over realizations of one process, all measured by one plan. That they are of the same thing is for the caller
/// to know (`Measurement` compares identities); what would show in the sums themselves is refused here too.
pub trait Sums: Any + Debug + Clone + Send + Sync {
    /// Adds other realizations. Sums in f64 must consist of whole leaves of `LEAF` realizations (the very last may be partial).
    ///
    /// # Errors
    /// Sums of another shape, or that hold the same realizations.
    fn merge(&mut self, other: Self) -> Result<()>;

    /// Adds the realization that follows, to those of one leaf that is not full.
    ///
    /// # Errors
    /// As `merge`.
    fn append(&mut self, next: Self) -> Result<()> {
        // Integers, or numbers that are kept per realization: any order and any cut will do.
        self.merge(next)
    }

    /// Who computed them; `None` where that is not kept.
    fn computed_by(&self) -> Option<&ComputedBy>;

    /// Writes them, to the bit.
    fn encode(&self, out: &mut Encoder);

    /// Reads what `encode` wrote.
    ///
    /// # Errors
    /// Names and lengths that do not fit together.
    fn decode(from: &mut Decoder<'_>) -> Result<Self>;
}

impl ComputedBy {
    pub(super) fn encode(&self, out: &mut Encoder) {
        out.value("computed_by", serde_json::to_value(self).unwrap_or_default());
    }

    pub(super) fn decode(from: &Decoder<'_>) -> Result<Self> {
        from.read("computed_by")
    }
}

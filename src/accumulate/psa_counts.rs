//! Unordered pairs per bin of every realization: what PSA's statistics of the spectrum are made of.

use std::collections::BTreeMap;

use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};

/// Pairs per bin, by the index of the realization.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PsaCounts(BTreeMap<u64, Vec<u64>>);

impl PsaCounts {
    /// Adds realization `index`.
    pub fn add(&mut self, index: u64, pairs: Vec<u64>) {
        self.0.insert(index, pairs);
    }

    /// In the order of realizations.
    pub fn of_realizations(&self) -> Vec<&[u64]> {
        self.0.values().map(Vec::as_slice).collect()
    }
}

impl Sums for PsaCounts {
    fn merge(&mut self, other: Self) -> Result<()> {
        if let Some(twice) = other.0.keys().find(|index| self.0.contains_key(index)) {
            return Err(Error::input("pairs for PSA's statistics", format!("both parts hold realization {twice}")));
        }
        self.0.extend(other.0);
        Ok(())
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        None
    }

    fn encode(&self, out: &mut Encoder) {
        out.u64s("realizations", self.0.keys().copied());
        out.value("bins", self.0.values().next().map_or(0, Vec::len));
        out.u64s("pairs", self.0.values().flatten().copied());
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let (indices, pairs) = (from.u64s("realizations")?, from.u64s("pairs")?);
        let bins: usize = from.read("bins")?;
        from.check_len("pairs", pairs.len(), bins.saturating_mul(indices.len()))?;
        let rows = (0..indices.len()).map(|k| pairs[k * bins..(k + 1) * bins].to_vec());
        Ok(Self(indices.iter().copied().zip(rows).collect()))
    }
}

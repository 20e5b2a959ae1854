//! Numbers of points in boxes and balls: integers per size and realization, kept in the order of its index.

use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};

/// Counts of a batch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CountSums {
    /// Number of sizes.
    pub sizes: usize,
    /// Per realization, ordered by index.
    pub realizations: Vec<RealizationCounts>,
}

/// Counts of one realization.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RealizationCounts {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// Per size.
    pub sizes: Vec<Places>,
}

/// Counts at all places of one size: integrals over them in fixed-point steps where every place is counted at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Places {
    /// Number of places.
    pub places: u128,
    /// Sum of N.
    pub sum: u128,
    /// Sum of N squared.
    pub squares: u128,
}

impl Places {
    /// Adds places that hold as many points.
    pub fn add(&mut self, places: u128, points: u128) {
        self.places += places;
        self.sum += places * points;
        self.squares += places * points * points;
    }
}

impl CountSums {
    /// Of no realization.
    pub fn new(sizes: usize) -> Self {
        Self { sizes, realizations: Vec::new() }
    }

    /// Of realizations.
    ///
    /// # Errors
    /// Two of the same index, or counts of another number of sizes.
    pub fn of(sizes: usize, realizations: Vec<RealizationCounts>) -> Result<Self> {
        let mut sums = Self::new(sizes);
        sums.merge(Self { sizes, realizations })?;
        Ok(sums)
    }
}

impl Sums for CountSums {
    fn merge(&mut self, other: Self) -> Result<()> {
        let whole = |sums: &Self| sums.realizations.iter().all(|r| r.sizes.len() == sums.sizes);
        if self.sizes != other.sizes || !whole(&other) {
            return Err(Error::input("counts", format!("are of {} sizes; expected {}", other.sizes, self.sizes)));
        }
        self.realizations.extend(other.realizations);
        // Batches mostly come in order: sorting what is sorted takes one pass.
        self.realizations.sort_by_key(|r| r.index);
        match self.realizations.windows(2).find(|w| w[0].index == w[1].index) {
            Some(twice) => Err(Error::input("counts", format!("both parts hold realization {}", twice[0].index))),
            None => Ok(()),
        }
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        None
    }

    fn encode(&self, out: &mut Encoder) {
        out.value("sizes", self.sizes);
        out.u64s("realizations", self.realizations.iter().flat_map(|r| [r.index, r.n]));
        let places = self.realizations.iter().flat_map(|r| &r.sizes);
        out.u128s("places", places.flat_map(|p| [p.places, p.sum, p.squares]));
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let sizes = from.count("sizes")? as usize;
        let (heads, numbers) = (from.u64s("realizations")?, from.u128s("places")?);
        let (heads, _) = heads.as_chunks::<2>();
        from.check_len("places", numbers.len(), sizes.saturating_mul(3 * heads.len()))?;
        let places = |&[places, sum, squares]: &[u128; 3]| Places { places, sum, squares };
        let all: Vec<Places> = numbers.as_chunks::<3>().0.iter().map(places).collect();
        let rows = heads.iter().enumerate();
        let realization = |(k, &[index, n]): (usize, &[u64; 2])| RealizationCounts {
            index,
            n,
            sizes: all[k * sizes..(k + 1) * sizes].to_vec(),
        };
        Ok(Self { sizes, realizations: rows.map(realization).collect() })
    }
}

//! Discrepancies: a few numbers per realization, kept in the order of its index.

use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};

/// The discrepancies, in the order in which they are kept.
pub const DISCREPANCIES: [&str; 5] = ["star_l2", "centered_l2", "wrap_around_l2", "mixture_l2", "diaphony"];

/// Discrepancies of a batch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DiscrepancySums {
    /// Per realization, ordered by index.
    pub realizations: Vec<RealizationDiscrepancy>,
    /// Per level k, over realizations of 2^m points, m >= k: the kinds of elementary intervals of volume 2^-k, and those that
    /// hold as many points each.
    pub levels: Vec<LevelCounts>,
}

/// Kinds (shapes) of elementary intervals of one level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LevelCounts {
    /// How many were looked at.
    pub shapes: u64,
    /// How many of them hold as many points in every interval.
    pub equidistributed: u64,
}

/// What is kept of one realization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealizationDiscrepancy {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// The squares of `DISCREPANCIES`.
    pub squares: [f64; DISCREPANCIES.len()],
    /// Least distance of two points, in length units; `None` with fewer than two points.
    pub minimum: Option<f64>,
    /// That of neighbours in the closest packing known of n points.
    pub closest_packing: f64,
    /// Covering radius, in length units: one that a place has, and a bound of all. In 1 to 3 dimensions.
    pub covering: Option<[f64; 2]>,
    /// The largest k such that all elementary intervals of volume 2^-k hold as many points; `None` where n is no power of 2.
    pub strength: Option<u32>,
}

impl RealizationDiscrepancy {
    /// t of a `(t, m, d)`-net in base 2 of `n = 2^m` points.
    pub fn t(&self) -> Option<u32> {
        self.strength.map(|strength| self.n.trailing_zeros() - strength)
    }

    fn integers(&self) -> [u64; 5] {
        let some = |given: bool| u64::from(given);
        let strength = self.strength.map_or(0, |k| u64::from(k) + 1);
        [self.index, self.n, some(self.minimum.is_some()), some(self.covering.is_some()), strength]
    }

    fn numbers(&self) -> [f64; 9] {
        let [a, b, c, d, e] = self.squares;
        let [radius, bound] = self.covering.unwrap_or_default();
        [a, b, c, d, e, self.minimum.unwrap_or_default(), self.closest_packing, radius, bound]
    }

    fn of(integers: &[u64; 5], numbers: &[f64; 9]) -> Option<Self> {
        let [index, n, has_minimum, has_covering, strength] = *integers;
        let [a, b, c, d, e, minimum, closest_packing, radius, bound] = *numbers;
        let strength = match strength {
            0 => None,
            k => Some(u32::try_from(k - 1).ok().filter(|&k| n.is_power_of_two() && k <= n.trailing_zeros())?),
        };
        Some(Self {
            index,
            n,
            squares: [a, b, c, d, e],
            minimum: (has_minimum == 1).then_some(minimum),
            closest_packing,
            covering: (has_covering == 1).then_some([radius, bound]),
            strength,
        })
    }
}

impl DiscrepancySums {
    /// Adds one realization and what its levels count.
    ///
    /// # Errors
    /// A realization that is there already.
    pub fn add(&mut self, one: RealizationDiscrepancy, levels: Vec<LevelCounts>) -> Result<()> {
        self.merge(Self { realizations: vec![one], levels })
    }
}

impl Sums for DiscrepancySums {
    fn merge(&mut self, other: Self) -> Result<()> {
        self.realizations.extend_from_slice(&other.realizations);
        // Batches mostly come in order: sorting what is sorted takes one pass.
        self.realizations.sort_by_key(|r| r.index);
        if let Some(twice) = self.realizations.windows(2).find(|w| w[0].index == w[1].index) {
            return Err(Error::input("discrepancies", format!("both parts hold realization {}", twice[0].index)));
        }
        self.levels.resize(self.levels.len().max(other.levels.len()), LevelCounts::default());
        for (level, more) in self.levels.iter_mut().zip(&other.levels) {
            level.shapes += more.shapes;
            level.equidistributed += more.equidistributed;
        }
        Ok(())
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        None
    }

    fn encode(&self, out: &mut Encoder) {
        out.u64s("integers", self.realizations.iter().flat_map(RealizationDiscrepancy::integers));
        out.f64s("numbers", self.realizations.iter().flat_map(RealizationDiscrepancy::numbers));
        out.u64s("levels", self.levels.iter().flat_map(|l| [l.shapes, l.equidistributed]));
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let (integers, numbers) = (from.u64s("integers")?, from.f64s("numbers")?);
        let (integers, _) = integers.as_chunks::<5>();
        from.check_len("numbers", numbers.len(), 9 * integers.len())?;
        let rows = integers.iter().zip(numbers.as_chunks::<9>().0);
        let realizations: Option<Vec<_>> = rows.map(|(i, x)| RealizationDiscrepancy::of(i, x)).collect();
        let levels = from.u64s("levels")?;
        let level = |&[shapes, equidistributed]: &[u64; 2]| LevelCounts { shapes, equidistributed };
        Ok(Self {
            realizations: realizations.ok_or_else(|| from.error("holds a realization that cannot be"))?,
            levels: levels.as_chunks::<2>().0.iter().map(level).collect(),
        })
    }
}

//! Sums of kernels on a grid, and what their bandwidth is found by.

use super::ordered_sum::{NOT_NEXT, OrderedSum};
use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};

/// Over realizations, per cell. The additions are ordered by realization index (`OrderedSum`).
#[derive(Debug, Clone, PartialEq)]
pub struct IntensitySums {
    /// Number of realizations.
    pub realizations: u64,
    /// Number of points.
    pub points: u64,
    cells: usize,
    /// The sums, then those of their squares.
    moments: OrderedSum,
}

impl IntensitySums {
    /// Of no realization.
    pub fn new(cells: usize) -> Self {
        Self { realizations: 0, points: 0, cells, moments: OrderedSum::default() }
    }

    /// Adds realizations of one leaf: `sums` are over them of the sum of kernels per cell, then of its square.
    pub fn add_leaf(&mut self, leaf: u64, realizations: u64, points: u64, sums: Vec<f64>) {
        debug_assert_eq!(sums.len(), 2 * self.cells, "two values per cell");
        self.realizations += realizations;
        self.points += points;
        self.moments.add_leaf(leaf, sums);
    }

    /// Per cell the sum over realizations, and that of squares.
    pub fn totals(&self) -> [Vec<f64>; 2] {
        let mut sums = self.moments.total();
        sums.resize(2 * self.cells, 0.0);
        let squares = sums.split_off(self.cells);
        [sums, squares]
    }
}

impl Sums for IntensitySums {
    fn merge(&mut self, other: Self) -> Result<()> {
        if self.cells != other.cells {
            return Err(Error::input("intensity", format!("is of {} cells; expected {}", other.cells, self.cells)));
        }
        if self.moments.overlaps(&other.moments) {
            return Err(Error::input("intensity", "both parts hold the same realizations"));
        }
        self.realizations += other.realizations;
        self.points += other.points;
        self.moments.merge(other.moments);
        Ok(())
    }

    fn append(&mut self, next: Self) -> Result<()> {
        if self.cells != next.cells || !self.moments.append(&next.moments) {
            return Err(Error::input("intensity", NOT_NEXT));
        }
        self.realizations += next.realizations;
        self.points += next.points;
        Ok(())
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        None
    }

    fn encode(&self, out: &mut Encoder) {
        out.value("cells", self.cells);
        out.value("realizations", self.realizations);
        out.value("points", self.points);
        self.moments.encode("moments", out);
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let cells = from.count("cells")? as usize;
        let (realizations, points) = (from.count("realizations")?, from.count("points")?);
        let moments = OrderedSum::decode("moments", cells.saturating_mul(2), from)?;
        Ok(Self { realizations, points, cells, moments })
    }
}

/// What a bandwidth is found by, per realization.
#[derive(Debug, Clone, PartialEq)]
pub struct IntensityScores {
    /// Number of bandwidths.
    pub bandwidths: usize,
    /// Per realization, ordered by index.
    pub realizations: Vec<RealizationScores>,
}

/// Of one realization.
#[derive(Debug, Clone, PartialEq)]
pub struct RealizationScores {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// Sums of coordinates from the middle of the box along each axis, 0 beyond the dimension.
    pub sums: [f64; 3],
    /// Sums of their squares.
    pub squares: [f64; 3],
    /// Per bandwidth, the sum over points of the logarithm of the intensity that the others give there.
    pub logs: Vec<f64>,
}

impl IntensityScores {
    /// Of no realization.
    pub fn new(bandwidths: usize) -> Self {
        Self { bandwidths, realizations: Vec::new() }
    }
}

impl Sums for IntensityScores {
    fn merge(&mut self, other: Self) -> Result<()> {
        if self.bandwidths != other.bandwidths || other.realizations.iter().any(|r| r.logs.len() != self.bandwidths) {
            let reason = format!("is of {} bandwidths; expected {}", other.bandwidths, self.bandwidths);
            return Err(Error::input("intensity bandwidth", reason));
        }
        self.realizations.extend(other.realizations);
        // Batches mostly come in order: sorting what is sorted takes one pass.
        self.realizations.sort_by_key(|r| r.index);
        match self.realizations.windows(2).find(|w| w[0].index == w[1].index) {
            Some(twice) => {
                Err(Error::input("intensity bandwidth", format!("both parts hold realization {}", twice[0].index)))
            }
            None => Ok(()),
        }
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        None
    }

    fn encode(&self, out: &mut Encoder) {
        out.value("bandwidths", self.bandwidths);
        out.u64s("realizations", self.realizations.iter().flat_map(|r| [r.index, r.n]));
        out.f64s("moments", self.realizations.iter().flat_map(|r| [r.sums, r.squares]).flatten());
        out.f64s("logs", self.realizations.iter().flat_map(|r| r.logs.iter().copied()));
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let bandwidths = from.count("bandwidths")? as usize;
        let heads = from.u64s("realizations")?;
        let (heads, _) = heads.as_chunks::<2>();
        let moments = from.f64s_of("moments", heads.len().saturating_mul(6))?;
        let logs = from.f64s_of("logs", heads.len().saturating_mul(bandwidths))?;
        let rows = heads.iter().zip(moments.as_chunks::<6>().0).enumerate();
        let realization = |(k, (&[index, n], &[a, b, c, d, e, f])): (usize, (&[u64; 2], &[f64; 6]))| {
            let logs = logs[k * bandwidths..(k + 1) * bandwidths].to_vec();
            RealizationScores { index, n, sums: [a, b, c], squares: [d, e, f], logs }
        };
        Ok(Self { bandwidths, realizations: rows.map(realization).collect() })
    }
}

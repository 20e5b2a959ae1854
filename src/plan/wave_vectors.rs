//! The wave vectors of a spectrum: a grid, or a list.

use super::WaveGrid;
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::setting::Setting;

/// The wave vectors of a spectrum, in cycles per side of the domain along each axis.
#[derive(Debug, Clone, PartialEq)]
pub enum WaveVectors {
    /// All integer vectors of a box about 0; half of them are computed and stored.
    Grid(WaveGrid),
    /// Those of a list.
    List(WaveList),
}

/// Wave vectors one by one.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveList {
    /// Number of axes.
    pub dim: usize,
    /// Cycles per side along each axis, 0 along axes the domain lacks; integers on a torus.
    pub vectors: Vec<[f64; 3]>,
    /// Whether each also stands for its mirror image.
    pub mirrored: bool,
}

/// Bytes that a listed wave vector takes in plans, sums, estimates and tables.
const BYTES_PER_VECTOR: u128 = 256;

/// Lists that would take more than that are refused: 16 GiB.
const MOST_BYTES: u128 = 1 << 34;

impl WaveList {
    /// Whether there is memory for it. `setting` and `value` are where it comes from.
    pub(crate) fn check_size(&self, setting: Setting, value: impl ToString) -> Result<()> {
        check_vectors(self.vectors.len() as u128, setting, value)
    }
}

/// Whether there is memory for so many wave vectors.
pub(super) fn check_vectors(vectors: u128, setting: Setting, value: impl ToString) -> Result<()> {
    let bytes = vectors * BYTES_PER_VECTOR;
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    let most = MOST_BYTES / BYTES_PER_VECTOR;
    let reason = format!("{vectors} wave vectors take {bytes} bytes; expected at most {most} ({MOST_BYTES} bytes)");
    Err(Error::setting(setting, value, reason))
}

impl WaveVectors {
    /// Bytes that sums, estimates and output take of them.
    pub(crate) fn memory(&self) -> u128 {
        match self {
            Self::Grid(grid) => grid.memory(),
            Self::List(list) => list.vectors.len() as u128 * BYTES_PER_VECTOR,
        }
    }

    /// Number of axes.
    pub fn dim(&self) -> usize {
        match self {
            Self::Grid(grid) => grid.dim(),
            Self::List(list) => list.dim,
        }
    }

    /// Number of modes that are computed and stored.
    pub fn len(&self) -> usize {
        match self {
            Self::Grid(grid) => grid.half_len(),
            Self::List(list) => list.vectors.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The stored mode at `index`, in cycles per side.
    pub fn vector(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Grid(grid) => grid.mode(index).map(f64::from),
            Self::List(list) => list.vectors[index],
        }
    }

    /// Its frequency `nu = m / L`, in cycles per unit length.
    pub fn frequency(&self, index: usize, domain: &Domain) -> [f64; 3] {
        let (m, sides) = (self.vector(index), domain.sides());
        std::array::from_fn(|k| sides.get(k).map_or(0.0, |side| m[k] / side))
    }

    /// `|nu|`.
    pub fn frequency_length(&self, index: usize, domain: &Domain) -> f64 {
        self.frequency(index, domain).iter().map(|nu| nu * nu).sum::<f64>().sqrt()
    }

    /// How many modes the stored mode stands for.
    pub fn multiplicity(&self, index: usize) -> u32 {
        match self {
            Self::Grid(grid) => grid.multiplicity(index),
            Self::List(list) => 1 + u32::from(list.mirrored),
        }
    }

    /// Where the DC mode `m = 0` is stored, if it is.
    pub fn dc(&self) -> Option<usize> {
        match self {
            Self::Grid(grid) => Some(grid.dc()),
            Self::List(list) => list.vectors.iter().position(|v| *v == [0.0; 3]),
        }
    }

    /// The grid, if it is one.
    pub fn grid(&self) -> Option<&WaveGrid> {
        match self {
            Self::Grid(grid) => Some(grid),
            Self::List(_) => None,
        }
    }
}

impl From<WaveGrid> for WaveVectors {
    fn from(grid: WaveGrid) -> Self {
        Self::Grid(grid)
    }
}

impl From<WaveList> for WaveVectors {
    fn from(list: WaveList) -> Self {
        Self::List(list)
    }
}

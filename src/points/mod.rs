//! 1. Points in: realizations of a pattern, checked once, kept as fixed-point fractions of the box.

mod domain;
mod ensemble;
mod fixed_point;
pub mod geometry;
pub mod polygon;
pub mod read;
mod shape;
mod unit_name;
pub mod write;

pub(crate) use domain::closest_packing_distance;
pub use domain::{Border, Boundary, Domain};
pub use ensemble::Ensemble;
pub(crate) use ensemble::counts_in_pairs;
pub(crate) use fixed_point::{mantissa_exponent, round32};
pub use shape::EnsembleShape;
pub use unit_name::UnitName;

/// Points as a reader or a sampler delivers them, before the domain is known.
#[derive(Debug, Clone, PartialEq)]
pub struct RawPoints {
    /// Number of coordinates per point.
    pub dim: usize,
    /// `n * dim` coordinates, point by point.
    pub coordinates: Vec<f64>,
    /// Where they come from, for error messages: `trees.csv`, or `batch.txt, realization 3`.
    pub source: String,
    /// The line of each point in its text file (1-based); empty for binary input.
    pub lines: Vec<u64>,
}

impl RawPoints {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.coordinates.len() / self.dim.max(1)
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// Where point `j` stands, for error messages: `trees.csv:17` or `batch.npy, realization 0, point 16`.
    pub fn place(&self, j: usize) -> String {
        match self.lines.get(j) {
            // The line says it all.
            Some(line) => format!("{}:{line}", self.source.split(", realization ").next().unwrap_or(&self.source)),
            None => format!("{}, point {j}", self.source),
        }
    }
}

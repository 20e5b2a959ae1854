//! The plan for the power spectrum.

use std::fmt;

use super::{Accuracy, Batch, EnsembleShape, Rings, WaveGrid};
use crate::error::{Error, Result, numbers};
use crate::points::Domain;

/// Everything decided about the power spectrum before any phase is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct WavePlan {
    /// The domain.
    pub domain: Domain,
    /// The integer frequency grid.
    pub grid: WaveGrid,
    /// Its rings.
    pub rings: Rings,
    /// The promise to keep.
    pub accuracy: Accuracy,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

impl WavePlan {
    /// Decides.
    pub fn new(domain: &Domain, grid: WaveGrid, accuracy: Accuracy, shape: EnsembleShape) -> Result<Self> {
        if grid.dim() != domain.dim() {
            let given = &grid.max_frequency()[..grid.dim()];
            let reason = format!("expected 1 or {} numbers for points with {} coordinates", domain.dim(), domain.dim());
            return Err(Error::setting("--max-frequency", numbers(given.iter().map(|&f| f64::from(f))), reason));
        }
        let rings = Rings::new(&grid, domain);
        let bytes = shape.max_points * 24 + grid.half_len() as u64 * 8;
        let batch = Batch::new(shape.realizations, bytes);
        Ok(Self { domain: domain.clone(), grid, rings, accuracy, shape, batch })
    }

    /// Floating-point operations of the matrix products: 8 per point, row and column.
    pub fn flop(&self) -> f64 {
        let rows = f64::from(self.grid.max_frequency()[0] + 1);
        8.0 * self.shape.realizations as f64 * self.shape.mean_points * rows * self.grid.columns().len() as f64
    }
}

impl fmt::Display for WavePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axes: Vec<_> = self.grid.max_frequency()[..self.grid.dim()].iter().map(u32::to_string).collect();
        let bound = self.accuracy.power_bound().max_any(self.shape.mean_points);
        writeln!(f, "wave_power: |m| <= {}, {} rings, {:.3e} flop", axes.join(", "), self.rings.count, self.flop())?;
        writeln!(
            f,
            "  separable direct sum, accuracy {}: |P - P_ref| <= {bound:.0e} (1 + P) whatever the points",
            self.accuracy.name()
        )?;
        writeln!(f, "  {}", self.batch)?;
        writeln!(f, "  skipped: {} modes that are mirror images", self.grid.full_len() - self.grid.half_len())
    }
}

//! 2. Decide everything, touch nothing: plans are values that can be printed, compared and tested without a device.

mod accuracy;
mod bin_filter;
mod pair_plan;
mod radial_bins;
mod wave_grid;
mod wave_plan;

pub use accuracy::{Accuracy, PowerBound};
pub use bin_filter::{BinFilter, BinTable, RELATIVE_GUARD};
pub use pair_plan::{Correction, PairPlan};
pub use radial_bins::{BinScale, MAX_BINS, RadialBins};
pub use wave_grid::{MAX_FREQUENCY, Rings, WaveGrid};
pub use wave_plan::WavePlan;

/// Number of points per realization, as far as a plan must know it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct EnsembleShape {
    /// Number of realizations.
    pub realizations: u64,
    /// Mean number of points per realization.
    pub mean_points: f64,
    /// Largest number of points in any realization (expected, where the sampler draws it).
    pub max_points: u64,
}

/// Bytes a batch of realizations may take on any path unless asked otherwise: 1 GiB.
pub const MEMORY_BUDGET: u64 = 1 << 30;

/// Realizations per batch: whole leaves of the ordered sum, as many as the budget allows, at least one leaf and at most
/// 4096 realizations, so that progress and cancellation stay lively.
fn batch_size(realizations: u64, bytes_per_realization: u64) -> u64 {
    let leaf = crate::accumulate::LEAF;
    let fitting = (MEMORY_BUDGET / bytes_per_realization.max(1)).min(4096) / leaf * leaf;
    fitting.max(leaf).min(realizations.div_ceil(leaf).max(1) * leaf)
}

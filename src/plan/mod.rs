//! 2. Decide everything, touch nothing: plans are values that can be printed, compared and tested without a device.

mod accuracy;
mod bandwidth;
mod bin_filter;
mod cell_grid;
mod convention;
mod costs;
mod count_plan;
mod covariance_plan;
mod discrepancy_plan;
mod importance;
mod integration_plan;
mod intensity_plan;
mod kernel_plan;
mod lag_plan;
mod neighbor_plan;
mod nufft_sizes;
mod pair_plan;
mod pair_search;
mod radial_bins;
mod ring_directions;
mod shell_measure;
mod smoothing;
mod taper;
mod tile;
mod wave_grid;
mod wave_method;
mod wave_plan;
mod wave_rings;
mod wave_sectors;
mod wave_vectors;

use crate::error::{Error, Result};
use crate::points::Domain;
pub use crate::points::EnsembleShape;
use crate::setting::Setting;
pub use accuracy::{Accuracy, GPU_WEIGHT_BOUND, PowerBound};
pub use bandwidth::{Bandwidth, BandwidthSearch};
pub use bin_filter::{BinFilter, BinTable, RELATIVE_GUARD};
pub use cell_grid::{CellAxis, CellGrid, StencilRow};
pub use convention::{AnisotropyRule, Convention, Conventions};
pub use costs::{CPU as CPU_COSTS, CostParts, Costs, DeviceCosts, MeasuredCosts};
pub use count_plan::{CountExtent, CountPlan, CountShape, CountSize};
pub use covariance_plan::CovariancePlan;
pub(crate) use covariance_plan::covariance_values;
pub use discrepancy_plan::DiscrepancyPlan;
pub use importance::Removal;
pub use integration_plan::{By, Estimator, Importance, IntegrationPlan, IntegrationSettings, PairSum, Spatial};
pub(crate) use integration_plan::{IntegrandTable, half_of_lags};
pub use intensity_plan::{IntensityBandwidth, IntensityPlan, IntensitySearch};
pub(crate) use intensity_plan::{KernelMass, kernel_sum, scott};
use kernel_plan::longest_distance;
pub use kernel_plan::{KernelMethod, KernelPlan};
pub(crate) use lag_plan::{DEFAULT_LAG_BINS, DEFAULT_LAG_RINGS};
pub use lag_plan::{LagFilter, LagGrid, LagPlan, LagReach, LagSector, MAX_LAG_BINS, MAX_LAG_CELLS};
pub use neighbor_plan::{NeighborPlan, ProbeLattice};
pub(crate) use nufft_sizes::kernel_lanes;
pub use nufft_sizes::{MAX_KERNEL_WIDTH, NufftCosts, NufftSizes};
pub(crate) use pair_plan::nearly_half_diagonal;
pub use pair_plan::{Correction, PairPlan, PairSettings};
pub use pair_search::{PairDevice, PairSearch, SearchCosts, SearchEstimate};
pub use radial_bins::{BinScale, MAX_BINS, RadialBins};
pub use ring_directions::RING_DIRECTIONS_RULE;
pub use smoothing::{Divisor, Smoothing, SmoothingKernel, sphere_surface};
pub use taper::{Debias, Taper, TaperPlan};
pub use tile::Tile;
pub use wave_grid::{MAX_FREQUENCY, WaveGrid};
pub use wave_method::{MethodEstimate, PANEL, ProductCosts, WaveCosts, WaveMethod};
pub use wave_plan::WavePlan;
pub use wave_rings::Rings;
pub use wave_sectors::{DEFAULT_SECTORS, MAX_SECTORS, Sectors};
pub use wave_vectors::{WaveList, WaveVectors};

/// What is not there for points in a polygon: tapers and set covariances of boxes are products along axes.
fn refuse_polygon(domain: &Domain, statistic: &str) -> Result<()> {
    if domain.as_polygon().is_none() {
        return Ok(());
    }
    let reason = "is not available for points in a polygon (`window_polygon`); expected pcf, k-function, neighbors, counts or intensity";
    Err(Error::setting(Setting::Stats, statistic, reason))
}

/// Realizations per leaf. Shards cut at multiples of this merge to the bytes of the whole run.
pub const LEAF: u64 = 16;

/// Bytes a batch of realizations may take on any path: 1 GiB. A batch is never less than one leaf of the ordered sum.
pub const MEMORY_BUDGET: u64 = 1 << 30;

/// How many realizations are worked on at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Batch {
    /// A multiple of `LEAF`, or all there are.
    pub realizations: u64,
    /// Bytes that each of them takes: points, the coordinates they were read from, and raw sums.
    pub bytes_each: u64,
}

impl Batch {
    /// Of what takes no memory.
    pub(crate) fn all(shape: EnsembleShape) -> Self {
        Self { realizations: shape.realizations.clamp(1, 4096), bytes_each: 0 }
    }

    /// Whole leaves of the ordered sum, as many as the budget allows, at least one leaf and at most 4096 realizations, so
    /// that progress and cancellation stay lively.
    fn new(shape: EnsembleShape, bytes: u64) -> Self {
        // Coordinates as a file has them, and as they are kept along three axes.
        let bytes_each = bytes + shape.max_points * 48;
        let (leaf, realizations) = (LEAF, shape.realizations);
        let fitting = (MEMORY_BUDGET / bytes_each.max(1)).min(4096) / leaf * leaf;
        let realizations = fitting.max(leaf).min(realizations.max(1));
        Self { realizations, bytes_each }
    }
}

impl std::fmt::Display for Batch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        let together = self.realizations * self.bytes_each;
        let (each, all, budget) = (mib(self.bytes_each), mib(together), mib(MEMORY_BUDGET));
        let kept = if together > MEMORY_BUDGET { "the least there is, above the" } else { "of the" };
        let n = self.realizations;
        write!(
            f,
            "batches of {n} realizations of {each:.3} MiB, {all:.3} MiB in all, {kept} {budget} MiB that a batch may take beside the memory of transforms"
        )
    }
}

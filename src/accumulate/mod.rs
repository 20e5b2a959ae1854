//! 4. Mergeable raw sums. No divisions here.

mod computed_by;
mod count_sums;
mod discrepancy_sums;
mod encode;
mod integration_sums;
mod intensity_scores;
mod intensity_sums;
mod kernel_sums;
mod lag_counts;
mod neighbor_sums;
mod ordered_sum;
mod pair_counts;
mod psa_counts;
mod sums;
mod wave_covariance;
mod wave_power;

pub use computed_by::{Backend, ComputedBy};
pub use count_sums::{CountSums, Places, RealizationCounts};
pub use discrepancy_sums::{DISCREPANCIES, DiscrepancySums, LevelCounts, RealizationDiscrepancy};
pub use encode::{Decoder, Encoder};
pub(crate) use integration_sums::add_lags;
pub use integration_sums::{IntegrandSums, IntegrationSums, KeptSums, LAG_STEP, RealizationSums, RemovalSums};
pub(crate) use intensity_scores::scores as intensity_scores;
pub use intensity_sums::{IntensityScores, IntensitySums, RealizationScores};
pub use kernel_sums::{KernelCurve, KernelMoments, KernelSums};
pub use lag_counts::LagCounts;
pub use neighbor_sums::{
    Bonds, COUNT_STEPS, CrossNeighborSums, Distances, DistributionCounts, DistributionSums, NeighborSums, NoBonds,
    RealizationNeighbors,
};
pub use ordered_sum::OrderedSum;
pub use pair_counts::{BorderHistogram, CrossCounts, Norm, PairCounts, PairHistogram, Ratios, Steps, WEIGHT_STEPS};
pub use psa_counts::PsaCounts;
pub use sums::Sums;
pub use wave_covariance::{CovarianceSums, WaveCovariance};
pub use wave_power::{PowerMoments, WavePower};

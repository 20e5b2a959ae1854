//! The one dial for accuracy: a promise in words and numbers, read by the plan, the tests and the README's table.

use crate::named::named;

/// How accurate the power spectrum is asked to be. Pair counts are exact at either setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Accuracy {
    /// f32 tables of exact phases, short f32 panels flushed into wider sums.
    #[default]
    Fast,
    /// f64 throughout.
    High,
}

named!(Accuracy: Fast = "fast", High = "high");

/// What an accuracy level promises about `P(m)` against the reference, for points given as 64-bit fractions and any
/// `|m|` up to `MAX_FREQUENCY` (tested to 65,536).
/// The fraction of a coordinate is off by at most 2^-65, which the reference, taking phases from coordinates, does not share:
/// |m| 2^-65 of a turn on top of that, far below the promise at such |m| (docs/limits.md).
///
/// Errors of scattered points cancel; points that repeat coordinates err alike, and their errors add up like the points
/// themselves: P is then off by a share of `1 + P` that grows as the square root of n.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PowerBound {
    /// `max |P - P_ref| / (1 + P_ref)` over all modes for uniform points, n up to 1e6.
    pub max_uniform: f64,
    /// Root mean square of `P - P_ref` for uniform points, n up to 1e6.
    pub rms_uniform: f64,
    /// The same maximum for any points whatever, divided by `sqrt(n)`; never below `max_uniform`.
    pub max_any_per_root_n: f64,
    /// Largest `P` where a rank-1 lattice has `P = 0`, n up to 65,536; in proportion to n beyond.
    pub lattice_zero: f64,
    /// Median of `|P - P_ref| / P_ref` for a lattice of 256 x 256 points, jittered by 1e-3 of a cell, where P goes down to
    /// 1e-11.
    pub jittered_median: f64,
    /// Largest error of a cosine or sine in a table of phases, any `|m|` up to 65,536.
    pub table_entry: f64,
}

/// Largest relative error of a sum of edge weights on the GPU, where weights are f32 and added without rounding: each weight
/// keeps this bound, so does every sum. Counts beside them, and minus sampling, are exact. The CPU path equals the reference.
pub const GPU_WEIGHT_BOUND: f64 = 2e-6;

impl PowerBound {
    /// `max |P - P_ref| / (1 + P_ref)` for any n points.
    pub fn max_any(&self, n: f64) -> f64 {
        self.max_uniform.max(self.max_any_per_root_n * n.sqrt())
    }

    /// What a P of 0 may come out as, for n points.
    pub fn zero(&self, n: f64) -> f64 {
        self.lattice_zero * (n / 65_536.0).max(1.0)
    }
}

impl Accuracy {
    /// The promise about `P`.
    pub const fn power_bound(self) -> PowerBound {
        match self {
            Self::Fast => PowerBound {
                max_uniform: 1e-5,
                rms_uniform: 6e-7,
                max_any_per_root_n: 2e-6,
                lattice_zero: 1e-10,
                jittered_median: 3e-4,
                table_entry: 2e-7,
            },
            Self::High => PowerBound {
                max_uniform: 1e-11,
                rms_uniform: 1e-12,
                max_any_per_root_n: 1e-14,
                lattice_zero: 1e-24,
                jittered_median: 1e-9,
                table_entry: 1e-15,
            },
        }
    }

    /// The tolerance of a nonuniform fast Fourier transform that keeps it.
    pub const fn nufft_tolerance(self) -> f64 {
        match self {
            Self::Fast => 1e-9,
            Self::High => 4e-15,
        }
    }

    /// Spread among values of P that is rounding and no more, relative to P.
    pub const fn relative_noise(self) -> f64 {
        match self {
            Self::Fast => 1e-5,
            Self::High => 1e-12,
        }
    }
}

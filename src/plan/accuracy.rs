//! The one dial for accuracy: a promise in words and numbers, read by the plan, the tests and the README's table.

/// How accurate the power spectrum is asked to be. Pair counts are exact at either setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Accuracy {
    /// f32 tables of exact phases, short f32 panels flushed into wider sums.
    #[default]
    Fast,
    /// f64 throughout.
    High,
}

/// What an accuracy level promises about `P(m)` against the reference, for points given as 64-bit fractions.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PowerBound {
    /// `max |P - P_ref| / (1 + P_ref)` over all modes, `|m|` up to 65,536.
    pub max_relative_to_one_plus_p: f64,
    /// Root mean square of `P - P_ref` for uniform points, n up to 65,536.
    pub rms_uniform: f64,
    /// Largest `P` where a rank-1 lattice has `P = 0`.
    pub lattice_zero: f64,
}

impl Accuracy {
    /// The promise about `P`.
    pub const fn power_bound(self) -> PowerBound {
        match self {
            Self::Fast => PowerBound { max_relative_to_one_plus_p: 2e-5, rms_uniform: 1e-6, lattice_zero: 1e-10 },
            Self::High => PowerBound { max_relative_to_one_plus_p: 1e-11, rms_uniform: 1e-12, lattice_zero: 1e-22 },
        }
    }

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::High => "high",
        }
    }
}

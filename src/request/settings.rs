//! What the settings of a request are on the command line.

use crate::setting::Setting;

impl Setting {
    /// Its flag as a user types it, `--r-max`.
    pub fn flag(self) -> &'static str {
        match self {
            Self::Files => "FILES",
            Self::Sampler => "--sampler",
            Self::Points => "-n",
            Self::Realizations => "-k",
            Self::Dim => "--dim",
            Self::Seed => "--seed",
            Self::Params => "--param",
            Self::Raw => "--raw",
            Self::WeightColumn => "--weight-column",
            Self::ClassColumn => "--class-column",
            Self::Domain => "--domain",
            Self::Sides => "--box",
            Self::Window => "--window",
            Self::Wrap => "--wrap",
            Self::Stats => "--stats",
            Self::RMax => "--r-max",
            Self::Bins => "--bins",
            Self::BinScale => "--bin-scale",
            Self::Edges => "--edges",
            Self::Kernel => "--kernel",
            Self::Bandwidth => "--bandwidth",
            Self::Divisor => "--divisor",
            Self::ExactKernel => "--exact-kernel",
            Self::Correction => "--correction",
            Self::BeyondHalf => "--beyond-half",
            Self::Classes => "--classes",
            Self::LagBins => "--lag-bins",
            Self::LagMax => "--lag-max",
            Self::LagRings => "--lag-rings",
            Self::Envelope => "--envelope",
            Self::Normalization => "--normalization",
            Self::MaxFrequency => "--max-frequency",
            Self::Frequencies => "--frequencies",
            Self::RingDirections => "--ring-directions",
            Self::Sectors => "--sectors",
            Self::CovarianceFrequency => "--covariance-frequency",
            Self::Taper => "--taper",
            Self::Tapers => "--tapers",
            Self::Debias => "--debias",
            Self::Convention => "--convention",
            Self::BugCompatible => "--bug-compatible",
            Self::Device => "--device",
            Self::Accuracy => "--accuracy",
            Self::Threads => "--threads",
            Self::Out => "--out",
            Self::Force => "--force",
            Self::Tolerance => "--tolerance",
        }
    }
}

//! 5. Raw sums -> physical numbers with errors and units. Pure functions; all divisions are here.

mod analysis;
mod angular_spectrum;
mod axis_slices;
mod blue_noise;
mod clusters;
mod confidence;
mod convergence;
mod counts;
mod cross_correlation;
mod cross_validation;
mod diaphony;
mod discrepancy;
mod envelope;
mod hotelling;
mod inhomogeneous;
mod integration;
mod intensity;
mod k_function;
mod lag_consistency;
mod line;
mod low_frequency;
mod neighbors;
mod pair_correlation;
mod pair_errors;
mod pair_kernel;
mod power_spectrum;
mod prediction;
mod psa_statistics;
mod radial_spectrum;
mod ratio;
mod spectrum_details;
mod spectrum_of_pcf;
mod spectrum_scalars;
mod vector_correlation;
mod wave_covariance;
mod window_edges;

pub use analysis::{Analysis, ClosedForm, Finding, Findings};
pub use angular_spectrum::{AngularSpectrum, SectorPower};
pub use axis_slices::{AxisMode, AxisSlices};
pub use blue_noise::BlueNoise;
pub use confidence::{Band, BandLaw, CONFIDENCE, MANY_ORDINATES, MANY_REALIZATIONS};
pub use convergence::{PowerLaw, VarianceAt, expected_slope, isotropic_exponent, local_slopes};
pub use counts::{CountDispersion, Counts};
pub use cross_correlation::{CrossCorrelation, CrossK};
pub use cross_validation::CrossValidation;
pub use diaphony::Diaphony;
pub use discrepancy::{Discrepancies, Discrepancy, Length, NetQuality};
pub use envelope::{Curve, Envelope, Envelopes};
pub use hotelling::Hotelling;
pub use inhomogeneous::Inhomogeneity;
pub use integration::{
    IntegrationError, IntegrationErrors, LagShare, Measured, ModeMap, ModeShare, Placed, RemovalError, RingShare,
};
pub use intensity::{Intensity, IntensityChoice};
pub use k_function::KFunction;
pub use lag_consistency::LagConsistency;
pub use low_frequency::LowFrequency;
pub use neighbors::{BondOrder, ClarkEvans, CrossNeighbors, NeighborDistances, NeighborFunctions, Neighbors};
pub use pair_correlation::{Normalization, PairCorrelation};
pub(crate) use pair_errors::PairErrors;
pub use pair_kernel::KernelEstimate;
pub use power_spectrum::PowerSpectrum;
pub use prediction::Prediction;
pub use psa_statistics::PsaStatistics;
pub use radial_spectrum::{RadialSpectrum, Ring};
pub use spectrum_details::SpectrumDetails;
pub use spectrum_of_pcf::SpectrumOfPcf;
pub use spectrum_scalars::{HighFrequency, SpectrumScalars};
pub use vector_correlation::{SectorCorrelation, VectorCorrelation};
pub use wave_covariance::{AmplitudeCovariance, CovarianceScalars};

/// Where an error bar comes from. Every output says which.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorSource {
    /// Standard error of the mean across K >= 2 realizations.
    AcrossRealizations,
    /// Theory, for a single realization: Poisson pair counts; exponential periodogram ordinates.
    Theory,
    /// Theory, for a single realization that is not clustered: Poisson pair counts, times what the spectrum that goes with
    /// them makes of their variance.
    SpectralTheory,
    /// Theory, for a single realization of clusters: that of the Thomas process that goes with what was measured.
    ClusterTheory,
}

impl ErrorSource {
    fn of(realizations: u64) -> Self {
        if realizations >= 2 { Self::AcrossRealizations } else { Self::Theory }
    }
}

/// Standard error of the ratio estimate `sum c / sum N` over `k` realizations, from the sum of squared residuals
/// `sum (c - g N)^2`: `sqrt(k / (k - 1) residuals) / sum N` (Cochran, Sampling Techniques, 1977, section 6.4). With equal
/// N it is the standard error of the mean of `c / N`. Rounding may leave residuals a hair below 0.
fn ratio_standard_error(k: u64, residuals: f64, sum_norm: f64) -> f64 {
    let k = k as f64;
    (k / (k - 1.0) * residuals.max(0.0)).sqrt() / sum_norm
}

/// The mean; `None` of no values.
pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Of the mean, from the spread of the values; `None` for fewer than two.
pub(crate) fn standard_error(values: &[f64]) -> Option<f64> {
    let mean = mean(values).filter(|_| values.len() >= 2)?;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    let k = values.len() as f64;
    Some((squares / (k * (k - 1.0))).sqrt())
}

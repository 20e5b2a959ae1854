//! All that is read off a power spectrum besides its rings.

use super::Analysis;
use super::{
    AngularSpectrum, AxisSlices, LagConsistency, PairCorrelation, PowerSpectrum, RadialSpectrum, SpectrumOfPcf,
    SpectrumScalars, VectorCorrelation,
};
use crate::accumulate::WavePower;
use crate::plan::WavePlan;

/// Slices, sectors, scalars, and what g says of P.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumDetails {
    /// P along each axis.
    pub axes: AxisSlices,
    /// P by direction; 2D.
    pub angular: Option<AngularSpectrum>,
    /// Numbers that sum it up.
    pub scalars: SpectrumScalars,
    /// Each of g(r) and P(nu) from the other; torus.
    pub of_pcf: Option<SpectrumOfPcf>,
    /// Lag counts against P(m); torus.
    pub lags: Option<LagConsistency>,
}

impl SpectrumDetails {
    /// The estimates. `vector` is left out where it takes points otherwise than the spectrum does, as with weights.
    pub fn new(
        plan: &WavePlan,
        power: &WavePower,
        spectrum: &PowerSpectrum,
        radial: &RadialSpectrum,
        pcf: Option<&PairCorrelation>,
        vector: Option<&VectorCorrelation>,
    ) -> Self {
        Self {
            axes: AxisSlices::new(plan, spectrum),
            angular: AngularSpectrum::new(plan, power, radial),
            scalars: SpectrumScalars::new(plan, power, spectrum, radial),
            of_pcf: pcf.and_then(|g| SpectrumOfPcf::new(&plan.domain, g, spectrum, radial)),
            lags: vector
                .filter(|_| plan.needed().is_none())
                .and_then(|v| LagConsistency::new(&plan.domain, plan.shape, v, spectrum)),
        }
    }
}

impl Analysis {
    /// What else is read off P.
    pub fn details(&self) -> Option<&SpectrumDetails> {
        self.get()
    }
}

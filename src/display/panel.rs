//! What a viewer shows, panel by panel.

use crate::estimate::Analysis;
use crate::request::Statistic;

/// One picture of an analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Panel {
    /// The points of a realization.
    Points,
    /// g(r).
    Pcf,
    /// Radial mean of P.
    Radial,
    /// Anisotropy of P.
    Anisotropy,
    /// P on the grid.
    Spectrum,
    /// g of the vector.
    Vector,
    /// Errors of integrals.
    Integration,
}

impl Panel {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Points, Self::Pcf, Self::Radial, Self::Anisotropy, Self::Spectrum, Self::Vector, Self::Integration];

    /// Its title.
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::Pcf => "g(r)",
            Self::Radial => "P(ν)",
            Self::Anisotropy => "anisotropy",
            Self::Spectrum => "P(m)",
            Self::Vector => "g(h)",
            Self::Integration => "integration",
        }
    }

    /// The stem of its files.
    pub fn slug(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::Pcf => "pcf",
            Self::Radial => "spectrum_radial",
            Self::Anisotropy => "anisotropy",
            Self::Spectrum => "spectrum",
            Self::Vector => "pcf_vector",
            Self::Integration => "variance",
        }
    }

    /// What is shown: formula and unit.
    pub fn definition(self) -> &'static str {
        match self {
            Self::Points => "The points of one realization, in length units of the domain.",
            Self::Pcf => {
                "Pair correlation function g(r) = |D| Σ c / (v Σ n(n-1)): ordered pairs whose distance is in the bin, over those \
                 expected of complete randomness in its shell v. Dimensionless; 1 where pairs are uncorrelated."
            }
            Self::Radial => {
                "Radial mean of the power spectrum P(m) = Σ |s_m|² / Σ n over rings of constant frequency ν, DC left out. \
                 Dimensionless, over cycles per unit length; 1 for complete randomness."
            }
            Self::Anisotropy => {
                "10 log10(s² / mean²) over the independent modes of a ring of P, in dB. An isotropic spectrum averaged over K \
                 realizations scatters about -10 log10 K."
            }
            Self::Spectrum => {
                "Power spectrum P(m) = Σ |s_m|² / Σ n, s_m = Σ_j exp(-2πi m·x_j / L), on the grid of frequencies ν = m / L in \
                 cycles per unit length. Dimensionless; 1 for complete randomness; DC in the centre is grey."
            }
            Self::Vector => {
                "Pair correlation function of the vector h between two points, g(h) = |D|² Σ c / (V Σ n(n-1)), in length units of \
                 the domain. Dimensionless; the middle of the colours is g = 1."
            }
            Self::Integration => {
                "Variance of the estimate of each integral over v₀/n, that of n random points, v₀ = ∫f² - I²: predicted from P and from \
                 pairs, observed over random shifts and as points are, with two standard errors."
            }
        }
    }

    /// What a request must ask for so that there is something to draw; integration needs no statistic, but an integrand.
    pub fn statistics(self) -> &'static [Statistic] {
        match self {
            Self::Points | Self::Integration => &[],
            Self::Pcf => &[Statistic::Pcf],
            Self::Radial | Self::Anisotropy => &[Statistic::Radial],
            Self::Spectrum => &[Statistic::Spectrum],
            Self::Vector => &[Statistic::PcfVector],
        }
    }

    /// Whether there could be something to draw of such points and settings, once it is measured.
    pub fn applies(self, analysis: &Analysis) -> bool {
        let plane = analysis.domain.dim() >= 2;
        // A list of wave vectors has neither rings nor a grid, the frequencies of rings alone have no grid.
        let gridless = analysis.spectrum().is_some_and(|spectrum| spectrum.waves.grid().is_none());
        self.has(analysis)
            || match self {
                Self::Points | Self::Pcf => true,
                Self::Integration => false,
                Self::Radial => !gridless,
                Self::Anisotropy | Self::Spectrum => plane && !gridless,
                Self::Vector => plane,
            }
    }

    /// Whether there is something to draw.
    pub fn has(self, analysis: &Analysis) -> bool {
        let rings = || analysis.radial().is_some_and(|radial| !radial.rings.is_empty());
        let plane = analysis.domain.dim() >= 2;
        match self {
            Self::Points => true,
            Self::Pcf => analysis.pair_correlation().is_some_and(|pcf| !pcf.r.is_empty()),
            Self::Radial => rings(),
            Self::Anisotropy => rings() && plane,
            Self::Spectrum => analysis.grid_of_power().is_some() && plane,
            Self::Vector => analysis.vector().is_some() && plane,
            Self::Integration => analysis.integration().is_some(),
        }
    }
}

//! What a viewer shows, panel by panel, and what can be taken away from each: the very files of a report.

use std::io;

use super::picture_figure;
use super::plots::{self, Svg};
use super::spectrum_image::{self, SpectrumImage};
use super::table::{self, Table};
use super::vector_image::{self, VectorImage};
use super::{npy, points_picture};
use crate::analysis::Analysis;
use crate::error::{Error, Result};
use crate::points::{RawPoints, write};
use crate::request::Statistic;

/// One picture of an analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Panel {
    /// The points of the first realization.
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
}

/// Which files of a panel an analysis has the data for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Offers {
    /// `Panel::svg`.
    pub svg: bool,
    /// `Panel::png`.
    pub png: bool,
    /// `Panel::csv`.
    pub csv: bool,
    /// `Panel::npy`.
    pub npy: bool,
}

/// Writes an array into a file.
pub(super) type WriteArray<'a> = Box<dyn FnOnce(&mut dyn io::Write) -> io::Result<()> + 'a>;

impl Panel {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Points, Self::Pcf, Self::Radial, Self::Anisotropy, Self::Spectrum, Self::Vector];

    /// Its title.
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::Pcf => "g(r)",
            Self::Radial => "P(ν)",
            Self::Anisotropy => "anisotropy",
            Self::Spectrum => "P(m)",
            Self::Vector => "g(h)",
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
        }
    }

    /// What is shown: formula and unit.
    pub fn definition(self) -> &'static str {
        match self {
            Self::Points => "The points of the first realization, in length units of the domain.",
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
        }
    }

    /// What a request must ask for so that there is something to draw.
    pub fn statistics(self) -> &'static [Statistic] {
        match self {
            Self::Points => &[],
            Self::Pcf => &[Statistic::Pcf],
            Self::Radial | Self::Anisotropy => &[Statistic::Radial],
            Self::Spectrum => &[Statistic::Spectrum],
            Self::Vector => &[Statistic::PcfVector],
        }
    }

    /// What there is, without making it.
    pub fn offers(self, analysis: &Analysis) -> Offers {
        let spectrum = analysis.spectrum().filter(|_| analysis.grid_wanted);
        let rings = analysis.radial().is_some_and(|radial| !radial.rings.is_empty());
        let plane = analysis.domain.dim() >= 2;
        let png = match self {
            Self::Spectrum => spectrum.is_some_and(|s| s.waves.grid().is_some()) && plane,
            Self::Vector => analysis.vector().is_some() && plane,
            _ => false,
        };
        let svg = match self {
            Self::Points => true,
            Self::Pcf => analysis.pair_correlation().is_some_and(|pcf| !pcf.r.is_empty()),
            Self::Radial => rings,
            Self::Anisotropy => rings && plane,
            Self::Spectrum | Self::Vector => png,
        };
        let csv = match self {
            Self::Points => analysis.first.realizations() > 0 && analysis.first.points_in(0) > 0,
            Self::Pcf => analysis.pair_correlation().is_some(),
            Self::Radial | Self::Anisotropy => analysis.radial().is_some(),
            Self::Spectrum => spectrum.is_some_and(|s| s.waves.grid().is_none()),
            Self::Vector => false,
        };
        Offers { svg, png, csv, npy: self.array(analysis).is_some() }
    }

    /// The picture as SVG: for curves and points the bytes of the report's file, for the others that file with axes and a colour
    /// bar. `None` where there is nothing to draw.
    pub fn svg(self, analysis: &Analysis) -> Result<Option<String>> {
        let svg = match self {
            Self::Spectrum => picture_figure::spectrum(analysis),
            Self::Vector => picture_figure::vector(analysis),
            _ => self.curves(analysis),
        };
        svg.transpose().map_err(|e| Error::file(format!("{}.svg", self.slug()), io::Error::other(e)))
    }

    /// The picture as PNG, the bytes of the report's file. `None` where there is none: curves and points are drawn as SVG.
    pub fn png(self, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
        let png = match self {
            Self::Spectrum => spectrum_image(analysis).map(|image| image.map(|image| image.png)),
            Self::Vector => vector_image(analysis).map(|image| image.map(|image| image.png)),
            _ => Ok(None),
        };
        png.map_err(|e| Error::file(format!("{}.png", self.slug()), e))
    }

    /// The numbers as CSV: the bytes of the report's file (of anisotropy, `spectrum_radial.csv`), and for points the coordinates
    /// of the first realization. `None` where there are none, or arrays only.
    pub fn csv(self, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
        if self == Self::Points {
            return first_points(analysis).map(|points| write::csv(&points)).transpose();
        }
        let csv = self.table(analysis).map(|table| table.csv()).transpose();
        csv.map_err(|e| Error::file(format!("{}.csv", self.slug()), e))
    }

    /// The numbers as NPY: the bytes of the report's file. `None` where there are none, or a table only.
    pub fn npy(self, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
        let Some(write) = self.array(analysis) else { return Ok(None) };
        let mut bytes = Vec::new();
        write(&mut bytes).map_err(|e| Error::file(format!("{}.npy", self.slug()), e))?;
        Ok(Some(bytes))
    }

    /// What is drawn in lines and dots.
    pub(super) fn curves(self, analysis: &Analysis) -> Option<Svg> {
        match self {
            Self::Points => Some(points_picture::svg(analysis)),
            Self::Pcf => plots::pcf(analysis),
            Self::Radial => plots::spectrum_radial(analysis),
            Self::Anisotropy => plots::anisotropy(analysis),
            Self::Spectrum | Self::Vector => None,
        }
    }

    pub(super) fn table(self, analysis: &Analysis) -> Option<Table> {
        match self {
            Self::Pcf => table::pcf(analysis),
            Self::Radial | Self::Anisotropy => table::radial(analysis),
            Self::Spectrum => table::spectrum_list(analysis),
            Self::Points | Self::Vector => None,
        }
    }

    pub(super) fn array(self, analysis: &Analysis) -> Option<WriteArray<'_>> {
        match self {
            Self::Spectrum => {
                let spectrum = analysis.spectrum().filter(|_| analysis.grid_wanted)?;
                let grid = spectrum.waves.grid()?;
                let lacks_last = analysis.convention.lacks_last_plane();
                Some(Box::new(move |file| npy::grid(grid, &spectrum.p, lacks_last, file)))
            }
            Self::Vector => {
                let vector = analysis.vector()?;
                Some(Box::new(|file| npy::lags(&vector.grid, &vector.g, file)))
            }
            _ => None,
        }
    }
}

/// `spectrum.png`.
pub(super) fn spectrum_image(analysis: &Analysis) -> io::Result<Option<SpectrumImage>> {
    match analysis.spectrum().filter(|_| analysis.grid_wanted) {
        Some(spectrum) => {
            spectrum_image::render(spectrum, &analysis.domain, analysis.shape.mean_points).map_err(io::Error::other)
        }
        None => Ok(None),
    }
}

/// `pcf_vector.png`.
pub(super) fn vector_image(analysis: &Analysis) -> io::Result<Option<VectorImage>> {
    match analysis.vector() {
        Some(vector) => vector_image::render(vector).map_err(io::Error::other),
        None => Ok(None),
    }
}

/// The first realization, if it has points.
fn first_points(analysis: &Analysis) -> Option<RawPoints> {
    let first = &analysis.first;
    let n = (first.realizations() > 0).then(|| first.points_in(0)).filter(|&n| n > 0)?;
    Some(RawPoints {
        dim: analysis.domain.dim(),
        coordinates: (0..n).flat_map(|j| first.position(0, j)).collect(),
        source: "points.csv".into(),
        lines: Vec::new(),
    })
}

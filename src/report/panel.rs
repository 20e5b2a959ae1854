//! What can be taken away from a panel of the viewer: the very files of a report.

use std::io;

use super::picture_figure;
use super::plots::{self, Svg};
use super::spectrum_image::{self, SpectrumImage};
use super::table::{self, Table};
use super::vector_image::{self, VectorImage};
use super::{npy, points_picture};
use crate::display::Panel;
use crate::error::{Error, Result};
use crate::estimate::Analysis;
use crate::points::{RawPoints, write};

/// Which files of a panel an analysis has the data for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Offers {
    /// `svg`.
    pub svg: bool,
    /// `png`.
    pub png: bool,
    /// `csv`.
    pub csv: bool,
    /// `npy`.
    pub npy: bool,
}

/// Writes an array into a file.
pub(super) type WriteArray<'a> = Box<dyn FnOnce(&mut dyn io::Write) -> io::Result<()> + 'a>;

/// What there is, without making it.
pub fn offers(panel: Panel, analysis: &Analysis) -> Offers {
    let csv = match panel {
        Panel::Points => analysis.first.realizations() > 0 && analysis.first.points_in(0) > 0,
        Panel::Pcf => analysis.pair_correlation().is_some(),
        Panel::Radial | Panel::Anisotropy => analysis.radial().is_some(),
        Panel::Spectrum => analysis.listed_power().is_some(),
        Panel::Vector => false,
    };
    let svg = panel.has(analysis);
    let png = svg && matches!(panel, Panel::Spectrum | Panel::Vector);
    Offers { svg, png, csv, npy: array(panel, analysis).is_some() }
}

/// The picture as SVG: for curves and points the bytes of the report's file, for the others that file with axes and a colour
/// bar. `None` where there is nothing to draw.
pub fn svg(panel: Panel, analysis: &Analysis) -> Result<Option<String>> {
    let svg = match panel {
        Panel::Spectrum => picture_figure::spectrum(analysis),
        Panel::Vector => picture_figure::vector(analysis),
        _ => curves(panel, analysis),
    };
    svg.transpose().map_err(|e| Error::file(format!("{}.svg", panel.slug()), io::Error::other(e)))
}

/// The picture as PNG, the bytes of the report's file. `None` where there is none: curves and points are drawn as SVG.
pub fn png(panel: Panel, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
    let png = match panel {
        Panel::Spectrum => spectrum_image(analysis).map(|image| image.map(|image| image.png)),
        Panel::Vector => vector_image(analysis).map(|image| image.map(|image| image.png)),
        _ => Ok(None),
    };
    png.map_err(|e| Error::file(format!("{}.png", panel.slug()), e))
}

/// The numbers as CSV: the bytes of the report's file (of anisotropy, `spectrum_radial.csv`), and for points the coordinates
/// of the first realization. `None` where there are none, or arrays only.
pub fn csv(panel: Panel, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
    if panel == Panel::Points {
        return first_points(analysis).map(|points| write::csv(&points)).transpose();
    }
    let csv = table(panel, analysis).map(|table| table.csv()).transpose();
    csv.map_err(|e| Error::file(format!("{}.csv", panel.slug()), e))
}

/// The numbers as NPY: the bytes of the report's file. `None` where there are none, or a table only.
pub fn npy(panel: Panel, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
    let Some(write) = array(panel, analysis) else { return Ok(None) };
    let mut bytes = Vec::new();
    write(&mut bytes).map_err(|e| Error::file(format!("{}.npy", panel.slug()), e))?;
    Ok(Some(bytes))
}

/// What is drawn in lines and dots.
pub(super) fn curves(panel: Panel, analysis: &Analysis) -> Option<Svg> {
    match panel {
        Panel::Points => Some(points_picture::svg(analysis)),
        Panel::Pcf => plots::pcf(analysis),
        Panel::Radial => plots::spectrum_radial(analysis),
        Panel::Anisotropy => plots::anisotropy(analysis),
        Panel::Spectrum | Panel::Vector => None,
    }
}

pub(super) fn table(panel: Panel, analysis: &Analysis) -> Option<Table> {
    match panel {
        Panel::Pcf => table::pcf(analysis),
        Panel::Radial | Panel::Anisotropy => table::radial(analysis),
        Panel::Spectrum => table::spectrum_list(analysis),
        Panel::Points | Panel::Vector => None,
    }
}

pub(super) fn array(panel: Panel, analysis: &Analysis) -> Option<WriteArray<'_>> {
    match panel {
        Panel::Spectrum => {
            let (spectrum, grid) = analysis.grid_of_power()?;
            let lacks_last = analysis.convention.lacks_last_plane();
            Some(Box::new(move |file| npy::grid(grid, &spectrum.p, lacks_last, file)))
        }
        Panel::Vector => {
            let vector = analysis.vector()?;
            Some(Box::new(|file| npy::lags(&vector.grid, &vector.g, file)))
        }
        _ => None,
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

//! What can be taken away from a panel of the viewer: the very files of a report.

use std::io;

use super::{html, outputs, picture_figure};
use crate::display::{Panel, untagged};
use crate::error::{Error, Result};
use crate::estimate::Analysis;
use crate::points::{Ensemble, RawPoints, write};

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

/// What there is, without making it.
pub fn offers(panel: Panel, analysis: &Analysis) -> Offers {
    let csv = match panel {
        Panel::Points => analysis.first.realizations() > 0 && analysis.first.points_in(0) > 0,
        Panel::Pcf => analysis.pair_correlation().is_some(),
        Panel::Radial | Panel::Anisotropy => analysis.radial().is_some(),
        Panel::Spectrum => analysis.listed_power().is_some(),
        Panel::Vector => false,
        Panel::Integration => analysis.integration().is_some(),
    };
    let svg = panel.has(analysis);
    let png = svg && matches!(panel, Panel::Spectrum | Panel::Vector);
    let npy = match panel {
        Panel::Spectrum => analysis.grid_of_power().is_some(),
        Panel::Vector => analysis.vector().is_some(),
        _ => false,
    };
    Offers { svg, png, csv, npy }
}

/// The picture as SVG: for curves and points the bytes of the report's file, for the others that file with axes and a colour
/// bar. `None` where there is nothing to draw.
///
/// # Errors
/// What cannot be drawn or encoded, by the name of the file.
pub fn svg(panel: Panel, analysis: &Analysis) -> Result<Option<String>> {
    let name = format!("{}.svg", panel.slug());
    let framed = match panel {
        Panel::Spectrum => picture_figure::spectrum(analysis),
        Panel::Vector => picture_figure::vector(analysis),
        _ => {
            let bytes = outputs::bytes(&name, analysis)?;
            let text = bytes.map(String::from_utf8).transpose();
            return text.map_err(|e| Error::file(name, io::Error::other(e)));
        }
    };
    framed.transpose().map_err(|e| Error::file(name, io::Error::other(e)))
}

/// The picture as PNG, the bytes of the report's file. `None` where there is none: curves and points are drawn as SVG.
///
/// # Errors
/// What cannot be drawn or encoded, by the name of the file.
pub fn png(panel: Panel, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
    outputs::bytes(&format!("{}.png", panel.slug()), analysis)
}

/// The numbers as CSV: the bytes of the report's file (of anisotropy, `spectrum_radial.csv`), and for points the coordinates
/// of the first realization. `None` where there are none, or arrays only.
///
/// # Errors
/// What cannot be drawn or encoded, by the name of the file.
pub fn csv(panel: Panel, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
    let name = match panel {
        Panel::Pcf => "pcf.csv",
        Panel::Radial | Panel::Anisotropy => "spectrum_radial.csv",
        Panel::Spectrum => "spectrum_list.csv",
        Panel::Points => return points_csv(&analysis.first),
        Panel::Integration => "variance.csv",
        Panel::Vector => return Ok(None),
    };
    outputs::bytes(name, analysis)
}

/// The numbers as NPY: the bytes of the report's file. `None` where there are none, or a table only.
///
/// # Errors
/// What cannot be drawn or encoded, by the name of the file.
pub fn npy(panel: Panel, analysis: &Analysis) -> Result<Option<Vec<u8>>> {
    outputs::bytes(&format!("{}.npy", panel.slug()), analysis)
}

/// What the page shows at a glance, as plain text: numbers of points, distances of neighbours, scalars of P.
pub fn scalars(analysis: &Analysis) -> Vec<(String, String)> {
    html::glance(analysis).into_iter().map(|(name, value)| (untagged(&name), untagged(&value))).collect()
}

/// The coordinates of the first of some realizations as CSV. `None` where it has no points.
///
/// # Errors
/// What cannot be encoded.
pub fn points_csv(points: &Ensemble) -> Result<Option<Vec<u8>>> {
    let n = (points.realizations() > 0).then(|| points.points_in(0)).filter(|&n| n > 0);
    let raw = n.map(|n| RawPoints {
        dim: points.domain().dim(),
        coordinates: (0..n).flat_map(|j| points.position(0, j)).collect(),
        source: "points.csv".into(),
        lines: Vec::new(),
    });
    raw.map(|raw| write::csv(&raw)).transpose()
}

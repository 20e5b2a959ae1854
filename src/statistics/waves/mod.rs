//! P: on the grid, over rings, at a list, along axes, by direction; its scalars; and whether it agrees with g.

mod figures;
mod image;
mod power;
mod scalars;
mod summary;
mod tables;

pub(crate) use image::{image as spectrum_image, tone_text};

use super::group::{Ask, Parts};
use super::{Array, Keys, Output, Room, Row, Values, across};
use crate::display::{human, with_error};
use crate::error::{Result, plural};
use crate::estimate::{Analysis, ErrorSource};
use crate::plan::WaveGrid;

pub(crate) use power::Waves;

/// P in a report.
pub(crate) struct Here;

const HEADING: &str = "Power spectrum";

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        power::plan(ask, parts)
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::table("spectrum_radial.csv", tables::radial)
                    .shown("radial mean of the power spectrum", &["nu", "p", "p_se", "p_lo", "p_hi", "anisotropy_db"]),
                Output::table("spectrum_list.csv", tables::spectrum_list)
                    .shown("power spectrum at listed wave vectors", &["nu_", "p", "p_se", "p_lo", "p_hi"]),
                Output::table("spectrum_axes.csv", tables::axes),
                Output::table("spectrum_angular.csv", tables::sectors),
                Output::table("spectrum_from_pcf.csv", tables::spectrum_from_pcf),
                Output::table("pcf_from_spectrum.csv", tables::pcf_from_spectrum),
                Output::array("spectrum.npy", p),
                Output::array("spectrum_se.npy", p_se),
                Output::figure("spectrum_radial.svg", figures::radial, HEADING, figures::radial_caption),
                Output::figure("anisotropy.svg", figures::anisotropy, HEADING, figures::anisotropy_caption),
                Output::figure("spectrum_axes.svg", figures::along_axes, HEADING, figures::axes_caption),
                Output::figure("spectrum_angular.svg", figures::angular, HEADING, figures::angular_caption),
                Output::image("spectrum.png", image::image, HEADING, image::caption),
                Output::image("spectrum_grey.png", image::grey, HEADING, image::caption).aside(),
            ]
        }
    }

    fn words(&self, a: &Analysis) -> Option<(&'static str, String)> {
        Some((HEADING, figures::words(a)?))
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("spectrum", &summary::spectrum(a))?;
        keys.add("radial", &summary::radial(a))?;
        keys.add("spectrum_scalars", &a.details().map(scalars::ScalarsOut::new))?;
        keys.add("consistency", &a.details().and_then(scalars::ConsistencyOut::new))
    }

    fn accuracy(&self, a: &Analysis) -> Option<Row> {
        a.spectrum()?;
        let bound = human(a.accuracy.power_bound().max_any(a.shape.max_points as f64));
        let name = a.accuracy.name();
        let text = format!("{name}: |<i>P</i> − <i>P</i><sub>exact</sub>| ≤ {bound} (1 + <i>P</i>)");
        Some(("Accuracy of P".into(), text))
    }

    fn scalars(&self, a: &Analysis) -> Vec<Row> {
        let mut rows = Vec::new();
        if let Some((spectrum, (p, se))) = a.spectrum().and_then(|s| Some((s, s.dc()?))) {
            let se = (spectrum.errors == ErrorSource::AcrossRealizations).then_some(se);
            rows.push(("<i>P</i> at zero frequency, ∑<i>n</i><sup>2</sup> / ∑<i>n</i>".into(), with_error(p, se)));
        }
        if let Some(radial) = a.radial() {
            let db = human(radial.anisotropy_reference_db);
            rows.push(("Anisotropy if isotropic".into(), format!("{db} dB")));
        }
        if let Some(details) = a.details() {
            rows.extend(scalars::rows(details));
        }
        rows
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let mut rows = Vec::new();
        if let Some(radial) = a.radial() {
            let text = match radial.errors {
                ErrorSource::AcrossRealizations => across(a, "each ring's mean of <i>P</i>"),
                ErrorSource::ClusterTheory => {
                    "theory, for a single realization of clusters: exponential ordinates, correlated as in the Thomas process \
                     with this <i>P</i> (Whittle likelihood)"
                        .into()
                }
                _ => {
                    "theory, for a single realization: independent exponential ordinates, <i>P</i> / √(independent modes)"
                        .into()
                }
            };
            rows.push(("<i>P</i>(<i>ν</i>)".into(), text));
            rows.push((
                "anisotropy".into(),
                "theory: the scatter of an isotropic spectrum with the ring's number of independent modes".into(),
            ));
        }
        rows
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(spectrum) = a.listed_power() {
            lines.push(format!("P(ν): {} of a list", plural(spectrum.p.len() as u64, "wave vector")));
        }
        if let Some(radial) = a.radial() {
            let first = radial.rings.first().map_or(String::new(), |ring| {
                let error = Some(ring.p_se);
                format!(", P = {} at the lowest frequency", with_error(ring.p, error))
            });
            lines.push(format!("P(ν): {}{first}", plural(radial.rings.len() as u64, "ring")));
        }
        lines
    }
}

/// The whole grid, index `m + F`, x axis first, from stored values (`p` or `p_se`). Even conventions lack the last plane along
/// each axis.
fn grid<'a>(a: &Analysis, grid: &'a WaveGrid, half: &'a [f64]) -> Array<'a> {
    let lacks_last = a.conventions.lacks_last_plane;
    let full = grid.full_shape();
    let shape = full.iter().map(|&n| n as u64 - u64::from(lacks_last)).collect();
    let is_last = move |index: usize| {
        let along = full.iter().rev().scan(index, |rest, &n| Some((std::mem::replace(rest, *rest / n) % n, n)));
        along.into_iter().any(|(i, n)| i == n - 1)
    };
    let kept = grid.full(half).enumerate().filter(move |&(i, _)| !(lacks_last && is_last(i))).map(|(_, p)| p);
    Array { shape, values: Values::Real(Box::new(kept)) }
}

fn p(a: &Analysis) -> Option<Array<'_>> {
    let (spectrum, waves) = a.grid_of_power()?;
    Some(grid(a, waves, &spectrum.p))
}

/// With one realization the error of a mode is the mode itself; a file would only repeat it.
fn p_se(a: &Analysis) -> Option<Array<'_>> {
    let (spectrum, waves) = a.grid_of_power().filter(|_| a.shape.realizations >= 2)?;
    Some(grid(a, waves, &spectrum.p_se))
}

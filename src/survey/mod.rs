//! The same points seen many times: projected on every pair of axes, or the first of them alone. Every view is measured like points of
//! its own; what is kept of it is a row of scalars, its curves and a picture.

mod figures;
mod page;
mod sheet;
mod tables;

use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde_json::json;

use crate::accumulate::{DiscrepancySums, Sums};
use crate::analysis::{self, Plan};
use crate::compute::Device;
use crate::compute::cpu::Cube;
use crate::control::{Control, Progress};
use crate::display::{Pixels, paper};
use crate::error::{Error, Result, plural};
use crate::estimate::{Analysis, Discrepancies};
use crate::plan::EnsembleShape;
use crate::report::{self, Asked};
use crate::request::{DEFAULT_STATISTICS, Request, SETTINGS, Statistic};
use crate::setting::Setting;
use crate::source::AllAxes;
use crate::statistics::Table;

/// What is looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Views {
    /// Every pair of axes.
    Projections,
    /// The first so many points of every realization.
    Prefixes(Prefixes),
}

/// Numbers of points, rising.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Prefixes(Vec<u64>);

/// A survey.
#[derive(Debug)]
pub struct Survey {
    views: Views,
    subject: String,
    first_line: String,
    dim: usize,
    shape: EnsembleShape,
    /// Of all axes and all points.
    whole: View,
    /// One by one.
    each: Vec<View>,
    /// What the user should know.
    pub warnings: Vec<String>,
    device: String,
}

/// What one view found.
#[derive(Debug)]
struct View {
    /// Its axes, from 0.
    axes: Vec<usize>,
    /// Mean number of points.
    n: f64,
    discrepancies: Option<Discrepancies>,
    /// r, g and its standard error.
    g: Vec<[f64; 3]>,
    /// Frequency, the same in units of `lambda^(1/d)`, P and its standard error.
    p: Vec<[f64; 4]>,
    picture: Option<Pixels>,
    /// The first realization, in the unit square.
    points: Vec<[f64; 2]>,
}

/// Points per cell of the sheet.
const SHOWN: usize = 4096;

impl Prefixes {
    /// The numbers.
    pub fn numbers(&self) -> &[u64] {
        &self.0
    }

    /// The largest.
    pub fn largest(&self) -> u64 {
        self.0.last().copied().unwrap_or(0)
    }
}

impl FromStr for Prefixes {
    type Err = String;

    /// `2^4..2^14`: doubled from the first to the last; or `100,200,500`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected two numbers of points such as 2^4..2^14, doubled from the first on, or a rising list such as 100,200,500";
        let number = |text: &str| {
            let value = match text.split_once('^') {
                Some((base, power)) => base.trim().parse::<u64>().ok()?.checked_pow(power.trim().parse().ok()?)?,
                None => text.trim().parse().ok()?,
            };
            Some(value).filter(|value| (1..=1 << 40).contains(value))
        };
        let numbers: Option<Vec<u64>> = match text.split_once("..") {
            Some((first, last)) => number(first).zip(number(last)).map(|(first, last)| {
                let doubled = std::iter::successors(Some(first), |n| n.checked_mul(2)).take_while(|n| *n < last);
                doubled.chain((first <= last).then_some(last)).collect()
            }),
            None => text.split(',').map(number).collect(),
        };
        let numbers = numbers.ok_or(expected)?;
        if numbers.is_empty() || numbers.windows(2).any(|w| w[0] >= w[1]) {
            return Err(expected.into());
        }
        Ok(Self(numbers))
    }
}

/// The statistics that a survey has tables for.
const STATISTICS: [Statistic; 4] = [Statistic::Pcf, Statistic::Spectrum, Statistic::Radial, Statistic::Discrepancy];

/// Settings of what there are no tables for.
const MISSING: [Setting; 7] = [
    Setting::Integrand,
    Setting::Envelope,
    Setting::EnvelopeFrom,
    Setting::Convention,
    Setting::Kernel,
    Setting::Frequencies,
    Setting::Sectors,
];

/// What would be ignored.
fn refuse_missing(request: &Request) -> Result<()> {
    match SETTINGS.iter().find(|row| MISSING.contains(&row.setting) && row.is_given(request)) {
        Some(row) => {
            let reason = "is not there where pairs of axes or prefixes are measured (`projections`, `prefixes`)";
            Err(Error::setting(row.setting, request.value(row.setting), reason))
        }
        None => Ok(()),
    }
}

/// What is measured of a view.
fn statistics(request: &Request) -> Result<Vec<Statistic>> {
    if request.stats == DEFAULT_STATISTICS {
        return Ok(vec![Statistic::Pcf, Statistic::Spectrum, Statistic::Discrepancy]);
    }
    match request.stats.iter().find(|s| !STATISTICS.contains(s)) {
        Some(other) => {
            let reason = "pairs of axes and prefixes have tables of pcf, spectrum, radial and discrepancy (with least distances)";
            Err(Error::setting(Setting::Stats, other.name(), reason))
        }
        None => Ok(request.stats.clone()),
    }
}

/// Looks at points from all sides.
///
/// # Errors
/// Settings of what is not measured so; what the plans, the points or the device say; too few points for a prefix; `Error::Cancelled`.
pub fn run(
    views: Views,
    request: &Request,
    points: &AllAxes,
    device: &Device,
    control: &Control,
    progress: &mut dyn FnMut(Progress),
) -> Result<Survey> {
    refuse_missing(request)?;
    let dim = points.dim();
    let axes: Vec<usize> = (0..dim).collect();
    let asked: Vec<(Vec<usize>, Option<u64>)> = match &views {
        Views::Projections if dim < 2 => {
            let reason = "points of one coordinate have no pairs of axes";
            return Err(Error::setting(Setting::Projections, "(given)", reason));
        }
        Views::Projections => axes.iter().flat_map(|&a| (a + 1..dim).map(move |b| (vec![a, b], None))).collect(),
        Views::Prefixes(prefixes) => {
            if let Some(n) = Some(prefixes.largest()).filter(|&n| n > points.fewest()) {
                let reason = format!("a realization has only {} points", points.fewest());
                return Err(Error::setting(Setting::Prefixes, n, reason));
            }
            prefixes.numbers().iter().map(|&n| (axes.clone(), Some(n))).collect()
        }
    };
    let request = request.only(&statistics(request)?);
    let mut survey = Survey {
        subject: points.subject().into(),
        first_line: points.first_line(),
        dim,
        shape: points.shape(),
        whole: View::of_all(points, axes, None, &request, device, control)?,
        each: Vec::new(),
        warnings: points.warnings().to_vec(),
        device: device.computed_by().device(),
        views,
    };
    if matches!(survey.views, Views::Prefixes(_)) && points.is_sequence() == Some(false) {
        let reason = "is no sequence: its first points are none of its sets of fewer points";
        survey.warnings.push(format!("{}: the sampler {reason}", points.subject()));
    }
    let total = asked.len() as u64;
    let mut warnings = Vec::new();
    for (done, (axes, first)) in asked.into_iter().enumerate() {
        control.check()?;
        let part = 1.0 / total as f64;
        let before = done as f64 * part;
        let mut told = |p: Progress| {
            progress(p.as_part(part, before, [done as u64, total]));
        };
        let view = match axes.len() {
            1..=3 => View::measured(points, axes, first, &request, device, control, &mut told, &mut warnings)?,
            _ => View::of_all(points, axes, first, &request, device, control)?,
        };
        survey.each.push(view);
    }
    survey.warnings.extend(warnings.iter().map(Warning::to_string));
    Ok(survey)
}

/// What the user should know of a view, and in how many others it is the same.
struct Warning {
    of: String,
    text: String,
    more: u64,
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let more = if self.more > 0 { format!(" and {}", plural(self.more, "more view")) } else { String::new() };
        write!(f, "{}{more}: {}", self.of, self.text)
    }
}

/// `axes 1-2`, `n = 64`.
fn name(axes: &[usize], first: Option<u64>) -> String {
    first.map_or_else(|| format!("axes {}", pair(axes)), |n| format!("n = {n}"))
}

/// Axes counted from 1: `1-2`.
fn pair(axes: &[usize]) -> String {
    axes.iter().map(|a| (a + 1).to_string()).collect::<Vec<_>>().join("-")
}

impl View {
    /// Discrepancies of all axes, however many.
    fn of_all(
        points: &AllAxes,
        axes: Vec<usize>,
        first: Option<u64>,
        request: &Request,
        device: &Device,
        control: &Control,
    ) -> Result<Self> {
        let mut sums = DiscrepancySums::default();
        let shape = points.shape();
        if request.stats.contains(&Statistic::Discrepancy) {
            for k in 0..shape.realizations {
                let axes = points.cube(k as usize, first);
                let cube = Cube { axes, sides: points.sides().to_vec(), is_torus: points.is_torus() };
                let (one, levels) = device.cpu().discrepancy(&cube, 0.0, control)?;
                let one = crate::accumulate::RealizationDiscrepancy { index: k, ..one };
                sums.merge(DiscrepancySums { realizations: vec![one], levels })?;
            }
        }
        Ok(Self {
            axes,
            n: first.map_or(shape.mean_points, |n| n as f64),
            discrepancies: Discrepancies::new(&sums),
            g: Vec::new(),
            p: Vec::new(),
            picture: None,
            points: Vec::new(),
        })
    }

    /// Everything of one to three axes.
    #[expect(clippy::too_many_arguments, reason = "what a run has, and what it looks at")]
    fn measured(
        points: &AllAxes,
        axes: Vec<usize>,
        first: Option<u64>,
        request: &Request,
        device: &Device,
        control: &Control,
        progress: &mut dyn FnMut(Progress),
        warnings: &mut Vec<Warning>,
    ) -> Result<Self> {
        let source = std::sync::Arc::new(points.view(&axes, first)?);
        let plan = Plan::of(request, &source)?.for_device(device.compute());
        let found = analysis::run(request, source, plan, device, control, progress)?;
        for text in found.warnings.iter().cloned() {
            match warnings.iter_mut().find(|warning| warning.text == text) {
                Some(warning) => warning.more += 1,
                None => warnings.push(Warning { of: name(&axes, first), text, more: 0 }),
            }
        }
        Ok(Self::read_off(axes, &found))
    }

    fn read_off(axes: Vec<usize>, found: &Analysis) -> Self {
        let unit = found.domain.measure().powf(-1.0 / axes.len() as f64)
            * found.shape.mean_points.powf(1.0 / axes.len() as f64);
        let g = found
            .pair_correlation()
            .map_or(Vec::new(), |g| g.r.iter().zip(&g.g).zip(&g.g_se).map(|((r, g), se)| [*r, *g, *se]).collect());
        let rings = found.radial().map_or(&[][..], |radial| &radial.rings);
        let turns = |axis: usize| found.first.turns(0, axis).take(SHOWN);
        let plane = axes.len() == 2 && found.first.realizations() > 0;
        Self {
            n: found.shape.mean_points,
            discrepancies: found.discrepancies().cloned(),
            g,
            p: rings.iter().map(|ring| [ring.nu, ring.nu / unit, ring.p, ring.p_se]).collect(),
            picture: paper::pixels(found, 256).filter(|_| plane),
            points: if plane { turns(0).zip(turns(1)).map(|(x, y)| [x, y]).collect() } else { Vec::new() },
            axes,
        }
    }
}

impl Survey {
    /// What was read, in a line.
    pub fn first_line(&self) -> &str {
        &self.first_line
    }

    /// The scalars of every view, for a terminal.
    pub fn text(&self) -> String {
        let (heading, shown) = match self.views {
            Views::Projections => {
                ("pairs of axes", &["axes", "star_l2", "centered_l2", "minimum_distance_relative", "t"][..])
            }
            Views::Prefixes(_) => {
                ("prefixes", &["n", "star_l2", "centered_l2", "diaphony", "minimum_distance_relative", "t"][..])
            }
        };
        report::some_columns(heading, shown, &self.scalars())
    }

    fn scalars(&self) -> Table {
        match self.views {
            Views::Projections => tables::projections(self),
            Views::Prefixes(_) => tables::prefixes(self),
        }
    }

    /// Its tables, by the names of their files.
    pub fn tables(&self) -> Vec<(&'static str, Table)> {
        let names = match self.views {
            Views::Projections => ["projections.csv", "projections_pcf.csv", "projections_radial.csv"],
            Views::Prefixes(_) => ["prefixes.csv", "prefixes_pcf.csv", "prefixes_radial.csv"],
        };
        let tables = [Some(self.scalars()), tables::pcf(self), tables::radial(self)];
        names.into_iter().zip(tables).filter_map(|(name, table)| Some((name, table?))).collect()
    }

    /// Writes everything into `dir`, as `report::write` does.
    ///
    /// # Errors
    /// As `report::write`.
    pub fn write(&self, dir: &Path, asked: &Asked, force: bool) -> Result<Vec<PathBuf>> {
        let kind = match self.views {
            Views::Projections => "projections",
            Views::Prefixes(_) => "prefixes",
        };
        let own = json!({
            "survey": kind,
            "subject": self.subject,
            "n": self.shape.mean_points,
            "k": self.shape.realizations,
            "d": self.dim,
            "views": self.each.len(),
            "device": self.device,
        });
        report::write_files(dir, force, asked, &self.warnings, own, |files| {
            let tables = self.tables();
            for (name, table) in &tables {
                files.add(name, |file| file.write_all(&table.csv()?));
            }
            let (mut sheet, mut figures) = (None, Vec::new());
            match self.views {
                Views::Projections => match sheet::svg(self) {
                    Ok(svg) => {
                        files.add("projections.svg", |file| file.write_all(svg.as_bytes()));
                        sheet = Some(svg);
                    }
                    Err(e) => files.add("projections.svg", |_| Err(io::Error::other(e))),
                },
                Views::Prefixes(_) => figures = figures::drawn(self),
            }
            for (name, figure) in &figures {
                let svg = || report::svg(figure).map_err(io::Error::other);
                files.add(name, |file| file.write_all(svg()?.as_bytes()));
            }
            files.add(report::PAGE, |file| {
                let page =
                    page::page(self, &asked.command, &tables, &figures, sheet.as_deref()).map_err(io::Error::other)?;
                file.write_all(page.as_bytes())
            });
        })
    }
}

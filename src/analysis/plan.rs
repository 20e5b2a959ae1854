//! A request and the number of points -> everything decided before the first sum: a value that prints.

use std::fmt;
use std::path::Path;

use super::classes::Classes;
use crate::error::{Error, Result, number};
use crate::estimate::Kernel;
use crate::plan::{BinScale, Correction, EnsembleShape, PairPlan, PairSettings, RadialBins, WaveGrid, WavePlan};
use crate::points::Domain;
use crate::points::read::read_edges;
use crate::request::{Request, Statistic};

/// Everything decided before the first sum: a value that can be printed.
#[derive(Debug)]
pub struct Plan {
    /// Whether g is wanted, not only K.
    pub(super) pcf: bool,
    pub(super) pairs: Option<PairPlan>,
    /// A second pass over the pairs, into the fine bins behind a kernel estimate.
    pub(super) fine: Option<(Kernel, PairPlan)>,
    /// Two classes of points whose own g and whose g with each other is wanted.
    pub(super) classes: Option<Classes>,
    pub(super) waves: Option<WavePlan>,
    pub(super) neighbors: bool,
    /// Whether the grid itself is wanted, not only its rings.
    pub(super) grid_wanted: bool,
    pub(super) batch: u64,
}

impl Plan {
    /// Decides from the request and the number of points.
    pub fn new(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<Self> {
        let wants = |s| request.stats.contains(&s);
        let (pcf, k_function) = (wants(Statistic::Pcf), wants(Statistic::KFunction));
        check_points(pcf || k_function || wants(Statistic::Neighbors), shape)?;
        refuse_idle_settings(request)?;
        let bins = (pcf || k_function).then(|| bins(request, domain, shape.mean_points)).transpose()?;
        let default_correction = if domain.is_torus() { Correction::None } else { Correction::Translation };
        let correction = request.correction.unwrap_or(default_correction);
        let settings = PairSettings {
            correction,
            cumulative: k_function,
            beyond_half: request.beyond_half,
            masses: request.input.weight_column.is_some(),
        };
        if request.beyond_half && !domain.is_torus() {
            return Err(Error::setting(
                "--beyond-half",
                "(given)",
                "is about a torus; a window has its edge correction",
            ));
        }
        if let Some(bins) = bins.as_ref().filter(|_| k_function) {
            check_bins_of_k(request, bins, domain)?;
        }
        if request.kernel.is_some() && correction == Correction::Border {
            return Err(Error::setting(
                "--correction",
                correction,
                "is not for kernels; expected translation or isotropic",
            ));
        }
        let fine = match (&bins, request.kernel) {
            (Some(bins), Some(kernel)) => {
                let kernel = Kernel::new(kernel, request.bandwidth, domain, shape.mean_points)?;
                let fine = kernel.fine_bins(bins.r_max(), domain)?;
                Some((kernel, PairPlan::new(domain, fine, PairSettings { cumulative: false, ..settings }, shape)?))
            }
            _ => None,
        };
        let pairs = bins.map(|bins| PairPlan::new(domain, bins, settings, shape)).transpose().map_err(|e| {
            match &request.edges {
                Some(path) => blame_edges(e, path),
                None => e,
            }
        })?;
        let waves = if wants(Statistic::Spectrum) || wants(Statistic::Radial) {
            let given = request.max_frequency.as_deref();
            let frequencies = match given {
                Some([f]) => vec![*f; domain.dim()],
                Some(each) => each.to_vec(),
                None => WaveGrid::default_max_frequency(shape.mean_points, domain),
            };
            Some(WavePlan::new(domain, WaveGrid::new(&frequencies)?, request.accuracy, shape)?)
        } else {
            None
        };
        let batches =
            [pairs.as_ref().map(|p| p.batch), fine.as_ref().map(|f| f.1.batch), waves.as_ref().map(|w| w.batch)];
        // Neighbours alone need no more than any of these: 4096 realizations at a time.
        let batch = batches.into_iter().flatten().map(|b| b.realizations).min().unwrap_or(4096);
        let (neighbors, grid_wanted) = (wants(Statistic::Neighbors), wants(Statistic::Spectrum));
        Ok(Self { pcf, pairs, fine, classes: None, waves, neighbors, grid_wanted, batch })
    }
}

impl Plan {
    /// The same plan for points of the classes with these names (`Source::classes`), of which there are none without
    /// `--class-column`.
    pub fn with_classes(mut self, request: &Request, names: &[String]) -> Result<Self> {
        if let Some(pairs) = self.pairs.as_ref().filter(|_| self.pcf && !names.is_empty()) {
            self.classes = Some(Classes::new(request, names, pairs)?);
        }
        Ok(self)
    }
}

/// A setting of a statistic that was not asked for would be silently ignored.
fn refuse_idle_settings(request: &Request) -> Result<()> {
    let text = |value: Option<String>| value.unwrap_or_default();
    let pairs = [
        ("--r-max", text(request.r_max.map(|r| r.to_string()))),
        ("--bins", text(request.bins.map(|b| b.to_string()))),
        ("--bin-scale", text(request.bin_scale.map(|s| format!("{s:?}").to_lowercase()))),
        ("--edges", text(request.edges.as_ref().map(|e| e.display().to_string()))),
        ("--correction", text(request.correction.map(|c| c.to_string()))),
        ("--beyond-half", text(request.beyond_half.then(|| "(given)".into()))),
        ("--weight-column", text(request.input.weight_column.clone())),
    ];
    let pcf = [
        ("--kernel", text(request.kernel.map(|k| format!("{k:?}").to_lowercase()))),
        ("--class-column", text(request.input.class_column.clone())),
    ];
    let list = |f: &Vec<u32>| f.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
    let waves = [("--max-frequency", text(request.max_frequency.as_ref().map(list)))];
    let wants = |s| request.stats.contains(&s);
    let no_pairs = !wants(Statistic::Pcf) && !wants(Statistic::KFunction);
    let idle_pairs = pairs.into_iter().filter(|_| no_pairs).map(|(f, v)| (f, v, "pcf or k-function"));
    let idle_pcf = pcf.into_iter().filter(|_| !wants(Statistic::Pcf)).map(|(f, v)| (f, v, "pcf"));
    let no_waves = !wants(Statistic::Spectrum) && !wants(Statistic::Radial);
    let idle_waves = waves.into_iter().filter(|_| no_waves).map(|(f, v)| (f, v, "spectrum or radial"));
    match idle_pairs.chain(idle_pcf).chain(idle_waves).find(|(_, value, _)| !value.is_empty()) {
        Some((flag, value, statistic)) => Err(Error::setting(flag, value, format!("needs {statistic} among --stats"))),
        None => Ok(()),
    }
}

/// K counts from 0 on, and L compares it with balls.
fn check_bins_of_k(request: &Request, bins: &RadialBins, domain: &Domain) -> Result<()> {
    let first = bins.edges()[0];
    if first > 0.0 {
        let reason = format!("K counts all pairs closer than r: bins must start at 0, not at {first}");
        return Err(match &request.edges {
            Some(path) => Error::setting("--edges", path.display(), reason),
            None => Error::setting("--bin-scale", "log", reason),
        });
    }
    let limit = domain.shortest_side() / 2.0;
    if request.beyond_half && bins.r_max() > limit {
        let reason =
            format!("K and L compare with whole balls, which fit up to r = {limit}; expected --stats pcf alone");
        return Err(Error::setting("--beyond-half", "(given)", reason));
    }
    Ok(())
}

/// Whether the realizations hold enough points for pairs, or for anything.
pub(super) fn check_points(pairs: bool, shape: EnsembleShape) -> Result<()> {
    let reason = match shape.max_points {
        0 => "no realization has any points; nothing can be measured",
        1 if pairs => {
            "pcf and neighbors need a realization of at least 2 points, the largest has 1; --stats spectrum works with 1"
        }
        _ => return Ok(()),
    };
    Err(Error::input("points", reason))
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(pairs) = &self.pairs {
            write!(f, "{pairs}")?;
        }
        if let Some((kernel, fine)) = &self.fine {
            writeln!(f, "kernel estimate: {:?}, bandwidth {}, from fine counts:", kernel.shape, kernel.bandwidth)?;
            write!(f, "{fine}")?;
        }
        if let Some(classes) = &self.classes {
            write!(f, "{classes}")?;
        }
        if let Some(waves) = &self.waves {
            write!(f, "{waves}")?;
        }
        if self.neighbors {
            writeln!(f, "neighbours: k-d tree, exact distances of the pairs it finds")?;
        }
        let skipped = [(!self.pcf, "pcf"), (self.waves.is_none(), "spectrum"), (!self.neighbors, "neighbors")];
        for (_, name) in skipped.iter().filter(|(skipped, _)| *skipped) {
            writeln!(f, "skipped: {name} (not asked for)")?;
        }
        writeln!(f, "together: {} realizations at a time", self.batch)
    }
}

/// An error about distances, told of the file they came from.
fn blame_edges(error: Error, path: &Path) -> Error {
    match error {
        Error::Setting { flag: "--r-max", value, reason } => {
            Error::setting("--edges", path.display(), format!("its last edge {value}: {reason}"))
        }
        Error::Setting { flag: "--edges" | "--bins", reason, .. } => Error::setting("--edges", path.display(), reason),
        other => other,
    }
}

/// The bins a request asks for.
fn bins(request: &Request, domain: &Domain, mean_points: f64) -> Result<RadialBins> {
    if let Some(path) = &request.edges {
        // What is wrong with them is wrong in that file.
        return RadialBins::from_edges(read_edges(path)?).map_err(|e| blame_edges(e, path));
    }
    let mut default = PairPlan::default_r_max(domain, mean_points);
    if request.correction == Some(Correction::Border) {
        // Enough points must be that far from the border.
        default = default.min(domain.shortest_side() / 4.0);
    }
    let r_max = request.r_max.unwrap_or(default);
    // Written so that NaN fails.
    if !(r_max > 0.0 && r_max.is_finite()) {
        return Err(Error::setting("--r-max", number(r_max), "expected a finite number above 0"));
    }
    let bins = request.bins.unwrap_or(256);
    match request.bin_scale.unwrap_or(BinScale::Linear) {
        BinScale::Log => RadialBins::logarithmic(r_max * 1e-3, r_max, bins),
        BinScale::Linear | BinScale::Given => RadialBins::linear(r_max, bins),
    }
}

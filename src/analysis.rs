//! A request, carried out: points -> plan -> compute -> accumulate -> estimate, in batches. The command line and the
//! viewer both call this and hold no arithmetic of their own.

use std::path::Path;
use std::time::Instant;

use crate::accumulate::{PairCounts, WavePower};
use crate::compute::{Compute, ComputedBy, Control, cpu::Cpu};
use crate::error::{Error, Result};
use crate::estimate::{
    Kernel, KernelEstimate, NearestNeighbors, NeighborDistances, Normalization, PairCorrelation, PowerSpectrum,
    RadialSpectrum, neighbor_distances,
};
use crate::plan::{Accuracy, BinScale, Correction, EnsembleShape, PairPlan, RadialBins, WaveGrid, WavePlan};
use crate::points::{Domain, Ensemble};
use crate::request::{Request, Statistic};
use crate::source::Source;

/// Everything `analyze` found.
#[derive(Debug)]
pub struct Analysis {
    /// What was analyzed, in words: `sampler jittered, n 1024, K 20, seed 1` or the input files.
    pub subject: String,
    /// Settings as (name, value), in a fixed order, for the summary.
    pub parameters: Vec<(String, String)>,
    /// The domain.
    pub domain: Domain,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Smallest number of points in a realization.
    pub min_points: u64,
    /// The edge correction of g.
    pub correction: Correction,
    /// g per bin.
    pub pair_correlation: Option<PairCorrelation>,
    /// g smoothed, at the bin centres.
    pub kernel: Option<KernelEstimate>,
    /// P on the grid.
    pub spectrum: Option<PowerSpectrum>,
    /// Whether the grid itself was asked for, not only its rings.
    pub grid_wanted: bool,
    /// Radial mean and anisotropy.
    pub radial: Option<RadialSpectrum>,
    /// Nearest-neighbour distances.
    pub neighbors: Option<NeighborDistances>,
    /// What theory says, where the process has a closed form.
    pub closed_form: ClosedForm,
    /// The accuracy asked for.
    pub accuracy: Accuracy,
    /// Who computed the sums.
    pub computed_by: ComputedBy,
    /// The plans, printed.
    pub plan: String,
    /// Wall time per stage, seconds.
    pub timings: Vec<(&'static str, f64)>,
    /// Points that coincide with an earlier one of their realization.
    pub duplicates: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// The first realization, for pictures.
    pub first: Ensemble,
}

/// Curves known in closed form, at the abscissae of the estimates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ClosedForm {
    /// The process, for legends.
    pub name: String,
    /// g at the bin centres, in the normalization of the estimate.
    pub g: Option<Vec<f64>>,
    /// Mean of P over each ring.
    pub radial: Option<Vec<f64>>,
}

/// Everything decided before the first sum: a value that can be printed.
#[derive(Debug)]
pub struct Plan {
    pairs: Option<PairPlan>,
    /// A second pass over the pairs, into the fine bins behind a kernel estimate.
    fine: Option<(Kernel, PairPlan)>,
    waves: Option<WavePlan>,
    neighbors: bool,
    /// Whether the grid itself is wanted, not only its rings.
    grid_wanted: bool,
    batch: u64,
}

impl Plan {
    /// Decides from the request and the number of points.
    pub fn new(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<Self> {
        let wants = |s| request.stats.contains(&s);
        let bins = wants(Statistic::Pcf).then(|| bins(request, domain, shape.mean_points)).transpose()?;
        let default_correction = if domain.is_torus() { Correction::None } else { Correction::Translation };
        let correction = request.correction.unwrap_or(default_correction);
        let fine = match (&bins, request.kernel) {
            (Some(bins), Some(kernel)) => {
                let kernel = Kernel::new(kernel, request.bandwidth, domain, shape.mean_points)?;
                let fine = kernel.fine_bins(bins.r_max(), domain)?;
                Some((kernel, PairPlan::new(domain, fine, correction, shape)?))
            }
            _ => None,
        };
        let pairs = bins.map(|bins| PairPlan::new(domain, bins, correction, shape)).transpose()?;
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
        let plan = Self {
            pairs,
            fine,
            waves,
            neighbors: wants(Statistic::Neighbors),
            grid_wanted: wants(Statistic::Spectrum),
            batch,
        };
        plan.check_points(shape)?;
        Ok(plan)
    }

    fn check_points(&self, shape: EnsembleShape) -> Result<()> {
        let enough = if self.pairs.is_some() || self.neighbors { 2 } else { 1 };
        if shape.max_points < enough {
            let n = shape.max_points;
            let reason = if n == 0 {
                "no realization has any points; nothing can be measured".to_string()
            } else {
                "pcf and neighbors need a realization of at least 2 points, the largest has 1; \
                 --stats spectrum works with 1"
                    .to_string()
            };
            return Err(Error::input("points", reason));
        }
        Ok(())
    }
}

impl std::fmt::Display for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(pairs) = &self.pairs {
            write!(f, "{pairs}")?;
        }
        if let Some((kernel, fine)) = &self.fine {
            writeln!(f, "kernel estimate: {:?}, bandwidth {}, from fine counts:", kernel.shape, kernel.bandwidth)?;
            write!(f, "{fine}")?;
        }
        if let Some(waves) = &self.waves {
            write!(f, "{waves}")?;
        }
        if self.neighbors {
            writeln!(f, "neighbours: k-d tree, exact distances of the pairs it finds")?;
        }
        let skipped =
            [(self.pairs.is_none(), "pcf"), (self.waves.is_none(), "spectrum"), (!self.neighbors, "neighbors")];
        for (_, name) in skipped.iter().filter(|(skipped, _)| *skipped) {
            writeln!(f, "skipped: {name} (not asked for)")?;
        }
        writeln!(f, "together: {} realizations at a time", self.batch)
    }
}

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Realizations finished.
    pub done: u64,
    /// Of how many.
    pub total: u64,
}

/// Computes, and falls back to the CPU path where the device cannot or fails.
struct Device<'a> {
    compute: &'a dyn Compute,
    fallback: Option<Cpu>,
    threads: Option<usize>,
    /// The device failed; everything goes to the fallback from here on.
    failed: bool,
    warnings: Vec<String>,
}

impl Device<'_> {
    /// Runs `work` on the device or, where it does not support it or fails at it, on the CPU path. A failed batch leaves
    /// nothing behind, so it is simply done again.
    fn run<T>(&mut self, supported: Result<(), String>, work: impl Fn(&dyn Compute) -> Result<T>) -> Result<T> {
        if !self.failed {
            match supported {
                Ok(()) => match work(self.compute) {
                    Err(error @ Error::Device { .. }) => {
                        self.failed = true;
                        self.warn(format!("{error}; continued on the native CPU path"));
                    }
                    done => return done,
                },
                Err(why) => self.warn(format!("{why}; done on the native CPU path")),
            }
        }
        if self.fallback.is_none() {
            self.fallback = Some(Cpu::new(self.threads)?);
        }
        match &self.fallback {
            Some(cpu) => work(cpu),
            None => Err(Error::Cancelled),
        }
    }

    fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}

/// Carries out a request on points and a device.
pub fn run(
    request: &Request,
    source: &Source,
    plan: &Plan,
    compute: &dyn Compute,
    control: &Control,
    progress: &mut dyn FnMut(Progress),
) -> Result<Analysis> {
    let shape = source.shape();
    let mut device = Device { compute, fallback: None, threads: request.threads, failed: false, warnings: Vec::new() };
    let mut pairs: Option<PairCounts> = None;
    let mut fine: Option<PairCounts> = None;
    let mut waves: Option<WavePower> = None;
    let mut neighbors: Option<NearestNeighbors> = None;
    let mut duplicates = 0;
    let mut points = (u64::MAX, 0u64, 0u64);
    let mut first = None;
    let mut clock = Clock::default();
    let mut start = 0;
    while start < shape.realizations {
        control.check()?;
        let end = (start + plan.batch).min(shape.realizations);
        let mut tell = |stage| progress(Progress { stage, done: start, total: shape.realizations });
        tell("points");
        let batch = clock.time("points", || source.batch(start..end, control))?;
        duplicates += batch.duplicates();
        for k in 0..batch.realizations() {
            let n = batch.points_in(k) as u64;
            points = (points.0.min(n), points.1.max(n), points.2 + n);
        }
        for (name, plan, sums) in [
            ("pair_counts", plan.pairs.as_ref(), &mut pairs),
            ("pair_counts (kernel)", plan.fine.as_ref().map(|f| &f.1), &mut fine),
        ] {
            if let Some(plan) = plan {
                tell(name);
                let part = clock.time(name, || {
                    let supported = device.compute.supports_pair_counts(plan);
                    device.run(supported, |c| c.pair_counts(plan, &batch, control))
                })?;
                match sums {
                    Some(sums) => sums.merge(&part)?,
                    None => *sums = Some(part),
                }
            }
        }
        if let Some(plan) = &plan.waves {
            tell("wave_power");
            let part = clock.time("wave_power", || {
                let supported = device.compute.supports_wave_power(plan);
                device.run(supported, |c| c.wave_power(plan, &batch, control))
            })?;
            match &mut waves {
                Some(sums) => sums.merge(part)?,
                None => waves = Some(part),
            }
        }
        if plan.neighbors {
            tell("neighbors");
            let part = clock.time("neighbors", || neighbor_distances(&batch, control))?;
            match &mut neighbors {
                Some(found) => found.merge(&part)?,
                None => neighbors = Some(part),
            }
        }
        if first.is_none() {
            first = Some(batch.slice(0..1));
        }
        start = end;
    }
    progress(Progress { stage: "estimates", done: shape.realizations, total: shape.realizations });
    let first = first.ok_or_else(|| Error::input(source.subject(), "there are no realizations"))?;
    // A sampler that draws n is only now known to have drawn enough.
    let shape = EnsembleShape {
        realizations: shape.realizations,
        mean_points: points.2 as f64 / shape.realizations as f64,
        max_points: points.1,
    };
    plan.check_points(shape)?;
    let mut warnings = device.warnings;
    if duplicates > 0 {
        warnings.push(format!("{duplicates} points coincide with another point of their realization"));
    }
    if plan.waves.is_some() && !source.domain().is_torus() {
        let warning = "P in a window is the plain periodogram at the window's own frequencies m / L: without a taper, \
                       what the window cuts off leaks into the lowest frequencies";
        warnings.push(warning.to_string());
    }
    let estimates = Instant::now();
    let both = |plan: &Option<PairPlan>, sums: &Option<PairCounts>| {
        Some(PairCorrelation::new(plan.as_ref()?, sums.as_ref()?, request.normalization))
    };
    let pair_correlation = both(&plan.pairs, &pairs);
    let kernel = match (&plan.fine, &fine, &pair_correlation) {
        (Some((kernel, plan)), Some(sums), Some(g)) => {
            Some(KernelEstimate::new(*kernel, &g.r, plan, sums, request.normalization))
        }
        _ => None,
    };
    let spectrum = plan.waves.as_ref().zip(waves.as_ref()).map(|(plan, sums)| PowerSpectrum::new(plan, sums));
    let radial = match (&plan.waves, &waves, &spectrum) {
        (Some(plan), Some(sums), Some(spectrum)) => Some(RadialSpectrum::new(plan, sums, spectrum)),
        _ => None,
    };
    let computed_by = [pairs.map(|s| s.computed_by), fine.map(|s| s.computed_by), waves.map(|s| s.computed_by)]
        .into_iter()
        .flatten()
        .reduce(|a, b| a.merge(&b))
        .unwrap_or_else(|| ComputedBy::new(crate::compute::Backend::Cpu, "k-d tree"));
    let closed_form = closed_form(source, plan, request.normalization, pair_correlation.as_ref());
    clock.add("estimates", estimates.elapsed().as_secs_f64());
    Ok(Analysis {
        subject: source.subject().to_string(),
        parameters: request.parameters(),
        domain: source.domain().clone(),
        shape,
        min_points: points.0,
        correction: plan.pairs.as_ref().map_or(Correction::None, |p| p.correction),
        pair_correlation,
        kernel,
        spectrum,
        grid_wanted: plan.grid_wanted,
        radial,
        neighbors: neighbors.map(|n| n.summary()),
        closed_form,
        accuracy: request.accuracy,
        computed_by,
        plan: plan.to_string(),
        timings: clock.stages,
        duplicates,
        warnings,
        first,
    })
}

/// The bins a request asks for.
fn bins(request: &Request, domain: &Domain, mean_points: f64) -> Result<RadialBins> {
    if let Some(path) = &request.edges {
        return RadialBins::from_edges(read_edges(path)?);
    }
    let r_max = request.r_max.unwrap_or_else(|| PairPlan::default_r_max(domain, mean_points));
    let bins = request.bins.unwrap_or(256);
    match request.bin_scale.unwrap_or(BinScale::Linear) {
        BinScale::Log => RadialBins::logarithmic(r_max * 1e-3, r_max, bins),
        BinScale::Linear | BinScale::Given => RadialBins::linear(r_max, bins),
    }
}

/// Numbers separated by blanks, commas or line ends; `#` starts a comment.
fn read_edges(path: &Path) -> Result<Vec<f64>> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
    let mut edges = Vec::new();
    for (line, content) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let content = content.split('#').next().unwrap_or_default();
        for word in content.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|w| !w.is_empty()) {
            edges.push(word.parse().map_err(|_| {
                Error::input(format!("{}:{}", path.display(), line + 1), format!("`{word}` is not a number"))
            })?);
        }
    }
    Ok(edges)
}

/// What theory says about the source, on a cubic torus.
fn closed_form(source: &Source, plan: &Plan, normalization: Normalization, g: Option<&PairCorrelation>) -> ClosedForm {
    let Some(process) = source.process().filter(|_| source.domain().is_cubic()) else { return ClosedForm::default() };
    let side = source.domain().shortest_side();
    let n = process.n as f64;
    // What turns n(n-1) into n^2 is a number only where n is one.
    let factor = match normalization {
        Normalization::Pairs => Some(1.0),
        Normalization::Intensity => process.sampler.fixed_n().then_some((n - 1.0) / n),
    };
    let g = g.and_then(|g| g.r.iter().map(|r| Some(process.pair_correlation(r / side)? * factor?)).collect());
    let radial = plan.waves.as_ref().and_then(|plan| {
        let mut sums = vec![0.0; plan.rings.count];
        for (index, &ring) in plan.rings.ring_of.iter().enumerate().filter(|(_, ring)| **ring > 0) {
            let multiplicity = f64::from(plan.grid.multiplicity(index));
            sums[ring as usize - 1] += multiplicity * process.power(plan.grid.mode(index))?;
        }
        Some(sums.iter().zip(&plan.rings.modes).map(|(sum, &modes)| sum / modes as f64).collect())
    });
    ClosedForm { name: process.sampler.name().to_string(), g, radial }
}

/// Wall time per stage.
#[derive(Default)]
struct Clock {
    stages: Vec<(&'static str, f64)>,
}

impl Clock {
    fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.add(stage, start.elapsed().as_secs_f64());
        result
    }

    fn add(&mut self, stage: &'static str, seconds: f64) {
        match self.stages.iter_mut().find(|(name, _)| *name == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.stages.push((stage, seconds)),
        }
    }
}

//! A request and the number of points -> everything decided before the first sum: a value that prints.

use std::fmt;

use super::classes::Classes;
use crate::compute::Compute;
use crate::error::{Error, Result, number, numbers};
use crate::estimate::PsaStatistics;
use crate::plan::{
    Bandwidth, BandwidthSearch, BinScale, Convention, Correction, CovariancePlan, DEFAULT_RINGS, DEFAULT_SECTORS,
    EnsembleShape, Kernel, KernelPlan, LagGrid, LagPlan, NeighborPlan, PairPlan, PairSettings, RadialBins, TaperPlan,
    WaveGrid, WaveList, WavePlan, WaveVectors,
};
use crate::points::Domain;
use crate::request::lists::{read_edges, read_frequencies};
use crate::request::{Group, Request, SETTINGS, Statistic, refuse_idle_settings, refuse_unknown_to_convention};
use crate::setting::Setting;
use crate::source::Source;

/// Everything decided before the first sum: a value that can be printed.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Whether g is wanted, not only K.
    pub(super) pcf: bool,
    /// Whether its bins are PSA's.
    pub(super) psa_bins: bool,
    /// Whether with the defects of that program.
    pub(super) bug_compatible: bool,
    /// Distances from which PSA takes its statistics of the spectrum.
    pub(super) psa: Option<PairPlan>,
    pub(super) pairs: Option<PairPlan>,
    /// Two classes of points whose own g and whose g with each other is wanted.
    pub(super) classes: Option<Classes>,
    /// A second pass over the pairs, for a kernel estimate.
    pub(super) kernel: Option<KernelPlan>,
    /// A pass before that, to find its bandwidth; until then it is Stoyan's.
    pub(super) search: Option<BandwidthSearch>,
    pub(super) lags: Option<LagPlan>,
    /// The rings of g of the vector, on a finer grid of their own.
    pub(super) rings: Option<LagPlan>,
    pub(super) waves: Option<WavePlan>,
    pub(super) covariance: Option<CovariancePlan>,
    pub(super) neighbors: Option<NeighborPlan>,
    /// Whether the grid itself is wanted, not only its rings.
    pub(super) grid_wanted: bool,
    /// Simulations of complete spatial randomness, for envelopes.
    pub(super) simulations: u64,
    pub(super) batch: u64,
}

/// Bins per axis of the grid behind rings.
const RING_GRID: usize = 128;

/// Values of simulated curves held at a time: 1 GiB.
const MAX_SIMULATED: u64 = 1 << 27;

/// Most bins of PSA's distances: as many Bessel functions squared. Reached at 100,000 points.
pub(super) const MAX_PSA_BINS: usize = 32_000;

impl Plan {
    /// Decides from the request and its points.
    pub fn of(request: &Request, source: &Source) -> Result<Self> {
        let plan = Self::new(request, source.domain(), source.shape())?;
        if let Some(column) = request.input.weight_column.as_ref().filter(|_| plan.pairs.is_some()) {
            source.check_pair_weights(column)?;
        }
        plan.with_classes(request, source.classes())
    }

    /// Decides from the request and the number of points.
    pub fn new(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<Self> {
        let wants = |s| request.stats.contains(&s);
        let (pcf, k_function) = (wants(Statistic::Pcf), wants(Statistic::KFunction));
        check_points(pcf || k_function || wants(Statistic::PcfVector) || wants(Statistic::Neighbors), shape)?;
        refuse_idle_settings(request)?;
        check_convention(request, domain, shape)?;
        let bins = (pcf || k_function).then(|| bins(request, domain, shape.mean_points)).transpose()?;
        let default_correction = if domain.is_torus() { Correction::None } else { Correction::Translation };
        let correction = request.correction.unwrap_or(default_correction);
        let settings = PairSettings {
            correction,
            cumulative: k_function,
            beyond_half: request.beyond_half || request.convention.pair_bins(shape.max_points).is_some(),
            masses: request.input.weight_column.is_some(),
        };
        if request.beyond_half && !domain.is_torus() {
            return Err(Error::setting(
                Setting::BeyondHalf,
                "(given)",
                "is about a torus; a window has its edge correction",
            ));
        }
        if let Some(bins) = bins.as_ref().filter(|_| k_function) {
            check_bins_of_k(request, bins, domain)?;
        }
        let (kernel, search) = match (&bins, request.kernel) {
            (Some(bins), Some(kernel)) => {
                let rule = request.bandwidth.unwrap_or(Bandwidth::Stoyan);
                let divisor = request.divisor.unwrap_or_default();
                let (r, exact) = (bins.centres(), request.exact_kernel);
                let ends = [r[0], r[r.len() - 1]];
                let kernel = Kernel { shape: kernel, bandwidth: rule.value(domain, shape.mean_points) };
                let plan = KernelPlan::new(kernel, divisor, r, exact, domain, settings, shape)?;
                let search = (rule == Bandwidth::Lscv)
                    .then(|| BandwidthSearch::new(kernel.shape, ends, domain, settings, shape))
                    .transpose()?;
                (Some(plan), search)
            }
            _ => (None, None),
        };
        let pairs = bins.map(|bins| PairPlan::new(domain, bins, settings, shape)).transpose().map_err(|e| {
            match (e, &request.edges) {
                (Error::Setting { setting: Setting::RMax, value, reason }, Some(path)) => {
                    Error::setting(Setting::Edges, path.display(), format!("its last edge {value}: {reason}"))
                }
                (other, _) => other,
            }
        })?;
        let lags = wants(Statistic::PcfVector).then(|| lags(request, domain, correction, shape)).transpose()?;
        let rings = lags.as_ref().map(|lags| rings(request, lags)).transpose()?.flatten();
        let bins = pairs.as_ref().map(|p| &p.bins);
        let neighbors = wants(Statistic::Neighbors).then(|| NeighborPlan::new(domain, bins, shape)).transpose()?;
        let waves = (wants(Statistic::Spectrum) || wants(Statistic::Radial))
            .then(|| {
                waves(request, domain, shape).map_err(|e| match &request.max_frequency {
                    Some(typed) => e.typed_as(Setting::MaxFrequency, axes(typed)),
                    None => e,
                })
            })
            .transpose()?;
        let grid_wanted = wants(Statistic::Spectrum);
        let waves = waves.map(|w| WavePlan { rings_only: !grid_wanted && w.rings.count > 0, ..w });
        let covariance = wants(Statistic::Covariance)
            .then(|| CovariancePlan::new(domain, request.covariance_frequency, shape))
            .transpose()?;
        let psa = psa_pairs(request, domain, shape)?.filter(|_| waves.is_some());
        let batches = [
            pairs.as_ref().map(|p| p.batch),
            kernel.as_ref().map(|k| k.pairs.batch),
            search.as_ref().map(|s| s.pairs.batch),
            lags.as_ref().map(|l| l.batch),
            rings.as_ref().map(|l| l.batch),
            waves.as_ref().map(|w| w.batch),
            covariance.as_ref().map(|c| c.batch),
            neighbors.as_ref().map(|n| n.batch),
            psa.as_ref().map(|p| p.batch),
        ];
        let batch = batches.into_iter().flatten().map(|b| b.realizations).min().unwrap_or(1);
        // g, the kernel estimate, K and L, G and F.
        let curves = usize::from(pcf) + usize::from(kernel.is_some()) + 2 * usize::from(k_function);
        let values =
            pairs.as_ref().map_or(0, |p| curves * p.bins.len()) + neighbors.as_ref().map_or(0, |n| 2 * n.r.len());
        let simulations = simulations(request, values as u64)?;
        if let (Some(n), Some(column)) = (request.envelope, &request.input.weight_column) {
            let reason =
                format!("simulated points would have no weights, those of the file have (`weight_column` {column})");
            return Err(Error::setting(Setting::Envelope, n, reason));
        }
        Ok(Self {
            pcf,
            psa_bins: request.convention == Convention::Psa,
            bug_compatible: request.bug_compatible,
            psa,
            pairs,
            kernel,
            search,
            classes: None,
            lags,
            rings,
            waves,
            covariance,
            neighbors,
            grid_wanted,
            simulations,
            batch,
        })
    }

    /// The same plan for points of the classes with these names (`Source::classes`), of which there are none without
    /// `--class-column`.
    fn with_classes(mut self, request: &Request, names: &[String]) -> Result<Self> {
        if let Some(pairs) = self.pairs.as_ref().filter(|_| self.pcf && !names.is_empty()) {
            self.classes = Some(Classes::new(request, names, pairs)?);
        }
        Ok(self)
    }

    /// The same plan with the searches that suit a device.
    pub fn for_device(self, compute: &dyn Compute) -> Self {
        let device = compute.pair_device();
        let suited = |plan: PairPlan| plan.for_device(device);
        Self {
            pairs: self.pairs.map(suited),
            classes: self.classes.map(|c| Classes { pairs: suited(c.pairs), ..c }),
            psa: self.psa.map(suited),
            kernel: self.kernel.map(|k| KernelPlan { pairs: suited(k.pairs), ..k }),
            search: self.search.map(|s| BandwidthSearch { pairs: suited(s.pairs), ..s }),
            waves: self.waves.map(|w| WavePlan { costs: compute.wave_costs(), ..w }),
            ..self
        }
    }

    /// What a simulation for envelopes needs of it.
    pub(super) fn of_simulations(&self) -> Self {
        let neighbors = self.neighbors.clone().map(|n| NeighborPlan { bonds: false, ..n });
        Self {
            classes: None,
            psa: None,
            lags: None,
            rings: None,
            waves: None,
            covariance: None,
            neighbors,
            grid_wanted: false,
            simulations: 0,
            ..self.clone()
        }
    }
}

/// The number of simulations asked for, of curves with so many values.
fn simulations(request: &Request, values: u64) -> Result<u64> {
    let Some(simulations) = request.envelope else { return Ok(0) };
    let largest = MAX_SIMULATED / values.max(1) - 1;
    if (1..=largest).contains(&simulations) {
        return Ok(simulations);
    }
    let reason = format!("expected 1 to {largest} simulations of {values} values each");
    Err(Error::setting(Setting::Envelope, simulations, reason))
}

/// K counts from 0 on, and L compares it with balls.
fn check_bins_of_k(request: &Request, bins: &RadialBins, domain: &Domain) -> Result<()> {
    let first = bins.edges()[0];
    if first > 0.0 {
        let reason = format!("K counts all pairs closer than r: bins must start at 0, not at {first}");
        return Err(match &request.edges {
            Some(path) => Error::setting(Setting::Edges, path.display(), reason),
            None => Error::setting(Setting::BinScale, "log", reason),
        });
    }
    let limit = domain.shortest_side() / 2.0;
    if request.beyond_half && bins.r_max() > limit {
        let reason =
            format!("K and L compare with whole balls, which fit up to r = {limit}; expected `stats` pcf alone");
        return Err(Error::setting(Setting::BeyondHalf, "(given)", reason));
    }
    Ok(())
}

/// Whether the realizations hold enough points for pairs, or for anything.
pub(super) fn check_points(pairs: bool, shape: EnsembleShape) -> Result<()> {
    let reason = match shape.max_points {
        0 => "no realization has any points; nothing can be measured",
        1 if pairs => {
            "pcf, pcf-vector, k-function and neighbors need a realization of at least 2 points, the largest has 1; `stats` spectrum works with 1"
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
        if let Some(search) = &self.search {
            write!(f, "{search}")?;
        }
        if let Some(kernel) = &self.kernel {
            write!(f, "{kernel}")?;
        }
        if let Some(classes) = &self.classes {
            write!(f, "{classes}")?;
        }
        if let Some(lags) = &self.lags {
            write!(f, "{lags}")?;
        }
        if let Some(rings) = &self.rings {
            write!(f, "along rings: {rings}")?;
        }
        if let Some(waves) = &self.waves {
            write!(f, "{waves}")?;
        }
        if let Some(covariance) = &self.covariance {
            write!(f, "{covariance}")?;
        }
        if let Some(psa) = &self.psa {
            write!(f, "for PSA's effective Nyquist frequency and oscillation: {psa}")?;
        }
        if let Some(neighbors) = &self.neighbors {
            write!(f, "{neighbors}")?;
        }
        if self.simulations > 0 {
            let n = self.simulations;
            writeln!(f, "envelope: {n} simulations of complete spatial randomness, each with all the pairs above")?;
        }
        let skipped = [
            (!self.pcf, "pcf"),
            (self.lags.is_none(), "pcf-vector"),
            (self.pairs.as_ref().is_none_or(|p| !p.cumulative), "k-function"),
            (self.waves.is_none(), "spectrum"),
            (self.covariance.is_none(), "covariance"),
            (self.neighbors.is_none(), "neighbors"),
        ];
        for (_, name) in skipped.iter().filter(|(skipped, _)| *skipped) {
            writeln!(f, "skipped: {name} (not asked for)")?;
        }
        writeln!(f, "together: {} realizations at a time", self.batch)
    }
}

/// The wave vectors a request asks for, with tapers, rings and sectors.
fn waves(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<WavePlan> {
    let frequencies = match (request.max_frequency.as_deref(), request.convention.max_frequency(shape.max_points)) {
        (Some([f]), _) => vec![*f; domain.dim()],
        (Some(each), _) => each.to_vec(),
        (None, Some(f)) => vec![f; domain.dim()],
        (None, None) => WaveGrid::default_max_frequency(shape.mean_points, domain),
    };
    let waves = match (&request.frequencies, request.ring_directions) {
        (Some(path), _) => read_frequencies(path, domain)?.into(),
        // In 1D a ring is a pair of opposite wave vectors: any number of directions is all of them.
        (None, Some(n)) if n == 0 || domain.dim() > 1 => WaveList::ring_directions(domain, &frequencies, n)?.into(),
        (None, _) => WaveVectors::from(WaveGrid::new(&frequencies)?),
    };
    // Directions of what is not 2D are refused, in their own words; rings of others have none.
    let all_directions = domain.dim() == 2 && waves.grid().is_some() && request.convention == Convention::Ours;
    let sectors = request.sectors.or(all_directions.then_some(DEFAULT_SECTORS));
    let plan = WavePlan::new(domain, waves, request.accuracy, shape)?
        .with_taper(taper(request, domain)?)
        .with_convention(request.convention, request.bug_compatible)?;
    match sectors {
        Some(count) => plan.with_sectors(count),
        None => Ok(plan),
    }
}

/// Frequencies as typed.
pub(super) fn axes(frequencies: &[u32]) -> String {
    numbers(frequencies.iter().map(|&f| f64::from(f)))
}

/// The lags a request asks for. Corrections that are only for g(r) are left to it.
fn lags(request: &Request, domain: &Domain, correction: Correction, shape: EnsembleShape) -> Result<LagPlan> {
    let grid = LagGrid::new(domain, request.lag_bins.unwrap_or(64), request.lag_max)?;
    let correction = match correction {
        Correction::Isotropic | Correction::Border if request.stats.contains(&Statistic::Pcf) => {
            Correction::Translation
        }
        other => other,
    };
    // Rings have a grid of their own.
    LagPlan::new(domain, grid, correction, (domain.dim() == 2).then_some(&[]), shape)
}

/// The rings along which g of the vector is followed, in 2D: by default at half, 1 and 2 closest-packing distances, as far as
/// they fit. Their cells are so small that g hardly changes within one, and the grid ends beyond the largest.
fn rings(request: &Request, lags: &LagPlan) -> Result<Option<LagPlan>> {
    let (domain, shape) = (&lags.domain, lags.shape);
    let limit = domain.shortest_side() / if domain.is_torus() { 2.0 } else { 1.0 };
    let radii = match &request.lag_rings {
        None if domain.dim() != 2 => return Ok(None),
        // Refused, in its own words.
        Some(radii) if domain.dim() != 2 => {
            return LagPlan::new(domain, lags.grid.clone(), lags.correction, Some(radii), shape).map(Some);
        }
        Some(radii) => radii.clone(),
        None => {
            let unit = domain.closest_packing_distance(shape.mean_points);
            DEFAULT_RINGS.map(|k| k * unit).into_iter().filter(|r| 1.02 * r < limit).collect()
        }
    };
    let largest = radii.iter().copied().fold(0.0, f64::max);
    if radii.is_empty() {
        return Ok(None);
    }
    let half = if largest > 0.0 { (1.02 * largest).min(limit) } else { limit };
    let grid = LagGrid::new(domain, RING_GRID, Some(half))?;
    LagPlan::new(domain, grid, lags.correction, Some(&radii), shape).map(Some)
}

/// The distances from which PSA takes its statistics of the spectrum, unless they are too many for its cubic sums.
fn psa_pairs(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<Option<PairPlan>> {
    let bins = PsaStatistics::bins(shape.max_points);
    let few = bins <= MAX_PSA_BINS && bins as u64 * shape.realizations <= MAX_SIMULATED;
    if request.convention != Convention::Psa || shape.max_points < 2 || !few {
        return Ok(None);
    }
    let bins = RadialBins::linear(domain.shortest_side() / 2.0, bins)?;
    PairPlan::new(domain, bins, Correction::None, shape).map(Some)
}

/// The tapers a request asks for.
fn taper(request: &Request, domain: &Domain) -> Result<TaperPlan> {
    let given = SETTINGS.iter().find(|row| row.group == Group::Tapers && row.is_given(request));
    if let Some(row) = given.filter(|_| domain.is_torus()) {
        let reason = "is about a window; a torus cuts nothing off";
        return Err(Error::setting(row.setting, request.value(row.setting), reason));
    }
    let (kind, debias) = (request.taper.unwrap_or_default(), request.debias.unwrap_or_default());
    TaperPlan::new(kind, request.tapers, debias, domain.dim())
}

/// Whether the program of a convention could have done what is asked for.
pub(super) fn check_convention(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<()> {
    request.convention.check(domain, request.bug_compatible)?;
    if request.convention == Convention::Ours {
        return Ok(());
    }
    let name = request.convention.to_string();
    if (shape.max_points as f64) > shape.mean_points {
        let reason = format!(
            "needs as many points in every realization; they have {} on average and up to {}",
            number(shape.mean_points),
            shape.max_points
        );
        return Err(Error::setting(Setting::Convention, name, reason));
    }
    refuse_unknown_to_convention(request)
}

/// The bins a request asks for.
fn bins(request: &Request, domain: &Domain, mean_points: f64) -> Result<RadialBins> {
    if let Some((bins, width)) = request.convention.pair_bins(mean_points as u64) {
        let width = width * domain.shortest_side();
        if bins == 0 {
            let reason = "has n/8 bins of g, so that it needs at least 8 points";
            return Err(Error::setting(Setting::Convention, request.convention, reason));
        }
        // Beyond half the diagonal of a torus there are no pairs.
        let edges = (0..=bins).map(|k| k as f64 * width);
        return RadialBins::from_edges(edges.take_while(|&r| r <= domain.half_diagonal()).collect());
    }
    if let Some(path) = &request.edges {
        // What is wrong with them is wrong in that file.
        return RadialBins::from_edges(read_edges(path)?).map_err(|e| e.in_file(Setting::Edges, path));
    }
    let mut default = PairPlan::default_r_max(domain, mean_points);
    if request.correction == Some(Correction::Border) {
        // Enough points must be that far from the border.
        default = default.min(domain.shortest_side() / 4.0);
    }
    let r_max = request.r_max.unwrap_or(default);
    // Written so that NaN fails.
    if !(r_max > 0.0 && r_max.is_finite()) {
        return Err(Error::setting(Setting::RMax, number(r_max), "expected a finite number above 0"));
    }
    let bins = request.bins.unwrap_or(256);
    match request.bin_scale.unwrap_or(BinScale::Linear) {
        BinScale::Log => RadialBins::logarithmic(r_max * 1e-3, r_max, bins),
        BinScale::Linear | BinScale::Given => RadialBins::linear(r_max, bins),
    }
}

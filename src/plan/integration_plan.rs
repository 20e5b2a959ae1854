//! The plan for integration errors: which frequencies, which lags, which shifts.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::{
    Accuracy, Batch, Correction, EnsembleShape, MAX_FREQUENCY, PairPlan, RadialBins, Removal, WaveGrid, WavePlan,
};
use crate::error::{Error, Result};
use crate::integrand::{Density, Integrand, gauss, nonnegative};
use crate::memory::Memory;
use crate::named::named;
use crate::points::Domain;
use crate::samplers::Process;
use crate::setting::Setting;

/// What estimates the integral.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Estimator {
    /// The mean of f over the points of a realization, each of which has as many.
    Mean,
    /// The same where their number is random.
    Ratio,
    /// The sum of f over the points, over the expected number of points; of points with weights the sum of w f.
    Lambda,
    /// Of points with weights 1/lambda the sum of w f, times the expected number of points over theirs.
    CountRatio,
}

named!(Estimator: Mean = "mean", Ratio = "ratio", Lambda = "lambda", CountRatio = "count-ratio");

impl Estimator {
    /// Whether it is over a random number: of points, or of their weights.
    pub fn is_ratio(self) -> bool {
        matches!(self, Self::Ratio | Self::CountRatio)
    }
}

/// How points are placed by a density that is no constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum By {
    /// Points of a parent are kept at random, where the density is low seldom.
    Removal,
    /// Points are mapped by the inverse of its distribution function.
    Warp,
    /// Points are added where the density is high: refused.
    Add,
}

named!(By: Removal = "removal", Warp = "warp", Add = "add");

/// How points come by a density that is no constant.
#[derive(Debug, Clone)]
pub enum Importance {
    /// They are as dense as this, per box: each weighs one over it.
    Known(Integrand),
    /// Those at hand are parents, of which some are kept.
    Removal(Removal),
    /// Those at hand are mapped to it, and integrands are functions of where they were before.
    Warp(Density),
}

/// How the sum over pairs of points is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairSum {
    /// a of every lag.
    Exact,
    /// Pairs are shared among the 2^d nodes around their lag, so many nodes per side.
    Deposit(usize),
    /// Pairs are counted by distance up to half a side, so many bins, and a is averaged over directions: right where points or f are isotropic.
    Radial(usize),
    /// Not at all: too many pairs.
    None,
}

/// How it is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Spatial {
    /// Every pair at its own lag.
    Pairs,
    /// Pairs deposited on a grid of lags.
    Deposit,
    /// Pairs counted by distance: g(r) up to half a side, the others by their number.
    Radial,
    /// Not at all.
    None,
}

named!(Spatial: Pairs = "pairs", Deposit = "deposit", Radial = "radial", None = "none");

/// Values of a that are computed one by one, at most: a few seconds.
const EXACT_BUDGET: f64 = 1e8;

/// Pairs that are deposited, at most: minutes.
const DEPOSIT_BUDGET: f64 = 1e12;

/// Pairs that are counted by distance, at most: the better part of an hour.
const RADIAL_BUDGET: f64 = 1e13;

/// Bins of distances up to half a side, by dimension: what they add in noise falls with n, on a line slowest.
const DISTANCES: [usize; 3] = [1 << 14, 1024, 1024];

/// Everything decided about integration errors before any point is looked at.
#[derive(Debug, Clone)]
pub struct IntegrationPlan {
    /// The domain, a torus.
    pub domain: Domain,
    /// What is integrated.
    pub integrands: Arc<[Integrand]>,
    /// What the points at hand average: the same, but for parents of a ratio by counts.
    pub averaged: Arc<[Integrand]>,
    /// How points come by a density, if by one.
    pub importance: Option<Importance>,
    /// Whether each point has a weight.
    pub weighted: bool,
    /// The estimator.
    pub estimator: Estimator,
    /// All frequencies `|m_k| <= F_k`.
    pub grid: WavePlan,
    /// Along each axis alone, those up to M.
    pub axes: Vec<WavePlan>,
    /// The largest frequencies along each axis that were asked for, where the grid has been cut to those that integrands have.
    pub asked: Vec<u32>,
    /// Frequencies of the truncated phase term.
    pub low: WaveGrid,
    /// Shifts of the torus, beside the random one of each realization: points of a lattice.
    pub shifts: Arc<Vec<f64>>,
    /// How pairs are summed.
    pub pairs: PairSum,
    /// How they are counted by distance, where they are.
    pub distances: Option<PairPlan>,
    /// Frequencies that are named, of those that add most, if it is said how many.
    pub top: Option<u32>,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Realizations worked on at a time.
    pub batch: Batch,
    /// What is known of each integrand at these frequencies and lags.
    pub(crate) tables: Arc<[IntegrandTable]>,
}

/// A coefficient is 0 where it is less than this times the root of the integral of f^2: less than what a mean of f is rounded by.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// Of one integrand.
#[derive(Debug)]
pub(crate) struct IntegrandTable {
    /// `|f_m|^2` times the modes that a stored one stands for, in the order of the grid; 0 at m = 0.
    pub(crate) grid: Vec<f64>,
    /// The same along each axis, 0 within the grid.
    pub(crate) axes: Vec<Vec<f64>>,
    /// `f_m` of the low frequencies, as stored.
    pub(crate) low: Vec<Complex<f64>>,
    /// `a - I^2` at the nodes of lags, extrapolated from two spacings, of mean 0; its means over
    /// distances and over those beyond half a side, where pairs are counted by distance; empty where pairs are not summed.
    pub(crate) nodes: Vec<f64>,
}

/// What a request says of integration.
#[derive(Debug, Clone, Copy)]
pub struct IntegrationSettings<'a> {
    /// Specifications of integrands.
    pub integrands: &'a [String],
    /// The estimator, if one is asked for.
    pub estimator: Option<Estimator>,
    /// Number of shifts.
    pub shifts: u32,
    /// How the spatial form is summed, if it is said.
    pub spatial: Option<Spatial>,
    /// Frequencies that are named, of those that add most, if it is said how many.
    pub top: Option<u32>,
    /// The specification of the density that points are placed by.
    pub intensity: Option<&'a str>,
    /// How they are.
    pub by: Option<By>,
    /// Whether each point has a weight.
    pub weighted: bool,
    /// The largest frequencies, if they are asked for.
    pub max_frequency: Option<&'a [u32]>,
    /// Largest low frequency of the truncated phase term.
    pub low_frequency: Option<u32>,
    /// The promise about P.
    pub accuracy: Accuracy,
    /// What sums may take.
    pub memory: Memory,
    /// Whether every realization is known to have as many points.
    pub equal: bool,
}

impl IntegrationPlan {
    /// Decides.
    ///
    /// # Errors
    /// Integrands that cannot be; a window, in which nothing wraps; frequencies that are no frequencies.
    pub fn new(domain: &Domain, settings: IntegrationSettings<'_>, shape: EnsembleShape) -> Result<Self> {
        if !domain.is_torus() {
            let reason = "predicts for shifts of a torus; `sides` gives the sides of one, and a window has none";
            return Err(Error::setting(Setting::Integrand, settings.integrands.join(" "), reason));
        }
        let dim = domain.dim();
        let integrands: Vec<Integrand> =
            settings.integrands.iter().map(|spec| Integrand::new(spec, dim)).collect::<Result<_>>()?;
        if let Some(twice) =
            (1..integrands.len()).find(|&k| integrands[..k].iter().any(|i| i.spec() == integrands[k].spec()))
        {
            return Err(Error::setting(Setting::Integrand, integrands[twice].spec(), "is given twice"));
        }
        let weighted = settings.weighted || settings.intensity.is_some() && settings.by.is_none();
        let estimator = estimator(&settings, weighted)?;
        if settings.shifts == 0 || settings.shifts > 1 << 16 {
            return Err(Error::setting(Setting::Shifts, settings.shifts, "expected 1 to 65536"));
        }
        let importance = Importance::new(&settings, dim, &integrands, estimator)?;
        let integrands = match &importance {
            Some(Importance::Warp(density)) => integrands.iter().map(|f| f.warped(density)).collect::<Result<_>>()?,
            _ => integrands,
        };
        let averaged: Vec<Integrand> = match &importance {
            // To first order f - I p, p the density over its integral, has the variance of the ratio.
            Some(Importance::Removal(removal)) if estimator == Estimator::CountRatio => {
                let scale = |f: &Integrand| f.integral() / removal.density.integral();
                integrands.par_iter().map(|f| f.less(&removal.density, scale(f))).collect()
            }
            _ => integrands.clone(),
        };
        let frequencies = match settings.max_frequency {
            Some(&[f]) => vec![f; dim],
            Some(each) => each.to_vec(),
            None => {
                // Tables of integrands beside the sums.
                let share = settings.memory.0 / (2 + integrands.len() as u64 / 4);
                WaveGrid::default_max_frequency(shape.mean_points, domain, Memory(share))
            }
        };
        let grid =
            WavePlan::new(domain, WaveGrid::new(&frequencies)?, settings.accuracy, shape)?.within(settings.memory);
        let reach = (4.0 * shape.max_points as f64).clamp(1.0, f64::from(MAX_FREQUENCY)) as u32;
        let axis = |a: usize| {
            let line = Domain::torus(&[domain.sides()[a]])?;
            let reach = if dim == 1 { frequencies[a] } else { reach.max(frequencies[a]) };
            Ok(WavePlan::new(&line, WaveGrid::new(&[reach])?, settings.accuracy, shape)?.within(settings.memory))
        };
        // In 1D the grid is the axis.
        let axes = (0..if dim == 1 { 0 } else { dim }).map(axis).collect::<Result<Vec<_>>>()?;
        let low = WaveGrid::new(&vec![settings.low_frequency.unwrap_or([64, 8, 2][dim - 1]); dim])?;
        let pairs_in_all = shape.realizations as f64 * shape.mean_points.powi(2) / 2.0;
        // a of a difference is not known well enough.
        let unknown = matches!(importance, Some(Importance::Removal(_))) && estimator == Estimator::CountRatio;
        // Distances in a box of unequal sides are not those in which a is averaged; weights have their own sums of pairs.
        let is_round = domain.is_cubic() && !weighted;
        let pairs = match settings.spatial {
            _ if unknown => PairSum::None,
            Some(Spatial::Pairs) => PairSum::Exact,
            Some(Spatial::Deposit) => PairSum::Deposit(nodes_per_side(dim)),
            Some(Spatial::Radial) if !is_round => {
                let reason = "is for a box of equal sides and points without weights; expected pairs, deposit or none";
                return Err(Error::setting(Setting::Spatial, Spatial::Radial, reason));
            }
            Some(Spatial::Radial) => PairSum::Radial(DISTANCES[dim - 1]),
            Some(Spatial::None) => PairSum::None,
            None if pairs_in_all * integrands.len() as f64 <= EXACT_BUDGET => PairSum::Exact,
            None if pairs_in_all <= DEPOSIT_BUDGET => PairSum::Deposit(nodes_per_side(dim)),
            None if pairs_in_all <= RADIAL_BUDGET && is_round => PairSum::Radial(DISTANCES[dim - 1]),
            None => PairSum::None,
        };
        let distances = match pairs {
            PairSum::Radial(bins) => Some(distances(dim, bins, shape)?),
            _ => None,
        };
        let shifts = lattice(settings.shifts, dim)?;
        let tables = averaged.par_iter().map(|i| IntegrandTable::new(i, &grid, &axes, &low, pairs)).collect::<Vec<_>>();
        let batch = Batch::new(shape, shape.max_points * 72 + grid.waves.len() as u64 * 8);
        Ok(Self {
            domain: domain.clone(),
            integrands: integrands.into(),
            averaged: averaged.into(),
            importance,
            weighted,
            estimator,
            grid,
            axes,
            asked: frequencies,
            low,
            shifts: Arc::new(shifts),
            pairs,
            distances,
            top: settings.top,
            shape,
            batch,
            tables: tables.into(),
        })
    }

    /// Without the frequencies at which no integrand has a coefficient: the grid and the axes end where the last of them is, and what is 0 between
    /// is not wanted. Nothing that is summed changes.
    ///
    /// # Errors
    /// None that a plan does not have itself.
    pub fn narrowed(self) -> Result<Self> {
        let Some(whole) = self.grid.waves.grid().copied() else { return Ok(self) };
        let dim = whole.dim();
        let any = |of: &dyn Fn(&IntegrandTable) -> bool| self.tables.iter().any(of);
        let mut last = [0; 3];
        for index in (0..whole.half_len()).filter(|&index| any(&|table| table.grid[index] != 0.0)) {
            last.iter_mut().zip(whole.mode(index)).for_each(|(last, m)| *last = m.unsigned_abs().max(*last));
        }
        // A grid without any frequency is none.
        last[0] = last[0].max(1);
        let part = WaveGrid::new(&last[..dim])?;
        let from: Vec<usize> = (0..part.half_len()).map(|index| whole.half_index(part.mode(index))).collect();
        // An axis has its own where they go on beyond those of the grid.
        let along: Vec<usize> = (0..self.axes.len())
            .map(|a| {
                self.tables.iter().filter_map(|table| table.axes[a].iter().rposition(|f| *f != 0.0)).max().unwrap_or(1)
            })
            .collect();
        let cut = |table: &IntegrandTable| IntegrandTable {
            grid: from.iter().map(|&index| table.grid[index]).collect(),
            axes: table.axes.iter().zip(&along).map(|(axis, &last)| axis[..=last].to_vec()).collect(),
            low: table.low.clone(),
            nodes: table.nodes.clone(),
        };
        let tables: Vec<IntegrandTable> = self.tables.iter().map(cut).collect();
        let wanted: Vec<u32> =
            (0..part.half_len()).map(|index| u32::from(tables.iter().any(|table| table.grid[index] != 0.0))).collect();
        let narrow = |plan: &WavePlan, last: &[u32]| -> Result<WavePlan> {
            let grid = WaveGrid::new(last)?;
            Ok(WavePlan {
                costs: plan.costs,
                ..WavePlan::new(&plan.domain, grid, plan.accuracy, plan.shape)?.within(plan.memory)
            })
        };
        let grid = narrow(&self.grid, &last[..dim])?;
        let all = wanted.iter().enumerate().all(|(index, &wanted)| wanted > 0 || index == part.dc());
        let grid = WavePlan { wanted: (!all).then(|| wanted.into()), ..grid };
        let axes =
            self.axes.iter().zip(&along).map(|(plan, &last)| narrow(plan, &[last as u32])).collect::<Result<_>>()?;
        Ok(Self { grid, axes, tables: tables.into(), ..self })
    }

    /// The same where pairs are deposited, however few they are.
    #[doc(hidden)]
    #[must_use]
    pub fn with_deposit(self) -> Self {
        Self { pairs: PairSum::Deposit(nodes_per_side(self.domain.dim())), ..self }
    }

    /// Nodes of lags per side that pairs are deposited on, be it only to say at which lags variance comes from; `None` where there are no pairs.
    pub fn lag_nodes(&self) -> Option<usize> {
        matches!(self.pairs, PairSum::Exact | PairSum::Deposit(_)).then(|| nodes_per_side(self.domain.dim()))
    }

    /// How many lags a node stands for: itself and its opposite, which is not among those that pairs are deposited on but at 0 and half a side.
    pub(crate) fn lag_multiplicity(&self, node: usize) -> f64 {
        let side = nodes_per_side(self.domain.dim());
        let last = node / side.pow(self.domain.dim() as u32 - 1);
        if last == 0 || last == side / 2 { 1.0 } else { 2.0 }
    }

    /// The removal, if points are kept at random.
    pub fn removal(&self) -> Option<&Removal> {
        match &self.importance {
            Some(Importance::Removal(removal)) => Some(removal),
            _ => None,
        }
    }

    /// The largest frequencies along each axis.
    pub fn max_frequency(&self) -> &[u32] {
        self.grid.waves.grid().map_or(&[], WaveGrid::max_frequency_of_axes)
    }

    /// The largest frequency along an axis alone.
    pub fn axis_frequency(&self) -> u32 {
        let largest = |plan: &WavePlan| plan.waves.grid().map_or(0, |grid| grid.max_frequency()[0]);
        self.axes.iter().map(largest).max().unwrap_or_else(|| largest(&self.grid))
    }

    /// Estimated seconds of one thread for a realization of `n` points.
    pub fn seconds(&self, n: f64) -> f64 {
        let many = self.integrands.len() as f64;
        let pairs = match self.pairs {
            PairSum::Exact => 1e-8 * many,
            PairSum::Deposit(_) => 3e-9,
            PairSum::Radial(_) => 5e-10,
            PairSum::None => 0.0,
        };
        let shifts = self.shifts.len() as f64 / self.domain.dim() as f64;
        let waves: f64 = self.axes.iter().chain([&self.grid]).map(|plan| plan.seconds(n)).sum();
        waves + pairs * n * n / 2.0 + 1e-8 * many * n * (1.0 + shifts) + 1e-9 * many * self.grid.waves.len() as f64
    }
}

/// The estimator asked for, or the usual one, if it can be.
fn estimator(settings: &IntegrationSettings<'_>, weighted: bool) -> Result<Estimator> {
    let wrong = |estimator: Estimator, reason: &str| Err(Error::setting(Setting::Estimator, estimator, reason));
    match settings.estimator {
        None if weighted => Ok(Estimator::Lambda),
        None if settings.equal => Ok(Estimator::Mean),
        None => Ok(Estimator::Lambda),
        Some(Estimator::Mean) if !settings.equal => {
            wrong(Estimator::Mean, "needs as many points in every realization; expected ratio or lambda")
        }
        Some(Estimator::CountRatio) if !weighted && settings.by != Some(By::Removal) => wrong(
            Estimator::CountRatio,
            "is for points with weights; expected `weight_column` or `intensity` beside it, or ratio",
        ),
        Some(ratio) if ratio.is_ratio() && settings.by == Some(By::Warp) => {
            wrong(ratio, "has no part in a warp, whose densities are known; expected mean or lambda")
        }
        Some(estimator) => Ok(estimator),
    }
}

impl Importance {
    /// The specification of the density.
    pub fn density(&self) -> &str {
        match self {
            Self::Known(density) => density.spec(),
            Self::Removal(removal) => removal.density.spec(),
            Self::Warp(density) => density.spec(),
        }
    }

    /// How points come by it; `None` where they are said to have it.
    pub fn by(&self) -> Option<By> {
        match self {
            Self::Known(_) => None,
            Self::Removal(_) => Some(By::Removal),
            Self::Warp(_) => Some(By::Warp),
        }
    }

    fn new(
        settings: &IntegrationSettings<'_>,
        dim: usize,
        integrands: &[Integrand],
        estimator: Estimator,
    ) -> Result<Option<Self>> {
        let Some(spec) = settings.intensity else {
            return match settings.by {
                None => Ok(None),
                Some(by) => {
                    let reason = "needs `intensity`, the density that points are placed by";
                    Err(Error::setting(Setting::By, by, reason))
                }
            };
        };
        if settings.weighted {
            let reason = "gives every point its weight; `weight_column` does too: expected one of them";
            return Err(Error::setting(Setting::Intensity, spec, reason));
        }
        match settings.by {
            None => Ok(Some(Self::Known(nonnegative(spec, dim)?.0))),
            Some(By::Removal) => Ok(Some(Self::Removal(Removal::new(spec, dim, integrands, estimator)?))),
            Some(By::Warp) => Ok(Some(Self::Warp(Density::new(spec, dim)?))),
            Some(By::Add) => {
                let reason = "points added to others have another g than these: what is predicted from it would be wrong, even below 0; expected removal, from a parent as dense as the largest value";
                Err(Error::setting(Setting::By, By::Add, reason))
            }
        }
    }
}

impl PartialEq for IntegrationPlan {
    fn eq(&self, other: &Self) -> bool {
        // All else follows from these, but for how many shifts there are.
        let specs = |plan: &Self| plan.integrands.iter().map(|i| i.spec().to_string()).collect::<Vec<_>>();
        let importance = |plan: &Self| plan.importance.as_ref().map(|i| (i.by(), i.density().to_string()));
        specs(self) == specs(other)
            && importance(self) == importance(other)
            && (self.weighted, self.top) == (other.weighted, other.top)
            && self.asked == other.asked
            && (&self.domain, self.estimator, &self.grid, &self.axes, self.low, self.pairs, self.shape, self.batch)
                == (
                    &other.domain,
                    other.estimator,
                    &other.grid,
                    &other.axes,
                    other.low,
                    other.pairs,
                    other.shape,
                    other.batch,
                )
            && self.shifts == other.shifts
    }
}

/// Nodes of lags per side: as many as the nearest memory of a processor holds.
fn nodes_per_side(dim: usize) -> usize {
    [1 << 14, 256, 64][dim - 1]
}

/// Nodes of a grid of lags whose last component is at most half a side: of a lag and its opposite one is among them.
pub(crate) fn half_of_lags(nodes: usize, dim: usize) -> usize {
    nodes.pow(dim as u32 - 1) * (nodes / 2 + 1)
}

/// So many points of a rank-1 lattice, coordinate by coordinate.
fn lattice(count: u32, dim: usize) -> Result<Vec<f64>> {
    if dim == 1 || count < 2 {
        return Ok((0..count).flat_map(|k| vec![f64::from(k) / f64::from(count); dim]).collect());
    }
    Process::new("lattice", count.into(), 1, dim, 1, &["shift=none"])?
        .coordinates(0, &crate::control::Control::default())
}

impl IntegrandTable {
    fn new(integrand: &Integrand, grid: &WavePlan, axes: &[WavePlan], low: &WaveGrid, pairs: PairSum) -> Self {
        let dim = integrand.dim();
        let Some(waves) = grid.waves.grid() else {
            return Self { grid: Vec::new(), axes: Vec::new(), low: Vec::new(), nodes: Vec::new() };
        };
        let frequencies = waves.max_frequency();
        let all = integrand.coefficients(&frequencies[..dim]);
        // The stored half follows DC.
        let stored = &all[waves.full_len() / 2 - waves.dc()..];
        let least = ROUNDING.powi(2) * (integrand.variance() + integrand.integral().powi(2));
        let square = |f: Complex<f64>| if f.norm_sqr() <= least { 0.0 } else { f.norm_sqr() };
        let stands_for = |(index, f): (usize, &Complex<f64>)| {
            if index == waves.dc() { 0.0 } else { f64::from(waves.multiplicity(index)) * square(*f) }
        };
        let squares = stored.iter().enumerate().map(stands_for).collect();
        let on_axis = |(a, plan): (usize, &WavePlan)| {
            let reach = plan.waves.grid().map_or(0, |grid| grid.max_frequency()[0]);
            let at = |m: u32| {
                let mut vector = [0; 3];
                vector[a] = m as i32;
                if m <= frequencies[a] { 0.0 } else { 2.0 * square(integrand.coefficient(&vector[..dim])) }
            };
            (0..=reach).map(at).collect()
        };
        let low_modes = (0..low.half_len()).map(|index| integrand.coefficient(&low.mode(index)[..dim])).collect();
        let nodes = match pairs {
            PairSum::Exact | PairSum::Deposit(_) => nodes(integrand, nodes_per_side(dim)),
            PairSum::Radial(bins) => shells(integrand, bins),
            PairSum::None => Vec::new(),
        };
        Self { grid: squares, axes: axes.iter().enumerate().map(on_axis).collect(), low: low_modes, nodes }
    }
}

/// `(4 b - b_2) / 3` at the nodes of a lag grid with so many per side, `b = a - I^2` and `b_2` interpolated between every other node: a sum
/// with it over deposited pairs is extrapolated to no spacing at all. x fastest.
fn nodes(integrand: &Integrand, cells: usize) -> Vec<f64> {
    let dim = integrand.dim();
    let len = cells.pow(dim as u32);
    let lag = |index: usize| -> [f64; 3] {
        std::array::from_fn(|a| if a < dim { (index / cells.pow(a as u32) % cells) as f64 / cells as f64 } else { 0.0 })
    };
    let mut values = vec![0.0; len];
    let chunk = 4096;
    values.par_chunks_mut(chunk).enumerate().for_each(|(k, out)| {
        let lags: Vec<[f64; 3]> = (k * chunk..k * chunk + out.len()).map(lag).collect();
        integrand.autocorrelations(&lags, out);
    });
    let square = integrand.integral() * integrand.integral();
    values.iter_mut().for_each(|a| *a -= square);
    let coarse = |index: usize| {
        let mut sum = 0.0;
        // Odd along some axes: the mean of the even neighbours along these.
        let places: [usize; 3] = std::array::from_fn(|a| if a < dim { index / cells.pow(a as u32) % cells } else { 0 });
        let odd: Vec<usize> = (0..dim).filter(|&a| places[a] % 2 == 1).collect();
        for corner in 0..1usize << odd.len() {
            let mut at = places;
            for (bit, &a) in odd.iter().enumerate() {
                at[a] = if corner >> bit & 1 == 0 { at[a] - 1 } else { (at[a] + 1) % cells };
            }
            sum += values[(0..dim).map(|a| at[a] * cells.pow(a as u32)).sum::<usize>()];
        }
        sum / (1usize << odd.len()) as f64
    };
    let mut nodes: Vec<f64> =
        (0..len).into_par_iter().map(|index| (4.0 * values[index] - coarse(index)) / 3.0).collect();
    // The integral of b is 0. Where a bends between nodes that of what is interpolated is not, which all pairs at lags of g = 1 would add.
    let mean = nodes.iter().sum::<f64>() / len as f64;
    nodes.truncate(half_of_lags(cells, dim));
    nodes.iter_mut().for_each(|b| *b -= mean);
    nodes
}

/// Counts of pairs by distance up to half a side of the unit torus.
fn distances(dim: usize, bins: usize, shape: EnsembleShape) -> Result<PairPlan> {
    PairPlan::new(&Domain::torus(&vec![1.0; dim])?, RadialBins::linear(0.5, bins)?, Correction::None, shape)
}

/// Means of `a - I^2` over shells of lags, then over all lags beyond half a side: those follow, since its integral is 0.
fn shells(integrand: &Integrand, bins: usize) -> Vec<f64> {
    let dim = integrand.dim();
    let width = 0.5 / bins as f64;
    let square = integrand.integral() * integrand.integral();
    // Three places in r, as many directions as a bends in.
    let places = gauss(3);
    let directions: Vec<[f64; 3]> = match dim {
        1 => vec![[1.0, 0.0, 0.0]],
        2 => (0..128)
            .map(|k| (std::f64::consts::PI * (k as f64 + 0.5) / 128.0).sin_cos())
            .map(|(y, x)| [x, y, 0.0])
            .collect(),
        // a is even: half of the sphere, equal areas, by the golden angle.
        _ => (0..512)
            .map(|k| {
                let z = (k as f64 + 0.5) / 512.0;
                let (sin, cos) = (std::f64::consts::PI * (3.0 - 5f64.sqrt()) * k as f64).sin_cos();
                let rho = (1.0 - z * z).sqrt();
                [rho * cos, rho * sin, z]
            })
            .collect(),
    };
    let shell = |bin: usize| {
        let (mut sum, mut weights) = (0.0, 0.0);
        let (mut lags, mut values) = (vec![[0.0; 3]; directions.len()], vec![0.0; directions.len()]);
        for (place, weight) in &places {
            let r = (bin as f64 + 0.5 * (1.0 + place)) * width;
            lags.iter_mut().zip(&directions).for_each(|(lag, way)| *lag = way.map(|w| w * r));
            integrand.autocorrelations(&lags, &mut values);
            let weight = weight * r.powi(dim as i32 - 1);
            sum += weight * values.iter().map(|a| a - square).sum::<f64>() / values.len() as f64;
            weights += weight;
        }
        sum / weights
    };
    let mut means: Vec<f64> = (0..bins).into_par_iter().map(shell).collect();
    let measure = |k: usize| crate::ball::unit_ball(dim) * (k as f64 * width).powi(dim as i32);
    let inside: f64 = means.iter().enumerate().map(|(k, b)| b * (measure(k + 1) - measure(k))).sum();
    let outside = 1.0 - measure(bins);
    means.push(if outside > 1e-12 { -inside / outside } else { 0.0 });
    means
}

impl fmt::Display for IntegrationPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let many = self.integrands.len();
        let frequencies: Vec<String> = self.max_frequency().iter().map(u32::to_string).collect();
        writeln!(f, "integration: {many} integrands, estimator {}", self.estimator.name())?;
        match &self.importance {
            None if self.weighted => writeln!(f, "  points weigh what they are given")?,
            None => {}
            Some(Importance::Known(density)) => writeln!(f, "  points weigh one over {}", density.spec())?,
            Some(Importance::Removal(removal)) => writeln!(
                f,
                "  removal: {:.4} of the points are kept, by {} over {}",
                removal.kept,
                removal.density.spec(),
                removal.maximum
            )?,
            Some(Importance::Warp(density)) => writeln!(f, "  points: placed by warp, as dense as {}", density.spec())?,
        }
        writeln!(f, "  spectral: |m| <= {}, along axes to {}", frequencies.join(", "), self.axis_frequency())?;
        if let Some(grid) = self.grid.waves.grid() {
            let asked: Vec<String> = self.asked.iter().map(u32::to_string).collect();
            let all = WaveGrid::new(&self.asked).map_or(0, |whole| whole.half_len());
            let summed = self.grid.needed().map_or(grid.half_len(), |needed| needed.iter().filter(|n| **n > 0).count());
            let skipped = all.saturating_sub(summed + usize::from(self.grid.needed().is_some()));
            if skipped > 0 {
                writeln!(
                    f,
                    "  skipped: {skipped} of {all} modes up to {}, at which no integrand has a coefficient",
                    asked.join(", ")
                )?;
            }
        }
        match self.pairs {
            PairSum::Exact => writeln!(f, "  spatial: every pair"),
            PairSum::Deposit(cells) => writeln!(f, "  spatial: pairs deposited on {cells} lags per side, extrapolated"),
            PairSum::Radial(bins) => {
                writeln!(
                    f,
                    "  spatial: pairs counted by distance to half a side, {bins} bins; a is averaged over directions"
                )
            }
            PairSum::None => writeln!(f, "  skipped: the spatial form"),
        }?;
        let shifts = self.shifts.len() / self.domain.dim();
        writeln!(f, "  observed: as is, and at {shifts} shifts of a lattice per realization")
    }
}

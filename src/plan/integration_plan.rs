//! The plan for integration errors: which frequencies, which lags, which shifts.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::{Accuracy, Batch, EnsembleShape, MAX_FREQUENCY, WaveGrid, WavePlan};
use crate::error::{Error, Result};
use crate::integrand::{Density, Integrand};
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
    /// The sum of f over the points, over the expected number of points.
    Lambda,
}

named!(Estimator: Mean = "mean", Ratio = "ratio", Lambda = "lambda");

/// How points are placed by a density that is no constant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum By {
    /// Points of a parent are kept at random, where the density is low seldom.
    Removal,
    /// Points are mapped by the inverse of its distribution function.
    Warp,
}

named!(By: Removal = "removal", Warp = "warp");

/// How the sum over pairs of points is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairSum {
    /// a of every lag.
    Exact,
    /// Pairs are shared among the 2^d nodes around their lag, so many nodes per side.
    Deposit(usize),
    /// Not at all: too many pairs.
    None,
}

/// Values of a that are computed one by one, at most: some seconds.
const EXACT_BUDGET: f64 = 5e8;

/// Pairs that are deposited, at most: minutes.
const DEPOSIT_BUDGET: f64 = 1e12;

/// Everything decided about integration errors before any point is looked at.
#[derive(Debug, Clone)]
pub struct IntegrationPlan {
    /// The domain, a torus.
    pub domain: Domain,
    /// What is integrated.
    pub integrands: Arc<[Integrand]>,
    /// The density that points are placed by, and how; integrands are functions of where they were before.
    pub placed: Option<(Density, By)>,
    /// The estimator.
    pub estimator: Estimator,
    /// All frequencies `|m_k| <= F_k`.
    pub grid: WavePlan,
    /// Along each axis alone, those up to M.
    pub axes: Vec<WavePlan>,
    /// Frequencies of the truncated phase term.
    pub low: WaveGrid,
    /// Shifts of the torus, beside the random one of each realization: points of a lattice.
    pub shifts: Arc<Vec<f64>>,
    /// How pairs are summed.
    pub pairs: PairSum,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Realizations worked on at a time.
    pub batch: Batch,
    /// What is known of each integrand at these frequencies and lags.
    pub(crate) tables: Arc<[IntegrandTable]>,
}

/// Of one integrand.
#[derive(Debug)]
pub(crate) struct IntegrandTable {
    /// `|f_m|^2` times the modes that a stored one stands for, in the order of the grid; 0 at m = 0.
    pub(crate) grid: Vec<f64>,
    /// The same along each axis, 0 within the grid.
    pub(crate) axes: Vec<Vec<f64>>,
    /// `f_m` of the low frequencies, as stored.
    pub(crate) low: Vec<Complex<f64>>,
    /// `a - I^2` at the nodes of lags, extrapolated from two spacings; empty where pairs are not deposited.
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
    /// The specification of the density that points are placed by.
    pub intensity: Option<&'a str>,
    /// How they are.
    pub by: Option<By>,
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
        let estimator = match (settings.estimator, settings.equal) {
            (None, true) => Estimator::Mean,
            (None, false) => Estimator::Lambda,
            (Some(Estimator::Mean), false) => {
                let reason = "needs as many points in every realization; expected ratio or lambda";
                return Err(Error::setting(Setting::Estimator, "mean", reason));
            }
            (Some(estimator), _) => estimator,
        };
        if settings.shifts == 0 || settings.shifts > 1 << 16 {
            return Err(Error::setting(Setting::Shifts, settings.shifts, "expected 1 to 65536"));
        }
        let placed = placed(settings.intensity, settings.by, dim)?;
        let integrands = match &placed {
            Some((density, By::Warp)) => integrands.iter().map(|f| f.warped(density)).collect::<Result<_>>()?,
            _ => integrands,
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
        let pairs = match pairs_in_all {
            pairs if pairs * integrands.len() as f64 <= EXACT_BUDGET => PairSum::Exact,
            pairs if pairs <= DEPOSIT_BUDGET => PairSum::Deposit(nodes_per_side(dim)),
            _ => PairSum::None,
        };
        let shifts = lattice(settings.shifts, dim)?;
        let tables =
            integrands.par_iter().map(|i| IntegrandTable::new(i, &grid, &axes, &low, pairs)).collect::<Vec<_>>();
        let batch = Batch::new(shape, shape.max_points * 72 + grid.waves.len() as u64 * 8);
        Ok(Self {
            domain: domain.clone(),
            integrands: integrands.into(),
            placed,
            estimator,
            grid,
            axes,
            low,
            shifts: Arc::new(shifts),
            pairs,
            shape,
            batch,
            tables: tables.into(),
        })
    }

    /// The same where pairs are deposited, however few they are.
    #[doc(hidden)]
    #[must_use]
    pub fn with_deposit(self) -> Self {
        let cells = nodes_per_side(self.domain.dim());
        let table = |(integrand, table): (&Integrand, &IntegrandTable)| IntegrandTable {
            grid: table.grid.clone(),
            axes: table.axes.clone(),
            low: table.low.clone(),
            nodes: nodes(integrand, cells),
        };
        let tables = self.integrands.iter().zip(self.tables.iter()).map(table).collect();
        Self { pairs: PairSum::Deposit(cells), tables, ..self }
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
            PairSum::None => 0.0,
        };
        let shifts = self.shifts.len() as f64 / self.domain.dim() as f64;
        let waves: f64 = self.axes.iter().chain([&self.grid]).map(|plan| plan.seconds(n)).sum();
        waves + pairs * n * n / 2.0 + 1e-8 * many * n * (1.0 + shifts) + 1e-9 * many * self.grid.waves.len() as f64
    }
}

impl PartialEq for IntegrationPlan {
    fn eq(&self, other: &Self) -> bool {
        // Integrands, shifts and tables follow from these.
        let specs = |plan: &Self| plan.integrands.iter().map(|i| i.spec().to_string()).collect::<Vec<_>>();
        let placed = |plan: &Self| plan.placed.as_ref().map(|(density, by)| (density.spec().to_string(), *by));
        specs(self) == specs(other)
            && placed(self) == placed(other)
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

/// The density that points are placed by, if one is asked for, and how.
fn placed(intensity: Option<&str>, by: Option<By>, dim: usize) -> Result<Option<(Density, By)>> {
    match (intensity, by) {
        (None, None) => Ok(None),
        (None, Some(by)) => {
            Err(Error::setting(Setting::By, by, "needs `intensity`, the density that points are placed by"))
        }
        (Some(spec), None) => {
            let reason = "says how dense points are, not how they are placed; expected `by` removal or warp beside it";
            Err(Error::setting(Setting::Intensity, spec, reason))
        }
        (Some(_), Some(By::Removal)) => {
            Err(Error::setting(Setting::By, By::Removal, "is not there yet; expected warp"))
        }
        (Some(spec), Some(By::Warp)) => Ok(Some((Density::new(spec, dim)?, By::Warp))),
    }
}

/// Nodes of lags per side: as many as the nearest memory of a processor holds.
fn nodes_per_side(dim: usize) -> usize {
    [1 << 14, 256, 64][dim - 1]
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
        let square = |(index, f): (usize, &Complex<f64>)| {
            if index == waves.dc() { 0.0 } else { f64::from(waves.multiplicity(index)) * f.norm_sqr() }
        };
        let squares = stored.iter().enumerate().map(square).collect();
        let on_axis = |(a, plan): (usize, &WavePlan)| {
            let reach = plan.waves.grid().map_or(0, |grid| grid.max_frequency()[0]);
            let at = |m: u32| {
                let mut vector = [0; 3];
                vector[a] = m as i32;
                if m <= frequencies[a] { 0.0 } else { 2.0 * integrand.coefficient(&vector[..dim]).norm_sqr() }
            };
            (0..=reach).map(at).collect()
        };
        let low_modes = (0..low.half_len()).map(|index| integrand.coefficient(&low.mode(index)[..dim])).collect();
        let nodes = match pairs {
            PairSum::Deposit(cells) => nodes(integrand, cells),
            _ => Vec::new(),
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
    (0..len).into_par_iter().map(|index| (4.0 * values[index] - coarse(index)) / 3.0).collect()
}

impl fmt::Display for IntegrationPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let many = self.integrands.len();
        let frequencies: Vec<String> = self.max_frequency().iter().map(u32::to_string).collect();
        writeln!(f, "integration: {many} integrands, estimator {}", self.estimator.name())?;
        if let Some((density, by)) = &self.placed {
            writeln!(f, "  points: placed by {by}, as dense as {}", density.spec())?;
        }
        writeln!(f, "  spectral: |m| <= {}, along axes to {}", frequencies.join(", "), self.axis_frequency())?;
        match self.pairs {
            PairSum::Exact => writeln!(f, "  spatial: every pair"),
            PairSum::Deposit(cells) => writeln!(f, "  spatial: pairs deposited on {cells} lags per side, extrapolated"),
            PairSum::None => writeln!(f, "  skipped: the spatial form, more than {DEPOSIT_BUDGET:.0e} pairs"),
        }?;
        let shifts = self.shifts.len() / self.domain.dim();
        writeln!(f, "  observed: as is, and at {shifts} shifts of a lattice per realization")
    }
}

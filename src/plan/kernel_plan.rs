//! The plan for a kernel estimate.

use std::fmt;

use super::{Correction, Divisor, EnsembleShape, PairPlan, PairSettings, RadialBins, Smoothing, SmoothingKernel};
use crate::error::{Error, Result, number};
use crate::points::Domain;
use crate::setting::Setting;

/// Fine bins per bandwidth, where `MAX_FINE_BINS` allows. A pair is spread evenly over its fine bin, so its distance is
/// off by at most half of it (bandwidth / 8192) either way: g moves by at most about 1e-5 of max(1, g) even where a kernel
/// covers only a hundred pairs (the box kernel, which jumps, by one pair at each jump), and in proportion more where the
/// bins are fewer. Every result carries its own rigorous bound.
const FINE: f64 = 4096.0;

/// With fewer fine bins per bandwidth than this only the direct sum will do.
const COARSEST: f64 = 128.0;

/// Fine bins in all. With more the f32 filter decides too few pairs.
const MAX_FINE_BINS: f64 = 262_144.0;

/// Costs, in values of a polynomial kernel (about 1 ns each): of a Gaussian's, of looking at a pair that may be out of reach,
/// of counting a pair (1/2 on a CPU, far less on a GPU).
const GAUSSIAN: f64 = 4.0;
const LOOKING: f64 = 3.0;
const COUNTING: f64 = 0.1;

/// What the direct sum may cost without being asked for: some seconds.
const AFFORDABLE: f64 = 4e9;

/// How the sum over pairs is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum KernelMethod {
    /// Pair by pair.
    Direct,
    /// From exact counts in fine bins.
    Binned,
}

/// Everything decided about a kernel estimate before any pair is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelPlan {
    /// The kernel.
    pub kernel: Smoothing,
    /// What a pair is divided by.
    pub divisor: Divisor,
    /// Where g is estimated, increasing.
    pub r: Vec<f64>,
    /// Whether the direct sum was asked for.
    pub exact: bool,
    /// The method taken.
    pub method: KernelMethod,
    /// The fine bins, or a single bin that holds every pair a kernel reaches.
    pub pairs: PairPlan,
}

/// The longest distance at which a kernel estimate may look at pairs.
pub(super) fn longest_distance(domain: &Domain, correction: Correction) -> f64 {
    match correction {
        _ if domain.is_torus() => 0.5 * domain.shortest_side(),
        Correction::Isotropic => super::nearly_half_diagonal(domain),
        _ => (1.0 - 1e-6) * domain.inner_diameter(),
    }
}

impl KernelPlan {
    /// Checks the bandwidth and the correction, and decides the method: the direct sum where it is affordable, or no dearer
    /// than counting into the fine bins of every realization and smoothing them, or the only one (divisor d, where bins at
    /// 0 would not do; very small bandwidths).
    ///
    /// # Errors
    /// A bandwidth that is not above 0 or reaches beyond the domain; more as `PairPlan::new`.
    pub fn new(
        kernel: Smoothing,
        divisor: Divisor,
        r: Vec<f64>,
        exact: bool,
        domain: &Domain,
        settings: impl Into<PairSettings>,
        shape: EnsembleShape,
    ) -> Result<Self> {
        let settings = PairSettings { cumulative: false, ..settings.into() };
        if settings.correction == Correction::Border {
            let reason = "a kernel estimate weighs pairs; expected translation, isotropic or none";
            return Err(Error::setting(Setting::Correction, settings.correction, reason));
        }
        // Written so that NaN fails.
        if !(kernel.bandwidth > 0.0 && kernel.bandwidth < domain.inner_diameter()) {
            let what = if domain.as_polygon().is_some() {
                "diameter of the largest circle in the polygon"
            } else {
                "shortest side"
            };
            let reason = format!("expected more than 0 and less than the {what} ({})", domain.inner_diameter());
            return Err(Error::setting(Setting::Bandwidth, number(kernel.bandwidth), reason));
        }
        let last = r.last().copied().unwrap_or(0.0);
        let range = (last + kernel.reach()).min(longest_distance(domain, settings.correction));
        let pairs = |bins| PairPlan::new(domain, RadialBins::linear(range, bins)?, settings, shape);
        let mut plan = Self { kernel, divisor, r, exact, method: KernelMethod::Direct, pairs: pairs(1)? };
        let per_bandwidth = FINE.min(MAX_FINE_BINS * kernel.bandwidth / range);
        if exact || divisor == Divisor::D || per_bandwidth < COARSEST {
            return Ok(plan);
        }
        let bins = (range / kernel.bandwidth * per_bandwidth).ceil();
        let smoothing = shape.realizations as f64 * plan.r.len() as f64 * bins.min(2.0 * kernel.reach() / range * bins);
        if plan.cost() > AFFORDABLE.max(smoothing + COUNTING * plan.pairs.pairs()) {
            plan.method = KernelMethod::Binned;
            plan.pairs = pairs(bins as usize)?;
        }
        Ok(plan)
    }

    /// The same with another bandwidth.
    ///
    /// # Errors
    /// As `new`.
    pub fn with_bandwidth(&self, bandwidth: f64) -> Result<Self> {
        let (kernel, pairs) = (Smoothing { bandwidth, ..self.kernel }, &self.pairs);
        let settings = PairSettings { masses: pairs.masses, ..pairs.correction.into() };
        let new = Self::new(kernel, self.divisor, self.r.clone(), self.exact, &pairs.domain, settings, pairs.shape)?;
        Ok(Self { pairs: new.pairs.for_device(pairs.device), ..new })
    }

    /// Pairs further apart than this are out of reach.
    pub fn range(&self) -> f64 {
        self.pairs.bins.r_max()
    }

    /// Whether g can be estimated at `r`: not at 0, and not where the kernel reaches past the longest distance.
    pub fn covers(&self, r: f64) -> bool {
        // A hair of slack: r + reach may equal the range up to rounding.
        r > 0.0 && r + self.kernel.reach() <= self.range() * (1.0 + 1e-9)
    }

    /// Unordered pairs that the direct sum looks at: those near each other along the longest axis.
    fn looked_at(&self) -> f64 {
        let longest = self.pairs.domain.sides().iter().copied().fold(0.0, f64::max);
        self.pairs.pairs() * (2.0 * self.range() / longest).min(1.0)
    }

    /// Kernel values that the direct sum takes, if the points are spread evenly.
    fn values(&self) -> f64 {
        let (domain, bins) = (&self.pairs.domain, &self.pairs.bins);
        let ball: f64 = (0..bins.len()).map(|bin| bins.shell_measure(bin, domain.dim())).sum();
        let in_reach = self.pairs.pairs() * (ball / domain.measure()).min(1.0);
        let span = self.r.last().copied().unwrap_or(0.0) - self.r.first().copied().unwrap_or(0.0);
        let covered = (self.r.len() as f64 * (2.0 * self.kernel.reach() / span).min(1.0)).max(1.0);
        in_reach * covered
    }

    /// What a realization takes, in seconds of one thread.
    pub fn seconds(&self) -> f64 {
        match self.method {
            KernelMethod::Direct => 1e-9 * self.cost() / self.pairs.shape.realizations.max(1) as f64,
            KernelMethod::Binned => {
                let bins = self.pairs.bins.len() as f64;
                let reached = bins.min(2.0 * self.kernel.reach() / self.range() * bins);
                self.pairs.seconds() + 1e-9 * self.r.len() as f64 * reached
            }
        }
    }

    /// The cost of the direct sum, in values of a polynomial kernel.
    fn cost(&self) -> f64 {
        let value = if self.kernel.shape == SmoothingKernel::Gaussian { GAUSSIAN } else { 1.0 };
        LOOKING * self.looked_at() + value * self.values()
    }
}

impl fmt::Display for KernelPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let divisor = match self.divisor {
            Divisor::R => "r",
            Divisor::D => "d",
        };
        let Smoothing { shape, bandwidth } = self.kernel;
        writeln!(f, "kernel estimate: {shape:?}, bandwidth {bandwidth}, divisor {divisor}")?;
        match self.method {
            KernelMethod::Direct => {
                let (looked, values) = (self.looked_at(), self.values());
                writeln!(f, "  direct sum in f64 on the CPU: {looked:.3e} pairs looked at, {values:.3e} kernel values")
            }
            KernelMethod::Binned => {
                let values = self.values();
                writeln!(
                    f,
                    "  from counts in fine bins, realization by realization (--exact-kernel: {values:.3e} kernel values)"
                )?;
                write!(f, "{}", self.pairs)
            }
        }
    }
}

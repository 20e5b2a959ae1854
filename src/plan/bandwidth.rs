//! How the bandwidth of a kernel is found.

use super::{EnsembleShape, PairPlan, PairSettings, RadialBins, SmoothingKernel, longest_distance};
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::setting::Setting;

/// How the bandwidth is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bandwidth {
    /// This standard deviation, in the domain's length unit.
    Given(f64),
    /// Stoyan's rule: Epanechnikov half-width `0.15 lambda^(-1/d)`, i.e. a bandwidth of that over sqrt(5), for every shape
    /// (Stoyan and Stoyan, Fractals, Random Shapes and Point Fields, 1994, p. 285).
    Stoyan,
    /// Fiksel's rule: standard deviation `0.1 lambda^(-1/d)` (Fiksel, Edge-corrected density estimators for point
    /// processes, 1988).
    Fiksel,
    /// Least-squares cross-validation.
    Lscv,
}

impl std::fmt::Display for Bandwidth {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Given(_) => "given",
            Self::Stoyan => "stoyan",
            Self::Fiksel => "fiksel",
            Self::Lscv => "lscv",
        })
    }
}

impl std::str::FromStr for Bandwidth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "stoyan" => Ok(Self::Stoyan),
            "fiksel" => Ok(Self::Fiksel),
            "lscv" => Ok(Self::Lscv),
            number => number.parse().map(Self::Given).map_err(|_| "expected a number, stoyan, fiksel or lscv".into()),
        }
    }
}

impl Bandwidth {
    /// The standard deviation; for `Lscv`, which must see the pairs first, Stoyan's.
    pub fn value(self, domain: &Domain, mean_points: f64) -> f64 {
        let spacing = spacing(domain, mean_points);
        match self {
            Self::Given(bandwidth) => bandwidth,
            Self::Fiksel => 0.1 * spacing,
            Self::Stoyan | Self::Lscv => 0.15 / 5f64.sqrt() * spacing,
        }
    }
}

/// `lambda^(-1/d)`.
fn spacing(domain: &Domain, mean_points: f64) -> f64 {
    (domain.measure() / mean_points).powf(1.0 / domain.dim() as f64)
}

/// Bandwidths searched by cross-validation, in units of `lambda^(-1/d)`, where the domain allows.
const SEARCHED: [f64; 2] = [0.02, 1.0];

/// Bins per smallest bandwidth: smoothing bin centres in place of pairs moves the score by about 1e-3 there.
const BINS_PER_BANDWIDTH: f64 = 8.0;

/// Bins in all; the smallest bandwidth is raised where they would not do.
const MAX_SEARCH_BINS: f64 = 65_536.0;

/// What cross-validation looks at: pairs in bins much finer than the smallest bandwidth.
#[derive(Debug, Clone, PartialEq)]
pub struct BandwidthSearch {
    /// The shape.
    pub shape: SmoothingKernel,
    /// Smallest and largest bandwidth tried.
    pub range: [f64; 2],
    /// The distances over which the squared error is integrated: those at which g is reported, from where a kernel of
    /// Stoyan's bandwidth loses no mass below 0 (nearer, that loss would outweigh all else and favour the smallest
    /// bandwidth), to where the largest still fits the domain.
    pub distances: [f64; 2],
    /// The bins.
    pub pairs: PairPlan,
}

impl BandwidthSearch {
    /// For g reported at distances from `r[0]` to `r[1]`.
    ///
    /// # Errors
    /// A range of bandwidths that the domain does not allow.
    pub fn new(
        shape: SmoothingKernel,
        r: [f64; 2],
        domain: &Domain,
        settings: impl Into<PairSettings>,
        ensemble: EnsembleShape,
    ) -> Result<Self> {
        let spacing = spacing(domain, ensemble.mean_points);
        let settings = PairSettings { cumulative: false, ..settings.into() };
        let limit = longest_distance(domain, settings.correction);
        let largest = (SEARCHED[1] * spacing).min(0.5 * limit / shape.reach());
        let range = (r[1] + shape.reach() * largest).min(limit);
        let smallest = (SEARCHED[0] * spacing).min(0.1 * largest).max(BINS_PER_BANDWIDTH * range / MAX_SEARCH_BINS);
        let lossless = shape.reach() * Bandwidth::Stoyan.value(domain, ensemble.mean_points);
        let distances = [r[0].max(lossless), r[1].min(limit - shape.reach() * largest)];
        if distances[0] >= distances[1] || smallest >= largest {
            let reason = format!(
                "needs r between {lossless:.4e}, below which kernels lose mass, and {:.4e}, beyond which they reach too far",
                limit - shape.reach() * largest
            );
            return Err(Error::setting(Setting::Bandwidth, "lscv", reason));
        }
        let bins = (range / smallest * BINS_PER_BANDWIDTH).ceil().min(MAX_SEARCH_BINS);
        let pairs = PairPlan::new(domain, RadialBins::linear(range, bins as usize)?, settings, ensemble)?;
        Ok(Self { shape, range: [smallest, largest], distances, pairs })
    }
}

impl std::fmt::Display for BandwidthSearch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([lo, hi], [from, to]) = (self.range, self.distances);
        writeln!(
            f,
            "bandwidth: least-squares cross-validation from {lo:.4e} to {hi:.4e}, over r in [{from:.4e}, {to:.4e}]"
        )?;
        write!(f, "{}", self.pairs)
    }
}

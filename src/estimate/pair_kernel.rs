//! Kernel estimates of g(r) from exact counts on a fine grid.

use super::Normalization;
use super::ratio::ratio;
use crate::accumulate::PairCounts;
use crate::error::{Error, Result, number};
use crate::plan::{PairPlan, RadialBins};
use crate::points::Domain;

/// The shape of a smoothing kernel. Bandwidth is its standard deviation (spatstat's convention).
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SmoothingKernel {
    /// `3/4 (1 - (x/h)^2) / h`, half-width `h = sqrt(5) bandwidth`.
    Epanechnikov,
    /// Gaussian, cut at 8 bandwidths (where it is 1e-14 of its peak).
    Gaussian,
    /// `1 / (2h)`, half-width `h = sqrt(3) bandwidth`.
    Box,
}

impl SmoothingKernel {
    /// The distance beyond which the kernel is 0, in bandwidths.
    fn reach(self) -> f64 {
        match self {
            Self::Epanechnikov => 5f64.sqrt(),
            Self::Gaussian => 8.0,
            Self::Box => 3f64.sqrt(),
        }
    }

    /// The integral of the kernel from -infinity to `x`, with unit bandwidth.
    fn cumulative(self, x: f64) -> f64 {
        let u = (x / self.reach()).clamp(-1.0, 1.0);
        match self {
            Self::Epanechnikov => 0.5 + 0.75 * u - 0.25 * u * u * u,
            Self::Box => 0.5 + 0.5 * u,
            Self::Gaussian => 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2),
        }
    }
}

/// How the bandwidth is found.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Bandwidth {
    /// This standard deviation, in the domain's length unit.
    Given(f64),
    /// Stoyan's rule: Epanechnikov half-width `0.15 lambda^(-1/d)`.
    Stoyan,
    /// Fiksel's rule: standard deviation `0.1 lambda^(-1/d)`.
    Fiksel,
    /// Least-squares cross-validation.
    Lscv,
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

/// The sphere whose surface a pair is divided by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Divisor {
    /// Of the radius at which g is estimated.
    #[default]
    R,
    /// Of the distance of the pair.
    D,
}

/// A kernel with its bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Kernel {
    /// Its shape.
    pub shape: SmoothingKernel,
    /// Its standard deviation, in the domain's length unit.
    pub bandwidth: f64,
}

/// Fine bins per bandwidth, where `MAX_FINE_BINS` allows. A pair is spread evenly over its fine bin, so its distance is
/// off by at most half of it (bandwidth / 8192) either way: g moves by at most about 1e-5 of max(1, g) even where a kernel
/// covers only a hundred pairs (tested against the exact sum; the box kernel, which jumps, by one pair at each jump), and
/// in proportion more where the bins are fewer. Mass that the kernel puts below r = 0 is lost: there is no boundary
/// correction.
const FINE: f64 = 4096.0;

/// With fewer fine bins per bandwidth than this the estimate is refused.
const COARSEST: f64 = 128.0;

/// Fine bins in all. With more the f32 filter decides too few pairs.
const MAX_FINE_BINS: f64 = 262_144.0;

impl Kernel {
    /// Checks the bandwidth. The default is Stoyan's rule, an Epanechnikov half-width of `0.15 / sqrt(lambda)` in 2D
    /// (`0.15 lambda^(-1/d)` in d dimensions), i.e. a bandwidth of that over sqrt(5), for every shape.
    pub fn new(
        shape: SmoothingKernel,
        bandwidth: Option<Bandwidth>,
        domain: &Domain,
        mean_points: f64,
    ) -> Result<Self> {
        let spacing = (domain.measure() / mean_points).powf(1.0 / domain.dim() as f64);
        let bandwidth = match bandwidth {
            Some(Bandwidth::Given(bandwidth)) => bandwidth,
            Some(Bandwidth::Fiksel) => 0.1 * spacing,
            Some(Bandwidth::Stoyan | Bandwidth::Lscv) | None => 0.15 / 5f64.sqrt() * spacing,
        };
        if !(bandwidth > 0.0 && bandwidth < domain.shortest_side()) {
            let reason = format!("expected more than 0 and less than the shortest side ({})", domain.shortest_side());
            return Err(Error::setting("--bandwidth", number(bandwidth), reason));
        }
        Ok(Self { shape, bandwidth })
    }

    /// The fine bins behind an estimate at distances up to `r_max`: linear, as far as the kernel reaches or the domain
    /// allows.
    pub fn fine_bins(&self, r_max: f64, domain: &Domain) -> Result<RadialBins> {
        let limit = if domain.is_torus() { 0.5 } else { 1.0 - 1e-9 } * domain.shortest_side();
        let range = (r_max + self.shape.reach() * self.bandwidth).min(limit);
        let per_bandwidth = FINE.min(MAX_FINE_BINS * self.bandwidth / range);
        if per_bandwidth < COARSEST {
            let smallest = range * COARSEST / MAX_FINE_BINS;
            let reason = format!("too small for r up to {range}: expected at least {smallest:e}, or a smaller --r-max");
            return Err(Error::setting("--bandwidth", number(self.bandwidth), reason));
        }
        let bins = (range / self.bandwidth * per_bandwidth).ceil();
        RadialBins::linear(range, bins as usize)
    }
}

/// `g(r) = |D| / (S(r) sum N) sum_pairs w k(r - d)`, with `S(r)` the surface of the sphere of radius r (divisor r); see
/// Illian et al. 2008, section 4.3.3. `None` where it is undefined: r = 0, or where the kernel reaches beyond the longest
/// distance the domain allows.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelEstimate {
    /// The kernel.
    pub kernel: Kernel,
    /// Where g is estimated.
    pub r: Vec<f64>,
    /// g.
    pub g: Vec<Option<f64>>,
    /// Its standard error if the pairs were independent (Poisson): `|D| / (S sum N) sqrt(2 sum_pairs (w k)^2)`.
    pub g_se: Vec<Option<f64>>,
}

impl KernelEstimate {
    /// The estimate at distances `r` from counts in `kernel.fine_bins`.
    pub fn new(kernel: Kernel, r: &[f64], plan: &PairPlan, counts: &PairCounts, normalization: Normalization) -> Self {
        let domain = &plan.domain;
        let bins = &plan.bins;
        let width = bins.r_max() / bins.len() as f64;
        let reach = kernel.shape.reach() * kernel.bandwidth;
        let density = domain.measure() / ratio(counts, &counts.bins, 0, normalization).norm;
        let (g, g_se) = r
            .iter()
            .map(|&r| {
                // A hair of slack: r + reach may equal the range up to rounding.
                if r <= 0.0 || r + reach > bins.r_max() * (1.0 + 1e-9) {
                    return (None, None);
                }
                let first = (((r - reach) / width).floor().max(0.0)) as usize;
                let last = (((r + reach) / width).ceil() as usize).min(bins.len());
                let (mut sum, mut squares) = (0.0, 0.0);
                for b in first..last {
                    let count = counts.counts[b] as f64;
                    if count == 0.0 {
                        continue;
                    }
                    let weight = counts.sum(b) / count;
                    // The mean of the kernel over the fine bin: its integral is known in closed form.
                    let at = |edge: f64| kernel.shape.cumulative((edge - r) / kernel.bandwidth);
                    let k = weight * (at(bins.edges()[b + 1]) - at(bins.edges()[b])) / width;
                    sum += count * k;
                    squares += count * k * k;
                }
                let scale = density / sphere_surface(r, domain.dim());
                (Some(scale * sum), Some(scale * (2.0 * squares).sqrt()))
            })
            .unzip();
        Self { kernel, r: r.to_vec(), g, g_se }
    }
}

/// Length, circumference or area of the sphere of radius `r`: 2, 2 pi r, 4 pi r^2.
fn sphere_surface(r: f64, dim: usize) -> f64 {
    let pi = std::f64::consts::PI;
    match dim {
        1 => 2.0,
        2 => 2.0 * pi * r,
        _ => 4.0 * pi * r * r,
    }
}

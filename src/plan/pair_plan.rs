//! The plan for pair counts.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

use super::shell_measure::shell_measure;
use super::{Batch, BinFilter, EnsembleShape, PairDevice, PairSearch, RadialBins, SearchCosts, SearchEstimate, Tile};
use crate::error::{Error, Result, number};
use crate::named::named;
use crate::points::Domain;
use crate::setting::Setting;

/// How pairs near the edge of a window are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Correction {
    /// Every pair counts 1 (a torus needs no more).
    None,
    /// Every pair counts `|D| / |D intersect (D + r)|`, the translation correction.
    Translation,
    /// Every ordered pair counts the inverse of the part of the circle about its first point, through its second, that
    /// lies in the window: Ripley's isotropic correction.
    Isotropic,
    /// Only points further from the border than the distance in question are looked from: minus sampling.
    Border,
}

named!(Correction: None = "none", Translation = "translation", Isotropic = "isotropic", Border = "border");

/// Seconds to look at a side of a polygon for a point or a circle, and at two for what they overlap.
const PER_SIDE: f64 = 3e-9;
const PER_OVERLAP: f64 = 1e-8;

/// What is counted, and how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PairSettings {
    /// Edge correction.
    pub correction: Correction,
    /// Whether sums over all pairs closer than each edge are wanted with their error, for K.
    pub cumulative: bool,
    /// Whether distances beyond half the shortest side of a torus are wanted, up to half its diagonal.
    pub beyond_half: bool,
    /// Whether points have weights.
    pub masses: bool,
}

impl From<Correction> for PairSettings {
    fn from(correction: Correction) -> Self {
        Self { correction, cumulative: false, beyond_half: false, masses: false }
    }
}

/// Everything decided about counting pairs before any pair is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct PairPlan {
    /// The domain.
    pub domain: Domain,
    /// The bins.
    pub bins: RadialBins,
    /// Integer thresholds on the squared distance, one per edge.
    pub thresholds: Vec<u128>,
    /// The f32 filter in front of them.
    pub filter: BinFilter,
    /// Edge correction.
    pub correction: Correction,
    /// Whether cumulative sums are kept.
    pub cumulative: bool,
    /// Whether points have weights.
    pub masses: bool,
    /// Which pairs are looked at: by default what suits the CPU (`PairSearch::choose`).
    pub search: PairSearch,
    /// How a GPU takes all pairs.
    pub tile: Tile,
    /// The device that both were chosen for.
    pub device: PairDevice,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

impl PairPlan {
    /// Checks the bins against the domain and decides.
    ///
    /// # Errors
    /// A largest distance or an edge correction that the domain does not allow.
    pub fn new(
        domain: &Domain,
        bins: RadialBins,
        settings: impl Into<PairSettings>,
        shape: EnsembleShape,
    ) -> Result<Self> {
        let PairSettings { correction, cumulative, beyond_half, masses } = settings.into();
        check_correction(domain, correction)?;
        check_r_max(domain, correction, beyond_half, bins.r_max())?;
        let thresholds = bins.thresholds(domain)?;
        let filter = BinFilter::new(&bins, domain);
        // Points (three u64 axes, once more sorted and rounded, and what they weigh), and a histogram with what is on its way.
        let per_bin = match correction {
            Correction::Border => 104,
            Correction::None if !masses => 24,
            _ => 56,
        };
        let bytes = shape.max_points * 72 + bins.len() as u64 * per_bin;
        let batch = Batch::new(shape, bytes);
        let beyond = thresholds[bins.len()];
        let device = PairDevice::CPU;
        let search = PairSearch::choose(domain, beyond, shape.mean_points, &filter, &device.costs);
        let tile = Tile::new(shape.max_points);
        let domain = domain.clone();
        Ok(Self {
            domain,
            bins,
            thresholds,
            filter,
            correction,
            cumulative,
            masses,
            search,
            tile,
            device,
            shape,
            batch,
        })
    }

    /// The default `r_max`: 8 closest-packing distances, at most half the shortest side, or the radius of the largest circle in a
    /// polygon.
    pub fn default_r_max(domain: &Domain, mean_points: f64) -> f64 {
        (8.0 * domain.closest_packing_distance(mean_points)).min(domain.inner_diameter() / 2.0)
    }

    /// Exact measure of what of the shell of bin `k` can hold pairs: all of it, or on a torus beyond half the shortest side
    /// the part inside the box.
    pub fn shell_measure(&self, k: usize) -> f64 {
        let (lo, hi) = (self.bins.edges()[k], self.bins.edges()[k + 1]);
        if self.domain.is_torus() && hi > self.domain.shortest_side() / 2.0 {
            shell_measure(lo, hi, self.domain.sides())
        } else {
            self.bins.shell_measure(k, self.domain.dim())
        }
    }

    /// Whether weights are summed beside the counts.
    pub fn weighted(&self) -> bool {
        self.masses || matches!(self.correction, Correction::Translation | Correction::Isotropic)
    }

    /// The largest weight that isotropic edge correction may give a pair.
    ///
    /// With sides a >= b, at a distance r. Where r <= a/2, half of the circle at least looks away from the nearer short side;
    /// with y the way to a long side it keeps `asin(min(1, y/r)) + asin(min(1, (b-y)/r))` of it, least at y = b/2 or y = 0.
    /// Beyond, the quarter towards the farthest corner, at least a/2 and b/2 away, keeps
    /// `asin(min(1, a/2r)) + asin(min(1, b/2r)) - pi/2`, which is above 0 up to half the diagonal. Both fall with r.
    pub fn largest_isotropic(&self) -> f64 {
        let r = self.bins.r_max();
        let [a, b] = match *self.domain.sides() {
            [x, y] => [f64::max(x, y), f64::min(x, y)],
            // One of two ends.
            _ => return 2.0,
        };
        let kept = |d: f64| (d / r).min(1.0).asin();
        let inside = if r <= a / 2.0 {
            FRAC_PI_2.min(2.0 * kept(b / 2.0))
        } else {
            (kept(a / 2.0) + kept(b / 2.0) - FRAC_PI_2).min(FRAC_PI_2)
        };
        TAU / inside
    }

    /// Steps to a unit of the weights that are summed.
    pub fn weight_steps(&self) -> f64 {
        2f64.powi(if self.masses { 64 } else { 32 })
    }

    /// Whether pairs are also counted from points deep inside the window.
    pub fn border(&self) -> bool {
        self.correction == Correction::Border
    }

    /// The same with the search that suits a device, of those it can do.
    pub fn for_device(self, device: PairDevice) -> Self {
        let beyond = self.thresholds[self.bins.len()];
        let search = match device.buffers {
            Some(buffers) if buffers < self.cell_buffers() => PairSearch::All,
            _ => PairSearch::choose(&self.domain, beyond, self.shape.mean_points, &self.filter, &device.costs),
        };
        Self { search, device, ..self }
    }

    /// Storage buffers that a GPU's kernels for cells need. Every device has enough for those that look at all pairs.
    pub fn cell_buffers(&self) -> u32 {
        // The one that counts has points twice, thresholds, histograms, jobs and tasks, and may have a table and depths; the
        // one that sorts has 8.
        let table = if matches!(self.filter, BinFilter::Table(_)) { 2 } else { 0 };
        (6 + table + u32::from(self.border())).max(8)
    }

    /// Every search there is to choose from, as it would be on a device with these costs: per realization.
    pub fn searches(&self, costs: &SearchCosts) -> Vec<SearchEstimate> {
        let beyond = self.thresholds[self.bins.len()];
        PairSearch::alternatives(&self.domain, beyond, self.shape.mean_points, &self.filter, costs)
    }

    /// What a realization takes by the search that is planned.
    pub fn seconds(&self) -> f64 {
        let all = self.searches(&self.device.costs);
        all.iter().find(|s| s.search == self.search).map_or(0.0, |s| s.seconds) + self.polygon_seconds()
    }

    /// What the weights of a realization take in a polygon, besides counting.
    fn polygon_seconds(&self) -> f64 {
        let Some(polygon) = self.domain.as_polygon() else { return 0.0 };
        let (n, sides, r) = (self.shape.mean_points, polygon.sides().len() as f64, self.bins.r_max());
        let ball: f64 = (0..self.bins.len()).map(|bin| self.bins.shell_measure(bin, 2)).sum();
        let pairs = 0.5 * n * (n - 1.0).max(0.0) * (ball / polygon.area()).min(1.0);
        // However jagged.
        let outline = polygon.length().min(TAU * polygon.circumradius());
        match self.correction {
            Correction::None => 0.0,
            Correction::Border => n * sides * PER_SIDE,
            // Sides, and pairs of sides that are near.
            Correction::Translation => {
                let near = 0.5 * sides * sides * (2.0 * r / outline).min(1.0);
                pairs * (sides * PER_SIDE + (sides + near) * PER_OVERLAP)
            }
            // Circles about points near the border, from both ends of a pair.
            Correction::Isotropic => {
                n * sides * PER_SIDE + 2.0 * pairs * (0.5 * r * outline / polygon.area()).min(1.0) * sides * PER_SIDE
            }
        }
    }

    /// Unordered pairs in all realizations, looked at or not.
    pub fn pairs(&self) -> f64 {
        let n = self.shape.mean_points;
        self.shape.realizations as f64 * n * (n - 1.0).max(0.0) / 2.0
    }
}

/// The longest distance of isotropic edge correction. In the plane weights grow without bound towards half the diagonal: this far
/// below they are at most 2^29.
pub(crate) fn nearly_half_diagonal(domain: &Domain) -> f64 {
    if domain.dim() == 1 { domain.circumradius() } else { domain.circumradius() * (1.0 - 1e-8) }
}

fn check_correction(domain: &Domain, correction: Correction) -> Result<()> {
    let reason = match correction {
        Correction::None => return Ok(()),
        _ if domain.is_torus() => "a torus has no edges; use none",
        Correction::Isotropic if domain.dim() == 3 => {
            "the part of a sphere inside a box is not computed; 3D has translation, border and none"
        }
        _ => return Ok(()),
    };
    Err(Error::setting(Setting::Correction, correction, reason))
}

/// Up to where each way of counting is right: on a torus a ball must not meet itself; in a window every direction of a
/// pair must be seen from somewhere (translation, none), every point must have some of its circle inside (isotropic),
/// some points must be that far from the border.
fn check_r_max(domain: &Domain, correction: Correction, beyond_half: bool, r_max: f64) -> Result<()> {
    let (side, diagonal) = (domain.inner_diameter(), domain.circumradius());
    let polygon = domain.as_polygon().is_some();
    let (fits, reason) = match (domain.is_torus(), correction) {
        (true, _) if beyond_half => (
            r_max <= diagonal,
            format!("expected at most half the diagonal of the torus ({diagonal}): no two points are further apart"),
        ),
        (true, _) => (
            r_max <= side / 2.0,
            format!(
                "beyond half the shortest side ({0}) a ring does not fit into the torus and g would be under-counted; \
                 expected at most {0}, or `beyond_half`, which compares with the part that fits",
                side / 2.0
            ),
        ),
        (false, Correction::Isotropic) if polygon => (
            r_max <= nearly_half_diagonal(domain),
            format!(
                "expected less than the radius of the smallest circle about a part of the polygon ({diagonal}): beyond, some points see \
                 nothing of the circle"
            ),
        ),
        (false, Correction::Border) if polygon => (
            r_max < side / 2.0,
            format!(
                "expected less than the radius of the largest circle in the polygon ({}): no point is further from the border",
                side / 2.0
            ),
        ),
        (false, _) if polygon => (
            r_max <= side * (1.0 - 1e-6),
            format!(
                "expected less than the diameter of the largest circle in the polygon ({side}): beyond, some directions may never be seen; \
                 `correction` isotropic reaches to {diagonal}"
            ),
        ),
        (false, Correction::Isotropic) => (
            r_max <= nearly_half_diagonal(domain),
            format!(
                "expected less than half the diagonal of the window ({diagonal}): there, some points see nothing of the circle"
            ),
        ),
        (false, Correction::Border) => (
            r_max < side / 2.0,
            format!(
                "expected less than half the shortest side of the window ({}): no point is further from the border",
                side / 2.0
            ),
        ),
        // Close to the side translation weights grow without bound.
        (false, _) => (
            r_max <= side * (1.0 - 1e-6),
            format!(
                "expected less than the shortest side of the window ({side}): beyond, some directions are never seen"
            ),
        ),
    };
    if fits { Ok(()) } else { Err(Error::setting(Setting::RMax, number(r_max), reason)) }
}

impl fmt::Display for PairPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let b = &self.bins;
        let filter = match &self.filter {
            BinFilter::Linear { .. } => "f32 square root",
            BinFilter::Table(_) => "table over the bits of r^2",
        };
        writeln!(
            f,
            "pair_counts: {:.3e} pairs, {} bins over [{}, {})",
            self.pairs(),
            b.len(),
            b.edges()[0],
            b.r_max()
        )?;
        writeln!(f, "  exact: {filter} decides pairs clear of an edge, 128-bit integers the rest")?;
        writeln!(f, "  {}", self.batch)?;
        let searches = self.searches(&self.device.costs);
        if let Some(chosen) = searches.iter().find(|s| s.search == self.search) {
            writeln!(f, "  search on {}: {chosen} per realization", self.device.costs.device)?;
        }
        if self.device.buffers.is_some() && self.search == PairSearch::All {
            writeln!(f, "    in {}", self.tile)?;
        }
        for other in searches.iter().filter(|s| s.search != self.search) {
            writeln!(f, "    instead of {other}")?;
        }
        writeln!(f, "  skipped: half of the pairs (i < j, counted twice)")?;
        if self.search != PairSearch::All {
            writeln!(f, "  skipped: pairs of cells that are farther apart than r_max")?;
        }

        if self.masses {
            writeln!(f, "  products of weights of points in steps of 2^-64 of the largest weight squared")?;
        }
        match self.correction {
            Correction::None => writeln!(f, "  skipped: edge weights (not asked for or a torus)"),
            Correction::Border => writeln!(f, "  border: pairs seen from points deeper inside than the distance"),
            weights if let Some(polygon) = self.domain.as_polygon() => {
                let sides = polygon.sides().len();
                let seconds = self.polygon_seconds();
                writeln!(
                    f,
                    "  {weights} weights exact by the {sides} sides of the polygon, {seconds:.2e} s per realization, in steps of 2^-32"
                )
            }
            Correction::Isotropic => {
                writeln!(f, "  isotropic weights up to {:.3}, in steps of 2^-32", self.largest_isotropic())
            }
            weights => writeln!(f, "  {weights} weights in steps of 2^-32"),
        }
    }
}

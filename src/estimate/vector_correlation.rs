//! Lag counts -> the pair correlation function of the vector between two points, g(h), and g(r, theta) along rings.

use super::Analysis;
use super::ratio::{Ratio, ratio_of};
use super::{ErrorSource, Normalization};
use crate::accumulate::LagCounts;
use crate::plan::{Correction, LagGrid, LagPlan};

/// `g_k = |D|^2 sum c_k / (V_k sum N)` per cell of lags, over realizations, with `c_k` the ordered pairs whose lag is in
/// the cell, `N = n (n - 1)` or `n^2`, and `V_k` the integral over the cell of what a lag h leaves of the domain,
/// `|D intersect (D + h)|`: its set covariance `gamma(h) = prod_a (a_a - |h_a|)` in a window with sides `a`
/// (translation correction, at the level of the cell; Illian et al. 2008, 4.2.2), and `|D|` on a torus or without
/// correction. A ratio of sums, as for g(r).
#[derive(Debug, Clone, PartialEq)]
pub struct VectorCorrelation {
    /// The grid.
    pub grid: LagGrid,
    /// Ordered pairs per cell, summed over realizations; x axis first.
    pub count: Vec<u64>,
    /// g per cell.
    pub g: Vec<f64>,
    /// Standard error per cell. Theory, for K = 1: unordered pairs are Poisson, and each counts once in a cell and once in
    /// its mirror image, so that it is `g / sqrt(c)` (and `g sqrt(2 / c)` in a cell that is its own); an empty cell gets
    /// the error of one pair.
    pub g_se: Vec<f64>,
    /// Where errors come from.
    pub errors: ErrorSource,
    /// The normalization.
    pub normalization: Normalization,
    /// The edge correction.
    pub correction: Correction,
    /// The rings of the plan, sector by sector.
    pub sectors: Vec<SectorCorrelation>,
}

/// g over the cells whose centres lie in a sector of a ring: their pairs over the pairs expected in the same cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectorCorrelation {
    /// Inner radius, radius and outer radius of the ring.
    pub r: [f64; 3],
    /// First, central and last direction in radians from the x axis.
    pub theta: [f64; 3],
    /// Number of cells, of each mirror pair one.
    pub cells: u64,
    /// Ordered pairs in them.
    pub count: u64,
    /// g; `None` where the sector has no cells.
    pub g: Option<f64>,
    /// Its standard error.
    pub g_se: Option<f64>,
}

impl VectorCorrelation {
    /// The estimate. With no pair of points at all (every n < 2) g is 0/0 and reported as NaN; callers check first.
    pub fn new(plan: &LagPlan, counts: &LagCounts, normalization: Normalization) -> Self {
        let cells = plan.grid.cells();
        let measures = axis_measures(plan);
        let measure = plan.domain.measure();
        // The part of N pairs that is expected in a cell.
        let share = |cell: usize| {
            let volume: f64 = measures.iter().enumerate().map(|(axis, m)| m[plan.grid.bin(cell, axis)]).product();
            volume / (measure * measure)
        };
        let estimate = |ratio: Ratio, share: f64, both_ends: bool| {
            let expected = share * ratio.norm;
            let theory = || if both_ends { (2.0 * ratio.sum.max(2.0)).sqrt() } else { ratio.sum.max(1.0).sqrt() };
            (ratio.sum / expected, ratio.error.unwrap_or_else(theory) / expected)
        };
        let of = |ratios, bin| ratio_of(counts.realizations, counts.steps, ratios, bin, normalization);
        let (g, g_se) = (0..cells)
            .map(|cell| estimate(of(&counts.cells, cell), share(cell), plan.grid.mirror(cell) == cell))
            .unzip();
        let sectors = plan.sectors.iter().enumerate().map(|(index, sector)| {
            let shares: f64 = sector.cells.iter().map(|&c| share(c as usize)).sum();
            let (g, g_se) = estimate(of(&counts.sectors, index), shares, false);
            let defined = !sector.cells.is_empty();
            SectorCorrelation {
                r: sector.r,
                theta: sector.theta,
                cells: sector.cells.len() as u64,
                count: counts.sectors.sums[index] as u64,
                g: defined.then_some(g),
                g_se: defined.then_some(g_se),
            }
        });
        Self {
            grid: plan.grid.clone(),
            count: counts.cells.sums.iter().map(|&c| c as u64).collect(),
            g,
            g_se,
            errors: ErrorSource::of(counts.realizations),
            normalization,
            correction: plan.correction,
            sectors: sectors.collect(),
        }
    }
}

/// Per axis and bin, the integral of what a lag leaves of the side: the factors of `V_k`.
fn axis_measures(plan: &LagPlan) -> Vec<Vec<f64>> {
    let grid = &plan.grid;
    let whole = plan.correction == Correction::None;
    let axis = |axis: usize, side: f64| {
        let bin = |k: usize| {
            let (lo, hi) = (grid.edge(axis, k), grid.edge(axis, k + 1));
            match (whole, lo < 0.0 && hi > 0.0) {
                (true, _) => side * grid.width(axis),
                // a - |h| is linear on either side of 0.
                (false, false) => grid.width(axis) * (side - 0.5 * (lo + hi).abs()),
                (false, true) => side * grid.width(axis) - 0.5 * (lo * lo + hi * hi),
            }
        };
        (0..grid.bins).map(bin).collect()
    };
    plan.domain.sides().iter().enumerate().map(|(k, &side)| axis(k, side)).collect()
}

impl Analysis {
    /// g per cell of lags.
    pub fn vector(&self) -> Option<&VectorCorrelation> {
        self.get()
    }
}

//! Distribution functions of nearest-neighbour distances (van Lieshout and Baddeley, "A nonparametric measure of spatial
//! interaction in point patterns", Statistica Neerlandica 50, 1996).
//!
//! - G(r): the probability that a point has another closer than r;
//! - F(r), the empty-space function: that a fixed place, here a test point, has a point closer than r;
//! - J(r) = (1 - G) / (1 - F): 1 for a Poisson process, above it where points keep apart, below it where they cluster.

use crate::accumulate::{COUNT_STEPS, DistributionSums, NeighborSums};
use crate::ball::unit_ball;
use crate::estimate::{ErrorSource, ratio_standard_error};
use crate::plan::{EnsembleShape, NeighborPlan};

/// G, F and J at the distances of the plan. Over realizations G is `sum_k n_k G_k / sum_k n_k`, on a torus the share of all
/// points; F is the mean. `None` where a window is too small: no distance so long was seen, nor all of them shorter.
#[derive(Debug, Clone, PartialEq)]
pub struct NeighborFunctions {
    /// Distances, in the domain's length unit.
    pub r: Vec<f64>,
    /// G.
    pub g: Vec<Option<f64>>,
    /// Standard error of G. Theory, for K = 1: `S sqrt((1 - S) / Y)`, S = 1 - G and Y the distances known to be at least r
    /// (Peto et al., British Journal of Cancer 35, 1977), on a torus the binomial `sqrt(G (1 - G) / n)`.
    pub g_se: Vec<Option<f64>>,
    /// F.
    pub f: Vec<Option<f64>>,
    /// Standard error of F. Theory, for K = 1: likewise, as of only as many test points as there are points, since
    /// neighbouring test points see the same.
    pub f_se: Vec<Option<f64>>,
    /// J; `None` also where F = 1.
    pub j: Vec<Option<f64>>,
    /// G and F of a Poisson process of the same intensity, `1 - exp(-lambda v r^d)`, v the measure of the unit ball.
    pub poisson: Vec<f64>,
    /// Where errors come from.
    pub errors: ErrorSource,
    /// Number of test points in each realization.
    pub probes: u64,
}

impl NeighborFunctions {
    pub(super) fn new(plan: &NeighborPlan, sums: &NeighborSums, shape: EnsembleShape) -> Self {
        let points = sums.nearest.points as f64;
        let all = |sums: &DistributionSums| (0..plan.r.len()).map(|i| estimate(sums, i, points)).collect::<Vec<_>>();
        let [g, f] = [&sums.nearest, &sums.empty].map(all);
        let j = |(g, f): (&Estimate, &Estimate)| {
            let (g, f) = (g.as_ref()?.0, f.as_ref()?.0);
            (f < 1.0).then(|| (1.0 - g) / (1.0 - f))
        };
        let dim = plan.domain.dim();
        let in_unit_ball = unit_ball(dim) * shape.mean_points / plan.domain.measure();
        let poisson = |r: &f64| -(-in_unit_ball * r.powi(dim as i32)).exp_m1();
        Self {
            j: g.iter().zip(&f).map(j).collect(),
            g: g.iter().map(|g| Some(g.as_ref()?.0)).collect(),
            g_se: g.iter().map(|g| Some(g.as_ref()?.1)).collect(),
            f: f.iter().map(|f| Some(f.as_ref()?.0)).collect(),
            f_se: f.iter().map(|f| Some(f.as_ref()?.1)).collect(),
            poisson: plan.r.iter().map(poisson).collect(),
            r: plan.r.clone(),
            errors: ErrorSource::of(sums.nearest.realizations),
            probes: plan.probes.len() as u64,
        }
    }
}

/// A value and its error.
type Estimate = Option<(f64, f64)>;

/// The estimate at one distance and its error; `points` independent distances are behind it if there is one realization.
fn estimate(sums: &DistributionSums, i: usize, points: f64) -> Estimate {
    let (norm, at_risk) = (sums.points as f64, sums.at_risk[i] as f64);
    let value = sums.counts[i] as f64 / COUNT_STEPS / norm;
    if norm == 0.0 || (at_risk == 0.0 && value < 1.0) {
        return None;
    }
    let error = match ErrorSource::of(sums.realizations) {
        ErrorSource::AcrossRealizations => {
            let residuals = residuals(sums, i) / (COUNT_STEPS * COUNT_STEPS);
            ratio_standard_error(sums.realizations, residuals, norm)
        }
        _ if at_risk > 0.0 => (1.0 - value) * (value / (at_risk * points.min(norm) / norm)).sqrt(),
        _ => 0.0,
    };
    Some((value, error))
}

/// `sum (c - (sum c / sum N) N)^2`, in squared steps of c.
fn residuals(sums: &DistributionSums, i: usize) -> f64 {
    let k = u128::from(sums.realizations);
    let (sum, square, product) = (sums.counts[i], sums.squares[i], sums.products[i]);
    if k.checked_mul(sums.squared_points).is_some_and(|a| Some(a) == sums.points.checked_mul(sums.points)) {
        // Equal N: K sum c^2 - (sum c)^2 in integers, so that identical realizations have no error at all.
        if let (Some(a), Some(b)) = (k.checked_mul(square), sum.checked_mul(sum)) {
            return a.saturating_sub(b) as f64 / k as f64;
        }
    }
    let ratio = sum as f64 / sums.points as f64;
    square as f64 - 2.0 * ratio * product as f64 + ratio * ratio * sums.squared_points as f64
}

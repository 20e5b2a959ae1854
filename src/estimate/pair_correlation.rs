//! Pair counts -> the pair correlation function g(r).

use super::{ErrorSource, ratio_standard_error};
use crate::accumulate::{PairCounts, WEIGHT_STEPS};
use crate::plan::PairPlan;

/// What the number of pairs is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Normalization {
    /// `n (n - 1)`: g = 1 for n independent uniform points.
    #[default]
    Pairs,
    /// `n^2`, the square of the intensity: g = 1 - 1/n for them. This is the g of the variance formula.
    Intensity,
}

/// `g(r)` per bin: `g_b = |D| sum_k c_b / (v_b sum_k N)` over realizations k, with `c_b` the ordered pairs (or weight sum)
/// in bin b, `v_b` the exact measure of its shell, and `N = n (n - 1)` or `n^2`. A ratio of sums, so that realizations
/// with more points count for more and g is not biased where n varies; with equal n it is the mean of the realizations' g.
#[derive(Debug, Clone, PartialEq)]
pub struct PairCorrelation {
    /// Lower edge of each bin, in the domain's length unit.
    pub r_lo: Vec<f64>,
    /// Centre of each bin.
    pub r: Vec<f64>,
    /// Upper edge of each bin.
    pub r_hi: Vec<f64>,
    /// Ordered pairs, summed over realizations.
    pub count: Vec<u64>,
    /// g.
    pub g: Vec<f64>,
    /// Standard error of g. Theory, for K = 1: `g sqrt(2 / c)`, the unordered pairs being Poisson; an empty bin gets the
    /// error of one unordered pair.
    pub g_se: Vec<f64>,
    /// Where `g_se` comes from.
    pub errors: ErrorSource,
    /// The normalization.
    pub normalization: Normalization,
}

impl Normalization {
    /// `sum N` and `sum N^2` over realizations.
    fn sums(self, counts: &PairCounts) -> (u128, u128) {
        let [n1, n2, n3, n4] = counts.n_moments;
        match self {
            Self::Pairs => (n2 - n1, n4 + n2 - 2 * n3),
            Self::Intensity => (n2, n4),
        }
    }

    /// `sum N` over realizations.
    pub(super) fn pairs(self, counts: &PairCounts) -> f64 {
        self.sums(counts).0 as f64
    }
}

impl PairCorrelation {
    /// The estimate. With no pair of points at all (every n < 2) g is 0/0 and reported as NaN; callers check first.
    pub fn new(plan: &PairPlan, counts: &PairCounts, normalization: Normalization) -> Self {
        let (bins, dim) = (&plan.bins, plan.domain.dim());
        let errors = ErrorSource::of(counts.realizations);
        let (sum_norm, sum_norm_squared) = normalization.sums(counts);
        let steps = counts.moment_steps();
        let mut g = Vec::with_capacity(bins.len());
        let mut g_se = Vec::with_capacity(bins.len());
        for b in 0..bins.len() {
            // Expected ordered pairs under complete randomness, per unit of N.
            let share = bins.shell_measure(b, dim) / plan.domain.measure();
            let expected = share * sum_norm as f64;
            let count = counts.counts[b] as f64;
            let sum = counts.weights.as_ref().map_or(count, |w| w[b] as f64 / WEIGHT_STEPS);
            let g_b = sum / expected;
            g.push(g_b);
            g_se.push(match errors {
                ErrorSource::Theory => (sum / count.max(1.0)).max(1.0) * (2.0 * count.max(2.0)).sqrt() / expected,
                ErrorSource::AcrossRealizations => {
                    let [c2, c_n, c_n2] = counts.moments[b];
                    let c_norm = match normalization {
                        Normalization::Pairs => c_n2 - c_n,
                        Normalization::Intensity => c_n2,
                    };
                    let residuals = residuals(counts, b, c2, c_norm, sum_norm, sum_norm_squared) / (steps * steps);
                    ratio_standard_error(counts.realizations, residuals, expected)
                }
            });
        }
        let edges = bins.edges();
        Self {
            r_lo: edges[..bins.len()].to_vec(),
            r: edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect(),
            r_hi: edges[1..].to_vec(),
            count: counts.counts.clone(),
            g,
            g_se,
            errors,
            normalization,
        }
    }
}

/// `sum (c - (sum c / sum N) N)^2` in squared moment steps.
fn residuals(counts: &PairCounts, bin: usize, c2: u128, c_norm: u128, sum_norm: u128, sum_norm_squared: u128) -> f64 {
    let k = u128::from(counts.realizations);
    // sum c in moment steps, consistent with the per-realization rounding of the other moments.
    let [n1, n2, ..] = counts.n_moments;
    if k.checked_mul(n2) == n1.checked_mul(n1) {
        // Equal n: K sum c^2 - (sum c)^2 in integers, so that identical realizations have no error at all.
        let n = n1 / k;
        let c = counts.moments[bin][1].checked_div(n).unwrap_or(0);
        if let (Some(a), Some(b)) = (k.checked_mul(c2), c.checked_mul(c)) {
            return a.saturating_sub(b) as f64 / k as f64;
        }
    }
    let c: f64 = match &counts.weights {
        Some(weights) => weights[bin] as f64 / WEIGHT_STEPS * counts.moment_steps(),
        None => counts.counts[bin] as f64,
    };
    let ratio = c / sum_norm as f64;
    c2 as f64 - 2.0 * ratio * c_norm as f64 + ratio * ratio * sum_norm_squared as f64
}

//! Pair counts -> the pair correlation function g(r).

use super::Analysis;
use super::ErrorSource;
use super::pair_errors::PairErrors;
use super::ratio::{mean_weight, ratio};
use crate::accumulate::PairCounts;
use crate::named::named;
use crate::plan::{Conventions, PairPlan};

/// What the number of pairs is compared with: in this order in `accumulate::Ratios`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Normalization {
    /// `n (n - 1)`: g = 1 for n independent uniform points.
    #[default]
    Pairs,
    /// `n^2`, the square of the intensity: g = 1 - 1/n for them. This is the g of the variance formula.
    Intensity,
}

named!(Normalization: Pairs = "pairs", Intensity = "intensity");

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
    /// Standard error of g. Theory, for K = 1: `g sqrt(2 / c)`, the unordered pairs being Poisson, times what the spectrum that
    /// goes with g makes of it, or that of clusters (`docs/errors.md`); an empty bin gets the error of one unordered pair.
    pub g_se: Vec<f64>,
    /// Where `g_se` comes from.
    pub errors: ErrorSource,
    /// The normalization.
    pub normalization: Normalization,
}

impl PairCorrelation {
    /// The estimate. With no pair of points at all (every n < 2) g is 0/0 and reported as NaN; callers check first.
    pub fn new(plan: &PairPlan, counts: &PairCounts, normalization: Normalization) -> Self {
        Self::with_errors(plan, counts, normalization, PairErrors::new(plan, counts).as_ref())
    }

    /// The estimate, with Poisson errors for K = 1 if no others are given.
    pub(crate) fn with_errors(
        plan: &PairPlan,
        counts: &PairCounts,
        normalization: Normalization,
        of_one: Option<&PairErrors>,
    ) -> Self {
        let bins = &plan.bins;
        let errors = of_one.map_or(ErrorSource::of(counts.realizations), |e| e.source);
        let mut g = Vec::with_capacity(bins.len());
        let mut g_se = Vec::with_capacity(bins.len());
        let typical = mean_weight(plan, counts);
        for b in 0..bins.len() {
            let ratio = ratio(counts, &counts.bins, b, normalization);
            // Ordered pairs (or their weight) expected under complete randomness.
            let expected = plan.shell_measure(b) / plan.domain.measure() * ratio.norm;
            g.push(ratio.sum / expected);
            let error = match of_one {
                Some(errors) => errors.bins[b].sqrt(),
                None => ratio.standard_error(plan, counts.counts[b], typical),
            };
            g_se.push(error / expected);
        }
        let edges = bins.edges();
        Self {
            r_lo: edges[..bins.len()].to_vec(),
            r: bins.centres(),
            r_hi: edges[1..].to_vec(),
            count: counts.counts.clone(),
            g,
            g_se,
            errors,
            normalization,
        }
    }

    /// The same with the labels of other programs: of PSA the left edges of the bins, and with its defect also g beyond half
    /// the side, where it divides by whole rings that the square torus does not hold.
    pub fn labelled(self, plan: &PairPlan, conventions: &Conventions) -> Self {
        if !conventions.pairs {
            return self;
        }
        let part = |b| plan.shell_measure(b) / plan.bins.shell_measure(b, plan.domain.dim());
        let scale = |values: Vec<f64>| values.into_iter().enumerate().map(|(b, g)| g * part(b)).collect();
        let (g, g_se) =
            if conventions.bug_compatible { (scale(self.g), scale(self.g_se)) } else { (self.g, self.g_se) };
        Self { r: self.r_lo.clone(), g, g_se, ..self }
    }
}

impl Analysis {
    /// g per bin.
    pub fn pair_correlation(&self) -> Option<&PairCorrelation> {
        self.get()
    }
}

//! Pair counts -> Ripley's K(r), L(r) and the mean number of neighbours.

use super::Analysis;
use super::pair_errors::PairErrors;
use super::ratio::{mean_weight, ratio};
use super::{ErrorSource, Normalization};
use crate::accumulate::PairCounts;
use crate::ball::unit_ball;
use crate::plan::PairPlan;

/// `K(r) = |D| sum_k C(r) / sum_k N` over realizations k at the upper edges of the bins, with `C` the ordered pairs closer
/// than r (or their weight) and `N = n (n - 1)` or `n^2`: `lambda K(r)` is the mean number of further points within r of a
/// point of an endless pattern (Ripley 1976; Illian et al. 2008, section 4.3). `L(r) = (K / b)^(1/d)`, `b r^d` being the measure of a ball
/// (Besag 1977): `L(r) = r` for complete spatial randomness.
///
/// Standard errors are across realizations. For K = 1 they start from those of complete spatial randomness, with unordered pairs
/// Poisson: the leading term of the variance of K (Ripley, Statistical Inference for Spatial Processes, 1988, chapter 3),
/// exact on a torus up to 1/n; in a window edge effects add to it as r grows. The spectrum that goes with the pairs, or
/// clusters, change them as those of g (`docs/errors.md`).
#[derive(Debug, Clone, PartialEq)]
pub struct KFunction {
    /// Upper edges of the bins, in the domain's length unit.
    pub r: Vec<f64>,
    /// K, in units of the domain's measure.
    pub k: Vec<f64>,
    /// Standard error of K.
    pub k_se: Vec<f64>,
    /// L, in the domain's length unit.
    pub l: Vec<f64>,
    /// Standard error of L, to first order; `None` where K is 0.
    pub l_se: Vec<Option<f64>>,
    /// `L - r`.
    pub l_minus_r: Vec<f64>,
    /// Mean number of further points within r of a point: K times the mean of `N / n` over |D|, which is `sum C / sum n` where
    /// nothing is weighted. With border correction or weights of points, K times the mean of n over |D|.
    pub neighbors: Vec<f64>,
    /// Where the errors come from.
    pub errors: ErrorSource,
    /// The normalization.
    pub normalization: Normalization,
}

impl KFunction {
    /// The estimate, `None` if the counts hold no cumulative sums. Bins must start at 0, which plans check. `mean_points` is
    /// the mean of n.
    pub fn new(plan: &PairPlan, counts: &PairCounts, normalization: Normalization, mean_points: f64) -> Option<Self> {
        counts.cumulative.as_ref()?;
        Self::with_errors(plan, counts, normalization, mean_points, PairErrors::new(plan, counts).as_ref())
    }

    /// The estimate, with Poisson errors for K = 1 if no others are given.
    pub(crate) fn with_errors(
        plan: &PairPlan,
        counts: &PairCounts,
        normalization: Normalization,
        mean_points: f64,
        of_one: Option<&PairErrors>,
    ) -> Option<Self> {
        let cumulative = counts.cumulative.as_ref()?;
        let (measure, dim) = (plan.domain.measure(), plan.domain.dim());
        let ball = unit_ball(dim);
        let mut closer = 0;
        let (mut k, mut k_se, mut l, mut l_se) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let typical = mean_weight(plan, counts);
        for bin in 0..plan.bins.len() {
            let ratio = ratio(counts, cumulative, bin, normalization);
            closer += counts.counts[bin];
            let error = match of_one {
                Some(errors) => errors.cumulative[bin].sqrt(),
                None => ratio.standard_error(plan, closer, typical),
            };
            let (value, se) = (measure * ratio.sum / ratio.norm, measure * error / ratio.norm);
            let radius = (value / ball).powf(1.0 / dim as f64);
            k.push(value);
            k_se.push(se);
            l.push(radius);
            // dL = dK L / (d K)
            l_se.push((value > 0.0).then(|| se * radius / (dim as f64 * value)));
        }
        let points = mean_points * counts.realizations as f64;
        let others = if plan.border() || plan.masses {
            mean_points
        } else {
            cumulative.norm(0)[normalization as usize].sum as f64 / points
        };
        let neighbors = k.iter().map(|k| others / measure * k).collect();
        let r = plan.bins.edges()[1..].to_vec();
        let l_minus_r = l.iter().zip(&r).map(|(l, r)| l - r).collect();
        let errors = of_one.map_or(ErrorSource::of(counts.realizations), |e| e.source);
        Some(Self { r, k, k_se, l, l_se, l_minus_r, neighbors, errors, normalization })
    }
}

impl Analysis {
    /// K, L and the mean number of neighbours.
    pub fn k_function(&self) -> Option<&KFunction> {
        self.get()
    }
}

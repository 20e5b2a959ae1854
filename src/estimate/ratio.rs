//! `sum c / sum N` over realizations, with its error: what g, K and their like have in common.

use super::{ErrorSource, Normalization, ratio_standard_error};
use crate::accumulate::{PairCounts, Ratios, Steps};
use crate::plan::PairPlan;

/// One bin of `Ratios`, divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ratio {
    /// `sum c`, in units of 1.
    pub(super) sum: f64,
    /// `sum N`, in units of 1.
    pub(super) norm: f64,
    /// Standard error of `sum c / sum N`, times `sum N`, across realizations; `None` for one realization.
    pub(super) error: Option<f64>,
}

impl Ratio {
    /// Standard error of `sum`: across realizations, or for one of them theory, as if unordered pairs were Poisson:
    /// `w sqrt(2 count)` with `w` the mean weight of the `count` ordered pairs (how weights spread about it is left out).
    /// No pair at all gets the error of one unordered pair of `typical` weight. With border correction, where most pairs are seen
    /// from one end only, twice the pairs seen, all of `typical` weight, stand for their variance: an upper bound where weights are alike.
    pub(super) fn standard_error(&self, plan: &PairPlan, count: u64, typical: f64) -> f64 {
        self.error.unwrap_or_else(|| {
            if plan.border() {
                return (2.0 * typical * self.sum.max(2.0 * typical)).sqrt();
            }
            let mean_weight = if count > 0 { self.sum / count as f64 } else { typical };
            mean_weight * (2.0 * count.max(2) as f64).sqrt()
        })
    }
}

/// The mean weight of all pairs counted, 1 if there are none. With border correction of those seen from deep inside: the part of all
/// pairs that is compared with what the first bin is, where nearly every point is deep.
pub(super) fn mean_weight(plan: &PairPlan, counts: &PairCounts) -> f64 {
    if plan.border() && !plan.masses {
        return 1.0;
    }
    let norm = |bin| counts.bins.norm(bin)[Normalization::Intensity as usize].sum as f64;
    let seen = |bin| if plan.border() { norm(bin) / norm(0) } else { 1.0 };
    let pairs: f64 = counts.counts.iter().enumerate().map(|(bin, &c)| c as f64 * seen(bin)).sum();
    let sum: f64 = (0..counts.counts.len()).map(|bin| counts.sum(bin)).sum();
    if pairs > 0.0 { sum / pairs } else { 1.0 }
}

/// The ratio of one bin.
pub(super) fn ratio(counts: &PairCounts, ratios: &Ratios, bin: usize, normalization: Normalization) -> Ratio {
    ratio_of(counts.realizations, counts.steps, ratios, bin, normalization)
}

/// The same of sums that are not a `PairCounts`.
pub(super) fn ratio_of(
    realizations: u64,
    steps: Steps,
    ratios: &Ratios,
    bin: usize,
    normalization: Normalization,
) -> Ratio {
    let which = normalization as usize;
    let unit = |bits: u32| 2f64.powi(bits as i32);
    let norm = ratios.norm(bin)[which];
    let sum = ratios.sums[bin] as f64 / unit(steps.sum_bits);
    let sum_norm = norm.sum as f64 / unit(steps.norm_bits);
    let error = (ErrorSource::of(realizations) == ErrorSource::AcrossRealizations).then(|| {
        let [c_unit, n_unit] = steps.moment_bits.map(unit);
        let residuals = residuals(realizations, ratios, bin, which, sum * c_unit, sum_norm * n_unit);
        ratio_standard_error(realizations, residuals / (c_unit * c_unit), 1.0)
    });
    Ratio { sum, norm: sum_norm, error }
}

/// `sum (c - (sum c / sum N) N)^2` in squared moment steps of c; `sum_c` and `sum_norm` in moment steps.
fn residuals(realizations: u64, ratios: &Ratios, bin: usize, which: usize, sum_c: f64, sum_norm: f64) -> f64 {
    let k = u128::from(realizations);
    let (norm, c2, c_norm) = (ratios.norm(bin)[which], ratios.squares[bin], ratios.products[bin][which]);
    if k.checked_mul(norm.square).is_some_and(|a| Some(a) == norm.moment.checked_mul(norm.moment)) {
        // Equal N: K sum c^2 - (sum c)^2 in integers, so that identical realizations have no error at all.
        let c = c_norm.checked_div(norm.moment / k).unwrap_or(0);
        if let (Some(a), Some(b)) = (k.checked_mul(c2), c.checked_mul(c)) {
            return a.saturating_sub(b) as f64 / k as f64;
        }
    }
    let ratio = sum_c / sum_norm;
    c2 as f64 - 2.0 * ratio * c_norm as f64 + ratio * ratio * norm.square as f64
}

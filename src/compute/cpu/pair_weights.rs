//! What pairs add beside their count: edge-correction weights. Formulas: see `reference`.

use crate::accumulate::{PairHistogram, WEIGHT_STEPS};
use crate::plan::PairPlan;

/// The weight of any pair of one realization: translation weights as in `reference::translation_weight`, operation for
/// operation, with the quotients of sides taken once.
pub(super) struct PairWeights<'a> {
    axes: &'a [&'a [u64]],
    sides: [f64; 3],
}

impl<'a> PairWeights<'a> {
    pub(super) fn new(plan: &PairPlan, axes: &'a [&'a [u64]]) -> Self {
        let mut sides = [0.0; 3];
        for (a, side) in sides.iter_mut().zip(plan.domain.sides()) {
            *a = side / plan.domain.length_unit();
        }
        Self { axes, sides }
    }

    #[inline(always)]
    pub(super) fn translation(&self, i: usize, j: usize) -> u64 {
        let mut weight = 1.0;
        for (axis, a) in self.axes.iter().zip(self.sides) {
            // Dividing by a power of two and multiplying with its inverse are the same, exact operation.
            let h = axis[i].abs_diff(axis[j]) as f64 * 2f64.powi(-64);
            weight *= a / (a - h);
        }
        (weight * WEIGHT_STEPS).round_ties_even() as u64
    }
}

/// Sums over unordered pairs, of both orders.
pub(super) struct WeightSums {
    weights: Vec<u128>,
}

impl WeightSums {
    /// `None` where pairs are only counted.
    pub(super) fn new(plan: &PairPlan) -> Option<Self> {
        plan.weighted().then(|| Self { weights: vec![0; plan.bins.len()] })
    }

    /// Adds the pairs (i, j) and (j, i).
    #[inline(always)]
    pub(super) fn add(&mut self, of: &PairWeights<'_>, bin: usize, i: usize, j: usize) {
        self.weights[bin] += 2 * u128::from(of.translation(i, j));
    }

    /// The histogram with these sums, leaving nothing.
    pub(super) fn take(&mut self, histogram: PairHistogram) -> PairHistogram {
        let weights = self.weights.iter_mut().map(std::mem::take).collect();
        PairHistogram { weights: Some(weights), ..histogram }
    }
}

//! What the dispatches of a plan counted, and how it becomes `PairCounts`.

use std::ops::Range;

use super::pair_specs::Layout;
use crate::accumulate::ComputedBy;
use crate::accumulate::{BorderHistogram, PairCounts, PairHistogram};
use crate::plan::{Correction, PairPlan};
use crate::points::Ensemble;
use crate::points::geometry;

/// What all dispatches counted, realization by realization.
pub(super) struct Sums {
    pub(super) layout: Layout,
    sums: Vec<u128>,
}

impl Sums {
    pub(super) fn new(plan: &PairPlan, realizations: usize) -> Self {
        let layout = Layout::new(plan);
        Self { sums: vec![0; realizations * layout.values()], layout }
    }

    /// Adds the histograms of one dispatch.
    pub(super) fn add(&mut self, realizations: Range<usize>, found: &[u32]) {
        let (plain, values) = (self.layout.plain(), self.layout.values());
        for (k, words) in realizations.zip(found.chunks_exact(self.layout.words as usize)) {
            let sums = &mut self.sums[k * values..(k + 1) * values];
            for (word, sum) in sums.iter_mut().enumerate() {
                *sum += u128::from(words[word]);
                if word >= plain {
                    *sum += u128::from(words[word + self.layout.sums as usize]) << 32;
                }
            }
        }
    }

    pub(super) fn finish(self, computed_by: ComputedBy, plan: &PairPlan, ensemble: &Ensemble) -> PairCounts {
        let bins = plan.bins.len();
        let mut counts = PairCounts::new(computed_by, plan);
        let realizations = self.sums.chunks_exact(self.layout.values()).enumerate();
        for (k, (pairs, rest)) in realizations.map(|(k, sums)| (k, sums.split_at(bins))) {
            // Each unordered pair is two ordered ones.
            let ordered: Vec<u64> = pairs.iter().map(|&c| 2 * c as u64).collect();
            // Excesses over a weight of 1: of both orders together, or of either.
            let weights = |orders: u128| {
                let excess = rest.iter().map(|e| orders * e);
                ordered.iter().zip(excess).map(|(&c, e)| (u128::from(c) << 32) + e).collect()
            };
            let weights = match plan.correction {
                Correction::Translation => Some(weights(2)),
                Correction::Isotropic => Some(weights(1)),
                Correction::None | Correction::Border => None,
            };
            let border = plan.border().then(|| {
                let norms = geometry::border_norms(&depths(plan, &ensemble.lengths(k)), bins, None);
                let (counts, ends) = rest.split_at(bins);
                BorderHistogram { counts: counts.to_vec(), ends: ends.to_vec(), norms }
            });
            let n = ensemble.points_in(k) as u64;
            counts.add(&PairHistogram { border, ..PairHistogram::new(n, ordered, weights) });
        }
        counts
    }
}

/// Per point of a realization, the number of bins whose upper edge is at most its distance from the border.
pub(super) fn depths(plan: &PairPlan, axes: &[&[u64]]) -> Vec<u32> {
    let border = plan.domain.border();
    let depth = |i| geometry::depth(&plan.thresholds, border.distance_of(axes, i)) as u32;
    (0..axes[0].len()).map(depth).collect()
}

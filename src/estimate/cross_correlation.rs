//! Pair counts of two classes of points -> g and K within each and between them.

use super::Analysis;
use super::{KFunction, Normalization, PairCorrelation};
use crate::accumulate::CrossCounts;
use crate::plan::PairPlan;

/// `g_AB(r) = |D| sum_k c_AB / (v sum_k n_A n_B)` per bin, with `c_AB` the ordered pairs from a point of A to one of B, and
/// `v` the measure of the shell; 1 if A and B are independent (Illian et al. 2008, section 4.3.4). Pairs are taken in both
/// orders, over `2 n_A n_B`: the same, but where a pair's edge correction depends on its order both orders count alike.
/// Errors of one realization are those of Poisson pairs, within classes too.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossCorrelation {
    /// The names of the classes.
    pub classes: [String; 2],
    /// g of A alone.
    pub a: PairCorrelation,
    /// g of B alone.
    pub b: PairCorrelation,
    /// g between A and B; its counts are pairs from A to B.
    pub between: PairCorrelation,
}

impl CrossCorrelation {
    /// The estimates. Within a class too small for pairs g is NaN.
    pub fn new(classes: [String; 2], plan: &PairPlan, counts: &CrossCounts, normalization: Normalization) -> Self {
        let g = |counts| PairCorrelation::with_errors(plan, counts, normalization, None);
        let mut between = g(&counts.between);
        between.count.iter_mut().for_each(|c| *c /= 2);
        Self { classes, a: g(&counts.a), b: g(&counts.b), between }
    }
}

/// `K_AB(r) = |D| sum_k C_AB / sum_k n_A n_B`: `lambda_B K_AB(r)` is the mean number of points of B within r of a point of
/// A, `b r^d` (the measure of a ball) if A and B are independent (Lotwick and Silverman 1982; Illian et al. 2008, section
/// 4.3.4), with L as for one class. How many points a class has is not kept: `neighbors` of these are empty.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossK {
    /// The names of the classes.
    pub classes: [String; 2],
    /// K of A alone.
    pub a: KFunction,
    /// K of B alone.
    pub b: KFunction,
    /// K between A and B, the same in both directions.
    pub between: KFunction,
}

impl CrossK {
    /// The estimates, `None` if the counts hold no cumulative sums. Within a class too small for pairs K is NaN.
    pub fn new(
        classes: [String; 2],
        plan: &PairPlan,
        counts: &CrossCounts,
        normalization: Normalization,
    ) -> Option<Self> {
        let k = |counts| {
            let k = KFunction::with_errors(plan, counts, normalization, f64::NAN, None)?;
            Some(KFunction { neighbors: Vec::new(), ..k })
        };
        Some(Self { classes, a: k(&counts.a)?, b: k(&counts.b)?, between: k(&counts.between)? })
    }
}

impl Analysis {
    /// K of two classes of points, and between them.
    pub fn cross_k(&self) -> Option<&CrossK> {
        self.get()
    }

    /// g of two classes of points, and between them.
    pub fn cross(&self) -> Option<&CrossCorrelation> {
        self.get()
    }
}

//! Raw sums of `pair_counts`: integers only, so any order of additions gives the same sums.

use crate::compute::ComputedBy;
use crate::error::{Error, Result};

/// Steps per unit of an edge-correction weight: weights are summed as multiples of 2^-32.
pub const WEIGHT_STEPS: f64 = 4_294_967_296.0;

/// The histogram of one realization: what a kernel delivers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PairHistogram {
    /// Number of points.
    pub n: u64,
    /// Ordered pairs per bin.
    pub counts: Vec<u64>,
    /// Sum over the same pairs of the edge-correction weight, in steps of 2^-32; `None` without correction.
    pub weights: Option<Vec<u128>>,
}

/// Sums over realizations of what g and its error need. Merging is exact and associative.
///
/// With `c` the ordered pairs of a realization in a bin (or its weight sum), and `n` its points, the moments allow the
/// ratio estimate `sum c / sum N` for both normalizations `N = n (n - 1)` and `N = n^2`, with its error, also where n
/// differs between realizations.
#[derive(Debug, Clone, PartialEq)]
pub struct PairCounts {
    /// Who computed them.
    pub computed_by: ComputedBy,
    /// Number of realizations.
    pub realizations: u64,
    /// Sums of n, n^2, n^3, n^4.
    pub n_moments: [u128; 4],
    /// Ordered pairs per bin.
    pub counts: Vec<u64>,
    /// Weight sums per bin in steps of 2^-32, `None` without edge correction.
    pub weights: Option<Vec<u128>>,
    /// Per bin: sums of c^2, c n, c n^2, where c is the count (exact), or the weight sum in steps of 2^-16 (rounded per
    /// realization; only the error estimate uses it).
    pub moments: Vec<[u128; 3]>,
}

/// Bits of a weight sum that its second moment drops, so that its square fits u128.
const MOMENT_SHIFT: u32 = 16;

impl PairCounts {
    /// No realizations yet.
    pub fn new(computed_by: ComputedBy, bins: usize, weighted: bool) -> Self {
        Self {
            computed_by,
            realizations: 0,
            n_moments: [0; 4],
            counts: vec![0; bins],
            weights: weighted.then(|| vec![0; bins]),
            moments: vec![[0; 3]; bins],
        }
    }

    /// Steps per unit of `c` in `moments`.
    pub fn moment_steps(&self) -> f64 {
        if self.weights.is_some() { WEIGHT_STEPS / f64::from(1 << MOMENT_SHIFT) } else { 1.0 }
    }

    /// Adds one realization.
    pub fn add(&mut self, histogram: &PairHistogram) {
        let n = u128::from(histogram.n);
        self.realizations += 1;
        for (power, sum) in self.n_moments.iter_mut().enumerate() {
            *sum += n.pow(power as u32 + 1);
        }
        for (sum, c) in self.counts.iter_mut().zip(&histogram.counts) {
            *sum += c;
        }
        if let (Some(sums), Some(weights)) = (&mut self.weights, &histogram.weights) {
            for (sum, w) in sums.iter_mut().zip(weights) {
                *sum += w;
            }
        }
        for (bin, moments) in self.moments.iter_mut().enumerate() {
            let c = match &histogram.weights {
                Some(weights) => (weights[bin] + (1 << (MOMENT_SHIFT - 1))) >> MOMENT_SHIFT,
                None => u128::from(histogram.counts[bin]),
            };
            moments[0] += c * c;
            moments[1] += c * n;
            moments[2] += c * n * n;
        }
    }

    /// Adds other realizations of the same process, counted in the same bins by the same method.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        if self.counts.len() != other.counts.len() || self.weights.is_some() != other.weights.is_some() {
            let reason = format!("{} bins cannot be merged with {}", self.counts.len(), other.counts.len());
            return Err(Error::input("pair counts", reason));
        }
        self.computed_by = self.computed_by.merge(&other.computed_by);
        self.realizations += other.realizations;
        for (a, b) in self.n_moments.iter_mut().zip(&other.n_moments) {
            *a += b;
        }
        for (a, b) in self.counts.iter_mut().zip(&other.counts) {
            *a += b;
        }
        if let (Some(a), Some(b)) = (&mut self.weights, &other.weights) {
            for (a, b) in a.iter_mut().zip(b) {
                *a += b;
            }
        }
        for (a, b) in self.moments.iter_mut().zip(&other.moments) {
            for (a, b) in a.iter_mut().zip(b) {
                *a += b;
            }
        }
        Ok(())
    }
}

//! Pair counts in fine bins -> the bandwidth of least integrated squared error, as the data themselves estimate it.

use rayon::prelude::*;

use super::Normalization;
use super::ratio::ratio;
use crate::accumulate::PairCounts;
use crate::plan::{BandwidthSearch, Divisor, Smoothing, sphere_surface};

/// Bandwidths tried, log-spaced, before the best is refined between its neighbours.
const TRIED: usize = 32;

/// Golden-section steps: each narrows the interval to 0.618 of it.
const REFINED: usize = 16;

/// Least-squares cross-validation (Guan, A least-squares cross-validation bandwidth selection approach in pair correlation
/// function estimations, Statistics and Probability Letters 77, 2007). The integrated squared error of `g_b` is, but for a
/// term without b, estimated by
///
/// ```text
/// M(b) = int g_b(r)^2 S(r) dr - 2 |D| / sum N sum_(i != j) w_ij g_b^(-ij)(d_ij)
/// ```
///
/// over the same distances in the integral and the sum of pairs, `g_b^(-ij)` being the estimate without that pair, all
/// realizations together.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct CrossValidation {
    /// The bandwidth with the least score.
    pub bandwidth: f64,
    /// M there.
    pub score: f64,
    /// Smallest and largest bandwidth tried.
    pub range: [f64; 2],
    /// The distances over which the error is integrated.
    pub distances: [f64; 2],
    /// Whether the least score is at an end of the range, so that the minimum may lie outside.
    pub at_end: bool,
}

impl CrossValidation {
    /// The best bandwidth: log-spaced over the range, then a golden section between the neighbours of the best.
    pub fn new(search: &BandwidthSearch, counts: &PairCounts, divisor: Divisor, normalization: Normalization) -> Self {
        let score = |b: f64| Self::score(search, counts, divisor, normalization, b);
        let [lo, hi] = search.range;
        let tried: Vec<f64> = (0..TRIED).map(|k| lo * (hi / lo).powf(k as f64 / (TRIED - 1) as f64)).collect();
        let scores: Vec<f64> = tried.iter().map(|&b| score(b)).collect();
        let best = (0..TRIED).min_by(|&a, &b| scores[a].total_cmp(&scores[b])).unwrap_or(0);
        let (mut bandwidth, mut least) = (tried[best], scores[best]);
        let at_end = best == 0 || best == TRIED - 1;
        if !at_end {
            let golden = (5f64.sqrt() - 1.0) / 2.0;
            let (mut a, mut b) = (tried[best - 1], tried[best + 1]);
            let (mut inner, mut outer) = (b - golden * (b - a), a + golden * (b - a));
            let (mut f, mut g) = (score(inner), score(outer));
            for _ in 0..REFINED {
                for (x, y) in [(inner, f), (outer, g)] {
                    if y < least {
                        (bandwidth, least) = (x, y);
                    }
                }
                if f < g {
                    (b, outer, g) = (outer, inner, f);
                    inner = b - golden * (b - a);
                    f = score(inner);
                } else {
                    (a, inner, f) = (inner, outer, g);
                    outer = a + golden * (b - a);
                    g = score(outer);
                }
            }
        }
        Self { bandwidth, score: least, range: search.range, distances: search.distances, at_end }
    }

    /// M(b), with every pair at the centre of its bin and with the mean weight of its bin.
    pub fn score(
        search: &BandwidthSearch,
        counts: &PairCounts,
        divisor: Divisor,
        normalization: Normalization,
        bandwidth: f64,
    ) -> f64 {
        let kernel = Smoothing { shape: search.shape, bandwidth };
        let (bins, domain) = (&search.pairs.bins, &search.pairs.domain);
        let density = domain.measure() / ratio(counts, &counts.bins, 0, normalization).norm;
        let width = bins.r_max() / bins.len() as f64;
        let centre = |b: usize| width * (b as f64 + 0.5);
        let surface = |b: usize| sphere_surface(centre(b), domain.dim());
        // What a pair is divided by as it enters the sum, or the sum at its end.
        let (entering, leaving): (Vec<f64>, Vec<f64>) = (0..bins.len())
            .map(|b| if divisor == Divisor::D { (1.0 / surface(b), 1.0) } else { (1.0, 1.0 / surface(b)) })
            .unzip();
        let masses: Vec<f64> = (0..bins.len()).map(|b| counts.sum(b) * entering[b]).collect();
        let reach = (kernel.reach() / width).ceil() as usize;
        let values: Vec<f64> = (0..=2 * reach).map(|k| kernel.value((k as f64 - reach as f64) * width)).collect();
        let [from, to] = search.distances;
        let term = |b: usize| {
            let first = b.saturating_sub(reach);
            let masses = &masses[first..(b + reach + 1).min(bins.len())];
            let sum: f64 = masses.iter().zip(&values[first + reach - b..]).map(|(m, k)| m * k).sum();
            let g = density * leaving[b] * sum;
            let (weight, count) = (counts.sum(b), counts.counts[b] as f64);
            // A pair sees itself, in both orders: count / 2 pairs, each of twice the mean weight.
            let own =
                if count > 0.0 { density * kernel.peak() / surface(b) * 2.0 * weight * weight / count } else { 0.0 };
            g * g * surface(b) * width - 2.0 * density * (weight * g - own)
        };
        let inside: Vec<f64> =
            (0..bins.len()).into_par_iter().filter(|&b| (from..=to).contains(&centre(b))).map(term).collect();
        inside.iter().sum()
    }
}

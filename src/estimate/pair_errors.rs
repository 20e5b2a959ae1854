//! Errors of g and K of a single realization, whose points are correlated.
//!
//! The number of ordered pairs in a bin is linear in the power: `C = sum_m b_m (|s_m|^2 - n) / |D|` with b the Fourier transform of the
//! shell, so that its variance is a double sum over the covariance of `|s_m|^2`. Where the amplitudes of different modes are
//! as good as independent that is `2 n^2 / |D|^2 sum_(m != 0) b_m^2 P_m^2`: for P = 1 twice the pairs of independent points, by Parseval's
//! theorem, for regular points, of small P at low frequencies, far less than that as soon as many pairs are counted. The mode 0 is the
//! number of points, by which g and K are divided.
//!
//! - Points that are not clustered: P is read off the pairs themselves, up to three spacings; the variance of Poisson pairs,
//!   twice their number, is multiplied by what that P makes of it.
//! - Clusters (`Clusters`): P is that of the Thomas process that goes with them, and what the few clusters add is added.
//!
//! In a window its sides add to it (`WindowEdges`).
//!
//! `docs/errors.md` says how often these errors hold what they promise.

use super::ErrorSource;
use super::clusters::{BinPairs, Clusters};
use super::ratio::mean_weight;
use super::spectrum_of_pcf::ball;
use super::window_edges::WindowEdges;
use crate::accumulate::PairCounts;
use crate::plan::{PairPlan, sphere_surface};

/// Pairs up to so many spacings, `(|D| / n)^(1/d)`, make P.
const REACH: f64 = 3.0;

/// From so many waves per spacing on P counts as 1.
const HIGHEST: f64 = 2.0;

/// Bins that are wider than this part of a spacing do not show P.
const WIDEST: f64 = 0.5;

/// Nor do those that begin beyond a ball with so many points.
const LEFT_OUT: f64 = 0.05;

/// Variances of the sums of one realization: what errors of g and K are made of.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PairErrors {
    /// What they rest on.
    pub(super) source: ErrorSource,
    /// Per bin, of its sum.
    pub(super) bins: Vec<f64>,
    /// Per bin, of the sum up to its upper edge.
    pub(super) cumulative: Vec<f64>,
}

/// One realization, seen by its pairs.
struct Seen<'a> {
    plan: &'a PairPlan,
    /// Points, and ordered pairs of them.
    n: f64,
    norm: f64,
    pairs: Vec<BinPairs>,
}

impl PairErrors {
    /// `None` where neither theory goes: several realizations, minus sampling, weights of points, bins that show too little.
    pub(crate) fn new(plan: &PairPlan, counts: &PairCounts) -> Option<Self> {
        let seen = Seen::new(plan, counts)?;
        let clusters = seen.clusters();
        if clusters.is_none() && !seen.shows_spectrum() {
            return None;
        }
        let [of_bins, of_balls] = seen.spectral_ratios(clusters.as_ref());
        let edges = seen.edge_variances(clusters.as_ref());
        let typical = mean_weight(plan, counts);
        let variances = |cumulative: bool, ratios: &[f64]| {
            let (mut count, mut found, mut expected) = (0, 0.0, 0.0);
            let variance = |(b, ratio): (usize, &f64)| {
                let BinPairs { edges: [lo, hi], found: f, expected: e } = seen.pairs[b];
                let mut first = lo;
                if cumulative {
                    (count, found, expected) = (count + counts.counts[b], found + f, expected + e);
                    first = plan.bins.edges()[0];
                } else {
                    (count, found, expected) = (counts.counts[b], f, e);
                }
                let unweighted = match &clusters {
                    Some(clusters) => {
                        let within = clusters.pairs(seen.norm, seen.n, [first, hi]);
                        2.0 * expected * ratio + clusters.pair_variance(seen.n, within)
                    }
                    None => 2.0 * found * (1.0 + (ratio - 1.0) * together(found / expected, found / seen.n)),
                } + edges[usize::from(cumulative)][b];
                // A pair counts for its weight. No less than the variance of one unordered pair.
                let weight = if count > 0 { found / count as f64 } else { typical };
                (weight * unweighted).max(4.0 * weight * weight)
            };
            ratios.iter().enumerate().map(variance).collect()
        };
        Some(Self {
            source: if clusters.is_some() { ErrorSource::ClusterTheory } else { ErrorSource::SpectralTheory },
            bins: variances(false, &of_bins),
            cumulative: variances(true, &of_balls),
        })
    }
}

/// How much the spectrum has to say of so many pairs, as a part of those of independent points and per point. Few pairs have no
/// point in common with another; of those that could, g^2 are there. Where a point has many, the number of points that
/// it has near, which is what the spectrum is about, is all that matters.
fn together(g: f64, per_point: f64) -> f64 {
    g.min(1.0).powf(2.0 / (1.0 + per_point * per_point))
}

impl<'a> Seen<'a> {
    fn new(plan: &'a PairPlan, counts: &PairCounts) -> Option<Self> {
        let norm = counts.bins.norm(0)[0].sum as f64;
        if counts.realizations != 1 || plan.border() || plan.masses || norm < 2.0 {
            return None;
        }
        let edges = plan.bins.edges();
        let of_bin = |b: usize| BinPairs {
            edges: [edges[b], edges[b + 1]],
            found: counts.sum(b),
            expected: norm * plan.shell_measure(b) / plan.domain.measure(),
        };
        let n = 0.5 + (0.25 + norm).sqrt();
        let seen = Self { plan, n, norm, pairs: (0..plan.bins.len()).map(of_bin).collect() };
        (seen.ball(edges[0]) * n < LEFT_OUT * plan.domain.measure()).then_some(seen)
    }

    fn dim(&self) -> usize {
        self.plan.domain.dim()
    }

    /// The measure of a ball.
    fn ball(&self, r: f64) -> f64 {
        sphere_surface(r, self.dim()) * r / self.dim() as f64
    }

    fn spacing(&self) -> f64 {
        (self.plan.domain.measure() / self.n).powf(1.0 / self.dim() as f64)
    }

    /// Up to where pairs make P.
    fn reach(&self) -> f64 {
        (REACH * self.spacing()).min(self.plan.domain.inner_diameter() / 2.0).min(self.plan.bins.r_max())
    }

    fn shows_spectrum(&self) -> bool {
        let near = self.pairs.iter().take_while(|bin| bin.edges[0] < self.reach());
        near.map(|bin| bin.edges[1] - bin.edges[0]).fold(0.0, f64::max) <= WIDEST * self.spacing()
    }

    fn clusters(&self) -> Option<Clusters> {
        let domain = &self.plan.domain;
        // In a window the number of points near its sides moves all sums of long distances together.
        let limit = if domain.is_torus() { f64::INFINITY } else { (domain.inner_diameter() / 8.0).max(self.reach()) };
        let near = self.pairs.iter().take_while(|bin| bin.edges[1] <= limit).count().max(1);
        Clusters::of_pairs(self.dim(), self.n, self.norm, &self.pairs[..near])
    }

    /// Per bin, and per ball up to its upper edge, `sum_(m != 0) b_m^2 P_m^2` over what it is for P = 1.
    fn spectral_ratios(&self, clusters: Option<&Clusters>) -> [Vec<f64>; 2] {
        let (dim, edges) = (self.dim(), self.plan.bins.edges());
        // The ball of frequencies that belongs to mode 0.
        let mean = (1.0 / (self.plan.domain.measure() * self.ball(1.0))).powf(1.0 / dim as f64);
        let highest = mean + clusters.map_or(HIGHEST / self.spacing(), Clusters::highest_frequency);
        // The square of the transform of a ball of radius r repeats every 1 / 2r.
        let finest = (0.125 / self.plan.bins.r_max()).min(highest / 16.0);
        let shells: Vec<f64> = (0..self.pairs.len()).map(|b| self.plan.bins.shell_measure(b, dim)).collect();
        let balls = shells.iter().scan(0.0, |sum, shell| {
            *sum += shell;
            Some(*sum)
        });
        let measures = [shells.clone(), balls.collect()];
        let mut lost = [vec![0.0; self.pairs.len()], vec![0.0; self.pairs.len()]];
        let mut start = 0.0;
        while start < highest {
            // Where many waves pass, some of each octave stand for all.
            let end = (start + finest.max(start / 2048.0)).min(highest);
            let nu = 0.5 * (start + end);
            let balls: Vec<f64> = edges.iter().map(|&r| ball(dim, nu, r)).collect();
            let squared = match clusters {
                Some(clusters) => clusters.power(nu).powi(2),
                None => self.squared_power(&balls, &measures[0]),
            };
            let beyond_mean = (end - start.max(mean).min(end)) / (end - start);
            let more = sphere_surface(nu, dim) * (end - start) * (squared * beyond_mean - 1.0);
            for b in 0..self.pairs.len() {
                lost[0][b] += more * (balls[b + 1] - balls[b]).powi(2);
                lost[1][b] += more * (balls[b + 1] - balls[0]).powi(2);
            }
            start = end;
        }
        let ratio = |(lost, measure): (&f64, &f64)| (1.0 + lost / measure).max(0.0);
        [0, 1].map(|of| lost[of].iter().zip(&measures[of]).map(ratio).collect())
    }

    /// `P^2`, less what the scatter of this P adds to it.
    fn squared_power(&self, balls: &[f64], measures: &[f64]) -> f64 {
        let (p, noise) = self.power_and_noise(self.reach(), |b| (balls[b + 1] - balls[b]) / measures[b]);
        p.powi(2) / (1.0 + noise)
    }

    fn power(&self, nu: f64, reach: f64) -> f64 {
        let (dim, bins) = (self.dim(), &self.plan.bins);
        let transform = |b: usize| {
            let [lo, hi] = self.pairs[b].edges.map(|r| ball(dim, nu, r));
            (hi - lo) / bins.shell_measure(b, dim)
        };
        self.power_and_noise(reach, transform).0
    }

    /// P from the pairs up to a distance, with weights that fall to 0 there, and the relative variance of it for independent points;
    /// `mean` is the mean of a wave over the shell of a bin.
    fn power_and_noise(&self, reach: f64, mean: impl Fn(usize) -> f64) -> (f64, f64) {
        let (mut p, mut noise) = (1.0, 0.0);
        for (b, bin) in self.pairs.iter().enumerate() {
            let r = 0.5 * (bin.edges[0] + bin.edges[1]) / reach;
            if r >= 1.0 {
                break;
            }
            let part = (1.0 - r * r).powi(2) * mean(b) / self.n;
            p += part * (bin.found - bin.expected);
            noise += 2.0 * part * part * bin.expected;
        }
        (p.max(0.0), noise)
    }

    /// What the sides of a window add to the variance of each bin and of all up to it: with f(x) the weighted measure of the part
    /// of the shell about x that is inside, `4 (n / |D|)^2 n Var f P`, P being that of low frequencies.
    fn edge_variances(&self, clusters: Option<&Clusters>) -> [Vec<f64>; 2] {
        let domain = &self.plan.domain;
        if domain.is_torus() {
            return [vec![0.0; self.pairs.len()], vec![0.0; self.pairs.len()]];
        }
        let WindowEdges { distances, nearest, variances } = WindowEdges::new(self.plan);
        let low = distances.map(|r| self.low_power(r, clusters));
        let scale = 4.0 * self.n.powi(3) / domain.measure().powi(2);
        variances.map(|of| of.iter().zip(&nearest).map(|(variance, &j)| scale * variance * low[j]).collect())
    }

    /// P at a quarter of a wave over r.
    fn low_power(&self, r: f64, clusters: Option<&Clusters>) -> f64 {
        let nu = 0.25 / r;
        clusters.map_or_else(|| self.power(nu, self.reach().max(r)), |clusters| clusters.power(nu))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of few pairs, g^2 are there that could have a point in common with others; of many per point, nearly all.
    #[test]
    fn pairs_that_the_spectrum_speaks_of() {
        assert_eq!(
            [(0.5, 0.0), (1.0, 0.0), (3.0, 0.0), (0.5, 1.0)].map(|(g, k)| together(g, k)),
            [0.25, 1.0, 1.0, 0.5]
        );
        assert!(together(0.5, 100.0) > 0.9998);
    }
}

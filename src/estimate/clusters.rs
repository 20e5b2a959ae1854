//! The Thomas process that goes with a measured g or P: how many clusters there are, and how wide they are.
//!
//! One realization of clusters scatters as its clusters do, which are fewer than its points, and whose pairs are not
//! independent. Two numbers say by how much: the points of a cluster `mu`, and its standard deviation `sigma` along each axis,
//! children being Gaussian about their parents, `g(r) = 1 + h(r) / kappa` with `kappa` the intensity of parents and h the density
//! of the difference of two siblings, and `P = 1 + mu exp(-4 pi^2 sigma^2 nu^2)` (Illian et al. 2008, section 6.3). Both are
//! found by maximum likelihood: from pairs by that of Palm (Tanaka, Ogata and Stoyan, "Parameter estimation and model selection for
//! Neyman-Scott point processes", Biometrical Journal 50, 2008), as if pairs were Poisson, from ring means of P by Whittle's, as if
//! ordinates were exponential.

use std::f64::consts::PI;

use crate::ball::mean_over_directions;

/// So much must the logarithm of the likelihood gain over independent points: of 10,000 sets of those less than one does.
const GAIN: f64 = 10.0;

/// Widths that are tried before the best one is refined.
const WIDTHS: usize = 40;

/// Clusters of a Thomas process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clusters {
    dim: usize,
    /// Mean number of points in one.
    pub(super) points: f64,
    /// Standard deviation along each axis.
    pub(super) sigma: f64,
}

/// Ordered pairs of one realization in a bin.
pub(super) struct BinPairs {
    /// The bin.
    pub(super) edges: [f64; 2],
    /// How many there are.
    pub(super) found: f64,
    /// How many independent points would have.
    pub(super) expected: f64,
}

/// A mean of P.
pub(super) struct RingPower {
    /// Frequency.
    pub(super) nu: f64,
    /// P.
    pub(super) p: f64,
    /// Independent exponential ordinates behind it.
    pub(super) ordinates: f64,
}

impl Clusters {
    /// Of `n` points with `norm` ordered pairs; `None` where they are not clustered.
    pub(super) fn of_pairs(dim: usize, n: f64, norm: f64, bins: &[BinPairs]) -> Option<Self> {
        let (first, last) = (bins.first()?, bins.last()?);
        let fit = |sigma: f64| {
            let siblings: Vec<f64> =
                bins.iter().map(|b| siblings(dim, sigma, b.edges[1]) - siblings(dim, sigma, b.edges[0])).collect();
            let (share, gain) = share(norm, bins, &siblings);
            (n * share, gain)
        };
        // In narrower ones all siblings would lie in the first bin.
        let (sigma, (points, gain)) = best(first.edges[1] / 4.0, last.edges[1], fit)?;
        // Ordered pairs come in twos.
        (gain / 2.0 > GAIN).then_some(Self { dim, points, sigma })
    }

    /// Of the points behind these rings.
    pub(super) fn of_rings(dim: usize, rings: &[RingPower]) -> Option<Self> {
        let (lowest, highest) = (rings.first()?.nu, rings.last()?.nu);
        let fit = |sigma: f64| {
            let shape: Vec<f64> = rings.iter().map(|ring| falloff(sigma, ring.nu)).collect();
            let gain = |mu: f64| -> f64 {
                let of_ring = |(ring, shape): (&RingPower, &f64)| {
                    let p = 1.0 + mu * shape;
                    ring.ordinates * (ring.p * (1.0 - 1.0 / p) - p.ln())
                };
                rings.iter().zip(&shape).map(of_ring).sum()
            };
            let most = rings.iter().map(|ring| ring.p).fold(1.0, f64::max);
            let mu = golden(0.0, (2.0 * most).ln(), |log| gain(log.exp_m1())).exp_m1();
            (mu, gain(mu))
        };
        let (sigma, (points, gain)) = best(0.05 / highest, 0.5 / lowest, fit)?;
        (gain > GAIN).then_some(Self { dim, points, sigma })
    }

    /// P.
    pub(super) fn power(&self, nu: f64) -> f64 {
        1.0 + self.points * falloff(self.sigma, nu)
    }

    /// Beyond this frequency P is 1 to 1e-6 of its largest.
    pub(super) fn highest_frequency(&self) -> f64 {
        0.6 / self.sigma
    }

    /// The variance of the number of ordered pairs that clusters add to that of Gaussian amplitudes with the same spectrum; `pairs`
    /// is the number of those within clusters, of `n` points.
    ///
    /// With S the pairs in a cluster of N points and p the probability of one, clusters being Poisson, it is
    /// `sum E[(S - 2 N mu p)^2]`, since what is divided by n^2 follows n; which is, siblings being Poisson too,
    /// `kappa (2 mu^2 p + 4 mu^3 (p_3 - p^2) + mu^4 p^2)` with `p_3` the probability that two siblings of a point are both in
    /// the bin. For short distances `p_3 / p^2` is `(4/3)^(d/2)`; for long ones, where the term matters little, less.
    pub(super) fn pair_variance(&self, n: f64, pairs: f64) -> f64 {
        let triples = (4.0f64 / 3.0).powf(0.5 * self.dim as f64) - 1.0;
        2.0 * pairs + pairs * pairs * self.points / n * (1.0 + 4.0 * triples / self.points)
    }

    /// Ordered pairs within clusters, of n points, whose distances lie in a bin.
    pub(super) fn pairs(&self, norm: f64, n: f64, edges: [f64; 2]) -> f64 {
        let [lo, hi] = edges.map(|r| siblings(self.dim, self.sigma, r));
        norm * self.points / n * (hi - lo)
    }

    /// The covariance of two ordinates of the same ring beyond that of Gaussian amplitudes, of n points, in units of P^2.
    ///
    /// Where `A` are the amplitudes of one cluster of N points, `kappa E[(|A_m|^2 - N P)(|A_l|^2 - N P)]`, since P is divided by
    /// n; over directions of m and l that is `kappa (2 mu^2 a(z) + mu^3 (4 q a(z/2) - 3 q^2))` with
    /// `q = exp(-4 pi^2 sigma^2 nu^2)`, `z = -2 ln q` and `a(z)` the mean of `exp(-z (1 - cos t))`.
    pub(super) fn ordinate_covariance(&self, n: f64, nu: f64) -> f64 {
        let (mu, q) = (self.points, falloff(self.sigma, nu));
        let z = 8.0 * (PI * self.sigma * nu).powi(2);
        let sum = 2.0 * mean_over_directions(self.dim, z)
            + mu * (4.0 * q * mean_over_directions(self.dim, 0.5 * z) - 3.0 * q * q);
        mu / n * sum / self.power(nu).powi(2)
    }
}

/// How P falls off with frequency.
fn falloff(sigma: f64, nu: f64) -> f64 {
    (-4.0 * (PI * sigma * nu).powi(2)).exp()
}

/// The probability that two siblings are closer than r: their difference is Gaussian of variance `2 sigma^2`.
fn siblings(dim: usize, sigma: f64, r: f64) -> f64 {
    let t = r / (2.0 * sigma);
    match dim {
        1 => libm::erf(t),
        2 => -(-t * t).exp_m1(),
        _ => libm::erf(t) - 2.0 / PI.sqrt() * t * (-t * t).exp(),
    }
}

/// The likeliest share of pairs within clusters, `1 / (kappa |D|)`, and its gain. The slope is convex and falls, so that Newton's
/// method from 0 goes up to its zero and never beyond.
fn share(norm: f64, bins: &[BinPairs], siblings: &[f64]) -> (f64, f64) {
    let both = || bins.iter().zip(siblings).filter(|(bin, _)| bin.expected > 0.0);
    let all = norm * siblings.iter().sum::<f64>();
    let mut share = 0.0;
    for _ in 0..100 {
        let (mut slope, mut bend) = (-all, 0.0);
        for (bin, p) in both() {
            let rate = p / (bin.expected / norm + share * p);
            slope += bin.found * rate;
            bend += bin.found * rate * rate;
        }
        // Written so that NaN ends it.
        if !(slope > 1e-12 * all && bend > 0.0) {
            break;
        }
        let step = slope / bend;
        share += step;
        if step <= 1e-9 * share {
            break;
        }
    }
    let gain = both().map(|(bin, p)| bin.found * (share * p * norm / bin.expected).ln_1p()).sum::<f64>() - share * all;
    (share, gain)
}

/// The sigma between two for which the gain of a fit is largest, with that fit.
fn best(lo: f64, hi: f64, fit: impl Fn(f64) -> (f64, f64)) -> Option<(f64, (f64, f64))> {
    if !(lo > 0.0 && lo < hi && hi.is_finite()) {
        return None;
    }
    let step = (hi / lo).ln() / (WIDTHS - 1) as f64;
    let log = |i: usize| lo.ln() + step * i as f64;
    let gains = (0..WIDTHS).map(|i| (i, fit(log(i).exp()).1)).filter(|(_, gain)| gain.is_finite());
    let (i, _) = gains.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let sigma = golden(log(i.saturating_sub(1)), log((i + 1).min(WIDTHS - 1)), |log| fit(log.exp()).1).exp();
    Some((sigma, fit(sigma)))
}

/// Where a function with one maximum between two ends has it, to a thousandth of that interval: golden section search.
fn golden(mut lo: f64, mut hi: f64, f: impl Fn(f64) -> f64) -> f64 {
    let part = 0.5 * (3.0 - 5f64.sqrt());
    let (mut a, mut b) = (lo + part * (hi - lo), hi - part * (hi - lo));
    let (mut at_a, mut at_b) = (f(a), f(b));
    for _ in 0..16 {
        if at_a > at_b {
            (hi, b, at_b) = (b, a, at_a);
            a = lo + part * (hi - lo);
            at_a = f(a);
        } else {
            (lo, a, at_a) = (a, b, at_b);
            b = hi - part * (hi - lo);
            at_b = f(b);
        }
    }
    0.5 * (lo + hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of pairs, and ring means of P, that are exactly those of clusters give them back.
    #[test]
    fn clusters_are_found_again() {
        for dim in 1..=3 {
            for (points, sigma) in [(10.0, 0.02), (2.0, 0.01)] {
                let clusters = Clusters { dim, points, sigma };
                let (n, norm) = (1000.0, 999_000.0);
                let bin = |b: i32| {
                    let edges = [0.005 * f64::from(b), 0.005 * f64::from(b + 1)];
                    let ball = |r: f64| crate::ball::unit_ball(dim) * r.powi(dim as i32);
                    let expected = norm * (ball(edges[1]) - ball(edges[0]));
                    BinPairs { edges, found: expected + clusters.pairs(norm, n, edges), expected }
                };
                let found = Clusters::of_pairs(dim, n, norm, &(0..60).map(bin).collect::<Vec<_>>()).unwrap();
                let ring = |m: i32| RingPower { nu: f64::from(m), p: clusters.power(f64::from(m)), ordinates: 500.0 };
                let of_rings = Clusters::of_rings(dim, &(1..60).map(ring).collect::<Vec<_>>()).unwrap();
                for found in [found, of_rings] {
                    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
                    assert!(close(found.points, points) && close(found.sigma, sigma), "{found:?} of {clusters:?}");
                }
            }
        }
    }

    #[test]
    fn points_that_keep_apart_are_no_clusters() {
        let bin = |b: i32| {
            let expected = 1000.0 * f64::from(2 * b + 1);
            // None nearer than 10 bins, twice as many just beyond.
            let found = expected
                * if b < 10 {
                    0.0
                } else if b < 14 {
                    2.0
                } else {
                    1.0
                };
            BinPairs { edges: [f64::from(b), f64::from(b + 1)], found, expected }
        };
        assert_eq!(Clusters::of_pairs(2, 1000.0, 1e6, &(0..40).map(bin).collect::<Vec<_>>()), None);
        let ring = |m: i32| RingPower { nu: f64::from(m), p: if m < 20 { 0.1 } else { 1.0 }, ordinates: f64::from(m) };
        assert_eq!(Clusters::of_rings(2, &(1..60).map(ring).collect::<Vec<_>>()), None);
        assert_eq!((Clusters::of_pairs(2, 0.0, 0.0, &[]), Clusters::of_rings(2, &[])), (None, None));
    }
}

//! Curves of simulations -> pointwise and global envelopes, with p-values.

use super::Analysis;

use std::cmp::Ordering;

/// One estimated function, of the data or of a simulation. NaN where it is undefined.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in `envelope.csv`.
    pub name: &'static str,
    /// Abscissae.
    pub r: Vec<f64>,
    /// Values.
    pub values: Vec<f64>,
}

/// The level of a global envelope, where there are simulations enough.
const LEVEL: f64 = 0.05;

/// The observed curve among N simulated ones: what a pattern with no correlation at all looks like.
///
/// With `N + 1` curves in all, ranks at each r count from the nearer end (from 1; ties share the mean rank). A curve's
/// *extreme rank* is its smallest. The *extreme rank length* order compares the sorted ranks of two curves number by number
/// and is nearly free of ties. See Myllymaki et al., Global envelope tests for spatial processes, J. R. Stat. Soc. B 79, 2017.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// The observed curve.
    pub observed: Curve,
    /// Pointwise: the smallest and largest simulated value. At one r fixed beforehand, independent points lie outside with
    /// probability `2 / (N + 1)`.
    pub pointwise: [Vec<f64>; 2],
    /// Global: where the observed curve lies outside somewhere, `p <= alpha`; the converse needs no ties at its border.
    pub global: [Vec<f64>; 2],
    /// The level of the global envelope: 0.05, or `1 / (N + 1)` where that is larger.
    pub alpha: f64,
    /// The p-value of the extreme rank length test.
    pub p: f64,
    /// The interval of p-values left open by ties of the extreme ranks.
    pub p_interval: [f64; 2],
}

impl Envelope {
    /// Of at least one simulation, with the abscissae of the observed curve.
    pub fn new(observed: Curve, simulated: &[Vec<f64>]) -> Self {
        let all: Vec<&[f64]> = std::iter::once(&observed.values).chain(simulated).map(Vec::as_slice).collect();
        let total = all.len() as f64;
        let ranks = sorted_ranks(&all);
        let extreme = |curve: usize| ranks[curve].first().copied().unwrap_or(0.0);
        let share = |count: usize| count as f64 / total;
        let p_interval = [
            share((0..all.len()).filter(|&c| extreme(c) < extreme(0)).count()),
            share((0..all.len()).filter(|&c| extreme(c) <= extreme(0)).count()),
        ];
        // Every curve's p-value: the share of curves at most as central.
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| lexicographic(&ranks[a], &ranks[b]));
        let mut p = vec![0.0; all.len()];
        let mut end = 0;
        for tied in order.chunk_by(|&a, &b| lexicographic(&ranks[a], &ranks[b]).is_eq()) {
            end += tied.len();
            tied.iter().for_each(|&curve| p[curve] = share(end));
        }
        let alpha = share(1).max(LEVEL);
        let kept: Vec<&[f64]> = all.iter().zip(&p).filter(|(_, p)| **p > alpha).map(|(curve, _)| *curve).collect();
        let (pointwise, global) = (hull(&all[1..], observed.r.len()), hull(&kept, observed.r.len()));
        Self { observed, pointwise, global, alpha, p: p[0], p_interval }
    }
}

/// Per curve its ranks at every r where all curves are defined, smallest first.
fn sorted_ranks(curves: &[&[f64]]) -> Vec<Vec<f64>> {
    let total = curves.len();
    let mut ranks = vec![Vec::new(); total];
    for k in (0..curves[0].len()).filter(|&k| curves.iter().all(|c| c[k].is_finite())) {
        let mut order: Vec<usize> = (0..total).collect();
        order.sort_by(|&a, &b| curves[a][k].total_cmp(&curves[b][k]));
        let mut start = 0;
        for tied in order.chunk_by(|&a, &b| curves[a][k] == curves[b][k]) {
            let rank = start as f64 + 0.5 * (tied.len() + 1) as f64;
            tied.iter().for_each(|&curve| ranks[curve].push(rank.min(total as f64 + 1.0 - rank)));
            start += tied.len();
        }
    }
    ranks.iter_mut().for_each(|r| r.sort_by(f64::total_cmp));
    ranks
}

fn lexicographic(a: &[f64], b: &[f64]) -> Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
}

/// The smallest and largest value at every abscissa; NaN where a curve is undefined or there is none.
fn hull(curves: &[&[f64]], len: usize) -> [Vec<f64>; 2] {
    let over = |first: f64, pick: fn(f64, f64) -> f64| {
        // `min` and `max` forget a NaN.
        let add = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::NAN } else { pick(a, b) };
        let at = |k: usize| if curves.is_empty() { f64::NAN } else { curves.iter().map(|c| c[k]).fold(first, add) };
        (0..len).map(at).collect()
    };
    [over(f64::INFINITY, f64::min), over(f64::NEG_INFINITY, f64::max)]
}

/// The observed curves among simulated ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelopes {
    /// Number of simulations.
    pub simulations: u64,
    /// Where they come from, if they were given; else they are of complete spatial randomness.
    pub given: Option<String>,
    /// One per curve.
    pub curves: Vec<Envelope>,
}

impl Envelopes {
    /// The probability that independent points leave a pointwise envelope at one r chosen beforehand.
    pub fn pointwise_significance(&self) -> f64 {
        2.0 / (self.simulations as f64 + 1.0)
    }

    /// What the user should know of so few of them.
    pub fn too_few(&self) -> Option<String> {
        let least = 1.0 / (self.simulations as f64 + 1.0);
        (least > LEVEL).then(|| {
            format!(
                "envelope: no p-value of {} simulations is below {least:.2}: the global envelope is at that level, and the \
                 {LEVEL} level needs {:.0} simulations",
                self.simulations,
                1.0 / LEVEL - 1.0
            )
        })
    }

    /// The envelope of a curve.
    pub fn find(&self, name: &str) -> Option<&Envelope> {
        self.curves.iter().find(|e| e.observed.name == name)
    }
}

impl Analysis {
    /// Envelopes of simulations.
    pub fn envelopes(&self) -> Option<&Envelopes> {
        self.get()
    }
}

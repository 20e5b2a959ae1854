//! The intensity on a grid, and its bandwidth. See `docs/first-order.md`.

use crate::accumulate::{IntensityScores, IntensitySums};
use crate::estimate::{Analysis, ErrorSource};
use crate::plan::{IntensityPlan, IntensitySearch, scott};

/// `lambda(u)`, the sum of kernels over the part of the kernel that is in the domain, mean over realizations.
#[derive(Debug, Clone, PartialEq)]
pub struct Intensity {
    /// Cells per axis.
    pub cells: usize,
    /// Standard deviation of the kernel.
    pub bandwidth: f64,
    /// How that was chosen among several.
    pub choice: Option<IntensityChoice>,
    /// Points per unit length, area or volume at the middle of every cell, the last axis fastest; 0 outside a polygon.
    pub lambda: Vec<f64>,
    /// Standard errors across realizations (K >= 2).
    pub lambda_se: Option<Vec<f64>>,
    /// Which cells have their middles in the domain.
    pub inside: Vec<bool>,
    /// Points per unit of the whole domain, `n / |D|`.
    pub mean: f64,
    /// The sum of all cells times their measure: what it makes of n.
    pub integral: f64,
    /// Where errors come from; `None` for a single realization, which has none.
    pub errors: Option<ErrorSource>,
}

/// A bandwidth that the points chose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntensityChoice {
    /// Standard deviation.
    pub bandwidth: f64,
    /// The bandwidths that were tried, if there were some.
    pub range: Option<[f64; 2]>,
    /// Whether the largest likelihood is at an end of them.
    pub at_end: bool,
}

impl Intensity {
    /// Of the sums; `None` without realizations.
    pub fn new(plan: &IntensityPlan, sums: &IntensitySums) -> Option<Self> {
        let k = sums.realizations as f64;
        if sums.realizations == 0 {
            return None;
        }
        let [total, squares] = sums.totals();
        let inside: Vec<bool> = plan.mass.iter().map(|mass| *mass > 0.0).collect();
        let over = |x: f64, mass: f64| if mass > 0.0 { x / mass } else { 0.0 };
        let lambda: Vec<f64> = total.iter().zip(&*plan.mass).map(|(sum, &mass)| over(sum / k, mass)).collect();
        let error = |((sum, square), &mass): ((&f64, &f64), &f64)| {
            let variance = (square - sum * sum / k).max(0.0) / (k - 1.0);
            over((variance / k).sqrt(), mass)
        };
        let lambda_se = (k >= 2.0).then(|| total.iter().zip(&squares).zip(&*plan.mass).map(error).collect());
        let cell = plan.domain.sides().iter().product::<f64>() / plan.cell_count() as f64;
        Some(Self {
            cells: plan.cells,
            bandwidth: plan.bandwidth,
            choice: None,
            integral: lambda.iter().sum::<f64>() * cell,
            lambda,
            lambda_se,
            inside,
            mean: sums.points as f64 / k / plan.domain.measure(),
            errors: (k >= 2.0).then_some(ErrorSource::AcrossRealizations),
        })
    }

    /// The least and the largest within the domain.
    pub fn range(&self) -> Option<[f64; 2]> {
        let within = self.lambda.iter().zip(&self.inside).filter(|(_, inside)| **inside).map(|(lambda, _)| *lambda);
        within.fold(None, |range, x| Some(range.map_or([x, x], |[l, h]: [f64; 2]| [l.min(x), h.max(x)])))
    }
}

impl IntensityChoice {
    /// By Scott's rule, or the largest likelihood, between its neighbours by a parabola in the logarithm of the bandwidth. `None`
    /// where the points say nothing: fewer than two of them, or all on a line.
    pub fn new(search: &IntensitySearch, scores: &IntensityScores) -> Option<Self> {
        let n: f64 = scores.realizations.iter().map(|r| r.n as f64).sum();
        let per_realization = n / scores.realizations.len() as f64;
        let tried = &search.bandwidths;
        let Some((&from, &to)) = tried.first().zip(tried.last()) else {
            let dim = search.domain.dim();
            let variance = |a: usize| {
                let total = |of: fn(&crate::accumulate::RealizationScores) -> [f64; 3]| {
                    scores.realizations.iter().map(|r| of(r)[a]).sum::<f64>()
                };
                (total(|r| r.squares) - total(|r| r.sums).powi(2) / n) / (n - 1.0)
            };
            let spread = (0..dim).map(variance).product::<f64>().powf(0.5 / dim as f64);
            let bandwidth = scott(spread, per_realization, dim);
            return (n > 1.0 && bandwidth > 0.0 && bandwidth.is_finite()).then_some(Self {
                bandwidth,
                range: None,
                at_end: false,
            });
        };
        if scores.realizations.iter().all(|r| r.n < 2) {
            return None;
        }
        let score = |b: usize| scores.realizations.iter().map(|r| r.logs[b]).sum::<f64>();
        let all: Vec<f64> = (0..tried.len()).map(score).collect();
        let best = (0..all.len()).max_by(|&a, &b| all[a].total_cmp(&all[b]))?;
        let at_end = best == 0 || best + 1 == all.len();
        let step = (to / from).ln() / (all.len() - 1) as f64;
        let shift = if at_end {
            0.0
        } else {
            let [before, here, after] = [all[best - 1], all[best], all[best + 1]];
            let bend = before - 2.0 * here + after;
            if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 }
        };
        Some(Self { bandwidth: tried[best] * (shift * step).exp(), range: Some([from, to]), at_end })
    }
}

impl Analysis {
    /// The intensity on a grid.
    pub fn intensity(&self) -> Option<&Intensity> {
        self.get()
    }
}

//! The variance of an integral as it follows from P alone, without points.
//!
//! With n points, `V = (1/n) [sum_R |f_m|^2 P(m) + T] + I^2 var(N) / n^2`: R are the frequencies at which P is known, `T = v0 - sum_R |f_m|^2` closes
//! the sum with P = 1 beyond, and the last term is of the estimator lambda where the number of points is random. Removal adds `int f^2 (1/q - 1) / n`.

use rayon::prelude::*;

use super::Measured;
use super::integration::{beyond, highest_excess};
use crate::integrand::Integrand;
use crate::plan::IntegrationPlan;

/// What a spectrum predicts for an integrand.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// The integrand.
    pub integrand: Integrand,
    /// The variance of one random point, `int f^2 - I^2`.
    pub v0: f64,
    /// Of the frequencies at which P is known.
    pub spectral: Measured,
    /// What closes that: P = 1 beyond.
    pub tail: f64,
    /// The part of it along axes.
    pub tail_axes: f64,
    /// How far it may be off, by how far P is from 1 where it ends.
    pub tail_bound: f64,
    /// Of the random number of points.
    pub count_term: f64,
    /// What removal adds, where points are kept at random.
    pub removal: f64,
}

impl Prediction {
    /// For each integrand of a plan, of its mean number of points. `power` is P where it is known. `realizations` is how many a measured P is the
    /// mean of: its standard error is then `sqrt(2 sum |f_m|^4 P^2 / K) / n`, halved below the root for K = 1, of exponential power.
    pub fn all(
        plan: &IntegrationPlan,
        power: &(dyn Fn([i32; 3]) -> Option<f64> + Sync),
        realizations: Option<u64>,
        count_variance: f64,
    ) -> Vec<Self> {
        let Some(grid) = plan.grid.waves.grid() else { return Vec::new() };
        let n = plan.shape.mean_points;
        let known = |m: [i32; 3]| power(m).unwrap_or(f64::NAN);
        let around: Vec<f64> = (0..grid.half_len())
            .into_par_iter()
            .map(|k| if k == grid.dc() { 0.0 } else { known(grid.mode(k)) })
            .collect();
        let reach = |a: usize| plan.axes[a].waves.grid().map_or(0, |line| line.max_frequency()[0] as usize);
        let along: Vec<Vec<f64>> = (0..plan.axes.len())
            .map(|a| {
                let at = |m: usize| {
                    let mut vector = [0; 3];
                    vector[a] = m as i32;
                    if m == 0 { f64::NAN } else { known(vector) }
                };
                (0..=reach(a)).into_par_iter().map(at).collect()
            })
            .collect();
        let excess = highest_excess(plan, &around, &along, 1.0);
        let one = |(i, (integrand, table)): (usize, (&Integrand, &crate::plan::IntegrandTable))| {
            let v0 = plan.averaged[i].variance().max(0.0);
            let (mut inside, mut sums, mut squares) = (0.0, [0.0; 2], 0.0);
            // Of the grid, and along axes beyond it.
            let mut add = |part: usize, f: f64, p: f64, times: f64| {
                if p.is_finite() {
                    inside += f;
                    sums[part] += f * p;
                    squares += (f * p).powi(2) / times;
                }
            };
            for (k, (f, p)) in table.grid.iter().zip(&around).enumerate() {
                add(0, *f, *p, f64::from(grid.multiplicity(k)));
            }
            for (of_axis, p) in table.axes.iter().zip(&along) {
                of_axis.iter().zip(p).for_each(|(f, p)| add(1, *f, *p, 2.0));
            }
            let [sum, axes] = sums;
            let rest = beyond(v0, inside);
            // A single measured power is twice as large in the square as its expectation.
            let se = realizations.map(|k| (if k == 1 { 1.0 } else { 2.0 / k as f64 } * squares).sqrt() / n);
            Self {
                integrand: integrand.clone(),
                v0,
                spectral: Measured { value: sum / n, se },
                tail: (axes + rest) / n,
                tail_axes: axes / n,
                tail_bound: rest / n * excess,
                count_term: integrand.integral().powi(2) * count_variance / (n * n),
                removal: plan.removal().map_or(0.0, |removal| removal.terms[i].value / n),
            }
        };
        plan.integrands.iter().zip(plan.tables.iter()).enumerate().map(one).collect()
    }

    /// All of it together.
    pub fn variance(&self) -> f64 {
        self.spectral.value + self.tail + self.count_term + self.removal
    }
}

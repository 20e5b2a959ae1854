//! Pair counts, by the definition.
//!
//! For points `x_1 .. x_n` in a box `D`, and half-open bins `[r_b, r_(b+1))`:
//!
//! ```text
//! c_b = sum_i sum_(j != i) w(x_i - x_j) 1[r_b <= |x_i - x_j| < r_(b+1)]
//! ```
//!
//! with `|.|` the minimum-image distance on a torus and the plain one in a window; ordered pairs, so each unordered pair
//! counts twice. `w = 1`, or with translation correction `w(h) = |D| / |D intersect (D + h)|` (Ohser, "On estimators for
//! the reduced second moment measure of point processes", 1983; `Illian et al., Statistical Analysis and Modelling of
//! Spatial Point Patterns`, 2008, section 4.2.2).
//!
//! Coordinates are integers in steps of `length_unit / 2^64`. Squared distances are compared with integer thresholds in
//! u128: no rounding anywhere, except that a weight is an f64 quotient rounded to steps of 2^-32.

use crate::accumulate::{PairHistogram, WEIGHT_STEPS};
use crate::compute::Control;
use crate::error::Result;
use crate::plan::{Correction, PairPlan};
use crate::points::Domain;

/// The distance between two positions along one axis, in steps; `period` 0 stands for 2^64. In a window (period 0) no
/// distance exceeds half of 2^64, so the minimum image is the plain difference.
pub fn minimum_image(a: u64, b: u64, period: u64) -> u64 {
    let difference = if a >= b { a - b } else { a.wrapping_sub(b).wrapping_add(period) };
    difference.min(period.wrapping_sub(difference))
}

/// The squared distance between points `i` and `j`, in squared steps. At most 3 (2^63)^2 < 2^128.
pub fn squared_distance(axes: &[&[u64]], periods: [u64; 3], i: usize, j: usize) -> u128 {
    let mut sum = 0;
    for (axis, period) in axes.iter().zip(periods) {
        let d = u128::from(minimum_image(axis[i], axis[j], period));
        sum += d * d;
    }
    sum
}

/// The translation weight `prod_k a_k / (a_k - |h_k|)` of a pair in steps of 2^-32, rounded to nearest; `a_k` and `h_k`
/// in units of the domain's length unit. Plans keep `r_max` below the window's shortest side, so `h_k < a_k` for
/// every pair that a bin accepts.
pub fn translation_weight(axes: &[&[u64]], domain: &Domain, i: usize, j: usize) -> u64 {
    let mut weight = 1.0;
    for (axis, side) in axes.iter().zip(domain.sides()) {
        let a = side / domain.length_unit();
        let h = axis[i].abs_diff(axis[j]) as f64 / 2f64.powi(64);
        weight *= a / (a - h);
    }
    (weight * WEIGHT_STEPS).round_ties_even() as u64
}

/// The histogram of one realization. `axes[a][j]` is the position of point `j` along axis `a`.
pub(super) fn pair_counts(plan: &PairPlan, axes: &[&[u64]], control: &Control) -> Result<PairHistogram> {
    let n = axes[0].len();
    let bins = plan.bins.len();
    let periods = plan.domain.periods();
    let mut counts = vec![0; bins];
    let mut weights = (plan.correction == Correction::Translation).then(|| vec![0; bins]);
    for i in 0..n {
        control.check()?;
        for j in 0..n {
            if i == j {
                continue;
            }
            let r2 = squared_distance(axes, periods, i, j);
            // The number of edges at or below the distance: bin b lies between edges b and b + 1.
            let edges_below = plan.thresholds.partition_point(|&t| t <= r2);
            if (1..=bins).contains(&edges_below) {
                counts[edges_below - 1] += 1;
                if let Some(weights) = &mut weights {
                    weights[edges_below - 1] += u128::from(translation_weight(axes, &plan.domain, i, j));
                }
            }
        }
    }
    Ok(PairHistogram::new(n as u64, counts, weights))
}

//! Pair counts, by the definition.
//!
//! For points `x_1 .. x_n` in a box `D`, and half-open bins `[r_b, r_(b+1))`:
//!
//! ```text
//! c_b = sum_i sum_(j != i) w(x_i - x_j) 1[r_b <= |x_i - x_j| < r_(b+1)]
//! ```
//!
//! with `|.|` the minimum-image distance on a torus and the plain one in a window; ordered pairs, so each unordered pair
//! counts twice. The weight `w` corrects for what the window does not show (Illian et al., Statistical Analysis and
//! Modelling of Spatial Point Patterns, 2008, section 4.2.2):
//!
//! - none: `w = 1`;
//! - translation: `w = |D| / |D intersect (D + x_i - x_j)|` (Ohser, "On estimators for the reduced second moment measure of
//!   point processes", 1983);
//! - isotropic, 1D and 2D: `w = |S| / |S intersect D|`, `S` the circle about `x_i` through `x_j`, in 1D its two ends
//!   (Ripley, "The second-order analysis of stationary point processes", 1976). Nothing caps it: plans stay below half the
//!   diagonal, where it has a bound (`PairPlan::largest_isotropic`);
//! - border: `w = 1` if `x_i` is at least as far from the border of `D` as the upper edge of the bin, else 0 (minus
//!   sampling; Ripley, Statistical Inference for Spatial Processes, 1988, section 3.2).
//!
//! In a window that is a polygon the formulas are the same; see `polygon`. A circle of which less than 2^-30 is in it counts as
//! if that were.
//!
//! Points with weights `u` count `u_i u_j w`, with border correction too.
//!
//! Coordinates are integers in steps of `length_unit / 2^64`. Squared distances are compared with integer thresholds in
//! u128: no rounding anywhere, except that a weight is an f64 quotient rounded to steps of 2^-32, and with weights of points an
//! f64 product rounded to steps of 2^-64.

use std::f64::consts::TAU;

use super::polygon;
use crate::accumulate::{BorderHistogram, PairHistogram, WEIGHT_STEPS};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Correction, PairPlan};
use crate::points::geometry::{depth, squared_distance, weighted_pair};
use crate::points::{Domain, geometry};

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

/// The isotropic weight of the ordered pair (i, j) in steps of 2^-32, in 1D and 2D; `sides` as `Domain::side_steps`.
///
/// In each of the four quadrants about `x_i`, a side at distance `a < r` cuts the angle `acos(a / r)` off the circle, and
/// the two sides cut from opposite ends: `pi/2 - acos(a / r) - acos(b / r)` is left, or nothing, where the corner is within the
/// circle. With `A^2 = r^2 - a^2` and `B^2 = r^2 - b^2` (a = r and A = 0 for a side that does not cut) its tangent is
///
/// ```text
/// (a^2 + b^2 - r^2) r^2 / ((a b + A B) (A b + a B))
/// ```
///
/// whose differences are exact, so that what is left keeps its digits however little it is. Libm's atan2 is the same on
/// every machine.
pub fn isotropic_weight(axes: &[&[u64]], sides: [u64; 3], i: usize, j: usize) -> u64 {
    let square = |d: u64| u128::from(d) * u128::from(d);
    let r2: u128 = axes.iter().map(|axis| square(axis[i].abs_diff(axis[j]))).sum();
    if r2 == 0 {
        return 1 << 32;
    }
    let to_sides = |axis: usize| [axes[axis][i], sides[axis].saturating_sub(axes[axis][i])];
    if axes.len() == 1 {
        // Of two ends, one is at x_j.
        return if to_sides(0).iter().all(|&d| square(d) >= r2) { 1 << 32 } else { 2 << 32 };
    }
    let mut inside = 0.0;
    for x in to_sides(0) {
        for y in to_sides(1) {
            let (a2, b2) = (square(x).min(r2), square(y).min(r2));
            // a^2 + b^2 may not fit.
            if let Some(beyond) = a2.checked_sub(r2 - b2) {
                let [a, b] = [a2, b2].map(|d2| (d2 as f64).sqrt());
                let [chord_a, chord_b] = [r2 - a2, r2 - b2].map(|d2| (d2 as f64).sqrt());
                let across = (a * b + chord_a * chord_b) * (chord_a * b + a * chord_b);
                inside += libm::atan2(beyond as f64 * r2 as f64, across);
            }
        }
    }
    (TAU / inside * WEIGHT_STEPS).round_ties_even() as u64
}

/// The weight of the ordered pair (i, j), that of its edge correction, in steps of 2^-32; times those of its points, where the
/// plan takes them into account, in steps of 2^-64.
pub(super) fn pair_weight(plan: &PairPlan, axes: &[&[u64]], masses: Option<&[f64]>, i: usize, j: usize) -> u128 {
    let edge = match plan.correction {
        Correction::None | Correction::Border => 1 << 32,
        // In the plane.
        Correction::Translation if let Some(polygon) = plan.domain.as_polygon() => {
            polygon::translation_weight(polygon, [0, 1].map(|a| i128::from(axes[a][j]) - i128::from(axes[a][i])))
        }
        Correction::Isotropic if let Some(polygon) = plan.domain.as_polygon() => {
            polygon::isotropic_weight(polygon, [0, 1].map(|a| axes[a][i]), [0, 1].map(|a| axes[a][j]))
        }
        Correction::Translation => translation_weight(axes, &plan.domain, i, j),
        Correction::Isotropic => isotropic_weight(axes, plan.domain.side_steps(), i, j),
    };
    let mass = |j: usize| masses.map_or(1.0, |m| m[j]);
    if plan.masses { weighted_pair([mass(i), mass(j)], edge) } else { u128::from(edge) }
}

/// What weights are compared with, of `n` points.
pub(super) fn mass_sums(n: usize, masses: Option<&[f64]>) -> [u128; 2] {
    masses.map_or_else(|| geometry::mass_sums(&vec![1.0; n]), geometry::mass_sums)
}

/// The histogram of one realization. `axes[a][j]` is the position of point `j` along axis `a`, `masses[j]` its weight.
pub(super) fn pair_counts(
    plan: &PairPlan,
    axes: &[&[u64]],
    masses: Option<&[f64]>,
    control: &Control,
) -> Result<PairHistogram> {
    let n = axes[0].len();
    let bins = plan.bins.len();
    let (periods, border_of) = (plan.domain.periods(), plan.domain.border());
    let mut counts = vec![0; bins];
    let mut weights = (plan.weighted() && !plan.border()).then(|| vec![0; bins]);
    let depths: Vec<u32> = match plan.border() {
        true => (0..n).map(|i| depth(&plan.thresholds, border_of.distance_of(axes, i)) as u32).collect(),
        false => Vec::new(),
    };
    let ones = vec![1.0; n];
    let masses = plan.masses.then_some(masses.unwrap_or(&ones));
    let mut border = plan.border().then(|| BorderHistogram {
        counts: vec![0; bins],
        ends: vec![0; bins + 1],
        norms: geometry::border_norms(&depths, bins, masses),
    });
    for i in 0..n {
        control.check()?;
        for j in 0..n {
            if i == j {
                continue;
            }
            let r2 = squared_distance(axes, periods, i, j);
            // The number of edges at or below the distance: bin b lies between edges b and b + 1.
            let edges_below = plan.thresholds.partition_point(|&t| t <= r2);
            if !(1..=bins).contains(&edges_below) {
                continue;
            }
            let bin = edges_below - 1;
            counts[bin] += 1;
            if let Some(weights) = &mut weights {
                weights[bin] += pair_weight(plan, axes, masses, i, j);
            }
            if let Some(border) = border.as_mut().filter(|_| depths[i] as usize > bin) {
                let pair = masses.map_or(1, |u| weighted_pair([u[i], u[j]], 1 << 32));
                border.counts[bin] += pair;
                border.ends[depths[i] as usize] += pair;
            }
        }
    }
    let masses = masses.map(geometry::mass_sums);
    Ok(PairHistogram { border, masses, ..PairHistogram::new(n as u64, counts, weights) })
}

//! Edge weights in a window that is a polygon W, by ways that the CPU path does not take.
//!
//! Translation, `|W| / |W ∩ (W + h)|`: a polygon is the sum of the trapezoids below its sides, counted negative where the
//! outline runs towards larger x, so that the overlap is
//!
//! ```text
//! sum_e sum_f s_e s_f ∫ min(y_e(x), y_f(x) + h_y) dx
//! ```
//!
//! over the x that sides e of W and f of `W + h` have in common. Isotropic, `2 pi` over the angle of the circle in W: the
//! circle is cut wherever it meets a side, and every arc counts whose middle is inside by the number of sides to its right.

use std::f64::consts::{PI, TAU};

use crate::accumulate::WEIGHT_STEPS;
use crate::points::polygon::Polygon;

/// Places in f64, in units of 2^64 steps.
fn places(polygon: &Polygon) -> Vec<[[f64; 2]; 2]> {
    polygon.sides().iter().map(|side| [side.from, side.to].map(|p| p.map(|x| x as f64 / 2f64.powi(64)))).collect()
}

/// The area that a polygon and the same shifted by `h` have in common.
fn common_area(sides: &[[[f64; 2]; 2]], h: [f64; 2]) -> f64 {
    let shifted: Vec<_> = sides.iter().map(|side| side.map(|p| [p[0] + h[0], p[1] + h[1]])).collect();
    let base = sides.iter().chain(&shifted).flatten().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    let mut sum = 0.0;
    for [a, b] in sides {
        for [c, d] in &shifted {
            let low = a[0].min(b[0]).max(c[0].min(d[0]));
            let high = a[0].max(b[0]).min(c[0].max(d[0]));
            if low >= high {
                continue;
            }
            let sign = if (a[0] < b[0]) == (c[0] < d[0]) { 1.0 } else { -1.0 };
            let height = |[p, q]: [&[f64; 2]; 2], x: f64| p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]) - base;
            let (first, second) = ([a, b], [c, d]);
            let trapezoid = |from: f64, to: f64| {
                let at = |x: f64| height(first, x).min(height(second, x));
                0.5 * (to - from) * (at(from) + at(to))
            };
            let gap = |x: f64| height(first, x) - height(second, x);
            sum += sign
                * if gap(low) * gap(high) < 0.0 {
                    let middle = low + (high - low) * gap(low) / (gap(low) - gap(high));
                    trapezoid(low, middle) + trapezoid(middle, high)
                } else {
                    trapezoid(low, high)
                };
        }
    }
    sum
}

/// In steps of 2^-32, for a lag in steps of 2^-64.
pub(super) fn translation_weight(polygon: &Polygon, lag: [i128; 2]) -> u64 {
    let sides = places(polygon);
    let whole = common_area(&sides, [0.0; 2]);
    (whole / common_area(&sides, lag.map(|x| x as f64 / 2f64.powi(64))) * WEIGHT_STEPS).round_ties_even() as u64
}

/// Of the circle about `center` through `other`, in steps of 2^-32.
pub(super) fn isotropic_weight(polygon: &Polygon, center: [u64; 2], other: [u64; 2]) -> u64 {
    let from_center = |p: [u64; 2]| [0, 1].map(|k| (i128::from(p[k]) - i128::from(center[k])) as f64);
    let sides: Vec<_> = polygon.sides().iter().map(|side| [from_center(side.from), from_center(side.to)]).collect();
    let [x, y] = from_center(other);
    let r2 = x * x + y * y;
    // Roots t in [0, 1] of |a + t (b - a)|^2 = r^2.
    let mut angles = vec![-PI, PI];
    for [a, b] in &sides {
        let d = [b[0] - a[0], b[1] - a[1]];
        let (square, half, rest) =
            (d[0] * d[0] + d[1] * d[1], a[0] * d[0] + a[1] * d[1], a[0] * a[0] + a[1] * a[1] - r2);
        let discriminant = half * half - square * rest;
        if discriminant <= 0.0 {
            continue;
        }
        for root in [-discriminant.sqrt(), discriminant.sqrt()] {
            let t = (root - half) / square;
            if (0.0..=1.0).contains(&t) {
                angles.push((a[1] + t * d[1]).atan2(a[0] + t * d[0]));
            }
        }
    }
    angles.sort_by(f64::total_cmp);
    let inside = |angle: f64| {
        let (x, y) = (r2.sqrt() * angle.cos(), r2.sqrt() * angle.sin());
        let right =
            |[a, b]: &&[[f64; 2]; 2]| (a[1] > y) != (b[1] > y) && a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) > x;
        sides.iter().filter(right).count() % 2 == 1
    };
    let arcs = angles.windows(2).filter(|arc| inside(0.5 * (arc[0] + arc[1])));
    let sum: f64 = arcs.map(|arc| arc[1] - arc[0]).sum();
    // As much as there is of a circle whose second point is at a corner, to rounding.
    (TAU / sum.max(TAU / 2f64.powi(30)) * WEIGHT_STEPS).round_ties_even() as u64
}

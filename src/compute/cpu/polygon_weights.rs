//! Edge weights in a window that is a polygon. Formulas: see `reference`, which takes other ways to them.
//!
//! Translation. Along the direction of a lag h, the indicator of the polygon W less that of `W + h` is the sum over sides of the
//! parallelograms that h sweeps, with the sign by which the side leads in or out. Half of its square, integrated, is what `W + h` does
//! not cover:
//!
//! ```text
//! |W| - |W ∩ (W + h)| = 1/2 sum_e sum_f s_e s_f ∫ max(0, |h| - |u_e(v) - u_f(v)|) dv
//! ```
//!
//! u along h, v across, `u_e(v)` where side e is. Only sides closer than |h| overlap, so that short lags cost little, and nothing is a
//! difference of large numbers.
//!
//! Isotropic. Where the outline, with W on its left, leaves the disk of a pair, the arc counterclockwise of it is in W; where it
//! enters, the arc before. The arcs in W are the angles of entries less those of exits, modulo a turn, whatever their order.

use std::f64::consts::TAU;

use crate::accumulate::WEIGHT_STEPS;
use crate::plan::{Correction, PairPlan};
use crate::points::polygon::Side;

/// Arcs so close to none or to a whole turn, in radians, are told apart by whether the longest of them is inside.
const NEARLY: f64 = 1e-6;

/// Less of a circle than this is as much as this: its second point is at a corner, to rounding.
const LEAST: f64 = TAU / (1u64 << 30) as f64;

/// What weights need to know about a polygon. Lengths are in units of the domain's length unit.
pub(super) struct PolygonWeights<'a> {
    sides: &'a [Side],
    /// The same as numbers, from end to end.
    ends: Vec<[[f64; 2]; 2]>,
    area: f64,
    /// Pairs of different sides that are closer than the largest distance, the closest first, with their distance.
    near: Vec<(f64, u32, u32)>,
}

impl<'a> PolygonWeights<'a> {
    /// Where the plan weights pairs and the window is a polygon.
    pub(super) fn new(plan: &'a PairPlan) -> Option<Self> {
        let polygon = plan.domain.as_polygon()?;
        let unit = plan.domain.length_unit();
        let ends: Vec<_> = polygon.sides().iter().map(|s| [s.from, s.to].map(|p| p.map(|x| x as f64 * STEP))).collect();
        let near = match plan.correction {
            Correction::Translation => near_sides(&ends, plan.bins.r_max() / unit * (1.0 + 1e-9)),
            _ => Vec::new(),
        };
        Some(Self { sides: polygon.sides(), ends, area: polygon.area() / (unit * unit), near })
    }

    /// `|W| / |W ∩ (W + h)|`, in steps of 2^-32.
    pub(super) fn translation(&self, lag: [i64; 2]) -> u64 {
        let h = lag.map(|x| x as f64 * STEP);
        let length = h[0].hypot(h[1]);
        if length == 0.0 {
            return 1 << 32;
        }
        let (cos, sin) = (h[0] / length, h[1] / length);
        // Along and across the lag.
        let turned = |p: [f64; 2]| [p[0] * cos + p[1] * sin, p[1] * cos - p[0] * sin];
        let ends: Vec<_> = self.ends.iter().map(|side| side.map(turned)).collect();
        let own: f64 = ends.iter().map(|[from, to]| (to[1] - from[1]).abs()).sum();
        let mut overlaps = 0.0;
        for &(_, e, f) in self.near.iter().take_while(|near| near.0 < length) {
            overlaps += overlap(ends[e as usize], ends[f as usize], length);
        }
        let lost = 0.5 * length * own + overlaps;
        (self.area / (self.area - lost) * WEIGHT_STEPS).round_ties_even() as u64
    }

    /// The inverse of the part of a circle that is in the polygon, in steps of 2^-32.
    pub(super) fn isotropic(&self, center: [u64; 2], r2: u128) -> u64 {
        let r2 = r2 as f64;
        let (mut crossings, mut inside) = (0, 0.0);
        self.crossings(center, r2, |angle, sign| {
            crossings += 1;
            inside += sign * angle;
        });
        if crossings == 0 {
            return 1 << 32;
        }
        let mut inside = inside.rem_euclid(TAU);
        if !(NEARLY..TAU - NEARLY).contains(&inside) {
            // Rounding may have gone over the end of a turn.
            let nearly_all = self.longest_arc_is_inside(center, r2);
            inside += if nearly_all && inside < 1.0 {
                TAU
            } else if !nearly_all && inside > 1.0 {
                -TAU
            } else {
                0.0
            };
        }
        (TAU / inside.max(LEAST) * WEIGHT_STEPS).round_ties_even() as u64
    }

    /// Where the outline crosses a circle: the angle, and 1 where it enters, -1 where it leaves.
    fn crossings(&self, center: [u64; 2], r2: f64, mut each: impl FnMut(f64, f64)) {
        // Differences are exact until they are numbers.
        let from_center = |p: [u64; 2]| [0, 1].map(|k| p[k].wrapping_sub(center[k]) as i64 as f64);
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        for side in self.sides {
            let (a, b) = (from_center(side.from), from_center(side.to));
            let (a_inside, b_inside) = (square(a) < r2, square(b) < r2);
            if a_inside && b_inside {
                continue;
            }
            let d = [b[0] - a[0], b[1] - a[1]];
            let length2 = square(d);
            let nearest = -(a[0] * d[0] + a[1] * d[1]) / length2;
            let cross = a[0] * d[1] - a[1] * d[0];
            let beyond = r2 - cross * cross / length2;
            let crosses = beyond > 0.0 && nearest > 0.0 && nearest < 1.0;
            if !(a_inside || b_inside || crosses) {
                continue;
            }
            let chord = (beyond.max(0.0) / length2).sqrt();
            let angle = |t: f64| libm::atan2(a[1] + t * d[1], a[0] + t * d[0]);
            if !a_inside {
                each(angle(nearest - chord), 1.0);
            }
            if !b_inside {
                each(angle(nearest + chord), -1.0);
            }
        }
    }

    /// Whether the middle of the longest arc between crossings is inside.
    fn longest_arc_is_inside(&self, center: [u64; 2], r2: f64) -> bool {
        let mut angles = Vec::new();
        self.crossings(center, r2, |angle, _| angles.push(angle));
        angles.sort_unstable_by(f64::total_cmp);
        let Some(&first) = angles.first() else { return true };
        let ends = angles.iter().skip(1).copied().chain([first + TAU]);
        let (middle, _) = angles.iter().zip(ends).fold((0.0, 0.0), |longest, (&start, end)| {
            if end - start > longest.1 { (0.5 * (start + end), end - start) } else { longest }
        });
        let r = r2.sqrt() * STEP;
        let at = [center[0] as f64 * STEP + r * libm::cos(middle), center[1] as f64 * STEP + r * libm::sin(middle)];
        let crossed = |&&[a, b]: &&[[f64; 2]; 2]| {
            (a[1] > at[1]) != (b[1] > at[1]) && a[0] + (b[0] - a[0]) * ((at[1] - a[1]) / (b[1] - a[1])) > at[0]
        };
        self.ends.iter().filter(crossed).count() % 2 == 1
    }
}

/// Length units to a step.
const STEP: f64 = 1.0 / (1u128 << 64) as f64;

/// Pairs of different sides closer than `reach`, the closest first.
fn near_sides(ends: &[[[f64; 2]; 2]], reach: f64) -> Vec<(f64, u32, u32)> {
    let range = |k: usize, axis: usize| {
        let [a, b] = ends[k].map(|p| p[axis]);
        (a.min(b), a.max(b))
    };
    let mut order: Vec<usize> = (0..ends.len()).collect();
    order.sort_by(|&e, &f| range(e, 0).0.total_cmp(&range(f, 0).0));
    let mut near = Vec::new();
    for (k, &e) in order.iter().enumerate() {
        let (high, y) = (range(e, 0).1, range(e, 1));
        for &f in order[k + 1..].iter().take_while(|&&f| range(f, 0).0 - high < reach) {
            let z = range(f, 1);
            if z.0 - y.1 >= reach || y.0 - z.1 >= reach {
                continue;
            }
            let distance = between(ends[e], ends[f]);
            if distance < reach {
                // A hair less, for what is rounded.
                near.push((distance * (1.0 - 1e-9), e.min(f) as u32, e.max(f) as u32));
            }
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    near
}

/// The distance between two sides, which do not cross: from an end of one to the other.
fn between(e: [[f64; 2]; 2], f: [[f64; 2]; 2]) -> f64 {
    let to = |p: [f64; 2], [a, b]: [[f64; 2]; 2]| {
        let (d, w) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let along = ((w[0] * d[0] + w[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        (w[0] - along * d[0]).hypot(w[1] - along * d[1])
    };
    to(e[0], f).min(to(e[1], f)).min(to(f[0], e)).min(to(f[1], e))
}

/// `s_e s_f ∫ max(0, |h| - |u_e - u_f|) dv` of two sides, in coordinates along and across h.
fn overlap(e: [[f64; 2]; 2], f: [[f64; 2]; 2], length: f64) -> f64 {
    let [e_down, f_down] = [e, f].map(|[a, b]| a[1] > b[1]);
    let range = |[a, b]: [[f64; 2]; 2]| (a[1].min(b[1]), a[1].max(b[1]));
    let (low, high) = (range(e).0.max(range(f).0), range(e).1.min(range(f).1));
    if low >= high {
        return 0.0;
    }
    let along = |[a, b]: [[f64; 2]; 2], v: f64| a[0] + (b[0] - a[0]) * ((v - a[1]) / (b[1] - a[1]));
    let difference = |v| along(e, v) - along(f, v);
    let (first, last) = (difference(low), difference(high));
    let (a, b) = (first.min(last), first.max(last));
    let mean = if a == b {
        (length - a.abs()).max(0.0)
    } else {
        // The mean over a range of differences, in two straight pieces.
        let piece = |from: f64, to: f64| {
            if from < to { 0.5 * (to - from) * ((length - from.abs()) + (length - to.abs())) } else { 0.0 }
        };
        (piece(a.max(-length), b.min(0.0)) + piece(a.max(0.0), b.min(length))) / (b - a)
    };
    let value = (high - low) * mean;
    if e_down == f_down { value } else { -value }
}

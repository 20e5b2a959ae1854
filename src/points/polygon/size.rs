//! Circles inside and about a polygon: up to which distances it can say something.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use geo::{ConvexHull, Coord, MultiPoint, Point};

use super::{Polygon, Ring};

/// Evaluations are shared between squares and sides.
const EVALUATIONS: usize = 1 << 28;

/// A square that may hold the centre.
struct Square {
    center: [f64; 2],
    half: f64,
    /// The largest depth that it may hold.
    bound: f64,
}

impl PartialEq for Square {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Square {}

impl PartialOrd for Square {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Square {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// The radius of the largest circle inside, in steps: that of a circle which is inside, and within 1e-4 of the largest. Squares
/// that could hold a larger one are cut into four, the most promising first (the method of polylabel).
pub(super) fn inner_radius(polygon: &Polygon) -> f64 {
    let ends = |axis: usize| polygon.rounded.iter().flatten().map(move |p| p[axis]).fold(0.0, f64::max);
    let (width, height) = (ends(0), ends(1));
    let square = |center: [f64; 2], half: f64| {
        let depth = polygon.depth(center);
        (depth, Square { center, half, bound: depth + half * f64::sqrt(2.0) })
    };
    let side = width.min(height);
    let (columns, rows) = ((width / side).ceil().min(1e3) as usize, (height / side).ceil().min(1e3) as usize);
    let half = 0.5 * (width / columns as f64).max(height / rows as f64);
    // In a box, the middle.
    let mut best = polygon.depth([0.5 * width, 0.5 * height]).max(0.0);
    let mut waiting = BinaryHeap::new();
    let look = |center, half, best: &mut f64| {
        let (depth, square) = square(center, half);
        *best = best.max(depth);
        square
    };
    for column in 0..columns {
        for row in 0..rows {
            let at = |k: usize, all: usize, length: f64| (k as f64 + 0.5) * length / all as f64;
            waiting.push(look([at(column, columns, width), at(row, rows, height)], half, &mut best));
        }
    }
    for _ in 0..(EVALUATIONS / (4 * polygon.rounded.len())).min(1 << 16) {
        let Some(Square { center: [x, y], half, .. }) = waiting.pop().filter(|s| s.bound > best * (1.0 + 1e-4)) else {
            break;
        };
        let half = 0.5 * half;
        for (dx, dy) in [(-half, -half), (half, -half), (-half, half), (half, half)] {
            waiting.push(look([x + dx, y + dy], half, &mut best));
        }
    }
    best
}

/// The radius of the smallest circle about a part, for the part where it is least.
pub(super) fn circumradius(parts: &[Vec<Ring>]) -> f64 {
    parts.iter().filter_map(|rings| rings.first()).map(|outer| about(outer)).fold(f64::INFINITY, f64::min)
}

/// The radius of the smallest circle about some points (Welzl's method, in rounds).
fn about(ring: &[[f64; 2]]) -> f64 {
    let points: MultiPoint<f64> = ring.iter().map(|&[x, y]| Point::new(x, y)).collect();
    let hull: Vec<Coord<f64>> = points.convex_hull().exterior().0.clone();
    let n = hull.len();
    // In an order that no outline has.
    let points: Vec<Coord<f64>> = {
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by_key(|&k| (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        order.into_iter().map(|k| hull[k] - hull[0]).collect()
    };
    let holds =
        |(center, r): (Coord<f64>, f64), p: Coord<f64>| (p - center).x.hypot((p - center).y) <= r * (1.0 + 1e-12);
    let mut circle = (points[0], 0.0);
    for i in 1..n {
        if holds(circle, points[i]) {
            continue;
        }
        circle = (points[i], 0.0);
        for j in 0..i {
            if holds(circle, points[j]) {
                continue;
            }
            circle = through(&[points[i], points[j]]);
            for k in 0..j {
                if !holds(circle, points[k]) {
                    circle = through(&[points[i], points[j], points[k]]);
                }
            }
        }
    }
    circle.1
}

/// The circle through two points, as its diameter, or three.
fn through(points: &[Coord<f64>]) -> (Coord<f64>, f64) {
    let a = points[0];
    let b = points[1] - a;
    let from_a = match points.get(2) {
        Some(&c) => {
            let c = c - a;
            let (b2, c2, area) = (b.x * b.x + b.y * b.y, c.x * c.x + c.y * c.y, 2.0 * (b.x * c.y - b.y * c.x));
            Coord { x: (c.y * b2 - b.y * c2) / area, y: (b.x * c2 - c.x * b2) / area }
        }
        None => b * 0.5,
    };
    (a + from_a, from_a.x.hypot(from_a.y))
}

//! A window that is no box: a polygon, of one or more parts, each with holes.
//!
//! Vertices become the same integers as points, in steps of `length_unit / 2^64` from the lower corner of the bounding box, so
//! that whether a point is inside is decided exactly.

mod check;
mod size;

use super::fixed_point::{difference, steps};
use crate::error::number;

/// A ring: its vertices in order, the first not repeated at the end.
pub type Ring = Vec<[f64; 2]>;

/// Vertices of all rings together. Some sums over them are quadratic.
const MAX_VERTICES: usize = 10_000;

/// A side between two vertices, in steps. What is inside the polygon is on its left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Side {
    /// Where it begins.
    pub from: [u64; 2],
    /// Where it ends.
    pub to: [u64; 2],
}

/// A polygon that was checked: rings that cross neither themselves nor each other, holes inside their outer rings, parts that do not
/// overlap.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    /// Per part its outer ring, counterclockwise, and its holes, clockwise; in the units of the points.
    parts: Vec<Vec<Ring>>,
    /// The lower corner of its box, and the domain's length unit.
    origin: [f64; 2],
    unit: f64,
    sides: Vec<Side>,
    /// As f64, for a first look.
    rounded: Vec<[[f64; 2]; 2]>,
    /// The area in squared length units.
    area: f64,
    inner_diameter: f64,
    circumradius: f64,
    /// So many steps beside a side a point is on it: coordinates are rounded.
    tolerance: u64,
}

/// What is wrong with which ring.
pub(super) struct Fault {
    pub(super) ring: String,
    pub(super) reason: String,
}

impl Polygon {
    /// Rings without closing vertices and repetitions, in their directions, if nothing is wrong with them.
    pub(super) fn checked(parts: Vec<Vec<Ring>>) -> Result<Vec<Vec<Ring>>, Fault> {
        let parts: Vec<Vec<Ring>> = parts.into_iter().map(|rings| rings.into_iter().map(cleaned).collect()).collect();
        let vertices = parts.iter().flatten().map(Vec::len).sum::<usize>();
        if vertices > MAX_VERTICES {
            let reason = format!("{vertices} vertices; expected at most {MAX_VERTICES}: simplify the outline");
            return Err(Fault { ring: "polygon".into(), reason });
        }
        check::check(&parts)?;
        Ok(parts.into_iter().map(directed).collect())
    }

    /// Of checked rings, in a box from `origin` with a length unit.
    pub(super) fn new(parts: Vec<Vec<Ring>>, origin: [f64; 2], unit: f64) -> Self {
        let place = |v: &[f64; 2]| [0, 1].map(|a| steps(difference(v[a], origin[a]), unit) as u64);
        let mut sides = Vec::new();
        for ring in parts.iter().flatten() {
            let places: Vec<_> = ring.iter().map(place).collect();
            sides.extend((0..places.len()).map(|k| Side { from: places[k], to: places[(k + 1) % places.len()] }));
        }
        let rounded: Vec<_> = sides.iter().map(|s| [s.from, s.to].map(|p| p.map(|x| x as f64))).collect();
        let step = unit * 2f64.powi(-64);
        let area = parts.iter().flatten().map(|ring| ring_area(ring)).sum();
        let largest = parts.iter().flatten().flatten().flatten().fold(0.0, |l: f64, x| l.max(x.abs()));
        let tolerance = (4.0 * f64::EPSILON * largest / step).ceil() as u64;
        let mut polygon = Self {
            circumradius: size::circumradius(&parts),
            parts,
            origin,
            unit,
            sides,
            rounded,
            area,
            inner_diameter: 0.0,
            tolerance,
        };
        polygon.inner_diameter = 2.0 * size::inner_radius(&polygon) * step;
        polygon
    }

    /// Per part its outer ring, counterclockwise, and its holes, clockwise.
    pub fn parts(&self) -> &[Vec<Ring>] {
        &self.parts
    }

    /// All sides, ring by ring.
    pub fn sides(&self) -> &[Side] {
        &self.sides
    }

    /// The area.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The length of all sides together.
    pub fn length(&self) -> f64 {
        let length = |[a, b]: &[[f64; 2]; 2]| (b[0] - a[0]).hypot(b[1] - a[1]);
        self.rounded.iter().map(length).sum::<f64>() * 2f64.powi(-64) * self.unit
    }

    /// The diameter of the largest circle inside, to 1e-4 of it and never too large.
    pub fn inner_diameter(&self) -> f64 {
        self.inner_diameter
    }

    /// The radius of the smallest circle about a part, of the part for which it is smallest.
    pub fn circumradius(&self) -> f64 {
        self.circumradius
    }

    /// Whether a point of its box, in the units of the points, is inside or on a side.
    pub fn contains_point(&self, point: [f64; 2]) -> bool {
        self.contains([0, 1].map(|a| steps(difference(point[a], self.origin[a]), self.unit) as u64))
    }

    /// Whether a box, given by its ends in steps along each axis, is inside: its middle is, and no side enters it.
    pub(crate) fn holds_box(&self, ends: [[f64; 2]; 2]) -> bool {
        let enters = |[from, to]: &[[f64; 2]; 2]| {
            // The part of the side that is between the ends along both axes.
            let (mut first, mut last) = (0f64, 1f64);
            for (a, [low, high]) in ends.into_iter().enumerate() {
                let way = to[a] - from[a];
                if way == 0.0 {
                    if from[a] <= low || from[a] >= high {
                        return false;
                    }
                    continue;
                }
                let [s, t] = [(low - from[a]) / way, (high - from[a]) / way];
                (first, last) = (first.max(s.min(t)), last.min(s.max(t)));
            }
            first < last
        };
        self.depth(ends.map(|[low, high]| 0.5 * (low + high))) > 0.0 && !self.rounded.iter().any(enters)
    }

    /// Whether a place, in steps, is inside or on a side.
    pub fn contains(&self, place: [u64; 2]) -> bool {
        let mut inside = false;
        for Side { from, to } in &self.sides {
            if (from[1] > place[1]) != (to[1] > place[1]) {
                let left = turn(*from, *to, place);
                // On a side that is crossed.
                if left == 0 {
                    return true;
                }
                inside ^= (left > 0) == (to[1] > from[1]);
            }
        }
        inside || self.to_sides(place) <= self.tolerance
    }

    /// The distance of a place from the nearest side, in steps, rounded down: exact where that side is along an axis.
    pub fn to_sides(&self, place: [u64; 2]) -> u64 {
        let at = place.map(|x| x as f64);
        let mut nearest = f64::INFINITY;
        for [from, to] in &self.rounded {
            nearest = nearest.min(squared_distance(at, *from, *to));
        }
        // What is rounded is decided again.
        let bound = (nearest.sqrt() * (1.0 + 1e-9) + 4096.0).powi(2);
        let candidates =
            self.sides.iter().zip(&self.rounded).filter(|(_, [from, to])| squared_distance(at, *from, *to) <= bound);
        candidates.map(|(side, _)| distance_to(side, place)).min().unwrap_or(0)
    }

    /// Distance from the nearest side in steps, in f64, negative outside.
    fn depth(&self, at: [f64; 2]) -> f64 {
        let (mut nearest, mut inside) = (f64::INFINITY, false);
        for [from, to] in &self.rounded {
            nearest = nearest.min(squared_distance(at, *from, *to));
            if (from[1] > at[1]) != (to[1] > at[1]) {
                let x = from[0] + (to[0] - from[0]) * ((at[1] - from[1]) / (to[1] - from[1]));
                inside ^= x > at[0];
            }
        }
        if inside { nearest.sqrt() } else { -nearest.sqrt() }
    }

    /// `12 vertices, 1 hole`, `40 vertices in 3 parts`.
    pub(crate) fn words(&self) -> String {
        let vertices = self.sides.len();
        let holes = self.parts.iter().map(|rings| rings.len() - 1).sum::<usize>();
        let mut words = format!("{vertices} vertices");
        if self.parts.len() > 1 {
            words += &format!(" in {} parts", self.parts.len());
        }
        match holes {
            0 => {}
            1 => words += ", 1 hole",
            _ => words += &format!(", {holes} holes"),
        }
        words
    }
}

/// Twice the area of the triangle, positive if `c` is left of the way from `a` to `b`. Places of a window are below 2^63.
fn turn(a: [u64; 2], b: [u64; 2], c: [u64; 2]) -> i128 {
    let d = |p: [u64; 2], k: usize| i128::from(p[k]) - i128::from(a[k]);
    d(b, 0) * d(c, 1) - d(b, 1) * d(c, 0)
}

/// From a place to a side, in f64.
fn squared_distance(at: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let (d, w) = ([to[0] - from[0], to[1] - from[1]], [at[0] - from[0], at[1] - from[1]]);
    let along = ((w[0] * d[0] + w[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    let off = [w[0] - along * d[0], w[1] - along * d[1]];
    off[0] * off[0] + off[1] * off[1]
}

/// From a place to a side in whole steps, rounded down.
fn distance_to(side: &Side, place: [u64; 2]) -> u64 {
    let minus = |p: [u64; 2], q: [u64; 2]| [0, 1].map(|k| i128::from(p[k]) - i128::from(q[k]));
    let dot = |p: [i128; 2], q: [i128; 2]| p[0] * q[0] + p[1] * q[1];
    let (d, w) = (minus(side.to, side.from), minus(place, side.from));
    let (along, length2) = (dot(w, d), dot(d, d));
    if along <= 0 {
        return (dot(w, w) as u128).isqrt() as u64;
    }
    if along >= length2 {
        let v = minus(place, side.to);
        return (dot(v, v) as u128).isqrt() as u64;
    }
    match d {
        [0, _] => w[0].unsigned_abs() as u64,
        [_, 0] => w[1].unsigned_abs() as u64,
        _ => (turn(side.from, side.to, place).unsigned_abs() as f64 / (length2 as f64).sqrt()) as u64,
    }
}

/// Without the closing vertex, and without vertices that repeat the one before.
fn cleaned(mut ring: Ring) -> Ring {
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

/// The area of a ring, positive if it is counterclockwise.
fn ring_area(ring: &[[f64; 2]]) -> f64 {
    let Some(&[x0, y0]) = ring.first() else { return 0.0 };
    let next = ring.iter().cycle().skip(1);
    let cross = |([ax, ay], [bx, by]): (&[f64; 2], &[f64; 2])| (ax - x0) * (by - y0) - (bx - x0) * (ay - y0);
    ring.iter().zip(next).map(cross).sum::<f64>() / 2.0
}

/// Rings with what is inside the polygon on the left.
fn directed(rings: Vec<Ring>) -> Vec<Ring> {
    let turned = |(k, mut ring): (usize, Ring)| {
        if (ring_area(&ring) > 0.0) != (k == 0) {
            ring.reverse();
        }
        ring
    };
    rings.into_iter().enumerate().map(turned).collect()
}

/// The ends along each axis, if the polygon is a box.
pub(super) fn as_box(parts: &[Vec<Ring>]) -> Option<[(f64, f64); 2]> {
    let [rings] = parts else { return None };
    let [ring] = rings.as_slice() else { return None };
    let [a, b, c, d] = ring[..] else { return None };
    let along = |first: usize| {
        let second = 1 - first;
        a[second] == b[second] && b[first] == c[first] && c[second] == d[second] && d[first] == a[first]
    };
    (along(0) || along(1)).then(|| [0, 1].map(|k| (a[k].min(c[k]), a[k].max(c[k]))))
}

/// `(0.5, 1)`.
fn point(x: f64, y: f64) -> String {
    format!("({}, {})", number(x), number(y))
}

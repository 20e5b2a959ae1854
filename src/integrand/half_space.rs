//! A half-plane or half-space, cut off by the unit box.

use std::f64::consts::PI;

use rustfft::num_complex::Complex;

use super::quadrature::gauss;
use super::shape::{Shape, turn};
use crate::sinc::sinc;

/// 1 where `n.x < c`, in 2 or 3 dimensions.
pub(super) struct HalfSpace {
    normal: [f64; 3],
    offset: f64,
    /// What bounds the part of the box: one polygon in 2D, faces in 3D; nothing where it is empty.
    faces: Vec<Face>,
    integral: f64,
}

/// A flat polygon, counter-clockwise about its normal.
struct Face {
    normal: [f64; 3],
    corners: Vec<[f64; 3]>,
}

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The place between a and b, from 0 to 1.
fn between(a: Vector, b: Vector, t: f64) -> Vector {
    std::array::from_fn(|k| a[k] + t * (b[k] - a[k]))
}

impl HalfSpace {
    pub(super) fn new(dim: usize, normal: Vector, offset: f64) -> Self {
        let faces = if dim == 2 {
            let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
            vec![Face { normal: [0.0, 0.0, 1.0], corners: clipped(&square, normal, offset) }]
        } else {
            polyhedron(normal, offset)
        };
        let integral = volume([[0.0, 1.0]; 3], normal, offset);
        Self { normal, offset, faces, integral }
    }
}

impl Shape for HalfSpace {
    fn value(&self, x: Vector) -> f64 {
        f64::from(u8::from(dot(self.normal, x) < self.offset))
    }

    fn integral(&self) -> f64 {
        self.integral
    }

    fn square_integral(&self) -> f64 {
        self.integral
    }

    /// The divergence theorem, once from area to edges, and in 3D once more from volume to faces.
    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        if m == [0; 3] {
            return Complex::from(self.integral);
        }
        let m = m.map(f64::from);
        match self.faces.as_slice() {
            [area] => {
                if m[2] != 0.0 {
                    return Complex::default();
                }
                area.transform(m)
            }
            faces => {
                let through = |face: &Face| face.transform(m) * dot(m, face.normal);
                faces.iter().map(through).sum::<Complex<f64>>() * Complex::new(0.0, 1.0 / (2.0 * PI * dot(m, m)))
            }
        }
    }

    /// x and x + t are both inside where n.x is below both c and c - n.t: on each of the 2^d boxes that the wrap leaves, a half-space
    /// again. Edges that coincide are therefore nothing special.
    fn autocorrelation(&self, r: Vector) -> f64 {
        let n = self.normal;
        let parts = r.map(|r| [([0.0, 1.0 - r], r), ([1.0 - r, 1.0], r - 1.0)]);
        let mut sum = 0.0;
        for (x, tx) in parts[0] {
            for (y, ty) in parts[1] {
                for (z, tz) in parts[2] {
                    if x[0] < x[1] && y[0] < y[1] && z[0] < z[1] {
                        sum += volume([x, y, z], n, self.offset.min(self.offset - dot(n, [tx, ty, tz])));
                    }
                }
            }
        }
        sum
    }

    fn smoothness(&self) -> f64 {
        1.0
    }
}

/// The measure of the part of a box where `n.x < c`, n of length 1.
fn volume(sides: [[f64; 2]; 3], n: Vector, c: f64) -> f64 {
    // Outermost the axis along which the plane rises least, innermost the one it is across: nothing is then divided by what is small
    // but the height of a cut, and a cut too far is none.
    let mut axes = [0, 1, 2];
    axes.sort_unstable_by(|&i, &j| n[i].abs().total_cmp(&n[j].abs()));
    let [outer, middle, inner] = axes.map(|k| (sides[k], n[k]));
    let (z, rise) = outer;
    if rise == 0.0 {
        return (z[1] - z[0]) * area(inner, middle, c);
    }
    // Over z the area is a quadratic between the heights at which the plane meets an edge: Simpson's rule is exact.
    let mut cuts = [z[0]; 6];
    cuts[5] = z[1];
    for (i, cut) in cuts[1..5].iter_mut().enumerate() {
        *cut = ((c - inner.1 * inner.0[i % 2] - middle.1 * middle.0[i / 2]) / rise).clamp(z[0], z[1]);
    }
    cuts[1..5].sort_unstable_by(f64::total_cmp);
    let at = |z: f64| area(inner, middle, c - rise * z);
    let piece = |w: &[f64]| (w[1] - w[0]) / 6.0 * (at(w[0]) + 4.0 * at(0.5 * (w[0] + w[1])) + at(w[1]));
    cuts.windows(2).filter(|w| w[0] < w[1]).map(piece).sum()
}

/// The area of the part of a rectangle, sides and what n has along each, where `n.x < c`; the first is not 0 and not the smaller.
fn area((along, a): ([f64; 2], f64), (across, b): ([f64; 2], f64), c: f64) -> f64 {
    let whole = along[1] - along[0];
    let start = if a > 0.0 { along[0] } else { along[1] };
    let length = |s: f64| ((c - b * s) / a - start) * a.signum();
    let (from, to) = (length(across[0]), length(across[1]));
    // A line that is cut off at 0 and at the whole: trapezoids between the cuts.
    let cut = |value: f64| if from == to { 0.0 } else { ((value - from) / (to - from)).clamp(0.0, 1.0) };
    let (first, second) = (cut(0.0), cut(whole));
    let ends = [0.0, first.min(second), first.max(second), 1.0];
    let at = |t: f64| (from + t * (to - from)).clamp(0.0, whole);
    let sum: f64 = ends.windows(2).map(|w| (w[1] - w[0]) * 0.5 * (at(w[0]) + at(w[1]))).sum();
    sum * (across[1] - across[0])
}

/// The part of a convex polygon where `n.x < c` (Sutherland & Hodgman 1974).
fn clipped(corners: &[Vector], n: Vector, c: f64) -> Vec<Vector> {
    let mut kept = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (above_a, above_b) = (dot(n, a) - c, dot(n, b) - c);
        if above_a < 0.0 {
            kept.push(a);
        }
        if (above_a < 0.0) != (above_b < 0.0) {
            kept.push(between(a, b, above_a / (above_a - above_b)));
        }
    }
    kept
}

/// The faces of the part of the unit cube where `n.x < c`.
fn polyhedron(n: Vector, c: f64) -> Vec<Face> {
    let mut faces = Vec::new();
    let mut rim: Vec<Vector> = Vec::new();
    for axis in 0..3 {
        for end in [0.0, 1.0] {
            let place = |u: f64, v: f64| {
                let mut x = [end; 3];
                (x[(axis + 1) % 3], x[(axis + 2) % 3]) = (u, v);
                x
            };
            // Counter-clockwise about the outer normal.
            let mut square = vec![place(0.0, 0.0), place(1.0, 0.0), place(1.0, 1.0), place(0.0, 1.0)];
            let mut normal = [0.0; 3];
            normal[axis] = 2.0 * end - 1.0;
            if end == 0.0 {
                square.reverse();
            }
            for (i, &a) in square.iter().enumerate() {
                let b = square[(i + 1) % 4];
                let (above_a, above_b) = (dot(n, a) - c, dot(n, b) - c);
                if (above_a < 0.0) != (above_b < 0.0) {
                    rim.push(between(a, b, above_a / (above_a - above_b)));
                }
            }
            let corners = clipped(&square, n, c);
            if corners.len() > 2 {
                faces.push(Face { normal, corners });
            }
        }
    }
    if rim.len() > 2 {
        // Every corner of the cut is seen from two faces; in order of angle they stand side by side, and an edge of length 0 is none.
        let middle: Vector = std::array::from_fn(|k| rim.iter().map(|p| p[k]).sum::<f64>() / rim.len() as f64);
        let far = rim.iter().copied().max_by(|a, b| {
            let from = |p: Vector| dot(minus(p, middle), minus(p, middle));
            from(*a).total_cmp(&from(*b))
        });
        let e1 = minus(far.unwrap_or(middle), middle);
        let e2 = cross(n, e1);
        let angle = |p: &Vector| dot(minus(*p, middle), e2).atan2(dot(minus(*p, middle), e1));
        rim.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        faces.push(Face { normal: n, corners: rim });
    }
    faces
}

impl Face {
    /// `int exp(-2 pi i m.x) dA` over it: its edges, counter-clockwise.
    fn transform(&self, m: Vector) -> Complex<f64> {
        let across = dot(m, self.normal);
        let within: Vector = std::array::from_fn(|k| m[k] - across * self.normal[k]);
        let m2 = dot(within, within);
        if m2 < 0.01 {
            return self.slow_transform(m);
        }
        let mut sum = Complex::<f64>::default();
        for (i, &a) in self.corners.iter().enumerate() {
            let b = self.corners[(i + 1) % self.corners.len()];
            let edge = minus(b, a);
            let outward = dot(within, cross(edge, self.normal));
            sum += turn(dot(m, between(a, b, 0.5))) * (outward * sinc(dot(m, edge)));
        }
        sum * Complex::new(0.0, 1.0 / (2.0 * PI * m2))
    }

    /// The same where m is nearly the normal, which the edges lose to rounding: there the phase hardly turns over the face.
    fn slow_transform(&self, m: Vector) -> Complex<f64> {
        let rule = gauss(12);
        let Some(&a) = self.corners.first() else { return Complex::default() };
        let mut sum = Complex::<f64>::default();
        for pair in self.corners[1..].windows(2) {
            let double_area = dot(cross(minus(pair[0], a), minus(pair[1], a)), self.normal);
            for (u, wu) in &rule {
                for (v, wv) in &rule {
                    // Duffy's square: u from the corner outwards, v along the side opposite.
                    let (u, v) = (0.5 * (1.0 + u), 0.5 * (1.0 + v));
                    let x = between(a, between(pair[0], pair[1], v), u);
                    sum += turn(dot(m, x)) * (0.25 * wu * wv * u * double_area);
                }
            }
        }
        sum
    }
}

//! Shells that reach beyond half the shortest side of a torus: minimum-image vectors fill the box `[-L/2, L/2)^d`, so only
//! the part of a shell inside that box can hold pairs.
//!
//! The surface `S(r)` of the sphere inside the box is known in closed form, by inclusion and exclusion. With half sides
//! `a, b, c`, and only the terms whose differences and roots are real:
//!
//! - 2D: a circle less what the four sides cut off, `S = 4 r (pi/2 - acos(a/r) - acos(b/r))`;
//! - 3D: `S = 4 pi r^2 - sum_a 4 pi r (r - a) + sum_ab 4 W(a, b)`: a sphere less six caps, and twelve edges beyond which two
//!   caps overlap (three never do before half the diagonal). By the theorem of Gauss and Bonnet the part beyond an edge is
//!   `W = 2 r^2 acos(ab / (A B)) - 2 a r acos(b / A) - 2 b r acos(a / B)`, `A^2 = r^2 - a^2`, `B^2 = r^2 - b^2`.
//!
//! A shell is the integral of S over r. S has square roots in r at the radii where faces and edges begin to cut, and none
//! at the nearest such radius p below r in `t`, `r^2 = p^2 + t^2`. The others lie where t is imaginary, so that panels
//! which grow in proportion to t stay as far from them as they are long, and Gauss-Legendre nodes in t find the integral
//! to rounding. Nothing is a difference of large terms when edges are close. Relative error: 1e-13 in 2D; in 3D 1e-15 of
//! the whole shell, over the part of it inside the box.

use std::f64::consts::{FRAC_PI_2, PI};

const NODES: usize = 16;

/// How much longer a panel is than the one below it, and how many there are: what is left below is 1e-17 of the whole.
const GROWTH: f64 = 0.25;
const PANELS: i32 = 14;

/// The measure of `lo <= |x| < hi` in the box with the given sides, in 1, 2 or 3 dimensions.
pub(super) fn shell_measure(lo: f64, hi: f64, sides: &[f64]) -> f64 {
    let mut half: Vec<f64> = sides.iter().map(|s| s / 2.0).collect();
    half.sort_by(f64::total_cmp);
    if let [a] = half[..] {
        return 2.0 * (hi.min(a) - lo.min(a));
    }
    let diagonal = half.iter().map(|h| h * h).sum::<f64>().sqrt();
    let mut radii = vec![0.0];
    radii.extend(&half);
    if let [a, b, c] = half[..] {
        radii.extend([a.hypot(b), a.hypot(c), b.hypot(c)]);
    }
    radii.push(diagonal);
    radii.sort_by(f64::total_cmp);
    let nodes = gauss_legendre();
    let mut sum = 0.0;
    for ends in radii.windows(2) {
        let p = ends[0];
        let (from, to) = (lo.max(p), hi.min(ends[1]));
        if from >= to {
            continue;
        }
        let t_of = |r: f64| ((r - p) * (r + p)).sqrt();
        let (first, last) = (t_of(from), t_of(to));
        // The difference of roots, without cancellation.
        let width = (to - from) * (to + from) / (first + last);
        let mut end = width;
        for panel in 1..=PANELS {
            let start = if panel == PANELS { 0.0 } else { (last * GROWTH.powi(panel) - first).max(0.0) };
            // r dr = t dt
            let integrand = |x: f64| {
                let t = first + start + (end - start) * x;
                t * surface_over_r(p, t, &half)
            };
            sum += (end - start) * nodes.iter().map(|&(x, weight)| weight * integrand(x)).sum::<f64>();
            end = start;
            if start == 0.0 {
                break;
            }
        }
    }
    sum
}

/// `S(r) / r` at `r^2 = p^2 + t^2`.
fn surface_over_r(p: f64, t: f64, half: &[f64]) -> f64 {
    let r = p.hypot(t);
    // sqrt(r^2 - q^2) for radii q up to p, 0 for those not reached.
    let root = |q: f64| if q <= p { (t * t + (p - q) * (p + q)).max(0.0).sqrt() } else { 0.0 };
    match *half {
        [a, b] => {
            let (beside_a, beside_b) = (root(a), root(b));
            if beside_a > 0.0 && beside_b > 0.0 {
                // The angle left between two cuts, from the distance to the corner.
                let left = (a * a - t * t + (b - p) * (b + p)).max(0.0);
                let sine = r * r * left / (a * b + beside_a * beside_b);
                return 4.0 * sine.atan2(a * beside_b + b * beside_a);
            }
            4.0 * (FRAC_PI_2 - beside_a.atan2(a) - beside_b.atan2(b))
        }
        [a, b, c] => {
            let caps = [a, b, c].iter().map(|&a| 4.0 * PI * (r - a).max(0.0)).sum::<f64>();
            let edge = |a: f64, b: f64| {
                let s = root(a.hypot(b));
                8.0 * (r * (r * s).atan2(a * b) - a * s.atan2(b) - b * s.atan2(a))
            };
            (4.0 * PI * r - caps + edge(a, b) + edge(a, c) + edge(b, c)).max(0.0)
        }
        _ => 0.0,
    }
}

/// Nodes in (0, 1) and weights, by Newton's method from Chebyshev's approximation to the zeros of the Legendre polynomial.
fn gauss_legendre() -> [(f64, f64); NODES] {
    let n = NODES as f64;
    std::array::from_fn(|k| {
        let mut x = (PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut below, mut value) = (1.0, x);
            for j in 2..=NODES {
                let j = j as f64;
                (below, value) = (value, ((2.0 * j - 1.0) * x * value - (j - 1.0) * below) / j);
            }
            slope = n * (x * value - below) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral over `[lo, hi]` by Simpson's rule, halved until it settles.
    fn adaptive(f: &dyn Fn(f64) -> f64, lo: f64, hi: f64, tolerance: f64) -> f64 {
        fn part(
            f: &dyn Fn(f64) -> f64,
            ends: [f64; 2],
            values: [f64; 3],
            whole: f64,
            tolerance: f64,
            depth: u32,
        ) -> f64 {
            let [lo, hi] = ends;
            let mid = 0.5 * (lo + hi);
            let (left, right) = (f(0.5 * (lo + mid)), f(0.5 * (mid + hi)));
            let first = (mid - lo) / 6.0 * (values[0] + 4.0 * left + values[1]);
            let second = (hi - mid) / 6.0 * (values[1] + 4.0 * right + values[2]);
            if depth == 0 || (first + second - whole).abs() < 15.0 * tolerance {
                return first + second + (first + second - whole) / 15.0;
            }
            part(f, [lo, mid], [values[0], left, values[1]], first, tolerance / 2.0, depth - 1)
                + part(f, [mid, hi], [values[1], right, values[2]], second, tolerance / 2.0, depth - 1)
        }
        let values = [f(lo), f(0.5 * (lo + hi)), f(hi)];
        part(f, [lo, hi], values, (hi - lo) / 6.0 * (values[0] + 4.0 * values[1] + values[2]), tolerance, 40)
    }

    /// The disk of radius r in the box, by slices.
    fn disk(r: f64, a: f64, b: f64) -> f64 {
        let height = |x: f64| (r * r - x * x).max(0.0).sqrt().min(b);
        // Slices end where the circle leaves the box at y = b, and at x = a or r.
        let knee = (r * r - b * b).max(0.0).sqrt().min(a);
        // x = r sin(u) smooths the end of the slices.
        let round = |u: f64| height(r * u.sin()) * r * u.cos();
        4.0 * (knee * b + adaptive(&round, (knee / r).asin(), (a / r).min(1.0).asin(), 1e-15))
    }

    #[test]
    fn shells_of_boxes_are_their_slices() {
        for [a, b] in [[0.5, 0.5], [0.5, 0.2], [0.5, 0.499_999], [3.0, 1.0]] {
            let diagonal = f64::hypot(a, b);
            for (lo, hi) in [(0.0, 1.0), (0.3, 0.45), (0.9, 0.91), (0.7, 0.999), (0.2, 0.8)] {
                let (lo, hi) = (lo * diagonal, hi * diagonal);
                let (found, expected) = (
                    shell_measure(lo, hi, &[2.0 * a, 2.0 * b]),
                    disk(hi, a, b) - if lo > 0.0 { disk(lo, a, b) } else { 0.0 },
                );
                assert!((found / expected - 1.0).abs() < 1e-10, "{a} {b}, {lo} to {hi}: {found} against {expected}");
            }
        }
        for [a, b, c] in [[0.5, 0.5, 0.5], [0.5, 0.4, 0.3], [1.0, 0.5, 0.499], [2.0, 0.3, 0.5]] {
            let diagonal = f64::hypot(f64::hypot(a, b), c);
            let ball = |r: f64| {
                let slice = |z: f64| {
                    let rho = (r * r - z * z).max(0.0).sqrt();
                    if rho == 0.0 { 0.0 } else { disk_closed(rho, a, b) }
                };
                let mut ends: Vec<f64> = [a, b, a.hypot(b)].iter().map(|h| (r * r - h * h).max(0.0).sqrt()).collect();
                ends.extend([0.0, c, r]);
                ends.retain(|&z| z <= c.min(r));
                ends.sort_by(f64::total_cmp);
                // z = from + (to - from)(3 u^2 - 2 u^3) tames the roots at both ends of a piece.
                let piece = |w: &[f64]| {
                    let (from, to) = (w[0], w[1]);
                    let f = |u: f64| {
                        slice(from + (to - from) * u * u * (3.0 - 2.0 * u)) * (to - from) * 6.0 * u * (1.0 - u)
                    };
                    adaptive(&f, 0.0, 1.0, 1e-15)
                };
                2.0 * ends.windows(2).map(piece).sum::<f64>()
            };
            for (lo, hi) in [(0.0, 1.0), (0.3, 0.45), (0.6, 0.7), (0.75, 0.9), (0.9, 0.95)] {
                let (lo, hi) = (lo * diagonal, hi * diagonal);
                let (found, expected) = (
                    shell_measure(lo, hi, &[2.0 * a, 2.0 * b, 2.0 * c]),
                    ball(hi) - if lo > 0.0 { ball(lo) } else { 0.0 },
                );
                assert!(
                    (found / expected - 1.0).abs() < 1e-10,
                    "{a} {b} {c}, {lo} to {hi}: {found} against {expected}"
                );
            }
        }
    }

    /// The disk in the box in closed form: sectors and triangles.
    fn disk_closed(r: f64, a: f64, b: f64) -> f64 {
        if r >= a.hypot(b) {
            return 4.0 * a * b;
        }
        let cut = |h: f64| if h < r { r * r * (h / r).acos() - h * (r * r - h * h).sqrt() } else { 0.0 };
        PI * r * r - 2.0 * cut(a) - 2.0 * cut(b)
    }

    #[test]
    fn all_shells_together_are_the_box() {
        for sides in [
            &[1.0, 1.0][..],
            &[2.0, 0.3],
            &[1.0, 1.0 - 1e-9],
            &[1e-3, 1.0],
            &[1.0; 3],
            &[7.0, 5.0, 3.0],
            &[1.0, 0.02, 0.3],
        ] {
            let diagonal = sides.iter().map(|s| s * s).sum::<f64>().sqrt() / 2.0;
            let box_measure: f64 = sides.iter().product();
            for bins in [1, 7, 256, 10_000] {
                let edge = |k: usize| diagonal * (k as f64 / bins as f64);
                let sum: f64 = (0..bins).map(|k| shell_measure(edge(k), edge(k + 1), sides)).sum();
                assert!((sum / box_measure - 1.0).abs() < 1e-12, "{sides:?}, {bins} bins: {sum}");
            }
        }
    }

    /// Close edges keep their digits: a shell is the sum of its thousandths, each of which the others do not know.
    #[test]
    fn thin_shells_keep_their_digits() {
        for sides in [&[1.0, 1.0][..], &[2.0, 0.3], &[1.0; 3], &[7.0, 5.0, 3.0]] {
            let diagonal = sides.iter().map(|s| s * s).sum::<f64>().sqrt() / 2.0;
            for at in [0.6, 0.75, 0.9, 0.98] {
                let (lo, hi) = (at * diagonal, (at + 1e-6) * diagonal);
                let thin = shell_measure(lo, hi, sides);
                let mid = 0.5 * (lo + hi);
                let mut half: Vec<f64> = sides.iter().map(|s| s / 2.0).collect();
                half.sort_by(f64::total_cmp);
                // Simpson's rule over the surface, from the plain formulas.
                let plain = |r: f64| {
                    let arc = |h: f64| if h < r { (h / r).acos() } else { 0.0 };
                    match half[..] {
                        [a, b] => 4.0 * r * (FRAC_PI_2 - arc(a) - arc(b)),
                        [a, b, c] => {
                            let w = |a: f64, b: f64| {
                                if a.hypot(b) >= r {
                                    return 0.0;
                                }
                                let (big_a, big_b) = ((r * r - a * a).sqrt(), (r * r - b * b).sqrt());
                                2.0 * r * r * (a * b / (big_a * big_b)).acos()
                                    - 2.0 * a * r * (b / big_a).acos()
                                    - 2.0 * b * r * (a / big_b).acos()
                            };
                            let caps: f64 = [a, b, c].iter().map(|h| 4.0 * PI * r * (r - h).max(0.0)).sum();
                            4.0 * PI * r * r - caps + 4.0 * (w(a, b) + w(a, c) + w(b, c))
                        }
                        _ => unreachable!(),
                    }
                };
                let expected = (hi - lo) / 6.0 * (plain(lo) + 4.0 * plain(mid) + plain(hi));
                assert!((thin / expected - 1.0).abs() < 1e-10, "{sides:?} at {at}: {thin:e} against {expected:e}");
            }
        }
    }

    #[test]
    fn below_half_a_side_nothing_is_cut_off() {
        for (lo, hi) in [(0.0, 0.5), (0.1, 0.100_000_1), (0.25, 0.5)] {
            let ring = PI * (hi - lo) * (hi + lo);
            assert!((shell_measure(lo, hi, &[1.0, 2.0]) / ring - 1.0).abs() < 1e-14);
            let shell = 4.0 / 3.0 * PI * (hi - lo) * (hi * hi + hi * lo + lo * lo);
            assert!((shell_measure(lo, hi, &[1.0, 2.0, 1.5]) / shell - 1.0).abs() < 1e-14);
        }
        assert_eq!(shell_measure(0.25, 0.5, &[1.0]), 0.5);
    }
}

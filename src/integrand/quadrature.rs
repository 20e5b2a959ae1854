//! Gauss's quadrature, and integrals over boxes to a stated error.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::pieces::SPREAD;

/// Places and weights of Gauss's rule on [-1, 1], exact for polynomials up to degree 2 n - 1: Newton's method on Legendre's P_n
/// (Press et al., Numerical Recipes, 4.6).
pub(crate) fn gauss(n: usize) -> Vec<(f64, f64)> {
    let nf = n as f64;
    let rule = (0..n).map(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (nf + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let p = legendre(n, x);
            slope = nf * (x * p[n] - p[n - 1]) / (x * x - 1.0);
            let step = p[n] / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    });
    rule.collect()
}

/// Places and weights of Lobatto's rule on [-1, 1], both ends among them, exact up to degree 2 n - 3 (Abramowitz & Stegun 25.4.32).
fn lobatto(n: usize) -> Vec<(f64, f64)> {
    let (last, nf) = (n - 1, n as f64);
    let rule = (0..n).map(|i| {
        let mut x = (std::f64::consts::PI * i as f64 / (nf - 1.0)).cos();
        // The places inside are zeros of P'_(n - 1), whose slope is known by Legendre's equation.
        for _ in 0..100 {
            if i == 0 || i == last {
                break;
            }
            let p = legendre(last, x);
            let slope = (nf - 1.0) * (x * p[last] - p[last - 1]) / (x * x - 1.0);
            let step = slope * (1.0 - x * x) / (2.0 * x * slope - (nf - 1.0) * nf * p[last]);
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        let p = legendre(last, x)[last];
        (x, 2.0 / (nf * (nf - 1.0) * p * p))
    });
    rule.collect()
}

/// Legendre's polynomials of degrees 0 to n at x.
pub(super) fn legendre(n: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for k in 1..n {
        let kf = k as f64;
        p.push(((2.0 * kf + 1.0) * x * p[k] - kf * p[k - 1]) / (kf + 1.0));
    }
    p.truncate(n + 1);
    p
}

/// The integrals of f and f^2 and a bound of the error of both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Integrals {
    pub(super) first: f64,
    pub(super) second: f64,
    pub(super) error: f64,
}

/// Where f jumps, what is left errs by about as much as the last halving changed: several times that is stated.
const SAFETY: f64 = 5.0;

/// Evaluations at most.
const BUDGET: usize = 2_000_000;

/// A box, what is known of it, and how far that is from what its parts say.
struct Part {
    corner: [f64; 3],
    side: f64,
    sums: [f64; 2],
    error: f64,
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Part {}
impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// Over the unit box: the worst of the boxes is halved along every axis until all errors together are below rounding, or the budget
/// is spent. Its error is what the rule on the halves and on the whole differ by, several times.
pub(super) fn over_box(dim: usize, mut f: impl FnMut([f64; 3]) -> f64) -> Integrals {
    let rule = gauss([24, 12, 8][dim - 1]);
    let (nodes, children) = (rule.len().pow(dim as u32), 1usize << dim);
    let mut sums = |corner: [f64; 3], side: f64| {
        let mut sums = [0.0; 2];
        for i in 0..nodes {
            let (mut x, mut weight, mut rest) = (corner, 1.0, i);
            for x in &mut x[..dim] {
                let (place, w) = rule[rest % rule.len()];
                *x += side * 0.5 * (1.0 + place);
                weight *= 0.5 * side * w;
                rest /= rule.len();
            }
            let value = f(x);
            sums[0] += weight * value;
            sums[1] += weight * value * value;
        }
        sums
    };
    let mut spent = nodes;
    let mut parts = BinaryHeap::new();
    parts.push(Part { corner: [0.0; 3], side: 1.0, sums: sums([0.0; 3], 1.0), error: f64::INFINITY });
    loop {
        let total = |of: fn(&Part) -> f64| parts.iter().map(of).sum::<f64>();
        let error = total(|p| p.error);
        let (first, second) = (total(|p| p.sums[0]), total(|p| p.sums[1]));
        let done = error < 1e-15 * (1.0 + first.abs() + second) || spent + nodes * children > BUDGET;
        // Sums over all parts are dear: many parts are halved before the next.
        let batch = if done { 0 } else { (parts.len() / 4).max(1) };
        if batch == 0 {
            return Integrals { first, second, error: SAFETY * error };
        }
        for _ in 0..batch {
            let Some(part) = parts.pop() else { break };
            let side = 0.5 * part.side;
            let halves: Vec<Part> = (0..children)
                .map(|c| {
                    let mut corner = part.corner;
                    for (k, x) in corner.iter_mut().enumerate().take(dim) {
                        *x += side * ((c >> k) & 1) as f64;
                    }
                    Part { corner, side, sums: sums(corner, side), error: 0.0 }
                })
                .collect();
            spent += nodes * children;
            let together = |k: usize| halves.iter().map(|p| p.sums[k]).sum::<f64>();
            let apart = (0..2).map(|k| (together(k) - part.sums[k]).abs()).fold(0.0, f64::max);
            // The halves are better than the whole: that is what the difference measured.
            parts.extend(halves.into_iter().map(|half| Part { error: apart / children as f64, ..half }));
            if spent + nodes * children > BUDGET {
                break;
            }
        }
    }
}

/// An integral and a bound of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Integral {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

/// Halvings of a panel at most: a jump is found to rounding.
const HALVINGS: u32 = 50;

/// Evaluations at most.
const NESTED_BUDGET: usize = 100_000_000;

/// The integral over the unit box, axis within axis, the last innermost: a jump costs some fifty halvings on a line, however long its
/// edge is, and is seen where it is near the end of a panel since rules have places there. Errors are some 1e-9 of the integral of |f| (1e-6 in
/// 3D) unless the budget is spent; what is stated is what two rules differ by.
pub(crate) fn nested(dim: usize, f: impl Fn([f64; 3]) -> f64) -> Integral {
    let rules = [lobatto(9), lobatto(6)];
    let spent = std::cell::Cell::new(0);
    // Of the mean of |f|, which is found first.
    let coarse = 64usize.pow(dim as u32 - 1).min(64) * 64;
    let spread = |i: usize| std::array::from_fn(|k| if k < dim { (i as f64 * SPREAD[k]).fract() } else { 0.0 });
    let scale = (1..=coarse).map(|i| f(spread(i)).abs()).filter(|f| f.is_finite()).sum::<f64>() / coarse as f64;
    let line = Line { dim, rules, scale, spent, jumps: std::cell::Cell::new(false), f };
    let found = line.along(0, [0.0; 3]);
    let unseen = if line.jumps.get() { [1e-12, 3e-8, 1e-6][dim - 1] * scale } else { 0.0 };
    Integral { error: found.error + unseen, ..found }
}

/// Places per axis at which a function is looked at, at least, by dimension.
const PLACES: [usize; 3] = [1 << 18, 4096, 256];

/// The integral of what jumps at the sides of so many equal cells, and seldom within: equally spaced places in each. The error is that of every
/// other one.
pub(crate) fn over_cells(dim: usize, shape: [usize; 3], f: impl Fn([f64; 3]) -> f64 + Sync) -> Integral {
    let sides: [usize; 3] =
        std::array::from_fn(|k| if k < dim { shape[k] * PLACES[dim - 1].div_ceil(shape[k]) } else { 1 });
    let slab = |i: usize| {
        let mut halves = [0.0; 2];
        for j in 0..sides[1] {
            for k in 0..sides[2] {
                let at = [i, j, k];
                let x = std::array::from_fn(|a| if a < dim { (at[a] as f64 + 0.5) / sides[a] as f64 } else { 0.0 });
                halves[(i + j + k) % 2] += f(x);
            }
        }
        halves
    };
    let slabs: Vec<[f64; 2]> = (0..sides[0]).into_par_iter().map(slab).collect();
    let [even, odd] = [0, 1].map(|half| slabs.iter().map(|slab| slab[half]).sum::<f64>());
    let count = sides.iter().product::<usize>() as f64;
    Integral { value: (even + odd) / count, error: (even - odd).abs() / count }
}

struct Line<F> {
    dim: usize,
    rules: [Vec<(f64, f64)>; 2],
    scale: f64,
    spent: std::cell::Cell<usize>,
    /// Whether there are any: what lies between two places where edges are short is not seen.
    jumps: std::cell::Cell<bool>,
    f: F,
}

impl<F: Fn([f64; 3]) -> f64> Line<F> {
    fn along(&self, axis: usize, mut x: [f64; 3]) -> Integral {
        let within = self.dim - 1 - axis;
        // Further out the rules see what is left of the errors further in.
        let tolerance = self.scale * if self.dim == 3 { 1e-9 } else { 1e-13 } * 30f64.powi(within as i32);
        let panels = [256, 48, 10][self.dim - 1];
        let mut open: Vec<(f64, f64, u32)> = (0..panels).rev().map(|i| (i as f64, 1.0, 0)).collect();
        open.iter_mut().for_each(|(from, width, _)| (*from, *width) = (*from / panels as f64, *width / panels as f64));
        let mut all = Integral { value: 0.0, error: 0.0 };
        while let Some((from, width, halvings)) = open.pop() {
            let mut inner = 0.0;
            let mut sum = |rule: &[(f64, f64)]| {
                let mut sum = 0.0;
                for (place, weight) in rule {
                    // Just inside: a density may be 0 on the very side.
                    x[axis] = (from + 0.5 * width * (1.0 + place)).clamp(2f64.powi(-60), 1.0 - f64::EPSILON / 2.0);
                    let weight = 0.5 * width * weight;
                    sum += weight
                        * if within == 0 {
                            self.spent.set(self.spent.get() + 1);
                            (self.f)(x)
                        } else {
                            let found = self.along(axis + 1, x);
                            inner += 0.5 * weight * found.error;
                            found.value
                        };
                }
                sum
            };
            let [fine, coarse] = [&self.rules[0], &self.rules[1]].map(|rule| sum(rule));
            let apart = (fine - coarse).abs();
            if apart <= tolerance || halvings == HALVINGS || self.spent.get() > NESTED_BUDGET || !fine.is_finite() {
                all.value += fine;
                all.error += apart + inner;
            } else {
                self.jumps.set(self.jumps.get() || halvings > 20);
                let half = 0.5 * width;
                open.push((from + half, half, halvings + 1));
                open.push((from, half, halvings + 1));
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for n in 1..25 {
            for power in 0..2 * n {
                let sum: f64 = gauss(n).iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                let exact = if power % 2 == 0 { 2.0 / (power as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 1e-14, "{n} {power}: {sum}");
                if n > 2 && power + 3 <= 2 * n {
                    let sum: f64 = lobatto(n).iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                    assert!((sum - exact).abs() < 1e-14, "Lobatto {n} {power}: {sum}");
                }
            }
        }
    }

    #[test]
    fn edges_are_found_along_every_line() {
        let inside = |x: [f64; 3], d: usize| x[..d].iter().map(|x| (x - 0.45) * (x - 0.45)).sum::<f64>() < 0.09;
        let weight = |x: [f64; 3]| 1.0 + x[0] - 0.45;
        for (dim, exact, tolerance) in [(1, 0.6, 1e-11), (2, 0.09 * PI, 2e-8), (3, 0.036 * PI, 1e-6)] {
            let ball = nested(dim, |x| if inside(x, dim) { weight(x) } else { 0.0 });
            let off = (ball.value - exact).abs();
            assert!(
                off < tolerance && off <= ball.error && ball.error < 10.0 * tolerance,
                "{dim}D: {ball:?}, off {off}"
            );
        }
        let smooth = nested(2, |x| (3.0 * x[0] + x[1]).sin());
        assert!((smooth.value - (3f64.sin() + 1f64.sin() - 4f64.sin()) / 3.0).abs() < 1e-12);
    }

    #[test]
    fn integrals_state_their_error() {
        let smooth = over_box(2, |x| (3.0 * x[0] + x[1]).sin());
        let exact = (3f64.sin() + 1f64.sin() - 4f64.sin()) / 3.0;
        assert!((smooth.first - exact).abs() < 1e-15 && smooth.error < 1e-14, "{smooth:?}");
        let jump = over_box(2, |x| f64::from(u8::from(x[0] + 0.4 * x[1] < 0.61)));
        let off = (jump.first - 0.41).abs();
        assert!(off <= jump.error && jump.error < 1e-2, "{off} {jump:?}");
    }
}

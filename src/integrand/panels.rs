//! The map of a density that is known by its values alone: polynomials on panels, finer along an axis where they err, and the inverse of
//! their integrals, marginal and conditional.

use rayon::prelude::*;

use super::inverse::crossing;
use super::quadrature::{gauss, legendre};
use super::stairs::pick;

/// Terms of the series, per axis.
const TERMS: usize = 8;

/// Panels per axis at first and at most, by dimension.
const FIRST: usize = 4;
const MOST: [usize; 3] = [1024, 64, 16];

/// What a slab of panels may err by, of the whole integral.
const TOLERANCE: f64 = 1e-13;

type Series = [f64; TERMS];

/// Legendre series on panels.
pub(super) struct Panels {
    dim: usize,
    /// Ends of panels, per axis; one panel on axes the box lacks.
    ends: [Vec<f64>; 3],
    /// Coefficients by panel, the last axis fastest, of each by degree along z, y and x, x fastest.
    whole: Vec<f64>,
    /// The same integrated over z: by panel of x and y, degree along y and x.
    over_z: Vec<f64>,
    /// Over y too: by panel of x, degree along x.
    over_yz: Vec<f64>,
    /// Sums of `over_yz` over panels, from 0.
    sums: Vec<f64>,
    /// Of integrals over slabs, of the whole: what the last terms of the series hold.
    pub(super) error: f64,
}

impl Panels {
    /// Of `p`, on panels that are halved until their series end in rounding, or are as many as may be.
    pub(super) fn new(dim: usize, p: impl Fn([f64; 3]) -> f64 + Sync) -> Self {
        let equal = |k: usize| {
            let panels = if k < dim { FIRST } else { 1 };
            (0..=panels).map(|i| i as f64 / panels as f64).collect::<Vec<f64>>()
        };
        let mut ends: [Vec<f64>; 3] = std::array::from_fn(equal);
        loop {
            let whole = series(dim, &ends, &p);
            let tails = tails(dim, &ends, &whole);
            let finer: [Vec<f64>; 3] = std::array::from_fn(|k| {
                let halved = |i: usize| {
                    let (lo, hi) = (ends[k][i], ends[k][i + 1]);
                    let middle = (tails[k][i] > TOLERANCE).then_some(0.5 * (lo + hi));
                    std::iter::once(lo).chain(middle.filter(|m| lo < *m && *m < hi))
                };
                (0..ends[k].len() - 1).flat_map(halved).chain([1.0]).collect()
            });
            let grows = (0..3).any(|k| finer[k].len() > ends[k].len());
            if !grows || (0..dim).any(|k| finer[k].len() > MOST[dim - 1] + 1) {
                let error = tails.iter().flatten().sum();
                return Self::of(dim, ends, whole, error);
            }
            ends = finer;
        }
    }

    fn of(dim: usize, ends: [Vec<f64>; 3], whole: Vec<f64>, error: f64) -> Self {
        let width = |k: usize, i: usize| ends[k][i + 1] - ends[k][i];
        let [n0, n1, n2] = [0, 1, 2].map(|k| ends[k].len() - 1);
        let [_, t1, t2] = terms(dim);
        // A series integrated over a panel is its first term, times the width.
        let (block, row) = (TERMS * t1 * t2, TERMS * t1);
        let mut over_z = vec![0.0; n0 * n1 * row];
        for (ij, out) in over_z.chunks_exact_mut(row).enumerate() {
            for m in 0..n2 {
                let from = &whole[(ij * n2 + m) * block..][..row];
                out.iter_mut().zip(from).for_each(|(out, c)| *out += width(2, m) * c);
            }
        }
        let mut over_yz = vec![0.0; n0 * TERMS];
        for (i, out) in over_yz.chunks_exact_mut(TERMS).enumerate() {
            for j in 0..n1 {
                let from = &over_z[(i * n1 + j) * row..][..TERMS];
                out.iter_mut().zip(from).for_each(|(out, c)| *out += width(1, j) * c);
            }
        }
        let mut sums = vec![0.0];
        for i in 0..n0 {
            sums.push(sums[i] + (width(0, i) * over_yz[i * TERMS]).max(0.0));
        }
        Self { dim, ends, whole, over_z, over_yz, sums, error }
    }

    pub(super) fn place(&self, u: [f64; 3]) -> [f64; 3] {
        let (i, part) = pick(&self.sums, u[0]);
        let (x, s) = self.within(0, i, part, |k| self.over_yz[i * TERMS + k]);
        if self.dim == 1 {
            return [x, 0.0, 0.0];
        }
        let [n1, n2] = [1, 2].map(|k| self.ends[k].len() - 1);
        let [_, t1, t2] = terms(self.dim);
        let at_x = values(s);
        let row = &self.over_z[i * n1 * TERMS * t1..];
        let along_y = |j: usize, l: usize| dot(&at_x, &row[(j * t1 + l) * TERMS..]);
        let (j, part) = pick(&self.rising(1, |j| along_y(j, 0)), u[1]);
        let (y, t) = self.within(1, j, part, |l| along_y(j, l));
        if self.dim == 2 {
            return [x, y, 0.0];
        }
        let at_y = values(t);
        let block = TERMS * t1 * t2;
        let column = &self.whole[(i * n1 + j) * n2 * block..];
        let along_z = |m: usize, n: usize| -> f64 {
            let from = &column[m * block + n * TERMS * t1..];
            (0..TERMS).map(|l| at_y[l] * dot(&at_x, &from[l * TERMS..])).sum()
        };
        let (m, part) = pick(&self.rising(2, |m| along_z(m, 0)), u[2]);
        let (z, _) = self.within(2, m, part, |n| along_z(m, n));
        [x, y, z]
    }

    /// Sums of integrals over the panels of an axis, from 0.
    fn rising(&self, axis: usize, mean: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut sum = 0.0;
        let each = self.ends[axis].windows(2).enumerate().map(|(i, ends)| {
            // Where it is 0, rounding may be below.
            sum += ((ends[1] - ends[0]) * mean(i)).max(0.0);
            sum
        });
        std::iter::once(0.0).chain(each).collect()
    }

    /// The place in panel `i` of an axis where its series reaches the part `part` of its integral; and the same in [-1, 1].
    fn within(&self, axis: usize, i: usize, part: f64, coefficient: impl Fn(usize) -> f64) -> (f64, f64) {
        let c: Series = std::array::from_fn(coefficient);
        let at = |s: f64| {
            let p: [f64; TERMS + 1] = polynomials(s);
            let first = c[0] * (s + 1.0);
            let sum = (1..TERMS).fold(first, |sum, k| sum + c[k] * (p[k + 1] - p[k - 1]) / (2.0 * k as f64 + 1.0));
            (sum, (0..TERMS).map(|k| c[k] * p[k]).sum())
        };
        let s = crossing(-1.0, 1.0, 2.0 * c[0] * part, 2.0 * part - 1.0, at);
        let (lo, hi) = (self.ends[axis][i], self.ends[axis][i + 1]);
        ((lo + 0.5 * (1.0 + s) * (hi - lo)).min(1f64.next_down()), s)
    }
}

/// Terms along each axis: one on those the box lacks.
fn terms(dim: usize) -> [usize; 3] {
    std::array::from_fn(|k| if k < dim { TERMS } else { 1 })
}

fn polynomials<const N: usize>(x: f64) -> [f64; N] {
    let mut p = [1.0; N];
    p[1] = x;
    for k in 2..N {
        let kf = k as f64;
        p[k] = ((2.0 * kf - 1.0) * x * p[k - 1] - (kf - 1.0) * p[k - 2]) / kf;
    }
    p
}

fn values(s: f64) -> Series {
    polynomials(s)
}

fn dot(a: &Series, b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The coefficients of all panels, from values at the places of Gauss's rule.
fn series(dim: usize, ends: &[Vec<f64>; 3], p: &(impl Fn([f64; 3]) -> f64 + Sync)) -> Vec<f64> {
    let rule = gauss(TERMS);
    let matrix: Vec<Series> = (0..TERMS)
        .map(|l| std::array::from_fn(|g| (l as f64 + 0.5) * rule[g].1 * legendre(TERMS, rule[g].0)[l]))
        .collect();
    let counts = [0, 1, 2].map(|k| ends[k].len() - 1);
    let total: usize = counts.iter().product();
    let nodes = TERMS.pow(dim as u32);
    let of_panel = |panel: usize| {
        let panel = [panel / (counts[1] * counts[2]), panel / counts[2] % counts[1], panel % counts[2]];
        let at = |g: usize| {
            p(std::array::from_fn(|k| {
                let (lo, hi) = (ends[k][panel[k]], ends[k][panel[k] + 1]);
                if k < dim { lo + 0.5 * (1.0 + rule[g / TERMS.pow(k as u32) % TERMS].0) * (hi - lo) } else { 0.0 }
            }))
        };
        let mut values: Vec<f64> = (0..nodes).map(at).collect();
        for k in 0..dim {
            let step = TERMS.pow(k as u32);
            let along = |g: usize| {
                let degree = g / step % TERMS;
                (0..TERMS).map(|i| matrix[degree][i] * values[g - degree * step + i * step]).sum()
            };
            values = (0..nodes).map(along).collect();
        }
        values
    };
    (0..total).into_par_iter().flat_map_iter(of_panel).collect()
}

/// Of every slab of panels the largest of the last two terms along its axis, times its width, of the whole integral.
fn tails(dim: usize, ends: &[Vec<f64>; 3], whole: &[f64]) -> [Vec<f64>; 3] {
    let counts = [0, 1, 2].map(|k| ends[k].len() - 1);
    let width = |k: usize, i: usize| ends[k][i + 1] - ends[k][i];
    let nodes = TERMS.pow(dim as u32);
    let place = |panel: usize| [panel / (counts[1] * counts[2]), panel / counts[2] % counts[1], panel % counts[2]];
    let mut tails: [Vec<f64>; 3] = counts.map(|n| vec![0.0; n]);
    let mut integral = 0.0;
    for (panel, series) in whole.chunks_exact(nodes).enumerate() {
        let at = place(panel);
        integral += series[0] * (0..3).map(|k| width(k, at[k])).product::<f64>();
        for k in 0..dim {
            let step = TERMS.pow(k as u32);
            let last = series.iter().enumerate().filter(|(g, _)| g / step % TERMS >= TERMS - 2);
            let most = last.map(|(_, c)| c.abs()).fold(0.0, f64::max);
            tails[k][at[k]] = tails[k][at[k]].max(most);
        }
    }
    for (k, slabs) in tails.iter_mut().enumerate() {
        slabs.iter_mut().enumerate().for_each(|(i, tail)| *tail *= width(k, i) / integral);
    }
    tails
}

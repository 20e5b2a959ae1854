//! Discrepancies: all pairs once, in rows of vectors.
//!
//! Each is the square of a norm, `1/n^2 sum_ij K(x_i, x_j) - 2/n sum_i h(x_i) + c` with `h(x) = int K(x, y) dy` and
//! `c = int h`. The sums are of `K(x_i, x_j) - h(x_i) - h(x_j) + c`, whose mean over y is 0: so small a discrepancy of many
//! points is no difference of large numbers.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::{Cpu, SimdLevel, simd};
use crate::accumulate::{DISCREPANCIES, DiscrepancySums, LevelCounts, RealizationDiscrepancy, Sums};
use crate::compute::compensated::Compensated;
use crate::compute::neighbors::covering_radius;
use crate::control::Control;
use crate::error::Result;
use crate::plan::DiscrepancyPlan;
use crate::points::{Ensemble, closest_packing_distance};

/// How many there are.
pub(super) const KINDS: usize = DISCREPANCIES.len();

/// Rows between two looks at the control.
const ROWS: usize = 32;

/// Interval counts spent on a level of elementary intervals beyond those that decide t.
const LEVEL_BUDGET: u64 = 1 << 28;

/// Points in the unit cube of any dimension.
pub(crate) struct Cube {
    /// Coordinates per axis, from 0 to 1.
    pub(crate) axes: Vec<Vec<f64>>,
    /// Sides of the domain, in which distances are measured.
    pub(crate) sides: Vec<f64>,
    /// Whether distances wrap.
    pub(crate) is_torus: bool,
}

impl Cube {
    /// Of realization `k`.
    fn of(ensemble: &Ensemble, k: usize) -> Self {
        let domain = ensemble.domain();
        Self {
            axes: (0..domain.dim()).map(|a| ensemble.turns(k, a).collect()).collect(),
            sides: domain.sides().to_vec(),
            is_torus: domain.is_torus(),
        }
    }
}

/// Discrepancies of every realization.
pub(super) fn discrepancies(
    cpu: &Cpu,
    plan: &DiscrepancyPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<DiscrepancySums> {
    let part = 1.0 / ensemble.realizations() as f64;
    let of = |k: usize| {
        let (mut one, levels) = measure(cpu, &Cube::of(ensemble, k), part, control)?;
        one.index = ensemble.first_index() + k as u64;
        one.covering = Some(covering_radius(&plan.domain, &ensemble.lengths(k), control)?);
        let mut sums = DiscrepancySums::default();
        sums.add(one, levels)?;
        Ok(sums)
    };
    cpu.pool.install(|| {
        (0..ensemble.realizations()).into_par_iter().map(of).try_reduce(DiscrepancySums::default, |mut a, b| {
            a.merge(b)?;
            Ok(a)
        })
    })
}

/// Of one set of points, all but its index and the covering radius. `part`: of the piece of work at hand.
pub(crate) fn measure(
    cpu: &Cpu,
    cube: &Cube,
    part: f64,
    control: &Control,
) -> Result<(RealizationDiscrepancy, Vec<LevelCounts>)> {
    let n = cube.axes[0].len();
    let (squares, minimum) = pairs(cpu.level, cube, part, control)?;
    let (levels, strength) = levels(&cube.axes, control)?;
    let one = RealizationDiscrepancy {
        index: 0,
        n: n as u64,
        squares,
        minimum: (n >= 2).then_some(minimum),
        closest_packing: closest_packing_distance(cube.axes.len(), n as f64 / cube.sides.iter().product::<f64>()),
        covering: None,
        strength,
    };
    Ok((one, levels))
}

/// What the kernels need of a point, per axis.
pub(super) struct Axis<'a> {
    x: &'a [f64],
    /// `|x - 1/2|`.
    middle: Vec<f64>,
    /// The side, and whether it wraps.
    side: f64,
    is_torus: bool,
}

/// The squares, and the least distance.
fn pairs(level: SimdLevel, cube: &Cube, part: f64, control: &Control) -> Result<([f64; KINDS], f64)> {
    let (n, d) = (cube.axes[0].len(), cube.axes.len());
    let axis = |(x, &side): (&'_ Vec<f64>, &f64)| (x.iter().map(|x| (x - 0.5).abs()).collect::<Vec<_>>(), side);
    let middles: Vec<_> = cube.axes.iter().zip(&cube.sides).map(axis).collect();
    let axes: Vec<Axis<'_>> = (cube.axes.iter().zip(middles))
        .map(|(x, (middle, side))| Axis { x, middle, side, is_torus: cube.is_torus })
        .collect();
    let constants = [1.0 / 3.0, 13.0 / 12.0, 4.0 / 3.0, 19.0 / 12.0, 1.0f64].map(|c| c.powi(d as i32));
    // h of every point; of what wraps it is the constant.
    let means: [Vec<f64>; 3] = [0, 1, 3].map(|kind| {
        let factor = |axis: &Axis<'_>, i: usize| {
            let (x, z) = (axis.x[i], axis.middle[i]);
            match kind {
                0 => 0.5 * (1.0 - x * x),
                1 => 1.0 + 0.5 * z - 0.5 * z * z,
                _ => 5.0 / 3.0 - 0.25 * z - 0.25 * z * z,
            }
        };
        (0..n).map(|i| axes.iter().map(|axis| factor(axis, i)).product()).collect()
    });
    let rows = |first: usize| {
        control.check()?;
        let end = (first + ROWS).min(n);
        let mut row = Row { sums: [0.0; KINDS], least: f64::INFINITY };
        for i in first..end {
            simd::discrepancy_row(level, &axes, &means, &constants, i, &mut row);
        }
        control.advance(part * (end - first) as f64 / n as f64);
        Ok(row)
    };
    let rows = (0..n).into_par_iter().step_by(ROWS).map(rows).collect::<Result<Vec<_>>>()?;
    let sum = |kind: usize| rows.iter().map(|row| row.sums[kind]).collect::<Compensated>().sum();
    let all = (n as f64).powi(2);
    let mut squares: [f64; KINDS] = std::array::from_fn(|kind| sum(kind) / all);
    squares[KINDS - 1] /= (1.0 + PI * PI / 3.0).powi(d as i32) - 1.0;
    let least = rows.iter().map(|row| row.least).fold(f64::INFINITY, f64::min);
    Ok((squares.map(|square| square.max(0.0)), least.sqrt()))
}

/// What rows of pairs add up to.
pub(super) struct Row {
    sums: [f64; KINDS],
    /// The least squared distance.
    least: f64,
}

/// Points per vector loop.
const LANES: usize = 32;

/// The loop over pairs, compiled for every instruction set.
pub(super) mod pair_sums {
    use super::*;

    /// Point i with itself, and twice with all that follow. `FUSED`: whether multiply-adds may be, which they are not, so that all levels
    /// give one result.
    #[inline(always)]
    pub(in crate::compute::cpu) fn add_row<const FUSED: bool>(
        axes: &[Axis<'_>],
        means: &[Vec<f64>; 3],
        constants: &[f64; KINDS],
        i: usize,
        row: &mut Row,
    ) {
        let n = means[0].len();
        let (mut own, mut others) = ([0.0; KINDS], [[0.0; LANES]; KINDS]);
        let mut least = [f64::INFINITY; LANES];
        let mut from = i;
        while from < n {
            let lanes = (n - from).min(LANES);
            let mut products = [[1.0; LANES]; KINDS];
            let mut squares = [0.0; LANES];
            for axis in axes {
                let (x, z) = (axis.x[i], axis.middle[i]);
                let (xs, zs) = (&axis.x[from..from + lanes], &axis.middle[from..from + lanes]);
                for (l, (&y, &w)) in xs.iter().zip(zs).enumerate() {
                    let apart = (x - y).abs();
                    let wrapped = apart * (1.0 - apart);
                    products[0][l] *= 1.0 - x.max(y);
                    products[1][l] *= 1.0 + 0.5 * (z + w - apart);
                    products[2][l] *= 1.5 - wrapped;
                    products[3][l] *= 1.875 - 0.25 * (z + w) - (0.75 - 0.5 * apart) * apart;
                    products[4][l] *= 1.0 + 2.0 * PI * PI * (1.0 / 6.0 - wrapped);
                    let distance = axis.side * if axis.is_torus { apart.min(1.0 - apart) } else { apart };
                    squares[l] += distance * distance;
                }
            }
            for (kind, mean) in [0, 1, 3].into_iter().zip(means) {
                let shift = constants[kind] - mean[i];
                for (l, h) in mean[from..from + lanes].iter().enumerate() {
                    products[kind][l] += shift - h;
                }
            }
            for kind in [2, 4] {
                products[kind].iter_mut().for_each(|p| *p -= constants[kind]);
            }
            // The first of all is the point itself.
            let begin = usize::from(from == i);
            if begin == 1 {
                own = std::array::from_fn(|kind| products[kind][0]);
            }
            for (sums, products) in others.iter_mut().zip(&products) {
                for l in begin..lanes {
                    sums[l] += products[l];
                }
            }
            for l in begin..lanes {
                least[l] = least[l].min(squares[l]);
            }
            from += lanes;
        }
        for (sum, (own, others)) in row.sums.iter_mut().zip(own.iter().zip(&others)) {
            *sum += own + 2.0 * others.iter().sum::<f64>();
        }
        row.least = least.iter().fold(row.least, |a, b| a.min(*b));
    }
}

/// The levels of elementary intervals, and the strength.
fn levels(axes: &[Vec<f64>], control: &Control) -> Result<(Vec<LevelCounts>, Option<u32>)> {
    let n = axes[0].len();
    if !n.is_power_of_two() {
        return Ok((Vec::new(), None));
    }
    let m = n.trailing_zeros();
    // The first m binary digits; the upper side of a window belongs to the last interval.
    let digits = |x: &f64| ((x * n as f64) as u64).min(n as u64 - 1);
    let axes: Vec<Vec<u64>> = axes.iter().map(|axis| axis.iter().map(digits).collect()).collect();
    let (mut counts, mut strength) = (vec![0u32; n], 0);
    let mut levels = Vec::new();
    for k in 0..=m {
        let whole = kinds(k, axes.len()).saturating_mul(n as u64) <= LEVEL_BUDGET;
        // A level whose intervals are not equal cannot be followed by one whose are.
        let unbroken = strength + 1 == k || k == 0;
        if !whole && !unbroken {
            break;
        }
        let mut level = LevelCounts::default();
        let mut shape = vec![0; axes.len()];
        shape[0] = k;
        loop {
            control.check()?;
            level.shapes += 1;
            level.equidistributed += u64::from(is_equal(&axes, m, k, &shape, &mut counts));
            if !whole && level.equidistributed < level.shapes || !next(&mut shape) {
                break;
            }
        }
        if unbroken && level.equidistributed == level.shapes {
            strength = k;
        }
        if whole {
            levels.push(level);
        }
    }
    Ok((levels, Some(strength)))
}

/// Whether all elementary intervals of `shape`, of volume `2^-k`, hold as many points.
fn is_equal(axes: &[Vec<u64>], m: u32, k: u32, shape: &[u32], counts: &mut [u32]) -> bool {
    let counts = &mut counts[..1 << k];
    counts.fill(0);
    for i in 0..axes[0].len() {
        let interval = axes.iter().zip(shape).fold(0, |at, (axis, &digits)| at << digits | axis[i] >> (m - digits));
        counts[interval as usize] += 1;
    }
    counts.iter().all(|&c| c == 1 << (m - k))
}

/// The number of ways to write k as a sum of so many numbers, `(k + parts - 1 over k)`.
fn kinds(k: u32, parts: usize) -> u64 {
    let ways = (1..parts as u128).try_fold(1u128, |ways, j| Some(ways.checked_mul(u128::from(k) + j)? / j));
    ways.and_then(|ways| u64::try_from(ways).ok()).unwrap_or(u64::MAX)
}

/// The next way, the first being `k 0 0 ...`; whether there is one.
fn next(shape: &mut [u32]) -> bool {
    let last = shape.len() - 1;
    let Some(from) = (0..last).rev().find(|&j| shape[j] > 0) else { return false };
    let rest = std::mem::take(&mut shape[last]);
    shape[from] -= 1;
    shape[from + 1] = rest + 1;
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_comes_once() {
        for (k, parts) in [(0, 1), (5, 1), (5, 2), (4, 3), (3, 6)] {
            let mut shape = vec![0; parts];
            shape[0] = k;
            let mut seen = std::collections::HashSet::from([shape.clone()]);
            while next(&mut shape) {
                assert_eq!(shape.iter().sum::<u32>(), k);
                assert!(seen.insert(shape.clone()), "{shape:?} twice");
            }
            assert_eq!(seen.len() as u64, kinds(k, parts));
        }
    }
}

//! Discrepancies as their papers write them, x in the unit cube, sums over i and j from 1 to n, products over axes:
//!
//! ```text
//! star L2      D^2 = 3^-d - 2^(1-d)/n sum_i prod (1 - x_i^2) + 1/n^2 sum_ij prod (1 - max(x_i, x_j))
//!              (Warnock, "Computational investigations of low-discrepancy point sets", 1972)
//! centred      (13/12)^d - 2/n sum_i prod (1 + |z_i|/2 - z_i^2/2) + 1/n^2 sum_ij prod (1 + |z_i|/2 + |z_j|/2 - |x_i - x_j|/2),
//!              z = x - 1/2 (Hickernell, "A generalized discrepancy and quadrature error bound", Math. Comp. 67, 1998)
//! wrap-around  -(4/3)^d + 1/n^2 sum_ij prod (3/2 - u + u^2), u = |x_i - x_j|
//!              (Hickernell, "Lattice rules: how well do they measure up?", 1998)
//! mixture      (19/12)^d - 2/n sum_i prod (5/3 - |z_i|/4 - z_i^2/4)
//!              + 1/n^2 sum_ij prod (15/8 - |z_i|/4 - |z_j|/4 - 3/4 u + u^2/2)
//!              (Zhou, Fang, Ning, "Mixture discrepancy for quasi-random point sets", J. Complexity 29, 2013)
//! diaphony     sum_ij (prod (1 + 2 pi^2 B_2(u)) - 1) / (n^2 ((1 + pi^2/3)^d - 1)), B_2(u) = u^2 - u + 1/6
//!              (Zinterhof 1976; so that independent points expect 1/n)
//! ```
//!
//! A set of `2^m` points is a (t, m, d)-net in base 2 if every elementary interval `prod [a_j 2^-k_j, (a_j + 1) 2^-k_j)` of
//! volume `2^(t-m)` holds `2^t` of them (Niederreiter 1987).

use std::collections::HashMap;
use std::f64::consts::PI;

use crate::accumulate::{DISCREPANCIES, DiscrepancySums, LevelCounts, RealizationDiscrepancy};
use crate::compute::compensated::total;
use crate::compute::neighbors::covering_radius;
use crate::control::Control;
use crate::error::Result;
use crate::plan::DiscrepancyPlan;
use crate::points::Ensemble;
use crate::points::geometry::squared_distance;

/// Of every realization. Coordinates are taken as they were given; the covering radius is that of the CPU path, whose test
/// tries every circumcentre.
pub(super) fn discrepancies(plan: &DiscrepancyPlan, ensemble: &Ensemble, control: &Control) -> Result<DiscrepancySums> {
    let mut sums = DiscrepancySums::default();
    let domain = &plan.domain;
    for k in 0..ensemble.realizations() {
        let axes = cube(ensemble, k);
        let levels = levels(&axes, control)?;
        let (lengths, n) = (ensemble.lengths(k), axes[0].len());
        let all = |i: usize| (0..i).map(move |j| (i, j));
        let least = (0..n).flat_map(all).map(|(i, j)| squared_distance(&lengths, domain.periods(), i, j)).min();
        let unbroken = levels.iter().take_while(|level| level.equidistributed == level.shapes).count();
        let one = RealizationDiscrepancy {
            index: ensemble.first_index() + k as u64,
            n: n as u64,
            squares: squares(&axes, control)?,
            minimum: least.map(|square| (square as f64).sqrt() * domain.length_unit() / 2f64.powi(64)),
            closest_packing: domain.closest_packing_distance(n as f64),
            covering: Some(covering_radius(domain, &lengths, control)?),
            strength: (unbroken as u32).checked_sub(1),
        };
        sums.add(one, levels)?;
    }
    Ok(sums)
}

/// Coordinates in the unit cube, per axis.
fn cube(ensemble: &Ensemble, k: usize) -> Vec<Vec<f64>> {
    let domain = ensemble.domain();
    let Some(given) = ensemble.coordinates(k) else {
        return (0..domain.dim()).map(|a| ensemble.turns(k, a).collect()).collect();
    };
    let scaled = |(a, axis): (usize, &&[f64])| {
        let turns = axis.iter().map(|x| (x - domain.origin()[a]) / domain.sides()[a]);
        // Points that were folded into a torus are still where they were given.
        turns.map(|x| if domain.is_torus() { x.rem_euclid(1.0) } else { x }).collect()
    };
    given.iter().enumerate().map(scaled).collect()
}

/// The squares of all discrepancies of points whose coordinates in the unit cube are `axes`.
pub(super) fn squares(axes: &[Vec<f64>], control: &Control) -> Result<[f64; DISCREPANCIES.len()]> {
    let (n, d) = (axes[0].len(), axes.len() as i32);
    let product = |factor: &dyn Fn(&[f64]) -> f64| axes.iter().map(|axis| factor(axis)).product::<f64>();
    let middle = |x: f64| (x - 0.5).abs();
    let one = |factor: &dyn Fn(f64) -> f64| total((0..n).map(|i| product(&|axis| factor(axis[i])))) / n as f64;
    let two = |factor: &dyn Fn(f64, f64) -> f64| {
        let row = |i: usize| {
            control.check()?;
            Ok(total((0..n).map(|j| product(&|axis| factor(axis[i], axis[j])))))
        };
        let rows = (0..n).map(row).collect::<Result<Vec<_>>>()?;
        Ok(total(rows.into_iter()) / (n * n) as f64)
    };
    let power = |x: f64| x.powi(d);
    let apart = |x: f64, y: f64| (x - y).abs();
    let star = power(1.0 / 3.0) - power(0.5) * 2.0 * one(&|x| 1.0 - x * x) + two(&|x, y| 1.0 - x.max(y))?;
    let centered = power(13.0 / 12.0) - 2.0 * one(&|x| 1.0 + 0.5 * middle(x) - 0.5 * middle(x).powi(2))
        + two(&|x, y| 1.0 + 0.5 * middle(x) + 0.5 * middle(y) - 0.5 * apart(x, y))?;
    let wrap_around = two(&|x, y| 1.5 - apart(x, y) + apart(x, y).powi(2))? - power(4.0 / 3.0);
    let mixture = power(19.0 / 12.0) - 2.0 * one(&|x| 5.0 / 3.0 - 0.25 * middle(x) - 0.25 * middle(x).powi(2))
        + two(&|x, y| 15.0 / 8.0 - 0.25 * (middle(x) + middle(y)) - 0.75 * apart(x, y) + 0.5 * apart(x, y).powi(2))?;
    let bernoulli = |u: f64| u * u - u + 1.0 / 6.0;
    let diaphony =
        (two(&|x, y| 1.0 + 2.0 * PI * PI * bernoulli(apart(x, y)))? - 1.0) / (power(1.0 + PI * PI / 3.0) - 1.0);
    Ok([star, centered, wrap_around, mixture, diaphony].map(|square| square.max(0.0)))
}

/// Per level k from 0 to m the kinds of elementary intervals of volume 2^-k, and those with as many points in each; nothing
/// where n is no power of 2.
pub(super) fn levels(axes: &[Vec<f64>], control: &Control) -> Result<Vec<LevelCounts>> {
    let n = axes[0].len();
    if !n.is_power_of_two() {
        return Ok(Vec::new());
    }
    let mut levels = Vec::new();
    for k in 0..=n.trailing_zeros() {
        let mut level = LevelCounts::default();
        for digits in compositions(k, axes.len()) {
            control.check()?;
            let mut held: HashMap<Vec<u64>, usize> = HashMap::new();
            for i in 0..n {
                let interval = |(axis, &digits): (&Vec<f64>, &u32)| (axis[i] * 2f64.powi(digits as i32)).floor() as u64;
                *held.entry(axes.iter().zip(&digits).map(interval).collect()).or_default() += 1;
            }
            level.shapes += 1;
            level.equidistributed += u64::from(held.len() == 1 << k && held.values().all(|&c| c == n >> k));
        }
        levels.push(level);
    }
    Ok(levels)
}

/// All ways to write k as a sum of so many numbers.
fn compositions(k: u32, parts: usize) -> Vec<Vec<u32>> {
    if parts == 1 {
        return vec![vec![k]];
    }
    let rest =
        |first: u32| compositions(k - first, parts - 1).into_iter().map(move |rest| [vec![first], rest].concat());
    (0..=k).flat_map(rest).collect()
}

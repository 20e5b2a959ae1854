//! Kernel sums: only pairs in reach, only the r that they reach, and each pair once. Formula: see `reference`.
//!
//! Points are sorted along the longest axis, so that the partners of a point are those that follow it up to the range.
//! A realization is cut into blocks of rows that depend on its size alone; block results are added in order.

use rayon::prelude::*;

use super::Cpu;
use super::pair_weights::{PairWeights, PointData};
use super::polygon_weights::PolygonWeights;
use crate::accumulate::{KernelCurve, KernelSums, PairHistogram};
use crate::compute::Compute;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Divisor, KernelPlan, SmoothingKernel, sphere_surface};
use crate::points::Ensemble;
use crate::points::geometry::minimum_image;

/// At most so many blocks per realization, of at least so many rows.
const BLOCKS: usize = 1024;
const ROWS: usize = 32;

/// Bytes of block results held at a time.
const HELD: usize = 64 << 20;

pub(super) fn kernel_sums(cpu: &Cpu, plan: &KernelPlan, ensemble: &Ensemble, control: &Control) -> Result<KernelSums> {
    let spread = Spread::new(plan);
    let mut sums = KernelSums::new(cpu.computed_by(), plan.r.len());
    // Block results come in order; the realization at hand is handed on when the next begins.
    let mut current: Option<(usize, KernelCurve)> = None;
    let mut hand_on = |current: &mut Option<(usize, KernelCurve)>, next: Option<(usize, KernelCurve)>| {
        if let Some((k, curve)) = std::mem::replace(current, next) {
            sums.add(ensemble.first_index() + k as u64, &curve);
        }
    };
    let group = (HELD / (24 * plan.r.len().max(1))).clamp(16, 4096);
    let blocks = |k: usize| ensemble.points_in(k).div_ceil(rows_per_block(ensemble.points_in(k))).max(1);
    let all: usize = (0..ensemble.realizations()).map(blocks).sum();
    let mut first = 0;
    while first < ensemble.realizations() {
        let mut tasks = Vec::new();
        let mut end = first;
        while end < ensemble.realizations() && (tasks.is_empty() || tasks.len() < group) {
            tasks.extend((0..blocks(end)).map(|block| (end, block)));
            end += 1;
        }
        let sets: Vec<Set> =
            cpu.pool.install(|| (first..end).into_par_iter().map(|k| Set::new(plan, ensemble, k)).collect());
        for tasks in tasks.chunks(group) {
            let work = |&(k, block): &(usize, usize)| {
                control.check()?;
                let block = spread.block(plan, &sets[k - first], block);
                control.advance(1.0 / all as f64);
                Ok((k, block))
            };
            let parts: Vec<_> = cpu.pool.install(|| tasks.par_iter().map(work).collect::<Result<_>>())?;
            for (k, part) in parts {
                match &mut current {
                    Some((at, curve)) if *at == k => curve.merge(&part),
                    _ => hand_on(&mut current, Some((k, part))),
                }
            }
        }
        first = end;
    }
    hand_on(&mut current, None);
    sums.close_leaf();
    Ok(sums)
}

fn rows_per_block(n: usize) -> usize {
    n.div_ceil(BLOCKS).max(ROWS)
}

/// One realization, sorted along one axis.
struct Set {
    n: usize,
    axes: Vec<Vec<u64>>,
    /// Weights of the points, where there are any.
    masses: Option<Vec<f64>>,
    sorted: usize,
}

impl Set {
    fn new(plan: &KernelPlan, ensemble: &Ensemble, k: usize) -> Self {
        let axes = ensemble.lengths(k);
        let sides = plan.pairs.domain.sides();
        let sorted = (0..sides.len()).rev().max_by(|&a, &b| sides[a].total_cmp(&sides[b])).unwrap_or(0);
        let mut order: Vec<usize> = (0..ensemble.points_in(k)).collect();
        order.sort_unstable_by_key(|&j| (axes[sorted][j], j));
        let axes = axes.iter().map(|axis| order.iter().map(|&j| axis[j]).collect()).collect();
        let masses = ensemble.weights(k).map(|m| order.iter().map(|&j| m[j]).collect());
        Self { n: order.len(), axes, masses, sorted }
    }
}

/// What a pair adds, and where.
struct Spread<'a> {
    shape: SmoothingKernel,
    reach: f64,
    /// Of `exp(rate x^2)`, for a Gaussian.
    rate: f64,
    /// The kernel's peak, for both orders of a pair.
    peak: f64,
    /// First r and steps per unit length, where r is evenly spaced.
    even: Option<(f64, f64)>,
    /// Length of a fixed-point step.
    step: f64,
    /// Weights in a polygon.
    polygon: Option<PolygonWeights<'a>>,
}

impl<'a> Spread<'a> {
    fn new(plan: &'a KernelPlan) -> Self {
        let (kernel, r) = (plan.kernel, plan.r.as_slice());
        let even = match r {
            [first, .., last] => {
                let step = (last - first) / (r.len() - 1) as f64;
                let off = |(k, x): (usize, &f64)| (x - (first + step * k as f64)).abs();
                // One index of slack on either side covers far more than this.
                r.iter().enumerate().map(off).all(|off| off <= 1e-3 * step).then_some((*first, 1.0 / step))
            }
            _ => None,
        };
        Self {
            shape: kernel.shape,
            reach: kernel.reach(),
            rate: -0.5 / (kernel.bandwidth * kernel.bandwidth),
            peak: 2.0 * kernel.peak(),
            even,
            step: 2f64.powi(-64) * plan.pairs.domain.length_unit(),
            polygon: PolygonWeights::new(&plan.pairs),
        }
    }

    /// The pairs of one block of rows with the points that follow.
    fn block(&self, plan: &KernelPlan, set: &Set, block: usize) -> KernelCurve {
        let axes: Vec<&[u64]> = set.axes.iter().map(Vec::as_slice).collect();
        let data = PointData::of_masses(&plan.pairs, &axes, set.masses.as_deref());
        let weights = plan.pairs.weighted().then(|| PairWeights::new(&plan.pairs, &axes, &data, self.polygon.as_ref()));
        // The mean over both orders.
        let weight = |i, j| weights.as_ref().map_or(1.0, |w| w.both(i, j) as f64 * (0.5 / plan.pairs.weight_steps()));
        let mut curve = KernelCurve::new(PairHistogram::unit_norms(set.n as u64, data.mass_sums()), plan.r.len());
        let rows = rows_per_block(set.n);
        let along = axes[set.sorted];
        let periods = plan.pairs.domain.periods();
        let beyond = plan.pairs.thresholds[plan.pairs.bins.len()];
        // Differences from here on put a pair out of reach. The range is at most half of the longest side, so that on a
        // torus no pair is met from both of its points.
        let limit = (beyond - 1).isqrt() as u64 + 1;
        let squared_distance = |i: usize, j: usize| {
            let mut sum = 0u128;
            for (axis, period) in axes.iter().zip(periods) {
                let d = minimum_image(axis[i], axis[j], period);
                if d >= limit {
                    return None;
                }
                sum += u128::from(d) * u128::from(d);
            }
            (sum < beyond).then_some(sum)
        };
        for i in block * rows..((block + 1) * rows).min(set.n) {
            let after = (i + 1..set.n).take_while(|&j| along[j] - along[i] < limit);
            // On around the torus: the longest axis wraps at 2^64.
            let wraps = plan.pairs.domain.is_torus();
            let around =
                (0..i).take_while(|&j| wraps && along[j] < along[i] && along[j].wrapping_sub(along[i]) < limit);
            for j in after.chain(around) {
                if let Some(r2) = squared_distance(i, j) {
                    self.pair(plan, (r2 as f64).sqrt() * self.step, weight(i, j), &mut curve);
                }
            }
        }
        curve
    }

    /// Adds a pair, in both orders.
    #[inline(always)]
    fn pair(&self, plan: &KernelPlan, d: f64, weight: f64, curve: &mut KernelCurve) {
        let mut height = self.peak * weight;
        if plan.divisor == Divisor::D {
            let surface = sphere_surface(d, plan.pairs.domain.dim());
            if surface == 0.0 {
                curve.coincident += 2;
                return;
            }
            height /= surface;
        }
        let within = self.within(&plan.r, d);
        let targets =
            plan.r[within.clone()].iter().zip(&mut curve.sums[within.clone()]).zip(&mut curve.squares[within]);
        macro_rules! add {
            ($value:expr) => {
                for ((&r, sum), squares) in targets {
                    let value: f64 = height * $value(r - d);
                    *sum += value;
                    *squares += value * value;
                }
            };
        }
        let (reach, inverse, rate) = (self.reach, 1.0 / self.reach, self.rate);
        match self.shape {
            SmoothingKernel::Epanechnikov => add!(|x: f64| (1.0 - (x * inverse) * (x * inverse)).max(0.0)),
            SmoothingKernel::Gaussian => add!(|x: f64| if x.abs() < reach { (rate * x * x).exp() } else { 0.0 }),
            SmoothingKernel::Box => add!(|x: f64| if x.abs() < reach { 1.0 } else { 0.0 }),
        }
    }

    /// The r nearer to `d` than the reach, and perhaps their neighbours.
    #[inline(always)]
    fn within(&self, r: &[f64], d: f64) -> std::ops::Range<usize> {
        let (lo, hi) = (d - self.reach, d + self.reach);
        match self.even {
            Some((first, per_step)) => {
                // Conversions saturate: below the first is 0.
                let begin = (((lo - first) * per_step) as usize).min(r.len());
                let end = (((hi - first) * per_step + 2.0) as usize).min(r.len());
                begin..end.max(begin)
            }
            None => r.partition_point(|&x| x <= lo)..r.partition_point(|&x| x < hi),
        }
    }
}

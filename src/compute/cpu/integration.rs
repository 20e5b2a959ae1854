//! What points and pairs add to integration errors. Formulas: see `reference`. Pairs come in rows of lags; everything else is one loop
//! over points.

use rayon::prelude::*;

use super::Cpu;
use super::lag_deposit::{self, deposit};
use super::pair_counts::pair_counts;
use super::wave_power::{WavePoints, amplitudes};
use crate::accumulate::{IntegrandSums, KeptSums, LAG_STEP, RealizationSums, RemovalSums, add_lags};
use crate::compute::compensated::{Compensated, total};
use crate::compute::shifts::{lot, places, random_shift, weights, wrapped};
use crate::control::Control;
use crate::error::Result;
use crate::integrand::Integrand;
use crate::plan::{Estimator, IntegrationPlan, PairPlan, PairSum, Removal, WaveVectors};
use crate::points::Ensemble;

/// Lags looked up at a time.
const ROW: usize = 512;

/// Values whose sum is taken plainly.
const CHUNK: usize = 256;

/// Sums taken side by side.
const LANES: usize = 8;

/// What points and pairs alone give, of realizations that weigh what the plan says; and the pairs of all by their lags.
pub(in crate::compute) fn realizations(
    cpu: &Cpu,
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<(Vec<RealizationSums>, Vec<i64>)> {
    let count = ensemble.realizations();
    let of_some = |mut some: Found, k: usize| {
        some.realizations.push(of_points(cpu, plan, ensemble, k, &mut some.pairs, control)?);
        control.advance(1.0 / count as f64);
        Ok(some)
    };
    let both = |mut a: Found, b: Found| {
        a.realizations.extend(b.realizations);
        add_lags(&mut a.pairs.lags, b.pairs.lags)?;
        Ok(a)
    };
    // Enough at a time that memory is kept from one to the next, few enough that no thread waits for another.
    let least = (count / (8 * cpu.threads())).clamp(1, 16);
    let all = || {
        (0..count)
            .into_par_iter()
            .with_min_len(least)
            .try_fold(Found::default, of_some)
            .try_reduce(Found::default, both)
    };
    let all = cpu.pool.install(all)?;
    Ok((all.realizations, all.pairs.lags))
}

/// What is known of some realizations.
#[derive(Default)]
struct Found {
    realizations: Vec<RealizationSums>,
    pairs: Deposited,
}

/// Pairs of all of them by their lags, in steps of `LAG_STEP`, and the memory that takes.
#[derive(Default)]
struct Deposited {
    lags: Vec<i64>,
    scratch: lag_deposit::Scratch,
}

/// A sum of products whose rounding does not grow with its length.
pub(in crate::compute) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let lanes = |(a, b): (&[f64], &[f64])| {
        let (a, rest_a) = a.as_chunks::<LANES>();
        let (b, rest_b) = b.as_chunks::<LANES>();
        let mut sums = [0.0; LANES];
        for (a, b) in a.iter().zip(b) {
            sums.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += a * b);
        }
        sums.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
    };
    a.chunks(CHUNK).zip(b.chunks(CHUNK)).map(lanes).collect::<Compensated>().sum()
}

/// What points alone give.
fn of_points(
    cpu: &Cpu,
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    k: usize,
    deposited: &mut Deposited,
    control: &Control,
) -> Result<RealizationSums> {
    let places = places(ensemble, k);
    let (dim, n) = (plan.domain.dim(), places.len());
    let weights = weights(ensemble, k);
    let index = ensemble.first_index() + k as u64;
    let ones = vec![1.0; n];
    let weight = weights.as_ref().unwrap_or(&ones);
    let total = dot(weight, &ones);
    let mut values = vec![0.0; n];
    let mut sum_at = |integrand: &Integrand, places: &[[f64; 3]]| {
        integrand.values(places, &mut values);
        dot(&values, weight)
    };
    let mut each: Vec<IntegrandSums> = (plan.averaged.iter())
        .map(|integrand| IntegrandSums { values: sum_at(integrand, &places), ..IntegrandSums::default() })
        .collect();
    let mut removing = plan.removal().map(|removal| Removing::new(plan, removal, index));
    if let Some(removing) = &mut removing {
        removing.as_is(&places)?;
    }
    let offset = random_shift(index);
    let mut moved = vec![[0.0; 3]; n];
    let mut errors = vec![[Compensated::default(); 2]; each.len()];
    for (at, shift) in plan.shifts.chunks_exact(dim).enumerate() {
        control.check()?;
        let shift: [f64; 3] = std::array::from_fn(|a| if a < dim { wrapped(shift[a] + offset[a]) } else { 0.0 });
        for (to, x) in moved.iter_mut().zip(&places) {
            *to = std::array::from_fn(|a| x[a] + shift[a]).map(|x| if x < 1.0 { x } else { x - 1.0 });
        }
        for (integrand, errors) in plan.averaged.iter().zip(&mut errors) {
            let error = sum_at(integrand, &moved) - total * integrand.integral();
            errors[0].add(error);
            errors[1].add(error * error);
        }
        if let Some(removing) = &mut removing {
            removing.shifted(at, &moved)?;
        }
    }
    let shifts = (plan.shifts.len() / dim) as f64;
    for (sums, errors) in each.iter_mut().zip(&errors) {
        sums.shifted = errors.each_ref().map(|sum| sum.sum() / shifts);
    }
    low(cpu, plan, ensemble, k, &mut each, control)?;
    if let Some(nodes) = plan.lag_nodes() {
        deposited_pairs(cpu, plan, ensemble, k, nodes, deposited, &mut each, control)?;
    }
    if let Some(distances) = &plan.distances {
        counted_pairs(cpu, plan, distances, ensemble, k, &mut each, control)?;
    }
    if plan.pairs == PairSum::Exact {
        exact_pairs(plan, ensemble, k, weights.as_deref(), &mut each, control)?;
    }
    let removal = removing.map(|removing| removing.sums);
    Ok(RealizationSums { index, n: n as u64, weight: total, square: dot(weight, weight), each, removal })
}

/// Points of a parent that are kept, and what they estimate.
struct Removing<'a> {
    plan: &'a IntegrationPlan,
    removal: &'a Removal,
    index: u64,
    /// Probabilities.
    q: Vec<f64>,
    /// `1/q` of points that are kept and 0 of others.
    kept: Vec<f64>,
    values: Vec<f64>,
    sums: RemovalSums,
}

impl<'a> Removing<'a> {
    fn new(plan: &'a IntegrationPlan, removal: &'a Removal, index: u64) -> Self {
        let sums = RemovalSums { kept: 0, shifts: 0, each: vec![KeptSums::default(); plan.integrands.len()] };
        Self { plan, removal, index, q: Vec::new(), kept: Vec::new(), values: Vec::new(), sums }
    }

    /// Draws which are kept: how many.
    fn draw(&mut self, shift: u64, places: &[[f64; 3]]) -> Result<u64> {
        self.q.resize(places.len(), 0.0);
        self.removal.probabilities(places, &mut self.q)?;
        self.values.resize(places.len(), 0.0);
        let index = self.index;
        let keep = |((j, q), x): ((usize, &f64), &[f64; 3])| if lot(index, shift, j, x) < *q { 1.0 / q } else { 0.0 };
        self.kept = self.q.iter().enumerate().zip(places).map(keep).collect();
        Ok(self.kept.iter().filter(|w| **w > 0.0).count() as u64)
    }

    /// The error of an estimate by those that were drawn; `None` of a ratio without points.
    fn error(&mut self, integrand: &Integrand, places: &[[f64; 3]], kept: u64) -> Option<f64> {
        integrand.values(places, &mut self.values);
        let sum = dot(&self.values, &self.kept);
        let exact = integrand.integral();
        match self.plan.estimator {
            Estimator::Mean | Estimator::Lambda => Some(sum - places.len() as f64 * exact),
            _ if kept == 0 => None,
            Estimator::Ratio => Some(sum / total(self.kept.iter().copied()) - exact),
            Estimator::CountRatio => Some(sum * self.removal.kept / kept as f64 - exact),
        }
    }

    fn as_is(&mut self, places: &[[f64; 3]]) -> Result<()> {
        let plan = self.plan;
        self.sums.kept = self.draw(0, places)?;
        for (i, integrand) in plan.integrands.iter().enumerate() {
            let error = self.error(integrand, places, self.sums.kept).unwrap_or(0.0);
            let squares =
                self.values.iter().zip(&self.q).map(|(f, q)| if *f == 0.0 { 0.0 } else { f * f * (1.0 / q - 1.0) });
            let given = squares.collect::<Compensated>().sum();
            self.sums.each[i] = KeptSums { error, given, shifted: [0.0; 2] };
        }
        Ok(())
    }

    fn shifted(&mut self, at: usize, places: &[[f64; 3]]) -> Result<()> {
        let plan = self.plan;
        let kept = self.draw(1 + at as u64, places)?;
        let mut seen = false;
        for (i, integrand) in plan.integrands.iter().enumerate() {
            if let Some(error) = self.error(integrand, places, kept) {
                // Means, one shift after the other.
                let times = 1.0 / (self.sums.shifts + 1) as f64;
                let means = &mut self.sums.each[i].shifted;
                means[0] += times * (error - means[0]);
                means[1] += times * (error * error - means[1]);
                seen = true;
            }
        }
        self.sums.shifts += u64::from(seen);
        Ok(())
    }
}

/// Low frequencies: the linear form and the power.
fn low(
    cpu: &Cpu,
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    k: usize,
    each: &mut [IntegrandSums],
    control: &Control,
) -> Result<()> {
    let (waves, unit) = (WaveVectors::from(plan.low), ensemble.weight_unit());
    let mut s = vec![[0.0; 2]; waves.len()];
    amplitudes(cpu, &waves, &WavePoints::of(ensemble, k, &waves), &mut s, control)?;
    for (table, sums) in plan.tables.iter().zip(each) {
        let (mut linear, mut power) = (Compensated::default(), Compensated::default());
        for (index, (f, [re, im])) in table.low.iter().zip(&s).enumerate() {
            if index != plan.low.dc() {
                let times = f64::from(plan.low.multiplicity(index));
                // The mirror image has the conjugate, so that twice the real part is both.
                linear.add(times * (f.re * re + f.im * im));
                power.add(times * f.norm_sqr() * (re * re + im * im));
            }
        }
        sums.low = [linear.sum() * unit, power.sum() * unit * unit];
    }
    Ok(())
}

/// a of every lag, rows shared between threads.
fn exact_pairs(
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    k: usize,
    weights: Option<&[f64]>,
    each: &mut [IntegrandSums],
    control: &Control,
) -> Result<()> {
    let axes = ensemble.fractions(k);
    let n = axes[0].len();
    let squares: Vec<f64> = plan.averaged.iter().map(|i| i.integral() * i.integral()).collect();
    let row = |i: usize| {
        control.check()?;
        let mut sums = vec![Compensated::default(); squares.len()];
        let (mut lags, mut values) = ([[0.0; 3]; ROW], [0.0; ROW]);
        for from in (i + 1..n).step_by(ROW) {
            let len = ROW.min(n - from);
            for (a, axis) in axes.iter().enumerate() {
                for (lag, x) in lags[..len].iter_mut().zip(&axis[from..]) {
                    // A wrapping difference is the lag, exactly.
                    lag[a] = x.wrapping_sub(axis[i]) as f64 * 2f64.powi(-64);
                }
            }
            for ((integrand, square), sum) in plan.averaged.iter().zip(&squares).zip(&mut sums) {
                integrand.autocorrelations(&lags[..len], &mut values[..len]);
                let terms = values[..len].iter().map(|a| a - square);
                sum.add(match weights {
                    None => terms.sum(),
                    Some(weights) => terms.zip(&weights[from..]).map(|(a, w)| a * w).sum::<f64>() * weights[i],
                });
            }
        }
        Ok(sums.iter().map(Compensated::sum).collect::<Vec<f64>>())
    };
    let rows = (0..n).into_par_iter().map(row).collect::<Result<Vec<_>>>()?;
    for (i, sums) in each.iter_mut().enumerate() {
        sums.pairs = rows.iter().map(|row| row[i]).collect::<Compensated>().sum();
    }
    Ok(())
}

/// Pairs by their distance; those beyond half a side by their number.
fn counted_pairs(
    cpu: &Cpu,
    plan: &IntegrationPlan,
    distances: &PairPlan,
    ensemble: &Ensemble,
    k: usize,
    each: &mut [IntegrandSums],
    control: &Control,
) -> Result<()> {
    let one = ensemble.slice(k..k + 1).stretched(&distances.domain);
    let counts = pair_counts(cpu, distances, &one, control)?.counts;
    let n = one.points_in(0) as f64;
    let beyond = n * (n - 1.0) - counts.iter().map(|count| *count as f64).sum::<f64>();
    let ordered: Vec<f64> = counts.iter().map(|count| *count as f64).chain([beyond]).collect();
    for (table, sums) in plan.tables.iter().zip(each) {
        sums.pairs = 0.5 * dot(&table.nodes, &ordered);
    }
    Ok(())
}

/// Pairs shared among the nodes around their lags.
#[expect(clippy::too_many_arguments, reason = "what there is to know of a realization, and two places to add to")]
fn deposited_pairs(
    cpu: &Cpu,
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    k: usize,
    nodes: usize,
    into: &mut Deposited,
    each: &mut [IntegrandSums],
    control: &Control,
) -> Result<()> {
    let axes = ensemble.fractions(k);
    let unit = ensemble.weight_unit();
    let deposited = deposit(cpu, &axes, ensemble.weights(k), nodes, &mut into.scratch, control)?;
    for (table, sums) in plan.tables.iter().zip(each) {
        sums.pairs = dot(&table.nodes, deposited) * unit * unit;
    }
    into.lags.resize(deposited.len(), 0);
    for (sum, share) in into.lags.iter_mut().zip(deposited) {
        *sum = sum.saturating_add((share / LAG_STEP).round_ties_even() as i64);
    }
    Ok(())
}

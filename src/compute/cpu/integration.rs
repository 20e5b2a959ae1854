//! Integration errors. Formulas: see `reference`. Power comes from the transforms of spectra, a realization at a time; pairs in rows of
//! lags; everything else is one loop over points.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::Cpu;
use super::wave_power::{WavePoints, amplitudes, wave_power_seen};
use crate::accumulate::{IntegrandSums, IntegrationSums, RealizationSums};
use crate::compute::compensated::Compensated;
use crate::compute::shifts::{places, random_shift, wrapped};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{IntegrationPlan, PairSum, WavePlan, WaveVectors};
use crate::points::Ensemble;

/// Lags looked up at a time.
const ROW: usize = 512;

/// Values whose sum is taken plainly.
const CHUNK: usize = 256;

pub(super) fn integration(
    cpu: &Cpu,
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<IntegrationSums> {
    let (count, many) = (ensemble.realizations(), plan.integrands.len());
    // The transform, one per axis, and the points.
    control.in_pieces(2 + plan.axes.len());
    let seen = |waves: &WavePlan, points: &Ensemble, table: &(dyn Fn(usize) -> Vec<f64> + Sync)| {
        let tables: Vec<Vec<f64>> = (0..many).map(table).collect();
        let dots = Mutex::new(vec![vec![0.0; many]; count]);
        let see = |k: usize, power: &[f64]| {
            let of_all: Vec<f64> = tables.iter().map(|table| dot(table, power)).collect();
            dots.lock().unwrap_or_else(PoisonError::into_inner)[k] = of_all;
        };
        let sums = wave_power_seen(cpu, waves, points, control, &see)?;
        Ok::<_, crate::error::Error>((sums, dots.into_inner().unwrap_or_else(PoisonError::into_inner)))
    };
    let unweighted = ensemble.unweighted();
    let (grid, on_grid) = seen(&plan.grid, &unweighted, &|i| plan.tables[i].grid.clone())?;
    let mut axes = Vec::new();
    let mut on_axes = vec![vec![0.0; many]; count];
    for (a, waves) in plan.axes.iter().enumerate() {
        let (sums, dots) = seen(waves, &unweighted.on_axis(a, &waves.domain), &|i| plan.tables[i].axes[a].clone())?;
        axes.push(sums);
        on_axes.iter_mut().zip(dots).for_each(|(all, more)| all.iter_mut().zip(more).for_each(|(a, b)| *a += b));
    }
    let of_points = |k: usize| {
        let mut each = of_points(cpu, plan, &unweighted, k, control)?;
        for (i, sums) in each.iter_mut().enumerate() {
            (sums.grid, sums.axes) = (on_grid[k][i], on_axes[k][i]);
        }
        control.advance(1.0 / count as f64);
        Ok(RealizationSums { index: ensemble.first_index() + k as u64, n: ensemble.points_in(k) as u64, each })
    };
    let realizations = cpu.pool.install(|| (0..count).into_par_iter().map(of_points).collect::<Result<Vec<_>>>())?;
    Ok(IntegrationSums { grid, axes, integrands: many, realizations })
}

/// A sum of products whose rounding does not grow with its length.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let chunks = a.chunks(CHUNK).zip(b.chunks(CHUNK));
    chunks.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).collect::<Compensated>().sum()
}

/// What points alone give.
fn of_points(
    cpu: &Cpu,
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    k: usize,
    control: &Control,
) -> Result<Vec<IntegrandSums>> {
    let places = places(ensemble, k);
    let dim = plan.domain.dim();
    let mut each = vec![IntegrandSums::default(); plan.integrands.len()];
    let offset = random_shift(ensemble.first_index() + k as u64);
    for (integrand, sums) in plan.integrands.iter().zip(&mut each) {
        control.check()?;
        sums.values = places.iter().map(|x| integrand.value(&x[..dim])).collect::<Compensated>().sum();
        let expected = places.len() as f64 * integrand.integral();
        let (mut first, mut second) = (Compensated::default(), Compensated::default());
        for shift in plan.shifts.chunks_exact(dim) {
            let shift: [f64; 3] = std::array::from_fn(|a| if a < dim { wrapped(shift[a] + offset[a]) } else { 0.0 });
            let at = |x: &[f64; 3]| {
                let x: [f64; 3] = std::array::from_fn(|a| x[a] + shift[a]).map(|x| if x < 1.0 { x } else { x - 1.0 });
                integrand.value(&x[..dim])
            };
            let error = places.iter().map(at).collect::<Compensated>().sum() - expected;
            first.add(error);
            second.add(error * error);
        }
        let shifts = (plan.shifts.len() / dim) as f64;
        sums.shifted = [first.sum() / shifts, second.sum() / shifts];
    }
    low(cpu, plan, ensemble, k, &mut each, control)?;
    match plan.pairs {
        PairSum::Exact => exact_pairs(plan, ensemble, k, &mut each, control)?,
        PairSum::Deposit(cells) => deposited_pairs(plan, ensemble, k, cells, &mut each, control)?,
        PairSum::None => {}
    }
    Ok(each)
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
    let waves = WaveVectors::from(plan.low);
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
        sums.low = [linear.sum(), power.sum()];
    }
    Ok(())
}

/// a of every lag, rows shared between threads.
fn exact_pairs(
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    k: usize,
    each: &mut [IntegrandSums],
    control: &Control,
) -> Result<()> {
    let axes = ensemble.fractions(k);
    let n = axes[0].len();
    let squares: Vec<f64> = plan.integrands.iter().map(|i| i.integral() * i.integral()).collect();
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
            for ((integrand, square), sum) in plan.integrands.iter().zip(&squares).zip(&mut sums) {
                integrand.autocorrelations(&lags[..len], &mut values[..len]);
                sum.add(values[..len].iter().map(|a| a - square).sum());
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

/// Pairs shared among the nodes around their lags.
fn deposited_pairs(
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    k: usize,
    cells: usize,
    each: &mut [IntegrandSums],
    control: &Control,
) -> Result<()> {
    let axes = ensemble.fractions(k);
    let deposited = match axes.as_slice() {
        [x] => deposit([x], cells, control),
        [x, y] => deposit([x, y], cells, control),
        [x, y, z] => deposit([x, y, z], cells, control),
        _ => return Ok(()),
    }?;
    for (table, sums) in plan.tables.iter().zip(each) {
        sums.pairs = dot(&table.nodes, &deposited);
    }
    Ok(())
}

/// Per node of a grid of lags, x fastest, the share of all pairs i < j.
fn deposit<const D: usize>(axes: [&[u64]; D], cells: usize, control: &Control) -> Result<Vec<f64>> {
    let mut grid = vec![0.0; cells.pow(D as u32)];
    let bits = cells.trailing_zeros();
    let scale = 2f64.powi(-64);
    let points: Vec<[u64; D]> = (0..axes[0].len()).map(|j| std::array::from_fn(|a| axes[a][j])).collect();
    for (i, origin) in points.iter().enumerate() {
        if i.is_multiple_of(64) {
            control.check()?;
        }
        for point in &points[i + 1..] {
            let (mut places, mut shares) = ([[0usize; 2]; D], [[0.0; 2]; D]);
            for a in 0..D {
                let lag = point[a].wrapping_sub(origin[a]);
                let cell = (lag >> (64 - bits)) as usize;
                let part = (lag << bits) as f64 * scale;
                let stride = cells.pow(a as u32);
                places[a] = [cell * stride, ((cell + 1) & (cells - 1)) * stride];
                shares[a] = [1.0 - part, part];
            }
            for corner in 0..1usize << D {
                let (mut at, mut share) = (0, 1.0);
                for a in 0..D {
                    let side = corner >> a & 1;
                    at += places[a][side];
                    share *= shares[a][side];
                }
                grid[at] += share;
            }
        }
    }
    Ok(grid)
}

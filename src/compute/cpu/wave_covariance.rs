//! The covariance of amplitudes as matrix products. Formula: see `reference`.
//!
//! The components of the amplitudes of a leaf of realizations are a matrix with a row per realization; the sums over the leaf
//! are its transpose times itself. Leaves are what sums are made of anyway, so nothing depends on threads.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::Cpu;
use super::product::{FEWEST_POINTS, Operand, product};
use super::wave_power::{WavePoints, amplitudes};
use crate::accumulate::{CovarianceSums, WaveCovariance};
use crate::compute::Compute;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{CovariancePlan, MEMORY_BUDGET, WaveVectors};
use crate::plan::{LEAF, covariance_values};
use crate::points::Ensemble;

pub(super) fn wave_covariance(
    cpu: &Cpu,
    plan: &CovariancePlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<WaveCovariance> {
    let (first, count) = (ensemble.first_index(), ensemble.realizations());
    let leaf_of = |k: usize| (first + k as u64) / LEAF;
    let leaves: Vec<Range<usize>> = (0..count)
        .filter(|&k| k == 0 || leaf_of(k) != leaf_of(k - 1))
        .map(|start| start..(((leaf_of(start) + 1) * LEAF - first) as usize).min(count))
        .collect();
    let sums = Mutex::new(WaveCovariance::new(cpu.computed_by(), plan.stored()));
    let waves = WaveVectors::from(plan.grid);
    let add = |range: &Range<usize>| -> Result<()> {
        let leaf = leaf_sums(cpu, plan, &waves, ensemble, range.clone(), control)?;
        let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
        sums.add_leaf(leaf_of(range.start), range.len() as u64, leaf);
        Ok(())
    };
    let threads = cpu.threads();
    let bytes = 8 * covariance_values(plan.stored() as u128);
    if leaves.len() >= threads && bytes * threads as u128 <= u128::from(MEMORY_BUDGET) {
        let next = AtomicUsize::new(0);
        let results = cpu.pool.broadcast(|_| {
            while let Some(range) = leaves.get(next.fetch_add(1, Ordering::Relaxed)) {
                add(range)?;
            }
            Ok(())
        });
        results.into_iter().collect::<Result<()>>()?;
    } else {
        // One after the other, all threads at the amplitudes of each.
        leaves.iter().try_for_each(add)?;
    }
    Ok(sums.into_inner().unwrap_or_else(PoisonError::into_inner))
}

fn leaf_sums(
    cpu: &Cpu,
    plan: &CovariancePlan,
    waves: &WaveVectors,
    ensemble: &Ensemble,
    range: Range<usize>,
    control: &Control,
) -> Result<CovarianceSums> {
    let stored = plan.stored();
    // Rows of zeros make up for realizations that are too few for a product.
    let rows = range.len().max(FEWEST_POINTS);
    let (mut components, mut with_norm) = (vec![0.0; rows * 2 * stored], vec![0.0; rows * 2 * stored]);
    let mut powers = vec![0.0; rows * stored];
    let mut sums = CovarianceSums::new(stored);
    let mut all = vec![[0.0; 2]; waves.len()];
    for (row, k) in range.enumerate() {
        control.check()?;
        amplitudes(cpu, waves, &WavePoints::of(ensemble, k, waves), &mut all, control)?;
        let norm = ensemble.norm(k);
        for (a, [re, im]) in all[plan.grid.dc()..].iter().enumerate() {
            for (at, x) in [(a, re), (stored + a, im)] {
                components[row * 2 * stored + at] = *x;
                with_norm[row * 2 * stored + at] = x * norm;
            }
            powers[row * stored + a] = re * re + im * im;
        }
        sums.add_norm(norm);
        control.advance(1.0 / ensemble.realizations() as f64);
    }
    let matrix = |values, width| Operand { values, stride: width, width };
    let x = matrix(components.as_slice(), 2 * stored);
    product(x, x, rows, &mut sums.products, false);
    product(matrix(with_norm.as_slice(), 2 * stored), x, rows, &mut sums.products_n, false);
    let q = matrix(powers.as_slice(), stored);
    product(q, q, rows, &mut sums.powers, false);
    Ok(sums)
}

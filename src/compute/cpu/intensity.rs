//! Sums of Gaussian kernels on a grid: a kernel is a product over axes, so each point adds the product of two or three vectors,
//! cut to where they are not 0. Every cell adds its points in their order, however many threads share the rows.

use rayon::prelude::*;

use super::Cpu;
use crate::accumulate::IntensitySums;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{IntensityPlan, LEAF};
use crate::points::Ensemble;

/// Points whose vectors are kept at a time.
const BLOCK: usize = 256;

/// Of every realization.
pub(super) fn intensity(
    cpu: &Cpu,
    plan: &IntensityPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<IntensitySums> {
    let mut sums = IntensitySums::new(plan.cell_count());
    let part = 1.0 / ensemble.realizations() as f64;
    let leaf_of = |k: usize| (ensemble.first_index() + k as u64) / LEAF;
    let indices: Vec<usize> = (0..ensemble.realizations()).collect();
    for leaf in indices.chunk_by(|&a, &b| leaf_of(a) == leaf_of(b)) {
        let mut both = vec![0.0; 2 * plan.cell_count()];
        let (total, squares) = both.split_at_mut(plan.cell_count());
        let mut points = 0;
        for &k in leaf {
            points += ensemble.points_in(k) as u64;
            let field = cpu.pool.install(|| kernels(plan, ensemble, k, control))?;
            for ((total, square), sum) in total.iter_mut().zip(&mut *squares).zip(field) {
                *total += sum;
                *square += sum * sum;
            }
            control.advance(part);
        }
        sums.add_leaf(leaf_of(leaf[0]), leaf.len() as u64, points, both);
    }
    Ok(sums)
}

/// The kernel of one point along an axis, where it is not 0.
struct Along {
    start: usize,
    values: Vec<f64>,
}

impl Along {
    fn new(plan: &IntensityPlan, axis: usize, place: f64) -> Self {
        let values: Vec<f64> = (0..plan.cells).map(|i| plan.kernel(axis, plan.middle_of(axis, i) - place)).collect();
        let start = values.iter().position(|v| *v > 0.0).unwrap_or(0);
        let end = values.iter().rposition(|v| *v > 0.0).map_or(start, |last| last + 1);
        Self { start, values: values[start..end].to_vec() }
    }

    fn at(&self, index: usize) -> f64 {
        index.checked_sub(self.start).and_then(|i| self.values.get(i)).copied().unwrap_or(0.0)
    }
}

/// The sum of all kernels of one realization at every cell.
fn kernels(plan: &IntensityPlan, ensemble: &Ensemble, k: usize, control: &Control) -> Result<Vec<f64>> {
    let (dim, cells) = (plan.domain.dim(), plan.cells);
    let unit = plan.domain.length_unit() / 2f64.powi(64);
    let lengths = ensemble.lengths(k);
    let mut field = vec![0.0; plan.cell_count()];
    let points: Vec<usize> = (0..lengths[0].len()).collect();
    for block in points.chunks(BLOCK) {
        control.check()?;
        let axes = |&j: &usize| (0..dim).map(|a| Along::new(plan, a, lengths[a][j] as f64 * unit)).collect::<Vec<_>>();
        let block: Vec<Vec<Along>> = block.par_iter().map(axes).collect();
        // The last axis is a row; the others say which row it is.
        field.par_chunks_mut(cells).enumerate().for_each(|(row, values)| {
            for point in &block {
                let Some((last, others)) = point.split_last() else { continue };
                let weight = others
                    .iter()
                    .rev()
                    .fold((row, 1.0), |(rest, weight), along| (rest / cells, weight * along.at(rest % cells)));
                if weight.1 > 0.0 {
                    let values = &mut values[last.start..last.start + last.values.len()];
                    values.iter_mut().zip(&last.values).for_each(|(sum, v)| *sum += weight.1 * v);
                }
            }
        });
    }
    Ok(field)
}

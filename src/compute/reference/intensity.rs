//! `sum_i k(u - x_i)` at the middle u of every cell, k the Gaussian kernel, wrapped on a torus.

use crate::accumulate::IntensitySums;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{IntensityPlan, LEAF};
use crate::points::Ensemble;

/// Of every realization.
pub(super) fn intensity(plan: &IntensityPlan, ensemble: &Ensemble, control: &Control) -> Result<IntensitySums> {
    let mut sums = IntensitySums::new(plan.cell_count());
    let leaf_of = |k: usize| (ensemble.first_index() + k as u64) / LEAF;
    let indices: Vec<usize> = (0..ensemble.realizations()).collect();
    for leaf in indices.chunk_by(|&a, &b| leaf_of(a) == leaf_of(b)) {
        let mut both = vec![0.0; 2 * plan.cell_count()];
        let mut points = 0;
        for &k in leaf {
            control.check()?;
            points += ensemble.points_in(k) as u64;
            for cell in 0..plan.cell_count() {
                let middle = plan.middle(cell);
                let kernel = |j: usize| -> f64 {
                    let axes = ensemble.position(k, j).into_iter().zip(plan.domain.origin()).enumerate();
                    axes.map(|(a, (x, origin))| plan.kernel(a, middle[a] - (x - origin))).product()
                };
                let sum: f64 = (0..ensemble.points_in(k)).map(kernel).sum();
                both[cell] += sum;
                both[plan.cell_count() + cell] += sum * sum;
            }
        }
        sums.add_leaf(leaf_of(leaf[0]), leaf.len() as u64, points, both);
    }
    Ok(sums)
}

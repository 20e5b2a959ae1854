//! Kernel sums from exact counts in fine bins, on any device: each pair is spread evenly over its bin.

use rayon::prelude::*;

use super::Compute;
use crate::accumulate::Backend;
use crate::accumulate::{KernelCurve, KernelSums, PairCounts};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{GPU_WEIGHT_BOUND, KernelPlan};
use crate::points::Ensemble;
use crate::pool::Pool;

/// The kernel sums of every realization, from the counts of a device; `pool` smooths them.
///
/// # Errors
/// What the backend says that counts the pairs; `Error::Cancelled`.
pub async fn kernel_sums(
    device: &dyn Compute,
    pool: &Pool,
    plan: &KernelPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<KernelSums> {
    let mut sums = KernelSums::new(device.computed_by(), plan.r.len());
    for k in 0..ensemble.realizations() {
        let counts = device.pair_counts(&plan.pairs, &ensemble.slice(k..k + 1), control).await?;
        sums.add(ensemble.first_index() + k as u64, &pool.install(|| curve(plan, &counts)));
    }
    sums.close_leaf();
    Ok(sums)
}

/// The sums of one realization. The mean of the kernel over a fine bin is known in closed form, and a pair's own value
/// differs from it by no more than the kernel's oscillation over the bin: that is the bound.
fn curve(plan: &KernelPlan, counts: &PairCounts) -> KernelCurve {
    let (kernel, bins) = (plan.kernel, &plan.pairs.bins);
    let edges = bins.edges();
    let width = bins.r_max() / bins.len() as f64;
    let norms = counts.bins.norm(0).map(|n| n.sum as f64 / 2f64.powi(counts.steps.norm_bits as i32));
    let mut curve = KernelCurve::new(norms, plan.r.len());
    // Weights of a GPU are f32.
    let of_weights = if plan.pairs.weighted() && counts.computed_by.backends.contains(&Backend::Gpu) {
        GPU_WEIGHT_BOUND
    } else {
        0.0
    };
    let at = |r: f64| {
        let first = ((r - kernel.reach()) / width).floor().max(0.0) as usize;
        let last = (((r + kernel.reach()) / width).ceil() as usize).min(bins.len());
        let [mut sum, mut squares, mut bound] = [0.0; 3];
        let mut below = kernel.cumulative(edges[first.min(last)] - r);
        for b in first..last {
            let (lo, hi) = (edges[b] - r, edges[b + 1] - r);
            let to_here = kernel.cumulative(hi);
            let mean = (to_here - std::mem::replace(&mut below, to_here)) / width;
            if counts.counts[b] == 0 {
                continue;
            }
            let weight = counts.sum(b);
            sum += weight * mean;
            // count / 2 unordered pairs of twice the mean weight.
            squares += 2.0 * weight * weight * mean * mean / counts.counts[b] as f64;
            bound += weight * kernel.oscillation(lo, hi);
        }
        (sum, (squares, bound + of_weights * sum))
    };
    let values: Vec<_> = plan.r.par_iter().map(|&r| at(r)).collect();
    let (sums, rest): (Vec<_>, Vec<_>) = values.into_iter().unzip();
    curve.sums = sums;
    (curve.squares, curve.bounds) = rest.into_iter().unzip();
    curve
}

//! Pair counts on the GPU: which kernel, which dispatches. See the reference for the definition and
//! `shaders/pair_counts.wgsl` for the work itself.

use std::ops::Range;

use super::pair_jobs::dispatches;
use super::pair_run::{NAME, Run, Tables, UploadedPoints};
use super::{GpuCompute, pair_cells, pair_specs};
use crate::accumulate::PairCounts;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{PairPlan, PairSearch};
use crate::points::Ensemble;

pub(super) async fn pair_counts(
    compute: &GpuCompute,
    plan: &PairPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<PairCounts> {
    let gpu = compute.gpu();
    let largest = (0..ensemble.realizations()).map(|k| ensemble.points_in(k)).max().unwrap_or(0) as u64;
    pair_specs::supports(plan, &gpu.limits)
        .and_then(|()| pair_specs::fits(largest, plan.domain.dim(), gpu.limits.max_storage_buffer_binding_size))
        .map_err(|reason| gpu.error(NAME, reason))?;

    let mut run = Run::new(compute, plan, ensemble, control);
    match plan.search {
        PairSearch::All => all_pairs(&mut run).await?,
        PairSearch::Cells(grid) => pair_cells::run(&mut run, grid).await?,
    }
    Ok(run.into_sums())
}

/// One tile after the other.
async fn all_pairs(run: &mut Run<'_>) -> Result<()> {
    let (compute, plan, ensemble) = (run.compute, run.plan, run.ensemble);
    let gpu = compute.gpu();
    let limit = gpu.limits.max_compute_workgroup_storage_size;
    let kernel = compute.kernel(pair_specs::all_pairs(plan, limit)).await?;
    let caps = run.caps();
    let mut held: Option<(Range<usize>, UploadedPoints)> = None;
    gpu.guarded(NAME, async || {
        let tables = Tables::upload(compute, plan);
        let all = dispatches(&run.sizes, plan.tile.points(), caps.pairs, caps.points, caps.histograms);
        let part = 1.0 / all.len().max(1) as f64;
        for dispatch in all {
            run.control.check()?;
            let range = dispatch.realizations.clone();
            // A large realization takes many dispatches; its points go up once.
            if held.as_ref().is_none_or(|(r, _)| *r != range) {
                drop(held.take());
                held = Some((range.clone(), UploadedPoints::with_depths(compute, plan, ensemble, &range)));
            }
            let Some((_, points)) = &held else { continue };
            let jobs = gpu.upload("jobs", &dispatch.jobs, compute.tuning.fill);
            run.submit(&kernel, &tables, range, points, &[&jobs], dispatch.jobs.len() as u32).await?;
            run.control.advance(part);
        }
        run.finish().await
    })
    .await
}

//! Pairs in cells near each other: points are sorted on the device, the host finds out which cells meet (`compute::cells`) and
//! cuts that into jobs for `shaders/pair_counts_cells.wgsl`.

use std::ops::Range;
use std::sync::Arc;

use super::kernel::Kernel;
use super::pair_run::{Caps, Run, Tables, UploadedPoints};
use super::params::{CellJob, CellPairJob, CellPairTask, CellParams};
use super::{MAX_GROUPS, pair_specs};
use crate::compute::cells::Neighbourhood;
use crate::error::Result;
use crate::plan::{CellGrid, Tile};

const NAME: &str = "pair_counts_cells";
/// Points per workgroup of the sort, at least.
const SORT_POINTS: usize = 1024;
/// Realizations sorted together, at most.
const SORT_SETS: usize = 1 << 14;
/// A task is at most about this many pairs, so that one crowded cell does not keep all others waiting.
const TASK_PAIRS: u64 = 1 << 18;
/// A job is at least this many pairs, so that clearing and adding up its histogram does not matter; a dispatch has about so
/// many jobs where the work allows.
const JOB_PAIRS: u64 = 1 << 14;
const JOBS_WANTED: u64 = 8192;

/// Counts all realizations.
pub(super) async fn run(run: &mut Run<'_>, grid: CellGrid) -> Result<()> {
    let compute = run.compute;
    let gpu = compute.gpu();
    let caps = run.caps();
    let near = Neighbourhood::new(run.plan);
    let kernel =
        compute.kernel(pair_specs::cell_pairs(run.plan, gpu.limits.max_compute_workgroup_storage_size)).await?;
    let sort = Sort::new(run, grid).await?;
    let cells = grid.len();
    gpu.guarded(NAME, async || {
        let tables = Tables::upload(compute, run.plan);
        let all = groups(&run.sizes, &caps, cells);
        let part = 1.0 / all.len().max(1) as f64;
        for group in all {
            run.control.check()?;
            let (points, starts) = sort.sorted(run, &group).await?;
            let sets = starts.windows(cells + 1).step_by(cells);
            let tasks: Vec<Vec<CellPairTask>> = sets.map(|starts| tasks(&near, starts)).collect();
            for (tasks, jobs) in
                dispatches(&tasks, caps.pairs, (caps.bytes as usize / size_of::<CellPairTask>()).max(1))
            {
                run.control.check()?;
                let groups = jobs.len() as u32;
                let jobs = gpu.upload("jobs", &jobs, compute.tuning.fill);
                let tasks = gpu.upload("tasks", &tasks, compute.tuning.fill);
                run.submit(&kernel, &tables, group.clone(), &points, &[&jobs, &tasks], groups).await?;
            }
            run.control.advance(part);
        }
        run.finish().await
    })
    .await
}

/// Realizations that go together: as many as the buffers hold, at least one.
fn groups(sizes: &[usize], caps: &Caps, cells: usize) -> Vec<Range<usize>> {
    let sets = caps.histograms.min(caps.bytes as usize / 4 / cells).clamp(1, SORT_SETS);
    let mut groups: Vec<Range<usize>> = Vec::new();
    let mut points = 0;
    for (k, &n) in sizes.iter().enumerate() {
        points += n;
        match groups.last_mut() {
            Some(group) if group.len() < sets && points <= caps.points => group.end = k + 1,
            _ => {
                groups.push(k..k + 1);
                points = n;
            }
        }
    }
    groups
}

/// The counting sort: the device counts the points of each cell, the host adds up, the device moves them.
struct Sort {
    count: Arc<Kernel>,
    scatter: Arc<Kernel>,
    params: CellParams,
    cells: usize,
}

impl Sort {
    async fn new(run: &Run<'_>, grid: CellGrid) -> Result<Self> {
        let [count, scatter] = pair_specs::sort(run.plan);
        let mut params = CellParams::default();
        let mut stride = 1;
        for (axis, rule) in grid.axes(&run.plan.domain).into_iter().enumerate() {
            let (multiplier, shift) = rule.rule();
            params.multiplier_low[axis] = multiplier as u32;
            params.multiplier_high[axis] = (multiplier >> 32) as u32;
            // The upper half of the product is shifted: by at least 63 + 44 - 20 - 64, since no side is shorter than 1e-6 of
            // the longest and no axis has more than 2^20 cells. Axes beyond the dimension are not looked at.
            params.shift[axis] = shift.saturating_sub(64);
            params.stride[axis] = stride;
            stride *= grid.cells[axis];
        }
        let (count, scatter) = (run.compute.kernel(count).await?, run.compute.kernel(scatter).await?);
        Ok(Self { count, scatter, params, cells: grid.len() })
    }

    /// The points of a group in the order of realizations and cells, and where each cell begins; one entry more at the end.
    async fn sorted(&self, run: &Run<'_>, group: &Range<usize>) -> Result<(UploadedPoints, Vec<u32>)> {
        let (gpu, fill) = (run.compute.gpu(), run.compute.tuning.fill);
        let total: usize = run.sizes[group.clone()].iter().sum();
        let piece = SORT_POINTS.max(total / (MAX_GROUPS as usize / 2));
        let (mut jobs, mut first_point) = (Vec::new(), 0);
        for (set, &n) in run.sizes[group.clone()].iter().enumerate() {
            let first_cell = (set * self.cells) as u32;
            jobs.extend((0..n).step_by(piece).map(|first| CellJob {
                first_point: (first_point + first) as u32,
                points: piece.min(n - first) as u32,
                first_cell,
            }));
            first_point += n;
        }
        let points = UploadedPoints::with_depths(run.compute, run.plan, run.ensemble, group);
        let params = gpu.uniform("params", &CellParams { total_points: total as u32, ..self.params });
        let places = gpu.scratch("places", 8 * total as u64, fill);
        let cells = group.len() * self.cells;
        let counts = gpu.scratch("counts", 4 * cells as u64, fill);
        let mut encoder = gpu.encoder(NAME);
        encoder.clear_buffer(&counts, 0, None);
        if !jobs.is_empty() {
            let buffer = gpu.upload("jobs", &jobs, fill);
            let buffers = [&params, &buffer, &points.exact, &places, &counts];
            self.count.dispatch(gpu, &mut encoder, &buffers, jobs.len() as u32);
        }
        let counts: Vec<u32> = gpu.read_back(NAME, encoder, &counts, cells).await?;
        let mut starts = Vec::with_capacity(cells + 1);
        starts.push(0);
        starts.extend(counts.iter().scan(0, |sum, count| {
            *sum += count;
            Some(*sum)
        }));

        let first_places = gpu.upload("starts", &starts[..cells], fill);
        let dim = run.plan.domain.dim() as u64;
        let rounded = gpu.scratch("sorted_rounded", 4 * dim * total as u64, fill);
        let exact = gpu.scratch("sorted_exact", 8 * dim * total as u64, fill);
        let of_points = if points.depths.is_some() { 4 * total as u64 } else { 0 };
        let depths = gpu.scratch("sorted_depths", of_points, fill);
        let none = gpu.scratch("depths", 0, fill);
        let mut encoder = gpu.encoder(NAME);
        let buffers = [
            &params,
            &first_places,
            &places,
            &points.rounded,
            &points.exact,
            points.depths.as_ref().unwrap_or(&none),
            &rounded,
            &exact,
            &depths,
        ];
        let groups = (total as u32).div_ceil(pair_specs::SORT_LANES).clamp(1, MAX_GROUPS);
        self.scatter.dispatch(gpu, &mut encoder, &buffers, groups);
        gpu.queue.submit([encoder.finish()]);
        let depths = points.depths.is_some().then_some(depths);
        Ok((UploadedPoints { rounded, exact, depths }, starts))
    }
}

/// The tasks of a realization whose cells begin at `starts`: every pair of points that partners make, once.
fn tasks(near: &Neighbourhood, starts: &[u32]) -> Vec<CellPairTask> {
    let most = (Tile::POINTS_PER_LANE * pair_specs::CELL_LANES) as usize;
    let (mut tasks, mut ranges) = (Vec::new(), Vec::new());
    for (cell, bounds) in starts.windows(2).enumerate() {
        let (start, end) = (bounds[0] as usize, bounds[1] as usize);
        for first in (start..end).step_by(most) {
            let rows = first..end.min(first + most);
            let lane_bits = rows.len().div_ceil(Tile::POINTS_PER_LANE as usize).next_power_of_two().ilog2();
            near.partners(starts, cell, &rows, &mut ranges);
            if let Some(own) = ranges.first_mut() {
                // The first row is nobody's partner.
                own.start += 1;
            }
            let columns = (TASK_PAIRS / u64::from(Tile::POINTS_PER_LANE << lane_bits)) as usize;
            for range in &ranges {
                tasks.extend(range.clone().step_by(columns).map(|column| CellPairTask {
                    first_row: rows.start as u32,
                    rows: rows.len() as u32,
                    first: column as u32,
                    end: range.end.min(column + columns) as u32,
                    lane_bits,
                }));
            }
        }
    }
    tasks
}

/// Pairs that a task keeps the device busy with, those of lanes without a row included.
fn pairs_of(task: &CellPairTask) -> u64 {
    u64::from(Tile::POINTS_PER_LANE << task.lane_bits) * u64::from(task.end - task.first)
}

/// Cuts the tasks of realizations into jobs, and those into dispatches of at most `pairs` pairs (or one task, where that is
/// more), `most_tasks` tasks and `MAX_GROUPS` jobs.
fn dispatches(sets: &[Vec<CellPairTask>], pairs: u64, most_tasks: usize) -> Vec<(Vec<CellPairTask>, Vec<CellPairJob>)> {
    let total: u64 = sets.iter().flatten().map(pairs_of).sum();
    let job_pairs = (total.min(pairs) / JOBS_WANTED).max(JOB_PAIRS);
    let mut all: Vec<(Vec<CellPairTask>, Vec<CellPairJob>)> = Vec::new();
    let (mut in_dispatch, mut in_job) = (0, 0);
    for (histogram, tasks) in sets.iter().enumerate() {
        let mut begins = true;
        for task in tasks {
            let size = pairs_of(task);
            begins |= in_job + size > job_pairs;
            let full = all.last().is_none_or(|(tasks, jobs)| {
                in_dispatch + size > pairs || tasks.len() >= most_tasks || begins && jobs.len() >= MAX_GROUPS as usize
            });
            if full {
                all.push((Vec::new(), Vec::new()));
                (in_dispatch, begins) = (0, true);
            }
            let Some((tasks, jobs)) = all.last_mut() else { continue };
            if begins {
                jobs.push(CellPairJob { first_task: tasks.len() as u32, tasks: 0, histogram: histogram as u32 });
                (in_job, begins) = (0, false);
            }
            tasks.push(*task);
            if let Some(job) = jobs.last_mut() {
                job.tasks += 1;
            }
            in_job += size;
            in_dispatch += size;
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(first: u32, pairs: u32) -> CellPairTask {
        CellPairTask { first_row: 0, rows: 4, first, end: first + pairs / 4, lane_bits: 0 }
    }

    /// Every task in exactly one job of its realization, whatever the caps.
    #[test]
    fn dispatches_cover_each_task_once() {
        let set = |k: u32, n: u32| (0..n).map(|t| task(1000 * k + t, 1 << (4 + t % 13))).collect::<Vec<_>>();
        let sets = [set(0, 50), set(1, 0), set(2, 1), set(3, 900)];
        for (pairs, most) in [(1, 1000), (1 << 17, 1000), (1 << 40, 7), (1 << 40, 1 << 20)] {
            let mut seen: Vec<Vec<CellPairTask>> = vec![Vec::new(); sets.len()];
            for (tasks, jobs) in dispatches(&sets, pairs, most) {
                assert!(tasks.len() <= most && jobs.len() <= MAX_GROUPS as usize);
                assert!(tasks.len() == 1 || tasks.iter().map(pairs_of).sum::<u64>() <= pairs);
                let mut next = 0;
                for job in jobs {
                    assert_eq!(job.first_task, next, "jobs follow each other");
                    next += job.tasks;
                    seen[job.histogram as usize].extend(&tasks[job.first_task as usize..next as usize]);
                }
                assert_eq!(next as usize, tasks.len());
            }
            assert_eq!(seen, sets);
        }
    }

    #[test]
    fn groups_keep_to_the_caps() {
        let caps = Caps { bytes: 4000, points: 100, histograms: 3, pairs: 1 };
        let sizes = [50, 50, 1, 300, 0, 0, 0, 0, 99];
        assert_eq!(groups(&sizes, &caps, 10), [0..2, 2..3, 3..4, 4..7, 7..9]);
        assert_eq!(groups(&[1, 1, 1], &caps, 500), [0..2, 2..3], "two sets of 500 cells in 4000 bytes");
        assert_eq!(groups(&[1, 1], &caps, 5000), [0..1, 1..2], "at least one");
    }
}

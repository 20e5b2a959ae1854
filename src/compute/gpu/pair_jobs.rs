//! All pairs of realizations, cut into jobs for `shaders/pair_counts.wgsl` and into dispatches.

use std::ops::Range;

use super::MAX_GROUPS;
use super::params::PairJob;

/// A job is at most this many tiles, and a dispatch has about this many jobs where the work allows: several rounds for the
/// largest devices, which run about 2000 workgroups at a time.
const MAX_STEPS: u32 = 64;
const JOBS_WANTED: u64 = 8192;

/// Jobs submitted together, whose realizations have one histogram each.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dispatch {
    pub(super) realizations: Range<usize>,
    pub(super) jobs: Vec<PairJob>,
}

/// Cuts the pairs of realizations with `sizes` points into dispatches of at most `pairs` pairs (or one job, where that is
/// more), `points` points, `bins_total` bins and `MAX_GROUPS` jobs.
pub(super) fn dispatches(sizes: &[usize], tile: u32, pairs: u64, points: usize, histograms: usize) -> Vec<Dispatch> {
    let tiles = |n: usize| n.div_ceil(tile as usize) as u32;
    // Tile `a` meets tiles a, a + 1, .. a + t/2 (mod t). For even t the last of them meets it, too: half of them skip it.
    let steps = |t: u32, a: u32| if t.is_multiple_of(2) && a >= t / 2 { t / 2 } else { t / 2 + 1 };
    let work = |t: u32| (0..t).map(|a| u64::from(steps(t, a))).sum::<u64>();
    let pairs_per_step = u64::from(tile) * u64::from(tile);
    let total: u64 = sizes.iter().map(|&n| work(tiles(n))).sum();
    let job_steps = (total.min(pairs / pairs_per_step) / JOBS_WANTED).clamp(1, u64::from(MAX_STEPS)) as u32;

    let mut all = Vec::new();
    let mut current = Dispatch { realizations: 0..0, jobs: Vec::new() };
    let (mut current_pairs, mut current_points) = (0, 0);
    let close = |current: &mut Dispatch, next: usize, all: &mut Vec<Dispatch>| {
        let done = std::mem::replace(current, Dispatch { realizations: next..next, jobs: Vec::new() });
        if !done.jobs.is_empty() {
            all.push(done);
        }
    };
    for (k, &n) in sizes.iter().enumerate() {
        // Fewer than two points are no pairs, but they lie within the range of a dispatch.
        let t = if n < 2 { 0 } else { tiles(n) };
        let whole = work(t) * pairs_per_step;
        let full = current_pairs + whole > pairs
            || current_points + n > points
            || k - current.realizations.start >= histograms
            || current.jobs.len() + t as usize * (t / 2 + 1).div_ceil(job_steps) as usize > MAX_GROUPS as usize;
        if full {
            close(&mut current, k, &mut all);
            (current_pairs, current_points) = (0, 0);
        }
        current.realizations.end = k + 1;
        let mut first_point = current_points;
        for a in 0..t {
            let mut first_step = 0;
            while first_step < steps(t, a) {
                let count = job_steps.min(steps(t, a) - first_step);
                let cost = u64::from(count) * pairs_per_step;
                let over = current_pairs + cost > pairs || current.jobs.len() >= MAX_GROUPS as usize;
                if over && !current.jobs.is_empty() {
                    close(&mut current, k, &mut all);
                    current.realizations = k..k + 1;
                    (current_pairs, current_points, first_point) = (0, 0, 0);
                }
                current.jobs.push(PairJob {
                    first_point: first_point as u32,
                    points: n as u32,
                    tile: a,
                    first_step,
                    steps: count,
                    histogram: (k - current.realizations.start) as u32,
                });
                current_pairs += cost;
                first_step += count;
            }
        }
        current_points += n;
    }
    close(&mut current, sizes.len(), &mut all);
    all
}

#[cfg(test)]
mod tests {
    use super::super::Tuning;
    use super::*;

    /// Every pair of tiles of every realization in exactly one job, whatever the caps.
    #[test]
    fn dispatches_cover_each_pair_of_tiles_once() {
        let sizes = [0, 1, 2, 300, 256, 5000, 257, 0, 1024, 100, 1];
        for (pairs, points, histograms) in
            [(1, 1 << 20, 100), (1 << 20, 6000, 3), (1 << 40, 1 << 20, 100), (3 << 16, 1 << 20, 1)]
        {
            let mut seen = std::collections::BTreeMap::new();
            for d in dispatches(&sizes, 256, pairs, points, histograms) {
                assert!(d.jobs.len() <= MAX_GROUPS as usize);
                let evaluated: u64 = d.jobs.iter().map(|j| u64::from(j.steps) << 16).sum();
                assert!(evaluated <= pairs || (d.jobs.len() == 1 && d.jobs[0].steps == 1));
                for job in d.jobs {
                    let k = d.realizations.start + job.histogram as usize;
                    assert!(d.realizations.contains(&k));
                    assert_eq!(job.points as usize, sizes[k]);
                    let before: usize = sizes[d.realizations.start..k].iter().sum();
                    assert_eq!(job.first_point as usize, before, "realization {k}");
                    let t = sizes[k].div_ceil(256) as u32;
                    for step in job.first_step..job.first_step + job.steps {
                        let other = (job.tile + step) % t;
                        let key = (k, job.tile.min(other), job.tile.max(other));
                        *seen.entry(key).or_insert(0) += 1;
                    }
                }
            }
            let expected: usize =
                sizes.iter().filter(|&&n| n > 1).map(|n| n.div_ceil(256)).map(|t| t * (t + 1) / 2).sum();
            assert_eq!(seen.len(), expected);
            assert!(seen.values().all(|&c| c == 1));
        }
    }

    #[test]
    fn many_small_realizations_go_together() {
        let t = Tuning::new(false);
        let (points, histograms) = (t.buffer_bytes as usize / 16, t.buffer_bytes as usize / 1024);
        let all = dispatches(&[256; 10_000], 256, t.pairs_per_dispatch, points, histograms);
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].jobs.len(), 10_000);
    }
}

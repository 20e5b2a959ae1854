//! Counts of pairs: plain loops, the exact count over all pairs, and by cells.

use super::{Bench, Scene, Section, Way, error_of, flat, given, naive};
use crate::error::Result;
use crate::plan::{Correction, PairPlan, PairSearch, RadialBins};
use crate::points::Ensemble;

/// Operations of a pair, at least: a difference, a square and a sum for each coordinate.
const FLOP: f64 = 6.0;

/// Random points, and a lattice, on which distances are edges of bins.
pub(super) fn scenes(bench: &Bench<'_>) -> Result<Vec<Scene>> {
    let side = bench.size(50, 100);
    let n = side * side;
    let random = super::sampled("random", n as u64, 1, 2, bench.control)?;
    let at = |k: usize| k as f64 / side as f64;
    let lattice: Vec<_> = (0..n).map(|k| [at(k % side), at(k / side)]).collect();
    Ok(vec![
        scene(bench, format!("pairs of {n} random points"), &random, 256)?,
        // Distances along the axes are edges.
        scene(bench, format!("pairs of a lattice of {side} x {side} points"), &given(&lattice)?, 250)?,
    ])
}

fn scene(bench: &Bench<'_>, name: String, ensemble: &Ensemble, bins: usize) -> Result<Scene> {
    let r_max = 0.25;
    let plan = PairPlan::new(ensemble.domain(), RadialBins::linear(r_max, bins)?, Correction::None, ensemble.shape())?;
    let n = ensemble.points_in(0) as f64;
    // Counts that are expected of random points.
    let expected: Vec<f64> = (0..bins).map(|bin| n * (n - 1.0) * plan.shell_measure(bin)).collect();
    let truth = bench.once(&bench.reference()?, &mut async |on| on.pair_counts(&plan, ensemble).await)?.counts;
    let error = |counts: &[u64]| {
        error_of(counts.iter().zip(&truth).zip(&expected).map(|((&c, &t), e)| (c as f64 - t as f64) / e))
    };
    let all = 0.5 * n * (n - 1.0);
    let points = flat(ensemble);
    let mut ways = Vec::new();
    for (method, count) in [
        ("plain loop, f64", naive::pairs_f64 as fn(&[[f64; 2]], f64, usize) -> Vec<u64>),
        ("plain loop, f32, vectors", naive::pairs_f32),
    ] {
        let (seconds, counts) = bench.plain(|| count(&points, r_max, bins))?;
        ways.push(Way {
            method: method.into(),
            device: bench.machine.cpu.clone(),
            seconds,
            work: Some((1e-9 * all, "pairs")),
            gflop: Some(1e-9 * FLOP * all),
            error: Some(error(&counts)),
            statistical: None,
            front: false,
        });
    }
    for device in &bench.devices {
        let plan = plan.clone().for_device(device.compute().costs().pairs);
        let searches = plan.searches(&plan.device.costs);
        let cells = searches.iter().filter(|search| search.search != PairSearch::All);
        let best = cells.min_by(|a, b| a.seconds.total_cmp(&b.seconds));
        for (method, search) in [("exact, all pairs", searches.first()), ("exact, cells", best)] {
            let Some(search) = search else { continue };
            let plan = PairPlan { search: search.search, ..plan.clone() };
            let (seconds, counts) = bench.timed(device, async |on| on.pair_counts(&plan, ensemble).await)?;
            ways.push(Way {
                method: method.into(),
                device: counts.computed_by.device(),
                seconds,
                // As if all were looked at.
                work: Some((1e-9 * all, "pairs")),
                gflop: Some(1e-9 * FLOP * search.pairs),
                error: Some(error(&counts.counts)),
                statistical: None,
                front: false,
            });
        }
    }
    // Independent points: pairs of a bin are nearly Poisson, and each counts twice.
    let [statistical, _] = error_of(expected.iter().map(|e| (2.0 / e).sqrt()));
    let name = format!("{name}, r < {r_max}, {bins} bins");
    Ok(Scene { name, section: Section::Pairs, error_of: "g, over its bins", ways, statistical })
}

//! How fast points are drawn: millions a second where n is 4096, K = 1000 and 2 threads draw; seconds a set of what takes long, one set
//! a thread. `cargo bench --bench samplers [NAME...]`; `benches/peers/samplers.py` has the generators of others.

use std::time::Instant;

use pairwave::control::Control;
use pairwave::samplers::Process;
use pairwave::{Pool, Result};
use rayon::prelude::*;

/// Name, parameters, n, dimension, realizations.
type Row = (&'static str, &'static [&'static str], u64, usize, u64);

const FAST: &[Row] = &[
    ("random", &[], 4096, 2, 1000),
    ("poisson", &[], 4096, 2, 1000),
    ("jittered", &[], 4096, 2, 1000),
    ("lhs", &[], 4096, 2, 1000),
    ("cell", &[], 4096, 2, 1000),
    ("halton", &[], 4096, 2, 1000),
    ("halton", &["scramble=owen"], 4096, 2, 1000),
    ("hammersley", &[], 4096, 2, 1000),
    ("sobol", &[], 4096, 2, 1000),
    ("pmj02", &[], 4096, 2, 1000),
    ("lattice", &[], 4096, 2, 1000),
    ("kronecker", &[], 4096, 2, 1000),
    ("cmj", &[], 4096, 2, 1000),
    ("perturbed-grid", &[], 4096, 2, 1000),
    ("thomas", &[], 4096, 2, 1000),
    ("matern-cluster", &[], 4096, 2, 1000),
    ("cauchy-cluster", &[], 4096, 2, 1000),
    ("matern-ii", &[], 4096, 2, 200),
    ("lgcp", &[], 4096, 2, 50),
    ("poisson-disk", &[], 4096, 2, 20),
];

const SLOW: &[Row] = &[
    ("maximal-poisson-disk", &[], 4096, 2, 8),
    ("best-candidate", &[], 4096, 2, 2),
    ("lloyd", &[], 4096, 2, 2),
    ("fpo", &[], 1024, 2, 2),
    ("stealthy", &[], 1024, 2, 2),
    ("ginibre", &[], 256, 2, 2),
    ("gaussian-dpp", &[], 1024, 2, 2),
];

fn main() -> Result<()> {
    let only: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let wanted = |row: &&Row| only.is_empty() || only.iter().any(|name| name == row.0);
    let pool = Pool::new(Some(2))?;
    // Seconds, the best of three, and points.
    let time = |&(name, given, n, dim, k): &Row| -> Result<(f64, f64)> {
        let process = Process::new(name, n, k, dim, 1, given)?;
        let control = Control::default();
        let draw = |index| process.coordinates(index, &control).map(|x| (x.len() / dim) as u64);
        let mut best = (f64::INFINITY, 0.0);
        for _ in 0..if k > 10 { 3 } else { 1 } {
            let start = Instant::now();
            let points = pool.install(|| (0..k).into_par_iter().map(draw).sum::<Result<u64>>())?;
            best = (best.0.min(start.elapsed().as_secs_f64()), points as f64);
        }
        Ok(best)
    };
    for row in FAST.iter().filter(wanted) {
        let (seconds, points) = time(row)?;
        println!(
            "{:<22} {:<18} n = {} {}D  {:8.2} M points/s",
            row.0,
            row.1.join(" "),
            row.2,
            row.3,
            points / seconds * 1e-6
        );
    }
    for row in SLOW.iter().filter(wanted) {
        let (seconds, _) = time(row)?;
        // Two at a time, so that a set takes as long as a pair of them.
        println!(
            "{:<22} {:<18} n = {} {}D  {:8.3} s a set",
            row.0,
            row.1.join(" "),
            row.2,
            row.3,
            2.0 * seconds / row.4 as f64
        );
    }
    Ok(())
}

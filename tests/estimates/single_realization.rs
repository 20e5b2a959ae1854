//! How often errors of one realization hold what they promise: 200 realizations, each measured alone, of processes whose g and P
//! are their means.

use crate::common::*;
use crate::shared::cpu;
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::estimate::{ErrorSource, KFunction, Normalization, PairCorrelation, PowerSpectrum, RadialSpectrum};
use pairwave::plan::{Accuracy, Correction, PairPlan, PairSettings, RadialBins};
use pairwave::points::{Domain, Ensemble};
use pairwave::samplers::{Process, Realization};

const RUNS: u64 = 200;

/// Realizations of a process on the unit torus, as they are or as if they had been seen through the window of that size.
fn realizations(sampler: &str, params: &[&str], n: u64, dim: usize, window: bool) -> Vec<Ensemble> {
    let params: Vec<String> = params.iter().map(|p| p.to_string()).collect();
    let p = Process::new(sampler, n, RUNS, dim, 7, &params).unwrap();
    let domain = if window { Domain::window(&vec![(0.0, 1.0); dim]).unwrap() } else { Domain::unit_torus(dim) };
    let one = |index| {
        let points = p.sampler.generate(&Realization { n, dim, seed: 7, index }, &p.values).unwrap();
        ensemble_in(&domain, &[raw(dim, points)])
    };
    (0..RUNS).map(one).collect()
}

/// The part of values within one standard error of the mean of all, at each abscissa.
fn coverage(runs: &[(Vec<f64>, Vec<f64>)]) -> Vec<f64> {
    let mean = |k: usize| runs.iter().map(|(values, _)| values[k]).sum::<f64>() / runs.len() as f64;
    let held = |k: usize| {
        let truth = mean(k);
        runs.iter().filter(|(values, se)| (values[k] - truth).abs() <= se[k]).count() as f64 / runs.len() as f64
    };
    (0..runs[0].0.len()).map(held).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn explore() {
    let which = std::env::var("W").unwrap_or_default();
    let cpu = cpu();
    for (name, params, n, dim, window, bins) in [
        ("random", vec![], 500, 2, true, 24),
        ("jittered", vec![], 1000, 3, true, 24),
        ("random", vec![], 1000, 1, true, 24),
        ("jittered", vec![], 529, 2, false, 24),
        ("thomas", vec![], 500, 2, false, 24),
        ("thomas", vec!["mu=4", "sigma=1"], 1000, 2, false, 24),
        ("thomas", vec!["mu=10", "sigma=2"], 1000, 2, false, 24),
        ("poisson-disk", vec![], 500, 2, false, 24),
        ("random", vec![], 1000, 3, false, 24),
        ("jittered", vec![], 1000, 3, false, 24),
        ("thomas", vec![], 1000, 3, false, 24),
        ("random", vec![], 1000, 1, false, 24),
        ("jittered", vec![], 1000, 1, false, 24),
        ("thomas", vec![], 1000, 1, false, 24),
        ("random", vec![], 1000, 2, true, 24),
        ("jittered", vec![], 1024, 2, true, 24),
        ("thomas", vec![], 1000, 2, true, 24),
    ] {
        if !format!("{name}{n}{dim}{window}").contains(&which) {
            continue;
        }
        let all = realizations(name, &params, n, dim, window);
        let domain = all[0].domain().clone();
        let correction = if window { if std::env::var("C").is_ok() { Correction::Isotropic } else { Correction::Translation } } else { Correction::None };
        let mut runs = [Vec::new(), Vec::new()];
        let (mut rings, mut bands, mut clustered, mut p_clustered, mut held) = (Vec::new(), Vec::new(), 0, 0, Vec::new());
        for e in all {
            let r_max = PairPlan::default_r_max(&domain, n as f64);
            let settings = PairSettings { cumulative: true, ..correction.into() };
            let plan = PairPlan::new(&domain, RadialBins::linear(r_max, bins).unwrap(), settings, shape(&e)).unwrap();
            let counts = wait(cpu.pair_counts(&plan, &e, &Control::default())).unwrap();
            let g = PairCorrelation::new(&plan, &counts, Normalization::Pairs);
            let kf = KFunction::new(&plan, &counts, Normalization::Pairs, n as f64).unwrap();
            clustered += u64::from(g.errors == ErrorSource::ClusterTheory);
            runs[0].push((g.g, g.g_se));
            runs[1].push((kf.k, kf.k_se));
            if !window {
                let f = (5.0 * (n as f64).powf(1.0 / dim as f64)).ceil() as u32;
                let plan = wave_plan(&e, &vec![if dim == 3 { f / 2 } else { f }; dim], Accuracy::Fast);
                let power = wait(cpu.wave_power(&plan, &e, &Control::default())).unwrap();
                let s = RadialSpectrum::new(&plan, &power, &PowerSpectrum::new(&plan, &power));
                p_clustered += u64::from(s.errors == ErrorSource::ClusterTheory);
                rings.push((s.rings.iter().map(|r| r.p).collect::<Vec<_>>(), s.rings.iter().map(|r| r.p_se).collect::<Vec<_>>()));
                bands.push(s.rings.iter().map(|r| r.band.map_or([0.0, 0.0], |b| [b.lo, b.hi])).collect::<Vec<_>>());
            }
        }
        println!("{name} {params:?} n={n} {dim}D window={window} clustered {clustered} {p_clustered}");
        let show = |c: &[f64]| {
            let part = c.len().div_ceil(8);
            let by: Vec<String> = c.chunks(part).map(|c| format!("{:.2}", mean(c))).collect();
            format!("{:.3} [{}]", mean(c), by.join(" "))
        };
        println!("   g {}\n   K {}", show(&coverage(&runs[0])[1..]), show(&coverage(&runs[1])[1..]));
        if !rings.is_empty() {
            println!("   P {}", show(&coverage(&rings)));
            for k in 0..rings[0].0.len() {
                let truth = rings.iter().map(|(p, _)| p[k]).sum::<f64>() / rings.len() as f64;
                held.push(bands.iter().filter(|b| b[k][0] <= truth && truth <= b[k][1]).count() as f64 / bands.len() as f64);
            }
            println!("   band {} min {:.2}", show(&held), held.iter().copied().fold(1.0, f64::min));
        }
    }
}

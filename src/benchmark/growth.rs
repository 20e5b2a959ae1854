//! How times grow with each size of a problem, and how well plans know it.

use super::{Bench, Timing, sampled};
use crate::compute::{Device, cpu::Cpu};
use crate::error::Result;
use crate::estimate::{Measured, PowerLaw, VarianceAt};
use crate::plan::{Accuracy, Correction, PairPlan, RadialBins, WaveGrid, WavePlan};
use crate::points::Ensemble;

/// A problem of one size.
#[derive(Debug, Clone, PartialEq)]
pub struct Grown {
    /// What is computed.
    pub of: &'static str,
    /// What grows.
    pub variable: &'static str,
    /// Its value.
    pub value: f64,
    /// Seconds of the whole problem.
    pub seconds: Timing,
    /// What the plan says; of one thread of the machine its costs were taken on.
    pub planned: f64,
}

/// How the time of a problem grows.
#[derive(Debug, Clone, PartialEq)]
pub struct Exponent {
    /// What is computed.
    pub of: &'static str,
    /// What grows.
    pub variable: &'static str,
    /// The exponent of the times, over the larger half of the values, and its standard error.
    pub measured: Option<[f64; 2]>,
    /// That of the plan, over the same.
    pub planned: Option<f64>,
}

/// A plan may be off by so much, beside what this machine is faster or slower throughout.
pub(super) const OFF: f64 = 0.15;

/// The sizes of a problem of pairs, or of frequencies.
#[derive(Clone, Copy)]
struct Sizes {
    n: u64,
    k: u64,
    bins: usize,
    r_max: f64,
    f: u32,
    threads: usize,
}

/// Measures.
pub(super) fn measure(bench: &Bench<'_>) -> Result<(Vec<Grown>, Vec<Exponent>)> {
    let base = bench.size(
        Sizes { n: 1000, k: 4, bins: 256, r_max: 0.1, f: 32, threads: 1 },
        Sizes { n: 4000, k: 16, bins: 256, r_max: 0.1, f: 64, threads: 1 },
    );
    let doubled = |first: f64, times: u32| (0..times).map(move |e| first * f64::from(1u32 << e));
    let times = bench.size(4, 6);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut all = Vec::new();
    let mut ladder = |of, variable, values: Vec<f64>, set: fn(&mut Sizes, f64)| -> Result<()> {
        for value in values {
            let mut sizes = base;
            set(&mut sizes, value);
            let run = if of == "pairs" { pairs } else { spectrum };
            let (seconds, planned) = run(bench, sizes)?;
            all.push(Grown { of, variable, value, seconds, planned });
        }
        Ok(())
    };
    for of in ["pairs", "spectrum"] {
        ladder(of, "n", doubled(bench.size(500.0, 1000.0), times + 1).collect(), |s, v| s.n = v as u64)?;
        ladder(of, "K", doubled(4.0, times).collect(), |s, v| s.k = v as u64)?;
    }
    ladder("pairs", "bins", doubled(64.0, times).collect(), |s, v| s.bins = v as usize)?;
    ladder("pairs", "r_max", doubled(1.0 / 64.0, times.min(6)).collect(), |s, v| s.r_max = v)?;
    ladder("spectrum", "F", doubled(16.0, times).collect(), |s, v| s.f = v as u32)?;
    for of in ["pairs", "spectrum"] {
        ladder(of, "threads", doubled(1.0, cores.ilog2() + 1).collect(), |s, v| s.threads = v as usize)?;
    }
    let exponents = exponents(&all);
    Ok((all, exponents))
}

fn exponents(all: &[Grown]) -> Vec<Exponent> {
    let mut found: Vec<Exponent> = Vec::new();
    for ladder in all.chunk_by(|a, b| (a.of, a.variable) == (b.of, b.variable)) {
        // What is small is all beginnings.
        let larger = &ladder[(ladder.len() / 2).min(ladder.len().saturating_sub(2))..];
        let fit = |of: fn(&Grown) -> Measured| {
            let at = |grown: &Grown| VarianceAt { n: grown.value, variance: of(grown) };
            PowerLaw::fit(&larger.iter().map(at).collect::<Vec<_>>()).map(|law| [law.slope, law.slope_se])
        };
        let (of, variable) = (ladder[0].of, ladder[0].variable);
        found.push(Exponent {
            of,
            variable,
            measured: fit(|grown| {
                let value = grown.seconds.median;
                Measured { value, se: Some((grown.seconds.most - grown.seconds.least).max(0.05 * value)) }
            }),
            planned: fit(|grown| Measured { value: grown.planned, se: Some(0.05 * grown.planned) })
                .map(|[slope, _]| slope),
        });
    }
    found
}

/// Points, and the CPU path on so many threads.
fn problem(bench: &Bench<'_>, sizes: Sizes) -> Result<(Ensemble, Device)> {
    let threads = Some(sizes.threads);
    Ok((sampled("random", sizes.n, sizes.k, 2, bench.control)?, Device::new(Box::new(Cpu::new(threads)?), threads)?))
}

fn pairs(bench: &Bench<'_>, sizes: Sizes) -> Result<(Timing, f64)> {
    let (ensemble, device) = problem(bench, sizes)?;
    let bins = RadialBins::linear(sizes.r_max, sizes.bins)?;
    let plan = PairPlan::new(ensemble.domain(), bins, Correction::None, ensemble.shape())?;
    let plan = plan.for_device(bench.costs_of(&device).pairs);
    let (seconds, _) = bench.timed(&device, async |on| on.pair_counts(&plan, &ensemble).await)?;
    Ok((seconds, plan.seconds() * sizes.k as f64 / sizes.threads as f64))
}

fn spectrum(bench: &Bench<'_>, sizes: Sizes) -> Result<(Timing, f64)> {
    let (ensemble, device) = problem(bench, sizes)?;
    let grid = WaveGrid::new(&[sizes.f, sizes.f])?;
    let plan = WavePlan::new(ensemble.domain(), grid, Accuracy::Fast, ensemble.shape())?;
    let plan = WavePlan { costs: bench.costs_of(&device).waves, ..plan };
    let (seconds, _) = bench.timed(&device, async |on| on.wave_power(&plan, &ensemble).await)?;
    Ok((seconds, plan.seconds(sizes.n as f64) * sizes.k as f64 / sizes.threads as f64))
}

impl super::Benchmark {
    /// What plans are off by throughout, as a factor: this machine is slower than the one their costs were taken on.
    pub fn pace(&self) -> Option<f64> {
        let mut ratios: Vec<f64> = self.grown.iter().map(|g| g.seconds.median / g.planned).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.get(ratios.len() / 2).copied()
    }

    /// Problems that a plan is off for, beside that, in every run.
    pub fn mispredicted(&self) -> impl Iterator<Item = &Grown> {
        let pace = self.pace().unwrap_or(1.0);
        let off = move |grown: &&Grown| {
            let [least, most] = [grown.seconds.least, grown.seconds.most].map(|s| s / grown.planned / pace);
            least > 1.0 + OFF || most < 1.0 / (1.0 + OFF)
        };
        self.grown.iter().filter(off)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_the_larger_half() {
        let grown = |value: f64| Grown {
            of: "pairs",
            variable: "n",
            value,
            seconds: Timing::of(vec![1e-3 + 1e-9 * value * value]),
            planned: 1e-9 * value,
        };
        let all: Vec<_> = (0..8).map(|e| grown(f64::from(1000 << e))).collect();
        let [found] = &exponents(&all)[..] else { panic!("one ladder") };
        assert!((found.measured.unwrap()[0] - 2.0).abs() < 0.05 && (found.planned.unwrap() - 1.0).abs() < 1e-9);
    }
}

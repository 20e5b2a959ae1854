//! What the parts of methods cost here: many problems are timed by each method, and their times explained by the parts, of which a plan's
//! estimate is the sum.

use std::path::Path;

use super::{Bench, sampled};
use crate::compute::Device;
use crate::error::Result;
use crate::plan::{
    Accuracy, Correction, CostParts, Costs, DeviceCosts, MeasuredCosts, PairPlan, RadialBins, WaveGrid, WaveList,
    WavePlan,
};
use crate::report;

/// A problem by one method, and what is said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Explained {
    /// The device.
    pub device: String,
    /// The problem.
    pub problem: String,
    /// The method.
    pub method: String,
    /// Seconds of a realization, the fastest of several runs.
    pub seconds: f64,
    /// What the costs that are built in say.
    pub built_in: f64,
    /// What the measured ones say.
    pub measured: f64,
    /// Whether the measured ones choose this method for the problem.
    pub chosen: bool,
    /// Whether it is the fastest of those that were timed.
    pub fastest: bool,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The costs.
    pub costs: Costs,
    /// How well they explain what was timed.
    pub explained: Vec<Explained>,
}

/// A timed problem: what each part adds to its estimate where it takes a nanosecond.
struct Row {
    problem: String,
    method: String,
    seconds: f64,
    by_part: Vec<f64>,
}

/// How firmly a part that times say little of stays near the built-in one, beside the squares of relative errors.
const FIRMNESS: f64 = 1e-4;

/// A part is no less than this of the built-in one, times the pace of the machine.
const LEAST: f64 = 0.02;

/// What looks slower than this many times the fastest is not timed: nobody takes it.
const SLOW: f64 = 6.0;

pub(super) fn measure(bench: &Bench<'_>) -> Result<Calibration> {
    let mut explained = Vec::new();
    let mut devices = std::collections::BTreeMap::new();
    for device in &bench.devices {
        let (built_in, name) = (device.compute().costs(), device.compute().costs_name());
        let (pairs, pair_rows) = fit(&pair_rows(bench, device, built_in)?, built_in, |c| c.pairs.costs.parts());
        let (waves, wave_rows) = fit(&wave_rows(bench, device, built_in)?, built_in, |c| c.waves.parts());
        let named = |row: Explained| Explained { device: name.clone(), ..row };
        explained.extend(pair_rows.into_iter().chain(wave_rows).map(named));
        devices.insert(name, MeasuredCosts { pairs, waves });
    }
    let program = concat!("pairwave ", env!("CARGO_PKG_VERSION")).into();
    Ok(Calibration { costs: Costs { program, machine: bench.machine.words(), devices }, explained })
}

/// Searches of problems that differ in what they need most: pairs, rows, cells, ranges.
fn pair_rows(bench: &Bench<'_>, device: &Device, built_in: DeviceCosts) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let large: &[(usize, u64, f64)] =
        bench.size(&[(2, 20_000, 0.02)], &[(2, 20_000, 0.02), (2, 100_000, 0.005), (3, 20_000, 0.1), (2, 20_000, 0.1)]);
    let small = [
        (2, 300, 0.4),
        (2, 1000, 0.1),
        (2, 4000, 0.05),
        (2, 4000, 0.4),
        (3, 1000, 0.2),
        (3, 4000, 0.1),
        (1, 3000, 0.01),
    ];
    for &(dim, n, r_max) in small.iter().chain(large) {
        let k = (8000 / n).max(1);
        let ensemble = sampled("random", n, k, dim, bench.control)?;
        for logarithmic in [false, true] {
            let bins = match logarithmic {
                false => RadialBins::linear(r_max, 256)?,
                true => RadialBins::logarithmic(r_max / 100.0, r_max, 64)?,
            };
            let plan = PairPlan::new(ensemble.domain(), bins, Correction::None, ensemble.shape())?;
            let plan = plan.for_device(built_in.pairs);
            let searches = plan.searches(&built_in.pairs.costs);
            let least = searches.iter().map(|s| s.seconds).fold(f64::INFINITY, f64::min);
            for (at, estimate) in searches.iter().enumerate().filter(|(_, s)| s.seconds <= SLOW * least) {
                let plan = PairPlan { search: estimate.search, ..plan.clone() };
                let (seconds, _) = bench.timed(device, async |on| on.pair_counts(&plan, &ensemble).await)?;
                let by_part =
                    by_part(built_in, |c| c.pairs.costs.parts(), |c| plan.searches(&c.pairs.costs)[at].seconds);
                let kind = if logarithmic { "64 logarithmic bins" } else { "256 bins" };
                rows.push(Row {
                    problem: format!("pairs {dim}D, n = {n}, r < {r_max}, {kind}"),
                    method: estimate.search.to_string(),
                    seconds: seconds.least / k as f64,
                    by_part,
                });
            }
        }
    }
    Ok(rows)
}

/// Spectra of problems that differ in what they need most: tables, products, sums of panels, fine cells.
fn wave_rows(bench: &Bench<'_>, device: &Device, built_in: DeviceCosts) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    let large: &[(&[u32], u64)] = bench.size(
        &[(&[256, 256], 4000)],
        &[(&[256, 256], 4000), (&[256, 256], 65_536), (&[512, 512], 16_384), (&[24, 24, 24], 16_384)],
    );
    let small: [(&[u32], u64); 10] = [
        (&[8, 8], 64),
        (&[32, 32], 40),
        (&[16, 16], 4000),
        (&[64, 64], 64),
        (&[64, 64], 1000),
        (&[64, 64], 16_384),
        (&[128, 128], 500),
        (&[12, 12, 12], 1000),
        (&[1000], 1000),
        (&[8000], 200),
    ];
    for &(f, n) in small.iter().chain(large) {
        let k = (4000 / n).clamp(1, 64);
        let ensemble = sampled("random", n, k, f.len(), bench.control)?;
        for accuracy in [Accuracy::Fast, Accuracy::High] {
            let plan = WavePlan::new(ensemble.domain(), WaveGrid::new(f)?, accuracy, ensemble.shape())?;
            let name = f.iter().map(u32::to_string).collect::<Vec<_>>().join(" x ");
            let problem = format!("P {accuracy}, n = {n}, |m| <= {name}", accuracy = accuracy.name());
            rows.extend(wave_methods(bench, device, built_in, &plan, &ensemble, &problem)?);
        }
    }
    // Lists have but one method, on the CPU path.
    let ensemble = sampled("random", 2000, 2, 2, bench.control)?;
    let vectors = (1..400).map(|m| [f64::from(m), f64::from(m % 7), 0.0]).collect();
    let list = WaveList { dim: 2, vectors, mirrored: false };
    let plan = WavePlan::new(ensemble.domain(), list, Accuracy::Fast, ensemble.shape())?;
    if device.compute().costs_name() == crate::plan::CPU_COSTS {
        rows.extend(wave_methods(bench, device, built_in, &plan, &ensemble, "P of 399 wave vectors, n = 2000")?);
    }
    Ok(rows)
}

fn wave_methods(
    bench: &Bench<'_>,
    device: &Device,
    built_in: DeviceCosts,
    plan: &WavePlan,
    ensemble: &crate::points::Ensemble,
    problem: &str,
) -> Result<Vec<Row>> {
    let n = ensemble.points_in(0) as f64;
    let plan = WavePlan { costs: built_in.waves, ..plan.clone() };
    let methods = plan.methods(n);
    let least = methods.iter().map(|m| m.seconds).fold(f64::INFINITY, f64::min);
    let mut rows = Vec::new();
    for (at, estimate) in methods.iter().enumerate().filter(|(_, m)| m.seconds <= SLOW * least) {
        let one = WavePlan { method: Some(estimate.method), ..plan.clone() };
        let (seconds, _) = bench.timed(device, async |on| on.wave_power(&one, ensemble).await)?;
        let with = |c: &DeviceCosts| WavePlan { costs: c.waves, ..plan.clone() }.methods(n)[at].seconds;
        rows.push(Row {
            problem: problem.into(),
            method: estimate.method.name().into(),
            seconds: seconds.least / ensemble.realizations() as f64,
            by_part: by_part(built_in, |c| c.waves.parts(), with),
        });
    }
    Ok(rows)
}

/// What an estimate is where one part takes a nanosecond and the others nothing: it is the sum of parts.
fn by_part(
    built_in: DeviceCosts,
    parts: impl Fn(&mut DeviceCosts) -> Vec<(&'static str, &mut f64)>,
    estimate: impl Fn(&DeviceCosts) -> f64,
) -> Vec<f64> {
    let mut one = built_in;
    let count = parts(&mut one).len();
    (0..count)
        .map(|only| {
            parts(&mut one).into_iter().enumerate().for_each(|(at, (_, part))| *part = f64::from(u8::from(at == only)));
            estimate(&one)
        })
        .collect()
}

/// Parts by which estimates are nearest to the times, in the squares of relative errors, and what they say.
fn fit(
    rows: &[Row],
    mut built_in: DeviceCosts,
    parts: impl Fn(&mut DeviceCosts) -> Vec<(&'static str, &mut f64)>,
) -> (CostParts, Vec<Explained>) {
    let names: Vec<&str> = parts(&mut built_in).iter().map(|(name, _)| *name).collect();
    let before: Vec<f64> = parts(&mut built_in).iter().map(|(_, part)| **part).collect();
    let sum = |row: &Row, parts: &[f64]| row.by_part.iter().zip(parts).map(|(a, b)| a * b).sum::<f64>();
    let mut paces: Vec<f64> = rows.iter().map(|row| row.seconds / sum(row, &before)).collect();
    paces.sort_by(f64::total_cmp);
    let pace = paces.get(paces.len() / 2).copied().unwrap_or(1.0);
    // In units of the built-in part at the pace of the machine, of which each relative estimate is a sum.
    let design: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| row.by_part.iter().zip(&before).map(|(a, b)| a * b * pace / row.seconds).collect())
        .collect();
    let factors = nonnegative_least_squares(&design, FIRMNESS * rows.len() as f64, before.len());
    let after: Vec<f64> = before.iter().zip(&factors).map(|(part, factor)| part * pace * factor).collect();
    let explained = rows.iter().map(|row| {
        let (seconds, measured) = (row.seconds, sum(row, &after));
        let of_problem = || rows.iter().filter(|other| other.problem == row.problem);
        Explained {
            device: String::new(),
            problem: row.problem.clone(),
            method: row.method.clone(),
            seconds,
            built_in: sum(row, &before),
            measured,
            chosen: of_problem().all(|other| sum(other, &after) >= measured),
            fastest: of_problem().all(|other| other.seconds >= seconds),
        }
    });
    let explained = explained.collect();
    (names.into_iter().map(String::from).zip(after).collect(), explained)
}

/// x that makes `sum_j (sum_i a_ji x_i - 1)^2 + firmness sum_i (x_i - 1)^2` least, no x below `LEAST`: coordinate by coordinate.
fn nonnegative_least_squares(design: &[Vec<f64>], firmness: f64, unknowns: usize) -> Vec<f64> {
    let mut x = vec![1.0; unknowns];
    let mut left: Vec<f64> = design.iter().map(|row| 1.0 - row.iter().sum::<f64>()).collect();
    for _ in 0..2000 {
        for i in 0..unknowns {
            let (mut slope, mut curvature) = (firmness * (1.0 - x[i]), firmness);
            for (row, left) in design.iter().zip(&left) {
                slope += row[i] * left;
                curvature += row[i] * row[i];
            }
            let to = (x[i] + slope / curvature).max(LEAST);
            let step = to - x[i];
            if step.is_finite() {
                x[i] = to;
                design.iter().zip(&mut left).for_each(|(row, left)| *left -= row[i] * step);
            }
        }
    }
    x
}

impl Calibration {
    /// Writes the costs into a file, which `costs` of a request names.
    ///
    /// # Errors
    /// What the file system says; a file that is there, without `force`.
    pub fn write(&self, path: &Path, force: bool) -> Result<()> {
        let text = serde_json::to_string_pretty(&self.costs).unwrap_or_default() + "\n";
        report::write_file(path, text.as_bytes(), force)
    }

    /// Problems whose time the measured costs miss by more than a plan may be off.
    pub fn missed(&self) -> impl Iterator<Item = &Explained> {
        self.explained.iter().filter(|e| {
            let ratio = e.seconds / e.measured;
            !(1.0 / (1.0 + super::growth::OFF)..=1.0 + super::growth::OFF).contains(&ratio)
        })
    }

    /// How much longer than the fastest of those timed the chosen ways take, at worst, by these costs.
    pub fn worst_choice(&self) -> f64 {
        let fastest = |of: &Explained| {
            let same = |e: &&Explained| e.fastest && e.problem == of.problem && e.device == of.device;
            self.explained.iter().find(same).map_or(of.seconds, |e| e.seconds)
        };
        self.explained.iter().filter(|e| e.chosen).map(|e| e.seconds / fastest(e)).fold(1.0, f64::max)
    }

    /// The median of how far measured, and built-in costs at the pace of the machine, are from the times, as factors above 1.
    pub fn typical_errors(&self) -> [f64; 2] {
        let median = |mut ratios: Vec<f64>| {
            ratios.sort_by(f64::total_cmp);
            ratios.get(ratios.len() / 2).copied().unwrap_or(1.0)
        };
        let off = |estimate: &dyn Fn(&Explained) -> f64| {
            let pace = median(self.explained.iter().map(|e| e.seconds / estimate(e)).collect());
            median(self.explained.iter().map(|e| (e.seconds / estimate(e) / pace).ln().abs().exp()).collect())
        };
        [off(&|e| e.measured), off(&|e| e.built_in)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times that are sums of parts give the parts back.
    #[test]
    fn parts_are_found_from_times() {
        let truth = [0.3, 2.0, 30.0, 0.1, 60.0, 20.0, 9.0];
        let mut state = 1u64;
        let mut any = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        let rows: Vec<Row> = (0..60)
            .map(|k| {
                let by_part: Vec<f64> = truth.iter().map(|part| 1e-9 * any() / part).collect();
                let seconds = by_part.iter().zip(truth).map(|(a, b)| a * b).sum();
                Row { problem: format!("{}", k / 2), method: String::new(), seconds, by_part }
            })
            .collect();
        let (found, explained) = fit(&rows, DeviceCosts::CPU, |c| c.pairs.costs.parts());
        let mut built_in = DeviceCosts::CPU;
        for ((name, _), truth) in built_in.pairs.costs.parts().into_iter().zip(truth) {
            assert!((found[name] / truth - 1.0).abs() < 0.1, "{name}: {} against {truth}", found[name]);
        }
        let calibration = Calibration {
            costs: Costs { program: String::new(), machine: String::new(), devices: Default::default() },
            explained,
        };
        assert_eq!(calibration.missed().count(), 0);
        assert!(calibration.worst_choice() < 1.05 && calibration.typical_errors()[0] < 1.02);
        // Costs that are none of this machine's miss.
        let wrong: Vec<_> =
            calibration.explained.iter().map(|e| Explained { measured: 2.0 * e.measured, ..e.clone() }).collect();
        assert_eq!(Calibration { explained: wrong, ..calibration }.missed().count(), 60);
    }
}

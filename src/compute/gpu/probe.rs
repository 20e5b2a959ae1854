//! The self-check of a device: the real kernels on tiny inputs, against the reference. A driver's compiler may rearrange
//! arithmetic in ways no specification forbids; a device that does so here is refused.

use std::fmt;

use super::GpuCompute;
use super::buffers::Fill;
use super::kernel::{self, KernelSpec};
use super::params::{PROBE, ProbeInput, ProbeOutput, ProbeParams};
use super::wave_power;
use crate::compute::Compute;
use crate::compute::reference::Reference;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{
    Accuracy, Correction, EnsembleShape, GPU_WEIGHT_BOUND, LagGrid, LagPlan, PairPlan, RadialBins, WaveGrid, WavePlan,
};
use crate::points::{Domain, Ensemble, RawPoints};

const NAME: &str = "probe";
const F64: &str = "power in f64";
const WORKGROUP: u32 = 64;

/// One question and its answer.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Check {
    /// What was asked.
    pub name: &'static str,
    /// Whether the device does it right.
    pub passed: bool,
    /// What was found.
    pub found: String,
    /// Whether a device that does it wrong is refused; else it is not asked for what needs it.
    pub required: bool,
}

/// What the self-check found.
#[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize)]
pub struct Verdict {
    /// In the order they were asked.
    pub checks: Vec<Check>,
}

impl Verdict {
    /// Whether every required check passed (and there were some).
    pub fn passed(&self) -> bool {
        !self.checks.is_empty() && self.checks.iter().all(|c| c.passed || !c.required)
    }

    /// Why f64 on this device cannot be relied on, if so.
    ///
    /// # Errors
    /// Why it has none.
    pub fn f64(&self) -> Result<(), String> {
        match self.checks.iter().find(|c| c.name == F64) {
            Some(check) if check.passed => Ok(()),
            Some(check) => Err(check.found.clone()),
            None => Err("it was not checked".into()),
        }
    }

    /// The required checks that failed, in one line.
    pub fn failures(&self) -> String {
        let failed = self.checks.iter().filter(|c| !c.passed && c.required);
        failed.map(|c| format!("{}: {}", c.name, c.found)).collect::<Vec<_>>().join("; ")
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for check in &self.checks {
            let word = match (check.passed, check.required) {
                (true, _) => "ok",
                (false, true) => "FAILED",
                (false, false) => "none",
            };
            writeln!(f, "{word:6} {}: {}", check.name, check.found)?;
        }
        Ok(())
    }
}

pub(super) fn spec() -> KernelSpec {
    KernelSpec {
        name: NAME,
        files: vec![kernel::PHASE, kernel::TWO_FLOAT, kernel::PROBE],
        overrides: vec![("WORKGROUP", WORKGROUP)],
        bindings: PROBE,
    }
}

/// Asks everything. A check that cannot run is a check that failed.
pub(super) async fn check(compute: &GpuCompute) -> Verdict {
    let mut verdict = Verdict::default();
    let mut ask = |name, result: Result<Result<String, String>>| {
        let required = name != F64;
        let (passed, found) = match result {
            Ok(Ok(found)) => (true, found),
            Ok(Err(found)) => (false, found),
            Err(e) => (false, e.to_string()),
        };
        verdict.checks.push(Check { name, passed, found, required });
    };
    ask("compensated sums, cosine and sine", arithmetic(compute).await);
    ask("pairs on bin edges, square torus", edge_pairs(compute).await);
    ask("pairs in logarithmic bins, unequal sides", box_pairs(compute).await);
    ask("pairs over several tiles", tiled_pairs(compute).await);
    ask("pairs over several wide tiles, bins in global memory", wide_pairs(compute).await);
    ask("pairs of points sorted into cells", cell_pairs(compute).await);
    ask("edge weights in a window", edge_weights(compute).await);
    ask("lags on edges", edge_lags(compute).await);
    ask("power of a rank-1 lattice", lattice_power(compute).await);
    ask("power over several chunks of points", chunked_power(compute).await);
    ask("power in three dimensions", box_power(compute).await);
    ask("power of weighted points", weighted_power(compute).await);
    ask(F64, precise_power(compute).await);
    verdict
}

/// A reproducible sequence of 32-bit numbers (PCG hash) without the weight of a sampler.
fn hash(i: u32) -> u32 {
    let state = i.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

fn unit(i: u32) -> f64 {
    f64::from(hash(i)) / 4_294_967_296.0
}

async fn arithmetic(compute: &GpuCompute) -> Result<Result<String, String>> {
    let inputs: Vec<ProbeInput> = (0..1024)
        .map(|i| ProbeInput {
            a: ((unit(4 * i) - 0.5) * 1e4) as f32,
            b: (unit(4 * i + 1) - 0.5) as f32,
            // Every eighth of a turn and its neighbours, then anywhere.
            phase: if i < 24 {
                (i / 3).wrapping_mul(1 << 29).wrapping_add(i % 3).wrapping_sub(1)
            } else {
                hash(4 * i + 2)
            },
            reserved: 0,
        })
        .collect();
    let gpu = compute.gpu();
    let kernel = compute.kernel(spec()).await?;
    let outputs: Vec<ProbeOutput> = gpu
        .guarded(NAME, async || {
            let count = inputs.len() as u32;
            let params = gpu.uniform("params", &ProbeParams { count, ..ProbeParams::default() });
            let given = gpu.upload("inputs", &inputs, Fill::Zero);
            let outputs = gpu.scratch("outputs", size_of_val(inputs.as_slice()) as u64, Fill::Poison);
            let mut encoder = gpu.encoder(NAME);
            kernel.dispatch(gpu, &mut encoder, &[&params, &given, &outputs], count.div_ceil(WORKGROUP));
            gpu.read_back(NAME, encoder, &outputs, inputs.len()).await
        })
        .await?;
    let mut lost = 0;
    let mut worst = 0f64;
    for (given, out) in inputs.iter().zip(&outputs) {
        // Both sides are exact in f64.
        if f64::from(given.a) + f64::from(given.b) != f64::from(out.sum) + f64::from(out.error) {
            lost += 1;
        }
        let angle = f64::from(given.phase) / 4_294_967_296.0 * std::f64::consts::TAU;
        let error = (f64::from(out.cos) - angle.cos()).abs().max((f64::from(out.sin) - angle.sin()).abs());
        // Written so that NaN stays.
        worst = if error <= worst { worst } else { error };
    }
    let found =
        format!("{lost} of {} sums lose their error term, cosine and sine are off by {worst:.1e}", inputs.len());
    Ok(if lost == 0 && worst <= 1.3e-7 { Ok(found) } else { Err(found) })
}

fn ensemble(domain: &Domain, sets: &[Vec<f64>]) -> Result<(Ensemble, EnsembleShape)> {
    let dim = domain.dim();
    let raw: Vec<RawPoints> = sets
        .iter()
        .map(|c| RawPoints { dim, coordinates: c.clone(), source: "self-check".into(), lines: Vec::new() })
        .collect();
    let ensemble = Ensemble::from_raw(&raw, domain, true, 0)?;
    let sizes: Vec<usize> = raw.iter().map(RawPoints::len).collect();
    let shape = EnsembleShape {
        realizations: sizes.len() as u64,
        mean_points: sizes.iter().sum::<usize>() as f64 / sizes.len() as f64,
        max_points: sizes.iter().copied().max().unwrap_or(0) as u64,
    };
    Ok((ensemble, shape))
}

async fn pairs(
    compute: &GpuCompute,
    domain: &Domain,
    bins: RadialBins,
    sets: &[Vec<f64>],
) -> Result<Result<String, String>> {
    pairs_as_if(compute, domain, bins, sets, |_| ()).await
}

/// As if the realizations were of another shape: kernels differ with it.
async fn pairs_as_if(
    compute: &GpuCompute,
    domain: &Domain,
    bins: RadialBins,
    sets: &[Vec<f64>],
    as_if: impl FnOnce(&mut EnsembleShape),
) -> Result<Result<String, String>> {
    let (ensemble, mut shape) = ensemble(domain, sets)?;
    as_if(&mut shape);
    let plan = PairPlan::new(domain, bins, Correction::None, shape)?.for_device(compute.costs().pairs);
    let truth = Reference.pair_counts(&plan, &ensemble, &Control::default()).await?;
    let here = compute.pair_counts(&plan, &ensemble, &Control::default()).await?;
    let total: u64 = truth.counts.iter().sum();
    let wrong = truth.counts.iter().zip(&here.counts).filter(|(a, b)| a != b).count();
    if wrong == 0 && truth.bins == here.bins {
        Ok(Ok(format!("{total} ordered pairs, all in their bins")))
    } else {
        Ok(Err(format!("{wrong} of {} bins are wrong", truth.counts.len())))
    }
}

/// Points of a grid of 20 x 20 steps, in bins whose edges are multiples of the step.
async fn edge_pairs(compute: &GpuCompute) -> Result<Result<String, String>> {
    let set =
        |n: u32| (0..n).flat_map(|i| [f64::from(hash(2 * i) % 20) / 20.0, f64::from(hash(2 * i + 1) % 20) / 20.0]);
    pairs(compute, &Domain::unit_torus(2), RadialBins::linear(0.5, 20)?, &[set(90).collect(), set(31).collect()]).await
}

fn uniform(n: u32, dim: u32) -> Vec<f64> {
    (0..dim * n).map(unit).collect()
}

async fn tiled_pairs(compute: &GpuCompute) -> Result<Result<String, String>> {
    pairs(compute, &Domain::unit_torus(2), RadialBins::linear(0.4, 100)?, &[uniform(1100, 2), uniform(300, 2)]).await
}

async fn wide_pairs(compute: &GpuCompute) -> Result<Result<String, String>> {
    let bins = RadialBins::linear(0.3, 20_000)?;
    pairs_as_if(compute, &Domain::unit_torus(3), bins, &[uniform(1100, 3)], |shape| shape.max_points = 1 << 20).await
}

/// A plan for large sets looks for pairs in cells.
async fn cell_pairs(compute: &GpuCompute) -> Result<Result<String, String>> {
    let sets = [uniform(900, 2), uniform(1, 2), uniform(250, 2)];
    pairs_as_if(compute, &Domain::unit_torus(2), RadialBins::linear(0.06, 50)?, &sets, |shape| shape.mean_points = 1e6)
        .await
}

async fn box_pairs(compute: &GpuCompute) -> Result<Result<String, String>> {
    let sides = [1.0, 0.7, 1.3];
    let set = |n: u32| (0..3 * n).map(|i| unit(i) * sides[i as usize % 3]).collect();
    pairs(compute, &Domain::torus(&sides)?, RadialBins::logarithmic(0.01, 0.35, 12)?, &[set(70), set(1), set(40)]).await
}

/// Isotropic weights: everything that f32 does to weights is in them.
async fn edge_weights(compute: &GpuCompute) -> Result<Result<String, String>> {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)])?;
    let (ensemble, shape) = ensemble(&window, &[uniform(200, 2)])?;
    let (mut worst, mut exact) = (0f64, true);
    for (correction, r_max) in [(Correction::Isotropic, 0.7), (Correction::Translation, 0.7), (Correction::Border, 0.4)]
    {
        let bins = RadialBins::linear(r_max, 300)?;
        let plan = PairPlan::new(&window, bins, correction, shape)?.for_device(compute.costs().pairs);
        let truth = Reference.pair_counts(&plan, &ensemble, &Control::default()).await?;
        let here = compute.pair_counts(&plan, &ensemble, &Control::default()).await?;
        for (&a, &b) in truth.bins.sums.iter().zip(&here.bins.sums) {
            worst = worst.max(a.abs_diff(b) as f64 / (a as f64).max(1.0));
        }
        exact &= truth.counts == here.counts && (plan.weighted() || truth.bins == here.bins);
    }
    let found = format!("sums are off by {worst:.1e}, promised {GPU_WEIGHT_BOUND:.0e}");
    Ok(if worst <= GPU_WEIGHT_BOUND && exact { Ok(found) } else { Err(found) })
}

/// Lags of a lattice on a torus of unequal sides, on edges and of half a period, and of scattered points.
async fn edge_lags(compute: &GpuCompute) -> Result<Result<String, String>> {
    let torus = Domain::torus(&[1.0, 0.75])?;
    let lattice = (0..64u32).flat_map(|i| [f64::from(i % 8) / 8.0, f64::from(i / 8) * 0.75 / 8.0]).collect();
    let (ensemble, shape) = ensemble(&torus, &[lattice, uniform(300, 2)])?;
    let plan = LagPlan::new(&torus, LagGrid::new(&torus, 16, None)?, Correction::None, None, shape)?;
    let truth = Reference.lag_counts(&plan, &ensemble, &Control::default()).await?;
    let here = compute.lag_counts(&plan, &ensemble, &Control::default()).await?;
    let wrong = truth.cells.sums.iter().zip(&here.cells.sums).filter(|(a, b)| a != b).count();
    let found = format!("{wrong} of {} cells are wrong", truth.cells.sums.len());
    Ok(if wrong == 0 { Ok(found) } else { Err(found) })
}

async fn power(
    compute: &GpuCompute,
    domain: &Domain,
    grid: &[u32],
    sets: &[Vec<f64>],
) -> Result<Result<String, String>> {
    let (ensemble, shape) = ensemble(domain, sets)?;
    power_of(compute, grid, Accuracy::Fast, &ensemble, shape).await
}

async fn power_of(
    compute: &GpuCompute,
    grid: &[u32],
    accuracy: Accuracy,
    ensemble: &Ensemble,
    shape: EnsembleShape,
) -> Result<Result<String, String>> {
    let domain = ensemble.domain();
    let plan = WavePlan::new(domain, WaveGrid::new(grid)?, accuracy, shape)?;
    let truth = Reference.wave_power(&plan, ensemble, &Control::default()).await?.mode_totals();
    let here = wave_power::wave_power(compute, &plan, ensemble, &|_, _| (), &Control::default()).await?.mode_totals();
    let n: f64 = (0..ensemble.realizations()).map(|k| ensemble.norm(k)).sum();
    let (mut worst, mut zero) = (0f64, 0f64);
    for (a, b) in truth.q.iter().zip(&here.q) {
        let error = (a - b).abs() / (n + a);
        // Written so that NaN stays.
        worst = if error <= worst { worst } else { error };
        if a / n < 1e-26 {
            zero = zero.max(b / n);
        }
    }
    let bound = accuracy.power_bound();
    let found = format!("|P - P_ref| <= {worst:.1e} (1 + P), promised {:.0e}; {zero:.1e} for 0", bound.max_uniform);
    Ok(if worst <= bound.max_uniform && zero <= bound.lattice_zero { Ok(found) } else { Err(found) })
}

async fn lattice_power(compute: &GpuCompute) -> Result<Result<String, String>> {
    let set = (0..144u32).flat_map(|i| [f64::from(i) / 144.0, f64::from(i * 89 % 144) / 144.0]).collect();
    power(compute, &Domain::unit_torus(2), &[24, 24], &[set]).await
}

async fn chunked_power(compute: &GpuCompute) -> Result<Result<String, String>> {
    power(compute, &Domain::unit_torus(2), &[5, 4], &[uniform(4500, 2), uniform(2049, 2)]).await
}

async fn box_power(compute: &GpuCompute) -> Result<Result<String, String>> {
    let sides = [1.0, 0.7, 1.3];
    let set = |n: u32| (0..3 * n).map(|i| unit(i) * sides[i as usize % 3]).collect();
    power(compute, &Domain::torus(&sides)?, &[5, 4, 3], &[set(50), set(20)]).await
}

async fn weighted_power(compute: &GpuCompute) -> Result<Result<String, String>> {
    let (ensemble, shape) = ensemble(&Domain::unit_torus(2), &[uniform(300, 2), uniform(90, 2)])?;
    let weights: Vec<f64> = (0..390).map(|i| unit(7 * i + 3) - 0.4).collect();
    power_of(compute, &[9, 8], Accuracy::Fast, &ensemble.with_weights(&weights), shape).await
}

/// A lattice with zeros and scattered points with weights, in three dimensions: all that the kernels in f64 do.
async fn precise_power(compute: &GpuCompute) -> Result<Result<String, String>> {
    if !compute.gpu().has_f64() {
        return Ok(Err("the adapter has no SHADER_F64".into()));
    }
    let lattice = (0..128u32).flat_map(|i| [i, i * 45 % 128].map(|x| f64::from(x) / 128.0)).collect();
    let (ensemble_2, shape_2) = ensemble(&Domain::unit_torus(2), &[lattice])?;
    let zeros = power_of(compute, &[24, 24], Accuracy::High, &ensemble_2, shape_2).await?;
    // Fractions of more than 32 bits.
    let fine = |n: u32| (0..3 * n).map(|i| unit(i) + unit(i + 9) / 4_294_967_296.0).collect();
    let (ensemble_3, shape_3) = ensemble(&Domain::unit_torus(3), &[fine(1100), fine(40)])?;
    let weights: Vec<f64> = (0..1140).map(|i| unit(7 * i + 3) - 0.4).collect();
    let scattered = power_of(compute, &[4, 3, 2], Accuracy::High, &ensemble_3.with_weights(&weights), shape_3).await?;
    Ok(zeros.and_then(|zeros| scattered.map(|scattered| format!("{zeros}; with weights {scattered}"))))
}

//! The power spectrum: by the definition, directly in f32 and f64, by transforms of several tolerances, and by a part of the modes.

use super::{Bench, Scene, Section, Way, error_of, flat, given, naive, sampled};
use crate::compute::Device;
use crate::error::Result;
use crate::estimate::{PowerSpectrum, RadialSpectrum};
use crate::plan::{Accuracy, PANEL, WaveGrid, WaveList, WaveMethod, WavePlan, WaveVectors};
use crate::points::Ensemble;

/// Modes at which sums by the definition are taken: the others take as long.
const LOOKED_AT: usize = 512;

/// Points of panels, and tolerances of transforms.
const PANELS: [usize; 4] = [16, 40, 80, PANEL];
const TOLERANCES: [f64; 6] = [1e-3, 1e-6, 1e-9, 1e-11, 1e-13, 4e-15];

pub(super) fn scenes(bench: &Bench<'_>) -> Result<Vec<Scene>> {
    let (n, f) = bench.size((256, 32), (1024, 64));
    let few = sampled("random", n, 1, 2, bench.control)?;
    let mut scenes = vec![scene(bench, format!("P of {n} random points, |m| <= {f}"), &few, f)?];
    let (n, f) = bench.size((4096, 32), (65_536, 64));
    let many = sampled("random", n, 1, 2, bench.control)?;
    scenes.push(scene(bench, format!("P of {n} random points, |m| <= {f}"), &many, f)?);
    // A lattice, each point moved by a thousandth of its cell: P is from 1e-11 up.
    let side = bench.size(32, 128);
    let moved = flat(&sampled("random", side * side, 1, 2, bench.control)?);
    let lattice: Vec<_> = (0..side * side)
        .zip(moved)
        .map(|(k, by)| {
            let cell = [(k % side) as f64, (k / side) as f64];
            [0, 1].map(|a| (cell[a] + 1e-3 * by[a]) / side as f64)
        })
        .collect();
    let name = format!("P of a lattice of {side} x {side} points moved by 1e-3 of a cell, |m| <= {f}");
    scenes.push(scene(bench, name, &given(&lattice)?, f)?);
    scenes.push(rings(bench, &few, bench.size(32, 64))?);
    Ok(scenes)
}

/// Modes far apart in the order in which they are stored; none is DC.
fn looked_at(grid: &WaveGrid) -> Vec<usize> {
    let (modes, dc) = (grid.half_len(), grid.dc());
    let step = crate::compute::coprime_from(modes / LOOKED_AT + 1, modes);
    (0..modes.min(LOOKED_AT)).map(|k| k * step % modes).filter(|&index| index != dc).collect()
}

fn scene(bench: &Bench<'_>, name: String, ensemble: &Ensemble, f: u32) -> Result<Scene> {
    let grid = WaveGrid::new(&[f, f])?;
    let (domain, shape) = (ensemble.domain(), ensemble.shape());
    let n = ensemble.points_in(0) as f64;
    let indices = looked_at(&grid);
    let vectors = indices.iter().map(|&index| grid.mode(index).map(f64::from)).collect();
    let list = WavePlan::new(domain, WaveList { dim: 2, vectors, mirrored: true }, Accuracy::High, shape)?;
    let truth = bench.once(&bench.reference()?, &mut async |on| on.wave_power(&list, ensemble).await)?.mode_totals().q;
    // As promised: relative to 1 + P.
    let error = |power: &mut dyn Iterator<Item = f64>| error_of(power.zip(&truth).map(|(q, t)| (q - t) / (n + t)));
    let mut ways = Vec::new();
    let modes = grid.half_len() as f64;
    let waves: Vec<[i32; 2]> = indices.iter().map(|&index| grid.mode(index)).map(|[x, y, _]| [x, y]).collect();
    let points = flat(ensemble);
    for (method, power) in [
        ("sine and cosine of each term, f64", naive::power_f64 as fn(&[[f64; 2]], &[[i32; 2]]) -> Vec<f64>),
        ("sine and cosine of each term, f32", naive::power_f32),
    ] {
        let (seconds, power) = bench.plain(|| power(&points, &waves))?;
        ways.push(Way {
            method: method.into(),
            device: bench.machine.cpu.clone(),
            seconds: seconds.each(waves.len() as f64 / modes),
            work: Some((1e-9 * n * modes, "terms")),
            gflop: None,
            error: Some(error(&mut power.into_iter())),
            statistical: None,
            front: false,
        });
    }
    for device in &bench.devices {
        for (method, plan) in methods(device, &WavePlan::new(domain, grid, Accuracy::Fast, shape)?) {
            let (seconds, sums) = bench.timed(device, async |on| on.wave_power(&plan, ensemble).await)?;
            let all = sums.mode_totals().q;
            ways.push(Way {
                method,
                device: sums.computed_by.device(),
                seconds,
                work: Some((1e-9 * n * modes, "terms")),
                gflop: gflop(&plan),
                error: Some(error(&mut indices.iter().map(|&index| all[index]))),
                statistical: None,
                front: false,
            });
        }
    }
    // P of one realization is exponential about its mean.
    let [statistical, _] = error_of(truth.iter().map(|t| t / (n + t)));
    Ok(Scene { name, section: Section::Spectrum, error_of: "P over 1 + P, over modes", ways, statistical })
}

/// Operations of a direct product, in 1e9; one in f64 takes the place of two in f32.
fn gflop(plan: &WavePlan) -> Option<f64> {
    match plan.method? {
        WaveMethod::DirectF32 => Some(1e-9 * plan.flop()),
        WaveMethod::DirectF64 => Some(2e-9 * plan.flop()),
        WaveMethod::Nufft => None,
    }
}

/// The ways of a device to the same modes.
fn methods(device: &Device, plan: &WavePlan) -> Vec<(String, WavePlan)> {
    let of = |method| WavePlan { method: Some(method), costs: device.compute().costs().waves, ..plan.clone() };
    let high = |plan: WavePlan| WavePlan { accuracy: Accuracy::High, ..plan };
    if device.compute().pool().is_none() {
        // Panels are those of the kernel.
        return vec![
            ("direct, f32".into(), of(WaveMethod::DirectF32)),
            ("direct, f64".into(), high(of(WaveMethod::DirectF64))),
        ];
    }
    let direct = |panel| (format!("direct, f32, panels of {panel}"), WavePlan { panel, ..of(WaveMethod::DirectF32) });
    let transform = |tolerance| (format!("NUFFT, {tolerance:.0e}"), WavePlan { tolerance, ..of(WaveMethod::Nufft) });
    let mut all: Vec<_> = PANELS.map(direct).into();
    all.push(("direct, f64".into(), high(of(WaveMethod::DirectF64))));
    all.extend(TOLERANCES.map(transform));
    all
}

/// The radial mean by all modes and by a part of them.
fn rings(bench: &Bench<'_>, ensemble: &Ensemble, f: u32) -> Result<Scene> {
    let (domain, shape) = (ensemble.domain(), ensemble.shape());
    let device = &bench.devices[0];
    let full = WavePlan::new(domain, WaveGrid::new(&[f, f])?, Accuracy::Fast, shape)?;
    let mut plans = vec![("all modes".to_string(), WavePlan { rings_only: true, ..full })];
    for directions in [4, 16, 64] {
        let list = WaveList::ring_directions(domain, &[f, f], directions)?;
        let plan = WavePlan::new(domain, WaveVectors::List(list), Accuracy::Fast, shape)?;
        plans.push((format!("some modes, {directions} directions"), plan));
    }
    let (mut ways, mut statistical) = (Vec::new(), None);
    for (method, plan) in plans {
        let (seconds, sums) = bench.timed(device, async |on| on.wave_power(&plan, ensemble).await)?;
        let spectrum = PowerSpectrum::new(&plan, &sums);
        let rings = RadialSpectrum::new(&plan, &sums, &spectrum).rings;
        // Fewer modes are a smaller sample: there is nothing but chance.
        let [chance, _] = error_of(rings.iter().map(|ring| ring.p_se));
        statistical.get_or_insert(chance);
        ways.push(Way {
            method,
            device: sums.computed_by.device(),
            seconds,
            work: None,
            gflop: None,
            error: None,
            statistical: Some(chance),
            front: false,
        });
    }
    let name = format!("radial mean of P of {} random points, |m| <= {f}", ensemble.points_in(0));
    Ok(Scene {
        name,
        section: Section::Spectrum,
        error_of: "P, over rings",
        ways,
        statistical: statistical.unwrap_or(0.0),
    })
}

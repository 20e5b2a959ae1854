//! Tapered spectra: every taper is a spectrum of weighted points. Formula: see `reference`.

use super::Cpu;
use super::nufft::{Nonuniform, Scratch};
use super::wave_power::{WavePoints, amplitudes};
use crate::accumulate::WavePower;
use crate::compute::Compute;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Debias, TaperPlan, WaveMethod, WavePlan, WaveVectors};
use crate::points::Ensemble;

/// One realization after the other, each by all threads.
pub(super) fn tapered_power(
    cpu: &Cpu,
    plan: &WavePlan,
    taper: &TaperPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<WavePower> {
    let dim = plan.waves.dim();
    let tapers = taper.all(dim);
    let mut sums = WavePower::new(cpu.computed_by(), plan.waves.len(), &plan.rings);
    let mut of_taper = vec![[0.0; 2]; plan.waves.len()];
    let mut scratch = Scratch::default();
    for k in 0..ensemble.realizations() {
        let points = WavePoints::of(ensemble, k, &plan.waves);
        let weights = points.weights;
        // s_0 without a taper, which is what the transform of the window is multiplied with.
        let total: f64 = weights.map_or(ensemble.points_in(k) as f64, |w| w.iter().sum());
        let mut power = vec![0.0; plan.waves.len()];
        for &orders in &tapers {
            control.advance(1.0 / (tapers.len() * ensemble.realizations()) as f64);
            let mut tapered: Vec<f64> =
                (0..ensemble.points_in(k)).map(|j| taper.value(orders, &points.axes, j)).collect();
            if let Some(weights) = weights {
                tapered.iter_mut().zip(weights).for_each(|(t, w)| *t *= w);
            }
            match (&plan.waves, plan.method(ensemble.points_in(k))) {
                (WaveVectors::Grid(grid), WaveMethod::Nufft) => {
                    let about = WaveMethod::about(ensemble.points_in(k) as f64) as usize;
                    let tolerance = plan.tolerance;
                    let nufft = cpu.nuffts.get(grid, tolerance, about, cpu.level(), plan.memory)?;
                    let spread = Nonuniform { axes: &points.axes, weights: Some(&tapered) };
                    nufft.components(&spread, &mut scratch, Some(&cpu.pool), control, &mut of_taper)?;
                }
                _ => amplitudes(cpu, &plan.waves, &points.weighted(&tapered), &mut of_taper, control)?,
            }
            let mean = |m: usize| taper.transform(orders, plan.waves.vector(m), dim).map(|f| total * f);
            let modes = power.iter_mut().zip(&of_taper);
            match taper.debias {
                Debias::None => modes.for_each(|(q, [re, im])| *q += re * re + im * im),
                Debias::Direct => modes.enumerate().for_each(|(m, (q, [re, im]))| {
                    let [mean_re, mean_im] = mean(m);
                    *q += (re - mean_re).powi(2) + (im - mean_im).powi(2);
                }),
                Debias::Undirect => modes.enumerate().for_each(|(m, (q, [re, im]))| {
                    let [mean_re, mean_im] = mean(m);
                    *q += re * re + im * im - mean_re * mean_re - mean_im * mean_im;
                }),
            }
        }
        let count = tapers.len() as f64;
        power.iter_mut().for_each(|q| *q /= count);
        sums.add(ensemble.first_index() + k as u64, ensemble.norm(k), &power, &plan.rings);
    }
    sums.close_leaf();
    Ok(sums)
}

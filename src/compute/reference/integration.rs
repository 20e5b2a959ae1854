//! Integration errors, by the definition.
//!
//! For points `x_1 .. x_n` in the unit torus and an integrand f with Fourier coefficients `f_m` and periodic autocorrelation a:
//!
//! ```text
//! S    = sum_j f(x_j)
//! s_m  = sum_j exp(-2 pi i m.x_j)
//! grid = sum_(0 != |m_k| <= F_k) |f_m|^2 |s_m|^2        axes: one component not 0, beyond F
//! pairs = sum_(i < j) (a(x_i - x_j) - I^2)
//! shifted = means over shifts t of S(t) - n I and its square
//! low  = Re sum_m conj(f_m) s_m and sum |f_m|^2 |s_m|^2 over 0 != |m_k| <= B
//! ```
//!
//! The mean over all shifts of `(S(t)/n - I)^2` is `sum_(m != 0) |f_m|^2 |s_m|^2 / n^2 = (n (int f^2 - I^2) + 2 pairs) / n^2`, whatever the
//! points. Lags are differences of coordinates as they were given.

use super::Reference;
use super::phases::Places;
use super::wave_power::{amplitudes, wave_power};
use crate::accumulate::{IntegrandSums, IntegrationSums, RealizationSums, WavePower};
use crate::compute::Compute;
use crate::compute::compensated::total;
use crate::compute::shifts::{random_shift, wrapped};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{IntegrationPlan, PairSum, WavePlan};
use crate::points::Ensemble;

pub(super) fn integration(plan: &IntegrationPlan, ensemble: &Ensemble, control: &Control) -> Result<IntegrationSums> {
    let by = Reference.computed_by();
    let none = |waves: &WavePlan| WavePower::new(by.clone(), waves.waves.len(), &waves.rings);
    let mut all = IntegrationSums {
        grid: none(&plan.grid),
        axes: plan.axes.iter().map(none).collect(),
        integrands: plan.integrands.len(),
        realizations: Vec::new(),
    };
    let dim = plan.domain.dim();
    for k in 0..ensemble.realizations() {
        let (index, n) = (ensemble.first_index() + k as u64, ensemble.points_in(k));
        let norm = n as f64;
        let places = Places::of(ensemble, k);
        let power = wave_power(&plan.grid.waves, &places, None, control)?;
        let mut on_axes = Vec::new();
        for (a, waves) in plan.axes.iter().enumerate() {
            let line = ensemble.on_axis(a, &waves.domain);
            on_axes.push(wave_power(&waves.waves, &Places::of(&line, k), None, control)?);
        }
        let low = amplitudes(&plan.low.into(), &places, None, control)?;
        let points: Vec<Vec<f64>> = (0..n).map(|j| places.fractions(j).into_iter().map(wrapped).collect()).collect();
        let mut each = Vec::new();
        for integrand in plan.integrands.iter() {
            control.check()?;
            let at = |shift: &[f64]| {
                let moved = |x: &Vec<f64>| x.iter().zip(shift).map(|(x, t)| wrapped(x + t)).collect::<Vec<_>>();
                total(points.iter().map(|x| integrand.value(&moved(x))))
            };
            let weighted = |waves: &WavePlan, power: &[f64], vector: &dyn Fn([i32; 3]) -> Option<[i32; 3]>| {
                let grid = waves.waves.grid();
                let of = |grid: &crate::plan::WaveGrid| {
                    let one = |(at, q): (usize, &f64)| {
                        let m = vector(grid.mode(at))?;
                        Some(f64::from(grid.multiplicity(at)) * integrand.coefficient(&m[..dim]).norm_sqr() * q)
                    };
                    total(power.iter().enumerate().filter_map(one))
                };
                grid.map_or(0.0, of)
            };
            let nonzero = |m: [i32; 3]| (m != [0; 3]).then_some(m);
            let frequencies = plan.max_frequency();
            let beyond = |a: usize| {
                move |m: [i32; 3]| {
                    let mut vector = [0; 3];
                    vector[a] = m[0];
                    (m[0] > frequencies[a] as i32).then_some(vector)
                }
            };
            let axes = plan.axes.iter().zip(&on_axes).enumerate();
            let offset = random_shift(index);
            let shifts: Vec<f64> = plan
                .shifts
                .chunks_exact(dim)
                .map(|t| {
                    let t: Vec<f64> = t.iter().zip(offset).map(|(t, offset)| wrapped(t + offset)).collect();
                    at(&t) - norm * integrand.integral()
                })
                .collect();
            let square = integrand.integral().powi(2);
            let lag = |i: usize, j: usize| points[i].iter().zip(&points[j]).map(|(x, y)| x - y).collect::<Vec<f64>>();
            let pairs = || {
                total(
                    (0..n)
                        .flat_map(|i| (0..i).map(move |j| (i, j)))
                        .map(|(i, j)| integrand.autocorrelation(&lag(i, j)) - square),
                )
            };
            let f = |at: usize| integrand.coefficient(&plan.low.mode(at)[..dim]);
            let times = |at: usize| if at == plan.low.dc() { 0.0 } else { f64::from(plan.low.multiplicity(at)) };
            let of_low = |part: &dyn Fn(usize, [f64; 2]) -> f64| {
                total(low.iter().enumerate().map(|(at, s)| times(at) * part(at, *s)))
            };
            each.push(IntegrandSums {
                values: at(&vec![0.0; dim]),
                grid: weighted(&plan.grid, &power, &nonzero),
                axes: axes.map(|(a, (waves, power))| weighted(waves, power, &beyond(a))).sum(),
                pairs: if plan.pairs == PairSum::None { 0.0 } else { pairs() },
                shifted: [
                    total(shifts.iter().copied()) / shifts.len() as f64,
                    total(shifts.iter().map(|e| e * e)) / shifts.len() as f64,
                ],
                low: [
                    of_low(&|at, [re, im]| f(at).re * re + f(at).im * im),
                    of_low(&|at, [re, im]| f(at).norm_sqr() * (re * re + im * im)),
                ],
            });
        }
        all.grid.add(index, norm, &power, &plan.grid.rings);
        for ((sums, waves), power) in all.axes.iter_mut().zip(&plan.axes).zip(&on_axes) {
            sums.add(index, norm, power, &waves.rings);
        }
        all.realizations.push(RealizationSums { index, n: n as u64, each });
    }
    all.grid.close_leaf();
    all.axes.iter_mut().for_each(WavePower::close_leaf);
    Ok(all)
}

//! Integration errors, by the definition.
//!
//! For points `x_1 .. x_n` in the unit torus, weights w (1 where none are given; s, S and pairs have `w_j` and `w_i w_j`) and an integrand f with Fourier coefficients `f_m` and periodic autocorrelation a:
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
//! points. Of points that are kept, each with probability `q(x_j)`: `error = sum_kept f/q - n I` (of ratios `sum_kept f/q / sum_kept 1/q - I`, or by
//! their number), `given = sum_j f^2 (1/q - 1)`, and means over shifts of the error and its square. Lags are differences of coordinates as they were given.

use super::Reference;
use super::phases::Places;
use super::wave_power::{amplitudes, wave_power};
use crate::accumulate::{IntegrandSums, IntegrationSums, KeptSums, RealizationSums, RemovalSums, WavePower};
use crate::compute::Compute;
use crate::compute::compensated::total;
use crate::compute::shifts::{lot, random_shift, weighted, weights, wrapped};
use crate::control::Control;
use crate::error::Result;
use crate::integrand::Integrand;
use crate::plan::{Estimator, IntegrationPlan, PairSum, Removal, WavePlan};
use crate::points::Ensemble;

pub(super) fn integration(plan: &IntegrationPlan, ensemble: &Ensemble, control: &Control) -> Result<IntegrationSums> {
    let ensemble = weighted(plan, ensemble)?;
    let unit = ensemble.weight_unit();
    let by = Reference.computed_by();
    let none = |waves: &WavePlan| WavePower::new(by.clone(), waves.waves.len(), &waves.rings);
    let mut all = IntegrationSums {
        grid: none(&plan.grid),
        axes: plan.axes.iter().map(none).collect(),
        integrands: plan.integrands.len(),
        unit,
        lags: Vec::new(),
        realizations: Vec::new(),
    };
    let dim = plan.domain.dim();
    for k in 0..ensemble.realizations() {
        let (index, n) = (ensemble.first_index() + k as u64, ensemble.points_in(k));
        let (scaled, weights) = (ensemble.weights(k), weights(&ensemble, k).unwrap_or_else(|| vec![1.0; n]));
        let (weight, square) = (total(weights.iter().copied()), total(weights.iter().map(|w| w * w)));
        let places = Places::of(&ensemble, k);
        let power = wave_power(&plan.grid.waves, &places, scaled, control)?;
        let mut on_axes = Vec::new();
        for (a, waves) in plan.axes.iter().enumerate() {
            let line = ensemble.on_axis(a, &waves.domain);
            on_axes.push(wave_power(&waves.waves, &Places::of(&line, k), scaled, control)?);
        }
        let low = amplitudes(&plan.low.into(), &places, scaled, control)?;
        let points: Vec<Vec<f64>> = (0..n).map(|j| places.fractions(j).into_iter().map(wrapped).collect()).collect();
        let mut each = Vec::new();
        for integrand in plan.averaged.iter() {
            control.check()?;
            let at = |shift: &[f64]| {
                let moved = |x: &Vec<f64>| x.iter().zip(shift).map(|(x, t)| wrapped(x + t)).collect::<Vec<_>>();
                total(points.iter().zip(&weights).map(|(x, w)| w * integrand.value(&moved(x))))
            };
            let weighted = |waves: &WavePlan, power: &[f64], vector: &dyn Fn([i32; 3]) -> Option<[i32; 3]>| {
                let grid = waves.waves.grid();
                let of = |grid: &crate::plan::WaveGrid| {
                    let one = |(at, q): (usize, &f64)| {
                        let m = vector(grid.mode(at))?;
                        Some(
                            f64::from(grid.multiplicity(at))
                                * integrand.coefficient(&m[..dim]).norm_sqr()
                                * q
                                * unit
                                * unit,
                        )
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
                    at(&t) - weight * integrand.integral()
                })
                .collect();
            let square = integrand.integral().powi(2);
            let lag = |i: usize, j: usize| points[i].iter().zip(&points[j]).map(|(x, y)| x - y).collect::<Vec<f64>>();
            let pairs = || {
                total(
                    (0..n)
                        .flat_map(|i| (0..i).map(move |j| (i, j)))
                        .map(|(i, j)| weights[i] * weights[j] * (integrand.autocorrelation(&lag(i, j)) - square)),
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
                    unit * of_low(&|at, [re, im]| f(at).re * re + f(at).im * im),
                    unit * unit * of_low(&|at, [re, im]| f(at).norm_sqr() * (re * re + im * im)),
                ],
            });
        }
        let removal = plan.removal().map(|removal| removed(plan, removal, index, &points)).transpose()?;
        let norm = ensemble.norm(k);
        all.grid.add(index, norm, &power, &plan.grid.rings);
        for ((sums, waves), power) in all.axes.iter_mut().zip(&plan.axes).zip(&on_axes) {
            sums.add(index, norm, power, &waves.rings);
        }
        all.realizations.push(RealizationSums { index, n: n as u64, weight, square, each, removal });
    }
    all.grid.close_leaf();
    all.axes.iter_mut().for_each(WavePower::close_leaf);
    Ok(all)
}

/// What points that are kept estimate.
fn removed(plan: &IntegrationPlan, removal: &Removal, index: u64, points: &[Vec<f64>]) -> Result<RemovalSums> {
    let dim = plan.domain.dim();
    let q = |x: &[f64]| removal.density.value(x) / removal.maximum;
    let padded = |x: &[f64]| std::array::from_fn(|a| x.get(a).copied().unwrap_or(0.0));
    let kept = |shift: u64, places: &[Vec<f64>]| -> Vec<usize> {
        (0..places.len()).filter(|&j| lot(index, shift, j, &padded(&places[j])) < q(&places[j])).collect()
    };
    let error = |f: &Integrand, places: &[Vec<f64>], kept: &[usize]| {
        let sum = total(kept.iter().map(|&j| f.value(&places[j]) / q(&places[j])));
        match plan.estimator {
            Estimator::Mean | Estimator::Lambda => Some(sum - places.len() as f64 * f.integral()),
            _ if kept.is_empty() => None,
            Estimator::Ratio => Some(sum / total(kept.iter().map(|&j| 1.0 / q(&places[j]))) - f.integral()),
            Estimator::CountRatio => Some(sum / kept.len() as f64 * removal.kept - f.integral()),
        }
    };
    let offset = random_shift(index);
    let moved: Vec<Vec<Vec<f64>>> = (plan.shifts.chunks_exact(dim))
        .map(|t| {
            let t: Vec<f64> = t.iter().zip(offset).map(|(t, offset)| wrapped(t + offset)).collect();
            points.iter().map(|x| x.iter().zip(&t).map(|(x, t)| wrapped(x + t)).collect()).collect()
        })
        .collect();
    let drawn: Vec<Vec<usize>> = moved.iter().zip(1..).map(|(places, shift)| kept(shift, places)).collect();
    let here = kept(0, points);
    let one = |f: &Integrand| {
        let errors: Vec<f64> = moved.iter().zip(&drawn).filter_map(|(places, kept)| error(f, places, kept)).collect();
        let count = errors.len().max(1) as f64;
        let square = |x: &Vec<f64>| match f.value(x) {
            0.0 => 0.0,
            value => value * value * (1.0 / q(x) - 1.0),
        };
        KeptSums {
            error: error(f, points, &here).unwrap_or(0.0),
            given: total(points.iter().map(square)),
            shifted: [total(errors.iter().copied()) / count, total(errors.iter().map(|e| e * e)) / count],
        }
    };
    let shifts = drawn
        .iter()
        .filter(|kept| plan.estimator == Estimator::Mean || plan.estimator == Estimator::Lambda || !kept.is_empty());
    let shifts = shifts.count() as u64;
    Ok(RemovalSums { kept: here.len() as u64, shifts, each: plan.integrands.iter().map(one).collect() })
}

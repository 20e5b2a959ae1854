//! Where integrands are looked at: points as fractions of the box, their random shifts, what they weigh, and which are kept.

use std::borrow::Cow;

use crate::error::{Error, Result};
use crate::integrand::Integrand;
use crate::plan::{Importance, IntegrationPlan};
use crate::points::Ensemble;
use crate::setting::Setting;

/// Coordinates of realization `k` as fractions of the box, point by point, as they were given: whether a point is inside of a set is
/// decided by them, not by integers near them.
pub(super) fn places(ensemble: &Ensemble, k: usize) -> Vec<[f64; 3]> {
    let domain = ensemble.domain();
    let mut places = vec![[0.0; 3]; ensemble.points_in(k)];
    for a in 0..domain.dim() {
        let mut put = |j: usize, x: f64| places[j][a] = wrapped(x);
        match ensemble.coordinates(k) {
            Some(given) => {
                let (origin, side) = (domain.origin()[a], domain.sides()[a]);
                given[a].iter().enumerate().for_each(|(j, x)| put(j, (x - origin) / side));
            }
            None => ensemble.turns(k, a).enumerate().for_each(|(j, x)| put(j, x)),
        }
    }
    places
}

/// `x` folded into [0, 1).
pub(super) fn wrapped(x: f64) -> f64 {
    if (0.0..1.0).contains(&x) {
        return x;
    }
    let folded = x - x.floor();
    // The rest of a tiny negative number rounds to 1.
    if folded < 1.0 { folded } else { 0.0 }
}

/// The random shift of a realization: SplitMix64 of its index in the batch, so that it depends on nothing else.
pub(super) fn random_shift(index: u64) -> [f64; 3] {
    let mut state = index.wrapping_mul(3).wrapping_add(SEED);
    std::array::from_fn(|_| {
        state = state.wrapping_add(STEP);
        unit(mix(state))
    })
}

const SEED: u64 = 0x5851_f42d_4c95_7f2d;

/// Of SplitMix64: what its state grows by.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// Of SplitMix64: bits of a state, mixed.
fn mix(state: u64) -> u64 {
    let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// 53 bits as a number in [0, 1).
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * 2f64.powi(-53)
}

/// What the points of the first realization weigh that are kept by a density of this largest value, over what the parents weigh; 0 of
/// those that are not kept.
pub(crate) fn kept(ensemble: &Ensemble, density: &Integrand, maximum: f64) -> Vec<f64> {
    let places = places(ensemble, 0);
    let mut q = vec![0.0; places.len()];
    density.values(&places, &mut q);
    let keeps = |j: usize, q: f64| lot(ensemble.first_index(), 0, j, &places[j]) < q;
    q.iter().map(|q| q / maximum).enumerate().map(|(j, q)| if keeps(j, q) { 1.0 / q } else { 0.0 }).collect()
}

/// What they weigh where they are as dense as this.
pub(crate) fn over_density(ensemble: &Ensemble, density: &Integrand) -> Vec<f64> {
    let places = places(ensemble, 0);
    let mut values = vec![0.0; places.len()];
    density.values(&places, &mut values);
    values.into_iter().map(|value| if value > 0.0 { 1.0 / value } else { 0.0 }).collect()
}

/// Number in [0, 1) by which a point is kept or removed: SplitMix64 of the realization, the shift, the point and where it lies, so that
/// points of another seed are not kept by the same numbers.
pub(super) fn lot(index: u64, shift: u64, point: usize, x: &[f64; 3]) -> f64 {
    let words = [index, shift, point as u64, x[0].to_bits(), x[1].to_bits(), x[2].to_bits()];
    let mixed =
        words.iter().fold(SEED, |state, word| mix(state.wrapping_add(STEP) ^ word.wrapping_mul(0xd129_0b5a_3c95_1e3d)));
    unit(mixed)
}

/// What every point weighs, as it was given; `None` where that is 1.
pub(super) fn weights(ensemble: &Ensemble, k: usize) -> Option<Vec<f64>> {
    let unit = ensemble.weight_unit();
    ensemble.weights(k).map(|w| w.iter().map(|w| w * unit).collect())
}

/// One over the intensity at every point of a realization.
fn inverse_intensity(intensity: &Integrand, ensemble: &Ensemble, k: usize) -> Result<Vec<f64>> {
    let places = places(ensemble, k);
    let mut densities = vec![0.0; places.len()];
    intensity.values(&places, &mut densities);
    if let Some(j) = densities.iter().position(|d| d.is_nan() || *d <= 0.0) {
        let reason = format!(
            "is {} at {:?}, point {} of realization {}; expected it above 0 wherever there are points",
            densities[j],
            &places[j][..intensity.dim()],
            j + 1,
            ensemble.first_index() + k as u64 + 1
        );
        return Err(Error::setting(Setting::Intensity, intensity.spec(), reason));
    }
    Ok(densities.into_iter().map(|d| 1.0 / d).collect())
}

/// The same points with the weights that the plan gives them, in units of a power of two that is the same for every batch.
pub(super) fn weighted<'a>(plan: &IntegrationPlan, ensemble: &'a Ensemble) -> Result<Cow<'a, Ensemble>> {
    if let Some(Importance::Known(intensity)) = &plan.importance {
        let all = (0..ensemble.realizations()).map(|k| inverse_intensity(intensity, ensemble, k));
        let all = all.collect::<Result<Vec<_>>>()?.concat();
        return Ok(Cow::Owned(ensemble.clone().with_weights_of(&all, 1.0 / intensity.integral())));
    }
    if !plan.weighted || ensemble.weights(0).is_none() {
        return Ok(ensemble.unweighted());
    }
    let unit = ensemble.weight_unit();
    if !(1e-100..1e100).contains(&unit) {
        let reason = format!(
            "are of the size of {unit:e}: the squares of sums with them are no numbers; expected some between 1e-100 and 1e100"
        );
        return Err(Error::setting(Setting::WeightColumn, "weights", reason));
    }
    Ok(Cow::Borrowed(ensemble))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 10,000 shifts, a hundredth of a side has 100 along each axis, to five times their scatter.
    #[test]
    fn random_shifts_are_all_over_a_side() {
        let mut parts = [[0i32; 100]; 3];
        for shift in (0..10_000).map(random_shift) {
            parts.iter_mut().zip(shift).for_each(|(parts, x)| parts[(x * 100.0) as usize] += 1);
        }
        assert!(parts.iter().flatten().all(|n| (n - 100).abs() <= 50), "{parts:?}");
    }
}

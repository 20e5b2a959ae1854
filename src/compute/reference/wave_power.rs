//! The power spectrum, by the definition.
//!
//! For points `x_1 .. x_n` with weights `w_j` (1 where there are none) in a box with sides `L`, and wave vectors `m` in cycles
//! per side (integers on a torus):
//!
//! ```text
//! s_m = sum_j w_j exp(-2 pi i m . x_j / L)        q_m = |s_m|^2        P(m) = E q_m / E sum_j w_j^2
//! ```
//!
//! (periodogram; e.g. Heck, Schloemer, Deussen, "Blue Noise Sampling with Controlled Aliasing", TOG 2013, eq. 2, up to the
//! name of n), x from the corner of the box. `phases` says how `m . x_j / L mod 1` is found from coordinates as they were
//! given; only that and the sine and cosine are rounded, to f64. Sums are compensated (Neumaier), so that the error does not grow with n.

use super::phases::Places;
use crate::control::Control;
use crate::error::Result;
use crate::plan::WaveVectors;

/// `|s_m|^2` for every stored mode.
pub(super) fn wave_power(
    waves: &WaveVectors,
    places: &Places<'_>,
    weights: Option<&[f64]>,
    control: &Control,
) -> Result<Vec<f64>> {
    Ok(amplitudes(waves, places, weights, control)?.into_iter().map(|[re, im]| re * re + im * im).collect())
}

/// `s_m`, real and imaginary part, for every stored mode.
pub(super) fn amplitudes(
    waves: &WaveVectors,
    places: &Places<'_>,
    weights: Option<&[f64]>,
    control: &Control,
) -> Result<Vec<[f64; 2]>> {
    let mut amplitudes = Vec::with_capacity(waves.len());
    for index in 0..waves.len() {
        control.check()?;
        let m = waves.vector(index);
        let (mut re, mut im) = ([0.0; 2], [0.0; 2]);
        for j in 0..places.len() {
            let (sin, cos) = (std::f64::consts::TAU * places.turns(m, j)).sin_cos();
            let weight = weights.map_or(1.0, |w| w[j]);
            add(&mut re, weight * cos);
            add(&mut im, -weight * sin);
        }
        amplitudes.push([re[0] + re[1], im[0] + im[1]]);
    }
    Ok(amplitudes)
}

/// Adds to a sum and its rounding error (Neumaier 1974).
fn add([sum, error]: &mut [f64; 2], x: f64) {
    let next = *sum + x;
    *error += if sum.abs() >= x.abs() { (*sum - next) + x } else { (x - next) + *sum };
    *sum = next;
}

//! The spectrum of a window, tapered and debiased.
//!
//! For points `x_1 .. x_n` of intensity `rho = n / |W|` in a window W, a taper t with `integral_W t^2 = 1`, and any real k:
//!
//! ```text
//! S(k) = |sum_j t(x_j) exp(-i k . x_j) - rho F[t](k)|^2 / rho             direct
//! S(k) = |sum_j t(x_j) exp(-i k . x_j)|^2 / rho - rho |F[t](k)|^2         undirect
//! S(k) = |sum_j t(x_j) exp(-i k . x_j)|^2 / rho                           none
//! ```
//!
//! and its mean over several tapers (Hawat, Gautier, Bardenet & Lachieze-Rey, "On estimating the structure factor of a point
//! process, with applications to hyperuniformity", 2023, sections 3.1 and 3.2). With `f = t sqrt |W|` and F over the unit cube
//! (`TaperPlan`), q = n S is `|sum_j f(x_j) exp(..) - n F|^2`, so that sums of q over realizations are compared with sums of n
//! as everywhere. Where points have weights w_j, f(x_j) is `w_j f(x_j)` and n in front of F their sum.

use super::phases::Places;
use super::wave_power::amplitudes;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Debias, TaperPlan, WaveVectors};

/// q at every stored mode of one realization.
pub(super) fn tapered_power(
    taper: &TaperPlan,
    waves: &WaveVectors,
    places: &Places<'_>,
    weights: Option<&[f64]>,
    control: &Control,
) -> Result<Vec<f64>> {
    let (dim, points) = (waves.dim(), places.len());
    let weight = |j: usize| weights.map_or(1.0, |w| w[j]);
    let total: f64 = (0..points).map(weight).sum();
    let tapers = taper.all(dim);
    let mut power = vec![0.0; waves.len()];
    for &orders in &tapers {
        let tapered: Vec<f64> = (0..points).map(|j| weight(j) * taper.value_at(orders, &places.fractions(j))).collect();
        let amplitudes = amplitudes(waves, places, Some(&tapered), control)?;
        for (index, (power, [re, im])) in power.iter_mut().zip(amplitudes).enumerate() {
            let [mean_re, mean_im] = taper.transform(orders, waves.vector(index), dim).map(|f| total * f);
            *power += match taper.debias {
                Debias::Direct => (re - mean_re).powi(2) + (im - mean_im).powi(2),
                Debias::Undirect => re * re + im * im - mean_re * mean_re - mean_im * mean_im,
                Debias::None => re * re + im * im,
            };
        }
    }
    let count = tapers.len() as f64;
    Ok(power.into_iter().map(|q| q / count).collect())
}

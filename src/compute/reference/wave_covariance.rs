//! The covariance of amplitudes, by the definition.
//!
//! With `s_m` as in `wave_power`, over realizations:
//!
//! ```text
//! C_ml = E[s_m conj(s_l)] / E sum_j w_j^2
//! ```
//!
//! Its diagonal is P. For a stationary process a shift by t multiplies `s_m conj(s_l)` by `exp(-2 pi i (m - l) . t / L)`, so
//! its expectation is 0 unless `m = l` (Pilleboue et al., "Variance Analysis for Monte Carlo Integration", TOG 2015, section
//! 4: what randomly shifted samplers leave out of the variance).
//!
//! Weights are real, so `s_{-m} = conj(s_m)`: the products of real and imaginary parts of one of each pair m, -m give all
//! elements. `s_m conj(s_l) = Re Re + Im Im + i (Im Re - Re Im)`.

use crate::accumulate::CovarianceSums;

/// Adds a realization: every product of two components, with and without its norm, and of two powers.
pub(super) fn add(sums: &mut CovarianceSums, amplitudes: &[[f64; 2]], norm: f64) {
    let stored = amplitudes.len();
    let component = |a: usize| amplitudes[a % stored][a / stored];
    let power = |a: usize| amplitudes[a][0] * amplitudes[a][0] + amplitudes[a][1] * amplitudes[a][1];
    for a in 0..2 * stored {
        for b in 0..2 * stored {
            sums.products[a * 2 * stored + b] += component(a) * component(b);
            sums.products_n[a * 2 * stored + b] += component(a) * component(b) * norm;
        }
    }
    for a in 0..stored {
        for b in 0..stored {
            sums.powers[a * stored + b] += power(a) * power(b);
        }
    }
    sums.add_norm(norm);
}

//! Gaussian densities about a place, averaged over directions: what pairs with Gaussian offsets have for g.

use std::f64::consts::PI;

use crate::ball::mean_over_directions;

/// The density at distance `r` from the origin, averaged over directions, of a Gaussian about a place `far` from it, with
/// `variance` per axis; 0 where it is below 1e-26 of its largest.
pub(super) fn about(dim: usize, variance: f64, r: f64, far: f64) -> f64 {
    // exp(-(r^2 + far^2 - 2 r far cos t) / 2 variance) = exp(-(r - far)^2 / ..) exp(-steepness (1 - cos t)).
    let nearest = (r - far).powi(2) / (2.0 * variance);
    if nearest >= REACH {
        return 0.0;
    }
    (-nearest).exp() * mean_over_directions(dim, r * far / variance) / (2.0 * PI * variance).powf(dim as f64 / 2.0)
}

/// Beyond this many times twice the variance, the square of a distance is out of reach.
pub(super) const REACH: f64 = 60.0;

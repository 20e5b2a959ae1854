//! Gaussian densities about a place, averaged over directions: what pairs with Gaussian offsets have for g.

use std::f64::consts::PI;

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

/// The mean of `exp(-steepness (1 - cos t))` over directions, t the angle to a fixed one.
fn mean_over_directions(dim: usize, steepness: f64) -> f64 {
    match dim {
        _ if steepness == 0.0 => 1.0,
        1 => (1.0 + (-2.0 * steepness).exp()) / 2.0,
        2 => bessel_i0_scaled(steepness),
        // cos t is uniform in [-1, 1].
        _ => -(-2.0 * steepness).exp_m1() / (2.0 * steepness),
    }
}

/// `exp(-x) I_0(x)`, I_0 the modified Bessel function, to rounding: its mean over the circle by the midpoint rule, which for an
/// entire function converges faster than any power, and from 700 on by the asymptotic series (Abramowitz, Stegun 9.7.1).
fn bessel_i0_scaled(x: f64) -> f64 {
    if x > 700.0 {
        let mut term = 1.0;
        let series: f64 = (1..12)
            .map(|k| {
                let odd = f64::from(2 * k - 1);
                term *= odd * odd / (8.0 * f64::from(k) * x);
                term
            })
            .sum();
        return (1.0 + series) / (2.0 * PI * x).sqrt();
    }
    let steps = 256;
    let angle = |i: u32| PI * (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(|i| (-x * (1.0 - angle(i).cos())).exp()).sum::<f64>() / f64::from(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bessel_function_has_its_values() {
        // scipy.special.ive(0, x).
        for (x, known) in [
            (0.5, 0.6450352704491501),
            (30.0, 0.07314594648223727),
            (699.0, 0.015092083422186379),
            (701.0, 0.015070530981047305),
        ] {
            let found = bessel_i0_scaled(x);
            assert!((found / known - 1.0).abs() < 1e-13, "{x}: {found} against {known}");
        }
    }
}

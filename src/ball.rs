//! Balls and directions in 1, 2 and 3 dimensions.

use std::f64::consts::PI;

/// The measure of the unit ball.
pub(crate) fn unit_ball(dim: usize) -> f64 {
    match dim {
        1 => 2.0,
        2 => PI,
        _ => 4.0 / 3.0 * PI,
    }
}

/// The mean of `exp(-steepness (1 - cos t))` over directions, t the angle to a fixed one.
pub(crate) fn mean_over_directions(dim: usize, steepness: f64) -> f64 {
    match dim {
        1 => (1.0 + (-2.0 * steepness).exp()) / 2.0,
        2 => bessel_i0_scaled(steepness),
        // cos t is uniform in [-1, 1].
        _ if steepness < 1e-9 => 1.0 - steepness,
        _ => -(-2.0 * steepness).exp_m1() / (2.0 * steepness),
    }
}

/// `exp(-x) I_0(x)`, I_0 the modified Bessel function, to rounding: its mean over the circle by the midpoint rule, which for an
/// entire function converges faster than any power, and from 700 on by the asymptotic series (Abramowitz, Stegun 9.7.1).
fn bessel_i0_scaled(x: f64) -> f64 {
    if x > 700.0 {
        let mut term = 1.0;
        let next = |k: i32| {
            let odd = f64::from(2 * k - 1);
            term *= odd * odd / (8.0 * f64::from(k) * x);
            term
        };
        return (1.0 + (1..12).map(next).sum::<f64>()) / (2.0 * PI * x).sqrt();
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
            (0.0, 1.0),
            (0.5, 0.6450352704491501),
            (30.0, 0.07314594648223727),
            (699.0, 0.015092083422186379),
            (701.0, 0.015070530981047305),
        ] {
            let found = bessel_i0_scaled(x);
            assert!((found / known - 1.0).abs() < 1e-13, "{x}: {found} against {known}");
        }
    }

    /// Against a fine sum over the angle.
    #[test]
    fn the_mean_over_a_sphere() {
        for steepness in [0.0, 1e-10, 0.3, 4.0, 200.0] {
            let steps = 20_000;
            let at = |t: f64| 0.5 * t.sin() * (-steepness * (1.0 - t.cos())).exp();
            let sum: f64 = (0..steps).map(|i| at(PI * (f64::from(i) + 0.5) / f64::from(steps))).sum();
            let (found, expected) = (mean_over_directions(3, steepness), sum * PI / f64::from(steps));
            assert!((found / expected - 1.0).abs() < 1e-5, "{steepness}: {found}, expected {expected}");
        }
    }
}

//! The transform of a box.

use std::f64::consts::PI;

/// `sin(pi x) / (pi x)`, exactly 0 at integers other than 0.
pub(crate) fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { sin_pi(x) / (PI * x) }
}

/// `sin(pi x)`, exactly 0 at integers.
pub(crate) fn sin_pi(x: f64) -> f64 {
    let x = x - 2.0 * (x / 2.0).round();
    let x = if x.abs() > 0.5 { 1f64.copysign(x) - x } else { x };
    (PI * x).sin()
}

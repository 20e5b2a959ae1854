//! Distances, lags and depths of points, exactly: coordinates are integers in steps of `length_unit / 2^64`, and nothing is
//! rounded. The one thing that all ways of computing share.

use super::Domain;

/// The distance between two positions along one axis, in steps; `period` 0 stands for 2^64. In a window (period 0) no
/// distance exceeds half of 2^64, so the minimum image is the plain difference.
pub fn minimum_image(a: u64, b: u64, period: u64) -> u64 {
    let difference = if a >= b { a - b } else { a.wrapping_sub(b).wrapping_add(period) };
    difference.min(period.wrapping_sub(difference))
}

/// The squared distance between points `i` and `j`, in squared steps. At most 3 (2^63)^2 < 2^128.
pub fn squared_distance(axes: &[&[u64]], periods: [u64; 3], i: usize, j: usize) -> u128 {
    let mut sum = 0;
    for (axis, period) in axes.iter().zip(periods) {
        let d = u128::from(minimum_image(axis[i], axis[j], period));
        sum += d * d;
    }
    sum
}

/// The distance of point `i` from the border of the window, in steps.
pub fn border_distance(axes: &[&[u64]], sides: [u64; 3], i: usize) -> u64 {
    axes.iter().zip(sides).map(|(axis, side)| axis[i].min(side - axis[i])).min().unwrap_or(0)
}

/// The number of bins whose upper edge is at most `distance`.
pub fn depth(thresholds: &[u128], distance: u64) -> usize {
    let squared = u128::from(distance) * u128::from(distance);
    thresholds[1..].partition_point(|&t| t <= squared)
}

/// `u_i u_j w` of points whose weights are `u`, in steps of 2^-24, and a pair that weighs `w`, in steps of 2^-32: in steps
/// of 2^-32, rounded to nearest.
pub fn weighted_pair(u: [u32; 2], w: u64) -> u64 {
    let product = u128::from(u[0]) * u128::from(u[1]) * u128::from(w);
    ((product + (1 << 47)) >> 48) as u64
}

/// The lag `a - b` along one axis of a torus, in steps, in `[-period / 2, period / 2)`; `period` 0 stands for 2^64.
fn torus_lag(a: u64, b: u64, period: u64) -> i64 {
    let forward = if a >= b { a - b } else { a.wrapping_sub(b).wrapping_add(period) };
    let nearer = if forward >= period.wrapping_sub(forward) { forward.wrapping_sub(period) } else { forward };
    nearer as i64
}

/// The lag of points `i` and `j`, `x_i - x_j` or `x_j - x_i`, on a torus as minimum images in `[-L/2, L/2)`, chosen of the
/// two by its value: the one whose first component that is not its own negative is positive (0 is its own negative, and on a
/// torus half a period).
pub fn canonical_lag(domain: &Domain, axes: &[&[u64]], i: usize, j: usize) -> [i128; 3] {
    let lag = |i: usize, j: usize| {
        let mut lag = [0; 3];
        for ((lag, axis), period) in lag.iter_mut().zip(axes).zip(domain.periods()) {
            *lag = if domain.is_torus() {
                i128::from(torus_lag(axis[i], axis[j], period))
            } else {
                i128::from(axis[i]) - i128::from(axis[j])
            };
        }
        lag
    };
    let (there, back) = (lag(i, j), lag(j, i));
    // A component that is its own negative is the same in both.
    match there.iter().zip(&back).find(|(a, b)| a != b) {
        Some((a, _)) if *a < 0 => back,
        _ => there,
    }
}

//! Distances, lags and depths of points, exactly: coordinates are integers in steps of `length_unit / 2^64`, and nothing is
//! rounded. The one thing that all ways of computing share.

use super::Domain;

/// The distance between two positions along one axis, in steps; `period` 0 stands for 2^64. In a window (period 0) no
/// distance exceeds half of 2^64, so the minimum image is the plain difference (but that of two ends of a longest side which f64
/// rounds down, 2^-52 of it short).
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
    axes.iter().zip(sides).map(|(axis, side)| axis[i].min(side.saturating_sub(axis[i]))).min().unwrap_or(0)
}

/// The number of bins whose upper edge is at most `distance`.
pub fn depth(thresholds: &[u128], distance: u64) -> usize {
    let squared = u128::from(distance) * u128::from(distance);
    thresholds[1..].partition_point(|&t| t <= squared)
}

/// `u_i u_j w` of points whose weights are `u`, at most 1, and a pair that weighs `w`, in steps of 2^-32: in steps of 2^-64,
/// rounded to nearest, of the product as f64 has it. The same in either order.
pub fn weighted_pair(u: [f64; 2], w: u64) -> u128 {
    (u[0] * u[1] * w as f64 * 2f64.powi(32)).round_ties_even() as u128
}

/// `sum_(i != j) u_i u_j` and `(sum u)^2` over points of weights `u`, in steps of 2^-64. The first without a difference of large
/// numbers, so that one heavy point does not cost what the others are among themselves; whatever the order of points.
pub fn mass_sums(u: &[f64]) -> [u128; 2] {
    let (mut before, mut pairs) = ([0.0; 2], [0.0; 2]);
    for x in ascending(u) {
        pairs = add_whole(pairs, 2.0 * x * (before[0] + before[1]));
        before = add_whole(before, x);
    }
    [mass_steps(pairs[0] + pairs[1]), mass_steps((before[0] + before[1]).powi(2))]
}

/// What pairs seen from deep inside a window are compared with, per bin `b` of `bins`: with `D` the points `i` whose `depths[i]` is
/// more than `b`, `n` for each of them by either normalization; where points have weights `u`, `n / (n - 1) sum_D u_i sum_(j != i) u_j`
/// and `sum_D u_i sum u`, in steps of 2^-64. The first is `n` too where all weights are alike, and no heavy point is its own
/// partner in it. Whatever the order of points.
pub fn border_norms(depths: &[u32], bins: usize, u: Option<&[f64]>) -> Vec<[u128; 2]> {
    let n = depths.len();
    let [sum, rest] = u.map_or([0.0; 2], |u| ascending(u).into_iter().fold([0.0; 2], add_whole));
    let mut norms = vec![[0; 2]; bins + 1];
    for (i, &depth) in depths.iter().enumerate() {
        let of_point = u.map_or([n as u128; 2], |u| {
            // In this order, what a heavy point leaves of the sum keeps its digits.
            let others = (sum - u[i]) + rest;
            let partners = if n > 1 { others * n as f64 / (n - 1) as f64 } else { u[i] };
            [mass_steps(u[i] * partners), mass_steps(u[i] * (sum + rest))]
        });
        norms[depth as usize].iter_mut().zip(of_point).for_each(|(norm, of_point)| *norm += of_point);
    }
    // From the deepest outwards.
    for b in (0..bins).rev() {
        let deeper = norms[b + 1];
        norms[b].iter_mut().zip(deeper).for_each(|(norm, deeper)| *norm += deeper);
    }
    norms.split_off(1)
}

/// A product of weights in steps of 2^-64.
fn mass_steps(x: f64) -> u128 {
    (x * 2f64.powi(64)).round_ties_even() as u128
}

fn ascending(u: &[f64]) -> Vec<f64> {
    let mut sorted = u.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

/// Sums of f64 with what each addition drops (Neumaier 1974).
fn add_whole([sum, rest]: [f64; 2], x: f64) -> [f64; 2] {
    let next = sum + x;
    [next, rest + if sum >= x { (sum - next) + x } else { (x - next) + sum }]
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

/// Every number here was worked out by hand.
#[cfg(test)]
mod tests {
    use super::*;

    const HALF: u64 = 1 << 63;

    #[test]
    fn distances_along_an_axis_take_the_shorter_way() {
        // A period of 2^64: from 3 back over 0 to 2^64 - 2 is 5 steps.
        assert_eq!(minimum_image(3, 7, 0), 4);
        assert_eq!(minimum_image(3, u64::MAX - 1, 0), 5);
        assert_eq!(minimum_image(u64::MAX - 1, 3, 0), 5);
        assert_eq!(minimum_image(9, 9, 0), 0);
        assert_eq!(minimum_image(0, HALF, 0), HALF);
        assert_eq!(minimum_image(HALF, 0, 0), HALF);
        assert_eq!(minimum_image(0, HALF + 1, 0), HALF - 1);
        // A period of 10: at most 5 steps apart.
        for (a, b, expected) in [(0, 4, 4), (0, 5, 5), (0, 6, 4), (9, 0, 1), (0, 9, 1), (8, 3, 5), (2, 2, 0)] {
            assert_eq!(minimum_image(a, b, 10), expected, "{a}, {b}");
            assert_eq!(minimum_image(b, a, 10), expected, "{b}, {a}");
        }
        // An odd one: 3 of 7 one way are 4 the other.
        assert_eq!((minimum_image(0, 3, 7), minimum_image(0, 4, 7)), (3, 3));
    }

    #[test]
    fn squared_distances_add_up_over_axes() {
        let axes: [&[u64]; 3] = [&[1, 4], &[0, u64::MAX - 3], &[2, 9]];
        // 3 steps; 4 steps over the seam of 2^64; 3 steps over the seam of 10.
        assert_eq!(squared_distance(&axes[..1], [0; 3], 0, 1), 9);
        assert_eq!(squared_distance(&axes[..2], [0; 3], 0, 1), 9 + 16);
        assert_eq!(squared_distance(&axes, [0, 0, 10], 0, 1), 9 + 16 + 9);
        assert_eq!(squared_distance(&axes, [0, 0, 10], 1, 0), 9 + 16 + 9);
        assert_eq!(squared_distance(&axes, [0, 0, 10], 1, 1), 0);
        // The longest there is does not overflow: 3 * 2^126.
        let far: [&[u64]; 3] = [&[0, HALF]; 3];
        assert_eq!(squared_distance(&far, [0; 3], 0, 1), 3 << 126);
    }

    #[test]
    fn the_nearest_side_is_the_border() {
        let axes: [&[u64]; 2] = [&[3, 50, 100, 90], &[20, 25, 7, 29]];
        let sides = [100, 30, 0];
        // Left side, upper side, on the right side, upper side again.
        assert_eq!([0, 1, 2, 3].map(|i| border_distance(&axes, sides, i)), [3, 5, 0, 1]);
        assert_eq!(border_distance(&axes[..1], sides, 3), 10);
    }

    #[test]
    fn depth_counts_upper_edges_up_to_the_distance() {
        // Edges 0, 2, 5, 9: upper edges 2, 5 and 9.
        let thresholds = [0, 4, 25, 81];
        let depths = [(0, 0), (1, 0), (2, 1), (4, 1), (5, 2), (8, 2), (9, 3), (u64::MAX, 3)];
        for (distance, expected) in depths {
            assert_eq!(depth(&thresholds, distance), expected, "{distance}");
        }
    }

    #[test]
    fn weights_of_points_multiply() {
        assert_eq!(weighted_pair([1.0, 1.0], 1 << 32), 1 << 64);
        // 1/2 * 1/4 * 3 = 3/8.
        assert_eq!(weighted_pair([0.5, 0.25], 3 << 32), 3 << 61);
        assert_eq!(weighted_pair([1.0, 2f64.powi(-64)], 1 << 32), 1);
        assert_eq!(weighted_pair([2f64.powi(-33), 2f64.powi(-32)], 1 << 32), 0, "half a step, to even");
        assert_eq!(weighted_pair([0.0, 1.0], 7 << 32), 0);
        // 2^29 is about the largest weight of a pair.
        assert_eq!(weighted_pair([1.0, 1.0], 1 << 61), 1 << 93);
    }

    #[test]
    fn sums_of_weights_keep_the_small_ones() {
        // 1/2, 1/4 and 1/4: 2 (1/8 + 1/8 + 1/16), and 1.
        assert_eq!(mass_sums(&[0.25, 0.5, 0.25]), [5 << 61, 1 << 64]);
        assert_eq!(mass_sums(&[0.7]), [0, ((0.7 * 0.7) * 2f64.powi(64)) as u128]);
        assert_eq!(mass_sums(&[]), [0, 0]);
        // One of 1 among a thousand of 2^-50: 2000 2^-50 + 999,000 2^-100, of which the last are nothing in steps of 2^-64.
        let mut heavy = vec![2f64.powi(-50); 1001];
        heavy[400] = 1.0;
        assert_eq!(mass_sums(&heavy)[0], 2000 << 14);
        heavy.rotate_left(123);
        assert_eq!(mass_sums(&heavy)[0], 2000 << 14);
    }

    #[test]
    fn norms_of_deep_points_add_from_the_deepest_outwards() {
        // Four points 0, 1, 3 and 1 bins deep: 3, 1 and 1 are deeper than bins 0, 1 and 2.
        assert_eq!(border_norms(&[0, 1, 3, 1], 3, None), [[12; 2], [4; 2], [4; 2]]);
        // Weights that are alike count as many points, times their square.
        assert_eq!(border_norms(&[0, 1, 3, 1], 3, Some(&[0.5; 4])), [[12 << 62; 2], [4 << 62; 2], [4 << 62; 2]]);
        // Of 1/4, 1/2 and 1/4, the last two are deep: 3/2 (1/2 1/2 + 1/4 3/4), and 1/2 + 1/4.
        assert_eq!(border_norms(&[0, 2, 1], 2, Some(&[0.25, 0.5, 0.25]))[0], [21 << 59, 3 << 62]);
        assert_eq!(border_norms(&[0, 2, 1], 2, Some(&[0.25, 0.5, 0.25]))[1], [3 << 61, 1 << 63]);
        assert_eq!(border_norms(&[1], 1, Some(&[0.5])), [[1 << 62; 2]]);
        assert_eq!(border_norms(&[], 1, Some(&[])), [[0; 2]]);
        // One of 1 that is deep among a thousand of 2^-50 that are not: 1001 / 1000 of a thousand of them.
        let (mut heavy, mut depths) = (vec![2f64.powi(-50); 1001], vec![0; 1001]);
        (heavy[400], depths[400]) = (1.0, 1);
        assert_eq!(border_norms(&depths, 1, Some(&heavy))[0][0], 1001 << 14);
        heavy.rotate_left(123);
        depths.rotate_left(123);
        assert_eq!(border_norms(&depths, 1, Some(&heavy))[0][0], 1001 << 14);
    }

    fn lag(domain: &Domain, [a, b]: [[u64; 2]; 2]) -> [i128; 3] {
        let axes = [[a[0], b[0]], [a[1], b[1]]];
        let axes: Vec<&[u64]> = axes.iter().map(|axis| &axis[..]).collect();
        let found = canonical_lag(domain, &axes, 0, 1);
        assert_eq!(canonical_lag(domain, &axes, 1, 0), found, "a lag does not depend on the order of its points");
        found
    }

    #[test]
    fn of_two_lags_the_positive_one_is_taken() {
        let torus = Domain::unit_torus(2);
        let half = -(1i128 << 63);
        assert_eq!(lag(&torus, [[5, 1], [2, 9]]), [3, -8, 0]);
        // A component of 0 does not decide.
        assert_eq!(lag(&torus, [[4, 1], [4, 9]]), [0, 8, 0]);
        assert_eq!(lag(&torus, [[4, 9], [4, 9]]), [0, 0, 0]);
        // Over the seam: 2 - (2^64 - 1) is 3.
        assert_eq!(lag(&torus, [[2, 0], [u64::MAX, 1]]), [3, -1, 0]);
        // Half a period is its own negative: it does not decide either, and is -2^63 in both.
        assert_eq!(lag(&torus, [[HALF, 1], [0, 4]]), [half, 3, 0]);
        assert_eq!(lag(&torus, [[HALF, 0], [0, HALF]]), [half, half, 0]);
        assert_eq!(lag(&torus, [[7, 0], [2, HALF]]), [5, half, 0]);
        // One step less than half of it is positive.
        assert_eq!(lag(&torus, [[HALF - 1, 0], [0, 0]]), [i128::from(HALF) - 1, 0, 0]);
    }

    #[test]
    fn lags_take_the_period_of_their_axis() {
        // The second side is 1/4: a period of 2^62.
        let torus = Domain::torus(&[1.0, 0.25]).unwrap();
        let period = 1u64 << 62;
        assert_eq!(torus.periods()[1], period);
        assert_eq!(lag(&torus, [[4, 1], [4, period - 1]]), [0, 2, 0]);
        assert_eq!(lag(&torus, [[4, period / 2], [4, 0]]), [0, -(1 << 61), 0]);
    }

    #[test]
    fn a_window_has_plain_lags() {
        let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
        assert_eq!(lag(&window, [[0, 3], [HALF, 1]]), [i128::from(HALF), -2, 0]);
        assert_eq!(lag(&window, [[5, 3], [5, 1]]), [0, 2, 0]);
    }
}

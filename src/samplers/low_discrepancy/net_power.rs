//! P of scrambled digital nets in base 2, n = 2^M.
//!
//! The gain coefficients of Owen ("Monte Carlo variance of scrambled net quadrature", 1997)
//! give P in closed form. With `beta_l(m) = sinc^2(m/2^l) - sinc^2(m/2^(l-1))`, the energy of a wave at digit l,
//!
//! ```text
//! P(m) = 1 + sum_l (Gamma(l) - 1) prod_j beta_(l_j)(m_j)        over the axes with m_j != 0, 1 <= l_j <= M + 1
//! Gamma(l) = sum_(e in {0,1}^u) (-1)^|e| 2^(u - |e|) N(l - e)   u axes, N(l) points whose first l_j digits are all 0
//! ```

use crate::sinc::sinc;

/// P of a scrambled digital net in base 2 with `2^levels` points, of which `count` says how many have so many leading zeros
/// on each axis.
pub(super) fn net_power(levels: usize, m: &[i32], count: impl Fn(&[usize]) -> u64) -> f64 {
    let axes: Vec<usize> = (0..m.len()).filter(|&axis| m[axis] != 0).collect();
    let energy = |axis: usize, level: usize| {
        let (m, digit) = (f64::from(m[axis]), 2f64.powi(level as i32));
        sinc(m / digit).powi(2) - sinc(2.0 * m / digit).powi(2)
    };
    // All levels of the axes at hand, as digits of a number.
    let side = levels + 1;
    let mut sum = 0.0;
    for all in 0..side.pow(axes.len() as u32) {
        let level: Vec<usize> = (0..axes.len()).map(|k| all / side.pow(k as u32) % side + 1).collect();
        let weight: f64 = axes.iter().zip(&level).map(|(&axis, &level)| energy(axis, level)).product();
        if weight == 0.0 {
            continue;
        }
        let mut gain = 0.0;
        for less in 0..1u32 << axes.len() {
            let mut zeros = vec![0; m.len()];
            for (k, &axis) in axes.iter().enumerate() {
                zeros[axis] = level[k] - (less >> k & 1) as usize;
            }
            // Only the origin has more zeros than the net has digits.
            let points = if zeros.iter().any(|&z| z > levels) { 1 } else { count(&zeros) };
            let ones = less.count_ones();
            let sign = if ones % 2 == 0 { 1.0 } else { -1.0 };
            gain += sign * 2f64.powi((axes.len() as u32 - ones) as i32) * points as f64;
        }
        sum += (gain - 1.0) * weight;
    }
    1.0 + sum
}

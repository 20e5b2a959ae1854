//! Coordinates as integers.

/// The nearest multiple of 2^32, in units of it, modulo the period (0 stands for 2^32): what the fast paths read of a position
/// in steps of 2^-64.
pub(crate) fn round32(v: u64, period: u32) -> u32 {
    let rounded = (v.wrapping_add(1 << 31) >> 32) as u32;
    if period != 0 && rounded >= period { rounded - period } else { rounded }
}

/// `a - b` exactly, as a number and what it was rounded off by (Knuth, The Art of Computer Programming, vol. 2, section 4.2.2).
pub(super) fn difference(a: f64, b: f64) -> [f64; 2] {
    let rounded = a - b;
    let of_b = a - rounded;
    let of_a = rounded + of_b;
    [rounded, (a - of_a) + (of_b - b)]
}

/// The multiple of 2^-64 nearest to `(offset[0] + offset[1]) / unit`, in units of it. The quotient of a single number is
/// exact until it is rounded, ties to even; what a second number adds (no more than half of the last place of the first) is
/// good to 2^-40 of a step. `offset[0]` is at least 0 and at most `unit`.
pub(super) fn steps([whole, rest]: [f64; 2], unit: f64) -> u128 {
    let ((a, a_exponent), (b, b_exponent)) = (mantissa_exponent(whole), mantissa_exponent(unit));
    let shift = a_exponent - b_exponent + 64;
    if (b.is_power_of_two() && rest == 0.0) || !(0..75).contains(&shift) {
        // Dividing by a power of two is exact. And far below a step or two nothing is left to round wrongly.
        return ((whole + rest) / unit * 2f64.powi(64)).round_ties_even() as u128;
    }
    let numerator = u128::from(a) << shift;
    let (quotient, remainder) = (numerator / u128::from(b), (numerator % u128::from(b)) as u64);
    if rest == 0.0 {
        let up = match (2 * u128::from(remainder)).cmp(&u128::from(b)) {
            std::cmp::Ordering::Less => 0,
            std::cmp::Ordering::Equal => quotient & 1,
            std::cmp::Ordering::Greater => 1,
        };
        return quotient + up;
    }
    let below = remainder as f64 / b as f64 + rest / unit * 2f64.powi(64);
    quotient.saturating_add_signed(below.round_ties_even() as i128)
}

/// A finite `x` of at least 0 as `mantissa * 2^exponent`.
pub(crate) fn mantissa_exponent(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let fraction = bits & ((1 << 52) - 1);
    if exponent == 0 { (fraction, -1074) } else { (fraction | (1 << 52), exponent - 1075) }
}

/// `fraction * period / 2^64`, rounded to nearest, modulo the period (0 stands for 2^64).
pub(super) fn scale_to_period(fraction: u64, period: u64) -> u64 {
    if period == 0 {
        return fraction;
    }
    let scaled = ((u128::from(fraction) * u128::from(period) + (1 << 63)) >> 64) as u64;
    if scaled == period { 0 } else { scaled }
}

#[cfg(test)]
mod tests {
    use super::{difference, round32, steps};

    #[test]
    fn quotients_are_the_nearest_steps() {
        let all = 1u128 << 64;
        assert_eq!(steps([0.0, 0.0], 3.0), 0);
        assert_eq!(steps([3.0, 0.0], 3.0), all);
        assert_eq!(steps([1.0, 0.0], 3.0), all / 3, "2^64 / 3 = ...5.33");
        assert_eq!(steps([2.0, 0.0], 3.0), 2 * all / 3 + 1, "...10.67");
        assert_eq!(steps([5.0, 0.0], 6.0), 5 * all / 6, "...13.33");
        // A step of 10 is 10 / 2^64: half of it, and one and a half, go to even numbers.
        assert_eq!(steps([5.0 / 2f64.powi(64), 0.0], 10.0), 0);
        assert_eq!(steps([15.0 / 2f64.powi(64), 0.0], 10.0), 2);
        assert_eq!(steps([1.0, 0.0], 4.0), all / 4);
        // A second number moves it either way: a third of a step of 3, and two thirds.
        let third = 1.0 / 2f64.powi(64);
        assert_eq!(steps([1.0, 0.5 * third], 3.0), all / 3, "5.33 + 1/6");
        assert_eq!(steps([1.0, third], 3.0), all / 3 + 1, "5.33 + 1/3");
        assert_eq!(steps([2.0, -third], 3.0), 2 * all / 3, "10.67 - 1/3");
        assert_eq!(steps([1e-300, 0.0], 3.0), 0);
    }

    #[test]
    fn differences_keep_what_rounding_drops() {
        assert_eq!(difference(1.1, 0.1), [1.0, 2f64.powi(-54) * 1.5]);
        assert_eq!(difference(3.0, 1.0), [2.0, 0.0]);
        assert_eq!(difference(1.0, -1e-20), [1.0, 1e-20]);
    }

    #[test]
    fn rounding_stays_below_the_period() {
        assert_eq!(round32(u64::MAX, 0), 0);
        assert_eq!(round32(1 << 31, 0), 1);
        let period = (5 << 32) + (3 << 30);
        let rounded = round32(period, 0);
        assert_eq!(rounded, 6);
        assert_eq!(round32(period - 1, rounded), 0, "6 = the rounded period");
        assert_eq!(round32(4 << 32, rounded), 4);
    }
}

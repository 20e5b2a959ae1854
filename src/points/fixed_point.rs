//! Coordinates as integers.

/// The nearest multiple of 2^32, in units of it, modulo the period (0 stands for 2^32): what the fast paths read of a position
/// in steps of 2^-64.
pub(crate) fn round32(v: u64, period: u32) -> u32 {
    let rounded = (v.wrapping_add(1 << 31) >> 32) as u32;
    if period != 0 && rounded >= period { rounded - period } else { rounded }
}

/// The nearest multiple of 2^-64, modulo 1.
pub(super) fn fixed_point(fraction: f64) -> u64 {
    // Scaling by a power of two is exact; u128 holds the one value 2^64 that wraps to 0.
    (fraction * 2f64.powi(64)).round_ties_even() as u128 as u64
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
    use super::round32;

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

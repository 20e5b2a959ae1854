//! Confidence bands of P.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability that a band holds the truth.
pub const CONFIDENCE: f64 = 0.95;

/// Where a band across realizations takes over: at this many realizations their scatter is known well enough,
pub const MANY_REALIZATIONS: u64 = 30;
/// and at this many independent ordinates their mean is near enough to a normal one.
pub const MANY_ORDINATES: f64 = 100.0;

/// What a band rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BandLaw {
    /// Independent exponential periodogram ordinates: their mean times its degrees of freedom is chi-squared.
    ChiSquared,
    /// The standard error across realizations, of a normal mean.
    StandardError,
}

impl BandLaw {
    /// As files say it.
    pub fn name(self) -> &'static str {
        match self {
            Self::ChiSquared => "chi-squared",
            Self::StandardError => "standard-error",
        }
    }
}

/// A band of probability `CONFIDENCE` for the expectation of a mean of P.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// What it rests on.
    pub law: BandLaw,
}

/// How many realizations there are, and how many of equal norm N would know as much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Realizations {
    pub(super) count: u64,
    /// `(sum N)^2 / sum N^2`: a ratio of sums weighs realizations by their norm.
    pub(super) effective: f64,
}

impl Band {
    /// The band of `p`, a mean over `realizations` and over `independent` modes.
    ///
    /// A mean of `K N` independent exponential ordinates of expectation P is chi-squared with `2 K N` degrees of freedom,
    /// times `P / 2 K N`; so P is in `[2 K N p / c_0.975, 2 K N p / c_0.025]` with the quantiles c (Percival and Walden,
    /// Spectral Analysis for Physical Applications, 1993, section 6.10; Brillinger, Time Series, 1981, section 5.7).
    /// From `MANY_REALIZATIONS` on with `MANY_ORDINATES` it is `p -+ 1.96` standard errors across realizations, which
    /// holds for any law of the ordinates. `None` where p is not a power.
    pub(super) fn new(p: f64, p_se: f64, realizations: Realizations, independent: f64) -> Option<Self> {
        let ordinates = realizations.effective * independent;
        if !(p.is_finite() && p_se.is_finite()) {
            return None;
        }
        if realizations.count >= MANY_REALIZATIONS && ordinates >= MANY_ORDINATES {
            let reach = normal_quantile() * p_se;
            return Some(Self { lo: p - reach, hi: p + reach, law: BandLaw::StandardError });
        }
        let freedom = 2.0 * ordinates;
        let law = ChiSquared::new(freedom).ok().filter(|_| p >= 0.0)?;
        let tail = 0.5 * (1.0 - CONFIDENCE);
        let [lo, hi] = [1.0 - tail, tail].map(|quantile| p * (freedom / law.inverse_cdf(quantile)));
        Some(Self { lo, hi, law: BandLaw::ChiSquared })
    }
}

/// The standard normal quantile of a band: 1.96.
pub(super) fn normal_quantile() -> f64 {
    statrs::distribution::Normal::standard().inverse_cdf(0.5 + 0.5 * CONFIDENCE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(count: u64, independent: f64, se: f64) -> Band {
        Band::new(1.0, se, Realizations { count, effective: count as f64 }, independent).unwrap()
    }

    /// Quantiles of chi-squared as printed in tables: 2 degrees of freedom 0.05064 and 7.37776 (closed form
    /// -2 ln(1 - q)); 10: 3.24697 and 20.4832; 100: 74.2219 and 129.561.
    #[test]
    fn bands_are_the_tabulated_quantiles() {
        for (count, independent, quantiles) in
            [(1, 1.0, [0.050_635_6, 7.377_76]), (1, 5.0, [3.246_97, 20.483_2]), (5, 10.0, [74.221_9, 129.561])]
        {
            let band = of(count, independent, 9.0);
            let freedom = 2.0 * count as f64 * independent;
            let expected = [freedom / quantiles[1], freedom / quantiles[0]];
            for (found, expected) in [band.lo, band.hi].into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-5, "{band:?}, expected {expected}");
            }
            assert_eq!(band.law, BandLaw::ChiSquared);
        }
        // Very many: the normal limit, 1 -+ 1.96 / sqrt(K N).
        for independent in [1e4, 1e6, 1e9] {
            let band = of(2, independent, 9.0);
            let reach = 1.959_964 / (2.0 * independent).sqrt();
            assert!(
                ((band.hi - 1.0) / reach - 1.0).abs() < 0.02 && ((1.0 - band.lo) / reach - 1.0).abs() < 0.02,
                "{band:?}"
            );
        }
    }

    #[test]
    fn the_law_changes_with_both_limits() {
        assert_eq!(of(29, 1e4, 0.1).law, BandLaw::ChiSquared);
        assert_eq!(of(30, 3.0, 0.1).law, BandLaw::ChiSquared);
        let many = of(30, 4.0, 0.1);
        assert_eq!(many.law, BandLaw::StandardError);
        assert!((many.hi - 1.195_996_4).abs() < 1e-7 && (many.lo - 0.804_003_6).abs() < 1e-7);
        let one = Realizations { count: 1, effective: 1.0 };
        assert_eq!(Band::new(f64::NAN, 1.0, one, 1.0), None);
        assert_eq!(Band::new(1.0, 1.0, one, 0.0), None);
        assert_eq!(Band::new(-0.1, 1.0, one, 4.0), None);
    }
}

//! Where a value of P is between the two ends of the colours.

use super::human;

const REINHARD: &str =
    "v = P (1 + P / n^2) / (1 + P) (Reinhard et al. 2002, eq. 4): P = 0 lowest, P = 1 in the middle, P = n highest";

/// How P becomes a place between the ends of the colours.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// `v = P (1 + P / n^2) / (1 + P)` (Reinhard et al. 2002, eq. 4), as in `spectrum.png`: all of P from 0 to n is seen.
    #[default]
    Reinhard,
    /// `v = P / max`.
    Linear {
        /// P at the upper end, above 0.
        max: f64,
    },
    /// `v = 1/2 + log10 P / (2 decades)`: P = 1 in the middle.
    Log {
        /// Decades of P below 1, and as many above, above 0.
        decades: f64,
    },
    /// As `Log`, with `10 log10 P` in dB on the bar.
    Decibel {
        /// Decibels below 1, and as many above, above 0.
        range: f64,
    },
}

impl ToneMap {
    /// One of each kind, with the settings to begin with.
    pub const ALL: [Self; 4] =
        [Self::Reinhard, Self::Linear { max: 2.0 }, Self::Log { decades: 3.0 }, Self::Decibel { range: 20.0 }];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reinhard => "Reinhard",
            Self::Linear { .. } => "linear",
            Self::Log { .. } => "logarithmic",
            Self::Decibel { .. } => "decibel",
        }
    }

    /// Its formula, in ASCII.
    pub fn definition(self) -> String {
        match self {
            Self::Reinhard => REINHARD.into(),
            Self::Linear { max } => format!("v = P / {max}"),
            Self::Log { decades } => format!("v = 1/2 + log10(P) / {}", 2.0 * decades),
            Self::Decibel { range } => format!("v = 1/2 + 10 log10(P) / {} dB", 2.0 * range),
        }
    }

    /// Where `p` is between the ends of the colours, for `n` points: in [0, 1], not below for a larger `p`.
    pub fn tone(self, p: f64, n: f64) -> f64 {
        let v = match self {
            Self::Reinhard => p * (1.0 + p / (n * n)) / (1.0 + p),
            Self::Linear { max } => p / max,
            Self::Log { decades } => 0.5 + p.log10() / (2.0 * decades),
            Self::Decibel { range } => 0.5 + 10.0 * p.log10() / (2.0 * range),
        };
        v.clamp(0.0, 1.0)
    }

    /// The colour bar: places from 0 to 1, rising, and the P (or dB of P) that they stand for.
    pub fn ticks(self, n: f64) -> Vec<(f64, String)> {
        let steps = |end: f64, target: u32| super::ticks::ticks(&(0.0..end), target).into_iter();
        match self {
            Self::Reinhard => {
                let known = [0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 10.0];
                let below = known.into_iter().filter(|&p| p == 0.0 || p <= 0.4 * n);
                below.map(|p| (self.tone(p, n), human(p))).chain([(1.0, format!("n = {}", human(n)))]).collect()
            }
            Self::Linear { max } => steps(max, 5).map(|(p, text)| (p / max, text)).collect(),
            Self::Log { decades } => super::ticks::ticks(&(-decades..decades), 6)
                .into_iter()
                .map(|(t, _)| (0.5 + t / (2.0 * decades), human(10f64.powf(t))))
                .collect(),
            Self::Decibel { range } => super::ticks::ticks(&(-range..range), 6)
                .into_iter()
                .map(|(t, text)| (0.5 + t / (2.0 * range), format!("{text} dB")))
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tones_are_monotone_with_1_in_the_middle() {
        for n in [2.0, 100.0, 1e6] {
            let p: Vec<f64> = (0..=1000).map(|k| n * (f64::from(k) / 1000.0).powi(3)).collect();
            assert!(p.windows(2).all(|w| ToneMap::Reinhard.tone(w[0], n) < ToneMap::Reinhard.tone(w[1], n)), "n = {n}");
            assert!(
                ToneMap::Reinhard.tone(0.0, n) == 0.0
                    && (ToneMap::Reinhard.tone(n, n) - 1.0).abs() < 1e-12
                    && ToneMap::Reinhard.tone(f64::NAN, n).is_nan()
            );
        }
        assert!((ToneMap::Reinhard.tone(1.0, 1000.0) - 0.5).abs() < 1e-5);
    }

    #[test]
    fn other_tones_have_their_landmarks() {
        let n = 1000.0;
        assert_eq!(ToneMap::Linear { max: 4.0 }.tone(1.0, n), 0.25);
        for map in [ToneMap::Log { decades: 2.0 }, ToneMap::Decibel { range: 20.0 }] {
            assert_eq!([0.0, 0.01, 1.0, 10.0, 1e9].map(|p| map.tone(p, n)), [0.0, 0.0, 0.5, 0.75, 1.0], "{map:?}");
        }
        for map in ToneMap::ALL {
            let ticks = map.ticks(n);
            assert!(ticks.len() >= 3 && ticks.windows(2).all(|t| t[0].0 < t[1].0), "{map:?} {ticks:?}");
            assert!(ticks.iter().all(|t| (0.0..=1.0).contains(&t.0)), "{map:?} {ticks:?}");
        }
        assert_eq!(ToneMap::Decibel { range: 20.0 }.ticks(n)[0], (0.0, "−20 dB".to_string()));
    }
}

//! How far P at a single wave vector may be from its estimate.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::PowerSpectrum;

impl PowerSpectrum {
    /// Per wave vector, the band that holds the true P with a probability of 95 %: `2 K P / chi` between the 97.5 % and the
    /// 2.5 % quantile of chi-squared with `2 K` degrees of freedom, as a periodogram ordinate is exponential (Brillinger,
    /// Time Series, 1981, section 5.4). Not at m = 0, where P is no fluctuation: `None`.
    pub fn bands(&self, realizations: u64) -> Vec<Option<[f64; 2]>> {
        let degrees = 2.0 * realizations as f64;
        let factors = ChiSquared::new(degrees).map(|d| [0.975, 0.025].map(|q| degrees / d.inverse_cdf(q))).ok();
        let zero = |k: usize| self.waves.vector(k) == [0.0; 3];
        (0..self.p.len()).map(|k| factors.filter(|_| !zero(k)).map(|f| f.map(|f| f * self.p[k]))).collect()
    }
}

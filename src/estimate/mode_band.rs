//! How far P at a single wave vector may be from its estimate.

use super::PowerSpectrum;
use super::confidence::{Band, Realizations};

impl PowerSpectrum {
    /// Per wave vector, the band that holds the true P with a probability of 95 % (`Band`). Not at m = 0, where P is no
    /// fluctuation: `None`. Realizations are taken as of equal norm.
    pub fn bands(&self, realizations: u64) -> Vec<Option<Band>> {
        let realizations = Realizations { count: realizations, effective: realizations as f64 };
        let zero = |k: usize| self.waves.vector(k) == [0.0; 3];
        let band = |k: usize| Band::new(self.p[k], self.p_se[k], realizations, 1.0);
        (0..self.p.len()).map(|k| band(k).filter(|_| !zero(k))).collect()
    }
}

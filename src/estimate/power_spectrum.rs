//! Wave power -> the power spectrum P(m) on the integer grid.

use super::Analysis;
use super::confidence::{Band, Realizations};
use super::{ErrorSource, ratio_standard_error};
use crate::accumulate::{PowerMoments, WavePower};
use crate::plan::{WaveGrid, WavePlan, WaveVectors};

/// `P(m) = sum_k |s_m|^2 / sum_k N` over realizations k with norm `N = sum_j w_j^2` (n where every point weighs 1): a ratio
/// of sums, which is the mean of the realizations' periodograms where N is the same for all. DC is part of the grid and of
/// nothing else.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerSpectrum {
    /// The wave vectors.
    pub waves: WaveVectors,
    /// P per stored mode (half of a grid, see `WaveGrid`).
    pub p: Vec<f64>,
    /// Standard error per stored mode. Theory, for K = 1: a periodogram ordinate is exponential, so its standard error is
    /// P itself; over the root of the number of tapers where P is their mean. Without tapers P(0) is the same wherever the
    /// points are: its error is 0.
    pub p_se: Vec<f64>,
    /// Where `p_se` comes from.
    pub errors: ErrorSource,
    realizations: Realizations,
    /// Independent ordinates behind a mode of one realization: tapers.
    ordinates: f64,
}

impl PowerSpectrum {
    /// The estimate.
    pub fn new(plan: &WavePlan, power: &WavePower) -> Self {
        let modes = power.mode_totals();
        let (mut p, mut p_se) = ratio_estimate(power, &modes, |_| 1.0, |_| plan.tapers());
        if let Some(dc) = plan.waves.dc().filter(|_| plan.dc_cleared()) {
            (p[dc], p_se[dc]) = (0.0, 0.0);
        }
        let errors = ErrorSource::of(power.realizations);
        if errors == ErrorSource::Theory && plan.tapered().is_none() {
            match &plan.waves {
                WaveVectors::Grid(grid) => p_se[grid.dc()] = 0.0,
                WaveVectors::List(list) => {
                    let zeros = p_se.iter_mut().zip(&list.vectors).filter(|(_, v)| **v == [0.0; 3]);
                    zeros.for_each(|(se, _)| *se = 0.0);
                }
            }
        }
        Self { waves: plan.waves.clone(), p, p_se, errors, realizations: realizations(power), ordinates: plan.tapers() }
    }

    /// P at a mode of the whole grid; `None` for a list.
    pub fn at(&self, m: [i32; 3]) -> Option<f64> {
        Some(self.p[self.waves.grid()?.half_index(m)])
    }

    /// The band that holds P at each stored mode; none at m = 0, where P is no fluctuation.
    pub fn bands(&self) -> Vec<Option<Band>> {
        let zero = |k: usize| self.waves.vector(k) == [0.0; 3];
        (0..self.p.len()).map(|k| self.band(k).filter(|_| !zero(k))).collect()
    }

    pub(super) fn band(&self, k: usize) -> Option<Band> {
        Band::new(self.p[k], self.p_se[k], self.realizations, self.ordinates)
    }

    /// P and its standard error at m = 0, if that is among the wave vectors.
    pub fn dc(&self) -> Option<(f64, f64)> {
        let dc = self.waves.dc()?;
        Some((self.p[dc], self.p_se[dc]))
    }
}

/// The realizations behind sums of power.
pub(super) fn realizations(power: &WavePower) -> Realizations {
    let [n1, n2] = power.norm_totals();
    Realizations { count: power.realizations, effective: n1 * n1 / n2 }
}

/// `P` and its standard error from the moments of q (or of ring sums of q over `members` modes). `independent` is the
/// number of independent exponential ordinates behind one value, for the theory at K = 1.
pub(super) fn ratio_estimate(
    power: &WavePower,
    moments: &PowerMoments,
    members: impl Fn(usize) -> f64,
    independent: impl Fn(usize) -> f64,
) -> (Vec<f64>, Vec<f64>) {
    let [n1, n2] = power.norm_totals();
    let errors = ErrorSource::of(power.realizations);
    (0..moments.q.len())
        .map(|i| {
            let ratio = moments.q[i] / n1;
            let se = match errors {
                ErrorSource::AcrossRealizations => {
                    let residuals = moments.q_squared[i] - 2.0 * ratio * moments.q_n[i] + ratio * ratio * n2;
                    // What remains of three sums that agree to their last digits is rounding, not variance.
                    let noise = 8.0 * f64::EPSILON * moments.q_squared[i];
                    ratio_standard_error(power.realizations, if residuals <= noise { 0.0 } else { residuals }, n1)
                }
                _ => ratio / independent(i).sqrt(),
            };
            (ratio / members(i), se / members(i))
        })
        .unzip()
}

impl Analysis {
    /// P on the grid or at a list of wave vectors.
    pub fn spectrum(&self) -> Option<&PowerSpectrum> {
        self.get()
    }

    /// P on the grid, and the grid, where it was asked for.
    pub fn grid_of_power(&self) -> Option<(&PowerSpectrum, &WaveGrid)> {
        let spectrum = self.spectrum().filter(|_| self.grid_wanted)?;
        Some((spectrum, spectrum.waves.grid()?))
    }

    /// P at a list of wave vectors.
    pub fn listed_power(&self) -> Option<&PowerSpectrum> {
        self.spectrum().filter(|s| self.grid_wanted && s.waves.grid().is_none())
    }
}

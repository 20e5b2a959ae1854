//! Wave power -> the power spectrum P(m) on the integer grid.

use super::{ErrorSource, ratio_standard_error};
use crate::accumulate::{PowerMoments, WavePower};
use crate::plan::{WaveGrid, WavePlan};

/// `P(m) = sum_k |s_m|^2 / sum_k n` over realizations k: a ratio of sums, which is the mean of the realizations'
/// periodograms where n is the same for all. DC is part of the grid (`P(0) = sum n^2 / sum n`) and of nothing else.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerSpectrum {
    /// The grid.
    pub grid: WaveGrid,
    /// P per stored mode (half of the grid, see `WaveGrid`).
    pub p: Vec<f64>,
    /// Standard error per stored mode. Theory, for K = 1: a periodogram ordinate is exponential, so its standard error is
    /// P itself.
    pub p_se: Vec<f64>,
    /// Where `p_se` comes from.
    pub errors: ErrorSource,
}

impl PowerSpectrum {
    /// The estimate.
    pub fn new(plan: &WavePlan, power: &WavePower) -> Self {
        let modes = power.mode_totals();
        let (p, p_se) = ratio_estimate(power, &modes, |_| 1.0, |_| 1.0);
        Self { grid: plan.grid, p, p_se, errors: ErrorSource::of(power.realizations) }
    }

    /// P at any mode of the whole grid.
    pub fn at(&self, m: [i32; 3]) -> f64 {
        self.p[self.grid.half_index(m)]
    }

    /// P and its standard error at m = 0.
    pub fn dc(&self) -> (f64, f64) {
        let dc = self.grid.dc();
        (self.p[dc], self.p_se[dc])
    }

    /// Shape of the whole grid: `2 F_k + 1` per axis of the domain.
    pub fn full_shape(&self) -> Vec<usize> {
        self.grid.max_frequency()[..self.grid.dim()].iter().map(|&f| 2 * f as usize + 1).collect()
    }

    /// The whole grid from stored values, x axis first (slowest), index `m + F`.
    pub fn full<'a>(&'a self, half: &'a [f64]) -> impl ExactSizeIterator<Item = f64> + 'a {
        let plane = self.grid.half_shape()[1] * self.grid.half_shape()[2];
        let mirrored = self.grid.max_frequency()[0] as usize * plane;
        // Planes m_0 < 0 are the stored planes read backwards; what follows is the store itself.
        (0..self.grid.full_len()).map(move |i| if i < mirrored { half[half.len() - 1 - i] } else { half[i - mirrored] })
    }
}

/// `P` and its standard error from the moments of q (or of ring sums of q over `members` modes). `independent` is the
/// number of independent exponential ordinates behind one value, for the theory at K = 1.
pub(super) fn ratio_estimate(
    power: &WavePower,
    moments: &PowerMoments,
    members: impl Fn(usize) -> f64,
    independent: impl Fn(usize) -> f64,
) -> (Vec<f64>, Vec<f64>) {
    let [n1, n2] = power.n_moments.map(|n| n as f64);
    let errors = ErrorSource::of(power.realizations);
    (0..moments.q.len())
        .map(|i| {
            let ratio = moments.q[i] / n1;
            let se = match errors {
                ErrorSource::Theory => ratio / independent(i).sqrt(),
                ErrorSource::AcrossRealizations => {
                    let residuals = moments.q_squared[i] - 2.0 * ratio * moments.q_n[i] + ratio * ratio * n2;
                    // What remains of three sums that agree to their last digits is rounding, not variance.
                    let noise = 8.0 * f64::EPSILON * moments.q_squared[i];
                    ratio_standard_error(power.realizations, if residuals <= noise { 0.0 } else { residuals }, n1)
                }
            };
            (ratio / members(i), se / members(i))
        })
        .unzip()
}

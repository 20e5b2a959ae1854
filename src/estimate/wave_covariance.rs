//! Products of amplitudes -> their covariance, and whether it looks stationary.

use super::Analysis;
use super::{ErrorSource, ratio_standard_error};
use crate::accumulate::WaveCovariance;
use crate::plan::{Accuracy, CovariancePlan, WaveGrid};

/// `C_ml = sum_k s_m conj(s_l) / sum_k N` over realizations k with norm `N = sum_j w_j^2`, for all `m` and `l` of a grid.
/// Hermitian; its diagonal is P.
#[derive(Debug, Clone, PartialEq)]
pub struct AmplitudeCovariance {
    /// The wave vectors: M of them, in the order of the whole grid (`m + B`, x axis first).
    pub grid: WaveGrid,
    /// Real and imaginary part of `C_ml` at `m * M + l`.
    pub c: Vec<[f64; 2]>,
    /// Standard error of `C_ml`, as a complex number: the root of the variances of both parts, added. `None` for K = 1.
    pub c_se: Option<Vec<f64>>,
    /// The matrix in a few numbers.
    pub scalars: CovarianceScalars,
}

/// A covariance in a few numbers, over `m` and `l` other than 0. Where P is below what f64 resolves, a pair is left out.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct CovarianceScalars {
    /// `sum |C_ml|^2` over `m != l`, over the same over all.
    pub off_diagonal_share: f64,
    /// What the first sum is expected to be by chance alone, over the second. `None` for K = 1.
    pub off_diagonal_share_by_chance: Option<f64>,
    /// Largest `|C_ml|` in standard errors over `m != l`.
    pub largest_z: Option<f64>,
    /// Root mean square of `|C_ml|` in standard errors over `m != l`: 1 where the process is stationary and K is large
    /// (`sqrt((K - 1) / (K - 2))` for normal amplitudes).
    pub rms_z: Option<f64>,
}

impl AmplitudeCovariance {
    /// The estimate.
    pub fn new(plan: &CovariancePlan, covariance: &WaveCovariance) -> Self {
        let sums = covariance.totals();
        let (modes, stored) = (plan.modes(), sums.stored);
        let [n1, n2] = sums.norms;
        let k = covariance.realizations;
        // Where m is stored, and the sign of its imaginary part.
        let place = |m: usize| if m + 1 >= stored { (m + 1 - stored, 1.0) } else { (stored - 1 - m, -1.0) };
        let product = |values: &[f64], m: usize, l: usize| {
            let ((a, sign_a), (b, sign_b)) = (place(m), place(l));
            let at = |a: usize, b: usize| values[a * 2 * stored + b];
            [
                at(a, b) + sign_a * sign_b * at(stored + a, stored + b),
                sign_a * at(stored + a, b) - sign_b * at(a, stored + b),
            ]
        };
        let mut c = Vec::with_capacity(modes * modes);
        let mut c_se = Vec::with_capacity(if k >= 2 { modes * modes } else { 0 });
        for m in 0..modes {
            for l in 0..modes {
                let element = product(&sums.products, m, l).map(|x| x / n1);
                c.push(element);
                if ErrorSource::of(k) == ErrorSource::AcrossRealizations {
                    let squares = sums.powers[place(m).0 * stored + place(l).0];
                    let [re, im] = product(&sums.products_n, m, l);
                    let squared = element[0].powi(2) + element[1].powi(2);
                    let residuals = squares - 2.0 * (element[0] * re + element[1] * im) + squared * n2;
                    // What remains of three sums that agree to their last digits is rounding, not variance.
                    let scatter = residuals > 8.0 * f64::EPSILON * squares;
                    c_se.push(ratio_standard_error(k, if scatter { residuals } else { 0.0 }, n1));
                }
            }
        }
        let c_se = (k >= 2).then_some(c_se);
        let scalars = CovarianceScalars::new(modes, &c, c_se.as_deref(), plan.shape.mean_points);
        Self { grid: plan.grid, c, c_se, scalars }
    }

    /// Number of wave vectors M.
    pub fn modes(&self) -> usize {
        self.grid.full_len()
    }

    /// `|C_ml|`.
    pub fn magnitude(&self, m: usize, l: usize) -> f64 {
        let [re, im] = self.c[m * self.modes() + l];
        re.hypot(im)
    }

    /// Where m = 0 is.
    pub fn dc(&self) -> usize {
        self.modes() / 2
    }
}

impl CovarianceScalars {
    fn new(modes: usize, c: &[[f64; 2]], c_se: Option<&[f64]>, n: f64) -> Self {
        let zero = Accuracy::High.power_bound().zero(n);
        let resolved = |m: usize| m != modes / 2 && c[m * modes + m][0] > zero;
        let (mut all, mut off, mut chance, mut z_squared, mut pairs, mut largest) = (0.0, 0.0, 0.0, 0.0, 0u64, 0f64);
        for m in (0..modes).filter(|&m| resolved(m)) {
            for l in (0..modes).filter(|&l| resolved(l)) {
                let at = m * modes + l;
                let squared = c[at][0].powi(2) + c[at][1].powi(2);
                all += squared;
                if m == l {
                    continue;
                }
                off += squared;
                if let Some(se) = c_se.map(|se| se[at]).filter(|&se| se > 0.0) {
                    chance += se * se;
                    z_squared += squared / (se * se);
                    largest = largest.max(squared.sqrt() / se);
                    pairs += 1;
                }
            }
        }
        Self {
            off_diagonal_share: off / all,
            off_diagonal_share_by_chance: c_se.map(|_| chance / all),
            largest_z: (pairs > 0).then_some(largest),
            rms_z: (pairs > 0).then(|| (z_squared / pairs as f64).sqrt()),
        }
    }
}

impl Analysis {
    /// Covariance of the amplitudes of low frequencies.
    pub fn covariance(&self) -> Option<&AmplitudeCovariance> {
        self.get()
    }
}

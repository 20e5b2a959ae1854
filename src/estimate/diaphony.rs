//! P -> diaphony, a discrepancy.
//! See `docs/spectrum-scalars.md`.

use super::PowerSpectrum;
use crate::plan::WavePlan;

/// Diaphony F of points on a torus, scaled to the unit cube (Zinterhof, "Ueber einige Abschaetzungen bei der Approximation von Funktionen
/// mit Gleichverteilungsmethoden", 1976), in the normalization of UTK, in which `E[F^2] = 1/n` for n independent points:
///
/// `F^2 = sum_(m != 0) prod_j max(1, |m_j|)^-2 |s_m|^2 / (sum w)^2 / ((1 + pi^2 / 3)^d - 1)`,
///
/// since `sum_(m != 0) exp(2 pi i m x) / m^2 = 2 pi^2 (x^2 - x + 1/6)` the same as
/// `sum_ij (w_i w_j prod_k (1 + 2 pi^2 B_2({x_ik - x_jk})) - 1) / ...`. Over realizations a ratio of sums, `P(m) / P(0)`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Diaphony {
    /// F, the root of both parts of its square.
    pub diaphony: f64,
    /// The sum over what is computed of the grid.
    pub grid_squared: f64,
    /// The rest, closed with the level of P at high frequency for all other modes.
    pub tail_squared: f64,
    /// That level.
    pub tail_level: f64,
}

impl Diaphony {
    /// Of a grid on a torus. `level` is that of P beyond the grid. `None` where weights sum to 0.
    pub fn new(plan: &WavePlan, spectrum: &PowerSpectrum, level: f64) -> Option<Self> {
        let grid = plan.waves.grid().filter(|_| plan.domain.is_torus())?;
        let at_zero = spectrum.p[grid.dc()];
        // Squares of weights that cancel leave rounding, not a sum.
        if at_zero.is_nan() || at_zero <= 1e-12 {
            return None;
        }
        let (mut sum, mut coefficients) = (0.0, 0.0);
        for (index, p) in spectrum.p.iter().enumerate().filter(|(k, _)| *k != grid.dc() && plan.computes(*k)) {
            let factor = grid.mode(index).iter().map(|&m| f64::from(m.abs().max(1)).powi(-2)).product::<f64>();
            let times = f64::from(grid.multiplicity(index));
            sum += times * factor * p;
            coefficients += times * factor;
        }
        let all = (1.0 + std::f64::consts::PI.powi(2) / 3.0).powi(grid.dim() as i32) - 1.0;
        let scale = at_zero * all;
        let (grid_squared, tail_squared) = (sum / scale, (all - coefficients).max(0.0) * level / scale);
        Some(Self { diaphony: (grid_squared + tail_squared).sqrt(), grid_squared, tail_squared, tail_level: level })
    }
}

//! The power spectrum, by the definition.
//!
//! For points `x_1 .. x_n` in a box with sides `L`, and integer `m`:
//!
//! ```text
//! s_m = sum_j exp(-2 pi i m . x_j / L)        q_m = |s_m|^2        P(m) = E q_m / E n
//! ```
//!
//! (periodogram; e.g. Heck, Schloemer, Deussen, "Blue Noise Sampling with Controlled Aliasing", TOG 2013, eq. 2, up to the
//! name of n). `x_j / L` is a multiple of 2^-64, so `m . x_j / L mod 1` is exact in wrapping u64 arithmetic; only the
//! sine and cosine of the reduced phase are rounded, to f64. Sums are compensated (Neumaier), so that the error does
//! not grow with n.

use crate::compute::Control;
use crate::error::Result;
use crate::plan::WaveGrid;

/// `m . x_j / L mod 1`, in turns, in [-1/2, 1/2).
pub fn phase_turns(axes: &[&[u64]], m: [i32; 3], j: usize) -> f64 {
    let mut phase = 0u64;
    for (axis, m_k) in axes.iter().zip(m) {
        phase = phase.wrapping_add(axis[j].wrapping_mul(i64::from(m_k) as u64));
    }
    phase as i64 as f64 / 2f64.powi(64)
}

/// `|s_m|^2` for every stored mode of the grid. `axes[a][j]` is the fraction of point `j` along axis `a`.
pub(super) fn wave_power(grid: &WaveGrid, axes: &[&[u64]], control: &Control) -> Result<Vec<f64>> {
    let mut power = Vec::with_capacity(grid.half_len());
    for index in 0..grid.half_len() {
        control.check()?;
        let m = grid.mode(index);
        let (mut re, mut im) = (Compensated::default(), Compensated::default());
        for j in 0..axes[0].len() {
            let (sin, cos) = (std::f64::consts::TAU * phase_turns(axes, m, j)).sin_cos();
            re.add(cos);
            im.add(-sin);
        }
        power.push(re.sum().powi(2) + im.sum().powi(2));
    }
    Ok(power)
}

/// A sum that carries its rounding error (Neumaier 1974).
#[derive(Default)]
struct Compensated {
    sum: f64,
    error: f64,
}

impl Compensated {
    fn add(&mut self, x: f64) {
        let s = self.sum + x;
        self.error += if self.sum.abs() >= x.abs() { (self.sum - s) + x } else { (x - s) + self.sum };
        self.sum = s;
    }

    fn sum(&self) -> f64 {
        self.sum + self.error
    }
}

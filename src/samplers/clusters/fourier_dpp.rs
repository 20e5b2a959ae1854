//! The determinantal process of the Fourier modes `|k_j| <= (s - 1) / 2`, n = s^d points, s odd (Bardenet, Hardy, "Monte Carlo with
//! determinantal point processes", 2020, on the torus).
//!
//! `P(m) = 1 - prod_j (1 - |m_j| / s)_+`, `g(r vec) = n / (n - 1) (1 - prod_j [sin(pi s r_j) / (s sin(pi r_j))]^2)`, averaged over directions
//! by quadrature.

use std::f64::consts::PI;
use std::sync::Arc;

use super::determinantal::draw;
use crate::control::Control;
use crate::error::Result;
use crate::samplers::size::root_below;
use crate::samplers::waves::Waves;
use crate::samplers::{Entry, Family, Realization, Sampler, Size};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Bardenet & Hardy 2020",
    formulas: "P = 1 - prod (1 - |m_j|/s)+, n = s^d; g = n/(n-1) (1 - prod [sin(pi s r_j)/(s sin pi r_j)]^2)",
    size: Size::ODD_POWER,
    ..Entry::new("fourier-dpp", Family::Clusters, "determinantal process of the lowest Fourier modes", |given| {
        let side = root_below(given.n, given.dim) as i32;
        let (dim, reach) = (given.dim, (side - 1) / 2);
        let count = given.n as usize;
        let component = |at: usize, axis: usize| (at / (side as usize).pow(axis as u32) % side as usize) as i32 - reach;
        let modes = (0..count).flat_map(|at| (0..dim).map(move |axis| component(at, axis))).collect();
        Ok(Arc::new(FourierDpp { side: f64::from(side), n: given.n as f64, waves: Waves { dim, reach, modes } }))
    })
};

struct FourierDpp {
    side: f64,
    n: f64,
    waves: Waves,
}

impl FourierDpp {
    /// `[sin(pi s x) / (s sin(pi x))]^2`.
    fn fejer(&self, x: f64) -> f64 {
        let below = (PI * x).sin();
        if below.abs() < 1e-9 { 1.0 } else { ((PI * self.side * x).sin() / (self.side * below)).powi(2) }
    }
}

impl Sampler for FourierDpp {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        draw(&self.waves, &mut which.stream(), control)
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        if self.n < 2.0 || !(0.0..=0.5).contains(&r) {
            return None;
        }
        // Steps enough for the oscillations of a kernel of this side.
        let steps = 64 + 4 * self.side as i32;
        let circle = |radius: f64| {
            let at = |i: i32| 0.5 * PI * (f64::from(i) + 0.5) / f64::from(steps);
            let product = |angle: f64| self.fejer(radius * angle.cos()) * self.fejer(radius * angle.sin());
            (0..steps).map(|i| product(at(i))).sum::<f64>() / f64::from(steps)
        };
        let mean = match self.waves.dim {
            1 => self.fejer(r),
            2 => circle(r),
            // cos of the polar angle is uniform; Simpson's rule.
            _ => {
                let at = |i: i32| f64::from(i) / f64::from(2 * steps);
                let value = |t: f64| self.fejer(r * t) * circle(r * (1.0 - t * t).max(0.0).sqrt());
                let weight = |i: i32| if i == 0 || i == 2 * steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                (0..=2 * steps).map(|i| weight(i) * value(at(i))).sum::<f64>() / f64::from(6 * steps)
            }
        };
        Some(self.n / (self.n - 1.0) * (1.0 - mean))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        Some(1.0 - m.iter().map(|&m| (1.0 - f64::from(m).abs() / self.side).max(0.0)).product::<f64>())
    }
}

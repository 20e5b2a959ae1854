//! The determinantal process with a Gaussian kernel (Lavancier, Moller, Rubak, "Determinantal point process models and
//! statistical inference", 2015).
//!
//! Eigenvalues `phi(k)` in proportion to `exp(-pi^2 a^2 |k|^2)` at whole k, with sum n, `a = alpha / (sqrt(pi) n^(1/d))`: alpha = 1 is the most
//! repulsive, where `phi(0) = 1`.
//!
//! ```text
//! P(m) = 1 - sum_k phi(k) phi(k + m) / n      Var n = sum phi (1 - phi)      g(r) = (n^2 - C(r)^2) / (n^2 - sum phi^2)
//! ```
//!
//! C(r) the periodized `n exp(-r^2 / a^2)`.

use std::f64::consts::PI;
use std::sync::Arc;

use super::determinantal::draw;
use crate::control::Control;
use crate::error::Result;
use crate::samplers::waves::Waves;
use crate::samplers::{Accepts, Entry, Family, Given, Number, Parameter, Realization, Sampler, Stream};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Lavancier, Moller, Rubak 2015",
    formulas: "P = 1 - sum phi(k) phi(k+m)/sum phi, phi(k) ~ exp(-pi^2 a^2 k^2), a = alpha/(sqrt(pi) n^(1/d)); Var n = sum phi (1 - phi); g = (n^2 - C(r)^2)/(n^2 - sum phi^2)",
    number: Number::Expected,
    parameters: &[Parameter::new(
        "alpha",
        "1",
        Accepts::Above(0.0, 1.0),
        "range of repulsion, relative to the largest possible",
    )],
    ..Entry::new("gaussian-dpp", Family::Clusters, "determinantal process with a Gaussian kernel", make)
};

struct GaussianDpp {
    dim: usize,
    n: f64,
    /// a, in units of the side.
    range: f64,
    /// Eigenvalues of one axis at -reach ..= reach, whose products are phi, and their sum.
    axis: Vec<f64>,
    reach: i32,
}

fn make(given: &Given<'_>) -> Result<Arc<dyn Sampler>> {
    let (n, dim) = (given.n as f64, given.dim);
    let per_axis = n.powf(1.0 / dim as f64);
    let range = given.values.number("alpha")? / (PI.sqrt() * per_axis);
    let reach = (6.0 / (PI * range)).ceil() as i32;
    let weight = |k: i32| (-(PI * range * f64::from(k)).powi(2)).exp();
    let sum: f64 = (-reach..=reach).map(weight).sum();
    // Rounding must not carry the largest beyond 1.
    let axis = (-reach..=reach).map(|k| (per_axis * weight(k) / sum).min(1.0)).collect();
    Ok(Arc::new(GaussianDpp { dim, n, range, axis, reach }))
}

impl GaussianDpp {
    /// The modes that take part, each with its own probability.
    fn modes(&self, stream: &mut Stream, control: &Control) -> Result<Vec<i32>> {
        let side = self.axis.len();
        let mut modes = Vec::new();
        for at in 0..side.pow(self.dim as u32) {
            if at % (1 << 16) == 0 {
                control.check()?;
            }
            let index = |axis: usize| at / side.pow(axis as u32) % side;
            let phi: f64 = (0..self.dim).map(|axis| self.axis[index(axis)]).product();
            // What is below this would take part less than once in 2^53 draws.
            if phi > 1e-16 && stream.uniform() < phi {
                modes.extend((0..self.dim).map(|axis| index(axis) as i32 - self.reach));
            }
        }
        Ok(modes)
    }

    /// The sum over one axis of `phi(k) phi(k + m)`.
    fn overlap(&self, m: i32) -> f64 {
        let m = m.unsigned_abs() as usize;
        self.axis.iter().zip(self.axis.iter().skip(m)).map(|(a, b)| a * b).sum()
    }

    fn sum_of_squares(&self) -> f64 {
        self.overlap(0).powi(self.dim as i32)
    }
}

impl Sampler for GaussianDpp {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let modes = self.modes(&mut stream, control)?;
        draw(&Waves { dim: self.dim, reach: self.reach, modes }, &mut stream, control)
    }

    fn count(&self, which: &Realization, control: &Control) -> Result<u64> {
        Ok((self.modes(&mut which.stream(), control)?.len() / self.dim) as u64)
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        let n2 = self.n * self.n;
        // Where images of the kernel could be seen, it has no simple mean over directions.
        let alone = (-(0.5 / self.range).powi(2)).exp() < 1e-7;
        alone.then(|| (n2 - n2 * (-2.0 * (r / self.range).powi(2)).exp()) / (n2 - self.sum_of_squares()))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        Some(1.0 - m.iter().map(|&m| self.overlap(m)).product::<f64>() / self.n)
    }

    fn count_variance(&self) -> Option<f64> {
        Some(self.n - self.sum_of_squares())
    }
}

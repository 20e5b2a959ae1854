//! The perturbed lattice: every point of the regular grid of n = k^d cell centres moved by an offset of its own, Gaussian or
//! uniform in a box, wrapped (Klatt, Kim, Torquato, "Cloaking the underlying long-range order of randomly perturbed
//! lattices", Phys. Rev. E 2020).
//!
//! With phi the characteristic function of an offset, exactly at any n = k^d,
//!
//! ```text
//! P(m) = 1 - |phi(m)|^2 + |phi(m)|^2 n [all m_j multiples of k]
//! gaussian: |phi|^2 = exp(-4 pi^2 sigma^2 |m|^2), sigma = width / k      box: |phi|^2 = prod_j sinc^2(width m_j / k)
//! g(r vec) = sum_L f(r vec - L) / (n - 1)     over the n - 1 other points of the lattice, f the density of the difference
//!                                             of two offsets
//! ```
//!
//! A box of width 1 is jittered sampling; whole widths cloak all peaks.

use std::f64::consts::PI;
use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};

use crate::control::Control;
use crate::error::Result;
use crate::samplers::size::root_below;
use crate::samplers::{Accepts, Entry, Family, Parameter, Realization, Sampler, Size, cells, gaussian, wrap};
use crate::sinc::sinc;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["gaussian-jitter"],
    source: "Klatt, Kim, Torquato 2020",
    formulas: "P = 1 - |phi|^2 + |phi|^2 n [m = 0 mod k]; gaussian: |phi|^2 = exp(-4 pi^2 s^2 nu^2), s = width/k; box: |phi|^2 = prod sinc^2(width m_j/k)",
    size: Size::POWER,
    parameters: &[
        Parameter::new("kernel", "gaussian", Accepts::OneOf(&["gaussian", "box"]), "the law of the offsets"),
        Parameter::new(
            "width",
            "0.25",
            Accepts::Between(0.0, 10.0),
            "standard deviation of the offsets along each axis, or side of the box, in cells",
        ),
    ],
    ..Entry::new("perturbed-grid", Family::Independent, "grid whose points are moved independently", |given| {
        let k = root_below(given.n, given.dim);
        let gaussian = given.values.word("kernel")? == "gaussian";
        let width = given.values.number("width")?;
        Ok(Arc::new(PerturbedGrid { k, n: given.n, dim: given.dim, gaussian, width }))
    })
};

struct PerturbedGrid {
    k: u64,
    n: u64,
    dim: usize,
    gaussian: bool,
    /// In cells.
    width: f64,
}

impl Sampler for PerturbedGrid {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let moved = |cell: u64| {
            let offset: f64 =
                if self.gaussian { StandardNormal.sample(&mut stream.rng) } else { stream.uniform() - 0.5 };
            wrap((cell as f64 + 0.5 + self.width * offset) / self.k as f64)
        };
        Ok(cells(which.n, self.k, which.dim).map(moved).collect())
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        let sigma = self.width / self.k as f64;
        if !self.gaussian || self.width == 0.0 || self.n < 2 || !(0.0..=0.5).contains(&r) {
            return None;
        }
        let variance = 2.0 * sigma * sigma;
        let k = self.k as i64;
        let reach = ((r + (2.0 * variance * gaussian::REACH).sqrt()) * k as f64).ceil() as i64;
        let axis = |used: bool| if used { -reach..=reach } else { 0..=0 };
        let mut sum = 0.0;
        for x in axis(true) {
            for y in axis(self.dim > 1) {
                for z in axis(self.dim > 2) {
                    // An image of a point is not another point.
                    if x % k != 0 || y % k != 0 || z % k != 0 {
                        let far = ((x * x + y * y + z * z) as f64).sqrt() / k as f64;
                        sum += gaussian::about(self.dim, variance, r, far);
                    }
                }
            }
        }
        Some(sum / (self.n - 1) as f64)
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let k = self.k as f64;
        let phi2: f64 = if self.gaussian {
            let m2: f64 = m.iter().map(|&m| f64::from(m).powi(2)).sum();
            (-4.0 * PI * PI * (self.width / k).powi(2) * m2).exp()
        } else {
            m.iter().map(|&m| sinc(self.width * f64::from(m) / k).powi(2)).product()
        };
        let on_peak = m.iter().all(|m| i64::from(*m) % self.k as i64 == 0);
        Some(1.0 - phi2 + if on_peak { phi2 * self.n as f64 } else { 0.0 })
    }
}

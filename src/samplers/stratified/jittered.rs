//! Jittered sampling: one uniform point in each of n = k^d equal cubes (Cook, "Stochastic sampling in computer graphics",
//! TOG 1986).
//!
//! Points of different cubes are independent; what the process lacks against a random one are the pairs within one cube,
//! whose difference has density `prod_j k (1 - k |r_j|)`. Hence, exactly at any n = k^d,
//!
//! ```text
//! P(m) = 1 - prod_j sinc^2(m_j / k)          g(r vec) = n / (n - 1) (1 - prod_j (1 - k |r_j|)_+)
//! ```
//!
//! (the first term by term the Fourier transform of the second; in rendering e.g. Pilleboue et al., "Variance Analysis for
//! Monte Carlo Integration", TOG 2015). The mean of g over directions follows from `overlap` below.

use std::f64::consts::{PI, SQRT_2};
use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::quadrature::simpson;
use crate::samplers::size::root_below;
use crate::samplers::{Entry, Family, Realization, Sampler, Size, cells, in_cell};
use crate::sinc::sinc;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["stratified"],
    source: "Cook 1986",
    formulas: "P = 1 - prod sinc^2(m_j/k); g(r) = n/(n-1) (1 - mean over directions of prod (1 - k|r_j|)+)",
    size: Size::POWER,
    ..Entry::new("jittered", Family::Stratified, "one uniform point in each of n = k^d equal cells", |given| {
        Ok(Arc::new(Jittered { k: root_below(given.n, given.dim), n: given.n, dim: given.dim }))
    })
};

struct Jittered {
    k: u64,
    n: u64,
    dim: usize,
}

impl Sampler for Jittered {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let k = self.k as f64;
        Ok(cells(which.n, self.k, which.dim).map(|cell| in_cell(cell, stream.uniform(), k)).collect())
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        let (k, n) = (self.k as f64, self.n as f64);
        (n >= 2.0 && (0.0..=0.5).contains(&r)).then(|| n / (n - 1.0) * (1.0 - overlap(self.dim, k * r)))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        Some(1.0 - m.iter().map(|&m| sinc(f64::from(m) / self.k as f64).powi(2)).product::<f64>())
    }
}

/// The mean of `prod_j (1 - rho |u_j|)_+` over unit vectors u: the overlap of a unit cube with itself shifted by rho.
fn overlap(dim: usize, rho: f64) -> f64 {
    match dim {
        1 => (1.0 - rho).max(0.0),
        2 => overlap_square(rho),
        _ => overlap_cube(rho),
    }
}

/// The integral of `(1 - rho |cos t|)_+ (1 - rho |sin t|)_+` over the circle, by elementary functions.
fn overlap_square(rho: f64) -> f64 {
    if rho <= 1.0 {
        1.0 - (4.0 - rho) * rho / PI
    } else if rho < SQRT_2 {
        let (angle, chord) = ((1.0 / rho).asin() - (1.0 / rho).acos(), (rho * rho - 1.0).sqrt());
        (2.0 / PI * (angle - 1.0 + 2.0 * chord - rho * rho / 2.0)).max(0.0)
    } else {
        0.0
    }
}

/// On the sphere `t = |u_3|` is uniform in [0, 1] (Archimedes), and the rest is a circle of radius `sqrt(1 - t^2)`. Up
/// to rho = 1 all factors are positive, and the moments of |u_j| give a polynomial; beyond, a quadrature between
/// the kinks.
fn overlap_cube(rho: f64) -> f64 {
    if rho <= 1.0 {
        return 1.0 - 1.5 * rho + 2.0 / PI * rho * rho - rho.powi(3) / (4.0 * PI);
    }
    if rho >= 3f64.sqrt() {
        return 0.0;
    }
    let integrand = |t: f64| (1.0 - rho * t).max(0.0) * overlap_square(rho * (1.0 - t * t).max(0.0).sqrt());
    let corner = |square: f64| (1.0 - square / (rho * rho)).max(0.0).sqrt();
    let mut cuts = [corner(2.0), corner(1.0), 1.0 / rho];
    cuts.sort_unstable_by(f64::total_cmp);
    let mut sum = 0.0;
    let mut from = 0.0;
    for to in cuts {
        // Absolute error below 1e-9 here.
        sum += simpson::<256>(from, to).map(|(t, weight)| weight * integrand(t)).sum::<f64>();
        from = to;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule over directions, straight from the definition.
    fn overlap_by_definition(dim: usize, rho: f64) -> f64 {
        let steps = 2000;
        let mean =
            |f: &dyn Fn(f64) -> f64| (0..steps).map(|i| f((i as f64 + 0.5) / steps as f64)).sum::<f64>() / steps as f64;
        let tent = |x: f64| (1.0 - rho * x.abs()).max(0.0);
        let circle = |radius: f64| {
            mean(&|s: f64| {
                let (sin, cos) = (s * PI / 2.0).sin_cos();
                tent(radius * cos) * tent(radius * sin)
            })
        };
        match dim {
            2 => circle(1.0),
            _ => mean(&|t: f64| tent(t) * circle((1.0 - t * t).sqrt())),
        }
    }

    #[test]
    fn the_overlap_is_the_mean_over_directions() {
        for dim in [2, 3] {
            for rho in [0.0, 0.3, 0.999, 1.0, 1.001, 1.2, 1.4, 1.42, 1.6, 1.73, 1.8] {
                let (closed, plain) = (overlap(dim, rho), overlap_by_definition(dim, rho));
                assert!((closed - plain).abs() < 2e-6, "{dim}D, rho {rho}: {closed} against {plain}");
            }
        }
    }
}

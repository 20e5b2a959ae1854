//! The Thomas process (Thomas 1949; a Neyman-Scott cluster process): a Poisson number of uniform parents, mean n / mu; each
//! has a Poisson number of children, mean mu, at Gaussian offsets of standard deviation sigma per axis, wrapped. Only the
//! children are points, so their number is random, with mean n and variance n (1 + mu).
//!
//! The difference of two children of one parent is a wrapped Gaussian of standard deviation `sqrt(2) sigma`. Exactly on
//! the torus (Illian et al. 2008 for g in units of lambda^2; here the pairs sum to `E[N (N - 1)] = n^2 (1 + mu / n)`):
//!
//! ```text
//! P(m) = 1 + mu exp(-4 pi^2 sigma^2 |m|^2)
//! g(r) = [1 + (mu / n) sum_images exp(-|r + j|^2 / 4 sigma^2) / (4 pi sigma^2)^(d/2)] / (1 + mu / n)
//! ```

use std::f64::consts::PI;

use rand_distr::{Distribution, Poisson, StandardNormal};

use super::stream::{stream, uniform};
use super::{Accepts, Parameter, ParameterValues, Realization, Sampler, wrap};
use crate::error::{Error, Result};
use crate::setting::Setting;

pub(super) struct Thomas;

/// Beyond this share of the side, images further away than the three that `pair_correlation` sums would matter.
const WIDEST: f64 = 0.2;

impl Sampler for Thomas {
    fn name(&self) -> &'static str {
        "thomas"
    }

    fn summary(&self) -> &'static str {
        "Thomas cluster process: Gaussian clusters around random parents; n is the expected number"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter {
                name: "mu",
                default: "10",
                accepts: Accepts::Between(0.01, 1e6),
                help: "mean number of points per cluster; there are n / mu clusters on average",
            },
            Parameter {
                name: "sigma",
                default: "0.5",
                accepts: Accepts::Above(0.0, 1e6),
                help: "standard deviation of a cluster along each axis, in units of n^(-1/d)",
            },
        ]
    }

    fn fixed_n(&self) -> bool {
        false
    }

    fn generate(&self, realization: &Realization, values: &ParameterValues) -> Result<Vec<f64>> {
        let Realization { n, dim, .. } = *realization;
        self.check(n, dim, values)?;
        let (mu, sigma) = shape(n, dim, values)?;
        let mut rng = stream(self, values, realization);
        let poisson = |mean: f64| {
            Poisson::new(mean)
                .map_err(|e| Error::setting(Setting::Params, format!("mu={mu}"), format!("Poisson({mean}): {e}")))
        };
        let (parents, children) = (poisson(n as f64 / mu)?, poisson(mu)?);
        let mut points = Vec::new();
        for _ in 0..parents.sample(&mut rng) as u64 {
            let parent: [f64; 3] = std::array::from_fn(|k| if k < dim { uniform(&mut rng) } else { 0.0 });
            for _ in 0..children.sample(&mut rng) as u64 {
                for x in &parent[..dim] {
                    let normal: f64 = StandardNormal.sample(&mut rng);
                    points.push(wrap(x + sigma * normal));
                }
            }
        }
        Ok(points)
    }

    fn pair_correlation(&self, n: u64, dim: usize, r: f64, values: &ParameterValues) -> Option<f64> {
        let (mu, sigma) = shape(n, dim, values).ok()?;
        if !(sigma <= WIDEST && (0.0..=0.5).contains(&r)) {
            return None;
        }
        let share = mu / n as f64;
        Some((1.0 + share * siblings(dim, sigma, r)) / (1.0 + share))
    }

    fn power(&self, n: u64, m: [i32; 3], dim: usize, values: &ParameterValues) -> Option<f64> {
        let (mu, sigma) = shape(n, dim, values).ok()?;
        let m2: f64 = m[..dim].iter().map(|&m| f64::from(m).powi(2)).sum();
        Some(1.0 + mu * (-4.0 * PI * PI * sigma * sigma * m2).exp())
    }
}

/// mu, and sigma in units of the side.
fn shape(n: u64, dim: usize, values: &ParameterValues) -> Result<(f64, f64)> {
    Ok((values.number("mu")?, values.number("sigma")? * (n as f64).powf(-1.0 / dim as f64)))
}

/// The density of sibling differences, averaged over the directions of a difference of length r.
fn siblings(dim: usize, sigma: f64, r: f64) -> f64 {
    let four_sigma2 = 4.0 * sigma * sigma;
    let images = |k: usize| if k < dim { -3..=3 } else { 0..=0 };
    let mut sum = 0.0;
    for x in images(0) {
        for y in images(1) {
            for z in images(2) {
                let far = f64::from(x * x + y * y + z * z).sqrt();
                // exp(-(r^2 + far^2 - 2 r far cos t) / 4 sigma^2) = exp(-(r - far)^2 / ..) exp(-steepness (1 - cos t)).
                let nearest = (r - far).powi(2) / four_sigma2;
                if nearest < 60.0 {
                    sum += (-nearest).exp() * mean_over_directions(dim, 2.0 * r * far / four_sigma2);
                }
            }
        }
    }
    sum / (PI * four_sigma2).powf(dim as f64 / 2.0)
}

/// The mean of `exp(-steepness (1 - cos t))` over directions, t the angle to a fixed one.
fn mean_over_directions(dim: usize, steepness: f64) -> f64 {
    match dim {
        _ if steepness == 0.0 => 1.0,
        1 => (1.0 + (-2.0 * steepness).exp()) / 2.0,
        // The midpoint rule over a period of an entire function converges faster than any power; enough here because
        // an image that is not negligible has a steepness below some 300.
        2 => {
            let steps = 256;
            let angle = |i: u32| PI * (f64::from(i) + 0.5) / f64::from(steps);
            (0..steps).map(|i| (-steepness * (1.0 - angle(i).cos())).exp()).sum::<f64>() / f64::from(steps)
        }
        // cos t is uniform in [-1, 1].
        _ => -(-2.0 * steepness).exp_m1() / (2.0 * steepness),
    }
}

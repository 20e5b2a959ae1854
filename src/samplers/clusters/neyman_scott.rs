//! Neyman-Scott processes (Neyman, Scott 1958): a Poisson number of uniform parents, mean n / mu, each with a Poisson number of
//! children, mean mu, at independent offsets, wrapped. Only the children are points, so their number has mean n and
//! variance n (1 + mu).
//!
//! With phi the characteristic function of an offset and f the wrapped density of the difference of two, exactly on the torus (Illian
//! et al. 2008 for g in units of lambda^2; here the pairs sum to `E[N (N - 1)] = n^2 (1 + mu / n)`):
//!
//! ```text
//! P(m) = 1 + mu |phi(m)|^2          g(r) = (1 + (mu / n) f(r)) / (1 + mu / n)
//! ```

use rand_distr::{Distribution, Poisson};

use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Accepts, Given, Parameter, Realization, Sampler, Stream, poisson, wrap};

/// The parameter that they share.
pub(super) const MU: Parameter = Parameter::new(
    "mu",
    "10",
    Accepts::Between(0.01, 1e6),
    "mean number of points per cluster; there are n / mu clusters on average",
);

/// Where a child is, seen from its parent.
pub(super) trait Offset: Send + Sync {
    /// One offset, a coordinate per axis.
    fn draw(&self, stream: &mut Stream, offset: &mut [f64]);

    /// `|phi|^2` at frequency nu.
    fn energy(&self, nu: f64) -> f64;

    /// The wrapped density of the difference of two, averaged over directions; `None` where it is not known.
    fn difference(&self, r: f64) -> Option<f64>;
}

/// The process of an offset.
pub(super) struct NeymanScott<O> {
    n: f64,
    dim: usize,
    mu: f64,
    parents: Poisson<f64>,
    children: Poisson<f64>,
    offset: O,
}

impl<O: Offset> NeymanScott<O> {
    /// Of n, mu and an offset.
    pub(super) fn new(given: &Given<'_>, offset: O) -> Result<Self> {
        let (n, mu) = (given.n as f64, given.values.number("mu")?);
        Ok(Self { n, dim: given.dim, mu, parents: poisson(n / mu)?, children: poisson(mu)?, offset })
    }
}

/// A length in units of n^(-1/d).
pub(super) fn length(given: &Given<'_>, name: &'static str) -> Result<f64> {
    Ok(given.values.number(name)? * (given.n as f64).powf(-1.0 / given.dim as f64))
}

impl<O: Offset> Sampler for NeymanScott<O> {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let mut points = Vec::new();
        let (mut parent, mut offset) = (vec![0.0; self.dim], vec![0.0; self.dim]);
        for _ in 0..self.parents.sample(&mut stream.rng) as u64 {
            control.check()?;
            parent.fill_with(|| stream.uniform());
            for _ in 0..self.children.sample(&mut stream.rng) as u64 {
                self.offset.draw(&mut stream, &mut offset);
                // Fractions first: an offset may be far longer than the torus.
                points.extend(parent.iter().zip(&offset).map(|(x, d)| wrap(x + d.fract())));
            }
        }
        Ok(points)
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        let share = self.mu / self.n;
        (0.0..=0.5).contains(&r).then_some(())?;
        Some((1.0 + share * self.offset.difference(r)?) / (1.0 + share))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let nu = m.iter().map(|&m| f64::from(m).powi(2)).sum::<f64>().sqrt();
        Some(1.0 + self.mu * self.offset.energy(nu))
    }

    fn count_variance(&self) -> Option<f64> {
        Some(self.n * (1.0 + self.mu))
    }
}

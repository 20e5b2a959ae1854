//! Matern's hard-core processes (Matern 1960): of a Poisson process of parents, type I keeps those without another within a
//! radius, type II those without an *older* one. An eliminated parent of type II still eliminates younger ones.
//!
//! With A the volume of a ball of radius R, V(r) that of the union of two at a distance r, and lambda the density of parents,
//!
//! ```text
//! type I:   n = lambda exp(-lambda A), the smaller root (n A <= 1/e)     rho_2(r) = lambda^2 exp(-lambda V)
//! type II:  lambda = -ln(1 - n A) / A (n A < 1)      rho_2(r) = [2 V (1 - exp(-lambda A)) - 2 A (1 - exp(-lambda V))] / (A V (V - A))
//! ```
//!
//! beyond R, 0 below, n^2 from 2 R on, and
//!
//! ```text
//! P(m) = 1 + (1/n) int_(r < 2 R) (rho_2 - n^2) exp(-2 pi i m.r) dr     Var n = n P(0)     g = rho_2 / (n^2 - n + Var n)
//! ```
//!
//! exact on the torus while 4 R <= 1.

use std::f64::consts::PI;
use std::sync::Arc;

use rand_distr::{Distribution, Poisson};

use crate::ball::unit_ball;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::samplers::quadrature::simpson;
use crate::samplers::torus_cells::TorusCells;
use crate::samplers::{Accepts, Entry, Family, Given, Number, Parameter, Realization, Sampler, poisson};
use crate::setting::Setting;
use crate::sinc::sinc;

const FORMULAS: &str = "P = 1 + (1/n) int (rho_2 - n^2) exp(-2 pi i m.r) dr, Var n = n P(0), g = rho_2 / (n^2 - n + Var n), exact while 4 R <= 1";

pub(in crate::samplers) static TYPE_I: Entry = Entry {
    source: "Matern 1960",
    formulas: FORMULAS,
    number: Number::Expected,
    parameters: &[Parameter::new(
        "radius",
        "0.15",
        Accepts::Above(0.0, 1.0),
        "hard-core distance, relative to the closest packing of n points; below 0.184 (1D), 0.318 (2D), 0.396 (3D)",
    )],
    ..Entry::new(
        "matern-i",
        Family::BlueNoise,
        "Matern's type I hard core: of random parents those without another within a radius",
        |given| make(given, Kind::One),
    )
};

pub(in crate::samplers) static TYPE_II: Entry = Entry {
    source: "Matern 1960",
    formulas: FORMULAS,
    number: Number::Expected,
    parameters: &[Parameter::new(
        "radius",
        "0.4",
        Accepts::Above(0.0, 1.0),
        "hard-core distance, relative to the closest packing of n points; below 0.5 (1D), 0.525 (2D), 0.552 (3D)",
    )],
    ..Entry::new(
        "matern-ii",
        Family::BlueNoise,
        "Matern's type II hard core: of random parents those without an older one within a radius",
        |given| make(given, Kind::Two),
    )
};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    One,
    Two,
}

struct Matern {
    kind: Kind,
    dim: usize,
    n: f64,
    /// R, in units of the side.
    radius: f64,
    /// lambda, and A.
    density: f64,
    ball: f64,
    parents: Poisson<f64>,
    /// The integral of `rho_2 - n^2` over r < 2 R as a sum over distances.
    shells: Vec<(f64, f64)>,
}

/// Volume of a ball.
fn ball(dim: usize, r: f64) -> f64 {
    unit_ball(dim) * r.powi(dim as i32)
}

/// Volume of the union of two balls of radius R whose centres are r <= 2 R apart.
fn union(dim: usize, radius: f64, r: f64) -> f64 {
    let overlap = match dim {
        1 => 2.0 * radius - r,
        2 => {
            let half = (r / (2.0 * radius)).min(1.0);
            2.0 * radius * radius * half.acos() - 0.5 * r * (4.0 * radius * radius - r * r).max(0.0).sqrt()
        }
        _ => PI / 12.0 * (4.0 * radius + r) * (2.0 * radius - r).powi(2),
    };
    2.0 * ball(dim, radius) - overlap
}

fn make(given: &Given<'_>, kind: Kind) -> Result<Arc<dyn Sampler>> {
    let (n, dim) = (given.n as f64, given.dim);
    let relative = given.values.number("radius")?;
    let packing = Domain::unit_torus(dim).closest_packing_distance(n);
    let radius = relative * packing;
    let a = ball(dim, radius);
    let most: f64 = if kind == Kind::One { (-1.0f64).exp() } else { 1.0 };
    if n * a >= most {
        let limit = (most / unit_ball(dim) / n).powf(1.0 / dim as f64) / packing;
        let name = if kind == Kind::One { "matern-i" } else { "matern-ii" };
        let reason =
            format!("radius of {name} in {dim}D is below {limit:.3}: no density of parents leaves so many points");
        return Err(Error::setting(Setting::Params, format!("radius={relative}"), reason));
    }
    let density = match kind {
        Kind::Two => -(-n * a).ln_1p() / a,
        Kind::One => smaller_root(n * a) / a,
    };
    let mut matern = Matern { kind, dim, n, radius, density, ball: a, parents: poisson(density)?, shells: Vec::new() };
    let surface = |r: f64| [2.0, 2.0 * PI * r, 4.0 * PI * r * r][dim - 1];
    for (from, to) in [(0.0, radius), (radius, 2.0 * radius)] {
        let part = simpson::<512>(from, to).map(|(r, weight)| {
            // At R itself the integrand jumps; each part ends with its own side of it.
            let rho2 = if to == radius { 0.0 } else { matern.rho2_beyond(r) };
            (r, weight * surface(r) * (rho2 - n * n))
        });
        let part: Vec<_> = part.collect();
        matern.shells.extend(part);
    }
    Ok(Arc::new(matern))
}

/// x <= 1 with `x exp(-x) = share`, by Newton's rule from below.
fn smaller_root(share: f64) -> f64 {
    let mut x = share;
    for _ in 0..200 {
        let step = (x * (-x).exp() - share) / ((1.0 - x) * (-x).exp());
        x -= step;
        if step.abs() <= 1e-15 * x {
            break;
        }
    }
    x
}

impl Matern {
    /// rho_2 at R <= r <= 2 R.
    fn rho2_beyond(&self, r: f64) -> f64 {
        let (a, lambda) = (self.ball, self.density);
        let v = union(self.dim, self.radius, r);
        match self.kind {
            Kind::One => lambda * lambda * (-lambda * v).exp(),
            Kind::Two => {
                let gone = |volume: f64| -(-lambda * volume).exp_m1();
                2.0 * (v * gone(a) - a * gone(v)) / (a * v * (v - a))
            }
        }
    }

    fn is_exact(&self) -> bool {
        4.0 * self.radius <= 1.0
    }

    fn excess(&self, nu: f64) -> f64 {
        let wave = |r: f64| match self.dim {
            1 => (2.0 * PI * nu * r).cos(),
            2 => libm::j0(2.0 * PI * nu * r),
            _ => sinc(2.0 * nu * r),
        };
        self.shells.iter().map(|&(r, weight)| weight * wave(r)).sum()
    }

    fn thinned<const D: usize>(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let number = self.parents.sample(&mut stream.rng) as usize;
        let mut cells = TorusCells::<D>::new(number.max(1), self.radius);
        for _ in 0..number {
            cells.push(std::array::from_fn(|_| stream.uniform()));
        }
        let mut kept = Vec::new();
        for (i, point) in cells.points.iter().enumerate() {
            if i % 4096 == 0 {
                control.check()?;
            }
            // Parents come in the order of their age: independent of where they are, without ties.
            let eliminated = cells.any_near(point, |j| if self.kind == Kind::One { j != i } else { j < i });
            if !eliminated {
                kept.extend(point);
            }
        }
        Ok(kept)
    }
}

impl Sampler for Matern {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        match self.dim {
            1 => self.thinned::<1>(which, control),
            2 => self.thinned::<2>(which, control),
            _ => self.thinned::<3>(which, control),
        }
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        let pairs = self.n * self.n - self.n + self.count_variance()?;
        let rho2 = match r / self.radius {
            near if near < 1.0 => 0.0,
            near if near < 2.0 => self.rho2_beyond(r),
            _ => self.n * self.n,
        };
        (pairs > 0.0).then(|| rho2 / pairs)
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let nu = m.iter().map(|&m| f64::from(m).powi(2)).sum::<f64>().sqrt();
        self.is_exact().then(|| 1.0 + self.excess(nu) / self.n)
    }

    fn count_variance(&self) -> Option<f64> {
        self.is_exact().then(|| self.n + self.excess(0.0))
    }
}

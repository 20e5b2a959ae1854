//! Stealthy hyperuniform sets: P = 0 at all frequencies up to nu_0, by collective coordinates (Uche, Stillinger, Torquato 2004;
//! Batten, Stillinger, Torquato 2008).
//!
//! From independent points, `sum P(m)` over 0 < |m| <= nu_0 descends to 0 by L-BFGS (Nocedal 1980), gradient from the s_m. `chi`, the
//! number of such pairs +-m over d (n - 1), is the share of constrained degrees of freedom: up to 0.45 a solution is found without trouble.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::samplers::waves::Waves;
use crate::samplers::{Accepts, Entry, Family, Given, Parameter, Realization, Sampler, wrap};
use crate::setting::Setting;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Uche, Stillinger, Torquato 2004; Batten, Stillinger, Torquato 2008",
    formulas: "P = 0 for 0 < nu <= nu_0",
    parameters: &[
        Parameter::new(
            "nu0",
            "0.5",
            Accepts::Above(0.0, 10.0),
            "frequency up to which P is 0, in units of n^(1/d); about 0.75 at most in 2D",
        ),
        Parameter::new("iterations", "5000", Accepts::Whole(1, 1_000_000), "steps of the descent at most"),
    ],
    ..Entry::new("stealthy", Family::BlueNoise, "stealthy hyperuniform points: P = 0 at low frequencies", make)
};

/// The share of constrained degrees of freedom up to which the descent ends.
const MOST_CONSTRAINED: f64 = 0.45;

/// The largest P that counts as 0.
const NOTHING: f64 = 1e-20;

/// Steps that the descent remembers.
const MEMORY: usize = 10;

struct Stealthy {
    dim: usize,
    n: usize,
    iterations: u64,
    /// Those of a half space of modes.
    waves: Waves,
}

fn make(given: &Given<'_>) -> Result<Arc<dyn Sampler>> {
    let (n, dim) = (given.n, given.dim);
    let relative = given.values.number("nu0")?;
    let nu0 = relative * (n as f64).powf(1.0 / dim as f64);
    let reach = nu0.floor() as i32;
    let modes = half_space(dim, reach, nu0 * nu0 * (1.0 + 1e-12));
    let pairs = modes.len() / dim;
    let free = dim as f64 * (n as f64 - 1.0);
    if pairs as f64 > MOST_CONSTRAINED * free {
        // Shorter by one mode at a time, from what was asked for.
        let fits = |nu0: f64| half_space(dim, nu0.floor() as i32, nu0 * nu0).len() / dim;
        let least = (0..1000).map(|k| relative * (1.0 - f64::from(k) / 1000.0));
        let most = least.map(|r| r * nu0 / relative).find(|&nu0| fits(nu0) as f64 <= MOST_CONSTRAINED * free);
        let reason = format!(
            "constrains {:.2} of the degrees of freedom of {n} points in {dim}D; a solution is found up to {MOST_CONSTRAINED}, nu0 = {:.3}",
            pairs as f64 / free.max(1.0),
            most.unwrap_or(0.0) * relative / nu0
        );
        return Err(Error::setting(Setting::Params, format!("nu0={relative}"), reason));
    }
    let iterations = given.values.whole("iterations")?.unwrap_or(5000);
    Ok(Arc::new(Stealthy { dim, n: n as usize, iterations, waves: Waves { dim, reach, modes } }))
}

/// The modes m != 0 with |m|^2 at most `most`, one of each pair +-m.
fn half_space(dim: usize, reach: i32, most: f64) -> Vec<i32> {
    let axis = |used: bool| if used { -reach..=reach } else { 0..=0 };
    let mut modes = Vec::new();
    for x in axis(true) {
        for y in axis(dim > 1) {
            for z in axis(dim > 2) {
                let m = [x, y, z];
                let length2 = m.iter().map(|&m| f64::from(m) * f64::from(m)).sum::<f64>();
                if length2 <= most && m.iter().find(|m| **m != 0).is_some_and(|m| *m > 0) {
                    modes.extend(&m[..dim]);
                }
            }
        }
    }
    modes
}

/// Sum of P over the modes, the largest of them, and its gradient.
struct Energy {
    sum: f64,
    largest: f64,
    gradient: Vec<f64>,
}

impl Stealthy {
    fn energy(&self, x: &[f64]) -> Energy {
        let (dim, modes) = (self.dim, self.waves.len());
        let (mut re, mut im) = (vec![0.0; modes], vec![0.0; modes]);
        let mut sums = [vec![0.0; modes], vec![0.0; modes]];
        for point in x.chunks_exact(dim) {
            self.waves.values(point, &mut re, &mut im);
            for (sums, values) in sums.iter_mut().zip([&re, &im]) {
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
        let n = self.n as f64;
        let power = sums[0].iter().zip(&sums[1]).map(|(a, b)| (a * a + b * b) / n);
        let (sum, largest) = power.fold((0.0, 0.0f64), |(sum, largest), p| (sum + p, largest.max(p)));
        // d |s|^2 / dx = 2 Re(conj(s) 2 pi i m w) = -4 pi m Im(conj(s) w).
        let mut gradient = vec![0.0; x.len()];
        for (point, pull) in x.chunks_exact(dim).zip(gradient.chunks_exact_mut(dim)) {
            self.waves.values(point, &mut re, &mut im);
            for (k, mode) in self.waves.modes.chunks_exact(dim).enumerate() {
                let crossed = sums[0][k] * im[k] - sums[1][k] * re[k];
                for (pull, &m) in pull.iter_mut().zip(mode) {
                    *pull -= 2.0 * TAU * f64::from(m) * crossed / n;
                }
            }
        }
        Energy { sum, largest, gradient }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The steps of late, for the direction that L-BFGS takes (Nocedal, Wright, Numerical Optimization, algorithm 7.4).
#[derive(Default)]
struct Steps {
    /// Differences of places and of gradients.
    all: std::collections::VecDeque<(Vec<f64>, Vec<f64>)>,
}

impl Steps {
    fn remember(&mut self, step: Vec<f64>, change: Vec<f64>) {
        // Only where the curvature is positive is there something to learn.
        if dot(&step, &change) > 1e-10 * dot(&change, &change).sqrt() * dot(&step, &step).sqrt() {
            if self.all.len() == MEMORY {
                self.all.pop_front();
            }
            self.all.push_back((step, change));
        }
    }

    fn direction(&self, gradient: &[f64]) -> Vec<f64> {
        let mut d: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut weights = Vec::with_capacity(self.all.len());
        for (step, change) in self.all.iter().rev() {
            let weight = dot(step, &d) / dot(step, change);
            d.iter_mut().zip(change).for_each(|(d, y)| *d -= weight * y);
            weights.push(weight);
        }
        if let Some((step, change)) = self.all.back() {
            let scale = dot(step, change) / dot(change, change);
            d.iter_mut().for_each(|d| *d *= scale);
        }
        for ((step, change), weight) in self.all.iter().zip(weights.into_iter().rev()) {
            let back = dot(change, &d) / dot(step, change);
            d.iter_mut().zip(step).for_each(|(d, s)| *d += (weight - back) * s);
        }
        d
    }
}

impl Sampler for Stealthy {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let mut x: Vec<f64> = (0..self.n * self.dim).map(|_| stream.uniform()).collect();
        let mut here = self.energy(&x);
        let mut steps = Steps::default();
        // At first a tenth of the mean spacing at most, for whichever point moves farthest.
        let spacing = (self.n as f64).powf(-1.0 / self.dim as f64);
        for _ in 0..self.iterations {
            control.check()?;
            if here.largest < NOTHING {
                break;
            }
            let mut d = steps.direction(&here.gradient);
            if dot(&d, &here.gradient) >= 0.0 {
                steps = Steps::default();
                d = steps.direction(&here.gradient);
            }
            let farthest = d.iter().fold(0.0f64, |most, d| most.max(d.abs()));
            let mut length = if farthest > 0.1 * spacing { 0.1 * spacing / farthest } else { 1.0 };
            let slope = dot(&d, &here.gradient);
            let mut moved = None;
            for _ in 0..60 {
                let place: Vec<f64> = x.iter().zip(&d).map(|(x, d)| wrap(x + length * d)).collect();
                let there = self.energy(&place);
                if there.sum <= here.sum + 1e-4 * length * slope {
                    moved = Some((place, there));
                    break;
                }
                length *= 0.5;
            }
            let Some((place, there)) = moved else {
                if steps.all.is_empty() {
                    break;
                }
                steps = Steps::default();
                continue;
            };
            let step = d.iter().map(|d| length * d).collect();
            let change = there.gradient.iter().zip(&here.gradient).map(|(a, b)| a - b).collect();
            steps.remember(step, change);
            (x, here) = (place, there);
        }
        if here.largest < NOTHING {
            return Ok(x);
        }
        let reason = format!(
            "stealthy points did not converge: the largest P at a low frequency is {:.1e} after at most {} iterations; expected below {NOTHING:e}: more iterations, or a lower nu0",
            here.largest, self.iterations
        );
        Err(Error::setting(Setting::Params, format!("iterations={}", self.iterations), reason))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let one = |mode: &[i32]| mode == m || mode.iter().zip(m).all(|(a, b)| *a == -b);
        self.waves.modes.chunks_exact(self.dim).any(one).then_some(0.0)
    }
}

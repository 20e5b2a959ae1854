//! The error of integrals against the time that it takes to draw points and to evaluate integrands at them, by samplers.

use super::{Bench, Timing};
use crate::error::Result;
use crate::integrand::Integrand;

/// Of a sampler and an integrand, at a number of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Efficiency {
    /// The sampler.
    pub sampler: String,
    /// The integrand.
    pub integrand: String,
    /// Points of a realization.
    pub n: u64,
    /// Realizations.
    pub k: u64,
    /// Seconds that a realization takes to draw, on one thread.
    pub drawing: Timing,
    /// Seconds that the integrand takes at its points.
    pub evaluating: Timing,
    /// Variance of the integrand: of one random point.
    pub variance: f64,
    /// Root of the mean squared error of the integral.
    pub error: f64,
    /// Its standard error.
    pub error_se: f64,
}

impl Efficiency {
    /// Seconds of a realization, where evaluating takes `factor` times as long as here.
    pub fn seconds(&self, factor: f64) -> f64 {
        self.drawing.median + factor * self.evaluating.median
    }
}

/// Those that are the same points every time are shifted at random.
const SAMPLERS: [&str; 9] = [
    "random",
    "jittered",
    "lhs",
    "grid:shift=random",
    "sobol",
    "pmj02",
    "halton:shift=random",
    "kronecker:shift=random",
    "poisson-disk",
];

const INTEGRANDS: [&str; 3] = ["disk", "gaussian:sigma=0.1", "ramp"];

/// Those that are asked for, or the usual ones.
fn or_usual<'a>(asked: &'a [String], usual: &[&'a str]) -> Vec<&'a str> {
    if asked.is_empty() { usual.to_vec() } else { asked.iter().map(String::as_str).collect() }
}

/// Draws and evaluates, on one thread.
pub(super) fn measure(bench: &Bench<'_>, samplers: &[String], integrands: &[String]) -> Result<Vec<Efficiency>> {
    let (most, k): (u32, u64) = bench.size((10, 32), (12, 128));
    let integrands = or_usual(integrands, &INTEGRANDS);
    let integrands = integrands.into_iter().map(|spec| Integrand::new(spec, 2)).collect::<Result<Vec<_>>>()?;
    let mut samplers = or_usual(samplers, &SAMPLERS);
    // What others are compared with.
    if !samplers.contains(&"random") {
        samplers.insert(0, "random");
    }
    let mut all = Vec::new();
    for sampler in samplers {
        for n in (4..=most).step_by(2).map(|e| 1u64 << e) {
            let process = super::process(sampler, n, k, 2)?;
            // A realization after the other, each timed.
            let (mut drawn, mut spent) = (Vec::new(), Vec::new());
            for index in 0..k {
                let start = crate::control::Instant::now();
                let coordinates = process.coordinates(index, bench.control)?;
                spent.push(start.elapsed().as_secs_f64());
                drawn.push(coordinates.chunks_exact(2).map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>());
            }
            let drawing = Timing::of(spent);
            for integrand in &integrands {
                let mut values = vec![0.0; n as usize];
                let mut squares = Vec::new();
                let mut seconds = Vec::new();
                for points in &drawn {
                    let start = crate::control::Instant::now();
                    integrand.values(points, &mut values);
                    let mean = values.iter().sum::<f64>() / n as f64;
                    seconds.push(start.elapsed().as_secs_f64());
                    squares.push((mean - integrand.integral()).powi(2));
                }
                let mse = crate::estimate::mean(&squares).unwrap_or(0.0);
                let mse_se = crate::estimate::standard_error(&squares).unwrap_or(0.0);
                let error = mse.sqrt();
                all.push(Efficiency {
                    sampler: sampler.into(),
                    integrand: integrand.spec().into(),
                    n,
                    k,
                    drawing,
                    evaluating: Timing::of(seconds),
                    variance: integrand.variance(),
                    error,
                    error_se: if error > 0.0 { 0.5 * mse_se / error } else { 0.0 },
                });
            }
        }
    }
    Ok(all)
}

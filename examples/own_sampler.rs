//! A sampler of one's own, measured like those of the registry and beside its closed form.

use std::sync::Arc;

use pairwave::control::Control;
use pairwave::samplers::{Process, Realization, Sampler};
use pairwave::{Domain, Points, Request, Result, Statistic, measure};

/// Antithetic pairs: independent points, each with its mirror image about the centre of the box.
struct Antithetic;

impl Sampler for Antithetic {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let mut points = Vec::new();
        for _ in 0..which.n / 2 {
            let point: Vec<f64> = (0..which.dim).map(|_| stream.uniform()).collect();
            points.extend_from_slice(&point);
            points.extend(point.iter().map(|x| (1.0 - x).fract()));
        }
        Ok(points)
    }
}

fn main() -> Result<()> {
    let process = Process::own("antithetic", Arc::new(Antithetic), 256, 200, 2, 1)?;
    let points = Points::sampled(process, Domain::unit_torus(2))?;
    let request = Request { stats: vec![Statistic::Radial, Statistic::Covariance], ..Request::default() };
    let found = measure(points, &request)?;
    if let Some(radial) = found.radial() {
        let mean = radial.rings.iter().map(|ring| ring.p).sum::<f64>() / radial.rings.len() as f64;
        println!("{}: mean of P over rings {mean:.3}; 1 for independent points", found.subject);
    }
    for warning in &found.warnings {
        println!("{warning}");
    }
    Ok(())
}

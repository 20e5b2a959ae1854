//! A sampler of one's own, measured like those of the registry and beside its closed form.

use std::sync::Arc;

use pairwave::samplers::{ParameterValues, Process, Realization, Sampler};
use pairwave::{Domain, Points, Request, Result, Statistic, measure};

/// Antithetic pairs: every point has its mirror image about the centre.
struct Antithetic;

impl Sampler for Antithetic {
    fn name(&self) -> &'static str {
        "antithetic"
    }

    fn summary(&self) -> &'static str {
        "Independent points, each with its mirror image about the centre of the box"
    }

    fn generate(&self, which: &Realization, _: &ParameterValues) -> Result<Vec<f64>> {
        // SplitMix64, seeded by what tells realizations apart.
        let mut state =
            which.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ which.index.wrapping_mul(0xd1b5_4a32_d192_ed03);
        let mut uniform = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / 2f64.powi(53)
        };
        let mut points = Vec::new();
        for _ in 0..which.n / 2 {
            let point: Vec<f64> = (0..which.dim).map(|_| uniform()).collect();
            points.extend_from_slice(&point);
            points.extend(point.iter().map(|x| (1.0 - x).fract()));
        }
        Ok(points)
    }
}

fn main() -> Result<()> {
    let process = Process::own(Arc::new(Antithetic), 256, 200, 2, 1)?;
    let points = Points::sampled(process, Domain::unit_torus(2));
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

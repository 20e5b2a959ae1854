//! What tests of integration errors share.

use crate::common::*;
use pairwave::accumulate::{IntegrandSums, IntegrationSums};
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::estimate::{Analysis, IntegrationError};
use pairwave::plan::{Accuracy, IntegrationPlan, IntegrationSettings};
use pairwave::points::Ensemble;
use pairwave::samplers::Process;
use pairwave::{Memory, Points};

/// Nothing asked for but 8 shifts and few low frequencies.
pub fn settings<'a>() -> IntegrationSettings<'a> {
    IntegrationSettings {
        integrands: &[],
        estimator: None,
        shifts: 8,
        spatial: None,
        top: None,
        intensity: None,
        by: None,
        weighted: false,
        max_frequency: None,
        low_frequency: Some(4),
        accuracy: Accuracy::High,
        memory: Memory(1 << 30),
        equal: true,
    }
}

/// The plan for these points, of settings whose integrands do not matter.
pub fn plan(ensemble: &Ensemble, integrands: &[&str], settings: IntegrationSettings<'_>) -> IntegrationPlan {
    let specs: Vec<String> = integrands.iter().map(ToString::to_string).collect();
    let shape = ensemble.shape();
    let equal = shape.mean_points == shape.max_points as f64;
    let settings = IntegrationSettings { integrands: &specs, equal, ..settings };
    IntegrationPlan::new(ensemble.domain(), settings, shape).unwrap()
}

pub fn sums(compute: &dyn Compute, plan: &IntegrationPlan, ensemble: &Ensemble) -> IntegrationSums {
    wait(compute.integration(plan, ensemble, &Control::default())).unwrap()
}

pub fn drawn(name: &str, n: u64, dim: usize, k: u64, params: &[&str]) -> Ensemble {
    Process::new(name, n, k, dim, 5, params).unwrap().ensemble(0..k, &Control::default()).unwrap()
}

pub fn found(line: &str) -> Analysis {
    let request = request(line);
    pairwave::measure(Points::open(&request.input).unwrap(), &request).unwrap()
}

pub fn each(analysis: &Analysis) -> &[IntegrationError] {
    &analysis.integration().unwrap().each
}

/// All that is summed of an integrand.
pub fn parts(s: &IntegrandSums) -> [f64; 8] {
    [s.values, s.grid, s.axes, s.pairs, s.shifted[0], s.shifted[1], s.low[0], s.low[1]]
}

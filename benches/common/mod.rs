//! What the benches share: a clock and points.
#![allow(dead_code, reason = "every bench uses its own part")]

use std::time::Instant;

use pairwave::plan::EnsembleShape;
use pairwave::points::{Domain, Ensemble, RawPoints};

/// What a backend was asked for.
pub fn wait<T>(work: impl Future<Output = T>) -> T {
    pollster::block_on(work)
}

/// Processor time of all threads of this process, or wall time where the system does not tell.
pub struct Clock {
    processor: Option<f64>,
    wall: Instant,
}

impl Clock {
    /// From now on; of the wall if not `by_processor`.
    pub fn start(by_processor: bool) -> Self {
        Self { processor: processor_seconds().filter(|_| by_processor), wall: Instant::now() }
    }

    pub fn seconds(&self) -> f64 {
        match (self.processor, processor_seconds()) {
            (Some(a), Some(b)) => b - a,
            _ => self.wall.elapsed().as_secs_f64(),
        }
    }
}

fn processor_seconds() -> Option<f64> {
    let mut total = 0.0;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        total += text.split(' ').next()?.parse::<f64>().ok()? * 1e-9;
    }
    Some(total)
}

/// Independent points on the unit torus, and the shape of their ensemble.
pub fn uniform(dim: usize, n: usize, realizations: usize) -> (Ensemble, EnsembleShape) {
    let mut state = 1u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2f64.powi(53)
    };
    let sets: Vec<RawPoints> = (0..realizations)
        .map(|_| RawPoints {
            dim,
            coordinates: (0..n * dim).map(|_| unit()).collect(),
            source: "uniform".into(),
            lines: Vec::new(),
        })
        .collect();
    let shape = EnsembleShape { realizations: realizations as u64, mean_points: n as f64, max_points: n as u64 };
    (Ensemble::from_raw(&sets, &Domain::unit_torus(dim), false, 0).unwrap_or_else(|e| panic!("{e}")), shape)
}

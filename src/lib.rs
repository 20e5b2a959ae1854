//! pairwave measures how the samples of a pattern are correlated: pair correlation functions g and power spectra P over
//! batches of point sets, with honest error bars.
//!
//! Data flows one way, and each arrow is one type:
//!
//! ```text
//! points -> plan -> compute (gpu | cpu | reference) -> accumulate -> estimate -> report
//! ```
//!
//! `Ensemble` holds realizations as 64-bit fixed-point fractions; `PairPlan` and `WavePlan` are everything decided before
//! the work; `Compute` turns both into raw sums, `PairCounts` and `WavePower`, which merge; `PairCorrelation`,
//! `PowerSpectrum` and `RadialSpectrum` are the numbers with their errors. `analysis::run` does all of it, and an `Analysis`
//! is all that it found: `display` says how it is shown, `report` writes it.
//!
//! Conventions: frequencies are integer wave vectors m in cycles per side, `s_m = sum_j exp(-2 pi i m.x_j / L)`; pairs are
//! ordered; bins are half-open; lengths are in the domain's own unit.
//!
//! ```
//! use pairwave::compute::{Compute, cpu::Cpu};
//! use pairwave::control::Control;
//! use pairwave::estimate::{Normalization, PairCorrelation};
//! use pairwave::plan::{Correction, EnsembleShape, PairPlan, RadialBins};
//! use pairwave::points::Domain;
//! use pairwave::samplers::{ParameterValues, ensemble, find};
//!
//! # fn main() -> pairwave::Result<()> {
//! let (jittered, control) = (find("jittered")?, Control::default());
//! let points = ensemble(jittered, 1024, 2, 1, 0..10, &ParameterValues::defaults(jittered)?, &control)?;
//! let shape = EnsembleShape { realizations: 10, mean_points: 1024.0, max_points: 1024 };
//! let bins = RadialBins::linear(0.1, 20)?;
//! let plan = PairPlan::new(&Domain::unit_torus(2), bins, Correction::None, shape)?;
//! let cpu = Cpu::new(None)?;
//! // A device may have to be waited for.
//! let counts = pollster::block_on(cpu.pair_counts(&plan, &points, &control))?;
//! let g = PairCorrelation::new(&plan, &counts, Normalization::Pairs);
//! assert!(g.g[0] < 0.2, "jittered points avoid each other: g({}) = {} +- {}", g.r[0], g.g[0], g.g_se[0]);
//! # Ok(())
//! # }
//! ```

// Nothing an input or a device does may panic; tests may unwrap.
#![warn(unreachable_pub, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod accumulate;
pub mod analysis;
pub mod compute;
pub mod control;
pub mod display;
mod error;
pub mod estimate;
mod named;
pub mod plan;
pub mod points;
mod pool;
pub mod report;
pub mod request;
pub mod samplers;
mod setting;
mod sinc;
pub mod source;
mod statistics;

pub use error::{Error, Result};
pub use pool::{Pool, check_threads};
pub use setting::Setting;

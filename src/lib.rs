//! pairwave measures how the samples of a pattern are correlated: pair correlation functions g and power spectra P over
//! batches of point sets, with honest error bars.
//!
//! Points of your own, and what is found about them:
//!
//! ```
//! use pairwave::{Domain, Points, Request, measure};
//!
//! # fn main() -> pairwave::Result<()> {
//! # let point = |k: u64| [k.wrapping_mul(0x9e37_79b9_7f4a_7c15), k.wrapping_mul(0xc2b2_ae3d_27d4_eb4f)];
//! # let set = |seed: u64| (0..200).flat_map(|k| point(k + 1000 * seed)).map(|x| (x >> 11) as f64 / 2f64.powi(53)).collect::<Vec<_>>();
//! # let (set_1, set_2) = (set(1), set(2));
//! let points = Points::new(Domain::unit_torus(2), &[set_1, set_2])?; // coordinates, point by point
//! let found = measure(points, &Request::default())?; // g, P and neighbours, by the best device there is
//! let g = found.pair_correlation().expect("asked for");
//! println!("g({}) = {} ± {}", g.r[0], g.g[0], g.g_se[0]);
//! # Ok(())
//! # }
//! ```
//!
//! A [`Request`] says what to measure and how; its fields are the settings of the command line ([`Setting`]). Points come from
//! memory, files, bytes or a sampler ([`Points`]). A [`Measurement`] is the same in steps: it can be looked at, stopped, written,
//! read, and merged with that of other realizations. `examples/` has one program for each.
//!
//! # Below: the expert's way
//!
//! Data flows one way, and each arrow is one type:
//!
//! ```text
//! points -> plan -> compute (gpu | cpu | reference) -> accumulate -> estimate -> report
//! ```
//!
//! [`points::Ensemble`] holds realizations as 64-bit fixed-point fractions; [`plan::PairPlan`] and [`plan::WavePlan`] are
//! everything decided before the work; [`compute::Compute`] turns both into raw sums, [`accumulate::PairCounts`] and
//! [`accumulate::WavePower`], which merge; [`estimate::PairCorrelation`] and [`estimate::PowerSpectrum`] are the numbers with
//! their errors. [`display`] says how an [`Analysis`] is shown, [`report`] writes it.
//!
//! Conventions: frequencies are integer wave vectors m in cycles per side, `s_m = sum_j exp(-2 pi i m.x_j / L)`; pairs are
//! ordered; bins are half-open; lengths are in the domain's own unit.
//!
//! ```
//! use pairwave::compute::{Compute, cpu::Cpu};
//! use pairwave::control::Control;
//! use pairwave::estimate::{Normalization, PairCorrelation};
//! use pairwave::plan::{Correction, PairPlan, RadialBins};
//! use pairwave::points::Domain;
//! use pairwave::samplers::Process;
//!
//! # fn main() -> pairwave::Result<()> {
//! let control = Control::default();
//! let points = Process::new("jittered", 1024, 10, 2, 1, &[])?.ensemble(0..10, &control)?;
//! let bins = RadialBins::linear(0.1, 20)?;
//! let plan = PairPlan::new(&Domain::unit_torus(2), bins, Correction::None, points.shape())?;
//! let cpu = Cpu::new(None)?;
//! // A device may have to be waited for.
//! let counts = pairwave::control::wait(cpu.pair_counts(&plan, &points, &control))?;
//! let g = PairCorrelation::new(&plan, &counts, Normalization::Pairs);
//! assert!(g.g[0] < 0.2, "jittered points avoid each other: g({}) = {} +- {}", g.r[0], g.g[0], g.g_se[0]);
//! # Ok(())
//! # }
//! ```

// Nothing an input or a device does may panic; tests may unwrap.
#![warn(unreachable_pub, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
// What can fail says how.
#![warn(clippy::missing_errors_doc)]

pub mod accumulate;
pub mod analysis;
mod ball;
pub mod benchmark;
pub mod comparison;
pub mod compute;
pub mod control;
pub mod convergence;
pub mod display;
mod error;
pub mod estimate;
mod fourier;
pub mod input;
pub mod integrand;
mod memory;
mod named;
pub mod plan;
pub mod points;
mod pool;
pub mod prediction;
pub mod report;
pub mod request;
pub mod samplers;
pub mod selftest;
mod setting;
mod sinc;
pub mod source;
mod stage;
mod statistics;
pub mod survey;

pub use analysis::{Measurement, measure};
pub use compute::Device;
pub use error::{Error, Result};
pub use estimate::Analysis;
pub use integrand::Integrand;
pub use memory::Memory;
pub use points::Domain;
pub use pool::{Pool, check_threads};
pub use request::{Request, Statistic};
pub use setting::Setting;
pub use source::Points;

//! pairwave measures how the samples of a pattern are correlated: pair correlation functions g and power spectra P over
//! batches of point sets, with honest error bars.
//!
//! Data flows one way, and each arrow is one type:
//!
//! ```text
//! points -> plan -> compute (gpu | cpu | reference) -> accumulate -> estimate -> report
//! ```

#![warn(unreachable_pub)]

pub mod accumulate;
pub mod compute;
mod error;
pub mod estimate;
pub mod plan;
pub mod points;
pub mod report;
pub mod samplers;

pub use error::{Error, Result};

//! pairwave measures how the samples of a pattern are correlated: pair correlation functions g and power spectra P over
//! batches of point sets, with honest error bars.
//!
//! Data flows one way, and each arrow is one type:
//!
//! ```text
//! points -> plan -> compute (gpu | cpu | reference) -> accumulate -> estimate -> report
//! ```

// Nothing an input or a device does may panic; tests may unwrap.
#![warn(unreachable_pub, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod accumulate;
pub mod analysis;
pub mod compute;
mod error;
pub mod estimate;
pub mod plan;
pub mod points;
pub mod report;
pub mod request;
pub mod samplers;
pub mod source;

pub use error::{Error, Result};

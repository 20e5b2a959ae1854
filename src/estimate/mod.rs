//! estimate
mod neighbors;
pub use neighbors::*;

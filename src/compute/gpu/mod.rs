//! The GPU path.

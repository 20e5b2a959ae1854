//! The native path against the definitions.

#[path = "../common/mod.rs"]
mod common;

mod cuts_and_threads;
mod lag_counts;
mod nufft;
mod pair_counts;
mod shared;
mod wave_covariance;
mod wave_power;

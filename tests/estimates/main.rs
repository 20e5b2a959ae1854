//! Raw sums -> numbers with errors.

#[path = "../common/mod.rs"]
mod common;

mod bandwidth;
mod convention;
mod cross_correlation;
mod envelope;
mod inhomogeneous;
mod k_function;
mod neighbors;
mod pair_correlation;
mod pair_kernel;
mod power_spectrum;
mod shared;
mod single_realization;
mod spectrum_details;
mod taper;
mod vector_correlation;
mod wave_covariance;

//! Clusters, Cox and determinantal processes.

pub(super) mod cauchy_cluster;
mod determinantal;
pub(super) mod fourier_dpp;
pub(super) mod gaussian_dpp;
pub(super) mod ginibre;
pub(super) mod lgcp;
pub(super) mod matern_cluster;
mod neyman_scott;
pub(super) mod thomas;

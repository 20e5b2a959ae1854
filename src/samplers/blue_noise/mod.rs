//! Hard cores and blue noise.

pub(super) mod best_candidate;
pub(super) mod fpo;
pub(super) mod lloyd;
pub(super) mod matern;
pub(super) mod maximal_poisson_disk;
mod periodic;
pub(super) mod poisson_disk;
pub(super) mod stealthy;

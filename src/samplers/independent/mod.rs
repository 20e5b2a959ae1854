//! Independent points and grids.

pub(super) mod cubic;
pub(super) mod grid;
pub(super) mod hexagonal;
pub(super) mod perturbed_grid;
pub(super) mod poisson;
pub(super) mod random;

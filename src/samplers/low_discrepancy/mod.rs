//! Nets, sequences and lattices.

pub(super) mod fibonacci;
pub(super) mod halton;
pub(super) mod hammersley;
pub(super) mod kronecker;
pub(super) mod lattice;
mod net_power;
pub(super) mod pmj02;
mod radical_inverse;
pub(super) mod sobol;

/// Coordinates point by point of columns of coordinates.
fn interleaved(columns: &[Vec<f64>]) -> Vec<f64> {
    let n = columns.first().map_or(0, Vec::len);
    (0..n).flat_map(|i| columns.iter().map(move |column| column[i])).collect()
}

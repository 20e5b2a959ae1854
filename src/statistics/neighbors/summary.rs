//! What `summary.json` says of neighbours.

use serde::Serialize;

use crate::estimate::{Analysis, BondOrder, ClarkEvans, ErrorSource, NeighborDistances};

#[derive(Serialize)]
pub(super) struct NeighborsOut {
    #[serde(flatten)]
    distances: NeighborDistances,
    clark_evans: Option<ClarkEvans>,
    functions: FunctionsOut,
    psi_6: Option<BondOrder>,
    psi_6_undefined: Option<&'static str>,
}

#[derive(Serialize)]
pub(super) struct FunctionsOut {
    distances: usize,
    errors: ErrorSource,
    test_points: u64,
}

#[derive(Serialize)]
pub(super) struct CrossOut<'a> {
    /// As in the names of columns.
    classes: &'a [String; 2],
    errors: ErrorSource,
}

/// Of two classes.
pub(super) fn cross(a: &Analysis) -> Option<CrossOut<'_>> {
    a.cross_neighbors().map(|c| CrossOut { classes: &c.classes, errors: c.from_a.errors })
}

/// Of distances, functions and bonds.
pub(super) fn neighbors(a: &Analysis) -> Option<NeighborsOut> {
    a.neighbors().map(|n| NeighborsOut {
        distances: n.distances,
        clark_evans: n.clark_evans,
        functions: FunctionsOut {
            distances: n.functions.r.len(),
            errors: n.functions.errors,
            test_points: n.functions.probes,
        },
        psi_6: n.bonds.ok(),
        psi_6_undefined: n.bonds.err(),
    })
}

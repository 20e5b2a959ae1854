//! Bond-orientational order over realizations; `compute::neighbors::bonds` has the definition.

use crate::accumulate::{Bonds, NoBonds, RealizationNeighbors};
use crate::estimate::{mean, standard_error};

/// psi_6 of a batch, over the realizations where it is defined, each counting alike.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BondOrder {
    /// Mean of `|psi_6|` over points: how hexagonal the surroundings of a point are. A few neighbours never cancel, so
    /// that it is far above 0 without any order.
    pub local: f64,
    /// Standard error of `local` across realizations (K >= 2).
    pub local_se: Option<f64>,
    /// `|mean of psi_6|`: 1 where all surroundings are turned alike, about `local / sqrt(n)` where they are not.
    pub global: f64,
    /// Standard error of `global` across realizations (K >= 2).
    pub global_se: Option<f64>,
    /// The shares of points with 5, 6 and 7 neighbours.
    pub with_5_6_7_neighbors: [f64; 3],
    /// Number of realizations behind it.
    pub realizations: u64,
}

impl BondOrder {
    /// `Err`: why no realization has any.
    pub(super) fn new(realizations: &[RealizationNeighbors]) -> Result<Self, &'static str> {
        let all: Vec<Bonds> = realizations.iter().filter_map(|r| r.bonds.ok()).collect();
        let [local, global] =
            [|b: &Bonds| b.local, |b: &Bonds| b.global].map(|f| all.iter().map(f).collect::<Vec<_>>());
        let (Some(local_mean), Some(global_mean)) = (mean(&local), mean(&global)) else {
            return Err(realizations
                .iter()
                .find_map(|r| r.bonds.err())
                .map_or("there are no realizations", NoBonds::why));
        };
        let points: u64 = all.iter().map(|b| b.points).sum();
        let share = |i: usize| all.iter().map(|b| b.with_neighbors[i]).sum::<u64>() as f64 / points as f64;
        Ok(Self {
            local: local_mean,
            local_se: standard_error(&local),
            global: global_mean,
            global_se: standard_error(&global),
            with_5_6_7_neighbors: [0, 1, 2].map(share),
            realizations: all.len() as u64,
        })
    }
}

//! Distribution functions of distances between two classes of points.

use super::NeighborFunctions;
use crate::accumulate::CrossNeighborSums;
use crate::estimate::Analysis;
use crate::plan::{EnsembleShape, NeighborPlan};

/// G, F and J within two classes A and B and between them. `G_AB(r)` is the probability that a point of A has one of B closer
/// than r, F_B that a fixed place has, and `J_AB = (1 - G_AB) / (1 - F_B)`: 1 if A and B are independent (van Lieshout and
/// Baddeley, "Indices of dependence between types in multivariate point patterns", Scandinavian Journal of Statistics 26,
/// 1999).
#[derive(Debug, Clone, PartialEq)]
pub struct CrossNeighbors {
    /// The names of the classes.
    pub classes: [String; 2],
    /// Within A.
    pub a: NeighborFunctions,
    /// Within B.
    pub b: NeighborFunctions,
    /// From points of A to those of B: G_AB, F_B, J_AB.
    pub from_a: NeighborFunctions,
    /// From points of B to those of A: G_BA, F_A, J_BA.
    pub from_b: NeighborFunctions,
}

impl CrossNeighbors {
    /// The estimates.
    pub fn new(classes: [String; 2], plan: &NeighborPlan, sums: &CrossNeighborSums) -> Self {
        let [a, b, from_a, from_b] = &sums.0;
        let shape = |sums: &[crate::accumulate::RealizationNeighbors]| {
            let mean_points = sums.iter().map(|r| r.n as f64).sum::<f64>() / sums.len() as f64;
            let max_points = sums.iter().map(|r| r.n).max().unwrap_or(0);
            EnsembleShape { realizations: sums.len() as u64, mean_points, max_points }
        };
        let [of_a, of_b] = [a, b].map(|sums| shape(&sums.realizations));
        let functions = |sums, to| NeighborFunctions::new(plan, sums, to);
        Self {
            classes,
            a: functions(a, of_a),
            b: functions(b, of_b),
            from_a: functions(from_a, of_b),
            from_b: functions(from_b, of_a),
        }
    }

    /// The names of the classes from and to which, and the functions.
    pub fn each(&self) -> [([&str; 2], &NeighborFunctions); 4] {
        let [a, b] = self.classes.each_ref().map(String::as_str);
        [([a, a], &self.a), ([b, b], &self.b), ([a, b], &self.from_a), ([b, a], &self.from_b)]
    }
}

impl Analysis {
    /// Nearest neighbours of two classes of points.
    pub fn cross_neighbors(&self) -> Option<&CrossNeighbors> {
        self.get()
    }
}

//! The plan for nearest-neighbour statistics: at which distances, and from where space is probed.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;

use super::{Batch, EnsembleShape, RadialBins};
use crate::error::Result;
use crate::points::Domain;

/// Everything decided about neighbours before any is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct NeighborPlan {
    /// The domain.
    pub domain: Domain,
    /// The distances at which G, F and J are given.
    pub r: Vec<f64>,
    /// Integer thresholds on the squared distance, one per distance: closer than r is below it.
    pub thresholds: Vec<u128>,
    /// The points from which F looks.
    pub probes: ProbeLattice,
    /// Whether bonds are wanted.
    pub bonds: bool,
    /// From points of the first class to the nearest, other than itself, of the second, and from the test points to those of
    /// the second; all points where there are none.
    pub classes: Option<[u32; 2]>,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

impl NeighborPlan {
    /// At the edges of `bins`; without any, at 257 distances from 0 to 3 closest-packing distances, or to the longest
    /// distance there is.
    ///
    /// # Errors
    /// Distances that the domain does not allow.
    pub fn new(domain: &Domain, bins: Option<&RadialBins>, shape: EnsembleShape) -> Result<Self> {
        let default;
        let bins = match bins {
            Some(bins) => bins,
            None => {
                let diagonal = domain.sides().iter().map(|s| s * s).sum::<f64>().sqrt();
                let longest = if domain.is_torus() { 0.5 * diagonal } else { diagonal };
                default =
                    RadialBins::linear(longest.min(3.0 * domain.closest_packing_distance(shape.mean_points)), 256)?;
                &default
            }
        };
        // Three u64 axes, kept and sorted into a tree.
        let batch = Batch::new(shape, shape.max_points * 72);
        Ok(Self {
            domain: domain.clone(),
            r: bins.edges().to_vec(),
            thresholds: bins.thresholds(domain)?,
            probes: ProbeLattice::new(domain, shape),
            bonds: domain.as_polygon().is_none(),
            classes: None,
            batch,
        })
    }
}

/// A lattice of test points: per axis a number m of them, at (i + 1/2) L / m; of a polygon those inside.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProbeLattice {
    /// Test points per axis; 1 on axes beyond the dimension.
    pub counts: [u64; 3],
    /// Extent of the box per axis, in fixed-point steps.
    extents: [u128; 3],
    /// Of a polygon the numbers of those inside.
    inside: Option<Arc<[usize]>>,
}

impl ProbeLattice {
    /// About one per point, and no fewer than 2^14 over all realizations together. The number per axis is prime, so that a
    /// pattern made on a grid is met at all phases, not at a few.
    fn new(domain: &Domain, shape: EnsembleShape) -> Self {
        let wanted = shape.mean_points.max(16384.0 / shape.realizations as f64);
        let spacing = (domain.measure() / wanted).powf(1.0 / domain.dim() as f64);
        let (mut counts, mut extents) = ([1; 3], [1; 3]);
        for (a, &side) in domain.sides().iter().enumerate() {
            counts[a] = prime_from((side / spacing).ceil() as u64);
            extents[a] = match domain.periods()[a] {
                _ if !domain.is_torus() => u128::from(domain.side_steps()[a]),
                0 => 1 << 64,
                period => u128::from(period),
            };
        }
        let all = Self { counts, extents, inside: None };
        let inside = domain.as_polygon().map(|polygon| {
            let within = |&index: &usize| {
                let [x, y, _] = all.position(index);
                polygon.contains([x, y])
            };
            (0..all.len()).into_par_iter().filter(within).collect::<Vec<_>>().into()
        });
        Self { inside, ..all }
    }

    /// Number of test points.
    pub fn len(&self) -> usize {
        self.inside.as_ref().map_or_else(|| self.counts.iter().product::<u64>() as usize, |inside| inside.len())
    }

    /// Only where a polygon is so thin that it holds none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Test point `index`, in fixed-point steps.
    pub fn position(&self, index: usize) -> [u64; 3] {
        let mut rest = self.inside.as_ref().map_or(index, |inside| inside[index]) as u64;
        std::array::from_fn(|a| {
            let i = u128::from(rest % self.counts[a]);
            rest /= self.counts[a];
            ((2 * i + 1) * self.extents[a] / (2 * u128::from(self.counts[a]))) as u64
        })
    }
}

/// The least prime from `least` on, or 1.
pub(super) fn prime_from(least: u64) -> u64 {
    let is_prime = |&m: &u64| (2..).take_while(|d| d * d <= m).all(|d| !m.is_multiple_of(d));
    (least.max(1)..).find(is_prime).unwrap_or(least)
}

impl fmt::Display for NeighborPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts: Vec<_> = self.probes.counts[..self.domain.dim()].iter().map(u64::to_string).collect();
        let edges = if self.domain.is_torus() { "no edges" } else { "Kaplan-Meier" };
        writeln!(f, "neighbours: k-d tree, exact distances of the pairs it finds")?;
        writeln!(f, "  G, F, J at {} distances, {edges}; F from {} test points", self.r.len(), counts.join(" x "))?;
        if self.domain.as_polygon().is_some() {
            writeln!(f, "    of which {} are in the polygon", self.probes.len())?;
            writeln!(f, "  skipped: psi_6 (neighbours across a notch or a hole are none)")?;
        } else if self.domain.dim() == 2 {
            let periodic = if self.domain.is_torus() { "periodic " } else { "" };
            writeln!(f, "  psi_6: {periodic}Delaunay triangulation")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_fill_the_box_evenly() {
        let shape = EnsembleShape { realizations: 1, mean_points: 100.0, max_points: 100 };
        for domain in [
            Domain::unit_torus(1),
            Domain::torus(&[1.0, 0.3]).unwrap(),
            Domain::window(&[(-3.0, 4.0), (10.0, 12.0), (0.0, 1.0)]).unwrap(),
            Domain::torus(&[1.0, 1e-6]).unwrap(),
        ] {
            let probes = ProbeLattice::new(&domain, shape);
            assert!((16384..=140_000).contains(&probes.len()), "{domain:?}: {}", probes.len());
            let unit = domain.length_unit() / 2f64.powi(64);
            for (a, &side) in domain.sides().iter().enumerate() {
                let m = probes.counts[a] as f64;
                let mut places: Vec<u64> = (0..probes.len()).map(|i| probes.position(i)[a]).collect();
                places.sort_unstable();
                places.dedup();
                assert_eq!(places.len() as f64, m);
                for (i, &place) in places.iter().enumerate() {
                    let expected = (i as f64 + 0.5) * side / m;
                    assert!((place as f64 * unit / expected - 1.0).abs() < 1e-12, "{domain:?}, axis {a}, {i}");
                }
            }
        }
        assert_eq!([0, 1, 2, 4, 90, 128, 1415].map(prime_from), [1, 1, 2, 5, 97, 131, 1423]);
    }

    #[test]
    fn distances_to_the_border_are_exact() {
        let domain = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
        // The length unit is 4.
        let at = |x: f64, y: f64| domain.border().distance(&[x, y].map(|v| (v / 4.0 * 2f64.powi(64)) as u64));
        let steps = |d: f64| (d / 4.0 * 2f64.powi(64)) as u64;
        assert_eq!(at(0.25, 0.5), steps(0.25));
        assert_eq!(at(1.875, 0.5), steps(0.125));
        assert_eq!(at(1.0, 0.75), steps(0.25));
        assert_eq!((at(2.0, 0.5), at(1.0, 1.0)), (0, 0));
    }
}

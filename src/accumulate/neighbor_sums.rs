//! Raw sums of nearest-neighbour statistics: integers, and a few numbers per realization, kept in the order of its index.
//! A merge of parts equals the whole, bit for bit, however the batch was cut.

use crate::error::{Error, Result};

/// Steps per unit of `DistributionSums::counts`.
pub const COUNT_STEPS: f64 = 4_294_967_296.0;

/// Nearest-neighbour statistics of a batch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NeighborSums {
    /// Per realization, ordered by index.
    pub realizations: Vec<RealizationNeighbors>,
    /// Distances from each point to the nearest other point, behind G.
    pub nearest: DistributionSums,
    /// Distances from each test point to the nearest point, behind F.
    pub empty: DistributionSums,
}

/// What is kept of one realization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealizationNeighbors {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// The distances; `None` with fewer than two points, where there is no neighbour.
    pub distances: Option<Distances>,
    /// Bonds between neighbours in the plane, or why there are none.
    pub bonds: Result<Bonds, &'static str>,
}

/// Nearest-neighbour distances within one realization, in the domain's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distances {
    /// Distance of the closest pair.
    pub minimum: f64,
    /// Mean over points of the distance to the nearest other point.
    pub mean: f64,
    /// Distance of neighbours in the closest packing of n points, `d_hex`.
    pub closest_packing: f64,
}

/// Bond-orientational order of one realization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bonds {
    /// Number of points that count.
    pub points: u64,
    /// How many of them have 5, 6 and 7 neighbours.
    pub with_neighbors: [u64; 3],
    /// Mean over points of `|psi_6|`.
    pub local: f64,
    /// Modulus of the mean over points of `psi_6`.
    pub global: f64,
}

/// Of one realization: a distribution function of distances, times the number of distances.
#[derive(Debug, Clone, PartialEq)]
pub struct DistributionCounts {
    /// Number of distances N.
    pub points: u64,
    /// N times the estimate, at each r, in steps of 2^-32. Without censoring a number of distances below r.
    pub counts: Vec<u128>,
    /// Distances known to be at least r.
    pub at_risk: Vec<u64>,
}

/// Sums over realizations of what the ratio `sum c / sum N` and its error need; c and N as in `DistributionCounts`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DistributionSums {
    /// Number of realizations.
    pub realizations: u64,
    /// `sum N`.
    pub points: u128,
    /// `sum N^2`.
    pub squared_points: u128,
    /// Per r, `sum c`.
    pub counts: Vec<u128>,
    /// Per r, `sum c^2`.
    pub squares: Vec<u128>,
    /// Per r, `sum c N`.
    pub products: Vec<u128>,
    /// Per r, distances known to be at least r.
    pub at_risk: Vec<u128>,
}

impl DistributionSums {
    fn add(&mut self, one: &DistributionCounts) {
        let points = u128::from(one.points);
        self.merge(&Self {
            realizations: 1,
            points,
            squared_points: points * points,
            squares: one.counts.iter().map(|c| c.saturating_mul(*c)).collect(),
            products: one.counts.iter().map(|c| c.saturating_mul(points)).collect(),
            at_risk: one.at_risk.iter().map(|&n| u128::from(n)).collect(),
            counts: one.counts.clone(),
        });
    }

    fn merge(&mut self, other: &Self) {
        self.realizations += other.realizations;
        self.points += other.points;
        self.squared_points += other.squared_points;
        for (sums, more) in [
            (&mut self.counts, &other.counts),
            (&mut self.squares, &other.squares),
            (&mut self.products, &other.products),
            (&mut self.at_risk, &other.at_risk),
        ] {
            sums.resize(sums.len().max(more.len()), 0);
            // Saturated squares spoil an error bar, never a mean, and in any order alike.
            sums.iter_mut().zip(more).for_each(|(a, b)| *a = a.saturating_add(*b));
        }
    }
}

impl NeighborSums {
    /// Adds the realization that follows.
    pub(crate) fn add(&mut self, one: RealizationNeighbors, nearest: &DistributionCounts, empty: &DistributionCounts) {
        self.realizations.push(one);
        self.nearest.add(nearest);
        self.empty.add(empty);
    }

    /// Adds other realizations of the same process, measured by the same plan.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        // Batches mostly come in order, one after the other.
        let follows = self.realizations.last().map(|r| r.index) < other.realizations.first().map(|r| r.index);
        if follows {
            self.realizations.extend_from_slice(&other.realizations);
        } else {
            let mut merged = [self.realizations.as_slice(), &other.realizations].concat();
            merged.sort_by_key(|r| r.index);
            if let Some(twice) = merged.windows(2).find(|w| w[0].index == w[1].index) {
                let reason = format!("both parts hold realization {}", twice[0].index);
                return Err(Error::input("neighbor statistics", reason));
            }
            self.realizations = merged;
        }
        self.nearest.merge(&other.nearest);
        self.empty.merge(&other.empty);
        Ok(())
    }
}

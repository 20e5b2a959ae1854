//! Which pairs are looked at: all, or those of points in cells near each other, whichever is estimated to be faster.

use std::fmt;

use super::{BinFilter, CellGrid};
use crate::points::Domain;

/// Which pairs are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum PairSearch {
    /// All of them.
    All,
    /// Those of points in cells near each other.
    Cells(CellGrid),
}

/// What the parts of a search take on a device, in nanoseconds of one thread (a GPU as a whole counts as one).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchCosts {
    /// The device, in words.
    pub device: &'static str,
    /// Looking at one pair, with bins that are found by a square root.
    pub pair: f64,
    /// The same with bins by a logarithm or from a table.
    pub pair_by_table: f64,
    /// Beginning a row, which is one point against all its partners; pairs that fill up the last vector included.
    pub row: f64,
    /// Bringing one partner of a cell to where the cell's points look.
    pub partner: f64,
    /// A range of partners.
    pub range: f64,
    /// A cell with points in it.
    pub cell: f64,
    /// Sorting one point.
    pub sort: f64,
    /// The most cells per point that are of use.
    pub cells_per_point: f64,
    /// The largest reach that is of use.
    pub max_reach: u32,
}

impl SearchCosts {
    /// Fitted to the times that `benches/pair_sweep.rs` takes on one core of an AMD EPYC of 2022 (Zen 4, AVX-512), but for bins by a logarithm or
    /// from a table, which are what `pairwave bench --calibrate` found over equal bins on an Intel Xeon. Only ratios matter, and those are
    /// much the same on other processors.
    pub const CPU: Self = Self {
        device: "the CPU, one thread",
        pair: 0.44,
        pair_by_table: 0.62,
        row: 23.0,
        partner: 0.16,
        range: 45.0,
        cell: 30.0,
        sort: 4.5,
        cells_per_point: 0.3,
        max_reach: 6,
    };

    /// Reasoned, not measured, for a GPU of the size of an NVIDIA H200: 5e11 pairs per second; four rows share the register
    /// file of a lane, so a partner of few rows costs as much as some pairs more; the host finds the ranges, at about what
    /// they cost on the CPU path.
    pub const GPU: Self = Self {
        device: "a GPU, by reasoned costs",
        pair: 0.002,
        pair_by_table: 0.006,
        row: 0.01,
        partner: 0.006,
        range: 6.0,
        cell: 8.0,
        sort: 0.5,
        cells_per_point: 0.25,
        max_reach: 4,
    };
}

/// What a plan must know of the device that is to count its pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairDevice {
    /// What searches cost on it.
    pub costs: SearchCosts,
    /// How many storage buffers a kernel may have, on a GPU.
    pub buffers: Option<u32>,
}

impl PairDevice {
    /// The native path.
    pub const CPU: Self = Self { costs: SearchCosts::CPU, buffers: None };
}

/// A search, and what it would take for one realization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchEstimate {
    /// The search.
    pub search: PairSearch,
    /// Unordered pairs looked at.
    pub pairs: f64,
    /// Seconds on the machine that the costs are of.
    pub seconds: f64,
}

impl PairSearch {
    /// Every search there is to choose from, with its estimate for uniform points: all pairs first, then cells by reach.
    /// `beyond` is the threshold of the last edge on squared distances.
    pub fn alternatives(
        domain: &Domain,
        beyond: u128,
        points: f64,
        filter: &BinFilter,
        costs: &SearchCosts,
    ) -> Vec<SearchEstimate> {
        let pair = match filter {
            BinFilter::Linear { .. } => costs.pair,
            BinFilter::Table(_) => costs.pair_by_table,
        };
        let all = points * (points - 1.0).max(0.0) / 2.0;
        let undivided = 1e-9 * (all * pair + points * costs.row);
        let mut found = vec![SearchEstimate { search: Self::All, pairs: all, seconds: undivided }];
        for reach in 1..=costs.max_reach {
            let Some(grid) = CellGrid::new(domain, beyond, reach, points * costs.cells_per_point) else { continue };
            found.push(Self::estimate(grid, domain, beyond, points, pair, costs));
        }
        found
    }

    fn estimate(
        grid: CellGrid,
        domain: &Domain,
        beyond: u128,
        points: f64,
        pair: f64,
        costs: &SearchCosts,
    ) -> SearchEstimate {
        let cells = grid.len() as f64;
        let in_cell = points / cells;
        // How much of a neighbour's cells there is: a window has none outside.
        let present = |axis: usize, d: i32| {
            if domain.is_torus() { 1.0 } else { (1.0 - f64::from(d.abs()) / f64::from(grid.cells[axis])).max(0.0) }
        };
        let (mut partners, mut ranges) = (-0.5, 0.0);
        for row in grid.stencil(domain, beyond) {
            let rows = present(1, row.dy) * present(2, row.dz);
            partners += rows * (row.first..=row.last).map(|dx| present(0, dx)).sum::<f64>();
            ranges += rows;
        }
        let pairs = points * in_cell * partners;
        // Only cells with points in them look for partners.
        let occupied = cells * (1.0 - (-in_cell).exp());
        let nanoseconds = pairs * pair
            + points * (costs.row + costs.sort)
            + occupied * (in_cell * partners * costs.partner + ranges * costs.range + costs.cell);
        SearchEstimate { search: Self::Cells(grid), pairs, seconds: 1e-9 * nanoseconds }
    }

    /// The fastest by estimate.
    pub fn choose(domain: &Domain, beyond: u128, points: f64, filter: &BinFilter, costs: &SearchCosts) -> Self {
        let all = Self::alternatives(domain, beyond, points, filter, costs);
        all.into_iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds)).map_or(Self::All, |best| best.search)
    }
}

impl fmt::Display for SearchEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {:.3e} pairs looked at, about {:.2e} s", self.search, self.pairs, self.seconds)
    }
}

impl fmt::Display for PairSearch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all pairs"),
            Self::Cells(grid) => {
                let [x, y, z] = grid.cells;
                write!(f, "cells {x} x {y} x {z}, reach {}", grid.reach)
            }
        }
    }
}

//! Cells over the box, so that pairs farther than the last edge need not be looked at. All in integers: a pair that is
//! left out is beyond the last edge by the exact definition.

use crate::points::Domain;

/// Cells of equal size over the box, so large that pairs closer than the last edge are at most `reach` cells apart on
/// every axis. An axis of one cell is not cut at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct CellGrid {
    /// Cells per axis; 1 on axes beyond the dimension.
    pub cells: [u32; 3],
    /// How many cells away a partner may be.
    pub reach: u32,
}

/// Cells per axis are at most this, so that a cell is far wider than what rounding moves its sides by.
const MAX_CELLS_PER_AXIS: u128 = 1 << 20;

/// Cells are taken to be narrower than they are by this many steps: more than rounding can move their sides by.
const MARGIN: u128 = 8;

/// Cells in one row along x, as offsets from a cell: `x` from `first` to `last`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StencilRow {
    /// Offset along y.
    pub dy: i32,
    /// Offset along z.
    pub dz: i32,
    /// The first offset along x.
    pub first: i32,
    /// The last offset along x.
    pub last: i32,
}

impl CellGrid {
    /// The finest grid with this reach and not much more than `most` cells, or `None` where no axis can be cut. `beyond` is
    /// the threshold of the last edge on squared distances (`PairPlan::thresholds`).
    pub fn new(domain: &Domain, beyond: u128, reach: u32, most: f64) -> Option<Self> {
        let root = beyond.isqrt();
        let r_max = if root * root < beyond { root + 1 } else { root };
        let width = r_max.div_ceil(u128::from(reach)) + MARGIN;
        let finest = domain.extents().map(|extent| (extent / width).clamp(1, MAX_CELLS_PER_AXIS) as u32);
        let mut cells = finest;
        // Cells that are too many get larger on all axes alike; axes that run out of cells leave it to the others.
        for _ in 0..3 {
            let total: f64 = cells.iter().map(|&c| f64::from(c)).product();
            let cut = cells.iter().filter(|&&c| c > 1).count();
            if total <= most || cut == 0 {
                break;
            }
            let factor = (total / most.max(1.0)).powf(-1.0 / cut as f64);
            cells = cells.map(|c| ((f64::from(c) * factor) as u32).max(1));
        }
        if domain.is_torus() {
            // Fewer cells would meet a pair from both sides.
            cells = cells.map(|c| if c <= 2 * reach { 1 } else { c });
        }
        (cells != [1; 3]).then_some(Self { cells, reach })
    }

    /// One cell for everything: every pair is looked at.
    pub fn undivided() -> Self {
        Self { cells: [1; 3], reach: 0 }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.iter().map(|&c| c as usize).product()
    }

    /// Never: there is at least one cell.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Per axis, how the cell of a position is found.
    pub fn axes(&self, domain: &Domain) -> [CellAxis; 3] {
        let extents = domain.extents();
        std::array::from_fn(|k| CellAxis::new(self.cells[k], extents[k]))
    }

    /// The cells in which partners of the points of a cell lie, each unordered pair of cells once: the cell's own row from
    /// the cell itself on, then the rows with (z, y) beyond its own. Cells that cannot be closer than the last edge are left
    /// out.
    pub fn stencil(&self, domain: &Domain, beyond: u128) -> Vec<StencilRow> {
        let extents = domain.extents();
        // The least distance along an axis of points in cells `d` apart.
        let gap = |axis: usize, d: i32| {
            let width = (extents[axis] / u128::from(self.cells[axis])).saturating_sub(MARGIN);
            u128::from(d.unsigned_abs().saturating_sub(1)) * width
        };
        let near = |dx: i32, dy: i32, dz: i32| {
            [dx, dy, dz]
                .into_iter()
                .enumerate()
                .try_fold(0u128, |sum, (axis, d)| sum.checked_add(gap(axis, d).checked_pow(2)?))
                .is_some_and(|r2| r2 < beyond)
        };
        let reach = self.cells.map(|c| if c == 1 { 0 } else { self.reach as i32 });
        let mut rows = Vec::new();
        for dz in 0..=reach[2] {
            for dy in if dz == 0 { 0 } else { -reach[1] }..=reach[1] {
                if let Some(last) = (0..=reach[0]).rev().find(|&dx| near(dx, dy, dz)) {
                    let own = dy == 0 && dz == 0;
                    rows.push(StencilRow { dy, dz, first: if own { 0 } else { -last }, last });
                }
            }
        }
        rows
    }
}

/// Cells along one axis: `floor(position * multiplier / 2^shift)`, the nearest there is to `floor(position * cells /
/// extent)` without a division: no side of a cell is off by more than `MARGIN / 2` steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CellAxis {
    multiplier: u64,
    shift: u32,
}

impl CellAxis {
    fn new(cells: u32, extent: u128) -> Self {
        // The multiplier, rounded down, is in [2^62, 2^64): positions below the extent stay below `cells`, and
        // 2^shift / multiplier exceeds extent / cells by less than extent / multiplier / cells <= 4 / cells steps.
        let shift = 63 + extent.ilog2() - cells.ilog2();
        Self { multiplier: ((u128::from(cells) << shift) / extent) as u64, shift }
    }

    /// Multiplier and shift.
    pub fn rule(self) -> (u64, u32) {
        (self.multiplier, self.shift)
    }

    /// The cell of a position.
    #[inline(always)]
    pub fn cell(self, position: u64) -> u32 {
        ((u128::from(position) * u128::from(self.multiplier)) >> self.shift) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::RadialBins;

    fn domains() -> Vec<Domain> {
        vec![
            Domain::unit_torus(1),
            Domain::unit_torus(3),
            Domain::torus(&[1.0, 1.0 / 3.0]).unwrap(),
            Domain::torus(&[1e-3, 0.7, 1.0 - 1e-12]).unwrap(),
            Domain::torus(&[1e6, 1.0]).unwrap(),
            Domain::window(&[(0.0, 3.0), (-1.0, 0.0), (0.0, 0.7)]).unwrap(),
        ]
    }

    /// Positions on both ends of every cell are never closer than the stencil takes them to be, wrapped or not.
    fn assert_apart(domain: &Domain, grid: &CellGrid, beyond: u128) {
        for (k, axis) in grid.axes(domain).into_iter().enumerate().take(domain.dim()) {
            let (cells, extent) = (grid.cells[k], domain.extents()[k]);
            if cells == 1 {
                continue;
            }
            // The first position of cell c, by bisection.
            let side = |c: u32| -> u128 {
                let (mut low, mut high) = (0, extent);
                while low < high {
                    let middle = low.midpoint(high);
                    if axis.cell(middle as u64) >= c { high = middle } else { low = middle + 1 }
                }
                low
            };
            assert_eq!((axis.cell(0), axis.cell((extent - 1) as u64)), (0, cells - 1));
            for c in (0..cells).step_by((cells / 50).max(1) as usize).chain([cells - 1]) {
                let (last, next) = (side(c + 1) - 1, c + grid.reach + 1);
                let gap = if next < cells {
                    side(next) - last
                } else if domain.is_torus() {
                    extent - last + side(next - cells)
                } else {
                    continue;
                };
                assert!(gap * gap >= beyond, "{domain:?}, {grid:?}, axis {k}, cell {c}");
            }
        }
    }

    #[test]
    fn cells_beyond_the_reach_are_beyond_the_last_edge() {
        for domain in domains() {
            for (r, reach) in [(0.4, 1), (0.1, 1), (0.1, 3), (0.01, 2), (1e-4, 1)] {
                let bins = RadialBins::linear(r * domain.shortest_side(), 1).unwrap();
                let beyond = bins.thresholds(&domain).unwrap()[1];
                let Some(grid) = CellGrid::new(&domain, beyond, reach, 1e5) else { continue };
                assert_apart(&domain, &grid, beyond);
            }
        }
    }

    /// Last edges that so many cells just hold, to the step, on a side whose cells are rounded: the last of them is narrower than it is
    /// taken to be.
    #[test]
    fn cells_that_just_hold_an_edge_are_wide_enough() {
        let domain = Domain::torus(&[1.0, 0.97]).unwrap();
        for cells in 3..60 {
            for (reach, less) in [1, 2, 3].into_iter().flat_map(|reach| (0..3).map(move |less| (reach, less))) {
                let r_max = (domain.extents()[1] / cells - less) * u128::from(reach);
                let Some(grid) = CellGrid::new(&domain, r_max * r_max, reach, 1e9) else { continue };
                assert_apart(&domain, &grid, r_max * r_max);
            }
        }
    }

    /// Half of the cube of cells and the cell itself, less the corners that touch nothing.
    #[test]
    fn corners_out_of_reach_are_left_out() {
        let domain = Domain::unit_torus(3);
        let beyond = RadialBins::linear(0.1, 1).unwrap().thresholds(&domain).unwrap()[1];
        for (reach, cells) in [(1, 14), (2, 63), (3, (343 - 8 - 24 + 1) / 2)] {
            let grid = CellGrid::new(&domain, beyond, reach, 1e9).unwrap();
            let count: i32 = grid.stencil(&domain, beyond).iter().map(|row| row.last - row.first + 1).sum();
            assert_eq!(count, cells, "reach {reach}");
        }
    }
}

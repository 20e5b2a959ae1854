//! Points sorted by cell, and which points are looked at from each: runs of cells along x are contiguous ranges of
//! points. Every unordered pair closer than the last edge is met exactly once.

use std::borrow::Cow;
use std::ops::Range;

use crate::plan::{CellGrid, PairPlan, PairSearch, StencilRow};

/// What all realizations share.
#[derive(Debug, Clone)]
pub(crate) struct Neighbourhood {
    grid: CellGrid,
    wraps: bool,
    stencil: Vec<StencilRow>,
}

/// The points of one realization in the order of their cells (x fastest, then y, then z), and within a cell as they came.
#[derive(Debug, Clone)]
pub(crate) struct SortedPoints {
    /// Cell `c` holds the points `starts[c]..starts[c + 1]` of the order.
    pub(crate) starts: Vec<u32>,
    /// The original index of each point; `None` where the order is unchanged.
    pub(crate) order: Option<Vec<u32>>,
}

impl Neighbourhood {
    pub(crate) fn new(plan: &PairPlan) -> Self {
        let grid = match plan.search {
            PairSearch::All => CellGrid::undivided(),
            PairSearch::Cells(grid) => grid,
        };
        let beyond = plan.thresholds[plan.bins.len()];
        Self { grid, wraps: plan.domain.is_torus(), stencil: grid.stencil(&plan.domain, beyond) }
    }

    /// Sorts points, given by their position along each axis in fixed-point steps (`Ensemble::lengths`).
    pub(crate) fn sort(&self, plan: &PairPlan, axes: &[&[u64]]) -> SortedPoints {
        let n = axes[0].len();
        if self.grid.len() == 1 {
            return SortedPoints { starts: vec![0, n as u32], order: None };
        }
        let mut cells = vec![0u32; n];
        let mut stride = 1;
        for ((axis, rule), count) in axes.iter().zip(self.grid.axes(&plan.domain)).zip(self.grid.cells) {
            for (cell, &position) in cells.iter_mut().zip(*axis) {
                *cell += rule.cell(position) * stride;
            }
            stride *= count;
        }
        // One place further than where the points of a cell end up: filling the cells moves each start to its place.
        let mut starts = vec![0u32; self.grid.len() + 2];
        for &cell in &cells {
            starts[cell as usize + 2] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut order = vec![0u32; n];
        for (j, &cell) in cells.iter().enumerate() {
            let place = &mut starts[cell as usize + 1];
            order[*place as usize] = j as u32;
            *place += 1;
        }
        starts.pop();
        SortedPoints { starts, order: Some(order) }
    }

    /// The ranges of points to be looked at from the points `rows` of `cell`. The first begins with `rows` themselves: of
    /// it, each point sees only those after it.
    pub(crate) fn partners(&self, starts: &[u32], cell: usize, rows: &Range<usize>, ranges: &mut Vec<Range<usize>>) {
        ranges.clear();
        let [nx, ny, nz] = self.grid.cells.map(|c| c as i32);
        let cell = cell as i32;
        let (x, y, z) = (cell % nx, cell / nx % ny, cell / nx / ny);
        for row in &self.stencil {
            let (Some(y), Some(z)) = (self.inside(y + row.dy, ny), self.inside(z + row.dz, nz)) else { continue };
            let line = (z * ny + y) * nx;
            let mut push = |from: i32, to: i32| {
                let range = starts[(line + from) as usize] as usize..starts[(line + to) as usize] as usize;
                match ranges.last_mut() {
                    None => ranges.push(rows.start..range.end),
                    Some(last) if last.end == range.start => last.end = range.end,
                    Some(_) if range.is_empty() => {}
                    Some(_) => ranges.push(range),
                }
            };
            let (from, to) = (x + row.first, x + row.last + 1);
            push(from.max(0), to.min(nx));
            if self.wraps && from < 0 {
                push(from + nx, nx);
            }
            if self.wraps && to > nx {
                push(0, to - nx);
            }
        }
    }

    /// An index along an axis, wrapped on a torus.
    fn inside(&self, c: i32, cells: i32) -> Option<i32> {
        let wrapped = if c < 0 {
            c + cells
        } else if c >= cells {
            c - cells
        } else {
            c
        };
        (self.wraps || wrapped == c).then_some(wrapped)
    }
}

impl SortedPoints {
    /// What belongs to the points, in their new order.
    pub(crate) fn permuted<'a, T: Copy>(&self, values: &'a [T]) -> Cow<'a, [T]> {
        match &self.order {
            None => Cow::Borrowed(values),
            Some(order) => order.iter().map(|&j| values[j as usize]).collect(),
        }
    }

    /// The runs of points of one cell that make up `points`, with their cell.
    pub(crate) fn runs(&self, points: Range<usize>) -> impl Iterator<Item = (usize, Range<usize>)> + '_ {
        let Range { start: mut begin, end } = points;
        let mut cell = self.starts.partition_point(|&s| s as usize <= begin).saturating_sub(1);
        std::iter::from_fn(move || {
            if begin >= end {
                return None;
            }
            while self.starts[cell + 1] as usize <= begin {
                cell += 1;
            }
            let run = begin..end.min(self.starts[cell + 1] as usize);
            begin = run.end;
            Some((cell, run))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Correction, EnsembleShape, RadialBins, SearchCosts};
    use crate::points::geometry::squared_distance;
    use crate::points::{Domain, Ensemble, RawPoints};

    /// Every pair is met at most once, and every pair closer than the last edge exactly once.
    #[test]
    fn near_pairs_are_met_once() {
        let n = 400;
        let domains = [
            Domain::unit_torus(1),
            Domain::unit_torus(2),
            Domain::unit_torus(3),
            Domain::torus(&[1.0, 0.3, 2.0]).unwrap_or_else(|e| panic!("{e}")),
            Domain::window(&[(0.0, 1.0), (5.0, 5.4)]).unwrap_or_else(|e| panic!("{e}")),
            Domain::window(&[(-1.0, 1.0), (0.0, 1.0), (0.0, 0.5)]).unwrap_or_else(|e| panic!("{e}")),
        ];
        let shape = EnsembleShape { realizations: 1, mean_points: n as f64, max_points: n as u64 };
        let costs = SearchCosts { cells_per_point: 10.0, ..SearchCosts::CPU };
        let mut looked_at = 0;
        for domain in &domains {
            // Points on sides of cells (multiples of 1/20) and between them.
            let coordinate = |i: usize| {
                let k = i % domain.dim();
                let place = i * 7919 % 4001;
                let fraction = if i.is_multiple_of(3) { (place / 200) as f64 / 20.0 } else { place as f64 / 4001.0 };
                domain.origin()[k] + fraction.min(1.0 - 1e-9) * domain.sides()[k]
            };
            let coordinates = (0..n * domain.dim()).map(coordinate).collect();
            let set = RawPoints { dim: domain.dim(), coordinates, source: "test".into(), lines: Vec::new() };
            let ensemble = Ensemble::from_raw(&[set], domain, false, 0).unwrap_or_else(|e| panic!("{e}"));
            let axes = ensemble.lengths(0);
            for r in [0.499, 0.25, 0.1, 0.02] {
                let bins = RadialBins::linear(r * domain.shortest_side(), 1).unwrap_or_else(|e| panic!("{e}"));
                let plan = PairPlan::new(domain, bins, Correction::None, shape).unwrap_or_else(|e| panic!("{e}"));
                for estimate in plan.searches(&costs) {
                    let plan = PairPlan { search: estimate.search, ..plan.clone() };
                    let near = Neighbourhood::new(&plan);
                    let sorted = near.sort(&plan, &axes);
                    let original = |p: usize| sorted.order.as_ref().map_or(p, |order| order[p] as usize);
                    let mut met = vec![0u8; n * n];
                    let mut ranges = Vec::new();
                    for block in [0..150, 150..n] {
                        for (cell, rows) in sorted.runs(block) {
                            near.partners(&sorted.starts, cell, &rows, &mut ranges);
                            for i in rows.clone() {
                                let own = ranges[0].clone().skip(i - rows.start + 1);
                                for j in own.chain(ranges[1..].iter().cloned().flatten()) {
                                    let (a, b) = (original(i), original(j));
                                    met[a.min(b) * n + a.max(b)] += 1;
                                    looked_at += 1;
                                }
                            }
                        }
                    }
                    for i in 0..n {
                        for j in i + 1..n {
                            let near = squared_distance(&axes, domain.periods(), i, j) < plan.thresholds[1];
                            let times = met[i * n + j];
                            assert!(times <= 1 && (times == 1 || !near), "{domain:?}, {}, {i}, {j}", estimate.search);
                        }
                    }
                }
            }
        }
        assert!(looked_at > 1_000_000);
    }
}

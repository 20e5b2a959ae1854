//! Numbers of points in boxes and balls: intervals by a sweep over where points enter and leave, boxes by running sums over a
//! lattice of cells, balls by the distances from every centre. Integers throughout.

use rayon::prelude::*;

use super::Cpu;
use crate::accumulate::{CountSums, Places, RealizationCounts};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{CountExtent, CountPlan};
use crate::points::Ensemble;
use crate::points::geometry::minimum_image;
use crate::points::polygon::Polygon;

/// Of every realization.
pub(super) fn counts(cpu: &Cpu, plan: &CountPlan, ensemble: &Ensemble, control: &Control) -> Result<CountSums> {
    let part = 1.0 / ensemble.realizations() as f64;
    let of = |k: usize| {
        let (index, n) = (ensemble.first_index() + k as u64, ensemble.points_in(k) as u64);
        let lengths = ensemble.lengths(k);
        let lattice = (lengths.len() > 1).then(|| Lattice::new(plan, &ensemble.fractions(k), index));
        let mut sizes = (plan.sizes.par_iter())
            .map(|size| {
                control.check()?;
                Ok(match (size.extent, &lattice) {
                    (CountExtent::Interval(length), _) => intervals(plan, lengths[0], length),
                    (CountExtent::Cells(q), Some(lattice)) => lattice.boxes(q),
                    _ => Places::default(),
                })
            })
            .collect::<Result<Vec<_>>>()?;
        balls(plan, &lengths, index, &mut sizes, control)?;
        control.advance(part);
        Ok(RealizationCounts { index, n, sizes })
    };
    let all = cpu.pool.install(|| (0..ensemble.realizations()).into_par_iter().map(of).collect::<Result<_>>())?;
    CountSums::of(plan.sizes.len(), all)
}

/// Over all places t of `[t, t + length)`: the places from which a point is in it begin a length before it and end at it.
fn intervals(plan: &CountPlan, x: &[u64], length: u64) -> Places {
    let (torus, side) = (plan.domain.is_torus(), u128::from(plan.domain.side_steps()[0]));
    let (side, s) = (if side == 0 { 1 << 64 } else { side }, u128::from(length));
    let end = if torus { side } else { side - s };
    // On a torus those that begin before the seam hold from 0 on.
    let mut held = if torus { x.iter().filter(|&&x| u128::from(x) < s).count() as u128 } else { 0 };
    let enters = |&x: &u64| match u128::from(x) {
        x if x >= s => x - s,
        x if torus => x + side - s,
        _ => 0,
    };
    let mut enter: Vec<u128> = x.iter().map(enters).collect();
    let mut leave: Vec<u128> = x.iter().map(|&x| u128::from(x).min(end)).collect();
    enter.sort_unstable();
    leave.sort_unstable();
    let (mut all, mut at, mut enter) = (Places::default(), 0, enter.into_iter().peekable());
    let mut go = |to: u128, held: u128| {
        all.add(to - at, held);
        at = to;
    };
    for leaves in leave {
        while let Some(enters) = enter.next_if(|&enters| enters <= leaves) {
            go(enters, held);
            held += 1;
        }
        go(leaves, held);
        held -= 1;
    }
    for enters in enter {
        go(enters, held);
        held += 1;
    }
    go(end, held);
    all
}

/// Cells with the number of points in each.
struct Lattice {
    cells: usize,
    dim: usize,
    points: Vec<u32>,
    /// 1 where a cell is not in the window as a whole; nothing on a torus.
    outside: Option<Vec<u32>>,
}

impl Lattice {
    fn new(plan: &CountPlan, axes: &[&[u64]], realization: u64) -> Self {
        let (cells, dim) = (plan.cells, axes.len());
        let mut points = vec![0; cells.pow(dim as u32)];
        let shifts: Vec<u64> = (0..dim).map(|a| plan.cell_shift(realization, a)).collect();
        let along = |a: usize, i: usize| {
            // The upper end of a window, which has wrapped to 0, comes into the last cell, as what is before the first.
            let shifted = axes[a][i].wrapping_sub(shifts[a]);
            ((u128::from(shifted) * cells as u128) >> 64) as usize
        };
        for i in 0..axes[0].len() {
            points[(0..dim).fold(0, |cell, a| cell * cells + along(a, i))] += 1;
        }
        let outside = (!plan.domain.is_torus()).then(|| {
            let ends: Vec<Vec<[f64; 2]>> =
                (0..dim).map(|a| (0..cells).map(|c| plan.cell_ends(realization, a, c)).collect()).collect();
            let polygon = plan.domain.as_polygon();
            let beyond = |cell: usize| {
                let along = |a: usize| cell / cells.pow((dim - 1 - a) as u32) % cells;
                let cut = (0..dim).any(|a| along(a) == cells - 1);
                let crossed = |polygon: &Polygon| !polygon.holds_box([ends[0][along(0)], ends[1][along(1)]]);
                u32::from(cut || polygon.is_some_and(crossed))
            };
            (0..points.len()).into_par_iter().map(beyond).collect()
        });
        Self { cells, dim, points, outside }
    }

    /// Over all places of boxes of q cells per axis that are in the window.
    fn boxes(&self, q: usize) -> Places {
        let points = self.running_sums(&self.points, q);
        let mut all = Places::default();
        match &self.outside {
            None => points.iter().for_each(|&n| all.add(1, u128::from(n))),
            Some(outside) => {
                let outside = self.running_sums(outside, q);
                let within = points.iter().zip(&outside).filter(|(_, beyond)| **beyond == 0);
                within.for_each(|(&n, _)| all.add(1, u128::from(n)));
            }
        }
        all
    }

    /// Over the q cells from each on, along every axis, around the seam.
    fn running_sums(&self, field: &[u32], q: usize) -> Vec<u32> {
        let mut field = field.to_vec();
        let mut line = vec![0; self.cells];
        for axis in 0..self.dim {
            let step = self.cells.pow(axis as u32);
            for block in field.chunks_exact_mut(step * self.cells) {
                for start in 0..step {
                    line.iter_mut().zip(block[start..].iter().step_by(step)).for_each(|(to, from)| *to = *from);
                    let mut sum: u32 = line[..q].iter().sum();
                    for i in 0..self.cells {
                        block[start + i * step] = sum;
                        // In this order, nothing falls below 0.
                        sum = sum + line[(i + q) % self.cells] - line[i];
                    }
                }
            }
        }
        field
    }
}

/// Centres between two looks at the control.
const CENTERS: usize = 16;

/// About every centre, all sizes at once.
fn balls(plan: &CountPlan, axes: &[&[u64]], realization: u64, sizes: &mut [Places], control: &Control) -> Result<()> {
    let radius = |extent| if let CountExtent::Ball(radius) = extent { Some(radius) } else { None };
    let radii: Vec<u64> = plan.sizes.iter().filter_map(|size| radius(size.extent)).collect();
    if radii.is_empty() {
        return Ok(());
    }
    let squares: Vec<u128> = radii.iter().map(|&r| u128::from(r).pow(2)).collect();
    let rounded: Vec<f64> = squares.iter().map(|&r| r as f64).collect();
    let (domain, periods, n) = (&plan.domain, plan.domain.periods(), axes[0].len());
    let about = |all: &mut [Places], index: usize, found: &mut [u32]| {
        let center = plan.center(realization, index);
        let reach = match domain.as_polygon() {
            _ if domain.is_torus() => u64::MAX,
            Some(polygon) if !polygon.contains([center[0], center[1]]) => return,
            _ => domain.border().distance(&center[..axes.len()]),
        };
        // How many of the radii fit.
        let fitting = radii.partition_point(|&r| r <= reach);
        let Some(largest) = fitting.checked_sub(1).map(|last| rounded[last] * (1.0 + 1e-12)) else { return };
        found.fill(0);
        for i in 0..n {
            let along = |a: usize| minimum_image(axes[a][i], center[a], periods[a]);
            let about = (0..axes.len()).map(|a| (along(a) as f64).powi(2)).sum::<f64>();
            if about > largest {
                continue;
            }
            let mut size = rounded[..fitting].partition_point(|&r| r * (1.0 + 1e-12) <= about);
            // What rounding could have moved is decided in integers.
            let square = || -> u128 { (0..axes.len()).map(|a| u128::from(along(a)).pow(2)).sum() };
            if size < fitting && about >= rounded[size] * (1.0 - 1e-12) && square() >= squares[size] {
                size += 1;
            }
            found[size] += 1;
        }
        let mut inside = 0;
        for (places, found) in all[..fitting].iter_mut().zip(&*found) {
            inside += u128::from(*found);
            places.add(1, inside);
        }
    };
    let centers: Vec<usize> = (0..plan.center_count()).collect();
    let parts = centers.par_chunks(CENTERS).map(|some| {
        control.check()?;
        let (mut all, mut found) = (vec![Places::default(); radii.len()], vec![0; radii.len() + 1]);
        some.iter().for_each(|&index| about(&mut all, index, &mut found));
        Ok(all)
    });
    let together = |mut a: Vec<Places>, b: Vec<Places>| {
        for (a, b) in a.iter_mut().zip(b) {
            a.places += b.places;
            a.sum += b.sum;
            a.squares += b.squares;
        }
        Ok(a)
    };
    let all = parts.try_reduce(|| vec![Places::default(); radii.len()], together)?;
    let of_balls = plan.sizes.iter().zip(sizes).filter(|(size, _)| radius(size.extent).is_some());
    of_balls.zip(all).for_each(|((_, places), all)| *places = all);
    Ok(())
}

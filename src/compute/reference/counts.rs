//! Numbers of points in boxes and balls, place by place; in one dimension, where every place counts,
//!
//! ```text
//! int N(t) dt = sum_i |I_i|     int N(t)^2 dt = sum_ij |I_i n I_j|     I_i = (x_i - s, x_i] on the torus, or cut to [0, L - s]
//! ```
//!
//! with `I_i` the places t from which an interval `[t, t + s)` holds point i.

use crate::accumulate::{CountSums, Places, RealizationCounts};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{CountExtent, CountPlan};
use crate::points::Ensemble;
use crate::points::geometry::minimum_image;

/// Of every realization.
pub(super) fn counts(plan: &CountPlan, ensemble: &Ensemble, control: &Control) -> Result<CountSums> {
    let of = |k: usize| {
        let index = ensemble.first_index() + k as u64;
        let each = plan.sizes.iter().map(|size| {
            control.check()?;
            Ok(match size.extent {
                CountExtent::Interval(length) => intervals(plan, ensemble.lengths(k)[0], length),
                CountExtent::Cells(q) => boxes(plan, &ensemble.fractions(k), index, q),
                CountExtent::Ball(radius) => balls(plan, &ensemble.lengths(k), index, radius),
            })
        });
        Ok(RealizationCounts { index, n: ensemble.points_in(k) as u64, sizes: each.collect::<Result<_>>()? })
    };
    CountSums::of(plan.sizes.len(), (0..ensemble.realizations()).map(of).collect::<Result<_>>()?)
}

fn intervals(plan: &CountPlan, x: &[u64], length: u64) -> Places {
    let (torus, side) = (plan.domain.is_torus(), plan.domain.side_steps()[0]);
    let (side, s) = (if side == 0 { 1 << 64 } else { i128::from(side) }, i128::from(length));
    let mut all = Places { places: (if torus { side } else { side - s }) as u128, ..Places::default() };
    let held = |i: usize| (0.max(i128::from(x[i]) - s), i128::from(x[i]).min(side - s));
    for i in 0..x.len() {
        for j in 0..x.len() {
            let both = if torus {
                s - i128::from(minimum_image(x[i], x[j], plan.domain.periods()[0]))
            } else {
                held(i).1.min(held(j).1) - held(i).0.max(held(j).0)
            };
            all.squares += both.max(0) as u128;
            all.sum += if i == j { both.max(0) as u128 } else { 0 };
        }
    }
    all
}

fn boxes(plan: &CountPlan, axes: &[&[u64]], realization: u64, q: usize) -> Places {
    let (cells, dim) = (plan.cells, axes.len());
    let cell = |a: usize, x: u64| {
        let shifted = x.wrapping_sub(plan.cell_shift(realization, a));
        ((u128::from(shifted) * cells as u128) >> 64) as usize
    };
    let mut all = Places::default();
    for place in 0..cells.pow(dim as u32) {
        let corner: Vec<usize> = (0..dim).map(|a| place / cells.pow(a as u32) % cells).collect();
        let window = !plan.domain.is_torus();
        if window && corner.iter().any(|c| c + q > cells - 1) {
            continue;
        }
        if let Some(polygon) = plan.domain.as_polygon() {
            let ends = |a: usize| {
                let [low, high] = [corner[a], corner[a] + q - 1].map(|c| plan.cell_ends(realization, a, c));
                [low[0], high[1]]
            };
            if !polygon.holds_box([ends(0), ends(1)]) {
                continue;
            }
        }
        let inside = |&i: &usize| (0..dim).all(|a| (cell(a, axes[a][i]) + cells - corner[a]) % cells < q);
        all.add(1, (0..axes[0].len()).filter(inside).count() as u128);
    }
    all
}

fn balls(plan: &CountPlan, axes: &[&[u64]], realization: u64, radius: u64) -> Places {
    let (domain, periods) = (&plan.domain, plan.domain.periods());
    let mut all = Places::default();
    for index in 0..plan.center_count() {
        let center = plan.center(realization, index);
        if !domain.is_torus() {
            let polygon = domain.as_polygon();
            let outside = polygon.is_some_and(|polygon| !polygon.contains([center[0], center[1]]));
            if outside || domain.border().distance(&center[..axes.len()]) < radius {
                continue;
            }
        }
        let square = |i: usize| -> u128 {
            (0..axes.len()).map(|a| u128::from(minimum_image(axes[a][i], center[a], periods[a])).pow(2)).sum()
        };
        let inside = (0..axes[0].len()).filter(|&i| square(i) < u128::from(radius).pow(2));
        all.add(1, inside.count() as u128);
    }
    all
}

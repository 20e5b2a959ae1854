//! Lag counts, by the definition.
//!
//! For points `x_1 .. x_n` in a box `D` with sides `L`, and cells of lags `C_k = prod_a [e_(k_a), e_(k_a + 1))` with the
//! symmetric edges `e_k = H (2k - B) / B`:
//!
//! ```text
//! c_k = sum_(i < j) 1[h_ij in C_k] + 1[h_ij in C_(k')]        k' = B - 1 - k on every axis
//! ```
//!
//! (e.g. Illian et al., `Statistical Analysis and Modelling of Spatial Point Patterns`, 2008, section 4.5, for g of a
//! vector). `h_ij` is one of the two lags of the pair, `x_i - x_j` and `x_j - x_i`, on a torus as minimum images in
//! `[-L/2, L/2)`. Which one does not matter, because `C_k'` is the mirror image of `C_k`, unless a component lies exactly
//! on an edge: a half-open cell has its lower sides, its mirror image has the upper ones. So that counts depend neither on
//! the order of points nor on the direction of the axes' arrows, the lag is chosen by its value: the one whose first
//! component that is not its own negative is positive. (0 is its own negative, and on a torus half a period.) Where all
//! components are, both lags are the same. Hence:
//!
//! - `c_k = c_k'` for every input, and the sum over a grid of all lags is `n (n - 1)`;
//! - coincident points are half in the cell above lag 0, half in the one below where B is even, and all in the middle
//!   cell where B is odd;
//! - a lag `(h, 0)` of a lattice with `h > 0` on an edge and B even is in the cell to the right of `h` above the axis, and
//!   its mirror image to the left of `-h` below the axis;
//! - a lag of exactly half a period is in the first and, mirrored, in the last bin;
//! - in a window, whose sides are closed, a lag that spans a side exactly may fall on the open end of the grid and is then
//!   not counted.
//!
//! Coordinates are integers in steps of `length_unit / 2^64`, compared with integer thresholds: no rounding anywhere.

use crate::accumulate::PairHistogram;
use crate::compute::Control;
use crate::error::Result;
use crate::plan::LagPlan;

/// The lag `a - b` along one axis of a torus, in steps, in `[-period / 2, period / 2)`; `period` 0 stands for 2^64.
fn torus_lag(a: u64, b: u64, period: u64) -> i64 {
    let forward = if a >= b { a - b } else { a.wrapping_sub(b).wrapping_add(period) };
    let nearer = if forward >= period.wrapping_sub(forward) { forward.wrapping_sub(period) } else { forward };
    nearer as i64
}

/// The lag of points `i` and `j`, chosen of the two by its value.
pub fn canonical_lag(plan: &LagPlan, axes: &[&[u64]], i: usize, j: usize) -> [i128; 3] {
    let lag = |i: usize, j: usize| {
        let mut lag = [0; 3];
        for ((lag, axis), period) in lag.iter_mut().zip(axes).zip(plan.domain.periods()) {
            *lag = if plan.domain.is_torus() {
                i128::from(torus_lag(axis[i], axis[j], period))
            } else {
                i128::from(axis[i]) - i128::from(axis[j])
            };
        }
        lag
    };
    let (there, back) = (lag(i, j), lag(j, i));
    // A component that is its own negative is the same in both.
    match there.iter().zip(&back).find(|(a, b)| a != b) {
        Some((a, _)) if *a < 0 => back,
        _ => there,
    }
}

/// The cell of the lag of points `i` and `j`, `None` outside the grid. The pair counts there and in the mirror cell.
pub fn lag_cell(plan: &LagPlan, axes: &[&[u64]], i: usize, j: usize) -> Option<usize> {
    let lag = canonical_lag(plan, axes, i, j);
    let mut cell = 0;
    for (h, thresholds) in lag.iter().zip(&plan.grid.thresholds) {
        let edges_below = thresholds.partition_point(|t| t <= h);
        if !(1..=plan.grid.bins).contains(&edges_below) {
            return None;
        }
        cell = cell * plan.grid.bins + edges_below - 1;
    }
    Some(cell)
}

/// The histogram of one realization. `axes[a][j]` is the position of point `j` along axis `a`.
pub(super) fn lag_counts(plan: &LagPlan, axes: &[&[u64]], control: &Control) -> Result<PairHistogram> {
    let n = axes[0].len();
    let mut counts = vec![0; plan.grid.cells()];
    for i in 0..n {
        control.check()?;
        for j in 0..i {
            if let Some(cell) = lag_cell(plan, axes, i, j) {
                counts[cell] += 1;
                counts[plan.grid.mirror(cell)] += 1;
            }
        }
    }
    Ok(PairHistogram::new(n as u64, counts, None))
}

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
use crate::control::Control;
use crate::error::Result;
use crate::plan::LagPlan;
use crate::points::geometry::canonical_lag;

/// The histogram of one realization. `axes[a][j]` is the position of point `j` along axis `a`.
pub(super) fn lag_counts(plan: &LagPlan, axes: &[&[u64]], control: &Control) -> Result<PairHistogram> {
    let n = axes[0].len();
    let mut counts = vec![0; plan.grid.cells()];
    for i in 0..n {
        control.check()?;
        for j in 0..i {
            if let Some(cell) = plan.grid.cell(canonical_lag(&plan.domain, axes, i, j)) {
                counts[cell] += 1;
                counts[plan.grid.mirror(cell)] += 1;
            }
        }
    }
    Ok(PairHistogram::new(n as u64, counts, None))
}

//! Kernel sums, by the definition.
//!
//! For points `x_1 .. x_n`, a kernel `k_b` of bandwidth b, and every r:
//!
//! ```text
//! c(r) = sum_i sum_(j != i) w(x_i - x_j) k_b(r - |x_i - x_j|) [ / S(|x_i - x_j|) ]
//! ```
//!
//! over pairs closer than `KernelPlan::range`, with `w` and `|.|` as in `pair_counts` and S the surface of the sphere, which
//! divides here only if the divisor is d (Illian et al., Statistical Analysis and Modelling of Spatial Point Patterns, 2008,
//! section 4.3.3; for divisor d Guan, Statistics and Probability Letters 77, 2007). Squared distances are exact
//! integers; their root and all that follows is f64.

use super::pair_counts::{mass_sums, pair_weight};
use crate::accumulate::{KernelCurve, PairHistogram};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Divisor, KernelPlan, sphere_surface};
use crate::points::geometry::squared_distance;

/// The sums of one realization. `axes[a][j]` is the position of point `j` along axis `a`, `masses[j]` its weight.
pub(super) fn kernel_sums(
    plan: &KernelPlan,
    axes: &[&[u64]],
    masses: Option<&[f64]>,
    control: &Control,
) -> Result<KernelCurve> {
    let n = axes[0].len();
    let (domain, dim) = (&plan.pairs.domain, plan.pairs.domain.dim());
    let beyond = plan.pairs.thresholds[plan.pairs.bins.len()];
    let squares = plan.pairs.masses.then(|| mass_sums(n, masses));
    let mut curve = KernelCurve::new(PairHistogram::unit_norms(n as u64, squares), plan.r.len());
    for i in 0..n {
        control.check()?;
        for j in 0..n {
            let r2 = squared_distance(axes, domain.periods(), i, j);
            if i == j || r2 >= beyond {
                continue;
            }
            let d = (r2 as f64).sqrt() * 2f64.powi(-64) * domain.length_unit();
            let weight = |i, j| pair_weight(&plan.pairs, axes, masses, i, j) as f64 / plan.pairs.weight_steps();
            let (mut weight, mut both) = (weight(i, j), weight(i, j) + weight(j, i));
            if plan.divisor == Divisor::D {
                if sphere_surface(d, dim) == 0.0 {
                    curve.coincident += 1;
                    continue;
                }
                weight /= sphere_surface(d, dim);
                both /= sphere_surface(d, dim);
            }
            for (k, &r) in plan.r.iter().enumerate() {
                let value = plan.kernel.value(r - d);
                curve.sums[k] += weight * value;
                // Each unordered pair is met twice.
                curve.squares[k] += 0.5 * (both * value).powi(2);
            }
        }
    }
    Ok(curve)
}

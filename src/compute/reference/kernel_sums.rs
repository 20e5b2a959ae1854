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

use super::{squared_distance, translation_weight};
use crate::accumulate::{KernelCurve, WEIGHT_STEPS};
use crate::compute::Control;
use crate::error::Result;
use crate::plan::{Correction, Divisor, KernelPlan, sphere_surface};

/// The sums of one realization. `axes[a][j]` is the position of point `j` along axis `a`.
pub(super) fn kernel_sums(plan: &KernelPlan, axes: &[&[u64]], control: &Control) -> Result<KernelCurve> {
    let n = axes[0].len();
    let (domain, dim) = (&plan.pairs.domain, plan.pairs.domain.dim());
    let beyond = plan.pairs.thresholds[plan.pairs.bins.len()];
    let mut curve = KernelCurve::new(n as u64, plan.r.len());
    for i in 0..n {
        control.check()?;
        for j in 0..n {
            let r2 = squared_distance(axes, domain.periods(), i, j);
            if i == j || r2 >= beyond {
                continue;
            }
            let d = (r2 as f64).sqrt() * 2f64.powi(-64) * domain.length_unit();
            let mut weight = match plan.pairs.correction {
                Correction::Translation => translation_weight(axes, domain, i, j) as f64 / WEIGHT_STEPS,
                _ => 1.0,
            };
            if plan.divisor == Divisor::D {
                if sphere_surface(d, dim) == 0.0 {
                    curve.coincident += 1;
                    continue;
                }
                weight /= sphere_surface(d, dim);
            }
            for (k, &r) in plan.r.iter().enumerate() {
                let value = weight * plan.kernel.value(r - d);
                curve.sums[k] += value;
                // (2 value)^2 for each unordered pair.
                curve.squares[k] += 2.0 * value * value;
            }
        }
    }
    Ok(curve)
}

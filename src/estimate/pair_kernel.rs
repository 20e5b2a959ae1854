//! Kernel sums -> smoothed g(r).

use super::Analysis;
use super::{CrossValidation, ErrorSource, Normalization, ratio_standard_error};
use crate::accumulate::KernelSums;
use crate::plan::{Divisor, KernelMethod, KernelPlan, Smoothing, sphere_surface};

/// `g(r) = |D| sum_k c_k(r) / (S(r) sum_k N)` over realizations k, with `c_k` their kernel sums, `S` the surface of the
/// sphere of radius r (divisor r; for divisor d it is in the sums) and `N` as for `PairCorrelation`; see Illian et al. 2008,
/// section 4.3.3. `None` where it is undefined: r = 0, or where the kernel reaches beyond the longest distance the domain
/// allows. Mass that the kernel puts below r = 0 is lost: there is no boundary correction.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelEstimate {
    /// The kernel.
    pub kernel: Smoothing,
    /// What pairs were divided by.
    pub divisor: Divisor,
    /// How the sum was taken.
    pub method: KernelMethod,
    /// Where g is estimated.
    pub r: Vec<f64>,
    /// g.
    pub g: Vec<Option<f64>>,
    /// Its standard error. Theory, for K = 1: that of independent (Poisson) pairs, `|D| / (S N) sqrt(sum_pairs (2 w k)^2)`
    /// over unordered pairs.
    pub g_se: Vec<Option<f64>>,
    /// Where `g_se` comes from.
    pub errors: ErrorSource,
    /// No g differs by more from the direct sum, rounding aside.
    pub bound: f64,
    /// How the bandwidth was found, if by cross-validation.
    pub cross_validation: Option<CrossValidation>,
}

impl KernelEstimate {
    /// The estimate. With no pair of points at all (every n < 2) g is NaN; callers check first.
    pub fn new(plan: &KernelPlan, sums: &KernelSums, normalization: Normalization) -> Self {
        let (domain, which) = (&plan.pairs.domain, normalization as usize);
        let errors = ErrorSource::of(sums.realizations);
        let totals = sums.totals();
        let [norm, norm_squared] = totals.norms[which];
        let mut bound: f64 = 0.0;
        let at = |(k, &r): (usize, &f64)| {
            if !plan.covers(r) {
                return (None, None);
            }
            let surface = if plan.divisor == Divisor::R { sphere_surface(r, domain.dim()) } else { 1.0 };
            let scale = domain.measure() / (surface * norm);
            let error = match errors {
                ErrorSource::AcrossRealizations => {
                    let ratio = totals.sums[k] / norm;
                    let residuals =
                        totals.sum_squares[k] - 2.0 * ratio * totals.products[which][k] + ratio * ratio * norm_squared;
                    ratio_standard_error(sums.realizations, residuals, 1.0)
                }
                _ => totals.squares[k].sqrt(),
            };
            bound = bound.max(scale * totals.bounds[k]);
            (Some(scale * totals.sums[k]), Some(scale * error))
        };
        let (g, g_se) = plan.r.iter().enumerate().map(at).unzip();
        let (kernel, divisor, method) = (plan.kernel, plan.divisor, plan.method);
        Self { kernel, divisor, method, r: plan.r.clone(), g, g_se, errors, bound, cross_validation: None }
    }
}

impl Analysis {
    /// g smoothed, at the bin centres.
    pub fn kernel(&self) -> Option<&KernelEstimate> {
        self.get()
    }
}

//! What `summary.json` says of g, of two classes and of K.

use serde::Serialize;

use crate::estimate::{Analysis, CrossValidation, ErrorSource, Normalization};
use crate::plan::{Correction, Divisor, KernelMethod, Smoothing};

#[derive(Serialize)]
pub(super) struct PairCorrelationOut {
    bins: usize,
    r_max: Option<f64>,
    normalization: Normalization,
    correction: Correction,
    errors: ErrorSource,
    kernel: Option<KernelOut>,
}

#[derive(Serialize)]
pub(super) struct CrossOut<'a> {
    /// As in the names of columns.
    classes: &'a [String; 2],
    correction: Correction,
    errors: ErrorSource,
}

#[derive(Serialize)]
pub(super) struct KFunctionOut {
    bins: usize,
    r_max: Option<f64>,
    normalization: Normalization,
    correction: Correction,
    errors: ErrorSource,
}

#[derive(Serialize)]
pub(super) struct KernelOut {
    #[serde(flatten)]
    kernel: Smoothing,
    divisor: Divisor,
    method: KernelMethod,
    /// On the difference of any g from the direct sum.
    bound: f64,
    errors: ErrorSource,
    cross_validation: Option<CrossValidation>,
}

/// Of g.
pub(super) fn pair_correlation(a: &Analysis) -> Option<PairCorrelationOut> {
    a.pair_correlation().map(|g| PairCorrelationOut {
        bins: g.g.len(),
        r_max: g.r_hi.last().copied(),
        normalization: g.normalization,
        correction: a.correction,
        errors: g.errors,
        kernel: a.kernel().map(|k| KernelOut {
            kernel: k.kernel,
            divisor: k.divisor,
            method: k.method,
            bound: k.bound,
            errors: k.errors,
            cross_validation: k.cross_validation,
        }),
    })
}

/// Of two classes.
pub(super) fn cross(a: &Analysis) -> Option<CrossOut<'_>> {
    a.cross().map(|c| CrossOut { classes: &c.classes, correction: a.correction, errors: c.between.errors })
}

/// Of K of two classes.
pub(super) fn cross_k(a: &Analysis) -> Option<CrossOut<'_>> {
    a.cross_k().map(|c| CrossOut { classes: &c.classes, correction: a.correction, errors: c.between.errors })
}

/// Of K.
pub(super) fn k_function(a: &Analysis) -> Option<KFunctionOut> {
    a.k_function().map(|k| KFunctionOut {
        bins: k.r.len(),
        r_max: k.r.last().copied(),
        normalization: k.normalization,
        correction: a.correction,
        errors: k.errors,
    })
}

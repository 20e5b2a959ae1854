//! Shared by the tests of this room.

use crate::common::*;
use pairwave::accumulate::{Backend, ComputedBy};
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::control::Control;
use pairwave::estimate::{KernelEstimate, Normalization};
use pairwave::plan::{Correction, Divisor, EnsembleShape, KernelMethod, KernelPlan, Smoothing};
use pairwave::points::Ensemble;

pub fn tag() -> ComputedBy {
    ComputedBy::new(Backend::Reference, "by hand")
}

/// A kernel plan for an ensemble; `mean_points` decides the method.
pub fn kernel_plan(
    e: &Ensemble,
    kernel: Smoothing,
    divisor: Divisor,
    r: &[f64],
    correction: Correction,
    n: f64,
) -> KernelPlan {
    let shape = EnsembleShape { mean_points: n, ..shape(e) };
    KernelPlan::new(kernel, divisor, r.to_vec(), false, e.domain(), correction, shape).unwrap()
}

pub fn cpu() -> Cpu {
    Cpu::new(Some(2)).unwrap()
}

pub fn direct(device: &dyn Compute, plan: &KernelPlan, e: &Ensemble) -> KernelEstimate {
    assert_eq!(plan.method, KernelMethod::Direct);
    let sums = wait(device.kernel_sums(plan, e, &Control::default())).unwrap();
    KernelEstimate::new(plan, &sums, Normalization::Pairs)
}

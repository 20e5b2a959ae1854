//! The kernel estimate of g: pair by pair, and from exact counts in fine bins.

use super::{Bench, Scene, Section, Way, error_of, sampled};
use crate::error::Result;
use crate::estimate::{KernelEstimate, Normalization};
use crate::plan::{Correction, Divisor, KernelMethod, KernelPlan, PairPlan, RadialBins, Smoothing, SmoothingKernel};

/// Bins of a bandwidth.
const FINE: [f64; 4] = [16.0, 64.0, 512.0, 4096.0];

pub(super) fn scene(bench: &Bench<'_>) -> Result<Scene> {
    let n: u64 = bench.size(1000, 4000);
    let ensemble = sampled("random", n, 1, 2, bench.control)?;
    // Stoyan's rule.
    let kernel = Smoothing { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.15 / (5.0 * n as f64).sqrt() };
    let r_max = 0.1;
    let r: Vec<f64> = (1..=256).map(|k| r_max * f64::from(k) / 256.0).collect();
    let (domain, shape) = (ensemble.domain(), ensemble.shape());
    let exact = KernelPlan::new(kernel, Divisor::R, r, true, domain, Correction::None, shape)?;
    let sums = bench.once(&bench.reference()?, &mut async |on| on.kernel_sums(&exact, &ensemble).await)?;
    let truth = KernelEstimate::new(&exact, &sums, Normalization::Pairs).g;
    let range = exact.pairs.bins.edges().last().copied().unwrap_or(r_max);
    let mut plans = vec![("pair by pair".to_string(), exact.clone())];
    for per_bandwidth in FINE {
        let bins = RadialBins::linear(range, (range / kernel.bandwidth * per_bandwidth).ceil() as usize)?;
        let pairs = PairPlan::new(domain, bins, Correction::None, shape)?;
        let plan = KernelPlan { method: KernelMethod::Binned, exact: false, pairs, ..exact.clone() };
        plans.push((format!("fine bins, {per_bandwidth} per bandwidth"), plan));
    }
    let mut ways = Vec::new();
    let mut statistical = 0.0;
    for device in &bench.devices {
        for (method, plan) in &plans {
            let mut plan = plan.clone();
            plan.pairs = plan.pairs.for_device(device.compute().costs().pairs);
            let (seconds, sums) = bench.timed(device, async |on| on.kernel_sums(&plan, &ensemble).await)?;
            let found = KernelEstimate::new(&plan, &sums, Normalization::Pairs);
            if ways.is_empty() {
                [statistical, _] = error_of(found.g_se.iter().flatten().copied());
            }
            let differences = found.g.iter().zip(&truth).filter_map(|(g, t)| Some((*g)? - (*t)?));
            ways.push(Way {
                method: method.clone(),
                device: sums.computed_by.device(),
                seconds,
                work: None,
                gflop: None,
                error: Some(error_of(differences)),
                statistical: None,
                front: false,
            });
        }
    }
    let name = format!("kernel estimate of g of {n} random points at 256 distances up to {r_max}");
    Ok(Scene { name, section: Section::Kernel, error_of: "g, over the distances", ways, statistical })
}

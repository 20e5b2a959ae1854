//! Envelopes: the same measurement on complete spatial randomness, many times.

use rayon::prelude::*;

use super::measure::{Input, Measured, measure};
use super::{Clock, Estimates, Progress};
use crate::compute::{Control, WithFallback};
use crate::error::Result;
use crate::estimate::{Curve, Envelope, Envelopes, Normalization};
use crate::points::{Domain, Ensemble, RawPoints};
use crate::samplers::{self, ParameterValues, Realization};

/// Every estimated function that has an envelope.
fn curves(estimates: &Estimates) -> Vec<Curve> {
    let g = estimates.pair_correlation.as_ref();
    let k = estimates.k_function.as_ref();
    let kernel = estimates.kernel.as_ref();
    let functions = estimates.neighbors.as_ref().map(|n| &n.functions);
    let defined = |values: &[Option<f64>]| values.iter().map(|v| v.unwrap_or(f64::NAN)).collect();
    let curves = [
        g.map(|g| Curve { name: "g", r: g.r.clone(), values: g.g.clone() }),
        kernel.map(|k| Curve { name: "g_kernel", r: k.r.clone(), values: defined(&k.g) }),
        k.map(|k| Curve { name: "k", r: k.r.clone(), values: k.k.clone() }),
        k.map(|k| Curve { name: "l_minus_r", r: k.r.clone(), values: k.l_minus_r.clone() }),
        functions.map(|n| Curve { name: "neighbor_g", r: n.r.clone(), values: defined(&n.g) }),
        functions.map(|n| Curve { name: "neighbor_f", r: n.r.clone(), values: defined(&n.f) }),
    ];
    curves.into_iter().flatten().collect()
}

/// Simulates what was measured: independent uniform points in the same domain, as many in each realization. A bandwidth
/// found by cross-validation is found anew, so that all curves are treated alike. Simulation s of N takes sampler `random` with
/// seed 2^64 - s, on the scale of the domain.
pub(super) fn envelopes(
    observed: &Measured<'_>,
    estimates: &Estimates,
    normalization: Normalization,
    device: &mut WithFallback<'_>,
    control: &Control,
    progress: &mut dyn FnMut(Progress),
) -> Result<Envelopes> {
    let simulations = observed.plan.simulations;
    let (plan, domain) = (observed.plan.of_simulations(), observed.first.domain());
    let observed_curves = curves(estimates);
    let mut simulated = vec![Vec::new(); observed_curves.len()];
    for s in 0..simulations {
        progress(Progress { stage: "envelope", done: s, total: simulations });
        let input = Input {
            subject: "simulation",
            realizations: observed.sizes.len() as u64,
            batch: &|range| {
                random(domain, u64::MAX - s, range.start, &observed.sizes[range.start as usize..range.end as usize])
            },
            normalization,
        };
        let measured = measure(&plan, &input, device, control, &mut Clock::default(), &mut |_, _| ())?;
        let curves = curves(&Estimates::new(&measured, normalization));
        simulated.iter_mut().zip(curves).for_each(|(all, curve)| all.push(curve.values));
    }
    let curves = observed_curves.into_iter().zip(simulated).map(|(curve, all)| Envelope::new(curve, &all)).collect();
    Ok(Envelopes { simulations, curves })
}

/// Realizations `first..` of complete spatial randomness, of the given sizes.
fn random(domain: &Domain, seed: u64, first: u64, sizes: &[u64]) -> Result<Ensemble> {
    let sampler = samplers::find("random")?;
    let values = ParameterValues::defaults(sampler)?;
    let dim = domain.dim();
    let one = |(index, &n): (u64, &u64)| {
        let realization = Realization { n, dim, seed, index };
        let mut coordinates = if n == 0 { Vec::new() } else { sampler.generate(&realization, &values)? };
        for point in coordinates.chunks_exact_mut(dim) {
            for ((x, origin), side) in point.iter_mut().zip(domain.origin()).zip(domain.sides()) {
                *x = origin + *x * side;
            }
        }
        Ok(RawPoints { dim, coordinates, source: "simulation".into(), lines: Vec::new() })
    };
    let sets: Vec<_> = (first..first + sizes.len() as u64).zip(sizes).collect();
    let raw = sets.into_par_iter().map(one).collect::<Result<Vec<_>>>()?;
    // Rounding may put a point on the far side of a torus.
    Ensemble::from_raw(&raw, domain, domain.is_torus(), first)
}

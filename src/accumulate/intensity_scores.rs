//! What the bandwidth of an intensity is found by: moments of the points, and the likelihood of each given the others.

use rayon::prelude::*;

use super::{IntensityScores, RealizationScores};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{IntensitySearch, KernelMass, kernel_sum};
use crate::points::Ensemble;

/// Of every realization.
pub(crate) fn scores(search: &IntensitySearch, ensemble: &Ensemble, control: &Control) -> Result<IntensityScores> {
    let part = 1.0 / ensemble.realizations() as f64;
    let of = |k: usize| {
        let one = realization(search, ensemble, k, control)?;
        control.advance(part);
        Ok(one)
    };
    let realizations = (0..ensemble.realizations()).map(of).collect::<Result<Vec<_>>>()?;
    Ok(IntensityScores { bandwidths: search.bandwidths.len(), realizations })
}

fn realization(
    search: &IntensitySearch,
    ensemble: &Ensemble,
    k: usize,
    control: &Control,
) -> Result<RealizationScores> {
    let domain = &search.domain;
    let (n, axes) = (ensemble.points_in(k), ensemble.offsets_from_corner(k));
    let (mut sums, mut squares) = ([0.0; 3], [0.0; 3]);
    for (a, axis) in axes.iter().enumerate() {
        let off = |x: &f64| x - 0.5 * domain.sides()[a];
        sums[a] = axis.iter().map(off).sum();
        squares[a] = axis.iter().map(|x| off(x).powi(2)).sum();
    }
    // Evenly spread over their order.
    let looked_at = n.min(search.points);
    let log = |which: usize, bandwidth: f64, mass: &KernelMass<'_>| {
        let i = which * n / looked_at.max(1);
        let place: Vec<f64> = axes.iter().map(|axis| axis[i]).collect();
        let others = kernel_sum(domain, bandwidth, &place, &axes, Some(i));
        // A lone point far from all others is as unlikely as f64 can say.
        (others / mass.at(&place)).max(f64::MIN_POSITIVE).ln()
    };
    let total = |&bandwidth: &f64| {
        control.check()?;
        let mass = KernelMass::new(domain, bandwidth);
        let each: Vec<f64> = (0..looked_at).into_par_iter().map(|which| log(which, bandwidth, &mass)).collect();
        // As if all had been looked at.
        Ok(each.iter().sum::<f64>() * n as f64 / looked_at.max(1) as f64)
    };
    let logs = search.bandwidths.iter().map(total).collect::<Result<_>>()?;
    Ok(RealizationScores { index: ensemble.first_index() + k as u64, n: n as u64, sums, squares, logs })
}

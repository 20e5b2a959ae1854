//! Nearest neighbours, on the CPU whatever the device: k-d tree and Delaunay triangulation are crates that run there.
//!
//! For each point of a realization the distance to the nearest other point, `d_i = min_(j != i) |x_i - x_j|` (minimum image
//! on a torus, plain in a window), for each test point of a lattice the distance to the nearest point, and the bonds
//! between neighbours in the plane.

mod bonds;
mod covering;
mod distribution;
mod search;

use std::borrow::Cow;

use rayon::prelude::*;

use crate::accumulate::{Bonds, Distances, NeighborSums, NoBonds, RealizationNeighbors};
use crate::control::Control;
use crate::error::Result;
use crate::plan::NeighborPlan;
use crate::points::{Domain, Ensemble};
pub(in crate::compute) use covering::covering_radius;
use distribution::distribution;
use search::Nearest;

/// Nearest-neighbour statistics of every realization.
///
/// # Errors
/// `Error::Cancelled`.
pub fn neighbor_sums(plan: &NeighborPlan, ensemble: &Ensemble, control: &Control) -> Result<NeighborSums> {
    let [from, to] = sides(plan, ensemble);
    let within = plan.classes.is_none_or(|[a, b]| a == b);
    let part = 1.0 / ensemble.realizations() as f64;
    let add = |mut sums: NeighborSums, k: usize| {
        control.check()?;
        let (axes, others) = (from.lengths(k), to.lengths(k));
        let n = axes[0].len() as u64;
        // The triangulation runs on one thread, the search on all that are left.
        let (bonds, nearest) = rayon::join(
            || bonds(plan, &axes, control),
            || Nearest::find(plan, (!within).then_some(&axes), &others, part, control),
        );
        let nearest = nearest?;
        let one = RealizationNeighbors {
            index: ensemble.first_index() + k as u64,
            n,
            distances: distances(&nearest.of_points, &plan.domain),
            bonds: bonds?,
        };
        let place = |i: usize| std::array::from_fn(|a| axes.get(a).map_or(0, |axis| axis[i]));
        let g = distribution(plan, &nearest.of_points, place);
        let f = distribution(plan, &nearest.of_probes, |i| plan.probes.position(i));
        sums.add(one, &g, &f);
        Ok(sums)
    };
    // Integers, and records that stay in order: how the realizations are dealt out is not seen.
    (0..ensemble.realizations()).into_par_iter().try_fold(NeighborSums::default, add).try_reduce(
        NeighborSums::default,
        |mut a, b| {
            a.merge(&b)?;
            Ok(a)
        },
    )
}

/// The points from which distances are taken, and those to which.
pub(in crate::compute) fn sides<'a>(plan: &NeighborPlan, ensemble: &'a Ensemble) -> [Cow<'a, Ensemble>; 2] {
    match plan.classes {
        Some(classes) => classes.map(|class| Cow::Owned(ensemble.of_classes(&[class]))),
        None => [Cow::Borrowed(ensemble), Cow::Borrowed(ensemble)],
    }
}

/// Per point of realization `k`, the index of the nearest other point (minimum image on a torus); `None` for a lone point. Of
/// several at the same distance the one with the lowest index, unless points coincide.
///
/// # Errors
/// `Error::Cancelled`.
pub fn nearest_neighbors(ensemble: &Ensemble, k: usize, control: &Control) -> Result<Vec<Option<usize>>> {
    search::partners(ensemble.domain(), &ensemble.lengths(k), control)
}

fn bonds(plan: &NeighborPlan, axes: &[&[u64]], control: &Control) -> Result<std::result::Result<Bonds, NoBonds>> {
    if plan.bonds { bonds::bonds(axes, &plan.domain, control) } else { Ok(Err(NoBonds::NotAskedFor)) }
}

/// Minimum and mean of the squared distances, which come in one order, whatever threads found them.
fn distances(squares: &[u128], domain: &Domain) -> Option<Distances> {
    let n = squares.len() as f64;
    let step = domain.length_unit() / 2f64.powi(64);
    let minimum = *squares.iter().min().filter(|square| **square < u128::MAX)?;
    Some(Distances {
        minimum: (minimum as f64).sqrt() * step,
        mean: squares.iter().map(|&square| (square as f64).sqrt()).sum::<f64>() / n * step,
        closest_packing: domain.closest_packing_distance(n),
    })
}

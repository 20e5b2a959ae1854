//! Envelopes: the same measurement on complete spatial randomness, or on simulations given, many times.

use std::sync::Arc;

use rayon::prelude::*;
use xxhash_rust::xxh3::{Xxh3Default, xxh3_64_with_seed};

use super::Measurement;
use crate::compute::Device;
use crate::control::{Control, Progress};
use crate::error::{Error, Result};
use crate::estimate::{Analysis, Curve, Envelope, Envelopes};
use crate::points::{Domain, Ensemble, EnsembleShape, RawPoints};
use crate::samplers::Process;
use crate::source::Points;
use crate::statistics::ROOMS;

/// Every estimated function that has an envelope.
fn curves(found: &Analysis) -> Vec<Curve> {
    ROOMS.iter().flat_map(|room| room.curves(found)).collect()
}

/// Simulates what was measured: independent uniform points in the same domain, as many in each realization. A bandwidth
/// found by cross-validation is found anew, so that all curves are treated alike. Simulations are drawn by sampler `random`, with
/// seeds that depend on the data and on the seed asked for: the same run repeats them, and over many data sets a test has the
/// size that it says.
pub(super) async fn envelopes(
    observed: &Measurement,
    found: &Analysis,
    device: &Device,
    control: &Control,
    progress: &mut dyn FnMut(Progress),
) -> Result<Envelopes> {
    let simulations = observed.plan.simulations;
    let (plan, domain) = (observed.plan.of_simulations(), observed.source.domain());
    let sizes: Arc<[u64]> = observed.sizes.values().collect();
    let observed_curves = curves(found);
    let mut simulated = vec![Vec::new(); observed_curves.len()];
    let drawn_for = data_digest(observed);
    for s in 0..simulations {
        let planned = observed.planned();
        let piece = observed.plan.simulated_seconds() / planned / simulations as f64;
        control.begin();
        let before = 1.0 - piece * (simulations - s) as f64;
        progress(Progress { stage: "envelope", done: s, total: simulations, before, piece, planned, known: None });
        let (of, n) = (domain.clone(), sizes.clone());
        let random = move |range: std::ops::Range<u64>| {
            csr(
                &of,
                xxh3_64_with_seed(&s.to_le_bytes(), drawn_for),
                range.start,
                &n[range.start as usize..range.end as usize],
            )
        };
        let k = sizes.len() as u64;
        let (points, quiet) = (observed.source.clone(), Control::default());
        let given = move |range: std::ops::Range<u64>| {
            let simulations = points.simulations().ok_or_else(|| Error::input("simulations", "there are none"))?;
            Ok(simulations.batch(s * k + range.start..s * k + range.end, &quiet)?.numbered_from(range.start))
        };
        let source = match observed.source.simulations() {
            Some(simulations) => {
                let shape = EnsembleShape { realizations: k, ..simulations.shape() };
                Points::drawn("simulation", domain.clone(), shape, Box::new(given))
            }
            None => Points::drawn("simulation", domain.clone(), observed.shape(), Box::new(random)),
        };
        let mut simulation = Measurement::new(observed.request.clone(), Arc::new(source), plan.clone());
        while simulation.advance(device, control, &mut |_| ()).await? {}
        let curves = simulation.estimates(control)?.map_or(Vec::new(), |found| curves(&found));
        simulated.iter_mut().zip(curves).for_each(|(all, curve)| all.push(curve.values));
    }
    let curves = observed_curves.into_iter().zip(simulated).map(|(curve, all)| Envelope::new(curve, &all)).collect();
    let given = observed.source.simulations().map(|simulations| simulations.subject().to_string());
    Ok(Envelopes { simulations, given, curves })
}

/// What simulations are drawn for: the first realization, and the seed asked for.
fn data_digest(observed: &Measurement) -> u64 {
    let mut hash = Xxh3Default::new();
    hash.update(&observed.request.input.seed.unwrap_or(1).to_le_bytes());
    if let Some(first) = &observed.first {
        for axis in 0..first.domain().dim() {
            first.all_lengths(axis).iter().for_each(|x| hash.update(&x.to_le_bytes()));
        }
    }
    hash.digest()
}

/// Realizations `first..` of complete spatial randomness, of the given sizes.
fn csr(domain: &Domain, seed: u64, first: u64, sizes: &[u64]) -> Result<Ensemble> {
    let dim = domain.dim();
    let one = |(index, &n): (u64, &u64)| {
        // Of a polygon those of the box that are inside, the first n of as many as it takes.
        let mut drawn = n;
        let coordinates = loop {
            let mut coordinates = match drawn {
                0 => Vec::new(),
                _ => Process::new("random", drawn, 1, dim, seed, &[])?.coordinates(index, &Control::default())?,
            };
            for point in coordinates.chunks_exact_mut(dim) {
                for ((x, origin), side) in point.iter_mut().zip(domain.origin()).zip(domain.sides()) {
                    *x = origin + *x * side;
                }
            }
            let Some(polygon) = domain.as_polygon() else { break coordinates };
            let inside = coordinates.as_chunks::<2>().0.iter().filter(|point| polygon.contains_point(**point));
            let inside: Vec<f64> = inside.take(n as usize).flatten().copied().collect();
            if inside.len() as u64 == 2 * n {
                break inside;
            }
            let share = domain.measure() / domain.sides().iter().product::<f64>();
            drawn = (2 * drawn).max((1.1 * n as f64 / share) as u64 + 16);
        };
        Ok(RawPoints { dim, coordinates, source: "simulation".into(), lines: Vec::new() })
    };
    let sets: Vec<_> = (first..first + sizes.len() as u64).zip(sizes).collect();
    let raw = sets.into_par_iter().map(one).collect::<Result<Vec<_>>>()?;
    // Rounding may put a point on the far side of a torus.
    Ensemble::from_raw(&raw, domain, domain.is_torus(), first)
}

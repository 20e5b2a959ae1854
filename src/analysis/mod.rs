//! A request, carried out: points -> plan -> compute -> accumulate -> estimate, in batches. The command line and the
//! viewer both call this and hold no arithmetic of their own.

mod classes;
mod envelope;
mod measure;
mod plan;
mod progress;
mod running;
mod sums;

use envelope::envelopes;
use measure::{Input, Measured, measure};
pub use plan::Plan;
use plan::{check_convention, check_points};
pub use running::{Running, Status, TrackStatus};

use crate::accumulate::LagCounts;
use crate::compute::{Compute, WithFallback};
use crate::control::{Clock, Control, Instant, Progress};
use crate::error::Result;
use crate::estimate::{
    AmplitudeCovariance, CrossCorrelation, Findings, KFunction, KernelEstimate, Neighbors, Normalization,
    PairCorrelation, PowerSpectrum, PsaStatistics, RadialSpectrum, SpectrumDetails, VectorCorrelation,
};
pub use crate::estimate::{Analysis, ClosedForm, Envelopes};
use crate::plan::{Convention, Correction, Debias, LagPlan, MAX_FREQUENCY, Taper, TaperPlan};
use crate::request::Request;
use crate::source::Source;

/// The estimates that envelopes are made of.
struct Estimates {
    pair_correlation: Option<PairCorrelation>,
    k_function: Option<KFunction>,
    kernel: Option<KernelEstimate>,
    neighbors: Option<Neighbors>,
}

impl Estimates {
    fn new(measured: &Measured<'_>, normalization: Normalization) -> Self {
        let Measured { sums, plan, cross_validation, .. } = measured;
        let pairs = plan.pairs.as_ref().zip(sums.pairs.as_ref());
        let kernel = plan.kernel.as_ref().zip(sums.kernel.as_ref());
        Self {
            pair_correlation: pairs.filter(|_| plan.pcf).map(|(pairs, sums)| {
                let g = PairCorrelation::new(pairs, sums, normalization);
                if plan.psa_bins { g.as_psa(pairs, plan.bug_compatible) } else { g }
            }),
            k_function: pairs
                .and_then(|(plan, sums)| KFunction::new(plan, sums, normalization, measured.shape().mean_points)),
            kernel: kernel.map(|(plan, sums)| KernelEstimate {
                cross_validation: *cross_validation,
                ..KernelEstimate::new(plan, sums, normalization)
            }),
            neighbors: plan
                .neighbors
                .as_ref()
                .zip(sums.neighbors.as_ref())
                .map(|(plan, sums)| Neighbors::new(plan, sums, measured.shape())),
        }
    }
}

/// Carries out a request on points and a device.
pub fn run(
    request: &Request,
    source: &Source,
    plan: &Plan,
    compute: &dyn Compute,
    control: &Control,
    progress: &mut dyn FnMut(Progress),
) -> Result<Analysis> {
    let mut device = WithFallback::new(compute, request.threads)?;
    let mut clock = Clock::default();
    let total = source.shape().realizations;
    let input = Input {
        subject: source.subject(),
        realizations: total,
        batch: &|range| source.batch(range, control),
        normalization: request.normalization,
    };
    let mut tell = |stage, done| progress(Progress { stage, done, total });
    let measured = measure(plan, &input, &mut device, control, &mut clock, &mut tell)?;
    // A sampler that draws n is only now known to have drawn enough.
    let shape = measured.shape();
    check_points(plan.pairs.is_some() || plan.lags.is_some() || plan.neighbors.is_some(), shape)?;
    check_convention(request, source.domain(), shape)?;
    progress(Progress { stage: "estimates", done: total, total });
    let estimates = clock.time("estimates", || Estimates::new(&measured, request.normalization));
    let envelopes = (plan.simulations > 0)
        .then(|| {
            let start = Instant::now();
            let done = envelopes(&measured, &estimates, request.normalization, &mut device, control, progress);
            clock.add("envelope", start.elapsed().as_secs_f64());
            done
        })
        .transpose()?;
    let found = Found { estimates, envelopes, warnings: device.into_warnings(), clock };
    Ok(analysis(request, source, measured, found))
}

/// What was found besides the sums.
struct Found {
    estimates: Estimates,
    envelopes: Option<Envelopes>,
    warnings: Vec<String>,
    clock: Clock,
}

/// Everything, of what was measured so far.
fn analysis(request: &Request, source: &Source, measured: Measured<'_>, found: Found) -> Analysis {
    let shape = measured.shape();
    let Found { estimates, envelopes, mut warnings, mut clock } = found;
    let Measured { sums, plan, sizes, duplicates, first, .. } = measured;
    let Estimates { pair_correlation, k_function, kernel, neighbors } = estimates;
    if duplicates > 0 {
        warnings.push(format!("{duplicates} points coincide with another point of their realization"));
    }
    let empty = sums.pairs.as_ref().map_or(0, |p| p.counts.iter().filter(|&&c| c == 0).count());
    if empty > 0 && shape.realizations >= 2 && plan.pcf {
        warnings.push(format!(
            "no realization has a pair in {empty} of {} bins: g = 0 there, and its standard error across realizations is 0",
            plan.pairs.as_ref().map_or(0, |p| p.bins.len())
        ));
    }
    let unseen = sums.pairs.as_ref().map_or(0, |p| p.bins.norms.iter().filter(|n| n[0].sum == 0).count());
    if unseen > 0 && unseen < sums.pairs.as_ref().map_or(0, |p| p.counts.len()) {
        warnings.push(format!("no point is far enough from the border for {unseen} of the bins: they are left empty"));
    }
    if plan.pairs.as_ref().is_some_and(|p| p.masses) && (plan.neighbors.is_some() || plan.lags.is_some()) {
        let warning =
            "weights of points enter g(r), K and P only: g of the vector and neighbours take every point alike";
        warnings.push(warning.to_string());
    }
    if plan.pairs.as_ref().is_some_and(|p| p.masses) && shape.realizations == 1 {
        let warning = "errors for a single realization take the pairs of a bin as of equal weight: with very unequal weights of \
                       points they are too small";
        warnings.push(warning.to_string());
    }
    let of_pairs = plan.pairs.as_ref().map(|p| p.correction);
    if let (Some(of_pairs), Some(lags)) = (of_pairs, plan.lags.as_ref())
        && of_pairs != lags.correction
    {
        warnings.push(format!("{of_pairs} correction is for g(r); g of the vector has {}", lags.correction));
    }
    if let Some(lags) = plan.lags.as_ref().filter(|_| request.lag_max.is_none() && request.lag_bins.is_none()) {
        warnings.extend(lags.coarse(shape.mean_points));
    }
    let default_grid = request.max_frequency.is_none() && request.convention == Convention::Ours;
    if let Some(grid) = plan.waves.as_ref().filter(|_| default_grid).and_then(|w| w.waves.grid()) {
        let reach = grid.max_frequency()[0];
        let wanted = 5.0 * shape.mean_points.powf(1.0 / grid.dim() as f64);
        if source.domain().is_cubic() && f64::from(reach) < 0.9 * wanted {
            let why = match reach {
                MAX_FREQUENCY => "the largest there is",
                _ => "to bound its memory; --max-frequency asks for more",
            };
            warnings.push(format!("P reaches |m| = {reach} only, {why}"));
        }
    }
    if plan.waves.as_ref().and_then(|w| w.taper).is_some_and(|t| t.taper == Taper::Bartlett) {
        let warning =
            "P in a window has Bartlett's taper: large P leaks into frequencies around it; --taper sine leaks less";
        warnings.push(warning.to_string());
    }
    let unremoved = |t: TaperPlan| t.debias == Debias::None;
    if plan.waves.as_ref().is_some_and(|w| w.tapered().is_some() && w.taper.is_some_and(unremoved)) {
        let warning = "--debias none leaves the transform of the window in P: at low frequencies it grows with n";
        warnings.push(warning.to_string());
    }
    if plan.covariance.is_some() && shape.realizations == 1 {
        let warning = "the covariance of amplitudes is an expectation over realizations: a single one shows s_m conj(s_l), which is \
                       not 0 for any process; -k or more files give an estimate with errors";
        warnings.push(warning.to_string());
    }
    let empty = kernel.as_ref().map_or(0, |k| k.r.iter().zip(&k.g).filter(|(r, g)| **r > 0.0 && g.is_none()).count());
    if empty > 0 {
        warnings.push(format!(
            "the kernel reaches past the longest distance the domain allows at {empty} of the bins: g_kernel is left empty \
             there; a smaller --bandwidth or --r-max avoids it"
        ));
    }
    if let Some(coincident) = sums.kernel.as_ref().map(|k| k.coincident).filter(|&c| c > 0) {
        warnings.push(format!(
            "{coincident} ordered pairs at distance 0 are left out of g_kernel: divisor d would divide by 0"
        ));
    }
    if let Some(found) = kernel.as_ref().and_then(|k| k.cross_validation).filter(|f| f.at_end) {
        let ([lo, hi], b) = (found.range, found.bandwidth);
        warnings.push(format!(
            "cross-validation found no least score within bandwidths from {lo:.4e} to {hi:.4e}: {b:.4e} is the end of that range"
        ));
    }
    let start = Instant::now();
    let cross = plan.classes.as_ref().zip(sums.cross.as_ref()).map(|(classes, sums)| {
        CrossCorrelation::new(classes.names.clone(), &classes.pairs, sums, request.normalization)
    });
    let vector_of = |plan: &Option<LagPlan>, sums: &Option<LagCounts>| {
        Some(VectorCorrelation::new(plan.as_ref()?, sums.as_ref()?, request.normalization))
    };
    let rings = vector_of(&plan.rings, &sums.rings).map_or(Vec::new(), |rings| rings.sectors);
    let vector = vector_of(&plan.lags, &sums.lags).map(|v| VectorCorrelation { sectors: rings, ..v });
    let spectrum = plan.waves.as_ref().zip(sums.waves.as_ref()).map(|(plan, sums)| PowerSpectrum::new(plan, sums));
    let radial = match (&plan.waves, &sums.waves, &spectrum) {
        (Some(plan), Some(sums), Some(spectrum)) if request.frequencies.is_none() => {
            Some(RadialSpectrum::new(plan, sums, spectrum))
        }
        _ => None,
    };
    let details = match (&plan.waves, &sums.waves, &spectrum, &radial) {
        (Some(plan), Some(sums), Some(spectrum), Some(radial)) if request.convention == Convention::Ours => {
            // Lag counts take every point alike.
            let vector = vector.as_ref().filter(|_| request.input.weight_column.is_none());
            Some(SpectrumDetails::new(plan, sums, spectrum, radial, pair_correlation.as_ref(), vector))
        }
        _ => None,
    };
    let covariance = plan.covariance.as_ref().zip(sums.covariance.as_ref());
    let covariance = covariance.map(|(plan, sums)| AmplitudeCovariance::new(plan, sums));
    let psa = PsaStatistics::new(shape.max_points, &sums.psa);
    if request.convention == Convention::Psa && plan.waves.is_some() && psa.is_none() {
        let why = if shape.max_points < 2 { "they need pairs of points" } else { "too many sets or points" };
        warnings.push(format!("effective Nyquist frequency and oscillation by PSA's route are left out: {why}"));
    }
    let closed_form = match request.convention {
        Convention::Ours => closed_form(source, &plan, request.normalization, pair_correlation.as_ref()),
        // Closed forms are at the centres of our bins and rings.
        _ => ClosedForm::default(),
    };
    clock.add("estimates", start.elapsed().as_secs_f64());
    let mut findings = Findings::default();
    findings.add(pair_correlation);
    findings.add(cross);
    findings.add(k_function);
    findings.add(kernel);
    findings.add(envelopes);
    findings.add(vector);
    findings.add(spectrum);
    findings.add(radial);
    findings.add(details);
    findings.add(covariance);
    findings.add(psa);
    findings.add(neighbors);
    Analysis {
        parameters: request.parameters(),
        min_points: sizes.iter().copied().min().unwrap_or(0),
        correction: plan.pairs.as_ref().map_or(Correction::None, |p| p.correction),
        grid_wanted: plan.grid_wanted,
        convention: request.convention,
        bug_compatible: request.bug_compatible,
        closed_form,
        accuracy: request.accuracy,
        plan: plan.to_string(),
        timings: clock.stages,
        duplicates,
        warnings,
        findings,
        ..Analysis::new(source.subject(), shape, first, sums.computed_by())
    }
}

/// What theory says about the source, on a cubic torus.
fn closed_form(source: &Source, plan: &Plan, normalization: Normalization, g: Option<&PairCorrelation>) -> ClosedForm {
    let Some(process) = source.process().filter(|_| source.domain().is_cubic()) else { return ClosedForm::default() };
    let side = source.domain().shortest_side();
    let n = process.n as f64;
    // What turns n(n-1) into n^2 is a number only where n is one.
    let factor = match normalization {
        Normalization::Pairs => Some(1.0),
        Normalization::Intensity => process.sampler.fixed_n().then_some((n - 1.0) / n),
    };
    let g = g.and_then(|g| g.r.iter().map(|r| Some(process.pair_correlation(r / side)? * factor?)).collect());
    let radial = plan.waves.as_ref().and_then(|plan| {
        let mut sums = vec![0.0; plan.rings.count];
        for (index, &ring) in plan.rings.ring_of.iter().enumerate().filter(|(_, ring)| **ring > 0) {
            let times = f64::from(plan.rings.times[index]);
            sums[ring as usize - 1] += times * process.power(plan.waves.vector(index).map(|m| m as i32))?;
        }
        Some(sums.iter().zip(&plan.rings.modes).map(|(sum, &modes)| sum / modes as f64).collect())
    });
    ClosedForm { name: process.sampler.name().to_string(), g, radial }
}

//! `summary.json`: everything but the arrays. Keys keep the order of the structs below; what is undefined is `null`.

use serde::{Serialize, Serializer};

use crate::analysis::Analysis;
use crate::compute::Backend;
use crate::estimate::{ErrorSource, Kernel, Normalization};
use crate::plan::{Correction, PowerBound};
use crate::points::Domain;

/// Raised when a key changes its meaning or goes away; new keys do not raise it.
pub(super) const SCHEMA: u32 = 1;

#[derive(Serialize)]
struct Summary<'a> {
    schema: u32,
    program: &'static str,
    version: &'static str,
    subject: &'a str,
    #[serde(serialize_with = "in_order")]
    parameters: Vec<(String, String)>,
    n: Points,
    k: u64,
    d: usize,
    domain: DomainOut<'a>,
    plan: &'a str,
    device: String,
    backends: &'a [Backend],
    accuracy: Option<AccuracyOut>,
    pair_correlation: Option<PairCorrelationOut>,
    cross_correlation: Option<CrossOut<'a>>,
    k_function: Option<KFunctionOut>,
    spectrum: Option<SpectrumOut>,
    radial: Option<RadialOut>,
    neighbors: Option<Neighbors>,
    duplicates: u64,
    closed_form: Option<&'a str>,
    warnings: &'a [String],
    files: Vec<&'static str>,
    #[serde(serialize_with = "in_order")]
    timings_seconds: Vec<(String, f64)>,
}

#[derive(Serialize)]
struct Points {
    min: u64,
    mean: f64,
    max: u64,
}

#[derive(Serialize)]
struct DomainOut<'a> {
    #[serde(flatten)]
    domain: &'a Domain,
    measure: f64,
    /// For the mean number of points, in length units.
    closest_packing_distance: f64,
}

#[derive(Serialize)]
struct AccuracyOut {
    name: &'static str,
    power_bound: PowerBound,
}

#[derive(Serialize)]
struct PairCorrelationOut {
    bins: usize,
    r_max: Option<f64>,
    normalization: Normalization,
    correction: Correction,
    errors: ErrorSource,
    kernel: Option<KernelOut>,
}

#[derive(Serialize)]
struct CrossOut<'a> {
    /// a and b of `pcf_cross.csv`.
    classes: &'a [String; 2],
    correction: Correction,
    errors: ErrorSource,
}

#[derive(Serialize)]
struct KFunctionOut {
    bins: usize,
    r_max: Option<f64>,
    normalization: Normalization,
    correction: Correction,
    errors: ErrorSource,
}

#[derive(Serialize)]
struct KernelOut {
    #[serde(flatten)]
    kernel: Kernel,
    errors: &'static str,
}

#[derive(Serialize)]
struct SpectrumOut {
    max_frequency: Vec<u32>,
    modes: usize,
    errors: ErrorSource,
    dc_p: f64,
    dc_p_se: f64,
}

#[derive(Serialize)]
struct RadialOut {
    rings: usize,
    errors: ErrorSource,
    anisotropy_reference_db: f64,
}

#[derive(Serialize)]
struct Neighbors {
    minimum: Option<f64>,
    mean: Option<f64>,
    mean_se: Option<f64>,
    minimum_relative: Option<f64>,
    mean_relative: Option<f64>,
}

/// An object whose keys keep the order of the list.
fn in_order<V: Serialize, S: Serializer>(pairs: &[(String, V)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(k, v)| (k, v)))
}

/// Keys once each: JSON leaves the meaning of a repeated key open, so values of one name are joined.
fn joined(parameters: &[(String, String)]) -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = Vec::with_capacity(parameters.len());
    for (name, value) in parameters {
        match out.iter_mut().find(|(n, _)| n == name) {
            Some((_, values)) => *values = format!("{values}; {value}"),
            None => out.push((name.clone(), value.clone())),
        }
    }
    out
}

/// Stages once each, their times added.
fn added(timings: &[(&'static str, f64)]) -> Vec<(String, f64)> {
    let mut out: Vec<(String, f64)> = Vec::with_capacity(timings.len());
    for (stage, seconds) in timings {
        match out.iter_mut().find(|(s, _)| s == stage) {
            Some((_, sum)) => *sum += seconds,
            None => out.push(((*stage).into(), *seconds)),
        }
    }
    out
}

/// The file's bytes. serde_json writes floats as the shortest decimal that reads back the same, and NaN as null.
pub(super) fn json(analysis: &Analysis, files: Vec<&'static str>) -> serde_json::Result<Vec<u8>> {
    let a = analysis;
    let summary = Summary {
        schema: SCHEMA,
        program: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        subject: &a.subject,
        parameters: joined(&a.parameters),
        n: Points { min: a.min_points, mean: a.shape.mean_points, max: a.shape.max_points },
        k: a.shape.realizations,
        d: a.domain.dim(),
        domain: DomainOut {
            domain: &a.domain,
            measure: a.domain.measure(),
            closest_packing_distance: a.domain.closest_packing_distance(a.shape.mean_points),
        },
        plan: &a.plan,
        device: a.computed_by.device(),
        backends: &a.computed_by.backends,
        // Pair counts are exact at either setting, so without a spectrum there is nothing to bound.
        accuracy: a
            .spectrum
            .as_ref()
            .map(|_| AccuracyOut { name: a.accuracy.name(), power_bound: a.accuracy.power_bound() }),
        pair_correlation: a.pair_correlation.as_ref().map(|g| PairCorrelationOut {
            bins: g.g.len(),
            r_max: g.r_hi.last().copied(),
            normalization: g.normalization,
            correction: a.correction,
            errors: g.errors,
            kernel: a.kernel.as_ref().map(|k| KernelOut { kernel: k.kernel, errors: "poisson-pairs" }),
        }),
        cross_correlation: a.cross.as_ref().map(|c| CrossOut {
            classes: &c.classes,
            correction: a.correction,
            errors: c.between.errors,
        }),
        k_function: a.k_function.as_ref().map(|k| KFunctionOut {
            bins: k.r.len(),
            r_max: k.r.last().copied(),
            normalization: k.normalization,
            correction: a.correction,
            errors: k.errors,
        }),
        spectrum: a.spectrum.as_ref().map(|s| SpectrumOut {
            max_frequency: s.grid.max_frequency()[..s.grid.dim()].to_vec(),
            modes: s.grid.full_len(),
            errors: s.errors,
            dc_p: s.dc().0,
            dc_p_se: s.dc().1,
        }),
        radial: a.radial.as_ref().map(|r| RadialOut {
            rings: r.rings.len(),
            errors: r.errors,
            // -10 log10 1 is -0.
            anisotropy_reference_db: r.anisotropy_reference_db + 0.0,
        }),
        neighbors: a.neighbors.as_ref().map(|n| Neighbors {
            minimum: n.minimum,
            mean: n.mean,
            mean_se: n.mean_se,
            minimum_relative: n.minimum_relative,
            mean_relative: n.mean_relative,
        }),
        duplicates: a.duplicates,
        closed_form: (!a.closed_form.name.is_empty()).then_some(a.closed_form.name.as_str()),
        warnings: &a.warnings,
        files,
        timings_seconds: added(&a.timings),
    };
    let mut bytes = serde_json::to_vec_pretty(&summary)?;
    bytes.push(b'\n');
    Ok(bytes)
}

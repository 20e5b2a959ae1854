//! `summary.json`: everything but the arrays. Keys keep the order of the structs below; what is undefined is `null`.

use serde::{Serialize, Serializer};

use super::spectrum_numbers::{BandsOut, ConsistencyOut, ScalarsOut};
use crate::compute::Backend;
use crate::display;
use crate::estimate::{
    Analysis, BondOrder, CovarianceScalars, CrossValidation, ErrorSource, NeighborDistances, Normalization,
    PsaStatistics,
};
use crate::plan::{
    Convention, Correction, Divisor, Kernel, KernelRoad, PowerBound, RING_DIRECTIONS_RULE, WaveGrid, WaveVectors,
};
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
    envelope: Option<EnvelopesOut>,
    vector_correlation: Option<VectorOut>,
    spectrum: Option<SpectrumOut>,
    radial: Option<RadialOut>,
    spectrum_scalars: Option<ScalarsOut>,
    consistency: Option<ConsistencyOut>,
    covariance: Option<CovarianceOut>,
    convention: Option<ConventionOut>,
    neighbors: Option<NeighborsOut>,
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
struct VectorOut {
    bins: Vec<usize>,
    /// Lags are in [-H, H) per axis, in length units.
    half_widths: Vec<f64>,
    ordered_pairs: u64,
    normalization: Normalization,
    correction: Correction,
    errors: ErrorSource,
    rings: Vec<f64>,
    /// g at the ends of the colours of the picture, which are symmetric about 1; beyond them it is clipped.
    picture_range: Option<[f64; 2]>,
    /// The part of cells within the range, unless that would exceed [0, 2].
    picture_quantile: Option<f64>,
}

#[derive(Serialize)]
struct KernelOut {
    #[serde(flatten)]
    kernel: Kernel,
    divisor: Divisor,
    road: KernelRoad,
    /// On the difference of any g from the direct sum.
    bound: f64,
    errors: ErrorSource,
    cross_validation: Option<CrossValidation>,
}

#[derive(Serialize)]
struct EnvelopesOut {
    simulations: u64,
    /// The probability that independent points leave the pointwise envelope at one r.
    pointwise_significance: f64,
    curves: Vec<EnvelopeOut>,
}

#[derive(Serialize)]
struct EnvelopeOut {
    curve: &'static str,
    /// Level of the global envelope.
    alpha: f64,
    p: f64,
    p_interval: [f64; 2],
}

#[derive(Serialize)]
struct SpectrumOut {
    /// Of a grid; a list has none.
    max_frequency: Option<Vec<u32>>,
    modes: usize,
    errors: ErrorSource,
    dc_p: Option<f64>,
    dc_p_se: Option<f64>,
}

#[derive(Serialize)]
struct RadialOut {
    rings: usize,
    /// Wave vectors of all rings, opposite ones counted both.
    modes: u64,
    /// Which wave vectors of a ring were taken.
    directions: &'static str,
    errors: ErrorSource,
    anisotropy_reference_db: f64,
    bands: BandsOut,
}

#[derive(Serialize)]
struct CovarianceOut {
    /// B: all |m_k| and |l_k| up to it.
    max_frequency: u32,
    /// Rows and columns.
    modes: usize,
    /// Their order in rows and columns.
    order: &'static str,
    #[serde(flatten)]
    scalars: CovarianceScalars,
}

/// Whose numbers these are, where not ours.
#[derive(Serialize)]
struct ConventionOut {
    name: Convention,
    bug_compatible: bool,
    /// What `nu_lo`, `nu` and `nu_hi` are.
    spectrum_radial: &'static str,
    /// What `r` of `pcf.csv` is.
    pcf: &'static str,
    /// By PSA's own route through the pair counts.
    #[serde(flatten)]
    psa: Option<PsaStatistics>,
}

#[derive(Serialize)]
struct NeighborsOut {
    #[serde(flatten)]
    distances: NeighborDistances,
    functions: FunctionsOut,
    psi_6: Option<BondOrder>,
    psi_6_undefined: Option<&'static str>,
}

#[derive(Serialize)]
struct FunctionsOut {
    distances: usize,
    errors: ErrorSource,
    test_points: u64,
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
            .spectrum()
            .map(|_| AccuracyOut { name: a.accuracy.name(), power_bound: a.accuracy.power_bound() }),
        pair_correlation: a.pair_correlation().map(|g| PairCorrelationOut {
            bins: g.g.len(),
            r_max: g.r_hi.last().copied(),
            normalization: g.normalization,
            correction: a.correction,
            errors: g.errors,
            kernel: a.kernel().map(|k| KernelOut {
                kernel: k.kernel,
                divisor: k.divisor,
                road: k.road,
                bound: k.bound,
                errors: k.errors,
                cross_validation: k.cross_validation,
            }),
        }),
        envelope: a.envelopes().map(|e| EnvelopesOut {
            simulations: e.simulations,
            pointwise_significance: e.pointwise_significance(),
            curves: e
                .curves
                .iter()
                .map(|c| EnvelopeOut { curve: c.observed.name, alpha: c.alpha, p: c.p, p_interval: c.p_interval })
                .collect(),
        }),
        cross_correlation: a.cross().map(|c| CrossOut {
            classes: &c.classes,
            correction: a.correction,
            errors: c.between.errors,
        }),
        k_function: a.k_function().map(|k| KFunctionOut {
            bins: k.r.len(),
            r_max: k.r.last().copied(),
            normalization: k.normalization,
            correction: a.correction,
            errors: k.errors,
        }),
        vector_correlation: a.vector().map(|v| VectorOut {
            bins: vec![v.grid.bins; v.grid.dim()],
            half_widths: v.grid.half.clone(),
            ordered_pairs: v.count.iter().sum(),
            normalization: v.normalization,
            correction: v.correction,
            errors: v.errors,
            rings: v.sectors.chunk_by(|a, b| a.r == b.r).map(|ring| ring[0].r[1]).collect(),
            picture_range: (v.grid.dim() > 1).then(|| display::range(v)),
            picture_quantile: (v.grid.dim() > 1).then_some(display::QUANTILE),
        }),
        spectrum: a.spectrum().map(|s| SpectrumOut {
            max_frequency: s.waves.grid().map(|grid| grid.max_frequency()[..grid.dim()].to_vec()),
            modes: s.waves.grid().map_or(s.waves.len(), WaveGrid::full_len),
            errors: s.errors,
            dc_p: s.dc().map(|dc| dc.0),
            dc_p_se: s.dc().map(|dc| dc.1),
        }),
        radial: a.radial().map(|r| RadialOut {
            rings: r.rings.len(),
            modes: r.rings.iter().map(|ring| ring.modes).sum(),
            directions: match a.spectrum().map(|s| &s.waves) {
                Some(WaveVectors::List(_)) => RING_DIRECTIONS_RULE,
                _ => "all",
            },
            errors: r.errors,
            anisotropy_reference_db: r.anisotropy_reference_db,
            bands: BandsOut::new(r),
        }),
        spectrum_scalars: a.details().map(ScalarsOut::new),
        consistency: a.details().and_then(ConsistencyOut::new),
        covariance: a.covariance().map(|c| CovarianceOut {
            max_frequency: c.grid.max_frequency()[0],
            modes: c.modes(),
            order: "m_x slowest, each m_k from -B to B; m = 0 in the middle, left out of covariance.png and of the numbers here",
            scalars: c.scalars,
        }),
        convention: (a.convention != Convention::Ours).then(|| ConventionOut {
            name: a.convention,
            bug_compatible: a.bug_compatible,
            spectrum_radial: a.convention.labels(),
            pcf: a.convention.pair_labels(),
            psa: a.psa().copied(),
        }),
        neighbors: a.neighbors().map(|n| NeighborsOut {
            distances: n.distances,
            functions: FunctionsOut {
                distances: n.functions.r.len(),
                errors: n.functions.errors,
                test_points: n.functions.probes,
            },
            psi_6: n.bonds.ok(),
            psi_6_undefined: n.bonds.err(),
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

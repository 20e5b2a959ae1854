//! Where the points come from: memory, files, or a sampler, drawn batch by batch.

use std::collections::HashMap;
use std::ops::Range;

use serde_json::{Value, json};
use xxhash_rust::xxh3::Xxh3Default;

use crate::control::Control;
use crate::error::{Error, Result, number, numbers};
use crate::plan::EnsembleShape;
use crate::points::read::{Columns, MarkedPoints, ReadOptions, read_marked};
use crate::points::{Boundary, Domain, Ensemble};
use crate::request::{PointsRequest, refuse_settings_of_samplers};
use crate::samplers::{self, Process};
use crate::setting::Setting;

/// The points of one request.
pub struct Source {
    subject: String,
    domain: Domain,
    shape: EnsembleShape,
    /// What makes these points the ones they are: equal ones are of equal points, realization by realization.
    identity: Value,
    classes: Vec<String>,
    /// The first weight below 0, and where it stands.
    negative_weight: Option<(String, f64)>,
    kind: Kind,
}

enum Kind {
    Held(Ensemble),
    Process(Process),
    Drawn(Box<Draw>),
    /// Somewhere else: they were measured, and only that was kept.
    Elsewhere,
}

/// Realizations of a range.
type Draw = dyn Fn(Range<u64>) -> Result<Ensemble> + Send + Sync;

impl Source {
    /// Reads the files, or prepares the sampler; resolves the domain.
    pub fn open(request: &PointsRequest) -> Result<Self> {
        if let Some(name) = &request.sampler {
            let n = request
                .points
                .ok_or_else(|| Error::setting(Setting::Points, "(none)", "`sampler` needs `points` N"))?;
            let (k, dim) = (request.realizations.unwrap_or(1), request.dim.unwrap_or(2));
            let seed = request.seed.unwrap_or(1);
            let process = Process::new(name, n, k, dim, seed, &request.params)?;
            if request.domain == Some(Boundary::Window) {
                return Err(Error::setting(Setting::Domain, "window", "samplers fill a torus; a window needs files"));
            }
            let domain = domain(request, dim)?;
            return Ok(Self::sampled(process, domain));
        }
        refuse_settings_of_samplers(request)?;
        if let Some(window) = request.window.as_ref().filter(|w| w.len() % 2 == 1 || w.len() > 6) {
            return Err(Error::setting(
                Setting::Window,
                numbers(window.iter().copied()),
                "expected two numbers per axis, x0,x1,y0,y1[,z0,z1]",
            ));
        }
        if request.files.is_empty() {
            return Err(Error::setting(Setting::Files, "(none)", "expected point files, or `sampler` NAME `points` N"));
        }
        let columns = Columns::new(request.weight_column.as_deref(), request.class_column.as_deref())?;
        let options = ReadOptions { dim: dim_of_flags(request), raw: request.raw };
        let marked = read_marked(&request.files, &options, &columns)?;
        let first = marked.first().ok_or_else(|| Error::input("points", "the files hold no realizations"))?;
        let domain = domain(request, first.points.dim)?;
        let negative_weight = marked.iter().find_map(|set| {
            let j = set.weights.iter().position(|&w| w < 0.0)?;
            Some((set.points.place(j), set.weights[j]))
        });
        let (ensemble, classes) = ensemble(marked, &domain, request)?;
        let names: Vec<_> = request.files.iter().map(|f| f.display().to_string()).collect();
        let subject = match names.as_slice() {
            [one] => one.clone(),
            [one, ..] => format!("{one} and {} more", names.len() - 1),
            [] => String::new(),
        };
        Ok(Self { subject, negative_weight, classes, ..Self::of(ensemble) })
    }

    /// Points that are there already.
    pub fn of(ensemble: Ensemble) -> Self {
        Self {
            subject: "points in memory".into(),
            domain: ensemble.domain().clone(),
            shape: ensemble.shape(),
            identity: json!({ "points": digest(&ensemble) }),
            classes: Vec::new(),
            negative_weight: None,
            kind: Kind::Held(ensemble),
        }
    }

    /// Realizations of a process, stretched to a domain.
    pub fn sampled(process: Process, domain: Domain) -> Self {
        let Process { n, dim, seed, realizations, .. } = process;
        let name = process.sampler.name();
        // A drawn n rarely strays far from its mean; the budget of a batch is no sharper than that.
        let max_points = if process.sampler.fixed_n() { n } else { 2 * n + 16 };
        let parameters: Vec<String> = process.values.canonical().collect();
        Self {
            subject: format!("sampler {name}, n {n}, K {realizations}, seed {seed}"),
            domain,
            shape: EnsembleShape { realizations, mean_points: n as f64, max_points },
            identity: json!({ "sampler": name, "n": n, "dim": dim, "seed": seed, "parameters": parameters }),
            classes: Vec::new(),
            negative_weight: None,
            kind: Kind::Process(process),
        }
    }

    /// Realizations that are made when they are asked for.
    pub(crate) fn drawn(subject: &str, domain: Domain, shape: EnsembleShape, draw: Box<Draw>) -> Self {
        let (identity, kind) = (Value::Null, Kind::Drawn(draw));
        Self { subject: subject.into(), domain, shape, identity, classes: Vec::new(), negative_weight: None, kind }
    }

    /// What is known of points that are not here.
    pub(crate) fn elsewhere(
        subject: String,
        domain: Domain,
        shape: EnsembleShape,
        classes: Vec<String>,
        identity: Value,
    ) -> Self {
        Self { subject, domain, shape, identity, classes, negative_weight: None, kind: Kind::Elsewhere }
    }

    /// What makes these points the ones they are.
    pub(crate) fn identity(&self) -> &Value {
        &self.identity
    }

    /// What this is, in words.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// The domain.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// The names of the classes of points, in order of their first point; none if there is no column of them.
    pub fn classes(&self) -> &[String] {
        &self.classes
    }

    /// The sampler, if the points come from one.
    pub fn process(&self) -> Option<&Process> {
        match &self.kind {
            Kind::Process(process) => Some(process),
            _ => None,
        }
    }

    /// Whether the weights are such that pairs can be counted by them: none below 0, and two of a realization not
    /// negligible.
    pub fn check_pair_weights(&self, column: &str) -> Result<()> {
        let Kind::Held(ensemble) = &self.kind else { return Ok(()) };
        if let Some((place, weight)) = &self.negative_weight {
            let reason = format!("weight {}; g and K need weights of at least 0, P does not", number(*weight));
            return Err(Error::input(place, reason));
        }
        let two = |k| ensemble.masses(k).is_none_or(|m| m.iter().filter(|&&u| u > 0).nth(1).is_some());
        if !(0..ensemble.realizations()).any(two) {
            let reason = "no realization has two points whose weights are not negligible beside the largest of all (2^-25 of it)";
            return Err(Error::setting(Setting::WeightColumn, column, reason));
        }
        Ok(())
    }

    /// Number and size of realizations.
    pub fn shape(&self) -> EnsembleShape {
        self.shape
    }

    /// Realizations `range`.
    pub fn batch(&self, range: Range<u64>, control: &Control) -> Result<Ensemble> {
        match &self.kind {
            Kind::Held(ensemble) => Ok(ensemble.slice(range.start as usize..range.end as usize)),
            Kind::Drawn(draw) => draw(range),
            Kind::Elsewhere => {
                let reason =
                    "these points are not here: sums that were read know of them, and go on once they have them again";
                Err(Error::input(&self.subject, reason))
            }
            Kind::Process(p) => {
                let on_unit = samplers::ensemble(p.sampler, p.n, p.dim, p.seed, range, &p.values, control)?;
                Ok(on_unit.stretched(&self.domain))
            }
        }
    }
}

/// A digest of all integers and marks of an ensemble, realization by realization.
fn digest(ensemble: &Ensemble) -> String {
    let mut hash = Xxh3Default::new();
    for k in 0..ensemble.realizations() {
        hash.update(&(ensemble.points_in(k) as u64).to_le_bytes());
        for axis in ensemble.fractions(k).into_iter().chain(ensemble.lengths(k)) {
            axis.iter().for_each(|x| hash.update(&x.to_le_bytes()));
        }
        ensemble.weights(k).into_iter().flatten().for_each(|w| hash.update(&w.to_le_bytes()));
        ensemble.classes(k).into_iter().flatten().for_each(|c| hash.update(&c.to_le_bytes()));
    }
    format!("{:032x}", hash.digest128())
}

/// The points with their weights and classes, and the names of the classes.
fn ensemble(marked: Vec<MarkedPoints>, domain: &Domain, request: &PointsRequest) -> Result<(Ensemble, Vec<String>)> {
    let (mut raw, mut weights, mut classes) = (Vec::new(), Vec::new(), Vec::new());
    let mut names: Vec<String> = Vec::new();
    let mut numbers = HashMap::new();
    for set in marked {
        raw.push(set.points);
        weights.extend(set.weights);
        for label in set.labels {
            let number = *numbers.entry(label).or_insert_with_key(|label| {
                names.push(label.clone());
                names.len() as u32 - 1
            });
            classes.push(number);
        }
    }
    let mut ensemble = Ensemble::from_raw(&raw, domain, request.wrap, 0)?;
    if let Some(column) = &request.weight_column {
        if weights.iter().all(|&w| w == 0.0) {
            return Err(Error::setting(Setting::WeightColumn, column, "all weights are 0"));
        }
        ensemble = ensemble.with_weights(&weights);
    }
    if request.class_column.is_some() {
        ensemble = ensemble.with_classes(classes);
    }
    Ok((ensemble, names))
}

/// The number of axes that `--box` or `--window` fix.
fn dim_of_flags(request: &PointsRequest) -> Option<usize> {
    let window = request.window.as_ref().map(|w| w.len() / 2);
    request.sides.as_ref().map(Vec::len).or(window)
}

/// The domain of the flags, for points with `dim` coordinates.
fn domain(request: &PointsRequest, dim: usize) -> Result<Domain> {
    if let Some(window) = &request.window {
        if request.domain == Some(Boundary::Torus) {
            return Err(Error::setting(
                Setting::Window,
                numbers(window.iter().copied()),
                "contradicts `domain` torus; `sides` sets its sides",
            ));
        }
        if window.len() != 2 * dim {
            let reason = format!("expected {} numbers for points with {dim} coordinates", 2 * dim);
            return Err(Error::setting(Setting::Window, numbers(window.iter().copied()), reason));
        }
        return Domain::window(&window.chunks_exact(2).map(|r| (r[0], r[1])).collect::<Vec<_>>());
    }
    if request.domain == Some(Boundary::Window) {
        return Err(Error::setting(
            Setting::Domain,
            "window",
            "needs `window` x0,x1,y0,y1[,z0,z1]: a window is not guessed",
        ));
    }
    match &request.sides {
        Some(sides) if sides.len() != dim => {
            let reason = format!("expected {dim} sides for points with {dim} coordinates");
            Err(Error::setting(Setting::Sides, numbers(sides.iter().copied()), reason))
        }
        Some(sides) => Domain::torus(sides),
        None => Ok(Domain::unit_torus(dim)),
    }
}

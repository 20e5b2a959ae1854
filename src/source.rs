//! Where the points come from: files, read once, or a sampler, drawn batch by batch.

use std::collections::HashMap;
use std::ops::Range;

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
    classes: Vec<String>,
    /// The first weight below 0, and where it stands.
    negative_weight: Option<(String, f64)>,
    kind: Kind,
}

enum Kind {
    Loaded(Ensemble),
    Process(Process),
}

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
            let subject = format!("sampler {name}, n {n}, K {k}, seed {seed}");
            return Ok(Self {
                subject,
                domain,
                classes: Vec::new(),
                negative_weight: None,
                kind: Kind::Process(process),
            });
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
        Ok(Self { subject, domain, classes, negative_weight, kind: Kind::Loaded(ensemble) })
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
            Kind::Loaded(_) => None,
        }
    }

    /// Whether the weights are such that pairs can be counted by them: none below 0, and two of a realization not
    /// negligible.
    pub fn check_pair_weights(&self, column: &str) -> Result<()> {
        let Kind::Loaded(ensemble) = &self.kind else { return Ok(()) };
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
        match &self.kind {
            Kind::Loaded(ensemble) => {
                let k = ensemble.realizations();
                EnsembleShape {
                    realizations: k as u64,
                    mean_points: ensemble.total_points() as f64 / k as f64,
                    max_points: (0..k).map(|k| ensemble.points_in(k) as u64).max().unwrap_or(0),
                }
            }
            Kind::Process(p) => {
                // A drawn n rarely strays far from its mean; the budget of a batch is no sharper than that.
                let max_points = if p.sampler.fixed_n() { p.n } else { 2 * p.n + 16 };
                EnsembleShape { realizations: p.realizations, mean_points: p.n as f64, max_points }
            }
        }
    }

    /// Realizations `range`.
    pub fn batch(&self, range: Range<u64>, control: &Control) -> Result<Ensemble> {
        match &self.kind {
            Kind::Loaded(ensemble) => Ok(ensemble.slice(range.start as usize..range.end as usize)),
            Kind::Process(p) => {
                let on_unit = samplers::ensemble(p.sampler, p.n, p.dim, p.seed, range, &p.values, control)?;
                Ok(on_unit.stretched(&self.domain))
            }
        }
    }
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

//! A look at all points, once, before any is used.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use serde_json::json;
use xxhash_rust::xxh3::Xxh3Default;

use super::files::{Files, Marking};
use super::intensity::{Intensity, Seen};
use super::precision::Extent;
use super::remarks::Remarks;
use super::weights::Weights;
use super::{Kind, Points, domain};
use crate::error::{Error, Result, plural};
use crate::points::read::{MarkedPoints, read_polygon};
use crate::points::{Domain, Ensemble, EnsembleShape};
use crate::request::PointsRequest;

/// What a look at all points, once, finds out.
pub(super) struct FirstPass<'a> {
    pub(super) request: &'a PointsRequest,
    pub(super) dim: Option<usize>,
    pub(super) sizes: Vec<u64>,
    pub(super) hash: Xxh3Default,
    /// Its digest after each realization.
    prefixes: Vec<u128>,
    pub(super) weights: Weights,
    intensities: Seen,
    pub(super) names: Vec<String>,
    pub(super) numbers: HashMap<String, u32>,
    pub(super) remarks: Remarks,
    /// Which realization first had these points.
    known: HashMap<u128, u64>,
    extent: Extent,
    domain: Option<Domain>,
    /// The window that a file has.
    polygon: Option<Domain>,
    outside: u64,
}

/// Their bytes, the least significant first on any machine; all at once where they lie so.
fn hash_numbers(hash: &mut Xxh3Default, numbers: &[f64]) {
    if cfg!(target_endian = "little") {
        hash.update(bytemuck::cast_slice(numbers));
    } else {
        numbers.iter().for_each(|x| hash.update(&x.to_le_bytes()));
    }
}

impl<'a> FirstPass<'a> {
    pub(super) fn new(request: &'a PointsRequest) -> Result<Self> {
        let polygon = request.window_polygon.as_ref().map(|path| read_polygon(path)).transpose()?;
        let (polygon, notes) = polygon.map_or((None, Vec::new()), |(domain, notes)| (Some(domain), notes));
        let mut remarks = Remarks::default();
        notes.iter().for_each(|note| remarks.note(note));
        Ok(Self {
            request,
            dim: None,
            sizes: Vec::new(),
            hash: Xxh3Default::new(),
            prefixes: Vec::new(),
            weights: Weights::default(),
            intensities: Seen::default(),
            names: Vec::new(),
            numbers: HashMap::new(),
            remarks,
            known: HashMap::new(),
            extent: Extent::default(),
            domain: None,
            polygon,
            outside: 0,
        })
    }

    pub(super) fn domain(&self) -> Result<Domain> {
        let nothing = || Error::input("points", "the files hold no realizations");
        if let Some(stated) = self.remarks.stated(self.request)? {
            return Ok(stated);
        }
        domain(self.request, self.polygon.as_ref(), self.dim.ok_or_else(nothing)?)
    }

    pub(super) fn see(&mut self, sets: &[MarkedPoints]) -> Result<()> {
        for set in sets {
            self.dim.get_or_insert(set.points.dim);
            self.remarks.read(&set.reading, &set.points.source);
            self.extent.see(&set.points, set.reading.digits);
            if self.request.wrap {
                let domain = match self.domain.take() {
                    Some(domain) => domain,
                    None => self.domain()?,
                };
                let inside = |point: &[f64]| {
                    let axes = point.iter().zip(domain.origin()).zip(domain.sides());
                    axes.into_iter().all(|((x, origin), side)| (0.0..*side).contains(&(x - origin)))
                };
                self.outside +=
                    set.points.coordinates.chunks_exact(set.points.dim).filter(|p| !inside(p)).count() as u64;
                self.domain = Some(domain);
            }
            self.compare(set);
            self.sizes.push(set.points.len() as u64);
            self.hash.update(&(set.points.len() as u64).to_le_bytes());
            hash_numbers(&mut self.hash, &set.points.coordinates);
            hash_numbers(&mut self.hash, &set.weights);
            match self.request.intensity_column {
                None => self.weights.see(&set.weights, |j| set.points.place(j)),
                Some(_) => {
                    let inverses = self.intensities.see(&set.weights, |j| set.points.place(j), "")?;
                    self.weights.see(&inverses, |j| set.points.place(j));
                }
            }
            for label in &set.labels {
                self.hash.update(&(label.len() as u64).to_le_bytes());
                self.hash.update(label.as_bytes());
                if !self.numbers.contains_key(label) {
                    self.numbers.insert(label.clone(), self.names.len() as u32);
                    self.names.push(label.clone());
                }
            }
            self.prefixes.push(self.hash.digest128());
        }
        Ok(())
    }

    /// Says where a realization is the same as one before.
    fn compare(&mut self, set: &MarkedPoints) {
        // One point, or none, may well be where another is.
        if set.points.len() < 2 {
            return;
        }
        let mut hash = Xxh3Default::new();
        hash_numbers(&mut hash, &set.points.coordinates);
        match self.known.entry(hash.digest128()) {
            Entry::Vacant(place) => _ = place.insert(self.sizes.len() as u64),
            Entry::Occupied(first) => {
                let note = format!(
                    "{} has the same points as realization {}: realizations that are copies make standard errors too small",
                    set.points.source,
                    first.get()
                );
                self.remarks.note(&note);
            }
        }
    }

    /// What the user should know.
    fn warnings(&self, domain: &Domain) -> Vec<String> {
        let mut warnings = self.remarks.all();
        let points: u64 = self.sizes.iter().sum();
        if self.request.wrap {
            let were = if self.outside == 1 { "was" } else { "were" };
            warnings.push(format!(
                "{} of {} {were} outside the box and folded into it",
                self.outside,
                plural(points, "point")
            ));
        }
        warnings.extend(self.extent.flat(&self.remarks.input));
        let mean = points as f64 / self.sizes.len().max(1) as f64;
        warnings.extend(self.extent.coarse(domain, mean));
        warnings
    }

    /// Whether all points of a file can be used, before any of them is.
    pub(super) fn accepts(&self, sets: &[MarkedPoints]) -> Result<()> {
        let Some(first) = sets.first() else { return Ok(()) };
        let domain = match self.remarks.stated_with(first, self.request)? {
            Some(stated) => stated,
            None => domain(self.request, self.polygon.as_ref(), self.dim.unwrap_or(first.points.dim))?,
        };
        for set in sets {
            Ensemble::check(&set.points, &domain, self.request.wrap)?;
            if self.request.intensity_column.is_some() {
                Seen::default().see(&set.weights, |j| set.points.place(j), "")?;
            }
        }
        Ok(())
    }

    /// Whether points that are not held can be used.
    pub(super) fn check(&self, sets: &[MarkedPoints]) -> Result<()> {
        let domain = self.domain()?;
        for set in sets {
            Ensemble::check(&set.points, &domain, self.request.wrap)?;
        }
        Ok(())
    }

    pub(super) fn finish(
        self,
        subject: String,
        held: Option<Vec<MarkedPoints>>,
        files: impl FnOnce(Marking) -> Files,
    ) -> Result<Points> {
        let domain = self.domain()?;
        let warnings = self.warnings(&domain);
        let Self { request, sizes, hash, prefixes, weights, intensities, names, numbers, remarks, outside, .. } = self;
        let mut input = remarks.input;
        input.wrapped = request.wrap.then_some(outside);
        let marked = request.weight_column.is_some() || request.intensity_column.is_some();
        let mut marks = Marking {
            wrap: request.wrap,
            largest: marked.then_some(weights.largest),
            inverse: request.intensity_column.is_some(),
            classes: request.class_column.is_some().then_some(numbers),
        };
        let no_weight = marks.largest == Some(0.0);
        if no_weight {
            // What is wrong with the points is said first.
            marks.largest = None;
        }
        let kind = match held {
            Some(sets) => Kind::Held(marks.ensemble(sets, &domain, 0)?),
            None => Kind::Files(files(marks)),
        };
        if let Some(column) = request.weight_column.as_ref().filter(|_| no_weight) {
            return Err(Error::input(subject, format!("`weight_column` {column}: all weights are 0")));
        }
        let identity = json!({
            "digest": format!("{:032x}", hash.digest128()),
            "weights": request.weight_column,
            "intensities": request.intensity_column,
            "classes": request.class_column,
            "columns": request.columns,
            "realizations": request.realization_column,
            "arrays": request.array,
            "wrap": request.wrap,
        });
        let mut points = Points {
            simulations: None,
            intensity: None,
            subject,
            domain,
            shape: EnsembleShape::of(&sizes),
            identity,
            prefixes,
            sizes: sizes.chunk_by(|a, b| a == b).map(|run| [run.len() as u64, run[0]]).collect(),
            classes: names,
            weights,
            fewest: sizes.iter().copied().min().unwrap_or(0),
            input: Some(input),
            warnings,
            kind,
        };
        points.intensity =
            request.intensity_column.as_ref().map(|column| Intensity::read(column, &intensities, &points));
        Ok(points)
    }
}

//! Where the points come from: memory, files or a sampler, batch by batch.

mod all_axes;
mod files;
mod first_pass;
mod held;
mod intensity;
mod precision;
mod remarks;
mod scan;
mod weights;

use std::ops::Range;
use std::path::Path;
use std::sync::Mutex;

use rayon::prelude::*;
use serde_json::{Value, json};
use xxhash_rust::xxh3::Xxh3Default;

pub use all_axes::AllAxes;
pub(crate) use all_axes::refuse_marks;
use files::Files;
use first_pass::FirstPass;
use intensity::Intensity;
pub use scan::{Scan, scanned};
use weights::Weights;

use crate::control::Control;
use crate::error::{Error, Result, number, numbers};
use crate::estimate::Inhomogeneity;
use crate::plan::MEMORY_BUDGET;
use crate::points::read::{
    Columns, Found, Input, MarkedPoints, OnBroken, ReadOptions, TypedColumns, each_piece, extension, folders_left_out,
    lasts, read_bytes,
};
use crate::points::{Boundary, Domain, Ensemble, EnsembleShape, RawPoints, counts_in_pairs};
use crate::request::{PointsRequest, refuse_settings_of_samplers};
use crate::samplers::Process;
use crate::setting::Setting;

/// The points of one request.
pub struct Points {
    subject: String,
    domain: Domain,
    shape: EnsembleShape,
    /// What makes these points the ones they are: equal ones are of equal points, realization by realization.
    identity: Value,
    /// Of files, the digest of the first realization, the first two, ...
    prefixes: Vec<u128>,
    /// Of files, realizations and points of each, in runs of equally many.
    sizes: Vec<[u64; 2]>,
    classes: Vec<String>,
    weights: Weights,
    /// What they are weighted by the inverse of.
    intensity: Option<Intensity>,
    /// The fewest points of a realization, where that is known.
    fewest: u64,
    /// What was read, if it was read.
    input: Option<Input>,
    /// What the user should know about that.
    warnings: Vec<String>,
    /// Simulations that they are compared with, if some were given.
    simulations: Option<Box<Points>>,
    kind: Kind,
}

enum Kind {
    Held(Ensemble),
    /// Some realizations, which have numbers of their own.
    Part(Ensemble),
    Files(Files),
    Process(Process),
    Drawn(Box<Draw>),
    /// Somewhere else: they were measured, and only that was kept.
    Elsewhere,
}

/// Realizations of a range.
type Draw = dyn Fn(Range<u64>) -> Result<Ensemble> + Send + Sync;

impl Points {
    /// Reads the files, or prepares the sampler; resolves the domain.
    ///
    /// # Errors
    /// Files that cannot be read, points outside the domain, settings that contradict each other: each by its place.
    pub fn open(request: &PointsRequest) -> Result<Self> {
        Self::open_with(request, &Control::default())
    }

    /// The same, where it can be stopped.
    ///
    /// # Errors
    /// The same; `Error::Cancelled`.
    pub fn open_with(request: &PointsRequest, control: &Control) -> Result<Self> {
        Self::open_subject(request, control)?.with_simulations(request, control)
    }

    /// With the simulations that the request names, if it names any.
    fn with_simulations(self, request: &PointsRequest, control: &Control) -> Result<Self> {
        let mut points = self;
        if let Some(from) = request.envelope_from.first() {
            let of_files = PointsRequest {
                files: request.envelope_from.clone(),
                envelope_from: Vec::new(),
                sampler: None,
                points: None,
                realizations: None,
                dim: None,
                seed: None,
                params: Vec::new(),
                class_column: None,
                inhomogeneous: None,
                ..request.clone()
            };
            let simulations = Self::open_subject(&of_files, control)?;
            if simulations.domain != points.domain {
                let reason = format!("the simulations are in {}, the points in {}", simulations.domain, points.domain);
                return Err(Error::setting(Setting::EnvelopeFrom, from.display(), reason));
            }
            points.warnings.extend(simulations.warnings.iter().map(|warning| format!("simulations: {warning}")));
            points.simulations = Some(Box::new(simulations));
        }
        Ok(points)
    }

    fn open_subject(request: &PointsRequest, control: &Control) -> Result<Self> {
        Self::open_plain(request, control)?.with_intensity(request, control)
    }

    fn open_plain(request: &PointsRequest, control: &Control) -> Result<Self> {
        if let Some(name) = &request.sampler {
            let n = request
                .points
                .ok_or_else(|| Error::setting(Setting::Points, "(none)", "`sampler` needs `points` N"))?;
            let (k, dim) = (request.realizations.unwrap_or(1), request.dim.unwrap_or(2));
            let seed = request.seed.unwrap_or(1);
            let process =
                Process::new(name, n, k, dim, seed, &request.params.iter().map(String::as_str).collect::<Vec<_>>())?;
            if let Some(path) = &request.window_polygon {
                let reason = "samplers fill a torus; a window needs files";
                return Err(Error::setting(Setting::WindowPolygon, path.display(), reason));
            }
            if request.domain == Some(Boundary::Window) {
                return Err(Error::setting(Setting::Domain, "window", "samplers fill a torus; a window needs files"));
            }
            let domain = if dim > 3 { Domain::unit_torus(dim) } else { domain(request, None, dim)? };
            return Self::sampled_with(process, domain, control);
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
        match Self::of_scan(request)? {
            Some(points) => Ok(points),
            None => Self::files_with(request, MEMORY_BUDGET, control),
        }
    }

    /// The same where files are held in memory up to `budget` bytes, and read again when they are needed beyond that.
    #[doc(hidden)]
    pub fn files_within(request: &PointsRequest, budget: u64) -> Result<Self> {
        Self::files_with(request, budget, &Control::default())
    }

    fn files_with(request: &PointsRequest, budget: u64, control: &Control) -> Result<Self> {
        match Self::files_like(None, request, budget, control)? {
            Ok(points) => Ok(points),
            // What the first file has is not what most have.
            Err(like) => Self::files_like(Some(like), request, budget, control)?
                .map_err(|_| Error::input("points", "the files changed while they were read")),
        }
    }

    /// The same where points are like some, or the first, of several coordinates. `Err` has points like those of most files, where files
    /// that cannot be used are left out and the first is one of few.
    fn files_like(
        like: Option<RawPoints>,
        request: &PointsRequest,
        budget: u64,
        control: &Control,
    ) -> Result<Result<Self, RawPoints>> {
        let columns = columns(request, false)?;
        let options = ReadOptions { dim: dim_of_flags(request), raw: request.raw };
        let mut pass = FirstPass::new(request)?;
        folders_left_out(&request.files).iter().for_each(|note| pass.remarks.note(note));
        let (mut held, mut bytes) = (Some(Vec::new()), 0);
        let (mut files, mut first, mut all_last) = (Vec::new(), 0, true);
        let may_restart = like.is_none() && request.files.iter().all(|file| lasts(file));
        let on_broken = if request.keep_going { OnBroken::LeaveOut { like } } else { OnBroken::Stop };
        each_piece(&request.files, &options, &columns, on_broken, |found| {
            control.check()?;
            let (file, piece) = match found {
                Found::Asked(piece) => return pass.accepts(piece),
                Found::Broken(broken) => {
                    pass.remarks.leave_out(broken);
                    return Ok(());
                }
                Found::Piece(file, piece) => (file, piece),
            };
            pass.see(&piece)?;
            let numbers =
                |set: &MarkedPoints| set.points.coordinates.len() + set.weights.len() + set.points.lines.len();
            bytes += 8 * piece.iter().map(numbers).sum::<usize>() as u64;
            match &mut held {
                Some(held) => held.extend(piece),
                None => pass.check(&piece)?,
            }
            if let Some(file) = file {
                pass.remarks.input.files += 1;
                all_last &= file.lasts();
                files.push((first, file));
                first = pass.sizes.len() as u64;
                // What was there once, and not again, is kept whatever it takes.
                if bytes > budget && all_last {
                    held.take().map_or(Ok(()), |held| pass.check(&held))?;
                }
            } else if bytes > budget && all_last {
                held.take().map_or(Ok(()), |held| pass.check(&held))?;
            }
            Ok(())
        })?;
        if let Some(most) = pass.remarks.most().filter(|_| may_restart) {
            return Ok(Err(most));
        }
        pass.remarks.check_any()?;
        let names: Vec<_> = request.files.iter().map(|f| f.display().to_string()).collect();
        let subject = match names.as_slice() {
            [one] => one.clone(),
            [one, ..] => format!("{one} and {} more", names.len() - 1),
            [] => String::new(),
        };
        pass.finish(subject, held, |marks| Files {
            files,
            stamps: Vec::new(),
            options,
            columns,
            marks,
            last: Mutex::default(),
        })
        .map(Ok)
    }

    /// Points in the bytes of a file, which `name` is the name of: its end tells apart what the bytes do not.
    ///
    /// # Errors
    /// As `open` of such a file.
    pub fn from_bytes(name: &str, bytes: &[u8], request: &PointsRequest) -> Result<Self> {
        let columns = columns(request, false)?;
        let options = ReadOptions { dim: dim_of_flags(request), raw: request.raw };
        let sets = read_bytes(name, &extension(Path::new(name)), bytes, &options, &columns)?;
        let mut pass = FirstPass::new(request)?;
        pass.see(&sets)?;
        pass.remarks.input.files = 1;
        pass.finish(name.to_string(), Some(sets), |marks| Files::none(options, columns, marks))?
            .with_intensity(request, &Control::default())
    }

    /// Realizations of points in memory: of each its coordinates, point by point.
    ///
    /// ```
    /// use pairwave::points::Domain;
    /// use pairwave::source::Points;
    ///
    /// let sets = [vec![0.1, 0.2, 0.7, 0.9], vec![0.5, 0.5]];
    /// let points = Points::new(Domain::unit_torus(2), &sets)?;
    /// assert_eq!((points.shape().realizations, points.shape().max_points), (2, 2));
    /// # Ok::<(), pairwave::Error>(())
    /// ```
    ///
    /// # Errors
    /// A point outside the domain, by its number; coordinates that do not make whole points; no realizations.
    pub fn new(domain: Domain, sets: &[impl AsRef<[f64]>]) -> Result<Self> {
        if sets.is_empty() {
            return Err(Error::input("points in memory", "there are no realizations"));
        }
        let dim = domain.dim();
        let raw = |(k, set): (usize, &[f64])| {
            let source = format!("points in memory, realization {k}");
            match set.len().is_multiple_of(dim) {
                true => Ok(RawPoints { dim, coordinates: set.to_vec(), source, lines: Vec::new() }),
                false => Err(Error::input(source, format!("{} numbers are no points of {dim} coordinates", set.len()))),
            }
        };
        let sets = sets.iter().map(AsRef::as_ref).enumerate().map(raw).collect::<Result<Vec<_>>>()?;
        Ok(Self::of(Ensemble::from_raw(&sets, &domain, false, 0)?))
    }

    /// Points that are there already.
    pub fn of(ensemble: Ensemble) -> Self {
        Self {
            subject: "points in memory".into(),
            domain: ensemble.domain().clone(),
            shape: ensemble.shape(),
            identity: json!({ "points": digest(&ensemble) }),
            prefixes: Vec::new(),
            sizes: Vec::new(),
            classes: Vec::new(),
            weights: Weights::of(&ensemble),
            intensity: None,
            fewest: (0..ensemble.realizations()).map(|k| ensemble.points_in(k) as u64).min().unwrap_or(0),
            input: None,
            warnings: Vec::new(),
            simulations: None,
            kind: Kind::Held(ensemble),
        }
    }

    /// Realizations of a process, stretched to a domain. Where their numbers of points are drawn, they are drawn here once: a plan knows
    /// them as it knows those of files.
    ///
    /// # Errors
    /// What the sampler says; a realization without points is none.
    pub fn sampled(process: Process, domain: Domain) -> Result<Self> {
        Self::sampled_with(process, domain, &Control::default())
    }

    fn sampled_with(process: Process, domain: Domain, control: &Control) -> Result<Self> {
        if process.dim != domain.dim() || process.dim > 3 {
            let reason = "expected 1 to 3; points of more are measured by pairs of axes, with `projections`";
            return Err(Error::setting(Setting::Dim, process.dim, reason));
        }
        let Process { n, dim, seed, realizations, ref name, ref parameters, .. } = process;
        let (shape, fewest) = if process.fixed_n {
            (EnsembleShape { realizations, mean_points: n as f64, max_points: n }, n)
        } else {
            let count = |index| process.count(index, control);
            let counts = (0..realizations).into_par_iter().map(count).collect::<Result<Vec<u64>>>()?;
            if counts.iter().all(|&n| n == 0) {
                return Err(Error::setting(Setting::Points, n, "no realization drew a single point; more are needed"));
            }
            (EnsembleShape::of(&counts), counts.iter().copied().min().unwrap_or(0))
        };
        Ok(Self {
            subject: format!("sampler {name}, n {n}, K {realizations}, seed {seed}"),
            domain,
            shape,
            identity: json!({ "sampler": name, "n": n, "dim": dim, "seed": seed, "parameters": parameters }),
            prefixes: Vec::new(),
            sizes: Vec::new(),
            classes: Vec::new(),
            weights: Weights::default(),
            intensity: None,
            fewest,
            input: None,
            warnings: Vec::new(),
            simulations: None,
            kind: Kind::Process(process),
        })
    }

    /// Realizations that are made when they are asked for.
    pub(crate) fn drawn(subject: &str, domain: Domain, shape: EnsembleShape, draw: Box<Draw>) -> Self {
        let (identity, kind) = (Value::Null, Kind::Drawn(draw));
        Self {
            subject: subject.into(),
            domain,
            shape,
            identity,
            prefixes: Vec::new(),
            sizes: Vec::new(),
            classes: Vec::new(),
            weights: Weights::default(),
            intensity: None,
            fewest: 0,
            input: None,
            warnings: Vec::new(),
            simulations: None,
            kind,
        }
    }

    /// What is known of points that are not here.
    pub(crate) fn elsewhere(
        subject: String,
        domain: Domain,
        shape: EnsembleShape,
        classes: Vec<String>,
        identity: Value,
        input: Option<Input>,
        found: Option<Inhomogeneity>,
    ) -> Self {
        Self {
            subject,
            domain,
            shape,
            identity,
            prefixes: Vec::new(),
            sizes: Vec::new(),
            classes,
            weights: Weights::default(),
            intensity: found.map(Intensity::of_elsewhere),
            fewest: 0,
            input,
            warnings: Vec::new(),
            simulations: None,
            kind: Kind::Elsewhere,
        }
    }

    /// What was read, if it was read from files.
    pub fn input(&self) -> Option<&Input> {
        self.input.as_ref()
    }

    /// The simulations they are compared with, if some were given.
    pub fn simulations(&self) -> Option<&Points> {
        self.simulations.as_deref()
    }

    /// What the user should know about what was read.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What was read, in a line: how many points and realizations, in what, from what.
    pub fn first_line(&self) -> String {
        let EnsembleShape { realizations, max_points, .. } = self.shape;
        let n = match self.fewest {
            fewest if fewest == max_points => max_points.to_string(),
            fewest => format!("{fewest}..{max_points}"),
        };
        let from = self.input.as_ref().map_or_else(String::new, |input| format!(": {}", input.words()));
        let (dim, domain, subject) = (self.domain.dim(), &self.domain, &self.subject);
        format!("n = {n}, K = {realizations}, {dim}D, {domain}; {subject}{from}")
    }

    /// What makes these points the ones they are.
    pub(crate) fn identity(&self) -> &Value {
        &self.identity
    }

    /// The identity of their first realizations alone, where more of them are the same points; none where that is not known.
    pub(crate) fn identity_of_first(&self, realizations: u64) -> Option<Value> {
        let digest = self.prefixes.get(usize::try_from(realizations).ok()?.checked_sub(1)?)?;
        let mut identity = self.identity.clone();
        identity["digest"] = json!(format!("{digest:032x}"));
        // What is relative to the largest of all changes with more of them.
        ["weights", "intensities"].iter().all(|marks| identity[marks].is_null()).then_some(identity)
    }

    /// Whether they are in files that were scanned elsewhere: of the first of them alone nothing is known.
    pub(crate) fn is_scanned(&self) -> bool {
        matches!(&self.kind, Kind::Files(files) if !files.stamps.is_empty())
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
    ///
    /// # Errors
    /// The first weight below 0, by its place; weights of which all but one are negligible in every realization.
    pub fn check_pair_weights(&self, of: &str) -> Result<()> {
        if let Some((place, weight)) = &self.weights.negative {
            let reason = format!("weight {}; g and K need weights of at least 0, P does not", number(*weight));
            return Err(Error::input(place, reason));
        }
        if !self.weights.second.is_some_and(|second| counts_in_pairs(second, self.weights.largest)) {
            let reason = format!(
                "{of}: no realization has two points whose weights are not negligible beside the largest of all (2^-60 of it)"
            );
            return Err(Error::input(&self.subject, reason));
        }
        Ok(())
    }

    /// Number and size of realizations.
    pub fn shape(&self) -> EnsembleShape {
        self.shape
    }

    /// The index after the last realization that there will be.
    pub(crate) fn end(&self) -> u64 {
        match &self.kind {
            Kind::Part(part) => part.first_index() + part.realizations() as u64,
            _ => self.shape.realizations,
        }
    }

    /// Realizations `range`.
    ///
    /// # Errors
    /// Files that changed since they were first read, what the sampler says, `Error::Cancelled`.
    pub fn batch(&self, range: Range<u64>, control: &Control) -> Result<Ensemble> {
        let batch = self.unweighted_batch(range, control)?;
        Ok(match &self.intensity {
            Some(intensity) => intensity.weigh(batch),
            None => batch,
        })
    }

    fn unweighted_batch(&self, range: Range<u64>, control: &Control) -> Result<Ensemble> {
        match &self.kind {
            Kind::Held(ensemble) => Ok(ensemble.slice(range.start as usize..range.end as usize)),
            Kind::Part(part) => {
                let from = part.first_index();
                match range.start.checked_sub(from).filter(|_| range.end <= self.end()) {
                    Some(start) => Ok(part.slice(start as usize..(range.end - from) as usize)),
                    None => {
                        let reason = format!("holds {from}..{} of a stream, and is asked for {range:?}", self.end());
                        Err(Error::input(&self.subject, reason))
                    }
                }
            }
            Kind::Files(files) => files.batch(range, &self.domain, control),
            Kind::Drawn(draw) => draw(range),
            Kind::Elsewhere => {
                let reason =
                    "these points are not here: sums that were read know of them, and go on once they have them again";
                Err(Error::input(&self.subject, reason))
            }
            Kind::Process(p) => Ok(p.ensemble(range, control)?.stretched(&self.domain)),
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

/// The columns that a request names; with `many_axes` of points that may have more than 3 coordinates.
fn columns(request: &PointsRequest, many_axes: bool) -> Result<Columns> {
    Columns::new(&TypedColumns {
        columns: request.columns.as_deref(),
        realization: request.realization_column.as_deref(),
        weight: request.weight_column.as_deref(),
        intensity: request.intensity_column.as_deref(),
        class: request.class_column.as_deref(),
        array: request.array.as_deref(),
        many_axes,
    })
}

/// The number of axes that `--box` or `--window` fix.
fn dim_of_flags(request: &PointsRequest) -> Option<usize> {
    let window = request.window.as_ref().map(|w| w.len() / 2);
    let polygon = request.window_polygon.as_ref().map(|_| 2);
    request.sides.as_ref().map(Vec::len).or(window).or(polygon)
}

/// The domain of the flags, for points with `dim` coordinates; `polygon` is the window that was read from a file.
fn domain(request: &PointsRequest, polygon: Option<&Domain>, dim: usize) -> Result<Domain> {
    if let Some((polygon, path)) = polygon.zip(request.window_polygon.as_ref()) {
        if request.window.is_some() || request.sides.is_some() {
            let reason = "is the window; expected neither `window` nor `sides` beside it";
            return Err(Error::setting(Setting::WindowPolygon, path.display(), reason));
        }
        if request.domain == Some(Boundary::Torus) {
            let reason = "contradicts `domain` torus; `sides` sets its sides";
            return Err(Error::setting(Setting::WindowPolygon, path.display(), reason));
        }
        if dim != 2 {
            let reason =
                format!("is a window in the plane, and the points have {dim} coordinates; `columns` takes two");
            return Err(Error::setting(Setting::WindowPolygon, path.display(), reason));
        }
        return Ok(polygon.clone());
    }
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
            "needs `window` x0,x1,y0,y1[,z0,z1] or `window_polygon` FILE: a window is not guessed",
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

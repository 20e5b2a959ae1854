//! Points of any number of axes, held whole, of which some axes and the first points of each realization are measured at a time.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::remarks::Remarks;
use super::scan::{Remarked, Scan};
use super::{Points, columns};
use crate::control::Control;
use crate::error::{Error, Result, number, numbers};
use crate::memory::Memory;
use crate::points::read::{Found, Input, OnBroken, ReadOptions, each_piece, folders_left_out};
use crate::points::{Boundary, Domain, Ensemble, EnsembleShape, RawPoints};
use crate::request::{PointsRequest, refuse_settings_of_samplers};
use crate::samplers::{Number, Process, find};
use crate::setting::Setting;

/// Realizations of points with as many coordinates as they have, in a torus or a box.
pub struct AllAxes {
    subject: String,
    sets: Arc<Vec<RawPoints>>,
    dim: usize,
    /// The lower corner, and how far it reaches.
    origin: Vec<f64>,
    sides: Vec<f64>,
    is_torus: bool,
    wrap: bool,
    input: Option<Input>,
    warnings: Vec<String>,
    /// Whether the first points of a realization are one of fewer points: not known of files.
    is_sequence: Option<bool>,
}

impl AllAxes {
    /// Reads the files, or draws from the sampler.
    ///
    /// # Errors
    /// As `Points::open`; weights, classes and polygons, which are not measured so.
    pub fn open(request: &PointsRequest, memory: Memory, control: &Control) -> Result<Self> {
        let scan = Scan::in_place_of(&request.files)?;
        let instead = match scan {
            Some(_) => "; expected the files themselves, or a scan that was made without it",
            None => "",
        };
        let (scanned, remarked) = scan.map(|(path, scan)| scan.of_its_files(path, request)).transpose()?.unzip();
        let request = scanned.as_ref().unwrap_or(request);
        let reason = "is not there where pairs of axes or prefixes are measured (`projections`, `prefixes`)";
        refuse_marks(request, &format!("{reason}{instead}"))?;
        match &request.sampler {
            Some(name) => Self::sampled(name, request, memory, control),
            None => Self::read(request, remarked, memory, control),
        }
    }

    fn sampled(name: &str, request: &PointsRequest, memory: Memory, control: &Control) -> Result<Self> {
        let missing = || Error::setting(Setting::Points, "(none)", "`sampler` needs `points` N");
        let n = request.points.ok_or_else(missing)?;
        let (k, dim, seed) = (request.realizations.unwrap_or(1), request.dim.unwrap_or(2), request.seed.unwrap_or(1));
        let process =
            Process::new(name, n, k, dim, seed, &request.params.iter().map(String::as_str).collect::<Vec<_>>())?;
        if let Some(window) = &request.window {
            let reason = "samplers fill a torus; a window needs files";
            return Err(Error::setting(Setting::Window, numbers(window.iter().copied()), reason));
        }
        let (origin, sides, is_torus) = place(request, dim)?;
        check_memory(memory, k as f64 * n as f64 * dim as f64)?;
        let draw = |index: u64| {
            let mut coordinates = process.coordinates(index, control)?;
            coordinates
                .chunks_exact_mut(dim)
                .for_each(|point| point.iter_mut().zip(&sides).for_each(|(x, side)| *x *= side));
            let source = format!("realization {index}");
            Ok(RawPoints { dim, coordinates, source, lines: Vec::new() })
        };
        let sets = (0..k).into_par_iter().map(draw).collect::<Result<Vec<_>>>()?;
        let is_sequence = Some(find(name)?.number == Number::Sequence);
        Ok(Self {
            subject: format!("sampler {}, n {n}, K {k}, seed {seed}", process.name),
            sets: Arc::new(sets),
            dim,
            origin,
            sides,
            is_torus,
            // A product with a side may round to it.
            wrap: true,
            input: None,
            warnings: Vec::new(),
            is_sequence,
        })
    }

    /// `remarked` is what is known of files that were scanned.
    fn read(request: &PointsRequest, remarked: Option<Remarked>, memory: Memory, control: &Control) -> Result<Self> {
        refuse_settings_of_samplers(request)?;
        if request.files.is_empty() {
            return Err(Error::setting(Setting::Files, "(none)", "expected point files, or `sampler` NAME `points` N"));
        }
        let columns = columns(request, remarked.is_none())?;
        let dim = request.sides.as_ref().map(Vec::len).or(request.window.as_ref().map(|w| w.len() / 2));
        let options = ReadOptions { dim, raw: request.raw };
        let (mut sets, mut numbers, mut seen) = (Vec::new(), 0.0, Remarks::default());
        folders_left_out(&request.files).iter().for_each(|note| seen.note(note));
        let on_broken = if request.keep_going { OnBroken::LeaveOut { like: None } } else { OnBroken::Stop };
        each_piece(&request.files, &options, &columns, on_broken, |found| {
            control.check()?;
            let (file, piece) = match found {
                Found::Asked(piece) => {
                    let Some(first) = piece.first() else { return Ok(()) };
                    let place = place_of(seen.stated_with(first, request)?, request, first.points.dim)?;
                    return piece.iter().try_for_each(|set| check(&set.points, &place, request.wrap));
                }
                Found::Broken(broken) => {
                    seen.leave_out(broken);
                    return Ok(());
                }
                Found::Piece(file, piece) => (file, piece),
            };
            seen.input.files += u64::from(file.is_some());
            for set in piece {
                seen.read(&set.reading, &set.points.source);
                numbers += set.points.coordinates.len() as f64;
                sets.push(set.points);
            }
            check_memory(memory, numbers)
        })?;
        seen.check_any()?;
        let dim = sets.first().map_or(0, |set: &RawPoints| set.dim);
        let place = place_of(seen.stated(request)?, request, dim)?;
        sets.iter().try_for_each(|set| check(set, &place, request.wrap))?;
        let (origin, sides, is_torus) = place;
        let names: Vec<_> = request.files.iter().map(|f| f.display().to_string()).collect();
        let more = if names.len() > 1 { format!(" and {} more", names.len() - 1) } else { String::new() };
        let subject = format!("{}{more}", names.first().map_or("", String::as_str));
        let (subject, input, warnings) = match remarked {
            // Files that were left out, and the like, were remarked when they were scanned.
            Some(of) => (of.subject, of.input, of.warnings),
            None => (subject, Some(seen.input.clone()), seen.all()),
        };
        Ok(Self {
            subject,
            sets: Arc::new(sets),
            dim,
            origin,
            sides,
            is_torus,
            wrap: request.wrap,
            input,
            warnings,
            is_sequence: None,
        })
    }

    /// What this is, in words.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// The number of axes.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Lengths along the axes.
    pub fn sides(&self) -> &[f64] {
        &self.sides
    }

    /// Whether distances wrap.
    pub fn is_torus(&self) -> bool {
        self.is_torus
    }

    /// Number and size of realizations.
    pub fn shape(&self) -> EnsembleShape {
        EnsembleShape::of(&self.sizes())
    }

    fn sizes(&self) -> Vec<u64> {
        self.sets.iter().map(|set| set.len() as u64).collect()
    }

    /// The fewest points of a realization.
    pub fn fewest(&self) -> u64 {
        self.sizes().into_iter().min().unwrap_or(0)
    }

    /// What was read, in a line.
    pub fn first_line(&self) -> String {
        let n = match (self.fewest(), self.shape().max_points) {
            (fewest, most) if fewest == most => most.to_string(),
            (fewest, most) => format!("{fewest}..{most}"),
        };
        let kind = if self.is_torus { "torus" } else { "window" };
        let from = self.input.as_ref().map_or_else(String::new, |input| format!(": {}", input.words()));
        let sides: Vec<String> = self.sides.iter().map(f64::to_string).collect();
        format!("n = {n}, K = {}, {}D, {kind} {}; {}{from}", self.sets.len(), self.dim, sides.join(" x "), self.subject)
    }

    /// What the user should know about what was read.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What was read, if it was read from files.
    pub fn input(&self) -> Option<&Input> {
        self.input.as_ref()
    }

    /// Whether the first points of a realization are one of fewer points; not known of files.
    pub fn is_sequence(&self) -> Option<bool> {
        self.is_sequence
    }

    /// Coordinates of the first `first` points of realization `k` in the unit cube, per axis.
    pub(crate) fn cube(&self, k: usize, first: Option<u64>) -> Vec<Vec<f64>> {
        let set = &self.sets[k];
        let n = first.map_or(set.len(), |first| (first as usize).min(set.len()));
        let scaled = |a: usize| {
            let fraction = move |j: usize| {
                let x = (set.coordinates[j * self.dim + a] - self.origin[a]) / self.sides[a];
                // What lies within, lies within; what rounds to 1 on a torus is 0.
                if self.is_torus && !(0.0..1.0).contains(&x) { (x - x.floor()) % 1.0 } else { x }
            };
            (0..n).map(fraction).collect()
        };
        (0..self.dim).map(scaled).collect()
    }

    /// The points on some axes, of each realization the first ones.
    ///
    /// # Errors
    /// Sides that differ too much.
    pub fn view(&self, axes: &[usize], first: Option<u64>) -> Result<Points> {
        let sides: Vec<f64> = axes.iter().map(|&a| self.sides[a]).collect();
        let domain = match self.is_torus {
            true => {
                let origin = axes.iter().map(|&a| self.origin[a]).collect();
                let rests = vec![0.0; axes.len()];
                Domain::from_numbers(Boundary::Torus, origin, sides, rests)?
            }
            false => {
                let ends: Vec<_> = axes.iter().map(|&a| (self.origin[a], self.origin[a] + self.sides[a])).collect();
                Domain::window(&ends)?
            }
        };
        let take = move |set: &RawPoints| set.len().min(first.map_or(usize::MAX, |first| first as usize));
        let sizes: Vec<u64> = self.sets.iter().map(|set| take(set) as u64).collect();
        let (sets, wrap, axes, dim, kept) = (self.sets.clone(), self.wrap, axes.to_vec(), self.dim, domain.clone());
        let draw = move |range: Range<u64>| {
            let cut = |set: &RawPoints| {
                let points = set.coordinates.chunks_exact(dim).take(take(set));
                RawPoints {
                    dim: axes.len(),
                    coordinates: points.flat_map(|point| axes.iter().map(|&a| point[a])).collect(),
                    source: set.source.clone(),
                    lines: set.lines.clone(),
                }
            };
            let some = sets[range.start as usize..range.end as usize].iter().map(cut).collect();
            Ensemble::from_owned(some, &kept, wrap, range.start)
        };
        Ok(Points::drawn(&self.subject, domain, EnsembleShape::of(&sizes), Box::new(draw)))
    }
}

/// What only some measurements have a use for is refused by the others, with a reason.
pub(crate) fn refuse_marks(request: &PointsRequest, reason: &str) -> Result<()> {
    let refused = [
        (Setting::WeightColumn, &request.weight_column),
        (Setting::IntensityColumn, &request.intensity_column),
        (Setting::Inhomogeneous, &request.inhomogeneous),
        (Setting::ClassColumn, &request.class_column),
        (Setting::WindowPolygon, &request.window_polygon.as_ref().map(|path| path.display().to_string())),
    ];
    match refused.into_iter().find_map(|(setting, value)| Some((setting, value.as_ref()?))) {
        Some((setting, value)) => Err(Error::setting(setting, value, reason)),
        None => Ok(()),
    }
}

/// Whether all points are inside.
fn check(set: &RawPoints, (origin, sides, is_torus): &Place, wrap: bool) -> Result<()> {
    for (j, point) in set.coordinates.chunks_exact(set.dim).enumerate() {
        for (a, x) in point.iter().enumerate() {
            let (low, high) = (origin[a], origin[a] + sides[a]);
            let inside = if *is_torus { (low..high).contains(x) } else { (low..=high).contains(x) };
            let folded = wrap && *is_torus && x.is_finite();
            if !inside && !folded {
                let end = if *is_torus { ")" } else { "]" };
                let reason = format!(
                    "coordinate {} = {} is outside [{low}, {high}{end}; `sides` sets the sides of a torus, `window` a window, `wrap` folds points in",
                    a + 1,
                    number(*x)
                );
                return Err(Error::input(set.place(j), reason));
            }
        }
    }
    Ok(())
}

/// Origin, sides, and whether they wrap.
type Place = (Vec<f64>, Vec<f64>, bool);

/// That of a domain that files state, or of the request.
fn place_of(stated: Option<Domain>, request: &PointsRequest, dim: usize) -> Result<Place> {
    match stated {
        Some(stated) => Ok((stated.origin().to_vec(), stated.sides().to_vec(), stated.is_torus())),
        None => place(request, dim),
    }
}

/// That of points with `dim` coordinates.
fn place(request: &PointsRequest, dim: usize) -> Result<Place> {
    let wrong = |setting, value: &[f64], expected: usize, what: &str| {
        let reason = format!("expected {expected} {what} for points with {dim} coordinates");
        Err(Error::setting(setting, numbers(value.iter().copied()), reason))
    };
    if let Some(window) = &request.window {
        if request.domain == Some(Boundary::Torus) {
            let reason = "contradicts `domain` torus; `sides` sets its sides";
            return Err(Error::setting(Setting::Window, numbers(window.iter().copied()), reason));
        }
        if window.len() != 2 * dim {
            return wrong(Setting::Window, window, 2 * dim, "numbers");
        }
        let ends: Vec<(f64, f64)> = window.chunks_exact(2).map(|ends| (ends[0], ends[1])).collect();
        // What is wrong with an axis is wrong with the window.
        ends.iter().try_for_each(|ends| Domain::window(&[*ends]).map(|_| ()))?;
        let sides = ends.iter().map(|(low, high)| high - low).collect();
        return Ok((ends.into_iter().map(|(low, _)| low).collect(), sides, false));
    }
    if request.domain == Some(Boundary::Window) {
        let reason = "needs `window` x0,x1,y0,y1,...: a window is not guessed";
        return Err(Error::setting(Setting::Domain, "window", reason));
    }
    match &request.sides {
        Some(sides) if sides.len() != dim => wrong(Setting::Sides, sides, dim, "sides"),
        Some(sides) => {
            sides.iter().try_for_each(|&side| Domain::torus(&[side]).map(|_| ()))?;
            Ok((vec![0.0; dim], sides.clone(), true))
        }
        None => Ok((vec![0.0; dim], vec![1.0; dim], true)),
    }
}

/// Whether so many numbers may be held.
fn check_memory(memory: Memory, numbers: f64) -> Result<()> {
    let bytes = 8.0 * numbers;
    if bytes <= memory.0 as f64 {
        return Ok(());
    }
    let reason = format!(
        "all points are held at once where pairs of axes or prefixes are measured: {:.1} GiB of coordinates",
        bytes / f64::from(1 << 30)
    );
    Err(Error::setting(Setting::Memory, memory, reason))
}

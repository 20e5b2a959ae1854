//! What one look at the files of a batch finds, as a file: parts of the batch that are measured anywhere then need no look at all of them.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::files::{Files, Marking, Stamp};
use super::intensity::Intensity;
use super::weights::Weights;
use super::{Kind, Points, columns, dim_of_flags};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::estimate::Inhomogeneity;
use crate::points::polygon::Ring;
use crate::points::read::{Input, PointFile, ReadOptions};
use crate::points::{Boundary, Domain, EnsembleShape};
use crate::request::{Group, PointsRequest, Request, Row, SETTINGS, refuse_settings_of_samplers};
use crate::setting::Setting;

/// How a file of this kind begins.
const START: &str = "{\"pairwave_scan\":";

/// Of the form of the file.
const VERSION: u32 = 1;

/// More points than any file holds in one realization.
const MOST: u64 = 1 << 40;

/// What a look at all files of a batch finds: how many realizations and points each has, the domain, classes, the scale of weights, what is remarked.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Scan {
    pairwave_scan: u32,
    program: String,
    /// How they were read: the settings, as they are typed.
    settings: BTreeMap<String, String>,
    subject: String,
    boundary: Boundary,
    origin: Vec<f64>,
    sides: Vec<f64>,
    rests: Vec<f64>,
    polygon: Option<Vec<Vec<Ring>>>,
    /// Realizations, and points of each, in runs of equally many.
    sizes: Vec<[u64; 2]>,
    identity: Value,
    classes: Vec<String>,
    weights: Weights,
    intensity: Option<Inhomogeneity>,
    input: Option<Input>,
    warnings: Vec<String>,
    files: Vec<Scanned>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Scanned {
    path: PathBuf,
    /// The index of its first realization.
    first: u64,
    #[serde(flatten)]
    stamp: Stamp,
}

/// Whether a setting says how files are read.
fn reads(row: &Row) -> bool {
    let others = [Setting::Files, Setting::EnvelopeFrom, Setting::Unit, Setting::Sampler];
    [Group::Points, Group::Domain].contains(&row.group) && !row.for_samplers && !others.contains(&row.setting)
}

/// The settings that do.
fn reading() -> impl Iterator<Item = &'static Row> {
    SETTINGS.iter().filter(|row| reads(row))
}

/// What the files of a request are now.
fn stamps(request: &PointsRequest) -> BTreeMap<PathBuf, Stamp> {
    let of =
        |path: &PathBuf| std::path::absolute(path).ok().and_then(|path| Some((path.clone(), Stamp::of(&path).ok()?)));
    crate::points::read::paths(&request.files).iter().filter_map(of).collect()
}

/// A request of nothing but these points.
fn of_points(points: &PointsRequest) -> Request {
    Request { input: points.clone(), ..Request::default() }
}

impl Scan {
    /// Reads all files once.
    ///
    /// # Errors
    /// As `Points::open`; points that are in no files.
    pub fn of(request: &PointsRequest, control: &Control) -> Result<Self> {
        if request.sampler.is_some() {
            return Err(Error::setting(Setting::Sampler, "(given)", "is no files; samplers need no scan"));
        }
        refuse_settings_of_samplers(request)?;
        let all = of_points(request);
        let idle = SETTINGS.iter().find(|row| row.is_given(&all) && !reads(row) && row.setting != Setting::Files);
        if let Some(row) = idle {
            let reason = "says nothing about how files are read; it goes with the scan to `pairwave analyze`";
            return Err(Error::setting(row.setting, all.value(row.setting), reason));
        }
        let before = stamps(request);
        let plain = PointsRequest { inhomogeneous: None, envelope_from: Vec::new(), ..request.clone() };
        let points = Points::files_with(&plain, 0, control)?;
        let Kind::Files(files) = &points.kind else {
            let reason = "hold no points that can be read again: standard input, or files without any";
            return Err(Error::input(points.subject.clone(), reason));
        };
        let asked = of_points(request);
        let given = reading().filter(|row| row.is_given(&asked));
        let scanned = files.files.iter().map(|(first, file)| {
            let path = std::path::absolute(file.path()).map_err(|e| Error::file(file.path(), e))?;
            let stamp = Stamp::of(&path)?;
            if path.to_str().is_none() {
                let reason = "has a name that is no UTF-8, which a scan cannot hold; expected another name";
                return Err(Error::input(path.display().to_string(), reason));
            }
            if before.get(&path).is_some_and(|before| *before != stamp) {
                return Err(Error::input(path.display().to_string(), "changed while files were scanned; scan again"));
            }
            Ok(Scanned { first: *first, stamp, path })
        });
        let domain = &points.domain;
        Ok(Self {
            pairwave_scan: VERSION,
            program: concat!("pairwave ", env!("CARGO_PKG_VERSION")).into(),
            settings: given.map(|row| (row.setting.name().to_string(), asked.value(row.setting))).collect(),
            subject: points.subject.clone(),
            boundary: domain.boundary(),
            origin: domain.origin().to_vec(),
            sides: domain.sides().to_vec(),
            rests: domain.rests().to_vec(),
            polygon: domain.as_polygon().map(|polygon| polygon.parts().to_vec()),
            sizes: points.sizes.clone(),
            identity: points.identity.clone(),
            classes: points.classes.clone(),
            weights: points.weights.clone(),
            intensity: points.inhomogeneity().cloned(),
            files: scanned.collect::<Result<_>>()?,
            input: points.input.clone(),
            warnings: points.warnings.clone(),
        })
    }

    /// What was read: the first line of a run on it.
    pub fn first_line(&self) -> String {
        let (files, realizations) = (self.files.len() as u64, self.shape().realizations);
        let plural = crate::error::plural;
        format!("{} of {}", plural(realizations, "realization"), plural(files, "file"))
    }

    /// The settings that they were read by, as they are typed.
    pub fn settings(&self) -> impl Iterator<Item = (Setting, &str)> {
        reading().filter_map(|row| Some((row.setting, self.settings.get(row.setting.name())?.as_str())))
    }

    /// What the user should know of the files.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn shape(&self) -> EnsembleShape {
        EnsembleShape::of_runs(self.sizes.iter().map(|&[run, n]| (run, n)))
    }

    /// Its bytes.
    pub fn write(&self) -> Vec<u8> {
        serde_json::to_vec(self).unwrap_or_default()
    }

    /// The scan that a file is, if it is one.
    ///
    /// # Errors
    /// A scan that is damaged, or of another version.
    pub fn read(path: &Path) -> Result<Option<Self>> {
        // Of a pipe nothing may be read that its reader would miss.
        if !path.is_file() {
            return Ok(None);
        }
        let mut start = [0; START.len()];
        let begins = File::open(path).and_then(|mut file| file.read_exact(&mut start));
        if begins.is_err() || start != START.as_bytes() {
            return Ok(None);
        }
        let bytes = fs::read(path).map_err(|e| Error::file(path, e))?;
        let wrong = |reason: String| Error::input(path.display().to_string(), reason);
        let scan: Self = serde_json::from_slice(&bytes).map_err(|e| wrong(format!("is no whole scan: {e}")))?;
        if scan.pairwave_scan != VERSION {
            let version = scan.pairwave_scan;
            return Err(wrong(format!("is of version {version} of scans; this program reads version {VERSION}")));
        }
        let most = scan.sizes.iter().map(|size| size[1]).max().unwrap_or(0);
        let total: u128 = scan.sizes.iter().map(|&[run, _]| u128::from(run)).sum();
        let in_order =
            scan.files.is_sorted_by(|a, b| a.first <= b.first) && scan.files.first().is_some_and(|f| f.first == 0);
        let last = scan.files.last().map_or(0, |file| file.first);
        if !in_order || u128::from(last) > total || total > 1 << 62 || most > MOST {
            return Err(wrong("has files whose realizations cannot be".into()));
        }
        Ok(Some(scan))
    }

    /// The request with the settings that the files were read by.
    ///
    /// # Errors
    /// A setting that was another one.
    fn completed(&self, path: &Path, request: &PointsRequest) -> Result<PointsRequest> {
        let mut request = of_points(request);
        for row in reading() {
            let (given, there) = (request.value(row.setting), self.settings.get(row.setting.name()));
            match there {
                None if row.is_given(&request) => {
                    let reason = format!("{} was read without it; scan again with it", path.display());
                    return Err(Error::setting(row.setting, given, reason));
                }
                Some(there) if row.is_given(&request) && given != *there => {
                    let reason = format!("{} was read with {there}; expected that, or none", path.display());
                    return Err(Error::setting(row.setting, given, reason));
                }
                Some(there) => request.set(row.setting, there)?,
                None => {}
            }
        }
        Ok(request.input)
    }

    fn points(self, path: &Path, request: &PointsRequest) -> Result<Points> {
        if self.completed(path, request)? != *request {
            let lacks = "was read with settings that this request does not have; `scanned` adds them";
            return Err(Error::input(path.display().to_string(), lacks));
        }
        let shape = self.shape();
        let mut domain = Domain::from_numbers(self.boundary, self.origin, self.sides, self.rests)?;
        if let Some(parts) = self.polygon {
            domain = Domain::polygon(parts)?;
        }
        let (columns, options) =
            (columns(request, false)?, ReadOptions { dim: dim_of_flags(request), raw: request.raw });
        let marked = request.weight_column.is_some() || request.intensity_column.is_some();
        let numbers = self.classes.iter().cloned().zip(0..).collect();
        let marks = Marking {
            wrap: request.wrap,
            largest: marked.then_some(self.weights.largest),
            inverse: request.intensity_column.is_some(),
            classes: request.class_column.is_some().then_some(numbers),
        };
        let ends = self.files.iter().skip(1).map(|next| next.first).chain([shape.realizations]).collect::<Vec<_>>();
        let (mut files, mut stamps) = (Vec::new(), Vec::new());
        for (file, end) in self.files.into_iter().zip(ends) {
            // Of one realization there are no rows to be read apart.
            let one = end - file.first <= 1;
            let open = if one { PointFile::Whole(file.path) } else { PointFile::open(file.path, &options, &columns) };
            files.push((file.first, open));
            stamps.push(file.stamp);
        }
        Ok(Points {
            simulations: None,
            intensity: self.intensity.map(Intensity::of_elsewhere),
            subject: self.subject,
            domain,
            shape,
            identity: self.identity,
            prefixes: Vec::new(),
            fewest: self.sizes.iter().map(|size| size[1]).min().unwrap_or(0),
            sizes: self.sizes,
            classes: self.classes,
            weights: self.weights,
            input: self.input,
            warnings: self.warnings,
            kind: Kind::Files(Files { files, stamps, options, columns, marks, last: Mutex::default() }),
        })
    }
}

impl Points {
    /// The points of a scan, where the only file of a request is one.
    pub(super) fn of_scan(request: &PointsRequest) -> Result<Option<Self>> {
        let [path] = request.files.as_slice() else { return Ok(None) };
        Scan::read(path)?.map(|scan| scan.points(path, request)).transpose()
    }
}

/// The request itself, or, where its only file is a scan, with the settings by which the files of that were read.
///
/// # Errors
/// A scan that is damaged; settings by which its files were not read.
pub fn scanned(request: PointsRequest) -> Result<PointsRequest> {
    let [path] = request.files.as_slice() else { return Ok(request) };
    match Scan::read(path)? {
        Some(scan) => scan.completed(path, &request),
        None => Ok(request),
    }
}

impl Stamp {
    /// Of a file as it is now.
    pub(super) fn of(path: &Path) -> Result<Self> {
        let metadata = fs::metadata(path).map_err(|e| Error::file(path, e))?;
        let since = metadata.modified().ok().and_then(|at| at.duration_since(UNIX_EPOCH).ok());
        Ok(Self { bytes: metadata.len(), modified_s: since.map_or(0, |since| since.as_secs()) })
    }
}

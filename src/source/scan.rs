//! What one look at the files of a batch finds, as a file: parts of the batch that are measured anywhere then need no look at all of them.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
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
use crate::points::read::{Input, PointFile, ReadOptions, SCAN};
use crate::points::{Domain, EnsembleShape};
use crate::request::{Group, PointsRequest, Request, Row, SETTINGS, refuse_settings_of_samplers};
use crate::setting::Setting;

/// Of the form of the file.
const VERSION: u32 = 1;

/// More points than any file holds in one realization.
const MOST: u64 = 1 << 40;

/// What a look at all files of a batch finds: how many realizations and points each has, the domain, classes, the scale of weights, what is remarked.
#[derive(Debug, Clone)]
pub struct Scan {
    head: Head,
    body: Body,
}

/// The first line of the file, by which it is known what it is of before all of it is read.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Head {
    pairwave_scan: u32,
    program: String,
    /// How the files were read: the settings, as they are typed.
    settings: BTreeMap<String, String>,
}

/// The second line.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Body {
    subject: String,
    domain: Domain,
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
        let head = Head {
            pairwave_scan: VERSION,
            program: concat!("pairwave ", env!("CARGO_PKG_VERSION")).into(),
            settings: given.map(|row| (row.setting.name().to_string(), asked.value(row.setting))).collect(),
        };
        let body = Body {
            subject: points.subject.clone(),
            domain: points.domain.clone(),
            sizes: points.sizes.clone(),
            identity: points.identity.clone(),
            classes: points.classes.clone(),
            weights: points.weights.clone(),
            intensity: points.inhomogeneity().cloned(),
            files: scanned.collect::<Result<_>>()?,
            input: points.input.clone(),
            warnings: points.warnings.clone(),
        };
        Ok(Self { head, body })
    }

    /// What was read: the first line of a run on it.
    pub fn first_line(&self) -> String {
        let (files, realizations) = (self.body.files.len() as u64, self.shape().realizations);
        let plural = crate::error::plural;
        format!("{} of {}", plural(realizations, "realization"), plural(files, "file"))
    }

    /// What the user should know of the files.
    pub fn warnings(&self) -> &[String] {
        &self.body.warnings
    }

    fn shape(&self) -> EnsembleShape {
        EnsembleShape::of_runs(self.body.sizes.iter().map(|&[run, n]| (run, n)))
    }

    /// Its bytes.
    pub fn write(&self) -> Vec<u8> {
        let lines = [serde_json::to_vec(&self.head), serde_json::to_vec(&self.body)];
        lines.into_iter().flat_map(|line| [line.unwrap_or_default(), b"\n".to_vec()].concat()).collect()
    }

    /// The settings by which the files of a scan were read, as they are typed, if a file is one: its head alone is read.
    ///
    /// # Errors
    /// A scan that is damaged, or of another version.
    pub fn settings_in(path: &Path) -> Result<Option<Vec<(Setting, String)>>> {
        let settings = |(head, _): (Head, _)| {
            let given = |row: &Row| Some((row.setting, head.settings.get(row.setting.name())?.clone()));
            reading().filter_map(given).collect()
        };
        Ok(Head::read(path)?.map(settings))
    }

    /// The scan that the only file of a request is, if it is one.
    ///
    /// # Errors
    /// A scan that is damaged, or of another version.
    pub(super) fn in_place_of(files: &[PathBuf]) -> Result<Option<(&Path, Self)>> {
        let [path] = files else { return Ok(None) };
        let Some((head, mut rest)) = Head::read(path)? else { return Ok(None) };
        let wrong = |reason: String| Error::input(path.display().to_string(), reason);
        let mut bytes = Vec::new();
        rest.read_to_end(&mut bytes).map_err(|e| Error::file(path, e))?;
        let body: Body = serde_json::from_slice(&bytes).map_err(|e| wrong(format!("is no whole scan: {e}")))?;
        let total: u128 = body.sizes.iter().map(|&[run, _]| u128::from(run)).sum();
        let in_order =
            body.files.is_sorted_by(|a, b| a.first <= b.first) && body.files.first().is_some_and(|f| f.first == 0);
        let last = body.files.last().map_or(0, |file| file.first);
        let most = body.sizes.iter().map(|size| size[1]).max().unwrap_or(0);
        if !in_order || u128::from(last) > total || total > 1 << 62 || most > MOST {
            return Err(wrong("has files whose realizations cannot be".into()));
        }
        Ok(Some((path, Self { head, body })))
    }

    /// A request of its files in its place, as they were when they were scanned, by the settings that they were read by; with what was read and
    /// what was remarked then.
    pub(super) fn of_its_files(self, path: &Path, request: &PointsRequest) -> Result<(PointsRequest, Remarked)> {
        let mut request = self.head.completed(path, request)?;
        for file in &self.body.files {
            file.stamp.check(&file.path)?;
        }
        request.files = self.body.files.into_iter().map(|file| file.path).collect();
        let Body { subject, input, warnings, .. } = self.body;
        Ok((request, Remarked { subject, input, warnings }))
    }

    fn points(self, path: &Path, request: &PointsRequest) -> Result<Points> {
        let (completed, asked) = (of_points(&self.head.completed(path, request)?), of_points(request));
        if let Some(row) = reading().find(|row| completed.value(row.setting) != asked.value(row.setting)) {
            let there = completed.value(row.setting);
            let reason = format!("{} was read with {there}; expected that", path.display());
            return Err(Error::setting(row.setting, "(none)", reason));
        }
        let shape = self.shape();
        let Body { subject, domain, sizes, identity, classes, weights, intensity, input, warnings, files: all } =
            self.body;
        let (columns, options) =
            (columns(request, false)?, ReadOptions { dim: dim_of_flags(request), raw: request.raw });
        let marked = request.weight_column.is_some() || request.intensity_column.is_some();
        let numbers = classes.iter().cloned().zip(0..).collect();
        let marks = Marking {
            wrap: request.wrap,
            largest: marked.then_some(weights.largest),
            inverse: request.intensity_column.is_some(),
            classes: request.class_column.is_some().then_some(numbers),
        };
        let ends = all.iter().skip(1).map(|next| next.first).chain([shape.realizations]).collect::<Vec<_>>();
        let (mut files, mut stamps) = (Vec::new(), Vec::new());
        for (file, end) in all.into_iter().zip(ends) {
            // Of one realization there are no rows to be read apart.
            let one = end - file.first <= 1;
            let open = if one { PointFile::Whole(file.path) } else { PointFile::open(file.path, &options, &columns) };
            files.push((file.first, open));
            stamps.push(file.stamp);
        }
        Ok(Points {
            simulations: None,
            intensity: intensity.map(Intensity::of_elsewhere),
            subject,
            domain,
            shape,
            identity,
            prefixes: Vec::new(),
            fewest: sizes.iter().map(|size| size[1]).min().unwrap_or(0),
            sizes,
            classes,
            weights,
            input,
            warnings,
            kind: Kind::Files(Files { files, stamps, options, columns, marks, last: Mutex::default() }),
        })
    }
}

/// What a scan says of its files, beside how they are read.
pub(super) struct Remarked {
    pub(super) subject: String,
    pub(super) input: Option<Input>,
    pub(super) warnings: Vec<String>,
}

impl Head {
    /// The head of a file, if it is a scan, and what is behind it.
    fn read(path: &Path) -> Result<Option<(Self, BufReader<File>)>> {
        // Of a pipe nothing may be read that its reader would miss.
        let Some(mut file) = path.is_file().then(|| File::open(path).ok()).flatten().map(BufReader::new) else {
            return Ok(None);
        };
        let mut line = vec![0; SCAN.len()];
        if file.read_exact(&mut line).is_err() || line != SCAN.as_bytes() {
            return Ok(None);
        }
        file.read_until(b'\n', &mut line).map_err(|e| Error::file(path, e))?;
        let wrong = |reason: String| Error::input(path.display().to_string(), reason);
        let head: Self = serde_json::from_slice(&line).map_err(|e| wrong(format!("is no whole scan: {e}")))?;
        match head.pairwave_scan {
            VERSION => Ok(Some((head, file))),
            other => {
                Err(wrong(format!("is of version {other} of scans; this program reads version {VERSION}; scan again")))
            }
        }
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
}

impl Points {
    /// The points of a scan, where the only file of a request is one.
    pub(super) fn of_scan(request: &PointsRequest) -> Result<Option<Self>> {
        Scan::in_place_of(&request.files)?.map(|(path, scan)| scan.points(path, request)).transpose()
    }
}

/// The request itself, or, where its only file is a scan, with the settings by which the files of that were read.
///
/// # Errors
/// A scan that is damaged; settings by which its files were not read.
pub fn scanned(request: PointsRequest) -> Result<PointsRequest> {
    let [path] = request.files.as_slice() else { return Ok(request) };
    match Head::read(path)? {
        Some((head, _)) => head.completed(path, &request),
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

    /// Whether a file still is the one that it was. What is not there is said when it is read.
    pub(super) fn check(&self, path: &Path) -> Result<()> {
        if Self::of(path).is_ok_and(|now| now != *self) {
            let reason = format!(
                "is not the file that was scanned, of {} bytes; expected it as it was, or a new scan",
                self.bytes
            );
            return Err(Error::input(path.display().to_string(), reason));
        }
        Ok(())
    }
}

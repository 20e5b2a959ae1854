//! What the worker does, without its thread: keeps a measurement per set, takes one step of one of them at a time.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use pairwave::analysis::{Analysis, Measurement, Status};
use pairwave::compute::Device;
use pairwave::control::Control;
use pairwave::convergence::{Climb, Convergence};
use pairwave::points::Ensemble;
use pairwave::request::{DeviceChoice, PointsRequest, Request};
use pairwave::{Error, Result, Setting};

use crate::controls;

/// Estimates are made at most this often per set while sums come in: more often than anyone can see costs only time.
pub const PACE: Duration = Duration::from_millis(100);

/// Which set a request is of.
pub type SetId = u32;

/// What is known of a set.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// What was asked for when this was made.
    pub request: Request,
    /// Estimates of the realizations so far.
    pub analysis: Option<Arc<Analysis>>,
    /// The realization whose points are drawn, where another than the first was chosen.
    pub points: Option<Arc<Ensemble>>,
    /// How far it is, and what it was spared.
    pub status: Option<Status>,
    /// Whether all realizations are in.
    pub done: bool,
    /// Why it stopped, if it did.
    pub error: Option<String>,
    /// The setting that is to blame.
    pub setting: Option<Setting>,
    /// What computed, or will, and why no GPU does.
    pub device: String,
    /// Counts the snapshots of all sets: pictures of an older one are stale.
    pub generation: u64,
    /// Variances of integrals at fewer points, where they are looked at.
    pub climb: Option<Climbed>,
}

/// How far variances against the number of points are.
#[derive(Debug, Clone, Default)]
pub struct Climbed {
    /// What is found so far.
    pub found: Option<Arc<Convergence>>,
    /// Numbers of points that are measured, and all of them.
    pub progress: (u64, u64),
    /// Why there are no more of them.
    pub error: Option<String>,
}

impl Climbed {
    /// Whether nothing is left to measure.
    pub fn is_done(&self) -> bool {
        self.error.is_some() || self.found.is_some() && self.progress.0 == self.progress.1
    }
}

/// Measurements under way.
pub struct Engine {
    /// Time between two estimates of a set.
    pub pace: Duration,
    jobs: BTreeMap<SetId, Task>,
    /// Sets that wait, with what they have.
    held: BTreeSet<SetId>,
    /// Sets whose variances at fewer points are wanted.
    climbs: BTreeSet<SetId>,
    devices: Vec<Opened>,
    /// The set that the last step was of.
    last: SetId,
    generation: u64,
}

struct Opened {
    of: (DeviceChoice, Option<usize>),
    device: Arc<Device>,
}

struct Task {
    request: Request,
    /// Not planned yet.
    changed: bool,
    measurement: Option<Measurement>,
    device: Option<Arc<Device>>,
    shown: Option<Instant>,
    /// The realization that is to be drawn, and that of `points`.
    chosen: u64,
    points: Option<Arc<Ensemble>>,
    /// Variances at fewer points: their measurement, and what was given out of it.
    climb: Option<Climb>,
    climbed: Option<Climbed>,
    /// What was given out last.
    last: Option<Snapshot>,
    /// Nothing is left to do, or it failed.
    idle: bool,
}

impl Task {
    /// Whether the realization that was chosen is not there yet.
    fn looks(&self) -> bool {
        let there = self.points.as_ref().map_or(0, |points| points.first_index());
        self.chosen != there && !self.changed && self.last.is_some() && self.measurement.is_some()
    }

    /// Whether there are numbers of points to measure, once all realizations are in.
    fn has_to_climb(&self) -> bool {
        let may = self.idle && self.last.as_ref().is_some_and(|last| last.done);
        may && !self.climbed.as_ref().is_some_and(Climbed::is_done)
    }

    /// Measures at one more number of points.
    fn climb(&mut self, control: &Control) -> Result<()> {
        let Some(device) = &self.device else { return Ok(()) };
        let climb = match &mut self.climb {
            Some(climb) => climb,
            none => match Climb::below(&self.request, control).transpose()? {
                Some(climb) => none.insert(climb),
                None => {
                    let error = Some("only samplers make points of other numbers".to_string());
                    self.climbed = Some(Climbed { error, ..Climbed::default() });
                    return Ok(());
                }
            },
        };
        climb.advance(device, control, &mut |_| ())?;
        let found = Some(Arc::new(climb.found()));
        self.climbed = Some(Climbed { found, progress: climb.progress(), error: None });
        Ok(())
    }
}

impl Default for Engine {
    fn default() -> Self {
        Self {
            pace: PACE,
            jobs: BTreeMap::new(),
            held: BTreeSet::new(),
            climbs: BTreeSet::new(),
            devices: Vec::new(),
            last: 0,
            generation: 0,
        }
    }
}

impl Engine {
    /// Asks for a set, or for other settings of it.
    pub fn set(&mut self, id: SetId, request: Request) {
        let job = self.jobs.entry(id).or_insert_with(|| Task {
            request: request.clone(),
            changed: true,
            measurement: None,
            device: None,
            shown: None,
            chosen: 0,
            points: None,
            climb: None,
            climbed: None,
            last: None,
            idle: false,
        });
        let of_one = |points: &PointsRequest| PointsRequest { realizations: None, ..points.clone() };
        if of_one(&job.request.input) != of_one(&request.input) {
            job.points = None;
        }
        // Which statistics are shown beside is nothing to them.
        if job.request.only(&[]) != request.only(&[]) {
            (job.climb, job.climbed) = (None, None);
        }
        (job.request, job.changed, job.idle, job.shown) = (request, true, false, None);
    }

    /// Forgets a set.
    pub fn remove(&mut self, id: SetId) {
        self.jobs.remove(&id);
        self.held.remove(&id);
        self.climbs.remove(&id);
    }

    /// Leaves a set as it is, or goes on with it.
    pub fn hold(&mut self, id: SetId, held: bool) {
        if held {
            self.held.insert(id);
        } else {
            self.held.remove(&id);
        }
    }

    /// Has variances of integrals measured at fewer points too, once all realizations are in, or no longer.
    pub fn climb(&mut self, id: SetId, climbs: bool) {
        if climbs {
            self.climbs.insert(id);
        } else {
            self.climbs.remove(&id);
        }
    }

    /// Chooses the realization whose points are drawn.
    pub fn look(&mut self, id: SetId, realization: u64) {
        if let Some(job) = self.jobs.get_mut(&id) {
            job.chosen = realization;
        }
    }

    /// Whether there is anything to measure.
    pub fn is_idle(&self) -> bool {
        self.next().is_none()
    }

    /// A set of which another realization is to be drawn.
    pub fn looking(&self) -> Option<SetId> {
        self.jobs.iter().find(|(_, job)| job.looks()).map(|(&id, _)| id)
    }

    /// Draws or reads that realization, and nothing else. What there is to show of the set then.
    pub fn fetch(&mut self, control: &Control) -> Option<(SetId, Snapshot)> {
        let id = self.looking()?;
        let job = self.jobs.get_mut(&id)?;
        let (Some(measurement), Some(device)) = (&job.measurement, &job.device) else { return None };
        job.chosen = job.chosen.min(measurement.total().saturating_sub(1));
        job.points = None;
        let mut failed = None;
        if job.chosen > 0 {
            match measurement.realization(job.chosen, device, control) {
                Ok(points) => job.points = Some(Arc::new(points)),
                Err(Error::Cancelled) => return None,
                Err(error) => {
                    job.chosen = 0;
                    failed = Some(error.told(controls::title));
                }
            }
        }
        let last = job.last.as_mut()?;
        last.points = job.points.clone();
        last.error = failed.or_else(|| last.error.clone());
        Some((id, last.clone()))
    }

    /// The set whose turn it is.
    pub fn next(&self) -> Option<SetId> {
        let free = |(id, job): &(&SetId, &Task)| {
            let has_work = !job.idle || self.climbs.contains(*id) && job.has_to_climb();
            has_work && !self.held.contains(*id)
        };
        let busy = || self.jobs.iter().filter(free).map(|(&id, _)| id);
        busy().find(|&id| id > self.last).or_else(|| busy().next())
    }

    /// What is asked of a set.
    pub fn request(&self, id: SetId) -> Option<&Request> {
        self.jobs.get(&id).map(|job| &job.request)
    }

    /// What there is to show of a set whose step did not come back.
    pub fn failed(&mut self, id: SetId, request: Request) -> (SetId, Snapshot) {
        self.jobs.remove(&id);
        self.generation += 1;
        let error = "an internal error stopped this set: a bug of pairwave; other settings start it again".to_string();
        let (generation, device) = (self.generation, String::new());
        let (analysis, status, setting) = (None, None, None);
        let (done, error, points) = (false, Some(error), None);
        (id, Snapshot { request, analysis, points, status, done, error, setting, device, generation, climb: None })
    }

    /// One step of the set whose turn it is. What there is to show of it, when it is time to.
    pub fn step(&mut self, control: &Control) -> Option<(SetId, Snapshot)> {
        let id = self.next()?;
        self.last = id;
        let mut job = self.jobs.remove(&id)?;
        if job.idle {
            let climbed = job.climb(control);
            let cancelled = matches!(climbed, Err(Error::Cancelled));
            if let (Err(error), false) = (climbed, cancelled) {
                let before = job.climbed.take().unwrap_or_default();
                job.climbed = Some(Climbed { error: Some(error.told(controls::title)), ..before });
            }
            if let Some(last) = &mut job.last {
                last.climb = job.climbed.clone();
            }
            let snapshot = job.last.clone().filter(|_| !cancelled);
            self.jobs.insert(id, job);
            return snapshot.map(|s| (id, s));
        }
        // The one place that waits; in a window it is on the worker's thread.
        let more = pollster::block_on(self.step_of(&mut job, control));
        let ended = !matches!(more, Ok(true));
        let cancelled = matches!(more, Err(Error::Cancelled));
        job.idle = ended && !cancelled;
        let due = job.shown.is_none_or(|at| at.elapsed() >= self.pace);
        let snapshot = (!cancelled && (ended || due)).then(|| {
            self.generation += 1;
            job.shown = Some(Instant::now());
            let measurement = job.measurement.as_ref();
            let analysis = measurement.and_then(Measurement::analysis).map(Arc::new);
            // A device that failed on the way has others finish its work.
            let device = job.device.as_ref().map(|device| {
                let by = analysis.as_ref().map_or_else(|| device.computed_by(), |a| a.computed_by.clone()).device();
                device.note().map_or(by.clone(), |note| format!("{by} ({note})"))
            });
            Snapshot {
                request: job.request.clone(),
                analysis,
                points: job.points.clone(),
                status: measurement.map(Measurement::status),
                done: matches!(more, Ok(false)),
                error: more.as_ref().err().map(|e| e.told(controls::title)),
                setting: match more {
                    Err(Error::Setting { setting, .. }) => Some(setting),
                    _ => None,
                },
                device: device.unwrap_or_default(),
                generation: self.generation,
                climb: job.climbed.clone(),
            }
        });
        if snapshot.is_some() {
            job.last = snapshot.clone();
        }
        self.jobs.insert(id, job);
        snapshot.map(|s| (id, s))
    }

    async fn step_of(&mut self, job: &mut Task, control: &Control) -> Result<bool> {
        if job.changed {
            job.changed = false;
            let device = match self.device(&job.request).await {
                Ok(found) => found,
                Err(error) => {
                    job.measurement = None;
                    return Err(error);
                }
            };
            job.device = Some(device.clone());
            let planned = match &mut job.measurement {
                Some(measurement) => measurement.change(&job.request, &device),
                None => Measurement::live(&job.request, &device).map(|new| job.measurement = Some(new)),
            };
            if let Err(error) = planned {
                // What was measured under other settings is not what is asked for.
                job.measurement = None;
                return Err(error);
            }
        }
        match (&mut job.measurement, &job.device) {
            (Some(measurement), Some(device)) => measurement.advance(device, control, &mut |_| ()).await,
            _ => Ok(false),
        }
    }

    /// Devices are opened once.
    async fn device(&mut self, request: &Request) -> Result<Arc<Device>> {
        let of = (request.device, request.threads);
        if let Some(known) = self.devices.iter().find(|d| d.of == of) {
            return Ok(known.device.clone());
        }
        let device = Arc::new(Device::open(request.device, request.threads).await?);
        self.devices.push(Opened { of, device: device.clone() });
        Ok(device)
    }
}

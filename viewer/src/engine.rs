//! What the worker does, without its thread: keeps a measurement per set, takes one step of one of them at a time.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use pairwave::analysis::{Analysis, Running, Status};
use pairwave::compute::Compute;
use pairwave::control::Control;
use pairwave::request::DeviceChoice;
use pairwave::request::Request;
use pairwave::{Error, Result, Setting};

/// Estimates are made at most this often per set while sums come in: more often than anyone can see costs only time.
const SHOW: Duration = Duration::from_millis(100);

/// Which set a request is of.
pub type SetId = u32;

/// What is known of a set.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// What was asked for when this was made.
    pub request: Request,
    /// Estimates of the realizations so far.
    pub analysis: Option<Arc<Analysis>>,
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
}

/// Measurements under way.
#[derive(Default)]
pub struct Engine {
    jobs: BTreeMap<SetId, Job>,
    /// Sets that wait, with what they have.
    held: BTreeSet<SetId>,
    devices: Vec<Device>,
    /// The set that the last step was of.
    last: SetId,
    generation: u64,
}

struct Device {
    of: (DeviceChoice, Option<usize>),
    compute: Arc<dyn Compute>,
    /// Why it is this one, if that needs a word.
    note: Option<String>,
}

struct Job {
    request: Request,
    /// Not planned yet.
    changed: bool,
    running: Option<Running>,
    device: Option<(Arc<dyn Compute>, Option<String>)>,
    shown: Option<Instant>,
    /// Nothing is left to do, or it failed.
    idle: bool,
}

impl Engine {
    /// Asks for a set, or for other settings of it.
    pub fn set(&mut self, id: SetId, request: Request) {
        let job = self.jobs.entry(id).or_insert_with(|| Job {
            request: request.clone(),
            changed: true,
            running: None,
            device: None,
            shown: None,
            idle: false,
        });
        (job.request, job.changed, job.idle) = (request, true, false);
    }

    /// Forgets a set.
    pub fn remove(&mut self, id: SetId) {
        self.jobs.remove(&id);
        self.held.remove(&id);
    }

    /// Leaves a set as it is, or goes on with it.
    pub fn hold(&mut self, id: SetId, held: bool) {
        if held {
            self.held.insert(id);
        } else {
            self.held.remove(&id);
        }
    }

    /// Whether there is anything to do.
    pub fn is_idle(&self) -> bool {
        self.next().is_none()
    }

    /// The set whose turn it is.
    pub fn next(&self) -> Option<SetId> {
        let busy = || self.jobs.iter().filter(|(id, job)| !job.idle && !self.held.contains(id)).map(|(&id, _)| id);
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
        (id, Snapshot { request, analysis, status, done: false, error: Some(error), setting, device, generation })
    }

    /// One step of the set whose turn it is. What there is to show of it, when it is time to.
    pub fn step(&mut self, control: &Control) -> Option<(SetId, Snapshot)> {
        let id = self.next()?;
        self.last = id;
        let mut job = self.jobs.remove(&id)?;
        let more = self.step_of(&mut job, control);
        let ended = !matches!(more, Ok(true));
        let cancelled = matches!(more, Err(Error::Cancelled));
        job.idle = ended && !cancelled;
        let due = job.shown.is_none_or(|at| at.elapsed() >= SHOW);
        let snapshot = (!cancelled && (ended || due)).then(|| {
            self.generation += 1;
            job.shown = Some(Instant::now());
            let running = job.running.as_ref();
            let analysis = running.and_then(Running::analysis).map(Arc::new);
            // A device that failed on the way has others finish its work.
            let device = job.device.as_ref().map(|(compute, note)| {
                let by = analysis.as_ref().map_or_else(|| compute.computed_by(), |a| a.computed_by.clone()).device();
                note.as_ref().map_or(by.clone(), |note| format!("{by} ({note})"))
            });
            Snapshot {
                request: job.request.clone(),
                analysis,
                status: running.map(Running::status),
                done: matches!(more, Ok(false)),
                error: more.as_ref().err().map(|e| e.told(Setting::flag)),
                setting: match more {
                    Err(Error::Setting { setting, .. }) => Some(setting),
                    _ => None,
                },
                device: device.unwrap_or_default(),
                generation: self.generation,
            }
        });
        self.jobs.insert(id, job);
        snapshot.map(|s| (id, s))
    }

    fn step_of(&mut self, job: &mut Job, control: &Control) -> Result<bool> {
        if job.changed {
            job.changed = false;
            let (compute, note) = match self.device(&job.request) {
                Ok(found) => found,
                Err(error) => {
                    job.running = None;
                    return Err(error);
                }
            };
            job.device = Some((compute.clone(), note));
            let planned = match &mut job.running {
                Some(running) => running.change(job.request.clone(), compute.as_ref()),
                None => Running::new(job.request.clone(), compute.as_ref()).map(|new| job.running = Some(new)),
            };
            if let Err(error) = planned {
                // What was measured under other settings is not what is asked for.
                job.running = None;
                return Err(error);
            }
        }
        match (&mut job.running, &job.device) {
            (Some(running), Some((compute, _))) => running.step(compute.as_ref(), control),
            _ => Ok(false),
        }
    }

    /// Devices are opened once.
    fn device(&mut self, request: &Request) -> Result<(Arc<dyn Compute>, Option<String>)> {
        let of = (request.device, request.threads);
        if let Some(known) = self.devices.iter().find(|d| d.of == of) {
            return Ok((known.compute.clone(), known.note.clone()));
        }
        let opened = pollster::block_on(pairwave::compute::open(request.device, request.threads))?;
        let compute: Arc<dyn Compute> = opened.compute.into();
        self.devices.push(Device { of, compute: compute.clone(), note: opened.note.clone() });
        Ok((compute, opened.note))
    }
}

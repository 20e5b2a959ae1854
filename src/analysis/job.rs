//! A measurement carried out to its end, or as far as it comes: what is done is kept on the way.

use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{Analysis, Measurement, Plan};
use crate::compute::Device;
use crate::control::{Control, Instant, Known, Progress};
use crate::error::{Error, Result, plural};
use crate::input;
use crate::plan::LEAF;
use crate::report::SUMS;
use crate::setting::Setting;
use crate::stage;
use crate::statistics::measured::median_error;
use crate::statistics::targets::{Standing, Standings, Target, look_from, next_look};

/// When a run leaves its sums behind, and when it ends before its end.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Job {
    /// Where its sums go on the way, and how often.
    pub checkpoint: Option<(PathBuf, Duration)>,
    /// How long it goes on.
    pub time_limit: Option<Duration>,
    /// Numbers that are to be known to an error: it ends when all of them are.
    pub until: Vec<Target>,
}

/// How measuring ended.
#[derive(Debug)]
pub enum Ended {
    /// All realizations are measured.
    Whole,
    /// The time was up.
    Late,
    /// Something went wrong, or the user stopped it. The measurement holds what was done before.
    Failed(Error),
}

impl Job {
    /// Whether it can be done with a measurement, asked before the long work.
    ///
    /// # Errors
    /// What needs all realizations at once, or a part of them, together with `until_error`.
    pub fn check(&self, measurement: &Measurement) -> Result<()> {
        let Some(first) = self.until.first() else { return Ok(()) };
        let refuse = |reason: String| Err(Error::setting(Setting::UntilError, first, reason));
        match measurement.needs_all() {
            Some(what) => refuse(format!("{what} needs all realizations at once, and the run may end before")),
            None if measurement.is_part() => {
                refuse("looks at all realizations so far, and a part has only its own".into())
            }
            None => Ok(()),
        }
    }

    /// Measures what is left. However it ends, all groups of sums hold the same realizations.
    pub fn measure(
        &self,
        measurement: &mut Measurement,
        device: &Device,
        control: &Control,
        progress: &mut dyn FnMut(Progress),
    ) -> Ended {
        let start = Instant::now();
        let mut saved = start;
        let mut watch = Watch::new(measurement.realizations(), self.until.is_empty());
        loop {
            measurement.pause_at(watch.look);
            let mut tell = |told| progress(watch.told(told));
            match crate::control::wait(measurement.advance(device, control, &mut tell)) {
                Ok(true) => {}
                Ok(false) => match watch.look(measurement, &self.until) {
                    Ok(true) => return Ended::Whole,
                    Ok(false) if measurement.is_done() => return Ended::Whole,
                    Ok(false) => continue,
                    Err(error) => return Ended::Failed(error),
                },
                Err(error) => {
                    measurement.give_up_round();
                    return Ended::Failed(error);
                }
            }
            if !measurement.is_even() || measurement.is_done() {
                continue;
            }
            if let Err(error) = watch.find(measurement, &self.until) {
                return Ended::Failed(error);
            }
            if self.time_limit.is_some_and(|limit| start.elapsed() >= limit) {
                return Ended::Late;
            }
            let due = self.checkpoint.as_ref().filter(|(_, every)| saved.elapsed() >= *every);
            if let Some((dir, _)) = due {
                // A disk that is full now may not be later: the run goes on, and says so.
                if let Err(error) = measurement.save(dir) {
                    measurement.note(format!("a checkpoint could not be written: {error}"));
                }
                saved = Instant::now();
            }
            if self.until.is_empty() {
                watch.glance(measurement);
            }
        }
    }
}

/// How well what is measured is known on the way.
struct Watch {
    /// Where it is looked at whether the run can end.
    look: u64,
    looks: u64,
    /// Whether the numbers that are waited for were looked for.
    found: bool,
    known: Option<Known>,
    /// The part of the run after which it is likely to end.
    part: f64,
    /// When its error was last looked at to be told, and what that took, in seconds.
    glanced: Instant,
    took: f64,
}

impl Watch {
    fn new(held: u64, without: bool) -> Self {
        let (look, looks) = if without { (u64::MAX, 0) } else { look_from(held) };
        Self { look, looks, found: false, known: None, part: 1.0, glanced: Instant::now(), took: 0.0 }
    }

    fn told(&self, progress: Progress) -> Progress {
        Progress { known: self.known, ..progress.ending_after(self.part) }
    }

    /// Whether there are the numbers that are waited for, asked once and early.
    fn find(&mut self, measurement: &Measurement, until: &[Target]) -> Result<()> {
        if std::mem::replace(&mut self.found, true) || until.is_empty() {
            return Ok(());
        }
        measurement.estimates().map_or(Ok(()), |found| standings(&found, until, 0).map(drop))
    }

    /// Looks whether every target is reached.
    fn look(&mut self, measurement: &mut Measurement, until: &[Target]) -> Result<bool> {
        if until.is_empty() {
            return Ok(false);
        }
        let Some(found) = measurement.estimates() else { return Ok(false) };
        self.looks += 1;
        let standings = standings(&found, until, self.looks)?;
        let reached = standings.iter().all(|standing| standing.reached);
        let worst = standings.iter().filter_map(|standing| standing.ratio()).fold(0.0, f64::max);
        let (held, total) = (measurement.realizations(), measurement.total());
        self.known = (worst > 0.0).then_some(Known::OfTarget(worst));
        self.part = (held as f64 * worst * worst / total as f64).clamp(held as f64 / total as f64, 1.0);
        if worst == 0.0 {
            self.part = 1.0;
        }
        self.look = next_look(self.look);
        measurement.stand(Standings(standings));
        Ok(reached)
    }

    /// Looks at the present error now and then, where estimates are quick beside the measuring.
    fn glance(&mut self, measurement: &Measurement) {
        const LEAST: f64 = 1.0;
        const SHARE: f64 = 0.02;
        /// Bytes of sums whose estimates take no time to speak of.
        const SMALL: u128 = 64 << 20;
        if measurement.memory() > SMALL || self.glanced.elapsed().as_secs_f64() < (self.took / SHARE).max(LEAST) {
            return;
        }
        let start = Instant::now();
        let found = measurement.estimates();
        self.known = found.and_then(|found| median_error(&found)).map(|(of, error)| Known::Median(of, error));
        (self.glanced, self.took) = (Instant::now(), start.elapsed().as_secs_f64());
    }
}

/// How targets stand, or which of them there is not.
fn standings(found: &Analysis, until: &[Target], looks: u64) -> Result<Vec<Standing>> {
    let of =
        |target: &Target| target.standing(found, looks).map_err(|why| Error::setting(Setting::UntilError, target, why));
    until.iter().map(of).collect()
}

impl Measurement {
    /// `512 of 1024 realizations`.
    pub fn held(&self) -> String {
        format!("{} of {}", self.realizations(), plural(self.total(), "realization"))
    }

    /// The part `shard` (from 1) of `of` parts of about the same number of realizations, to be measured by itself and merged.
    ///
    /// # Errors
    /// A part that cannot be; what needs all realizations at once.
    pub fn shard(self, shard: u64, of: u64, device: &Device) -> Result<Self> {
        let refuse = |reason: String| Err(Error::setting(Setting::Shard, format!("{shard}/{of}"), reason));
        if let Some(what) = self.needs_all() {
            return refuse(format!(
                "{what} needs all realizations at once; expected it in the run that is not cut, or left out"
            ));
        }
        let leaves = self.total().div_ceil(LEAF);
        if shard == 0 || shard > of || of > leaves {
            return refuse(format!(
                "expected I/N with 1 <= I <= N <= {leaves}: {} are summed {LEAF} at a time",
                plural(self.total(), "realization")
            ));
        }
        let cut =
            |shard: u64| ((u128::from(leaves) * u128::from(shard) / u128::from(of)) as u64 * LEAF).min(self.total());
        let span = cut(shard - 1)..cut(shard);
        self.within(span, device)
    }

    /// Goes on where another measurement of the same kind ended.
    ///
    /// # Errors
    /// As `merge`; realizations that this one is not to have.
    pub fn resume(mut self, earlier: Self) -> Result<Self> {
        let span = self.span.clone();
        let beyond = |(run, _): (Range<u64>, u64)| match run.start < span.start {
            true => Some(run.start),
            false => (run.end > span.end).then(|| run.start.max(span.end)),
        };
        if let Some(out) = earlier.sizes.runs().find_map(beyond) {
            let reason =
                format!("holds realization {}; expected realizations {} to {} only", out + 1, span.start + 1, span.end);
            return Err(Error::input("the earlier run", reason));
        }
        self.merge(earlier)?;
        Ok(self.to(span))
    }

    /// Adds these realizations to those of an earlier measurement, by the plan that the earlier one was made by: numbers that follow from how
    /// many realizations there are (points that F is looked at from, windows that are counted in) stay what they were. Of files, the first
    /// realizations are those of the earlier one, in its order, and others come after them.
    ///
    /// # Errors
    /// As `resume`.
    pub fn extend(mut self, mut earlier: Self, device: &Device) -> Result<Self> {
        let (shape, lists) = (earlier.source.shape(), self.plan.lists.clone());
        if self.source.identity_of_first(shape.realizations).as_ref() == Some(earlier.source.identity()) {
            earlier.source = self.source.clone();
        }
        let planned = Plan::with(&self.request, self.source.domain(), shape, self.source.classes(), lists)?;
        self.plan = planned.for_device(device.compute());
        Self::new(self.request, self.source, self.plan).resume(earlier)
    }

    /// Writes its sums into a directory, whole or not at all.
    ///
    /// # Errors
    /// What the file system says; what was there before stays.
    pub fn save(&self, dir: &Path) -> Result<()> {
        let path = dir.join(SUMS);
        let written = fs::create_dir_all(dir).and_then(|()| {
            // Of a name of its own: another run may be writing here.
            let mut file = stage::file_within(dir)?;
            file.write_all(&self.write())?;
            file.as_file().sync_all()?;
            file.persist(&path).map_err(|e| e.error)
        });
        written.map(drop).map_err(|e| Error::file(path, e))
    }

    /// The sums in a directory, or in a file.
    ///
    /// # Errors
    /// What cannot be read, or is no file of sums.
    pub fn load(path: &Path) -> Result<Self> {
        let file = if path.is_dir() { path.join(SUMS) } else { path.to_path_buf() };
        if path.is_dir() && !file.exists() {
            let reason =
                format!("holds no {SUMS}; expected a directory that `shard`, `keep_sums` or an unfinished run left");
            return Err(Error::input(path.display().to_string(), reason));
        }
        Self::read(&file.display().to_string(), &input::read(&file)?)
    }
}

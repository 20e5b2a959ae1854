//! A measurement carried out to its end, or as far as it comes: what is done is kept on the way.

use std::path::PathBuf;
use std::time::Duration;

use super::{Analysis, Measurement};
use crate::compute::Device;
use crate::control::{Control, Instant, Known, Progress};
use crate::error::{Error, Result};
use crate::setting::Setting;
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
        let ended = self.carry_out(measurement, device, control, progress);
        measurement.give_up_round();
        ended
    }

    fn carry_out(
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
                Ok(false) => match watch.look(measurement, &self.until, control) {
                    Ok(true) => return Ended::Whole,
                    Ok(false) if measurement.is_done() => return Ended::Whole,
                    Ok(false) => continue,
                    Err(error) => return Ended::Failed(error),
                },
                Err(error) => return Ended::Failed(error),
            }
            if !measurement.is_even() || measurement.is_done() {
                continue;
            }
            if let Err(error) = watch.find(measurement, &self.until, control) {
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
            if self.until.is_empty()
                && let Err(error) = watch.glance(measurement, control)
            {
                return Ended::Failed(error);
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
    fn find(&mut self, measurement: &Measurement, until: &[Target], control: &Control) -> Result<()> {
        if std::mem::replace(&mut self.found, true) || until.is_empty() {
            return Ok(());
        }
        measurement.estimates(control)?.map_or(Ok(()), |found| standings(&found, until, 0).map(drop))
    }

    /// Looks whether every target is reached.
    fn look(&mut self, measurement: &mut Measurement, until: &[Target], control: &Control) -> Result<bool> {
        if until.is_empty() {
            return Ok(false);
        }
        let Some(found) = measurement.estimates(control)? else { return Ok(false) };
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
    fn glance(&mut self, measurement: &Measurement, control: &Control) -> Result<()> {
        const LEAST: f64 = 1.0;
        const SHARE: f64 = 0.02;
        /// Bytes of sums whose estimates take no time to speak of.
        const SMALL: u128 = 64 << 20;
        if measurement.memory() > SMALL || self.glanced.elapsed().as_secs_f64() < (self.took / SHARE).max(LEAST) {
            return Ok(());
        }
        let start = Instant::now();
        let found = measurement.estimates(control)?;
        self.known = found.and_then(|found| median_error(&found)).map(|(of, error)| Known::Median(of, error));
        (self.glanced, self.took) = (Instant::now(), start.elapsed().as_secs_f64());
        Ok(())
    }
}

/// How targets stand, or which of them there is not.
fn standings(found: &Analysis, until: &[Target], looks: u64) -> Result<Vec<Standing>> {
    let of =
        |target: &Target| target.standing(found, looks).map_err(|why| Error::setting(Setting::UntilError, target, why));
    until.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::cpu::Cpu;
    use crate::request::Request;

    /// What is stopped while the device measures is not estimated first, whatever is due then.
    #[test]
    fn estimates_on_the_way_hear_that_they_are_not_wanted() {
        let device = Device::new(Box::new(Cpu::new(Some(1)).unwrap()), None).unwrap();
        let mut request = Request { bins: Some(8), ..Request::default() };
        let input = &mut request.input;
        (input.sampler, input.points, input.realizations) = (Some("random".into()), Some(20), Some(4));
        let mut measurement = Measurement::of(&request).unwrap();
        let control = Control::default();
        while measurement.step(&device, &control).unwrap() {}
        let until = ["pcf@0.1:1".parse::<Target>().unwrap()];
        let watch = || Watch { glanced: Instant::now() - Duration::from_secs(9), ..Watch::new(0, false) };
        let mut heard = watch();
        heard.find(&measurement, &until, &control).unwrap();
        heard.look(&mut measurement, &until, &control).unwrap();
        heard.glance(&measurement, &control).unwrap();
        assert!(heard.looks == 1 && heard.known.is_some() && !measurement.standings().is_empty());
        measurement.stand(Standings(Vec::new()));
        control.cancel();
        let mut watch = watch();
        for heard in [
            watch.find(&measurement, &until, &control),
            watch.look(&mut measurement, &until, &control).map(drop),
            watch.glance(&measurement, &control),
        ] {
            assert!(matches!(heard, Err(Error::Cancelled)), "{heard:?}");
        }
        assert!(watch.looks == 0 && watch.known.is_none() && measurement.standings().is_empty());
        // What there is can be had all the same.
        assert_eq!(measurement.analysis().map(|found| found.shape.realizations), Some(4));
    }
}

//! How long work is stopped, told of and timed.

use std::sync::atomic::{AtomicBool, Ordering};

// That of the standard library panics in a browser.
pub(crate) use web_time::Instant;

use crate::error::{Error, Result};

/// Blocks the current thread until `work` is done. In a browser nobody may: there futures are awaited.
pub fn wait<T>(work: impl Future<Output = T>) -> T {
    pollster::block_on(work)
}

/// How a caller watches and stops long work. Shared between threads.
#[derive(Debug, Default)]
pub struct Control {
    cancelled: AtomicBool,
}

impl Control {
    /// Asks the work to stop at the next chance.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// `Err(Cancelled)` once `cancel` was called.
    ///
    /// # Errors
    /// `Error::Cancelled` once that was asked for.
    pub fn check(&self) -> Result<()> {
        if self.cancelled.load(Ordering::Relaxed) { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Realizations finished.
    pub done: u64,
    /// Of how many.
    pub total: u64,
}

/// Wall time per stage.
#[derive(Debug, Clone, Default)]
pub(crate) struct Clock {
    pub(crate) stages: Vec<(&'static str, f64)>,
}

impl Clock {
    pub(crate) fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.add(stage, start.elapsed().as_secs_f64());
        result
    }

    pub(crate) fn add(&mut self, stage: &'static str, seconds: f64) {
        match self.stages.iter_mut().find(|(name, _)| *name == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.stages.push((stage, seconds)),
        }
    }
}

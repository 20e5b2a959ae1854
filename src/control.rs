//! How long work is stopped, told of and timed.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

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
    cancelled: Arc<AtomicBool>,
    /// Of the work that this one is done for.
    above: Vec<Arc<AtomicBool>>,
    /// The part of the piece of work at hand that is done, in steps of 2^-40.
    share: AtomicU64,
    /// How many equal pieces it comes in, less 1: each of them is told of as a whole.
    more: AtomicU64,
    /// What was done: pairs, products, bytes.
    done: [AtomicU64; 3],
}

/// Work on pairs in bins and on power, as the CPU path counts it while it does it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Done {
    /// Pairs of points that were looked at.
    pub pairs: u64,
    /// Points times wave vectors; of a transform points times cells of a kernel, and its own additions.
    pub products: u64,
    /// Bytes of points, tables and grids that kernels read and wrote for it.
    pub bytes: u64,
}

/// Steps of a whole piece of work.
const WHOLE: f64 = (1u64 << 40) as f64;

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
        let is = |cancelled: &Arc<AtomicBool>| cancelled.load(Ordering::Relaxed);
        if is(&self.cancelled) || self.above.iter().any(is) { Err(Error::Cancelled) } else { Ok(()) }
    }

    /// Of work done beside this one: stops with it, can be stopped alone, and is told of apart.
    pub(crate) fn beside(&self) -> Self {
        Self { above: self.above.iter().chain([&self.cancelled]).cloned().collect(), ..Self::default() }
    }

    /// Begins a piece of work.
    pub(crate) fn begin(&self) {
        self.share.store(0, Ordering::Relaxed);
        self.in_pieces(1);
    }

    /// The piece of work at hand comes in so many equal pieces.
    pub(crate) fn in_pieces(&self, pieces: usize) {
        self.more.store(pieces.max(1) as u64 - 1, Ordering::Relaxed);
    }

    /// Another part of it is done. Told by whoever does the work, from any thread, some hundred times at least.
    pub(crate) fn advance(&self, part: f64) {
        let pieces = (self.more.load(Ordering::Relaxed) + 1) as f64;
        self.share.fetch_add((part * WHOLE / pieces) as u64, Ordering::Relaxed);
    }

    /// Counts work that was done, from any thread.
    pub(crate) fn did(&self, done: Done) {
        for (sum, more) in self.done.iter().zip([done.pairs, done.products, done.bytes]) {
            sum.fetch_add(more, Ordering::Relaxed);
        }
    }

    /// The work that was done so far.
    pub fn done(&self) -> Done {
        let [pairs, products, bytes] = [0, 1, 2].map(|k| self.done[k].load(Ordering::Relaxed));
        Done { pairs, products, bytes }
    }

    /// The part of it that is done, 0 to 1.
    pub fn share(&self) -> f64 {
        (self.share.load(Ordering::Relaxed) as f64 / WHOLE).min(1.0)
    }
}

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Realizations (or simulations) finished.
    pub done: u64,
    /// Of how many.
    pub total: u64,
    /// The part of the whole run that is done, 0 to 1, by what the plan says that its parts take.
    pub before: f64,
    /// And the part that the piece of work at hand is: see `Control::share`.
    pub piece: f64,
    /// Seconds of one thread that the plan takes for all of it.
    pub planned: f64,
    /// How well what is measured is known by now, if that was looked at.
    pub known: Option<Known>,
}

/// How well something is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Known {
    /// The median over a table of the standard error of a column.
    Median(&'static str, f64),
    /// The largest error of what is waited for, over what is asked for.
    OfTarget(f64),
}

impl Progress {
    /// Of a run that is this `part` of several one after the other, with `before` behind it, where `[done, total]` of them are done.
    pub(crate) fn as_part(self, part: f64, before: f64, [done, total]: [u64; 2]) -> Self {
        Self {
            done,
            total,
            before: before + part * self.before,
            piece: part * self.piece,
            planned: self.planned / part,
            ..self
        }
    }

    /// Of a run that is likely to end after a part of it.
    pub(crate) fn ending_after(self, part: f64) -> Self {
        Self {
            total: ((self.total as f64 * part).ceil() as u64).max(self.done),
            before: self.before / part,
            piece: self.piece / part,
            planned: self.planned * part,
            ..self
        }
    }

    /// The part of the whole run that is done.
    pub fn fraction(&self, control: &Control) -> f64 {
        (self.before + self.piece * control.share()).clamp(0.0, 1.0)
    }

    /// Seconds that are left after so many: by what was done in that time, and before anything was, by the plan.
    pub fn left(&self, control: &Control, elapsed: f64) -> f64 {
        match self.fraction(control) {
            done if done >= 0.01 => elapsed * (1.0 - done) / done,
            _ => (self.planned - elapsed).max(0.0),
        }
    }
}

/// Wall time per stage.
#[derive(Debug, Clone, Default)]
pub(crate) struct Clock {
    pub(crate) stages: Vec<(&'static str, f64)>,
}

impl Clock {
    pub(crate) fn add(&mut self, stage: &'static str, seconds: f64) {
        match self.stages.iter_mut().find(|(name, _)| *name == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.stages.push((stage, seconds)),
        }
    }
}

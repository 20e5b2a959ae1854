//! Points that are drawn or read while those before them are measured.

use std::ops::Range;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use crate::control::Control;
use crate::error::Result;
use crate::points::Ensemble;
use crate::pool::Pool;
use crate::source::Points;

/// Realizations of a range, on their way. Dropped, they are given up.
pub(super) struct Ahead {
    pub(super) range: Range<u64>,
    control: Arc<Control>,
    drawing: Option<JoinHandle<Result<Ensemble>>>,
}

impl Ahead {
    /// Begins to draw them; nothing where a platform has no threads.
    pub(super) fn begin(source: &Arc<Points>, range: Range<u64>, pool: &Pool, control: &Control) -> Option<Self> {
        let (source, pool, control) = (source.clone(), pool.clone(), Arc::new(control.beside()));
        let (of, watched) = (range.clone(), control.clone());
        let work = move || pool.install(|| source.batch(of, &watched));
        let drawing = std::thread::Builder::new().name("points".into()).spawn(work).ok()?;
        Some(Self { range, control, drawing: Some(drawing) })
    }

    /// Waits for them; nothing where drawing broke off, so that it is done again where it is heard.
    pub(super) fn points(mut self, control: &Control) -> Result<Option<Ensemble>> {
        let Some(drawing) = self.drawing.take() else { return Ok(None) };
        while !drawing.is_finished() {
            control.check()?;
            std::thread::sleep(Duration::from_micros(200));
        }
        Ok(drawing.join().ok().and_then(Result::ok))
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        self.control.cancel();
    }
}

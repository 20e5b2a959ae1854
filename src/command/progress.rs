//! Progress on stderr, and Ctrl-C. A request to end (TERM) and a lost terminal (HUP) are taken like Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pairwave::control::Control;
use pairwave::control::Progress;
use pairwave::{Error, Result};

/// Set while results are moved into place: that is soon over, and cutting it short would leave a stage behind.
static WRITING: AtomicBool = AtomicBool::new(false);

/// Runs `write` to its end, whatever the user types.
pub(crate) fn uninterrupted<T>(write: impl FnOnce() -> T) -> T {
    WRITING.store(true, Ordering::SeqCst);
    let result = write();
    WRITING.store(false, Ordering::SeqCst);
    result
}

/// A control that Ctrl-C cancels; a second Ctrl-C ends the program at once.
pub(crate) fn stop_on_interrupt() -> Result<Arc<Control>> {
    let control = Arc::new(Control::default());
    let watched = Arc::clone(&control);
    let handler = move || {
        if watched.check().is_err() && !WRITING.load(Ordering::SeqCst) {
            std::process::exit(130);
        }
        watched.cancel();
    };
    ctrlc::set_handler(handler).map_err(|e| Error::file("signal handler", std::io::Error::other(e)))?;
    Ok(control)
}

/// A progress bar over realizations that also says what is being done.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    pub(crate) fn new(quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        let template = "{spinner} {wide_bar} {pos}/{len} realizations, {msg}, {elapsed} (about {eta} left)";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    pub(crate) fn show(&self, progress: Progress) {
        self.0.set_length(progress.total);
        self.0.set_position(progress.done);
        self.0.set_message(progress.stage);
    }

    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

//! Progress on stderr, and Ctrl-C. A request to end (TERM) and a lost terminal (HUP) are taken like Ctrl-C.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use pairwave::control::{Control, Known, Progress};
use pairwave::{Error, Result};

/// Set while results are moved into place: that is soon over, and cutting it short would leave a stage behind.
static WRITING: AtomicBool = AtomicBool::new(false);

/// Set once what was done before the end is made a result: only a second Ctrl-C cuts that short.
static KEEPING: AtomicBool = AtomicBool::new(false);

/// From now on there is time.
pub(crate) fn unhurried() {
    KEEPING.store(true, Ordering::SeqCst);
}

/// Runs `write` to its end, whatever the user types.
pub(crate) fn uninterrupted<T>(write: impl FnOnce() -> T) -> T {
    WRITING.store(true, Ordering::SeqCst);
    let result = write();
    WRITING.store(false, Ordering::SeqCst);
    result
}

/// How long work has to end by itself once that was asked for. Some does not look: an integral that is looked for, a file of many
/// points.
const GRACE: Duration = Duration::from_secs(2);

/// A control that Ctrl-C cancels; a second Ctrl-C ends the program at once, and so does time.
pub(crate) fn stop_on_interrupt() -> Result<Arc<Control>> {
    let control = Arc::new(Control::default());
    let watched = Arc::clone(&control);
    let handler = move || {
        if watched.check().is_err() && !WRITING.load(Ordering::SeqCst) {
            std::process::exit(130);
        }
        watched.cancel();
        // Without the thread the second Ctrl-C is left.
        let _ = std::thread::Builder::new().name("cancelled".into()).spawn(|| {
            std::thread::sleep(GRACE);
            while WRITING.load(Ordering::SeqCst) || KEEPING.load(Ordering::SeqCst) {
                std::thread::sleep(Duration::from_millis(10));
            }
            super::tell(&format!("error: {}", Error::Cancelled));
            std::process::exit(130);
        });
    };
    ctrlc::set_handler(handler).map_err(|e| Error::file("signal handler", std::io::Error::other(e)))?;
    Ok(control)
}

/// How progress is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub(crate) enum Tell {
    /// A bar on a terminal, else a line each half minute.
    #[default]
    Auto,
    /// A line of JSON each second: stage, done, total, fraction, elapsed_s, left_s, realizations_per_s, error_of, error.
    Json,
    /// Nothing.
    None,
}

/// A progress bar over all of the work that says what is being done, and how long the rest will take; where standard error is
/// no terminal, a line each half minute.
pub(crate) struct Bar {
    bar: ProgressBar,
    control: Arc<Control>,
    now: Arc<Mutex<Option<Progress>>>,
}

/// Steps of the bar.
const STEPS: u64 = 1000;

/// How often a line is printed where there is no terminal.
const LINE: Duration = Duration::from_secs(30);

/// How often a line of JSON is.
const JSON_LINE: Duration = Duration::from_secs(1);

impl Bar {
    pub(crate) fn new(quiet: bool, control: &Arc<Control>) -> Self {
        Self::told(if quiet { Tell::None } else { Tell::Auto }, control)
    }

    pub(crate) fn told(how: Tell, control: &Arc<Control>) -> Self {
        let target = if how == Tell::Auto { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(STEPS), target);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {wide_bar} {percent} %, {msg}") {
            bar.set_style(style);
        }
        let now = Arc::new(Mutex::new(None));
        let watched = (bar.downgrade(), Arc::clone(control), Arc::downgrade(&now));
        let hidden = bar.is_hidden();
        let every = if how == Tell::Json { JSON_LINE } else { LINE };
        // A run without these lines is a run all the same.
        let _ = std::thread::Builder::new().name("progress".into()).spawn(move || {
            let (bar, control, now) = watched;
            let start = Instant::now();
            let mut said = start;
            loop {
                std::thread::sleep(Duration::from_millis(100));
                let (Some(bar), Some(now)) = (bar.upgrade(), now.upgrade()) else { return };
                let now = *now.lock().unwrap_or_else(PoisonError::into_inner);
                let Some(now) = now else { continue };
                let told = Told::new(now, &control, start.elapsed().as_secs_f64());
                if !hidden {
                    bar.set_position((told.fraction * STEPS as f64) as u64);
                    bar.set_message(told.words());
                } else if how != Tell::None && said.elapsed() >= every {
                    said = Instant::now();
                    super::tell(&match how {
                        Tell::Json => serde_json::json!(told).to_string(),
                        _ => format!("{:.0} %, {}", 100.0 * told.fraction, told.words()),
                    });
                }
            }
        });
        Self { bar, control: Arc::clone(control), now }
    }

    pub(crate) fn show(&self, progress: Progress) {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
        self.bar.set_position((progress.fraction(&self.control) * STEPS as f64) as u64);
    }

    pub(crate) fn finish(&self) {
        *self.now.lock().unwrap_or_else(PoisonError::into_inner) = None;
        self.bar.finish_and_clear();
    }
}

/// What is told of a run at one moment.
#[derive(serde::Serialize)]
struct Told {
    stage: &'static str,
    done: u64,
    total: u64,
    fraction: f64,
    elapsed_s: f64,
    left_s: f64,
    realizations_per_s: f64,
    /// What `error` is the median standard error of; null where it is an error over what is asked for.
    error_of: Option<&'static str>,
    error: Option<f64>,
}

impl Told {
    fn new(now: Progress, control: &Control, elapsed: f64) -> Self {
        let fraction = now.fraction(control);
        Self {
            stage: now.stage,
            done: now.done,
            total: now.total,
            fraction,
            elapsed_s: elapsed,
            left_s: now.left(control, elapsed),
            realizations_per_s: fraction * now.total as f64 / elapsed.max(1e-3),
            error_of: if let Some(Known::Median(of, _)) = now.known { Some(of) } else { None },
            error: now.known.map(|(Known::Median(_, error) | Known::OfTarget(error))| error),
        }
    }

    /// `wave_power, 3/10, 0.25 realizations/s, 12 s (about 40 s left)`
    fn words(&self) -> String {
        let time = |seconds: f64| HumanDuration(Duration::from_secs_f64(seconds.min(1e9))).to_string();
        let (elapsed, left, rate) = (time(self.elapsed_s), time(self.left_s), self.realizations_per_s);
        let rate = if rate >= 10.0 { format!("{rate:.0}") } else { format!("{rate:.2}") };
        let known = match (self.error_of, self.error) {
            (Some(of), Some(error)) => format!(", {of} ± {error:.2e}"),
            (None, Some(error)) => format!(", error {error:.2} of what is asked for"),
            _ => String::new(),
        };
        let (stage, done, total) = (self.stage, self.done, self.total);
        format!("{stage}, {done}/{total}{known}, {rate} realizations/s, {elapsed} (about {left} left)")
    }
}

//! Long work: without the lock of the interpreter, told of, and ended by Ctrl-C.

use std::sync::Mutex;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pairwave::control::{Control, Progress};
use pairwave::{Error, Result};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::raised;

/// How often it is looked whether someone wants to end it.
const LOOK: Duration = Duration::from_millis(50);

/// Does `work` on a thread of its own. `progress` is called with the stage, realizations done, how many there are, and the part of the work
/// that is done. What it raises, or Ctrl-C, ends the work, and is raised once that has ended.
pub(crate) fn done<T: Send>(
    py: Python<'_>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Control, &mut dyn FnMut(Progress)) -> Result<T> + Send,
) -> PyResult<T> {
    let control = Control::default();
    let (sender, receiver) = channel();
    let receiver = Mutex::new(receiver);
    let mut raised_here = None;
    let ended = std::thread::scope(|scope| {
        let control = &control;
        let worker = scope.spawn(move || work(control, &mut |told| _ = sender.send(told)));
        let mut last: Option<Progress> = None;
        loop {
            let told = py.detach(|| match receiver.lock() {
                Ok(receiver) => receiver.recv_timeout(LOOK),
                Err(_) => Err(RecvTimeoutError::Disconnected),
            });
            match told {
                Ok(told) => last = Some(told),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            let share = |told: Progress| (told.before + told.piece * control.share()).min(1.0);
            let tell = || match (progress, last) {
                (Some(progress), Some(told)) => {
                    progress.call1(py, (told.stage, told.done, told.total, share(told))).map(drop)
                }
                _ => Ok(()),
            };
            if raised_here.is_none()
                && let Err(error) = py.check_signals().and_then(|()| tell())
            {
                control.cancel();
                raised_here = Some(error);
            }
        }
        py.detach(|| worker.join())
    });
    match (raised_here, ended) {
        (Some(error), _) => Err(error),
        (None, Ok(result)) => result.map_err(raised),
        (None, Err(_)) => Err(PyRuntimeError::new_err("pairwave ended by a bug of its own; please report it")),
    }
}

/// Waits for `work`, which is short or cannot be told of.
pub(crate) fn waited<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T, Error> + Send) -> PyResult<T> {
    done(py, None, |_, _| work())
}

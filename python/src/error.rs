//! Errors of the library as exceptions, with settings under the names of keywords.

use pairwave::Error;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyValueError};
use pyo3::{PyErr, create_exception};

use crate::keywords::keyword;

create_exception!(pairwave, DeviceError, PyRuntimeError, "There is no such device, or it failed.");

/// The exception that an error is.
pub(crate) fn raised(error: Error) -> PyErr {
    let text = error.told(keyword);
    match error {
        Error::File { path, source } => match source.raw_os_error() {
            // Python makes FileNotFoundError and its like of the number.
            Some(code) => PyOSError::new_err((code, reason(&source), path)),
            None => PyOSError::new_err(text),
        },
        Error::NoDevice { .. } | Error::Device { .. } => DeviceError::new_err(text),
        Error::Cancelled => PyKeyboardInterrupt::new_err(()),
        Error::Unfinished { error, .. } if matches!(*error, Error::Cancelled) => PyKeyboardInterrupt::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// What the operating system says, without the number.
fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_string()
}

//! Samplers and integrands.

use numpy::{IntoPyArray, PyArrayMethods};
use pairwave::samplers::{Process, find, registry};
use pairwave::{Integrand, Pool, integrand};
use pyo3::prelude::*;
use pyo3::types::PyList;
use rayon::prelude::*;

use crate::error::raised;
use crate::work::done;

/// Realizations of a sampler, arrays of shape (n, d).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are the keywords of `pairwave.sample`")]
pub(crate) fn sample<'py>(
    py: Python<'py>,
    name: &str,
    n: u64,
    k: u64,
    dim: usize,
    seed: u64,
    param: Vec<String>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyList>> {
    let param: Vec<&str> = param.iter().map(String::as_str).collect();
    let process = Process::new(name, n, k, dim, seed, &param).map_err(raised)?;
    let sets = done(py, None, |control, _| {
        let set = |index| process.coordinates(index, control);
        Pool::new(threads)?.install(|| (0..k).into_par_iter().map(set).collect::<pairwave::Result<Vec<_>>>())
    })?;
    let shaped = |set: Vec<f64>| {
        let n = set.len() / dim;
        set.into_pyarray(py).reshape([n, dim])
    };
    PyList::new(py, sets.into_iter().map(shaped).collect::<PyResult<Vec<_>>>()?)
}

/// What there is to know about samplers, as JSON: of all, or of one.
#[pyfunction]
#[pyo3(signature = (name=None))]
pub(crate) fn samplers(name: Option<&str>) -> PyResult<String> {
    let chosen = match name {
        Some(name) => vec![find(name).map_err(raised)?],
        None => registry().to_vec(),
    };
    Ok(serde_json::Value::Array(chosen.into_iter().map(|entry| entry.json()).collect()).to_string())
}

/// The nearest number of points that a sampler can make.
#[pyfunction]
pub(crate) fn nearest_size(name: &str, n: u64, dim: usize) -> PyResult<u64> {
    Ok(find(name).map_err(raised)?.nearest_size(n, dim))
}

/// What there is to know about integrands, as JSON: of all, or of one that is made.
#[pyfunction]
#[pyo3(signature = (spec=None, dim=None))]
pub(crate) fn integrands(py: Python<'_>, spec: Option<&str>, dim: Option<usize>) -> PyResult<String> {
    let all = match spec {
        Some(spec) => {
            let made = py.detach(|| Integrand::new(spec, dim.unwrap_or(2))).map_err(raised)?;
            vec![made.entry().json(Some(&made))]
        }
        None => integrand::registry().iter().map(|entry| entry.json(None)).collect(),
    };
    Ok(serde_json::Value::Array(all).to_string())
}

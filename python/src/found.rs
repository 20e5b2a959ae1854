//! Runs that are no analysis of one batch: over numbers of points, of pairs of axes and prefixes, comparisons, predictions.

use std::path::PathBuf;

use pairwave::comparison::{self, Comparison};
use pairwave::convergence::{Convergence, Subjects, run as climb};
use pairwave::prediction::{self, Predicted};
use pairwave::report::{Asked, Table, check_out};
use pairwave::source::AllAxes;
use pairwave::survey::{Prefixes, Survey, Views, run as look};
use pairwave::{Error, Result, Setting};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::devices::device;
use crate::error::raised;
use crate::keywords::{Request, keyword};
use crate::tables::columns;
use crate::work::{done, waited};

enum Kind {
    Convergence(Convergence),
    Survey(Box<Survey>),
    Comparison(Comparison),
    Predicted(Predicted),
}

/// What such a run found.
#[pyclass(frozen, module = "pairwave._pairwave")]
pub(crate) struct Found(Kind);

#[pymethods]
impl Found {
    /// Its tables: the name of each and its columns.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tables: Vec<(&str, Table)> = match &self.0 {
            Kind::Convergence(found) => found.tables(),
            Kind::Survey(found) => found.tables(),
            Kind::Comparison(found) => vec![("comparison.csv", found.table())],
            Kind::Predicted(found) => vec![("variance.csv", found.table())],
        };
        let all = PyDict::new(py);
        for (name, table) in tables {
            all.set_item(name.trim_end_matches(".csv"), columns(py, &table)?)?;
        }
        Ok(all)
    }

    /// What the command line prints.
    #[getter]
    fn text(&self) -> String {
        match &self.0 {
            Kind::Convergence(found) => found.text(),
            Kind::Survey(found) => found.text(),
            Kind::Comparison(found) => found.text(),
            Kind::Predicted(found) => found.text(),
        }
    }

    /// What the user should know.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        let all = match &self.0 {
            Kind::Convergence(found) => &found.warnings,
            Kind::Survey(found) => &found.warnings,
            Kind::Comparison(found) => &found.notes,
            Kind::Predicted(found) => &found.warnings,
        };
        all.iter().map(|text| Setting::renamed(text, keyword)).collect()
    }

    /// Of a comparison, whether any result differs from the first.
    #[getter]
    fn differ(&self) -> Option<bool> {
        match &self.0 {
            Kind::Comparison(found) => Some(found.differ),
            _ => None,
        }
    }

    /// Writes the directory that the command line writes, and returns its files.
    fn write(&self, py: Python<'_>, out: PathBuf, force: bool, command: String) -> PyResult<Vec<PathBuf>> {
        let asked = Asked { command, settings: None };
        waited(py, || {
            check_out(&out, force)?;
            match &self.0 {
                Kind::Convergence(found) => found.write(&out, &asked, force),
                Kind::Survey(found) => found.write(&out, &asked, force),
                Kind::Comparison(found) => found.write(&out, &asked, force),
                Kind::Predicted(found) => found.write(&out, &asked, force),
            }
        })
    }
}

/// Compares results, by their directories, with the first of them.
#[pyfunction]
pub(crate) fn compare(py: Python<'_>, results: Vec<PathBuf>, alpha: f64) -> PyResult<Found> {
    waited(py, || comparison::compare(&results, alpha)).map(|found| Found(Kind::Comparison(found)))
}

/// Numbers of points, as they are typed.
fn numbers(setting: Setting, text: &str) -> Result<Prefixes> {
    text.parse().map_err(|reason: String| Error::setting(setting, text, reason))
}

/// The variance of integrals against the number of points.
#[pyfunction]
#[pyo3(signature = (request, samplers, numbers_of_points=None, prefixes=None, progress=None))]
pub(crate) fn convergence(
    py: Python<'_>,
    request: &Request,
    samplers: Vec<String>,
    numbers_of_points: Option<&str>,
    prefixes: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let subjects = match (numbers_of_points, prefixes) {
        (Some(text), _) => Subjects::Samplers(samplers, numbers(Setting::Points, text).map_err(raised)?),
        (_, Some(text)) => Subjects::Prefixes(numbers(Setting::Prefixes, text).map_err(raised)?),
        _ => Subjects::Groups(request.0.input.files.clone()),
    };
    let found = done(py, progress.as_ref(), |control, tell| {
        let device = device(request.0.device, request.0.threads)?;
        climb(&subjects, &request.0, &device, control, tell)
    })?;
    Ok(Found(Kind::Convergence(found)))
}

/// Errors of integrals without points, of a result or of a sampler's formula.
#[pyfunction]
pub(crate) fn predict(py: Python<'_>, spec: &str, request: &Request) -> PyResult<Found> {
    waited(py, || prediction::predict(spec, &request.0)).map(|found| Found(Kind::Predicted(found)))
}

/// Every pair of axes, or with `prefixes` the first points of every realization.
#[pyfunction]
#[pyo3(signature = (request, prefixes=None, progress=None))]
pub(crate) fn survey(
    py: Python<'_>,
    request: &Request,
    prefixes: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let mut request = request.0.clone();
    let views = match prefixes {
        Some(text) => {
            let numbers = numbers(Setting::Prefixes, text).map_err(raised)?;
            if request.input.sampler.is_some() {
                request.input.points.get_or_insert(numbers.largest());
            }
            Views::Prefixes(numbers)
        }
        None => Views::Projections,
    };
    let found = done(py, progress.as_ref(), |control, tell| {
        let points = AllAxes::open(&request.input, request.memory(), control)?;
        let device = device(request.device, request.threads)?;
        look(views, &request, &points, &device, control, tell)
    })?;
    Ok(Found(Kind::Survey(Box::new(found))))
}

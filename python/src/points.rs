//! Arrays as points.

use std::sync::Arc;

use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pairwave::Error;
use pairwave::control::Control;
use pairwave::points::read::{Apart, MarkedPoints, Reading};
use pairwave::points::{EnsembleShape, RawPoints};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::error::raised;
use crate::keywords::Request;
use crate::work::done;

/// The points of one request.
#[pyclass(frozen, module = "pairwave._pairwave")]
pub(crate) struct Points(pub(crate) Arc<pairwave::Points>);

/// Realizations in memory, each an array of shape (n, d), with a weight or a label for each point if these are not empty.
#[derive(FromPyObject)]
pub(crate) struct Sets<'py> {
    #[pyo3(item)]
    coordinates: Vec<Bound<'py, PyAny>>,
    /// Binary digits of the numbers that were given.
    #[pyo3(item)]
    digits: Option<u32>,
    #[pyo3(item)]
    weights: Vec<Vec<f64>>,
    #[pyo3(item)]
    labels: Vec<Vec<String>>,
    /// Columns of a data frame that were taken, and those that were not.
    #[pyo3(item)]
    columns: Vec<String>,
    #[pyo3(item)]
    unused: Vec<String>,
    /// The number of the first in messages.
    #[pyo3(item)]
    first: u64,
}

impl Sets<'_> {
    fn marked(self) -> PyResult<Vec<MarkedPoints>> {
        let reading = Arc::new(Reading {
            format: if self.columns.is_empty() { "NumPy".into() } else { "a data frame".into() },
            columns: self.columns,
            unused: self.unused,
            apart: Apart::Arrays,
            digits: self.digits,
            ..Reading::default()
        });
        let (mut weights, mut labels) = (self.weights.into_iter(), self.labels.into_iter());
        let of = |(k, array): (u64, &Bound<'_, PyAny>)| {
            let (dim, coordinates) = numbers(array)?;
            let source = format!("points in memory, realization {k}");
            let (weights, labels) = (weights.next().unwrap_or_default(), labels.next().unwrap_or_default());
            if coordinates.iter().any(|x| !x.is_finite()) {
                let at = coordinates.iter().position(|x| !x.is_finite()).unwrap_or(0);
                let reason = format!("a coordinate is {}; expected finite numbers", coordinates[at]);
                return Err(raised(Error::input(format!("{source}, point {}", at / dim.max(1)), reason)));
            }
            let points = RawPoints { dim, coordinates, source, lines: Vec::new() };
            Ok(MarkedPoints { points, weights, labels, reading: reading.clone() })
        };
        (self.first..).zip(&self.coordinates).map(of).collect()
    }
}

/// The columns and the numbers of an array, row by row. Strides are followed; there is one copy.
fn numbers(array: &Bound<'_, PyAny>) -> PyResult<(usize, Vec<f64>)> {
    if let Ok(array) = array.extract::<PyReadonlyArray2<'_, f64>>() {
        // What is contiguous by columns has its numbers in another order.
        let numbers = match array.as_slice() {
            Ok(numbers) if array.is_c_contiguous() => numbers.to_vec(),
            _ => array.as_array().iter().copied().collect(),
        };
        return Ok((array.shape()[1], numbers));
    }
    if let Ok(array) = array.extract::<PyReadonlyArray2<'_, f32>>() {
        return Ok((array.shape()[1], array.as_array().iter().map(|&x| x.into()).collect()));
    }
    Err(PyTypeError::new_err("expected arrays of float64 or float32 with two axes"))
}

#[pymethods]
impl Points {
    /// Files or a sampler.
    #[staticmethod]
    #[pyo3(signature = (request, progress=None))]
    fn open(py: Python<'_>, request: &Request, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let points = done(py, progress.as_ref(), |control, _| {
            let input = pairwave::source::scanned(request.0.input.clone())?;
            pairwave::Points::open_with(&input, control)
        })?;
        Ok(Self(Arc::new(points)))
    }

    /// Arrays.
    #[staticmethod]
    fn held(py: Python<'_>, request: &Request, sets: Sets<'_>) -> PyResult<Self> {
        let sets = sets.marked()?;
        let points =
            py.detach(|| pairwave::Points::marked(sets, &request.0.input, &Control::default())).map_err(raised)?;
        Ok(Self(Arc::new(points)))
    }

    /// Whether arrays can be used.
    #[staticmethod]
    fn check(request: &Request, sets: Sets<'_>) -> PyResult<()> {
        pairwave::Points::check_sets(&sets.marked()?, &request.0.input).map_err(raised)
    }

    /// Arrays that are realizations from `first` on of a stream. `sizes` are realizations, mean and largest number of points of what all parts
    /// of it are planned by.
    #[staticmethod]
    fn of_stream(
        py: Python<'_>,
        request: &Request,
        name: &str,
        sets: Sets<'_>,
        first: u64,
        sizes: (u64, f64, u64),
    ) -> PyResult<Self> {
        let sets = sets.marked()?;
        let whole = EnsembleShape { realizations: sizes.0, mean_points: sizes.1, max_points: sizes.2 };
        let points =
            py.detach(|| pairwave::Points::of_stream(name, sets, first, whole, &request.0.input)).map_err(raised)?;
        Ok(Self(Arc::new(points)))
    }

    /// Realizations, mean and largest number of points.
    #[getter]
    fn sizes(&self) -> (u64, f64, u64) {
        let shape = self.0.shape();
        (shape.realizations, shape.mean_points, shape.max_points)
    }

    /// What was read, in a line.
    #[getter]
    fn first_line(&self) -> String {
        self.0.first_line()
    }
}

/// Mean and largest of numbers of points, of realizations one after the other.
#[pyfunction]
pub(crate) fn sizes_of(sizes: Vec<u64>) -> (u64, f64, u64) {
    let shape = EnsembleShape::of(&sizes);
    (shape.realizations, shape.mean_points, shape.max_points)
}

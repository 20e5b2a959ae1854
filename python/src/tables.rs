//! Columns and arrays of the library as arrays of NumPy.

use numpy::{Complex64, Element, IntoPyArray, PyArrayMethods};
use pairwave::report::{Array, ArrayValues, Column, Table};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// The columns of a table by name: arrays of float64 or uint64, lists of words.
pub(crate) fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    for (name, column) in table.values() {
        match column {
            Column::Real(values) => all.set_item(name, read_only(values.into_pyarray(py))?)?,
            Column::Integer(values) => all.set_item(name, read_only(values.into_pyarray(py))?)?,
            Column::Text(values) => all.set_item(name, PyList::new(py, values)?)?,
        }
    }
    Ok(all)
}

/// An array of the same shape.
pub(crate) fn array<'py>(py: Python<'py>, array: Array<'_>) -> PyResult<Bound<'py, PyAny>> {
    let shape: Vec<usize> = array.shape.iter().map(|&side| side as usize).collect();
    match array.values {
        ArrayValues::Real(values) => shaped(py, values.collect::<Vec<f64>>(), shape),
        ArrayValues::Integer(values) => shaped(py, values.collect::<Vec<u64>>(), shape),
        ArrayValues::Complex(values) => shaped(py, values.collect::<Vec<Complex64>>(), shape),
    }
}

fn shaped<T: Element>(py: Python<'_>, values: Vec<T>, shape: Vec<usize>) -> PyResult<Bound<'_, PyAny>> {
    read_only(values.into_pyarray(py).reshape(shape)?)
}

/// What was measured is not written to.
fn read_only<'py, T: Element, D: numpy::ndarray::Dimension>(
    array: Bound<'py, numpy::PyArray<T, D>>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = array.into_any();
    array.getattr("flags")?.setattr("writeable", false)?;
    Ok(array)
}

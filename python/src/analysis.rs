//! What was found.

use std::path::PathBuf;
use std::sync::Arc;

use pairwave::report::{self, Beside};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::error::raised;
use crate::tables::{array, columns};
use crate::work::waited;

/// All that was found about points.
#[pyclass(frozen, module = "pairwave._pairwave")]
pub(crate) struct Analysis {
    found: pairwave::Analysis,
    device: Arc<pairwave::Device>,
}

impl Analysis {
    /// What was found, with the call that asked for it.
    pub(crate) fn of(mut found: pairwave::Analysis, command: String, device: &Arc<pairwave::Device>) -> Self {
        found.parameters.push(("command".into(), command.into()));
        Self { found, device: device.clone() }
    }
}

#[pymethods]
impl Analysis {
    /// The names of the files that results may have.
    #[staticmethod]
    fn file_names() -> Vec<&'static str> {
        report::file_names()
    }

    /// The columns of a table by name; None where there is no such table.
    fn table<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyDict>>> {
        py.detach(|| report::table(name, &self.found)).map(|table| columns(py, &table)).transpose()
    }

    /// An array; None where there is no such array.
    fn array<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        report::array(name, &self.found).map(|found| array(py, found)).transpose()
    }

    /// The bytes of a file as the command line writes it; None where there is nothing to be in it.
    fn file<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let made = py.detach(|| self.device.pool().install(|| report::file(name, &self.found))).map_err(raised)?;
        Ok(made.map(|bytes| PyBytes::new(py, &bytes)))
    }

    /// Writes the directory that the command line writes, and returns its files.
    fn write(
        &self,
        py: Python<'_>,
        out: PathBuf,
        force: bool,
        sums: Option<Vec<u8>>,
        npz: bool,
    ) -> PyResult<Vec<PathBuf>> {
        waited(py, || {
            report::check_out(&out, force)?;
            let beside = Beside { sums: sums.as_deref(), settings: None, npz };
            self.device.pool().install(|| report::write_with(&out, &self.found, beside, force))
        })
    }

    /// The main numbers in a few lines.
    #[getter]
    fn headline(&self) -> String {
        report::headline(&self.found)
    }

    /// What the user should know.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.found.warnings.iter().map(|text| pairwave::Setting::renamed(text, crate::keywords::keyword)).collect()
    }

    /// What computed it.
    #[getter]
    fn device(&self) -> String {
        self.found.computed_by.device()
    }

    /// Name of the length unit, if it has one.
    #[getter]
    fn unit(&self) -> Option<String> {
        self.found.unit.as_ref().map(ToString::to_string)
    }
}

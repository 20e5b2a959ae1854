//! Settings as keywords: the flags of the command line with `_` for `-`, read off the one table of settings.

use std::sync::OnceLock;

use pairwave::request::{self, SETTINGS};
use pairwave::{Error, Setting};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::raised;

/// The keyword of a setting: `r_max` for `--r-max`, `n` for `-n`.
pub(crate) fn keyword(setting: Setting) -> &'static str {
    static ALL: OnceLock<Vec<(Setting, String)>> = OnceLock::new();
    let made = |setting: &Setting| {
        let name = setting.flag().trim_start_matches('-').replace('-', "_").to_lowercase();
        (*setting, name)
    };
    let all = ALL.get_or_init(|| Setting::ALL.iter().map(made).collect());
    all.iter().find(|(known, _)| *known == setting).map_or("", |(_, name)| name)
}

/// What is asked for.
#[pyclass(frozen, module = "pairwave._pairwave")]
#[derive(Clone)]
pub(crate) struct Request(pub(crate) pairwave::Request);

#[pymethods]
impl Request {
    /// Of keywords, each with its value as the command line takes it, or with several where the flag may be repeated.
    #[new]
    fn new(settings: Vec<(String, Vec<String>)>) -> PyResult<Self> {
        let of = |(name, texts): (String, Vec<String>)| {
            let known = SETTINGS.iter().find(|row| keyword(row.setting) == name);
            known.map(|row| (row.setting, texts)).ok_or_else(|| Error::input(name, "is no setting"))
        };
        let settings = settings.into_iter().map(of).collect::<Result<Vec<_>, _>>().map_err(raised)?;
        pairwave::Request::of(settings).map(Self).map_err(raised)
    }

    /// With nothing measured but integrals.
    fn integrals_alone(&self) -> Self {
        Self(pairwave::Request { stats: Vec::new(), ..self.0.clone() })
    }

    /// The arguments of `pairwave analyze` that make it.
    fn arguments(&self) -> Vec<String> {
        self.0.arguments()
    }
}

/// What there is to know about every setting.
#[pyfunction]
pub(crate) fn settings(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let of = |row: &request::Row| {
        let all = PyDict::new(py);
        all.set_item("name", keyword(row.setting))?;
        all.set_item("flag", row.flag)?;
        all.set_item("group", row.group.name())?;
        all.set_item("help", Setting::renamed(&request::help(row.setting), keyword))?;
        all.set_item("default", row.default)?;
        all.set_item("otherwise", row.left_out(keyword))?;
        all.set_item("choices", row.choices())?;
        all.set_item("switch", row.is_switch())?;
        all.set_item("repeated", row.is_repeated())?;
        PyResult::Ok(all)
    };
    PyList::new(py, SETTINGS.iter().map(of).collect::<PyResult<Vec<_>>>()?)
}

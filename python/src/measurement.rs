//! A request, carried out: sums that grow, are merged, written and read.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use pairwave::analysis::{Ended, Job, Plan, Target};
use pairwave::control::wait;
use pairwave::{Device, Error, Result, Setting};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::analysis::Analysis;
use crate::devices::device_for;
use crate::error::raised;
use crate::keywords::{Request, keyword};
use crate::points::Points;
use crate::work::{done, waited};

/// The raw sums of a request, of the realizations that were measured so far.
#[pyclass(module = "pairwave._pairwave")]
pub(crate) struct Measurement {
    sums: pairwave::Measurement,
    device: Arc<Device>,
}

#[pymethods]
impl Measurement {
    /// Of points; nothing is measured yet. With `span` of a part of the realizations, which begins and ends at multiples of 16 or where the points do.
    #[new]
    #[pyo3(signature = (request, points, span=None))]
    fn new(py: Python<'_>, request: &Request, points: &Points, span: Option<(u64, u64)>) -> PyResult<Self> {
        let (request, points) = (&request.0, &points.0);
        let made = || -> Result<Self> {
            let (plan, device) = planned(request, points)?;
            let sums = pairwave::Measurement::new(request.clone(), points.clone(), plan);
            let sums = match span {
                Some((start, end)) => sums.within(start..end, &device)?,
                None => sums,
            };
            Ok(Self { sums, device })
        };
        py.detach(made).map_err(raised)
    }

    /// The plan with its cost.
    #[staticmethod]
    fn explain(py: Python<'_>, request: &Request, points: &Points) -> PyResult<String> {
        let (request, points) = (&request.0, &points.0);
        waited(py, || {
            let (plan, device) = planned(request, points)?;
            Ok(format!("{}\ndevice: {}\n{plan}", points.first_line(), device.computed_by().device()))
        })
    }

    /// Measures what is left. What ends it before leaves what was done.
    #[pyo3(signature = (progress=None))]
    fn measure(&mut self, py: Python<'_>, progress: Option<Py<PyAny>>) -> PyResult<()> {
        let Self { sums, device } = self;
        done(py, progress.as_ref(), |control, tell| {
            while wait(sums.advance(device, control, tell))? {}
            Ok(())
        })
    }

    /// Measures what is left and estimates, simulations for envelopes included. It ends before when all of `until_error` are known, or after
    /// `time_limit` seconds, with what is measured then.
    #[pyo3(signature = (command, progress=None, until_error=Vec::new(), time_limit=None))]
    fn finish(
        &mut self,
        py: Python<'_>,
        command: String,
        progress: Option<Py<PyAny>>,
        until_error: Vec<String>,
        time_limit: Option<f64>,
    ) -> PyResult<Analysis> {
        let target =
            |text: &String| text.parse::<Target>().map_err(|reason| Error::setting(Setting::UntilError, text, reason));
        let until = until_error.iter().map(target).collect::<Result<_>>().map_err(raised)?;
        let limit = |seconds: f64| {
            let reason = "expected a number of seconds, 0 or more";
            Duration::try_from_secs_f64(seconds).map_err(|_| Error::setting(Setting::TimeLimit, seconds, reason))
        };
        let job = Job { checkpoint: None, time_limit: time_limit.map(limit).transpose().map_err(raised)?, until };
        let Self { sums, device } = self;
        job.check(sums).map_err(raised)?;
        let found = done(py, progress.as_ref(), |control, tell| match job.measure(sums, device, control, tell) {
            Ended::Whole => wait(sums.finish(device, control, tell)),
            Ended::Failed(error) => Err(error),
            Ended::Late => {
                let mut found =
                    sums.analysis().ok_or_else(|| Error::input("time_limit", "was up before anything was measured"))?;
                found.warnings.push(format!("this is not all that was asked for: {} were measured", sums.held()));
                Ok(found)
            }
        })?;
        Ok(Analysis::of(found, command, device))
    }

    /// What is found so far; None before there is anything.
    fn analysis(&self, py: Python<'_>, command: String) -> Option<Analysis> {
        let found = py.detach(|| self.device.pool().install(|| self.sums.analysis()));
        found.map(|found| Analysis::of(found, command, &self.device))
    }

    /// Takes the realizations of another of the same measurement, which holds nothing afterwards.
    fn absorb(&mut self, py: Python<'_>, other: &Bound<'_, Self>) -> PyResult<()> {
        let sums = &mut self.sums;
        let mut other = other.try_borrow_mut()?;
        let empty = other.sums.emptied();
        let taken = std::mem::replace(&mut other.sums, empty);
        py.detach(|| sums.merge(taken)).map_err(raised)
    }

    /// The sums as bytes.
    fn write<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.sums.write()))
    }

    /// What `write` wrote. `place` names it in errors.
    #[staticmethod]
    fn read(py: Python<'_>, place: &str, bytes: &[u8]) -> PyResult<Self> {
        py.detach(|| Self::opened(pairwave::Measurement::read(place, bytes)?)).map_err(raised)
    }

    /// The sums that a result, a part of one or a file holds.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| Self::opened(pairwave::Measurement::load(&path)?)).map_err(raised)
    }

    /// Realizations that it holds.
    #[getter]
    fn realizations(&self) -> u64 {
        self.sums.realizations()
    }

    /// Those that it is of.
    #[getter]
    fn total(&self) -> u64 {
        self.sums.total()
    }

    /// The first realization that it holds, and the one after the last, counted from 0.
    #[getter]
    fn reach(&self) -> (u64, u64) {
        let reach = self.sums.reach();
        (reach.start, reach.end)
    }

    /// Number of coordinates.
    #[getter]
    fn dim(&self) -> usize {
        self.sums.points().domain().dim()
    }

    /// Realizations, mean and largest number of points of what it is planned by.
    #[getter]
    fn sizes(&self) -> (u64, f64, u64) {
        let shape = self.sums.points().shape();
        (shape.realizations, shape.mean_points, shape.max_points)
    }

    /// The realizations that it lacks, counted from 1; None if it has all.
    #[getter]
    fn missing(&self) -> Option<String> {
        self.sums.missing()
    }

    /// Its settings: keyword and value as they are typed, of those that are given.
    #[getter]
    fn settings(&self) -> Vec<(&'static str, String)> {
        let request = self.sums.request();
        let given = pairwave::request::SETTINGS.iter().filter(|row| row.is_given(request));
        given.map(|row| (keyword(row.setting), request.value(row.setting))).collect()
    }
}

/// The plan of a request, for the device that it names.
fn planned(request: &pairwave::Request, points: &pairwave::Points) -> Result<(Plan, Arc<Device>)> {
    let plan = Plan::of(request, points)?;
    let device = device_for(&plan, request)?;
    Ok((plan.for_device(device.compute()), device))
}

impl Measurement {
    fn opened(sums: pairwave::Measurement) -> Result<Self> {
        let device = device_for(sums.plan(), sums.request())?;
        Ok(Self { sums, device })
    }
}

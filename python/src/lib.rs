//! The library for Python. It holds no arithmetic: arrays become points, keywords a request, and what was found arrays again. What Python
//! programs see of it is in `package/pairwave/`, which names, checks and shows.

mod analysis;
mod devices;
mod error;
mod found;
mod keywords;
mod measurement;
mod points;
mod sample;
mod tables;
mod work;

use pyo3::prelude::*;

/// The part of `pairwave` that is in Rust; programs import `pairwave`.
#[pymodule]
fn _pairwave(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add("DeviceError", m.py().get_type::<error::DeviceError>())?;
    m.add_class::<keywords::Request>()?;
    m.add_class::<points::Points>()?;
    m.add_class::<measurement::Measurement>()?;
    m.add_class::<analysis::Analysis>()?;
    m.add_class::<found::Found>()?;
    m.add_function(wrap_pyfunction!(keywords::settings, m)?)?;
    m.add_function(wrap_pyfunction!(devices::devices, m)?)?;
    m.add_function(wrap_pyfunction!(devices::forget_devices, m)?)?;
    m.add_function(wrap_pyfunction!(sample::sample, m)?)?;
    m.add_function(wrap_pyfunction!(sample::samplers, m)?)?;
    m.add_function(wrap_pyfunction!(sample::nearest_size, m)?)?;
    m.add_function(wrap_pyfunction!(points::sizes_of, m)?)?;
    m.add_function(wrap_pyfunction!(sample::integrands, m)?)?;
    m.add_function(wrap_pyfunction!(found::compare, m)?)?;
    m.add_function(wrap_pyfunction!(found::convergence, m)?)?;
    m.add_function(wrap_pyfunction!(found::predict, m)?)?;
    m.add_function(wrap_pyfunction!(found::survey, m)?)?;
    Ok(())
}

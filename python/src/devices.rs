//! Devices, opened once: threads and kernels of one call serve the next.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pairwave::analysis::Plan;
use pairwave::compute::gpu::{AdapterChoice, GpuCompute, adapters};
use pairwave::compute::{Compute, Device, cpu::Cpu};
use pairwave::control::wait;
use pairwave::request::DeviceChoice;
use pairwave::{Request, Result};
use pyo3::prelude::*;

use crate::work::waited;

type Open = Vec<((DeviceChoice, Option<usize>), Arc<Device>)>;

fn all() -> &'static Mutex<Open> {
    static ALL: OnceLock<Mutex<Open>> = OnceLock::new();
    ALL.get_or_init(Mutex::default)
}

/// The device of a choice.
pub(crate) fn device(choice: DeviceChoice, threads: Option<usize>) -> Result<Arc<Device>> {
    let known = |open: &Open| open.iter().find(|(of, _)| *of == (choice, threads)).map(|(_, device)| device.clone());
    if let Some(device) = known(&all().lock().unwrap_or_else(PoisonError::into_inner)) {
        return Ok(device);
    }
    // Not under the lock: a GPU takes a while.
    let opened = Arc::new(wait(Device::open(choice, threads))?);
    let mut open = all().lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(device) = known(&open) {
        return Ok(device);
    }
    open.push(((choice, threads), opened.clone()));
    Ok(opened)
}

/// The device that a request asks for; where it leaves the choice, the CPU path for what that has done before a GPU is ready.
pub(crate) fn device_for(plan: &Plan, request: &Request) -> Result<Arc<Device>> {
    if request.device == DeviceChoice::Auto {
        let cpu = device(DeviceChoice::Cpu, request.threads)?;
        if plan.soon_done(cpu.pool().threads()).is_some() {
            return Ok(cpu);
        }
    }
    device(request.device, request.threads)
}

/// What can compute here, a name and a line about each.
#[pyfunction]
pub(crate) fn devices(py: Python<'_>) -> PyResult<Vec<(String, String, String)>> {
    waited(py, || {
        let mut found = vec![("cpu".to_string(), Cpu::new(None)?.computed_by().device(), "usable".to_string())];
        for adapter in wait(adapters()) {
            let verdict = match wait(GpuCompute::open(AdapterChoice::Index(adapter.index))) {
                Ok(gpu) => gpu.verdict().to_string(),
                Err(error) => format!("not usable: {error}"),
            };
            found.push((adapter.index.to_string(), adapter.to_string(), verdict));
        }
        Ok(found)
    })
}

/// After a fork: threads did not come along, so that what is open here waits for ever. It is left alone, and opened anew when needed.
#[pyfunction]
pub(crate) fn forget_devices() {
    match all().try_lock() {
        Ok(mut open) => std::mem::forget(std::mem::take(&mut *open)),
        Err(std::sync::TryLockError::Poisoned(open)) => std::mem::forget(std::mem::take(&mut *open.into_inner())),
        // Another thread held it at the fork.
        Err(std::sync::TryLockError::WouldBlock) => {}
    }
}

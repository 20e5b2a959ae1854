//! From a word to something that computes.

use super::cpu::Cpu;
use super::gpu::{AdapterChoice, GpuCompute};
use super::{Compute, reference::Reference};
use crate::error::{Error, Result};
use crate::pool::check_threads;
use crate::request::DeviceChoice;

/// A device made ready.
pub struct Opened {
    /// It.
    pub compute: Box<dyn Compute>,
    /// What the user should know about the choice: why `auto` did not take a GPU.
    pub note: Option<String>,
}

/// Opens the device that is asked for. `threads` is for the CPU path.
pub async fn open(choice: DeviceChoice, threads: Option<usize>) -> Result<Opened> {
    let gpu = async |choice| -> Result<Opened> {
        // The CPU path stands behind every GPU.
        threads.map_or(Ok(()), check_threads)?;
        Ok(Opened { compute: Box::new(GpuCompute::open(choice).await?), note: None })
    };
    match choice {
        DeviceChoice::Cpu => Ok(Opened { compute: Box::new(Cpu::new(threads)?), note: None }),
        DeviceChoice::Reference => Ok(Opened { compute: Box::new(Reference), note: None }),
        DeviceChoice::Gpu => gpu(AdapterChoice::Any).await,
        DeviceChoice::Index(index) => gpu(AdapterChoice::Index(index)).await,
        DeviceChoice::Auto => match gpu(AdapterChoice::HardwareOnly).await {
            Err(error @ (Error::NoDevice { .. } | Error::Device { .. })) => {
                let compute = Box::new(Cpu::new(threads)?);
                let note = format!("{}; using the native CPU path", reason(&error));
                Ok(Opened { compute, note: Some(note) })
            }
            opened => opened,
        },
    }
}

/// The part of a device error that matters when nobody asked for that device.
fn reason(error: &Error) -> String {
    match error {
        Error::NoDevice { reason, .. } => reason.clone(),
        other => other.to_string(),
    }
}

//! `--device`: from a word to something that computes.

use std::str::FromStr;

use super::cpu::{Cpu, check_threads};
use super::gpu::{AdapterChoice, GpuCompute};
use super::{Compute, reference::Reference};
use crate::error::{Error, Result};

/// What `--device` asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// A hardware GPU that passes the self-check, else the CPU path; never a software adapter.
    #[default]
    Auto,
    /// The native path.
    Cpu,
    /// Any adapter, hardware first.
    Gpu,
    /// The slow truth.
    Reference,
    /// An adapter by its index.
    Index(usize),
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            "cpu" => Ok(Self::Cpu),
            "gpu" => Ok(Self::Gpu),
            "reference" => Ok(Self::Reference),
            index => index.parse().map(Self::Index).map_err(|_| {
                "expected auto, cpu, gpu, reference or an index that `pairwave devices` lists".to_string()
            }),
        }
    }
}

/// A device made ready.
pub struct Opened {
    /// It.
    pub compute: Box<dyn Compute>,
    /// What the user should know about the choice: why `auto` did not take a GPU.
    pub note: Option<String>,
}

impl DeviceChoice {
    /// Opens it. `threads` is for the CPU path.
    pub fn open(self, threads: Option<usize>) -> Result<Opened> {
        let gpu = |choice| -> Result<Opened> {
            // The CPU path stands behind every GPU.
            threads.map_or(Ok(()), check_threads)?;
            Ok(Opened { compute: Box::new(GpuCompute::open(choice)?), note: None })
        };
        match self {
            Self::Cpu => Ok(Opened { compute: Box::new(Cpu::new(threads)?), note: None }),
            Self::Reference => Ok(Opened { compute: Box::new(Reference), note: None }),
            Self::Gpu => gpu(AdapterChoice::Any),
            Self::Index(index) => gpu(AdapterChoice::Index(index)),
            Self::Auto => match gpu(AdapterChoice::HardwareOnly) {
                Err(error @ (Error::NoDevice { .. } | Error::Device { .. })) => {
                    let compute = Box::new(Cpu::new(threads)?);
                    let note = format!("{}; using the native CPU path", reason(&error));
                    Ok(Opened { compute, note: Some(note) })
                }
                opened => opened,
            },
        }
    }
}

/// The part of a device error that matters when nobody asked for that device.
fn reason(error: &Error) -> String {
    match error {
        Error::NoDevice { reason, .. } => reason.clone(),
        other => other.to_string(),
    }
}

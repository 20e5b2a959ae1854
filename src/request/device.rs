//! `--device`, in words; `compute::open` makes it something that computes.

use std::str::FromStr;

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

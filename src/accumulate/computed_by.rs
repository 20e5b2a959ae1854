//! Who computed a raw sum.

/// Which of the three ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// The slow truth.
    Reference,
    /// Native threads and SIMD.
    Cpu,
    /// wgpu.
    Gpu,
}

/// The tag every raw sum carries: who computed it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ComputedBy {
    /// The ways that took part (more than one after a fallback or a merge).
    pub backends: Vec<Backend>,
    /// Device and driver of each, in words.
    pub devices: Vec<String>,
}

impl ComputedBy {
    /// One backend on one device.
    pub fn new(backend: Backend, device: impl Into<String>) -> Self {
        Self { backends: vec![backend], devices: vec![device.into()] }
    }

    /// Both, each named once.
    pub fn merge(&self, other: &Self) -> Self {
        let mut merged = self.clone();
        for b in &other.backends {
            if !merged.backends.contains(b) {
                merged.backends.push(*b);
            }
        }
        for d in &other.devices {
            if !merged.devices.contains(d) {
                merged.devices.push(d.clone());
            }
        }
        merged
    }

    /// All devices in one line.
    pub fn device(&self) -> String {
        self.devices.join("; ")
    }
}

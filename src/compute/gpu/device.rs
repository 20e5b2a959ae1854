//! Adapters and the one device: opened once, borrowed by everything that needs it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
#[cfg(not(target_arch = "wasm32"))]
use std::time::Duration;

use super::answer::Answer;
use crate::error::{Error, Result};

/// Vulkan, Metal and Direct3D 12; WebGPU, which is there in a browser only. Never GL: its software adapters hide that no
/// Vulkan driver was found.
const BACKENDS: wgpu::Backends = wgpu::Backends::VULKAN
    .union(wgpu::Backends::METAL)
    .union(wgpu::Backends::DX12)
    .union(wgpu::Backends::BROWSER_WEBGPU);

/// One adapter, in words.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct AdapterSummary {
    /// Its place in the list of `adapters()`, the INDEX of `--device`.
    pub index: usize,
    /// What it calls itself.
    pub name: String,
    /// `Vulkan`, `Metal`, `Dx12` or `BrowserWebGpu`.
    pub backend: String,
    /// `DiscreteGpu`, `IntegratedGpu`, `VirtualGpu`, `Cpu` or `Other`.
    pub device_type: String,
    /// The driver's name.
    pub driver: String,
    /// The driver's version.
    pub driver_info: String,
    /// The largest buffer a kernel can see, in bytes.
    pub max_binding_bytes: u64,
    /// Whether it is a processor in disguise.
    pub software: bool,
}

impl std::fmt::Display for AdapterSummary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = if self.software { "software" } else { "hardware" };
        write!(f, "{} ({}, {kind}, {} {})", self.name, self.backend, self.driver, self.driver_info)
    }
}

/// Which adapter to open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The first that is hardware and passes the self-check.
    HardwareOnly,
    /// The first that passes the self-check, hardware before software.
    Any,
    /// This one of `adapters()`.
    Index(usize),
}

impl AdapterChoice {
    fn asked(self) -> String {
        match self {
            Self::HardwareOnly => "auto".into(),
            Self::Any => "gpu".into(),
            Self::Index(i) => i.to_string(),
        }
    }
}

/// All adapters of this machine, in the order of their indices. Empty where there is no driver.
pub async fn adapters() -> Vec<AdapterSummary> {
    enumerate().await.into_iter().map(|(summary, _)| summary).collect()
}

async fn enumerate() -> Vec<(AdapterSummary, wgpu::Adapter)> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = BACKENDS;
    let instance = wgpu::Instance::new(descriptor);
    let found = instance.enumerate_adapters(BACKENDS).await;
    found.into_iter().enumerate().map(|(index, adapter)| (summary(index, &adapter), adapter)).collect()
}

fn summary(index: usize, adapter: &wgpu::Adapter) -> AdapterSummary {
    let info = adapter.get_info();
    AdapterSummary {
        index,
        name: info.name,
        backend: format!("{:?}", info.backend),
        device_type: format!("{:?}", info.device_type),
        driver: info.driver,
        driver_info: info.driver_info,
        max_binding_bytes: adapter.limits().max_storage_buffer_binding_size,
        software: info.device_type == wgpu::DeviceType::Cpu,
    }
}

/// The adapters that answer a choice, best first; an error that says what there is where none does.
pub(super) async fn candidates(choice: AdapterChoice) -> Result<Vec<(AdapterSummary, wgpu::Adapter)>> {
    let mut found = enumerate().await;
    let list = found.iter().map(|(s, _)| format!("{}: {s}", s.index)).collect::<Vec<_>>().join("; ");
    match choice {
        AdapterChoice::Index(i) => found.retain(|(s, _)| s.index == i),
        AdapterChoice::HardwareOnly => found.retain(|(s, _)| !s.software),
        AdapterChoice::Any => {}
    }
    let rank = |s: &AdapterSummary| match s.device_type.as_str() {
        "DiscreteGpu" => 0,
        "IntegratedGpu" => 1,
        "Cpu" => 3,
        _ => 2,
    };
    found.sort_by_key(|(s, _)| rank(s));
    if found.is_empty() {
        let reason = match choice {
            _ if list.is_empty() => "no GPU driver (Vulkan, Metal or Direct3D 12) found".to_string(),
            AdapterChoice::HardwareOnly => format!("no hardware GPU found, only {list}"),
            _ => format!("no adapter has that index; there is {list}"),
        };
        return Err(Error::NoDevice { asked: choice.asked(), reason });
    }
    Ok(found)
}

pub(super) fn refused(choice: AdapterChoice, failures: &[String]) -> Error {
    Error::NoDevice { asked: choice.asked(), reason: failures.join("; ") }
}

/// Longest wait for one submission. The work of each is bounded to about a second on slow hardware.
#[cfg(not(target_arch = "wasm32"))]
const TIMEOUT: Duration = Duration::from_secs(300);

/// A submission whose end the device will tell of.
pub(super) struct Waiting<T> {
    #[cfg(not(target_arch = "wasm32"))]
    submission: wgpu::SubmissionIndex,
    answer: Answer<T>,
}

impl<T: Send + 'static> Waiting<T> {
    /// Of a submission, and what the device is to call at its end.
    pub(super) fn of(_submission: wgpu::SubmissionIndex) -> (Self, impl FnOnce(T) + Send + 'static) {
        let answer = Answer::default();
        let given = answer.clone();
        let waiting = Self {
            #[cfg(not(target_arch = "wasm32"))]
            submission: _submission,
            answer,
        };
        (waiting, move |value| given.give(value))
    }
}

/// What went wrong outside of any error scope.
#[derive(Debug, Default)]
struct Faults {
    lost: Mutex<Option<String>>,
    uncaptured: Mutex<Option<String>>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A fault is a plain string: whatever panicked elsewhere, it is whole.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An open device: adapter, device, queue, limits.
#[derive(Debug)]
pub struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) limits: wgpu::Limits,
    summary: AdapterSummary,
    faults: Arc<Faults>,
}

impl Gpu {
    pub(super) async fn open(summary: AdapterSummary, adapter: &wgpu::Adapter) -> Result<Self> {
        // All the adapter has: the size of one binding decides which point sets fit.
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("pairwave"),
            // What some kernels use and others do without.
            required_features: adapter.features() & wgpu::Features::SHADER_F64,
            required_limits: limits.clone(),
            experimental_features: wgpu::ExperimentalFeatures::disabled(),
            memory_hints: wgpu::MemoryHints::Performance,
            trace: wgpu::Trace::Off,
        };
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(|e| Error::Device {
            device: summary.to_string(),
            what: "open",
            reason: e.to_string(),
        })?;
        let faults = Arc::new(Faults::default());
        let seen = Arc::clone(&faults);
        device.set_device_lost_callback(move |reason, message| {
            *locked(&seen.lost) = Some(format!("device lost ({reason:?}) {message}"));
        });
        let seen = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| *locked(&seen.uncaptured) = Some(e.to_string())));
        Ok(Self { device, queue, limits, summary, faults })
    }

    /// Whether kernels may compute in f64.
    pub(super) fn has_f64(&self) -> bool {
        self.device.features().contains(wgpu::Features::SHADER_F64)
    }

    /// Adapter and driver, in words.
    pub fn summary(&self) -> &AdapterSummary {
        &self.summary
    }

    pub(super) fn error(&self, what: &'static str, reason: impl ToString) -> Error {
        Error::Device { device: self.summary.to_string(), what, reason: reason.to_string() }
    }

    fn check(&self, what: &'static str) -> Result<()> {
        if let Some(reason) = locked(&self.faults.lost).clone() {
            return Err(self.error(what, reason));
        }
        match locked(&self.faults.uncaptured).take() {
            Some(reason) => Err(self.error(what, reason)),
            None => Ok(()),
        }
    }

    /// Runs `work`, and turns whatever the device has to say about it into an error that names `what`.
    pub(super) async fn guarded<T>(&self, what: &'static str, work: impl AsyncFnOnce() -> Result<T>) -> Result<T> {
        self.check(what)?;
        let filters = [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let result = work().await;
        // Scopes are a stack: the last one pushed is the first to go.
        let mut reason = None;
        for scope in scopes.into_iter().rev() {
            reason = scope.pop().await.or(reason);
        }
        if matches!(result, Err(Error::Cancelled)) {
            return result;
        }
        self.check(what)?;
        match reason {
            Some(e) => Err(self.error(what, e)),
            None => result,
        }
    }

    /// Submits what `encoder` holds, whose end can be waited for.
    pub(super) fn submit(&self, encoder: wgpu::CommandEncoder) -> Waiting<()> {
        let (waiting, answer) = Waiting::of(self.queue.submit([encoder.finish()]));
        self.queue.on_submitted_work_done(move || answer(()));
        waiting
    }

    /// What the device answers.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) async fn wait<T>(&self, what: &'static str, waiting: Waiting<T>) -> Result<T> {
        // Drivers call nobody back: the device has to be asked, and answers while it is. So this blocks where it waits.
        let wait = wgpu::PollType::Wait { submission_index: Some(waiting.submission), timeout: Some(TIMEOUT) };
        self.device.poll(wait).map_err(|e| self.error(what, e))?;
        // The submission is done, but where threads share the device another one's poll may have taken the answer along and
        // be about to deliver it.
        waiting.answer.within(TIMEOUT).ok_or_else(|| self.error(what, "the device did not answer"))
    }

    /// What the device answers.
    #[cfg(target_arch = "wasm32")]
    pub(super) async fn wait<T>(&self, _what: &'static str, waiting: Waiting<T>) -> Result<T> {
        // A browser answers once it has control again.
        Ok(waiting.answer.await)
    }

    /// For tests: what a driver reset does.
    #[doc(hidden)]
    pub fn lose(&self) {
        self.device.destroy();
        let _ = self.device.poll(wgpu::PollType::Poll);
    }
}

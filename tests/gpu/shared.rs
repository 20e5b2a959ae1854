//! Shared by the tests of this room.

use std::sync::OnceLock;

use crate::common::*;
use pairwave::compute::gpu::{AdapterChoice, GpuCompute};
use pairwave::control::Control;
use pairwave::plan::Accuracy;

/// A device of one's own, or `None` where there is no driver and a person said that this is fine.
pub fn open(test: &str) -> Option<GpuCompute> {
    if gpu_tests_skipped(test) {
        return None;
    }
    match wait(GpuCompute::open(AdapterChoice::Any)) {
        Ok(gpu) => Some(gpu),
        Err(why) => panic!("{test}: {why} (PAIRWAVE_ALLOW_NO_GPU=1 skips where there is no driver)"),
    }
}

/// One device for the tests that change nothing about it.
pub fn shared(test: &str) -> Option<&'static GpuCompute> {
    static GPU: OnceLock<Option<GpuCompute>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| open(test)).as_ref();
    if gpu.is_none() {
        gpu_tests_skipped(test);
    }
    gpu
}

pub fn go() -> Control {
    Control::default()
}

/// What each accuracy promises about P on any device.
pub struct Promise {
    pub accuracy: Accuracy,
    /// Root mean square of `P - P_ref` for uniform points.
    pub rms: f64,
    /// `|P - P_ref| / (1 + P_ref)` for them.
    pub max: f64,
    /// P of a rank-1 lattice of 65,536 points where it is 0.
    pub zero: f64,
    /// Median of `|P - P_ref| / P_ref` of a jittered lattice.
    pub jittered: f64,
    /// Error of cosine and sine.
    pub table: f64,
}

pub const PROMISES: [Promise; 2] = [
    Promise { accuracy: Accuracy::Fast, rms: 6e-7, max: 1e-5, zero: 1e-10, jittered: 3e-4, table: 2e-7 },
    Promise { accuracy: Accuracy::High, rms: 1e-12, max: 1e-11, zero: 1e-24, jittered: 1e-9, table: 1e-15 },
];

/// The promises the device makes: `fast` always, `high` where it has a good f64, as every driver of a test machine should.
pub fn promises(gpu: &GpuCompute) -> impl Iterator<Item = &'static Promise> {
    if let Err(why) = gpu.verdict().f64() {
        println!("accuracy high is not tested: {why}");
    }
    PROMISES.iter().filter(|p| p.accuracy == Accuracy::Fast || gpu.verdict().f64().is_ok())
}

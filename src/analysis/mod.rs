//! A request, carried out: points -> plan -> compute -> accumulate -> estimate, in batches. The command line and the
//! viewer both call this and hold no arithmetic of their own.

mod envelope;
mod measurement;
mod plan;
mod ranges;
mod status;
mod sums_file;

use std::sync::Arc;

pub use measurement::Measurement;
pub use plan::Plan;
pub use status::{Status, TrackStatus};

pub use crate::estimate::{Analysis, ClosedForm, Envelopes};

use crate::compute::Device;
use crate::control::{Control, Instant, Progress};
use crate::error::{Error, Result};
use crate::request::Request;
use crate::source::Points;

/// Carries out a request on points and a device.
///
/// # Errors
/// What the points or the device say; `Error::Cancelled` once `control` was told so.
pub fn run(
    request: &Request,
    source: Arc<Points>,
    plan: Plan,
    device: &Device,
    control: &Control,
    progress: &mut dyn FnMut(Progress),
) -> Result<Analysis> {
    let mut measurement = Measurement::new(request.clone(), source, plan);
    pollster::block_on(measurement.finish(device, control, progress))
}

impl Measurement {
    /// Measures what is left and estimates.
    ///
    /// # Errors
    /// As `run`.
    pub async fn finish(
        &mut self,
        device: &Device,
        control: &Control,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Analysis> {
        while self.advance(device, control, progress).await? {}
        let total = self.total();
        progress(Progress { stage: "estimates", done: total, total });
        let nothing = || Error::input(self.source.subject(), "there are no realizations");
        let mut found = self.analysis().ok_or_else(nothing)?;
        if self.plan.simulations > 0 {
            let start = Instant::now();
            let envelopes = envelope::envelopes(self, &found, device, control, progress).await?;
            self.clock.add("envelope", start.elapsed().as_secs_f64());
            found.timings.push(("envelope", start.elapsed().as_secs_f64()));
            found.findings.insert(envelopes);
        }
        Ok(found)
    }
}

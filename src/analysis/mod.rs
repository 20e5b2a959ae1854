//! A request, carried out: points -> plan -> compute -> accumulate -> estimate, in batches. The command line and the
//! viewer both call this and hold no arithmetic of their own.

mod ahead;
mod envelope;
mod estimates;
mod job;
mod measurement;
mod parts;
mod plan;
mod ranges;
mod sizes;
mod status;
mod sums_file;
mod track;

use std::sync::Arc;

pub use job::{Ended, Job};
pub use measurement::Measurement;
pub use plan::Plan;
pub use status::{Status, TrackStatus};

pub use crate::estimate::{Analysis, ClosedForm, Envelopes};
pub use crate::statistics::targets::{Standing, Target};

use crate::compute::Device;
use crate::control::{Control, Instant, Progress};
use crate::error::{Error, Result};
use crate::request::Request;
use crate::source::Points;

/// Measures points: everything that the request asks for, on the device that it names, by default the best there is. What the
/// request says of where points come from is not looked at.
///
/// # Errors
/// Settings that cannot be, or say nothing about what is asked for; what the device says.
pub fn measure(points: impl Into<Arc<Points>>, request: &Request) -> Result<Analysis> {
    let points = points.into();
    let plan = Plan::of(request, &points)?;
    crate::control::wait(async {
        let device = plan.open(request).await?;
        let plan = plan.for_device(device.compute());
        let mut measurement = Measurement::new(request.clone(), points, plan);
        measurement.finish(&device, &Control::default(), &mut |_| ()).await
    })
}

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
    crate::control::wait(measurement.finish(device, control, progress))
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
        let (planned, piece) = (self.planned(), 0.0);
        let before = 1.0 - self.plan.simulated_seconds() / planned;
        progress(Progress { stage: "estimates", done: total, total, before, piece, planned, known: None });
        let nothing = || Error::input(self.source.subject(), "there are no realizations");
        let mut found = self.analysis().ok_or_else(nothing)?;
        if self.plan.simulations > 0 {
            let start = Instant::now();
            let envelopes = envelope::envelopes(self, &found, device, control, progress).await?;
            self.clock.add("envelope", start.elapsed().as_secs_f64());
            found.timings.push(("envelope", start.elapsed().as_secs_f64()));
            found.warnings.extend(envelopes.too_few());
            found.findings.insert(envelopes);
        }
        Ok(found)
    }
}

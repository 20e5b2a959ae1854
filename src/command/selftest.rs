//! `pairwave selftest`

use pairwave::request::DeviceChoice;
use pairwave::selftest::{self, Check};
use pairwave::{Device, Error, Result};

use super::progress::stop_on_interrupt;
use super::{print, tell};

#[derive(clap::Args)]
pub(crate) struct Selftest {
    /// What computes: auto, gpu, cpu, reference, or the index of an adapter
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    device: DeviceChoice,

    /// All processes, and more realizations of each
    #[arg(long)]
    full: bool,

    /// As JSON
    #[arg(long)]
    json: bool,

    /// Number of threads
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

impl Selftest {
    pub(crate) fn run(self) -> Result<()> {
        let control = stop_on_interrupt()?;
        let device = pairwave::control::wait(Device::open(self.device, self.threads))?;
        if let Some(note) = device.note() {
            tell(&format!("note: {note}"));
        }
        if !self.json {
            print(&format!(
                "{} realizations by {}\n",
                if self.full { 1000 } else { 400 },
                device.computed_by().device()
            ))?;
        }
        let mut failed_to_print = None;
        let mut show = |check: &Check| {
            if !self.json
                && let Err(error) = print(&line(check))
            {
                failed_to_print.get_or_insert(error);
            }
        };
        let checks = pairwave::control::wait(selftest::run(&device, self.full, &control, &mut show))?;
        failed_to_print.map_or(Ok(()), Err)?;
        if self.json {
            print(&format!(
                "{:#}\n",
                serde_json::json!({ "device": device.computed_by().device(), "checks": checks })
            ))?;
        }
        let failed = checks.iter().filter(|check| !check.holds).count();
        match failed {
            0 if self.json => Ok(()),
            0 => print(&format!("all {} hold\n", checks.len())),
            _ => Err(Error::input("selftest", format!("{failed} of {} checks fail", checks.len()))),
        }
    }
}

fn line(check: &Check) -> String {
    let verdict = if check.holds { "holds" } else { "FAILS" };
    let Check { sampler, n, dim, claim, p_value, .. } = check;
    format!("{verdict}  p = {p_value:<8.2e} {sampler}, n = {n}, {dim}D: {claim}\n")
}

//! `pairwave selftest`

use pairwave::control::Control;
use pairwave::request::DeviceChoice;
use pairwave::selftest::{self, Check, Stress};
use pairwave::{Device, Error, Result};

use super::progress::stop_on_interrupt;
use super::{print, tell};

#[derive(clap::Args)]
pub(crate) struct Selftest {
    /// What computes: auto, gpu, cpu, reference, or the index of an adapter
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    device: DeviceChoice,

    /// All processes, and more realizations of each; with --stress larger problems and longer searches
    #[arg(long)]
    full: bool,

    /// Push at every promise instead: hostile points, far frequencies, many decades in one sum, searches for the worst input
    #[arg(long)]
    stress: bool,

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
        if self.stress {
            return self.push(&device, &control);
        }
        if !self.json {
            print(&format!(
                "{} realizations by {}\n",
                if self.full { 1000 } else { 400 },
                device.computed_by().device()
            ))?;
        }
        let mut told = Ok(());
        let mut show = |check: &Check| self.show(&line(check), &mut told);
        let checks = pairwave::control::wait(selftest::run(&device, self.full, &control, &mut show))?;
        told?;
        self.conclude(&device, "checks", &checks, checks.iter().filter(|check| !check.holds).count())
    }

    /// Pushes at every promise.
    fn push(&self, device: &Device, control: &Control) -> Result<()> {
        if !self.json {
            print(&format!(
                "by {}\n{:<5}  {:>8}  {:>8}  {:>9}\n",
                device.computed_by().device(),
                "",
                "bound",
                "measured",
                "clearance"
            ))?;
        }
        let mut told = Ok(());
        let mut show = |one: &Stress| {
            let verdict = if one.holds { "holds" } else { "FAILS" };
            let Stress { what, bound, measured, tried, .. } = one;
            let clearance = one.clearance();
            self.show(
                &format!("{verdict}  {bound:8.1e}  {measured:8.1e}  {clearance:9.1e}  {what} ({tried} tried)\n"),
                &mut told,
            );
        };
        let all = pairwave::control::wait(selftest::stress(device, self.full, control, &mut show))?;
        told?;
        self.conclude(device, "stress", &all, all.iter().filter(|one| !one.holds).count())
    }

    /// Prints a line, unless all comes as JSON in the end; keeps the first error.
    fn show(&self, line: &str, told: &mut Result<()>) {
        if !self.json && told.is_ok() {
            *told = print(line);
        }
    }

    fn conclude<T: serde::Serialize>(&self, device: &Device, name: &str, all: &[T], failed: usize) -> Result<()> {
        if self.json {
            print(&format!("{:#}\n", serde_json::json!({ "device": device.computed_by().device(), name: all })))?;
        }
        match failed {
            0 if self.json => Ok(()),
            0 => print(&format!("all {} hold\n", all.len())),
            _ => Err(Error::input("selftest", format!("{failed} of {} checks fail", all.len()))),
        }
    }
}

fn line(check: &Check) -> String {
    let verdict = if check.holds { "holds" } else { "FAILS" };
    let Check { sampler, n, dim, claim, p_value, .. } = check;
    format!("{verdict}  p = {p_value:<8.2e} {sampler}, n = {n}, {dim}D: {claim}\n")
}

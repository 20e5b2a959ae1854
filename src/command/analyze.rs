//! `pairwave analyze`

use std::path::PathBuf;
use std::sync::Arc;

use pairwave::analysis::{self, Plan};
use pairwave::compute::Device;
use pairwave::request::{Request, shell_words};
use pairwave::source::Points;
use pairwave::{Result, Setting, check_threads, report};

use super::progress::{Bar, stop_on_interrupt, uninterrupted};
use super::{print, tell};

#[derive(clap::Args)]
pub(crate) struct Analyze {
    #[command(flatten)]
    request: Request,

    /// Directory for the results, to be created
    ///
    /// Directory for the results; created, never overwritten without --force
    #[arg(long, help_heading = "Output", value_name = "DIR", required_unless_present = "explain")]
    out: Option<PathBuf>,

    /// Replace a result that is already there
    #[arg(long, help_heading = "Output")]
    force: bool,

    /// Print the plan with its cost, and stop
    #[arg(long, help_heading = "Output")]
    explain: bool,

    /// No progress and no notes, only errors
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl Analyze {
    pub(crate) fn run(self) -> Result<()> {
        let out = self.out.as_ref().filter(|_| !self.explain);
        if let Some(out) = out {
            report::check_inputs(out, &self.request)?;
            report::check_out(out, self.force)?;
        }
        if let Some(threads) = self.request.threads {
            check_threads(threads)?;
        }
        let control = stop_on_interrupt()?;
        let source = Arc::new(Points::open_with(&self.request.input, &control)?);
        if !self.quiet && !self.explain {
            print(&format!("{}\n", source.first_line()))?;
        }
        let plan = Plan::of(&self.request, &source)?;
        if let Some(line) = plan.lists_read().filter(|_| !self.quiet && !self.explain) {
            print(&format!("{line}\n"))?;
        }
        let device = pairwave::control::wait(Device::open(self.request.device, self.request.threads))?;
        if let Some(note) = device.note().filter(|_| !self.quiet) {
            tell(&format!("note: {note}"));
        }
        let plan = plan.for_device(device.compute());
        let Some(out) = out else {
            if !self.quiet {
                source.warnings().iter().for_each(|warning| warn(warning));
            }
            return print(&format!("{}\ndevice: {}\n{plan}", source.first_line(), device.computed_by().device()));
        };
        let bar = Bar::new(self.quiet, &control);
        let mut analysis = analysis::run(&self.request, source, plan, &device, &control, &mut |p| bar.show(p))?;
        bar.finish();
        analysis.parameters.push(("command".into(), command_line().into()));
        let files = uninterrupted(|| report::write(out, &analysis, self.force))?;
        if !self.quiet {
            analysis.warnings.iter().for_each(|warning| warn(warning));
            print(&report::headline(&analysis))?;
            let names: Vec<_> = files.iter().filter_map(|f| f.file_name()?.to_str()).collect();
            print(&format!("{}: {}\n", out.display(), names.join(" ")))?;
        }
        Ok(())
    }
}

/// Says a warning, with settings under the names of their flags.
fn warn(warning: &str) {
    tell(&format!("warning: {}", Setting::renamed(warning, Setting::flag)));
}

/// What was typed.
fn command_line() -> String {
    let arguments = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned());
    shell_words(std::iter::once("pairwave".to_string()).chain(arguments))
}

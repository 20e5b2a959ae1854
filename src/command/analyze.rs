//! `pairwave analyze`

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pairwave::analysis::{self, Plan};
use pairwave::compute::Device;
use pairwave::control::Control;
use pairwave::prediction::Predicted;
use pairwave::request::{Request, shell_words};
use pairwave::source::{AllAxes, Points};
use pairwave::survey::{self, Prefixes, Views};
use pairwave::{Error, Result, Setting, check_threads, report};

use super::progress::{Bar, stop_on_interrupt, uninterrupted};
use super::{print, tell};

#[derive(clap::Args)]
pub(crate) struct Analyze {
    #[command(flatten)]
    request: Request,

    /// Directory for the results, to be created
    ///
    /// Directory for the results; created, never overwritten without --force. Without one nothing is written: the main numbers
    /// are printed, and a plot of g(r) and P(nu) where a terminal shows it
    #[arg(long, help_heading = "Output", value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace a result that is already there
    #[arg(long, help_heading = "Output")]
    force: bool,

    /// Measure every pair of axes, of 2 to 16
    ///
    /// Measure every pair of axes, of points with 2 to 16 coordinates: a table of discrepancies and least distances, of g and of P, and a
    /// contact sheet. What is done with samplers of more than 3 dimensions
    #[arg(long, help_heading = "Output", conflicts_with = "prefixes")]
    projections: bool,

    /// Measure the first points of every realization [2^4..2^14]
    ///
    /// Measure the first points of every realization, of numbers doubled from the first to the last (2^4..2^14) or listed (100,200,500):
    /// tables of discrepancies, least distances, g and P against n, and figures. N need not be given with a sampler
    #[arg(long, help_heading = "Output", value_name = "LO..HI")]
    prefixes: Option<Prefixes>,

    /// Print the plan with its cost, and stop
    #[arg(long, help_heading = "Output")]
    explain: bool,

    /// No progress and no notes, only errors
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl Analyze {
    pub(crate) fn run(self) -> Result<()> {
        if self.force && self.out.is_none() {
            return Err(Error::setting(Setting::Force, "(given)", "needs `out`: without it nothing is written"));
        }
        let out = self.out.as_ref().filter(|_| !self.explain);
        if let Some(out) = out {
            report::check_inputs(out, &self.request)?;
            report::check_out(out, self.force)?;
        }
        if let Some(threads) = self.request.threads {
            check_threads(threads)?;
        }
        let control = stop_on_interrupt()?;
        if let Some(views) = self.views() {
            return self.survey(views, &control);
        }
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
        if self.explain {
            if !self.quiet {
                source.warnings().iter().for_each(|warning| warn(warning));
            }
            return print(&format!("{}\ndevice: {}\n{plan}", source.first_line(), device.computed_by().device()));
        }
        let bar = Bar::new(self.quiet, &control);
        let mut analysis = analysis::run(&self.request, source, plan, &device, &control, &mut |p| bar.show(p))?;
        bar.finish();
        analysis.parameters.push(("command".into(), command_line().into()));
        let files = out.map(|out| uninterrupted(|| report::write(out, &analysis, self.force))).transpose()?;
        if !self.quiet {
            analysis.warnings.iter().for_each(|warning| warn(warning));
            print(&report::headline(&analysis))?;
        }
        match out.zip(files) {
            Some(_) if self.quiet => Ok(()),
            Some((out, files)) => {
                let names: Vec<_> = files.iter().filter_map(|f| f.file_name()?.to_str()).collect();
                print(&format!("{}: {}\n", out.display(), names.join(" ")))
            }
            // Nothing but what is printed is left of the run.
            None => {
                print(&format!("\n{}", report::numbers(&analysis)))?;
                plot_columns().map_or(Ok(()), |columns| print(&report::plots(&analysis, columns)))
            }
        }
    }
}

impl Analyze {
    /// What is asked for.
    pub(crate) fn request(&self) -> &Request {
        &self.request
    }

    /// The same with nothing but the integrals, unless statistics are asked for.
    pub(crate) fn integrating(mut self) -> Self {
        if self.request.stats == Request::default().stats {
            self.request.stats.clear();
        }
        self
    }

    /// Says and writes what was predicted without points.
    pub(crate) fn predicted(&self, found: &Predicted) -> Result<()> {
        let without = [
            (Setting::Prefixes, self.prefixes.is_some()),
            (Setting::Projections, self.projections),
            (Setting::Force, self.force && self.out.is_none()),
        ];
        if let Some((setting, _)) = without.into_iter().find(|(_, given)| *given) {
            let reason = match setting {
                Setting::Force => "needs `out`: without it nothing is written",
                _ => "is of points, and `p` predicts without them",
            };
            return Err(Error::setting(setting, "(given)", reason));
        }
        let out = self.out.as_deref().filter(|_| !self.explain);
        conclude(self.quiet, &found.warnings, &found.text(), out, |out, line| found.write(out, line, self.force))
    }

    /// What is looked at besides the points as they are.
    fn views(&self) -> Option<Views> {
        let many = self.request.input.sampler.is_some() && self.request.input.dim.is_some_and(|dim| dim > 3);
        match &self.prefixes {
            Some(prefixes) => Some(Views::Prefixes(prefixes.clone())),
            None => (self.projections || many).then_some(Views::Projections),
        }
    }

    fn survey(mut self, views: Views, control: &Arc<Control>) -> Result<()> {
        if self.explain {
            let setting = if self.prefixes.is_some() { Setting::Prefixes } else { Setting::Projections };
            return Err(Error::setting(setting, "(given)", "has no plan to be printed; expected no --explain"));
        }
        if let (Views::Prefixes(prefixes), Some(_)) = (&views, &self.request.input.sampler) {
            self.request.input.points.get_or_insert(prefixes.largest());
        }
        let points = AllAxes::open(&self.request.input, self.request.memory(), control)?;
        if !self.quiet {
            print(&format!("{}\n", points.first_line()))?;
        }
        let device = pairwave::control::wait(Device::open(self.request.device, self.request.threads))?;
        if let Some(note) = device.note().filter(|_| !self.quiet) {
            tell(&format!("note: {note}"));
        }
        let bar = Bar::new(self.quiet, control);
        let found = survey::run(views, &self.request, &points, &device, control, &mut |p| bar.show(p))?;
        bar.finish();
        let out = self.out.as_deref();
        conclude(self.quiet, &found.warnings, &found.text(), out, |out, line| found.write(out, line, self.force))
    }
}

/// Says what was found by a run that is no analysis, and writes it into `out`, with the line that was typed.
pub(super) fn conclude(
    quiet: bool,
    warnings: &[String],
    text: &str,
    out: Option<&Path>,
    write: impl FnOnce(&Path, &str) -> Result<Vec<PathBuf>>,
) -> Result<()> {
    if !quiet {
        warnings.iter().for_each(|warning| warn(warning));
        print(text)?;
    }
    let Some(out) = out else { return Ok(()) };
    let files = uninterrupted(|| write(out, &command_line()))?;
    let names: Vec<_> = files.iter().filter_map(|f| f.file_name()?.to_str()).collect();
    if quiet { Ok(()) } else { print(&format!("{}: {}\n", out.display(), names.join(" "))) }
}

/// The width of the terminal that standard output is, if it shows braille.
fn plot_columns() -> Option<usize> {
    let variable = |name| std::env::var(name).ok().filter(|value| !value.is_empty());
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(variable)?.to_lowercase();
    let unicode = locale.ends_with("utf-8") || locale.ends_with("utf8");
    let shows = unicode && std::io::stdout().is_terminal() && variable("TERM").is_some_and(|term| term != "dumb");
    let given = || variable("COLUMNS")?.parse().ok();
    let measured = || terminal_size::terminal_size_of(std::io::stdout()).map(|(width, _)| usize::from(width.0));
    shows.then(|| given().or_else(measured)).flatten()
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

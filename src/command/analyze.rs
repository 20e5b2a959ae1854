//! `pairwave analyze`

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pairwave::analysis::{Analysis, Ended, Measurement, Plan};
use pairwave::compute::Device;
use pairwave::control::Control;
use pairwave::prediction::Predicted;
use pairwave::report::Asked;
use pairwave::request::Request;
use pairwave::source::{AllAxes, Points};
use pairwave::survey::{self, Prefixes, Views};
use pairwave::{Error, Result, Setting, check_threads, comparison, report, source};

use super::batch::{self, Batch};
use super::config;
use super::progress::{Bar, Tell, stop_on_interrupt, unhurried, uninterrupted};
use super::{print, tell};

#[derive(Clone, clap::Args)]
pub(crate) struct Analyze {
    #[command(flatten)]
    request: Request,

    #[command(flatten)]
    batch: Batch,

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

    /// Measure other points too and compare: files, or a sampler
    ///
    /// Measure other points by the same settings too and compare them with the first: files, or a sampler (NAME or NAME:key=value,...) of as many
    /// points and realizations; several times for several. Every result is a directory in --out, beside a page of all and `pairwave compare`'s table
    #[arg(long, help_heading = "Output", value_name = "FILES|SAMPLER", hide_short_help = true, requires = "out",
        conflicts_with_all = ["projections", "prefixes", "explain"])]
    beside: Vec<String>,

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
        let control = stop_on_interrupt()?;
        match self.beside.is_empty() {
            true => self.run_with(&control),
            false => self.side_by_side(&control),
        }
    }

    fn run_with(mut self, control: &Arc<Control>) -> Result<()> {
        self.request.input = source::scanned(self.request.input)?;
        let out = self.out.as_deref().filter(|_| !self.explain);
        if let Some(out) = out {
            report::check_inputs(out, &self.request)?;
            self.batch.check_out(out, self.force)?;
        }
        if let Some(threads) = self.request.threads {
            check_threads(threads)?;
        }
        if let Some(views) = self.views() {
            if let Some(setting) = self.batch.given() {
                let reason = "is of one measurement; `projections` and `prefixes` are many";
                return Err(Error::setting(setting, "(given)", reason));
            }
            return self.survey(views, control);
        }
        let source = Arc::new(Points::open_with(&self.request.input, control)?);
        if !self.quiet && !self.explain {
            print(&format!("{}\n", source.first_line()))?;
        }
        let plan = Plan::of(&self.request, &source)?;
        if let Some(line) = plan.lists_read().filter(|_| !self.quiet && !self.explain) {
            print(&format!("{line}\n"))?;
        }
        let device = pairwave::control::wait(plan.open(&self.request))?;
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
        let whole = Measurement::new(self.request.clone(), source, plan);
        let mut measurement = self.batch.begin(whole, out, &device)?;
        if measurement.realizations() > 0 && !self.quiet {
            tell(&format!("note: {} are there already", measurement.held()));
        }
        let bar = Bar::told(if self.quiet { Tell::None } else { self.batch.progress }, control);
        let job = self.batch.job(out);
        job.check(&measurement)?;
        let ended = job.measure(&mut measurement, &device, control, &mut |p| bar.show(p));
        let ended = match ended {
            Ended::Whole if self.batch.shard.is_none() => {
                let found = pairwave::control::wait(measurement.finish(&device, control, &mut |p| bar.show(p)));
                match found {
                    Ok(found) => {
                        bar.finish();
                        let sums = self.batch.keep_sums.then(|| measurement.write());
                        match device.pool().install(|| self.conclude(found, out, sums.as_deref())) {
                            Err(error @ Error::File { .. }) => Ended::Failed(error),
                            done => return done,
                        }
                    }
                    Err(error) => Ended::Failed(error),
                }
            }
            other => other,
        };
        bar.finish();
        unhurried();
        device.pool().install(|| self.keep(&measurement, out, ended))
    }

    /// Measures the points and those beside them, each into a directory of its own, and compares the others with the first.
    fn side_by_side(mut self, control: &Arc<Control>) -> Result<()> {
        let Some(out) = self.out.take() else { return Ok(()) };
        if let Some(setting) = self.batch.of_one() {
            return Err(Error::setting(setting, "(given)", "is of one measurement, and `beside` makes several"));
        }
        // Only a comparison is gone on with.
        let force = self.force || self.batch.resumes() && out.join("comparison.csv").is_file();
        report::check_out(&out, force)?;
        self.request.input = source::scanned(self.request.input)?;
        self.beside.iter().try_for_each(|spec| comparison::check_beside(&self.request, spec))?;
        let (asked, specs) = (config::asked(), std::mem::take(&mut self.beside));
        let input = &self.request.input;
        let first = match &input.sampler {
            Some(name) => std::iter::once(name).chain(&input.params).map(String::as_str).collect::<Vec<_>>().join(","),
            None => input.files.first().map_or("points".into(), |file| file.display().to_string()),
        };
        let (mut dirs, mut notes): (Vec<PathBuf>, Vec<String>) = (Vec::new(), Vec::new());
        for (k, spec) in std::iter::once(first).chain(specs).enumerate() {
            let name = folder(&spec, |name| dirs.contains(&out.join(name)));
            dirs.push(out.join(name));
            let mut one = self.clone();
            if k > 0 {
                one.request = comparison::beside(&self.request, &spec, &dirs[0])?;
                let without = comparison::unmarked(&self.request, &one.request);
                notes.extend(without.map(|without| format!("{}: {without}", dirs[k].display())));
            }
            config::keep_part(&one.words())?;
            if self.batch.is_whole(&dirs[k]) {
                let settings = std::fs::read_to_string(dirs[k].join(report::SETTINGS)).ok();
                if settings != config::asked().settings {
                    let reason = "holds a result of other settings; `force` without `resume` measures anew";
                    return Err(Error::setting(Setting::Out, dirs[k].display(), reason));
                }
                if !self.quiet {
                    tell(&format!("note: {} is there already", dirs[k].display()));
                }
                continue;
            }
            one.out = Some(dirs[k].clone());
            one.run_with(control)?;
        }
        config::ask(asked);
        let mut found = comparison::compare(&dirs, comparison::ALPHA)?;
        found.notes.splice(0..0, notes);
        conclude(self.quiet, &found.notes, &found.text(), Some(&out), |out, asked| found.write(out, asked, force))
    }

    /// The command that makes this result.
    fn words(&self) -> Vec<String> {
        let mut request = self.request.clone();
        let command = if request.stats.is_empty() { "integrate" } else { "analyze" };
        if request.stats.is_empty() {
            request.stats = Request::default().stats;
        }
        std::iter::once(command.into()).chain(self.batch.words()).chain(request.arguments()).collect()
    }

    /// Writes and says what was found.
    fn conclude(&self, mut found: Analysis, out: Option<&Path>, sums: Option<&[u8]>) -> Result<()> {
        let files = out.map(|out| self.write(out, &mut found, sums)).transpose()?;
        say(&found, out.zip(files.as_deref()), self.quiet)
    }

    fn write(&self, out: &Path, found: &mut Analysis, sums: Option<&[u8]>) -> Result<Vec<PathBuf>> {
        batch::write(out, found, sums, self.batch.npz, self.force || self.batch.owns())
    }

    /// Keeps what there is of a run that did not come to its end, or is to be merged.
    fn keep(&self, measurement: &Measurement, out: Option<&Path>, ended: Ended) -> Result<()> {
        let held = measurement.held();
        let found = |measurement: &Measurement| {
            let mut found = measurement.analysis()?;
            found.warnings.push(format!("this is not all that was asked for: {held} were measured"));
            Some(found)
        };
        let Some(out) = out.filter(|_| measurement.realizations() > 0) else {
            return match ended {
                Ended::Failed(error) => Err(error),
                _ => found(measurement).map_or(Ok(()), |found| self.conclude(found, None, None)),
            };
        };
        let written = match found(measurement).filter(|_| self.batch.shard.is_none() && measurement.is_even()) {
            Some(mut found) => match self.write(out, &mut found, Some(&measurement.write())) {
                // No room for pictures may be room for sums.
                Err(Error::File { .. }) => uninterrupted(|| measurement.save(out)),
                written => written.map(drop),
            },
            None if !self.force && !self.batch.owns() && out.join(report::SUMS).exists() => {
                let reason = "holds sums that another run has written meanwhile; expected a directory for each part";
                Err(Error::input(out.display().to_string(), reason))
            }
            None => uninterrupted(|| measurement.save(out)),
        };
        let kept = match &written {
            Ok(()) => format!("{held} are kept in {}: the same command with `resume` goes on", out.display()),
            Err(error) => {
                // What was there before is there.
                let last = Measurement::load(out).map(|last| {
                    format!(
                        "; {} of the last checkpoint are in {}: `resume` goes on with them",
                        last.held(),
                        out.display()
                    )
                });
                format!("{held} could not be kept: {error}{}", last.unwrap_or_default())
            }
        };
        match ended {
            Ended::Failed(error) => Err(Error::Unfinished { error: Box::new(error), kept }),
            _ if written.is_err() => written,
            Ended::Late => {
                tell(&format!("note: the time was up; {}", Setting::renamed(&kept, Setting::flag)));
                Ok(())
            }
            Ended::Whole if self.quiet => Ok(()),
            Ended::Whole => print(&format!("{}: {}, {held}\n", out.display(), report::SUMS)),
        }
    }
}

/// Says what was found and which files hold it.
pub(super) fn say(found: &Analysis, files: Option<(&Path, &[PathBuf])>, quiet: bool) -> Result<()> {
    if !quiet {
        found.warnings.iter().for_each(|warning| warn(warning));
        print(&report::headline(found))?;
    }
    match files {
        Some(_) if quiet => Ok(()),
        Some((out, files)) => {
            let names: Vec<_> = files.iter().filter_map(|f| f.file_name()?.to_str()).collect();
            print(&format!("{}: {}\n", out.display(), names.join(" ")))
        }
        // Nothing but what is printed is left of the run.
        None => {
            print(&format!("\n{}", report::numbers(found)))?;
            plot_columns().map_or(Ok(()), |columns| print(&report::plots(found, columns)))
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
        if let Some(setting) = self.batch.given() {
            return Err(Error::setting(setting, "(given)", "is of points, and `p` predicts without them"));
        }
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
        conclude(self.quiet, &found.warnings, &found.text(), out, |out, asked| found.write(out, asked, self.force))
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
        conclude(self.quiet, &found.warnings, &found.text(), out, |out, asked| found.write(out, asked, self.force))
    }
}

/// Says what was found by a run that is no analysis, and writes it into `out`, with the line that was typed.
pub(super) fn conclude(
    quiet: bool,
    warnings: &[String],
    text: &str,
    out: Option<&Path>,
    write: impl FnOnce(&Path, &Asked) -> Result<Vec<PathBuf>>,
) -> Result<()> {
    if !quiet {
        warnings.iter().for_each(|warning| warn(warning));
        print(text)?;
    }
    let Some(out) = out else { return Ok(()) };
    let files = uninterrupted(|| write(out, &config::asked()))?;
    let names: Vec<_> = files.iter().filter_map(|f| f.file_name()?.to_str()).collect();
    if quiet { Ok(()) } else { print(&format!("{}: {}\n", out.display(), names.join(" "))) }
}

/// A name for the folder of a result: what it is of, without what a path cannot have, and another than those that are taken.
fn folder(spec: &str, taken: impl Fn(&str) -> bool) -> String {
    let short = if Path::new(spec).exists() {
        Path::new(spec).file_stem().map(|stem| stem.to_string_lossy().into_owned())
    } else {
        None
    };
    let plain = |c: char| if c.is_alphanumeric() || "._-=".contains(c) { c } else { '-' };
    let name: String = short.as_deref().unwrap_or(spec).chars().map(plain).collect();
    let name = match name.trim_matches(['.', '-']) {
        "" => "points",
        name => name,
    };
    let numbered = (2..).map(|k| format!("{name}-{k}"));
    std::iter::once(name.to_string()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
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

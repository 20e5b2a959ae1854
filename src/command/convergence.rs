//! `pairwave convergence`

use std::path::PathBuf;

use pairwave::compute::Device;
use pairwave::convergence::{self, Subjects};
use pairwave::plan::{Accuracy, By, Estimator};
use pairwave::request::{DeviceChoice, Request};
use pairwave::survey::Prefixes;
use pairwave::{Error, Result, Setting, check_threads, report};

use super::analyze::conclude;
use super::progress::{Bar, stop_on_interrupt};
use super::tell;

#[derive(clap::Args)]
pub(crate) struct Convergence {
    /// A file or folder per number of points, or files for --prefixes
    #[arg(value_name = "FILES", help_heading = "Points", conflicts_with = "samplers")]
    files: Vec<PathBuf>,

    /// A sampler, NAME or NAME:key=value,...; may be repeated
    #[arg(long = "sampler", help_heading = "Points", value_name = "NAME", requires = "points")]
    samplers: Vec<String>,

    /// Numbers of points, 2^4..2^12 (doubled) or 100,200,500
    #[arg(
        short = 'n',
        long = "points",
        help_heading = "Points",
        value_name = "LO..HI",
        requires = "samplers",
        conflicts_with = "files"
    )]
    points: Option<Prefixes>,

    /// Number of realizations of each number of points
    #[arg(
        short = 'k',
        long = "realizations",
        help_heading = "Points",
        value_name = "K",
        requires = "samplers",
        conflicts_with = "files"
    )]
    realizations: Option<u64>,

    /// Dimension, 1 to 3
    #[arg(long, help_heading = "Points", value_name = "D", requires = "samplers", conflicts_with = "files")]
    dim: Option<usize>,

    /// Seed, from which each number of points has its own
    #[arg(long, help_heading = "Points", requires = "samplers", conflicts_with = "files")]
    seed: Option<u64>,

    /// A parameter of every sampler that has it; may be repeated
    #[arg(
        long = "param",
        help_heading = "Points",
        value_name = "KEY=VALUE",
        requires = "samplers",
        conflicts_with = "files"
    )]
    params: Vec<String>,

    /// The first points of every realization in the files instead, 2^4..2^12 or 100,200,500
    #[arg(long, help_heading = "Points", value_name = "LO..HI", requires = "files", conflicts_with = "samplers")]
    prefixes: Option<Prefixes>,

    /// Columns of the coordinates, as in x,y
    #[arg(long, help_heading = "Points", value_name = "C1,C2[,C3]", requires = "files", conflicts_with = "samplers")]
    columns: Option<String>,

    /// Sides of the torus
    #[arg(long = "box", help_heading = "Points", value_name = "L1,L2[,L3]", value_delimiter = ',')]
    sides: Option<Vec<f64>>,

    /// Fold points outside the torus back in
    #[arg(long, help_heading = "Points", requires = "files", conflicts_with = "samplers")]
    wrap: bool,

    /// An integrand, NAME or NAME:key=value,...; may be repeated
    #[arg(long = "integrand", help_heading = "Integration", value_name = "SPEC")]
    integrands: Vec<String>,

    /// mean, ratio or lambda
    #[arg(long, help_heading = "Integration", value_enum)]
    estimator: Option<Estimator>,

    /// Shifts of each realization
    #[arg(long, help_heading = "Integration", value_name = "S")]
    shifts: Option<u32>,

    /// The density that points are placed by, NAME or NAME:key=value,...
    #[arg(long, help_heading = "Integration", value_name = "SPEC")]
    intensity: Option<String>,

    /// removal or warp
    #[arg(long, help_heading = "Integration", value_enum, requires = "intensity")]
    by: Option<By>,

    /// What computes
    #[arg(long, help_heading = "Computing", default_value = "auto", value_name = "auto|cpu|gpu|reference|INDEX")]
    device: DeviceChoice,

    /// fast or high: the promise about P
    #[arg(long, help_heading = "Computing", value_enum, default_value = "fast")]
    accuracy: Accuracy,

    /// Number of threads
    #[arg(long, help_heading = "Computing", value_name = "T")]
    threads: Option<usize>,

    /// Directory for tables, figure and summary; without one tables are printed
    #[arg(long, help_heading = "Output", value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace a result that is already there
    #[arg(long, help_heading = "Output")]
    force: bool,

    /// No progress and no notes, only errors
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl Convergence {
    pub(crate) fn run(self) -> Result<()> {
        if self.force && self.out.is_none() {
            return Err(Error::setting(Setting::Force, "(given)", "needs `out`: without it nothing is written"));
        }
        let mut request = Request {
            integrand: self.integrands,
            estimator: self.estimator,
            shifts: self.shifts,
            intensity: self.intensity,
            by: self.by,
            device: self.device,
            accuracy: self.accuracy,
            threads: self.threads,
            ..Request::default()
        };
        let input = &mut request.input;
        (input.realizations, input.dim, input.seed, input.params) =
            (self.realizations, self.dim, self.seed, self.params);
        (input.columns, input.sides, input.wrap, input.files) = (self.columns, self.sides, self.wrap, self.files);
        let subjects = match (self.points, self.prefixes) {
            (Some(numbers), _) => Subjects::Samplers(self.samplers, numbers),
            (_, Some(numbers)) => Subjects::Prefixes(numbers),
            _ => Subjects::Groups(input.files.clone()),
        };
        if let Some(out) = &self.out {
            report::check_inputs(out, &request)?;
            report::check_out(out, self.force)?;
        }
        if let Some(threads) = request.threads {
            check_threads(threads)?;
        }
        let control = stop_on_interrupt()?;
        let device = pairwave::control::wait(Device::open(request.device, request.threads))?;
        if let Some(note) = device.note().filter(|_| !self.quiet) {
            tell(&format!("note: {note}"));
        }
        let bar = Bar::new(self.quiet, &control);
        let found = convergence::run(&subjects, &request, &device, &control, &mut |p| bar.show(p))?;
        bar.finish();
        let out = self.out.as_deref();
        conclude(self.quiet, &found.warnings, &found.text(), out, |out, asked| found.write(out, asked, self.force))
    }
}

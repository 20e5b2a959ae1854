//! `pairwave bench`

use std::path::PathBuf;

use pairwave::benchmark::{self, Section, Wanted};
use pairwave::request::DeviceChoice;
use pairwave::{Error, Result, Setting, check_threads, report};

use super::analyze::conclude;
use super::progress::{Bar, stop_on_interrupt};

#[derive(clap::Args)]
pub(crate) struct Bench {
    /// Small problems and few runs: half a minute instead of some minutes
    #[arg(long)]
    quick: bool,

    /// Only these sections
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    only: Vec<Section>,

    /// A sampler whose errors are held against time, NAME or NAME:key=value,...; may be repeated
    ///
    /// A sampler whose errors are held against time beside those of random points, NAME or NAME:key=value,...; may be repeated. Without --only,
    /// that is all that is measured
    #[arg(long = "sampler", value_name = "NAME")]
    samplers: Vec<String>,

    /// What samplers integrate (2D), as `pairwave integrands` lists them; may be repeated
    #[arg(long = "integrand", value_name = "SPEC")]
    integrands: Vec<String>,

    /// Measure what methods cost here into a file, for --costs
    ///
    /// Measure what the parts of methods cost on this machine and write it into FILE, which `analyze --costs FILE` chooses its methods by. Without
    /// --only, that and the growth of times is all that is measured
    #[arg(long, value_name = "FILE")]
    calibrate: Option<PathBuf>,

    /// What is timed beside the CPU path
    #[arg(long, default_value = "auto", value_name = "auto|cpu|gpu|INDEX")]
    device: DeviceChoice,

    /// Number of threads of the CPU path [default: 1]
    #[arg(long, value_name = "T")]
    threads: Option<usize>,

    /// Directory for tables, figures and the page; without one tables are printed
    #[arg(long, help_heading = "Output", value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace a result that is already there
    #[arg(long, help_heading = "Output")]
    force: bool,

    /// No progress and no notes, only errors
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl Bench {
    pub(crate) fn run(self) -> Result<()> {
        if self.force && self.out.is_none() && self.calibrate.is_none() {
            return Err(Error::setting(Setting::Force, "(given)", "needs `out`: without it nothing is written"));
        }
        if self.device == DeviceChoice::Reference {
            let reason = "is what the others are held against; expected auto, cpu, gpu or the index of an adapter";
            return Err(Error::setting(Setting::Device, "reference", reason));
        }
        if let Some(out) = &self.out {
            report::check_out(out, self.force)?;
        }
        let (of_samplers, given) = (self.samplers.first(), self.only.contains(&Section::Samplers));
        if let Some(value) = of_samplers.filter(|_| !self.only.is_empty() && !given) {
            return Err(Error::setting(Setting::Sampler, value, "is of the section samplers, which --only leaves out"));
        }
        if let Some(value) = self.integrands.first().filter(|_| !self.only.is_empty() && !given) {
            return Err(Error::setting(
                Setting::Integrand,
                value,
                "is of the section samplers, which --only leaves out",
            ));
        }
        if let Some(path) = &self.calibrate {
            report::check_file(Setting::Calibrate, path, self.force)?;
            if let Some(threads) = self.threads.filter(|threads| *threads > 1) {
                return Err(Error::setting(
                    Setting::Threads,
                    threads,
                    "costs are of one thread; expected 1, or no `calibrate`",
                ));
            }
        }
        self.threads.map_or(Ok(()), check_threads)?;
        let control = stop_on_interrupt()?;
        let wanted = Wanted {
            sections: self.only,
            quick: self.quick,
            device: self.device,
            threads: self.threads,
            samplers: self.samplers,
            integrands: self.integrands,
            calibrate: self.calibrate.is_some(),
        };
        let bar = Bar::new(self.quiet, &control);
        let found = benchmark::run(&wanted, &control, &mut |p| bar.show(p))?;
        bar.finish();
        if let Some((path, calibration)) = self.calibrate.as_ref().zip(found.calibration.as_ref()) {
            calibration.write(path, self.force)?;
        }
        let out = self.out.as_deref();
        conclude(self.quiet, &found.warnings, &found.text(), out, |out, asked| found.write(out, asked, self.force))
    }
}

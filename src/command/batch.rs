//! What is said of long runs: parts of them, what is kept on the way, when they end.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use pairwave::analysis::{Analysis, Job, Measurement, Target};
use pairwave::compute::Device;
use pairwave::report::Beside;
use pairwave::{Error, Result, Setting, report};

use super::config;
use super::progress::{Tell, uninterrupted};

#[derive(Clone, clap::Args)]
pub(crate) struct Batch {
    /// Measure part I of N of the realizations, for `pairwave merge`
    ///
    /// Measure part I of N of the realizations and leave their sums in --out: `pairwave merge` makes one result of all parts, byte for byte
    /// that of one run. Parts may run anywhere, in any order; each is planned as a part of the whole
    #[arg(long, help_heading = "Batches", value_name = "I/N", hide_short_help = true, requires = "out")]
    pub(crate) shard: Option<Shard>,

    /// Write the sums into --out every so many seconds
    ///
    /// Write the sums into --out every so many seconds, so that whatever ends the run loses no more; --resume goes on with them
    #[arg(long, help_heading = "Batches", value_name = "SECONDS", value_parser = seconds, hide_short_help = true, requires = "out")]
    checkpoint: Option<Duration>,

    /// Go on with the run that --out holds, if it holds one
    ///
    /// Go on with the run that --out holds, which was stopped, killed or out of time; the result is that of a run that was not. Where there
    /// is none, begin
    #[arg(long, help_heading = "Batches", hide_short_help = true, requires = "out")]
    resume: bool,

    /// Add realizations to those of a result that kept its sums
    ///
    /// Add realizations to those of a result that kept its sums (--keep-sums): of a sampler, whose -k says how many there are to be, or of files,
    /// the same first and others after them
    #[arg(long, help_heading = "Batches", value_name = "DIR", hide_short_help = true, conflicts_with_all = ["shard", "resume"])]
    extend: Option<PathBuf>,

    /// End after so many seconds with what is measured then
    #[arg(long, help_heading = "Batches", value_name = "SECONDS", value_parser = seconds, hide_short_help = true)]
    time_limit: Option<Duration>,

    /// End when a number is known well enough, as pcf@0.05:0.01
    ///
    /// End when a number of the result is known to a standard error: TABLE[.COLUMN]@PLACE:ERROR, the error absolute or with % of the value, as
    /// pcf@0.05:0.01 (g in the bin of r = 0.05), spectrum_radial@20:2%, spectrum@3,-4:0.1 (P at a wave vector) or
    /// variance.var_spectral@disk:5%; several times for several. -k, or the files, say how many realizations there may be. The error that
    /// counts is larger than that of the table, for it is looked at more than once
    #[arg(long, help_heading = "Batches", value_name = "FIGURE:ERROR", hide_short_help = true)]
    until_error: Vec<Target>,

    /// auto, json (a line a second on standard error) or none
    #[arg(
        long,
        help_heading = "Output",
        value_enum,
        default_value = "auto",
        hide_short_help = true,
        value_name = "auto|json|none",
        hide_possible_values = true
    )]
    pub(crate) progress: Tell,

    /// Keep the raw sums beside the result, for --extend and `pairwave merge`
    #[arg(long, help_heading = "Batches", hide_short_help = true, requires = "out")]
    pub(crate) keep_sums: bool,

    /// Write all numbers into one file too, results.npz
    ///
    /// Write all numbers into one file too, results.npz in --out, beside the tables and arrays: numpy reads the columns of tables as
    /// pcf/g, the arrays as spectrum
    #[arg(long, help_heading = "Output", hide_short_help = true, requires = "out")]
    pub(crate) npz: bool,
}

/// Writes a result with the line that was typed, the settings that came of it, and what else is to stand beside it.
pub(crate) fn write(
    out: &Path,
    found: &mut Analysis,
    sums: Option<&[u8]>,
    npz: bool,
    force: bool,
) -> Result<Vec<PathBuf>> {
    let asked = config::asked();
    found.parameters.push(("command".into(), asked.command.into()));
    let beside = Beside { sums, settings: asked.settings.as_deref(), npz };
    uninterrupted(|| report::write_with(out, found, beside, force))
}

/// `3/20`
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shard {
    part: u64,
    of: u64,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parts = text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((part, of)) if (1..=of).contains(&part) => Ok(Self { part, of }),
            _ => Err("expected I/N with 1 <= I <= N, as 3/20".into()),
        }
    }
}

fn seconds(text: &str) -> std::result::Result<Duration, String> {
    let seconds = text.parse().ok().filter(|s: &f64| *s >= 0.0).and_then(|s| Duration::try_from_secs_f64(s).ok());
    seconds.ok_or_else(|| "expected a number of seconds, 0 or more".into())
}

impl Batch {
    /// The first of these settings that is given, for what has no use for them.
    pub(crate) fn given(&self) -> Option<Setting> {
        let all = [
            (Setting::Shard, self.shard.is_some()),
            (Setting::Checkpoint, self.checkpoint.is_some()),
            (Setting::Resume, self.resume),
            (Setting::Extend, self.extend.is_some()),
            (Setting::TimeLimit, self.time_limit.is_some()),
            (Setting::UntilError, !self.until_error.is_empty()),
            (Setting::KeepSums, self.keep_sums),
            (Setting::Npz, self.npz),
        ];
        all.into_iter().find(|(_, given)| *given).map(|(setting, _)| setting)
    }

    /// The first of these settings that is given, for who measures several things.
    pub(crate) fn of_one(&self) -> Option<Setting> {
        let all = [(Setting::Shard, self.shard.is_some()), (Setting::Extend, self.extend.is_some())];
        all.into_iter().find(|(_, given)| *given).map(|(setting, _)| setting)
    }

    /// Whether an earlier run is gone on with.
    pub(crate) fn resumes(&self) -> bool {
        self.resume
    }

    /// What of these settings a result depends on, as it is typed.
    pub(crate) fn words(&self) -> Vec<String> {
        let until = self.until_error.iter().map(|target| format!("--until-error={target}"));
        let kept = [("--keep-sums", self.keep_sums), ("--npz", self.npz)];
        let kept = kept.into_iter().filter(|(_, given)| *given).map(|(flag, _)| flag.to_string());
        // They need a directory, which is none of the settings.
        let out = ["--out=DIR".to_string()];
        until.chain(kept).chain(out).collect()
    }

    /// Whether there is nothing left to go on with in `out`.
    pub(crate) fn is_whole(&self, out: &Path) -> bool {
        self.resume && out.join("summary.json").exists() && !out.join(report::SUMS).exists()
    }

    /// Whether the run may write into `out`, asked before the long work.
    pub(crate) fn check_out(&self, out: &Path, force: bool) -> Result<()> {
        let there = |name: &str| out.join(name).exists();
        if self.is_whole(out) && !force {
            let reason = "holds a result that is whole: there is nothing to go on with; `force` replaces it";
            return Err(Error::setting(Setting::Out, out.display(), reason));
        }
        report::check_out(out, force || self.resume && there(report::SUMS))
    }

    /// Whether what `out` holds is of this run, and may be replaced by its result.
    pub(crate) fn owns(&self) -> bool {
        self.resume || self.checkpoint.is_some()
    }

    /// When the run leaves its sums behind, and when it ends.
    pub(crate) fn job(&self, out: Option<&Path>) -> Job {
        Job {
            checkpoint: out.map(Path::to_path_buf).zip(self.checkpoint),
            time_limit: self.time_limit,
            until: self.until_error.clone(),
        }
    }

    /// The part of the run that is to be done, with what was done before.
    pub(crate) fn begin(&self, whole: Measurement, out: Option<&Path>, device: &Device) -> Result<Measurement> {
        let part = match self.shard {
            Some(Shard { part, of }) => whole.shard(part, of, device)?,
            None => whole,
        };
        let of = |place: &Path, error: Error| Error::input(place.display().to_string(), error.told(Setting::flag));
        if let Some(place) = &self.extend {
            return part.extend(Measurement::load(place)?, device).map_err(|error| of(place, error));
        }
        match out.filter(|out| self.resume && out.join(report::SUMS).is_file()) {
            Some(place) => part.resume(Measurement::load(place)?).map_err(|error| of(place, error)),
            None => Ok(part),
        }
    }
}

//! `pairwave merge`

use std::path::PathBuf;

use pairwave::analysis::Measurement;
use pairwave::{Error, Result, Setting, report};

use super::analyze::say;
use super::batch;
use super::progress::stop_on_interrupt;

#[derive(clap::Args)]
pub(crate) struct Merge {
    /// Directories of shards, of unfinished runs or of results that kept their sums, or such files
    #[arg(required = true, value_name = "DIR")]
    parts: Vec<PathBuf>,

    /// Directory for the result, to be created
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// Accept that realizations are missing, which the result says
    #[arg(long)]
    partial: bool,

    /// Keep the raw sums beside the result, for `pairwave analyze --extend`
    #[arg(long)]
    keep_sums: bool,

    /// Write all numbers into one file too, results.npz
    #[arg(long)]
    npz: bool,

    /// Replace a result that is already there
    #[arg(long)]
    force: bool,

    /// Only errors
    #[arg(long)]
    quiet: bool,
}

impl Merge {
    pub(crate) fn run(self) -> Result<()> {
        report::check_not_read(&self.out, &self.parts)?;
        report::check_out(&self.out, self.force)?;
        let control = stop_on_interrupt()?;
        let mut parts = self.parts.iter();
        let Some(first) = parts.next() else { return Ok(()) };
        let mut whole = Measurement::load(first)?;
        for part in parts {
            control.check()?;
            let of = |error: Error| Error::input(part.display().to_string(), error.told(Setting::flag));
            whole.merge(Measurement::load(part)?).map_err(of)?;
        }
        if let Some(missing) = whole.missing() {
            if !self.partial {
                let reason = format!("no part has the realizations {missing}; `partial` does without them");
                return Err(Error::input("merge", reason));
            }
            whole.note(format!("{} were merged; the others, {missing}, are missing", whole.held()));
        }
        if let Some(what) = whole.needs_all() {
            let reason = format!("{what} needs the points: expected the run to be gone on with, by `resume`");
            return Err(Error::input("merge", reason));
        }
        let nothing = || Error::input(first.display().to_string(), "holds no realizations");
        let mut found = whole.analysis().ok_or_else(nothing)?;
        let sums = self.keep_sums.then(|| whole.write());
        let files = batch::write(&self.out, &mut found, sums.as_deref(), self.npz, self.force)?;
        say(&found, Some((&self.out, &files)), self.quiet)
    }
}

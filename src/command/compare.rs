//! `pairwave compare`

use std::path::PathBuf;
use std::process::ExitCode;

use pairwave::{Result, comparison, report};

use super::analyze::conclude;
use super::print;

/// The exit code where results differ: others tell of errors.
const DIFFER: u8 = 3;

#[derive(clap::Args)]
pub(crate) struct Compare {
    /// Directories of results: the first, and those that are compared with it
    #[arg(required = true, num_args = 2.., value_name = "DIR")]
    results: Vec<PathBuf>,

    /// Level of significance of the test over everything
    #[arg(long, value_name = "P", default_value_t = comparison::ALPHA)]
    alpha: f64,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,

    /// Directory for the difference of every value, to be created
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace a result that is already there
    #[arg(long, requires = "out")]
    force: bool,

    /// Say nothing: the exit code tells, 0 where they agree and 3 where they differ
    #[arg(long)]
    quiet: bool,
}

impl Compare {
    pub(crate) fn run(self) -> Result<ExitCode> {
        if let Some(out) = &self.out {
            report::check_not_read(out, &self.results)?;
            report::check_out(out, self.force)?;
        }
        let found = comparison::compare(&self.results, self.alpha)?;
        let text = if self.json { String::new() } else { found.text() };
        let out = self.out.as_deref();
        let quiet = self.quiet || self.json;
        conclude(quiet, &found.notes, &text, out, |out, asked| found.write(out, asked, self.force))?;
        if self.json {
            print(&format!("{}\n", found.json()))?;
        }
        Ok(if found.differ { ExitCode::from(DIFFER) } else { ExitCode::SUCCESS })
    }
}

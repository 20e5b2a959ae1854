//! `pairwave scan`

use std::path::PathBuf;

use pairwave::report;
use pairwave::request::PointsRequest;
use pairwave::source::Scan;
use pairwave::{Result, Setting};

use super::progress::stop_on_interrupt;
use super::{print, tell};

#[derive(clap::Args)]
pub(crate) struct Asked {
    #[command(flatten)]
    points: PointsRequest,

    /// File for what is found, which `analyze` takes in place of the files
    #[arg(long, help_heading = "Output", value_name = "FILE")]
    out: PathBuf,

    /// Replace a file that is already there
    #[arg(long, help_heading = "Output")]
    force: bool,

    /// No notes, only errors
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

impl Asked {
    pub(crate) fn run(self) -> Result<()> {
        let control = stop_on_interrupt()?;
        report::check_file(Setting::Out, &self.out, self.force)?;
        report::check_not_read(&self.out, &self.points.files)?;
        let scan = Scan::of(&self.points, &control)?;
        if !self.quiet {
            scan.warnings()
                .iter()
                .for_each(|warning| tell(&format!("warning: {}", Setting::renamed(warning, Setting::flag))));
        }
        report::write_file(&self.out, &scan.write(), self.force)?;
        if self.quiet { Ok(()) } else { print(&format!("{}: {}\n", self.out.display(), scan.first_line())) }
    }
}

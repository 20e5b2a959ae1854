//! `pairwave plot`

use std::path::PathBuf;

use pairwave::Result;
use pairwave::report::Plot as Asked;

use super::{print, tell};

#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Plot {
    #[command(flatten)]
    plot: Asked,

    /// A file, or a directory for one file per figure
    #[arg(long, value_name = "FILE|DIR")]
    out: PathBuf,

    /// Replace files that are already there
    #[arg(long)]
    force: bool,

    /// No notes, only errors
    #[arg(long)]
    quiet: bool,
}

impl Plot {
    pub(crate) fn run(self) -> Result<()> {
        let plotted = self.plot.draw(&self.out, self.force)?;
        if self.quiet {
            return Ok(());
        }
        plotted.warnings.iter().for_each(|difference| tell(&format!("warning: measured otherwise: {difference}")));
        plotted.files.iter().try_for_each(|file| print(&format!("{}\n", file.display())))
    }
}

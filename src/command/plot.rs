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
    #[arg(long, value_name = "FILE|DIR", required_unless_present = "page")]
    out: Option<PathBuf>,

    /// One HTML page: every figure with its numbers, what differs between the results, their scalars side by side
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,

    /// Replace files that are already there
    #[arg(long)]
    force: bool,

    /// No notes, only errors
    #[arg(long)]
    quiet: bool,
}

impl Plot {
    pub(crate) fn run(self) -> Result<()> {
        let drawn = self.out.as_ref().map(|out| self.plot.draw(out, self.force)).transpose()?;
        let page = self.page.as_ref().map(|page| self.plot.page(page, self.force)).transpose()?;
        if self.quiet {
            return Ok(());
        }
        if let Some(plotted) = drawn.as_ref().or(page.as_ref()) {
            plotted.warnings.iter().for_each(|difference| tell(&format!("warning: measured otherwise: {difference}")));
        }
        let files = drawn.iter().chain(&page).flat_map(|plotted| &plotted.files);
        files.map(|file| file.display()).try_for_each(|file| print(&format!("{file}\n")))
    }
}

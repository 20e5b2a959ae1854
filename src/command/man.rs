//! `pairwave man`

use std::path::PathBuf;

use clap::Command;
use pairwave::{Error, Result};

use super::print;

/// Pages of the manual.
#[derive(clap::Args)]
pub(crate) struct Man {
    /// Directory for the pages, pairwave.1 and one for each command; created where there is none
    dir: PathBuf,
}

impl Man {
    /// Writes them; those that are there are replaced.
    pub(crate) fn run(&self, command: Command) -> Result<()> {
        std::fs::create_dir_all(&self.dir).map_err(|e| Error::file(&self.dir, e))?;
        clap_mangen::generate_to(command, &self.dir).map_err(|e| Error::file(&self.dir, e))?;
        print(&format!("{}: read with `man -l {0}/pairwave.1`\n", self.dir.display()))
    }
}

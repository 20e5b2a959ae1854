//! `pairwave sample`

use std::path::PathBuf;

use pairwave::Result;
use pairwave::points::write::write;
use pairwave::samplers::Process;

use super::print;
use super::progress::stop_on_interrupt;

#[derive(clap::Args)]
pub(crate) struct Sample {
    /// The sampler; `pairwave samplers` lists the names
    name: String,

    /// Points per realization
    #[arg(short = 'n', long = "points", value_name = "N")]
    points: u64,

    /// Number of realizations
    #[arg(short = 'k', long = "realizations", value_name = "K", default_value_t = 1)]
    realizations: u64,

    /// Dimension, 1 to 3
    #[arg(long, value_name = "D", default_value_t = 2)]
    dim: usize,

    /// Seed
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// A parameter of the sampler; may be repeated
    #[arg(long = "param", value_name = "KEY=VALUE")]
    params: Vec<String>,

    /// The file; its extension chooses the format: csv, txt, npy, npz, bin (UTK), rps, f32, f64
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Replace the file if it exists
    #[arg(long)]
    force: bool,

    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

impl Sample {
    pub(crate) fn run(self) -> Result<()> {
        let control = stop_on_interrupt()?;
        let process = Process::new(&self.name, self.points, self.realizations, self.dim, self.seed, &self.params)?;
        let mut realizations = (0..self.realizations).map(|index| {
            control.check()?;
            process.realization(index)
        });
        write(&self.out, &mut realizations, self.force)?;
        if self.quiet {
            return Ok(());
        }
        print(&format!(
            "{}: {} realizations of {}, n = {}\n",
            self.out.display(),
            self.realizations,
            self.name,
            self.points
        ))
    }
}

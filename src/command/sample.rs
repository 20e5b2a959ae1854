//! `pairwave sample`

use std::path::PathBuf;
use std::sync::Arc;

use pairwave::points::write::write;
use pairwave::samplers::{InOrder, Process, find};
use pairwave::{Pool, Result};

use super::progress::stop_on_interrupt;
use super::{print, tell};

#[derive(clap::Args)]
pub(crate) struct Sample {
    /// The sampler; `pairwave samplers` lists the names
    name: String,

    /// Points per realization; where their number is drawn, its expectation
    #[arg(short = 'n', long = "points", value_name = "N")]
    points: u64,

    /// Take the nearest number of points that the sampler can make
    #[arg(long)]
    nearest: bool,

    /// Number of realizations
    #[arg(short = 'k', long = "realizations", value_name = "K", default_value_t = 1)]
    realizations: u64,

    /// Dimension: 1 to 3, of some samplers up to 16
    #[arg(long, value_name = "D", default_value_t = 2)]
    dim: usize,

    /// Seed
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// A parameter of the sampler; may be repeated
    #[arg(long = "param", value_name = "KEY=VALUE")]
    params: Vec<String>,

    /// The file; its extension chooses the format: csv, txt, npy, npz, ply, xyz, bin (UTK), rps, f32, f64; parquet, arrow where built in
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Replace the file if it exists
    #[arg(long)]
    force: bool,

    /// Number of threads; the points do not depend on it
    #[arg(long, value_name = "N")]
    threads: Option<usize>,

    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

impl Sample {
    pub(crate) fn run(self) -> Result<()> {
        let control = stop_on_interrupt()?;
        let params: Vec<&str> = self.params.iter().map(String::as_str).collect();
        let mut n = self.points;
        if self.nearest {
            n = find(&self.name)?.nearest_size(n, self.dim);
            if n != self.points && !self.quiet {
                tell(&format!("note: n = {n}, the nearest to {} that {} can make", self.points, self.name));
            }
        }
        let process = Arc::new(Process::new(&self.name, n, self.realizations, self.dim, self.seed, &params)?);
        let pool = Pool::new(self.threads)?;
        write(&self.out, &mut InOrder::new(process.clone(), pool, control)?, self.force)?;
        if self.quiet {
            return Ok(());
        }
        let (out, k, name) = (self.out.display(), self.realizations, &process.name);
        let drawn = if process.fixed_n { "" } else { " on average" };
        let s = if k == 1 { "" } else { "s" };
        print(&format!("{out}: {k} realization{s} of {name}, n = {n}{drawn}\n"))
    }
}

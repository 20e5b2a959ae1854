//! The subcommands: each parses, calls the library, and prints. No arithmetic here.

mod analyze;
mod batch;
mod completions;
mod convergence;
mod devices;
mod integrands;
mod integrate;
mod merge;
mod out_of_memory;
mod plot;
mod progress;
mod sample;
mod samplers;
mod selftest;

use pairwave::Result;

pub(crate) use out_of_memory::Allocator;

/// What to do.
#[derive(clap::Subcommand)]
pub(crate) enum Command {
    /// Measure g(r), P(nu) and neighbour distances of point files or a sampler
    Analyze(Box<analyze::Analyze>),
    /// Predict and observe errors of integrals over the points
    Integrate(Box<integrate::Integrate>),
    /// Measure how errors of integrals fall with the number of points
    Convergence(Box<convergence::Convergence>),
    /// Make one result of the parts of a batch
    Merge(merge::Merge),
    /// Draw results again, several in one figure, without computing
    Plot(Box<plot::Plot>),
    /// Write realizations of a sampler to a file
    Sample(sample::Sample),
    /// List the samplers, or explain one
    Samplers(samplers::Samplers),
    /// List the integrands, or explain and draw one
    Integrands(integrands::Integrands),
    /// List the compute devices and what the self-check finds
    Devices,
    /// Print what completes commands, flags and names in a shell
    Completions(completions::Completions),
    /// Hold what a device measures against what is known in closed form
    Selftest(selftest::Selftest),
}

impl Command {
    /// Carries it out; `command` is the command line itself.
    pub(crate) fn run(self, command: clap::Command) -> Result<()> {
        match self {
            Self::Completions(completions) => completions.run(command),
            Self::Analyze(analyze) => analyze.run(),
            Self::Integrate(integrate) => integrate.run(),
            Self::Convergence(convergence) => convergence.run(),
            Self::Merge(merge) => merge.run(),
            Self::Plot(plot) => plot.run(),
            Self::Sample(sample) => sample.run(),
            Self::Samplers(samplers) => samplers.run(),
            Self::Integrands(integrands) => integrands.run(),
            Self::Devices => devices::run(),
            Self::Selftest(selftest) => selftest.run(),
        }
    }
}

/// Prints a line to standard error; nobody can be told that it is closed or full.
pub(crate) fn tell(line: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Prints to standard output; a reader that has gone away (`pairwave samplers | head`) is not an error.
fn print(text: &str) -> Result<()> {
    use std::io::Write;
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(pairwave::Error::file("stdout", error)),
        _ => Ok(()),
    }
}

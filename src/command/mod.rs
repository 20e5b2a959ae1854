//! The subcommands: each parses, calls the library, and prints. No arithmetic here.

mod analyze;
mod batch;
mod bench;
mod compare;
mod completions;
pub(crate) mod config;
mod convergence;
mod devices;
mod integrands;
mod integrate;
mod man;
mod merge;
mod out_of_memory;
mod plot;
mod progress;
mod sample;
mod samplers;
mod scan;
mod selftest;

use std::process::ExitCode;

use clap::CommandFactory;
use pairwave::Result;

pub(crate) use out_of_memory::Allocator;

/// How the samples of a pattern are correlated: g(r) and P(nu) with error bars, exact pair counts, on any GPU or none.
#[derive(clap::Parser)]
#[command(version, max_term_width = 120)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The command line as clap knows it, with the rules of the table of settings.
pub(crate) fn interface() -> clap::Command {
    let dress = pairwave::request::dress;
    let command = Arguments::command()
        .mut_subcommand("analyze", dress)
        .mut_subcommand("integrate", dress)
        .mut_subcommand("scan", dress);
    command.arg(config::argument())
}

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
    /// Look at the files of a batch once, for parts of it that are measured anywhere
    Scan(Box<scan::Asked>),
    /// Test whether results differ, value by value and over all of them
    Compare(compare::Compare),
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
    /// Write the pages of the manual
    Man(man::Man),
    /// Time every way to the same numbers on this machine, and hold it against its error
    Bench(bench::Bench),
    /// Hold what a device measures against what is known in closed form
    Selftest(selftest::Selftest),
}

impl Command {
    /// Carries it out; `command` is the command line itself.
    pub(crate) fn run(self, command: clap::Command) -> Result<ExitCode> {
        match self {
            Self::Compare(compare) => return compare.run(),
            Self::Completions(completions) => completions.run(command),
            Self::Man(man) => man.run(command),
            Self::Analyze(analyze) => analyze.run(),
            Self::Integrate(integrate) => integrate.run(),
            Self::Convergence(convergence) => convergence.run(),
            Self::Scan(scan) => scan.run(),
            Self::Merge(merge) => merge.run(),
            Self::Plot(plot) => plot.run(),
            Self::Sample(sample) => sample.run(),
            Self::Samplers(samplers) => samplers.run(),
            Self::Integrands(integrands) => integrands.run(),
            Self::Bench(bench) => bench.run(),
            Self::Devices => devices::run(),
            Self::Selftest(selftest) => selftest.run(),
        }
        .map(|()| ExitCode::SUCCESS)
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

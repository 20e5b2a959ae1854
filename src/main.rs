//! pairwave measures how the samples of a pattern are correlated. `pairwave --help` says how to ask.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod command;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser};
use command::Command;

#[global_allocator]
static ALLOCATOR: command::Allocator = command::Allocator;

/// How the samples of a pattern are correlated: g(r) and P(nu) with error bars, exact pair counts, on any GPU or none.
#[derive(Parser)]
#[command(version, max_term_width = 120)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let mut command = Arguments::command().mut_subcommand("analyze", pairwave::request::dress);
    let matches = command.get_matches_mut();
    // clap prints usage errors itself, with exit code 2.
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command).exit());
    match arguments.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            command::tell(&format!("error: {}", error.told(pairwave::Setting::flag)));
            ExitCode::from(error.exit_code())
        }
    }
}

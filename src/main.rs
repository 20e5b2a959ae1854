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

/// Where there is no desktop, Vulkan's drivers ask for a Wayland display all the same, and complain aloud that there is no folder
/// to look for one. There: one without any.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "sets a variable of the environment before there are threads")]
fn look_nowhere_for_wayland() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: called first of all, when no other thread reads or writes the environment.
        unsafe { std::env::set_var("XDG_RUNTIME_DIR", std::env::temp_dir()) }
    }
}

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    look_nowhere_for_wayland();
    let dress = pairwave::request::dress;
    let mut command = Arguments::command().mut_subcommand("analyze", dress).mut_subcommand("integrate", dress);
    let matches = command.get_matches_mut();
    // clap prints usage errors itself, with exit code 2.
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command).exit());
    match arguments.command.run(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            command::tell(&format!("error: {}", error.told(pairwave::Setting::flag)));
            ExitCode::from(error.exit_code())
        }
    }
}

//! pairwave measures how the samples of a pattern are correlated. `pairwave --help` says how to ask.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod command;

use std::process::ExitCode;

use clap::FromArgMatches;
use command::{Arguments, config};

#[global_allocator]
static ALLOCATOR: command::Allocator = command::Allocator;

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
    let mut command = command::interface();
    let (words, config) = match config::expand(std::env::args_os().collect(), &mut command) {
        Ok(expanded) => expanded,
        Err(error) => return failed(&error),
    };
    // clap prints usage errors itself, with exit code 2.
    let matches = command
        .try_get_matches_from_mut(&words)
        .unwrap_or_else(|error| config::exit(&error, config.as_ref(), &words, &mut command));
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command).exit());
    config::keep(&command, &matches);
    match arguments.command.run(command) {
        Ok(code) => code,
        Err(error) => failed(&error),
    }
}

fn failed(error: &pairwave::Error) -> ExitCode {
    command::tell(&format!("error: {}", error.told(pairwave::Setting::flag)));
    ExitCode::from(error.exit_code())
}

//! `pairwave completions`

use clap::Command;
use clap::builder::PossibleValuesParser;
use pairwave::{Result, integrand, samplers};

use super::print;

/// The script of a shell.
#[derive(clap::Args)]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    /// Prints the script for `command`.
    pub(crate) fn run(&self, command: Command) -> Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut named(command), "pairwave", &mut script);
        print(&String::from_utf8_lossy(&script))
    }
}

/// With the names of samplers and integrands where these are asked for.
fn named(command: Command) -> Command {
    let samplers = || PossibleValuesParser::new(samplers::registry().iter().map(|entry| entry.name));
    let integrands = || PossibleValuesParser::new(integrand::registry().iter().map(|entry| entry.name));
    let subcommands: Vec<String> = command.get_subcommands().map(|sub| sub.get_name().to_string()).collect();
    subcommands.into_iter().fold(command, |command, name| {
        command.mut_subcommand(&name, |mut sub| {
            let ids: Vec<String> = sub.get_arguments().map(|argument| argument.get_id().to_string()).collect();
            for id in ids {
                let of_samplers = id == "sampler" || (name == "sample" || name == "samplers") && id == "name";
                let of_integrands = id == "integrand" || name == "integrands" && id == "spec";
                if of_samplers {
                    sub = sub.mut_arg(&id, |argument| argument.value_parser(samplers()));
                } else if of_integrands {
                    sub = sub.mut_arg(&id, |argument| argument.value_parser(integrands()));
                }
            }
            sub
        })
    })
}

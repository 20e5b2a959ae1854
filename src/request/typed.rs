//! Requests as the command line takes them: what clap needs to know beyond the types of the fields comes from the table.

use clap::builder::PossibleValue;
use clap::{Arg, Args, Command, CommandFactory, FromArgMatches};

use super::settings::Row;
use super::{Request, shell_words};
use crate::error::{Error, Result};
use crate::points::read::RawLayout;
use crate::setting::Setting;

pub(super) fn raw_layout(text: &str) -> Result<RawLayout, String> {
    text.parse().map_err(|error: Error| error.told(Setting::flag))
}

/// A request as a command of its own.
#[derive(clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Typed {
    #[command(flatten)]
    request: Request,
}

impl Request {
    /// The request that these arguments of `pairwave analyze` make. Says what is wrong with them in one line.
    ///
    /// # Errors
    /// `Error::Arguments`, in one line.
    pub fn parse(arguments: impl IntoIterator<Item = String>) -> Result<Self> {
        let arguments: Vec<String> = arguments.into_iter().collect();
        let matches = dress(Typed::command()).try_get_matches_from(&arguments);
        matches
            .and_then(|matches| Self::from_arg_matches(&matches))
            .map_err(|error| Error::Arguments { arguments: shell_words(&arguments), reason: in_a_line(&error) })
    }
}

/// What clap says, without the usage and the tips, which come after a blank line.
fn in_a_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let what: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    what.join(" ").trim_start_matches("error: ").to_string()
}

/// The table's row of an argument.
fn row(argument: &Arg) -> Option<&'static Row> {
    super::SETTINGS.iter().find(|row| row.setting.name() == argument.get_id().as_str())
}

/// A command that flattens a [`Request`] or its points, with the rules, headings and defaults of the table of settings.
pub fn dress(command: Command) -> Command {
    let there: Vec<String> = command.get_arguments().map(|argument| argument.get_id().to_string()).collect();
    let is_there = |setting: &Setting| there.iter().any(|id| id == setting.name());
    command.mut_args(|argument| match row(&argument) {
        Some(row) => {
            let conflicts = row.conflicts.iter().filter(|other| is_there(other)).map(|other| other.name());
            let needs = row.needs.filter(|other| is_there(other)).map(Setting::name);
            dressed(argument, row).conflicts_with_all(conflicts).requires_all(needs)
        }
        None => {
            let long = explained(&argument);
            argument.long_help(long)
        }
    })
}

/// What the long help says of an argument: all but the line that the short help has in its place.
fn explained(argument: &Arg) -> String {
    let whole = argument.get_long_help().or(argument.get_help()).map(ToString::to_string).unwrap_or_default();
    whole.split_once("\n\n").map_or(whole.as_str(), |(_, rest)| rest).to_string()
}

fn dressed(argument: Arg, row: &Row) -> Arg {
    let short = argument.get_help().map(ToString::to_string).unwrap_or_default();
    // clap itself says what it fills in.
    let otherwise = if argument.get_default_values().is_empty() { row.left_out(Setting::flag) } else { String::new() };
    let bracket = if otherwise.is_empty() { String::new() } else { format!(" [default: {otherwise}]") };
    // A line of the short help has room for so much beside the longest flag.
    let in_short = if short.len() + bracket.len() <= 55 { bracket.as_str() } else { "" };
    let values = if row.is_switch() { Vec::new() } else { argument.get_possible_values() };
    let long = format!("{}{bracket}{}", explained(&argument).trim_end_matches('.'), listed(&values));
    argument
        .help(format!("{short}{in_short}"))
        .long_help(long)
        .help_heading(row.group.name())
        .hide_short_help(!row.usual)
        // They are in the long help, and would fill the short one.
        .hide_possible_values(!row.is_switch())
}

/// Values with what they mean, as clap lists them.
fn listed(values: &[PossibleValue]) -> String {
    let width = values.iter().map(|v| v.get_name().len() + 1).max().unwrap_or(0);
    let line = |value: &PossibleValue| {
        let help = value.get_help().map(ToString::to_string).unwrap_or_default();
        format!("\n- {:width$} {help}", format!("{}:", value.get_name()))
    };
    let lines: String = values.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("\n\nPossible values:{lines}") }
}

/// What the help says about a setting, in full sentences.
pub fn help(setting: Setting) -> String {
    let command = Request::augment_args(Command::new("analyze"));
    let argument = command.get_arguments().find(|argument| argument.get_id().as_str() == setting.name());
    argument.map(explained).unwrap_or_default()
}

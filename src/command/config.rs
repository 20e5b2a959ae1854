//! `--config`: the settings of a command from a file, and the file that repeats a run.
//!
//! A file is a table of flags by their long names (`r-max = 0.1`, `stats = ["pcf"]`, `wrap = true`), of files by `files`. Its settings become
//! arguments before those that are typed; what is typed wins, also over settings that it cannot be given with.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use pairwave::report::Asked;
use pairwave::request::{Row, SETTINGS, shell_words};
use pairwave::source::Scan;
use pairwave::{Error, Result};
use toml::Value;

/// The key that says which command a file is of.
const COMMAND: &str = "command";

/// What says where a result goes and how a run is carried out, not what the result is.
const APART: [&str; 11] =
    ["config", "out", "force", "quiet", "progress", "checkpoint", "resume", "time_limit", "explain", "help", "version"];

/// What was typed, or is carried out as a part of it.
static ASKED: Mutex<Option<Asked>> = Mutex::new(None);

/// The line of the run, and its settings, defaults too, as a file that repeats it.
pub(crate) fn asked() -> Asked {
    ASKED.lock().unwrap_or_else(PoisonError::into_inner).clone().unwrap_or_default()
}

/// Says what was typed.
pub(crate) fn ask(asked: Asked) {
    *ASKED.lock().unwrap_or_else(PoisonError::into_inner) = Some(asked);
}

/// The argument, for every command.
pub(crate) fn argument() -> Arg {
    Arg::new("config")
        .long("config")
        .value_name("FILE")
        .global(true)
        .hide_short_help(true)
        .help("Settings from a TOML file; what is typed wins")
        .long_help(
            "Settings from a TOML file, by the long names of flags: r-max = 0.1, stats = [\"pcf\"], wrap = true, files = [\"a.csv\"]; what is \
             typed wins. Every result has the settings it was made by in run.toml",
        )
}

/// A file of settings.
pub(crate) struct Config {
    path: PathBuf,
    text: String,
    settings: Vec<(toml::Spanned<String>, Value)>,
    /// Those that became arguments, and these.
    used: Vec<(String, Vec<OsString>)>,
}

type Entries = std::collections::BTreeMap<toml::Spanned<String>, Value>;

impl Config {
    fn read(path: &Path) -> Result<Self> {
        let text = pairwave::input::read_text(path)?;
        let place = |offset: usize| format!("{}:{}", path.display(), line(&text, offset));
        let entries: Entries = toml::from_str(&text).map_err(|e| {
            let reason = format!("is no TOML: {}", e.message());
            Error::input(e.span().map_or_else(|| path.display().to_string(), |span| place(span.start)), reason)
        })?;
        let mut settings: Vec<_> = entries.into_iter().collect();
        settings.sort_by_key(|(key, _)| key.span().start);
        Ok(Self { path: path.into(), text, settings, used: Vec::new() })
    }

    fn fault(&self, key: &toml::Spanned<String>, reason: String) -> Error {
        let place = format!("{}:{}", self.path.display(), line(&self.text, key.span().start));
        Error::input(place, format!("{}: {reason}", key.get_ref()))
    }

    /// The command that it is of, if it says so.
    fn command(&self) -> Result<Option<&str>> {
        let Some((key, value)) = self.settings.iter().find(|(key, _)| key.get_ref() == COMMAND) else {
            return Ok(None);
        };
        let name =
            value.as_str().ok_or_else(|| self.fault(key, format!("is {value}; expected the name of a command")))?;
        Ok(Some(name))
    }

    /// Where a flag of it is set: `run.toml:3`.
    pub(crate) fn place(&self, flag: &str) -> Option<String> {
        let name = flag.trim_start_matches('-').split(['=', ' ']).next()?;
        let (key, _) = self.used.iter().find(|(key, _)| dashed(key) == name)?;
        self.place_of(key)
    }

    /// Where a key stands.
    fn place_of(&self, key: &str) -> Option<String> {
        let (key, _) = self.settings.iter().find(|(other, _)| other.get_ref() == key)?;
        Some(format!("{}:{}", self.path.display(), line(&self.text, key.span().start)))
    }

    /// The keys that need what is missing, each with what it needs: by themselves they lack it too, and the command without them does not.
    fn needs(&self, missing: &[String], name: &str, command: &mut Command) -> Vec<(String, String)> {
        let mut lacking = |words: &[OsString]| {
            let words = [OsString::from("pairwave"), name.into()].into_iter().chain(words.iter().cloned());
            command.try_get_matches_from_mut(words).map_or_else(|error| lacks(&error), |_| Vec::new())
        };
        let always = lacking(&[]);
        let needed = |(key, words): &(String, Vec<OsString>)| {
            let flag = lacking(words).into_iter().find(|flag| missing.contains(flag) && !always.contains(flag));
            flag.map(|flag| (key.clone(), flag))
        };
        self.used.iter().filter_map(needed).collect()
    }

    /// Its settings as arguments of a command, but those that are typed or cannot be given with what is.
    fn arguments(&mut self, command: &Command, typed: Option<&ArgMatches>) -> Result<Vec<OsString>> {
        let is_typed = |arg: &Arg| {
            typed.is_some_and(|typed| typed.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine))
        };
        let typed_files = command.get_arguments().any(|arg| arg.get_id() == "files" && is_typed(arg));
        let (mut arguments, mut used) = (Vec::new(), Vec::new());
        for (key, value) in self.settings.iter().filter(|(key, _)| key.get_ref() != COMMAND) {
            let name = dashed(key.get_ref());
            let found = command
                .get_arguments()
                .find(|arg| named(arg) == name)
                .filter(|arg| !["config", "help", "version"].contains(&arg.get_id().as_str()));
            let Some(arg) = found else {
                return Err(self.fault(key, unknown(&name, command)));
            };
            let apart = |other: &Arg| command.get_arg_conflicts_with(other).iter().any(|a| a.get_id() == arg.get_id());
            let beaten = command.get_arguments().filter(|other| is_typed(other)).any(|other| {
                apart(other) || command.get_arg_conflicts_with(arg).iter().any(|a| a.get_id() == other.get_id())
            });
            // Files come as they are: how a sampler draws says nothing about them.
            let idle = typed_files && SETTINGS.iter().any(|row| row.for_samplers && row.setting.name() == arg.get_id());
            if is_typed(arg) || beaten || idle {
                continue;
            }
            let words = words(arg, value).map_err(|reason| self.fault(key, reason))?;
            let words: Vec<OsString> = words.into_iter().map(OsString::from).collect();
            arguments.extend(words.iter().cloned());
            used.push((key.get_ref().clone(), words));
        }
        self.used = used;
        Ok(arguments)
    }
}

/// The arguments with those of a file of settings before them, if one is named.
///
/// # Errors
/// A file that cannot be read, is of another command, or sets what the command does not have.
pub(crate) fn expand(typed: Vec<OsString>, command: &mut Command) -> Result<(Vec<OsString>, Option<Config>)> {
    command.build();
    let (mut words, config) = with_config(typed, command)?;
    with_scan(&mut words, command)?;
    Ok((words, config))
}

/// Adds the settings by which the files of a scan were read, where that is what is typed for files.
fn with_scan(words: &mut Vec<OsString>, command: &Command) -> Result<()> {
    let Ok(matches) = command.clone().ignore_errors(true).try_get_matches_from(&*words) else { return Ok(()) };
    let Some((_, typed)) = matches.subcommand().filter(|(name, _)| ["analyze", "integrate"].contains(name)) else {
        return Ok(());
    };
    let files: Vec<&PathBuf> = typed.get_many("files").into_iter().flatten().collect();
    let [path] = files.as_slice() else { return Ok(()) };
    let Some(settings) = Scan::settings_in(path)? else { return Ok(()) };
    let given = |row: &Row| typed.value_source(row.setting.name()) == Some(ValueSource::CommandLine);
    let rows = settings.into_iter().filter_map(|(setting, value)| Some((setting.row()?, value)));
    let of_scan = rows.filter(|(row, _)| !given(row));
    let arguments = of_scan.map(|(row, value)| match row.is_switch() {
        true => row.flag.into(),
        false => format!("{}={value}", row.flag).into(),
    });
    let arguments: Vec<OsString> = arguments.collect();
    words.splice(2..2, arguments);
    Ok(())
}

/// Adds the settings of a file.
fn with_config(mut typed: Vec<OsString>, command: &Command) -> Result<(Vec<OsString>, Option<Config>)> {
    let Some(path) = taken(&mut typed)? else { return Ok((typed, None)) };
    let mut config = Config::read(&path)?;
    let names: Vec<String> = command.get_subcommands().map(|sub| sub.get_name().to_string()).collect();
    // A command comes first: behind it the same word is a value.
    let first = typed.get(1).map(|word| word.to_string_lossy().into_owned());
    let asked = first.filter(|first| names.contains(first));
    let name = match (asked, config.command()?) {
        (Some(asked), Some(of)) if asked != of => {
            let reason = format!("holds settings of {of}; expected those of {asked}");
            return Err(Error::input(path.display().to_string(), reason));
        }
        (Some(asked), _) => asked,
        (None, Some(of)) => {
            typed.insert(1, of.into());
            of.to_string()
        }
        (None, None) => {
            let reason = "does not say which command it is of; expected one, as `pairwave analyze --config FILE`";
            return Err(Error::input(path.display().to_string(), reason));
        }
    };
    let Some(sub) = command.find_subcommand(&name) else {
        let reason = format!("holds settings of {name}, which is no command; expected one of {}", names.join(", "));
        return Err(Error::input(path.display().to_string(), reason));
    };
    // What is typed is looked at as it stands; what is wrong with it is said when all is parsed.
    let matches = command.clone().ignore_errors(true).try_get_matches_from(&typed).ok();
    let of_file = config.arguments(sub, matches.as_ref().and_then(|matches| matches.subcommand_matches(&name)))?;
    typed.splice(2..2, of_file);
    Ok((typed, Some(config)))
}

/// The arguments that are missing, as `--out <DIR>`.
fn lacks(error: &clap::Error) -> Vec<String> {
    match (error.kind(), error.get(ContextKind::InvalidArg)) {
        (ErrorKind::MissingRequiredArgument, Some(ContextValue::Strings(missing))) => missing.clone(),
        _ => Vec::new(),
    }
}

/// Ends with what is wrong with the arguments, and where the file sets what is.
pub(crate) fn exit(error: &clap::Error, config: Option<&Config>, typed: &[OsString], command: &mut Command) -> ! {
    let _ = error.print();
    let (missing, name) = (lacks(error), typed.get(1).map(|name| name.to_string_lossy()).unwrap_or_default());
    for (key, needed) in config.iter().flat_map(|config| config.needs(&missing, &name, command)) {
        let place = config.and_then(|config| config.place_of(&key)).unwrap_or_default();
        super::tell(&format!("{key} is set in {place}, and needs {needed}: type it, or set it there too"));
    }
    let wrong = error.get(ContextKind::InvalidArg).map(|value| value.to_string());
    if let Some((place, wrong)) = wrong.and_then(|wrong| Some((config?.place(&wrong)?, wrong))) {
        super::tell(&format!("{wrong} is set in {place}"));
    }
    std::process::exit(error.exit_code())
}

/// Takes `--config FILE` out of the arguments.
fn taken(typed: &mut Vec<OsString>) -> Result<Option<PathBuf>> {
    let end = typed.iter().position(|word| word == "--").unwrap_or(typed.len());
    let is = |word: &OsString| word == "--config" || word.to_string_lossy().starts_with("--config=");
    let Some(at) = typed[..end].iter().position(is) else { return Ok(None) };
    let word = typed.remove(at).to_string_lossy().into_owned();
    let path = match word.split_once('=') {
        Some((_, "")) => return Err(Error::input("--config", "expected a file of settings, as run.toml")),
        Some((_, path)) => path.into(),
        None if at < typed.len() => typed.remove(at),
        None => return Err(Error::input("--config", "expected a file of settings, as run.toml")),
    };
    match typed.iter().take_while(|word| *word != "--").any(is) {
        true => Err(Error::input("--config", "is given twice; expected one file of settings")),
        false => Ok(Some(path.into())),
    }
}

/// Keeps what was typed, and the settings that came of it.
pub(crate) fn keep(command: &Command, matches: &ArgMatches) {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    keep_words(words, command, matches);
}

/// Keeps another command, which is a part of what was typed, as if that had been.
///
/// # Errors
/// What of it cannot be typed.
pub(crate) fn keep_part(words: &[String]) -> Result<()> {
    let mut command = super::interface();
    let all = std::iter::once("pairwave").chain(words.iter().map(String::as_str));
    let matches = command.try_get_matches_from_mut(all).map_err(|error| Error::Arguments {
        arguments: shell_words(words),
        reason: error.to_string().lines().next().unwrap_or_default().into(),
    })?;
    let shown = words.iter().filter(|word| *word != "--out=DIR").cloned();
    keep_words(shown, &command, &matches);
    Ok(())
}

fn keep_words(words: impl Iterator<Item = String>, command: &Command, matches: &ArgMatches) {
    let line = shell_words(std::iter::once("pairwave".to_string()).chain(words));
    ask(Asked { command: line, settings: settings(command, matches) });
}

/// The settings of a run, as a file that repeats it.
fn settings(command: &Command, matches: &ArgMatches) -> Option<String> {
    let (name, matches) = matches.subcommand()?;
    let sub = command.find_subcommand(name)?;
    let mut text = format!(
        "# pairwave {}: `pairwave {name} --config FILE --out DIR` does it again; paths are as they were typed.\n{COMMAND} = \"{name}\"\n",
        env!("CARGO_PKG_VERSION")
    );
    for arg in sub.get_arguments().filter(|arg| !APART.contains(&arg.get_id().as_str())) {
        if let Some(value) = value(arg, matches) {
            let _ = writeln!(text, "{} = {value}", named(arg));
        }
    }
    Some(text)
}

/// The value of an argument; none where it has none.
fn value(arg: &Arg, matches: &ArgMatches) -> Option<Value> {
    let id = arg.get_id().as_str();
    matches.value_source(id)?;
    if matches!(arg.get_action(), ArgAction::SetTrue) {
        return matches.get_flag(id).then_some(Value::Boolean(true));
    }
    let mut values: Vec<Value> = matches.get_raw(id)?.map(|word| typed(&word.to_string_lossy())).collect();
    match (values.len(), is_list(arg)) {
        (0, _) => None,
        (1, false) => values.pop(),
        _ => Some(Value::Array(values)),
    }
}

/// A word as it was typed: a number where that is written alike.
fn typed(word: &str) -> Value {
    match (word.parse::<i64>(), word.parse::<f64>()) {
        (Ok(number), _) if number.to_string() == word => Value::Integer(number),
        (_, Ok(number)) if number.is_finite() && number.fract() != 0.0 && number.to_string() == word => {
            Value::Float(number)
        }
        _ => Value::String(word.into()),
    }
}

/// Whether it takes several values.
fn is_list(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::Append)
        || arg.get_value_delimiter().is_some()
        || arg.get_num_args().is_some_and(|number| number.max_values() > 1)
}

/// The words by which a value is typed.
fn words(arg: &Arg, value: &Value) -> Result<Vec<String>, String> {
    let name = named(arg);
    let flag = matches!(arg.get_action(), ArgAction::SetTrue);
    let texts = match value {
        Value::Boolean(given) if flag => return Ok(if *given { vec![format!("--{name}")] } else { Vec::new() }),
        _ if flag => return Err(format!("is {value}; expected true or false")),
        Value::Array(values) => values.iter().map(word).collect::<Result<Vec<_>, _>>()?,
        Value::Table(pairs) if arg.get_action().takes_values() && is_list(arg) => pairs
            .iter()
            .map(|(key, value)| Ok(format!("{key}={}", word(value)?)))
            .collect::<Result<Vec<_>, String>>()?,
        one => vec![word(one)?],
    };
    let separate = matches!(arg.get_action(), ArgAction::Append);
    let delimiter = arg.get_value_delimiter().filter(|_| separate);
    if let Some(text) = texts.iter().find(|text| texts.len() > 1 && delimiter.is_some_and(|c| text.contains(c))) {
        return Err(format!("holds {text:?}; expected values without commas"));
    }
    Ok(if arg.is_positional() {
        // What begins with a dash would be taken for a flag.
        texts
            .into_iter()
            .map(|text| if text.len() > 1 && text.starts_with('-') { format!("./{text}") } else { text })
            .collect()
    } else if separate {
        texts.into_iter().map(|text| format!("--{name}={text}")).collect()
    } else {
        // Several words of one value are a line of CSV.
        let quoted = |text: String| match text.contains([',', '"']) && matches!(value, Value::Array(_)) {
            true => format!("\"{}\"", text.replace('"', "\"\"")),
            false => text,
        };
        vec![format!("--{name}={}", texts.into_iter().map(quoted).collect::<Vec<_>>().join(","))]
    })
}

fn word(value: &Value) -> Result<String, String> {
    match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) if number.is_finite() => Ok(number.to_string()),
        Value::Boolean(given) => Ok(given.to_string()),
        other => Err(format!("is {other}; expected a number, a word in quotes, true, false, or a list of them")),
    }
}

/// The key of an argument: its long name, or what it is called where it has no flag.
fn named(arg: &Arg) -> String {
    arg.get_long().map_or_else(|| dashed(arg.get_id().as_str()), str::to_string)
}

fn dashed(key: &str) -> String {
    key.replace('_', "-")
}

/// Why there is no setting of a name, with the nearest that there is.
fn unknown(name: &str, command: &Command) -> String {
    let names =
        command.get_arguments().map(named).filter(|other| !["help", "version", "config"].contains(&other.as_str()));
    let near = names.map(|other| (strsim::jaro_winkler(name, &other), other)).max_by(|a, b| a.0.total_cmp(&b.0));
    let hint = match near {
        Some((likeness, other)) if likeness > 0.7 => format!("; did you mean {other}?"),
        _ => format!("; `pairwave {} --help` lists them", command.get_name()),
    };
    format!("is no setting of {}{hint}", command.get_name())
}

/// The line of an offset, from 1.
fn line(text: &str, offset: usize) -> usize {
    text.as_bytes().iter().take(offset).filter(|byte| **byte == b'\n').count() + 1
}

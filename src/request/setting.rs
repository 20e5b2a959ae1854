//! One setting of a request as a person sees it: its flag, what it says, and its value as text.

use clap::{Arg, Args, Parser};

use super::{Request, Typed, shell_words, texts};
use crate::error::{Error, Result};

/// A setting: an argument of `pairwave analyze`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    /// The name of its field, which is also its name in clap.
    pub name: String,
    /// The flag, `--r-max`; of the files, `FILES`.
    pub flag: String,
    /// What it is, with its default in brackets.
    pub help: String,
    /// The values there are; empty where any text may be one.
    pub choices: Vec<String>,
    /// The value it has when it is left out, if that is one that can be typed.
    pub default: Option<String>,
    /// What it is when it is left out, in words: `256`, `ceil(5 n^(1/d))`.
    pub otherwise: Option<String>,
    /// Whether it is given or not, without a value.
    pub is_switch: bool,
}

impl Setting {
    /// All settings, in the order of the help.
    pub fn all() -> Vec<Self> {
        let command = Request::augment_args(clap::Command::new("analyze"));
        command.get_arguments().map(Self::of).collect()
    }

    fn of(argument: &Arg) -> Self {
        let name = argument.get_id().to_string();
        let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
        let value_name = argument.get_value_names().and_then(<[_]>::first).map(ToString::to_string).unwrap_or_default();
        let flag = argument.get_long().map_or(value_name.clone(), |long| format!("--{long}"));
        let is_switch = !argument.get_action().takes_values() && !argument.is_positional();
        let mut choices: Vec<String> =
            argument.get_possible_values().iter().map(|v| v.get_name().to_string()).filter(|_| !is_switch).collect();
        if choices.is_empty() && value_name.contains('|') {
            // Words are values; what is in capitals stands for others.
            choices = value_name.split('|').filter(|v| *v != v.to_uppercase()).map(str::to_string).collect();
        }
        let default = argument.get_default_values().first().filter(|_| !is_switch).map(|v| v.to_string_lossy().into());
        let bracket = help.rsplit_once("[default: ").and_then(|(_, end)| end.strip_suffix(']')).map(str::to_string);
        Self { name, flag, help, choices, otherwise: default.clone().or(bracket), default, is_switch }
    }
}

impl Request {
    /// The value of a setting as it is typed; empty where it is left out.
    pub fn value(&self, setting: &Setting) -> String {
        let value = self.settings().remove(&setting.name).unwrap_or_default();
        match texts(&value).join(if setting.name == "params" { " " } else { "," }) {
            text if setting.is_switch && text == "false" => String::new(),
            text => text,
        }
    }

    /// The request with another value of a setting, or with none if `text` is empty. Several files or parameters are not
    /// one text: they are fields of `input`.
    pub fn with(&self, setting: &Setting, text: &str) -> Result<Self> {
        let command = Self::augment_args(clap::Command::new("analyze"));
        let text = text.trim();
        let arguments =
            self.arguments_with(&command, |argument, values| match argument.get_id() == setting.name.as_str() {
                true => Some(text.to_string()).filter(|t| !t.is_empty()).into_iter().collect(),
                false => values,
            });
        let mut with = Typed::try_parse_from(&arguments).map(|typed| typed.request).map_err(|error| {
            let (flag, value) = (setting.flag.as_str(), shell_words([text]));
            Error::Arguments { arguments: format!("{flag} {value}"), reason: super::in_a_line(&error) }
        })?;
        // Names of files need not be text.
        with.input.files.clone_from(&self.input.files);
        Ok(with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setting(name: &str) -> Setting {
        Setting::all().into_iter().find(|s| s.name == name).unwrap()
    }

    #[test]
    fn a_setting_says_what_it_takes() {
        let bins = setting("bins");
        assert_eq!((bins.flag.as_str(), bins.otherwise.as_deref(), bins.default), ("--bins", Some("256"), None));
        let accuracy = setting("accuracy");
        assert_eq!((accuracy.choices, accuracy.default.as_deref()), (vec!["fast".into(), "high".into()], Some("fast")));
        assert_eq!(setting("device").choices, ["auto", "cpu", "gpu", "reference"]);
        assert!(setting("wrap").is_switch && setting("wrap").choices.is_empty());
        for setting in Setting::all() {
            assert!(!setting.help.is_empty() && !setting.flag.is_empty(), "{}", setting.name);
        }
    }

    #[test]
    fn what_is_set_reads_back() {
        let start = Request::parse(["--sampler", "random", "-n", "9"].map(String::from)).unwrap();
        for (name, text) in [
            ("bins", "12"),
            ("r_max", "0.125"),
            ("max_frequency", "3,4"),
            ("bin_scale", "log"),
            ("beyond_half", "true"),
            ("normalization", "intensity"),
            ("device", "2"),
            ("realizations", "70"),
            ("correction", "none"),
        ] {
            let setting = setting(name);
            let with = start.with(&setting, text).unwrap();
            assert_eq!(with.value(&setting), text);
            assert_eq!(with.with(&setting, " ").unwrap(), start, "{name}");
            assert_ne!(with, start);
        }
        assert_eq!(start.value(&setting("normalization")), "pairs");
    }

    #[test]
    fn what_is_no_value_is_refused_in_a_line() {
        let start = Request::default();
        let error = start.with(&setting("bins"), "many").unwrap_err().to_string();
        assert!(error.contains("--bins many") && error.contains("invalid digit"), "{error}");
        let given = start.with(&setting("edges"), "edges.txt").unwrap();
        let error = given.with(&setting("bins"), "12").unwrap_err().to_string();
        assert!(error.contains("--edges") && !error.contains('\n'), "{error}");
        let files = Request {
            input: super::super::PointsRequest { files: vec!["a b,c".into()], ..Default::default() },
            ..start
        };
        assert_eq!(files.with(&setting("bins"), "12").unwrap().input.files, files.input.files);
    }
}

//! The values of settings as text: as they are typed, shown and stored.

use std::path::PathBuf;

use serde_json::Value as Json;

use super::DeviceChoice;
use super::settings::{Row, SETTINGS};
use super::{DEFAULT_STATISTICS, Request, Statistic};
use crate::error::{Error, Result, number};
use crate::estimate::Normalization;
use crate::memory::Memory;
use crate::plan::{
    Accuracy, Bandwidth, BinScale, By, Convention, Correction, Debias, Divisor, Estimator, IntensityBandwidth,
    LagReach, SmoothingKernel, Spatial, Taper,
};
use crate::points::read::RawLayout;
use crate::points::{Boundary, UnitName};
use crate::setting::Setting;

/// One value.
trait Value: Sized {
    fn text(&self) -> String;
    fn parse(text: &str) -> Result<Self, String>;

    /// As JSON: a number where it is one.
    fn json(&self) -> Json {
        self.text().into()
    }

    /// All values there are; none where any text may be one.
    fn choices() -> Vec<&'static str> {
        Vec::new()
    }
}

/// A field of a request.
pub(super) trait Field {
    /// What is typed to have this value: nothing where it is left out, several texts where the flag is repeated.
    fn texts(&self) -> Vec<String>;
    /// The value as JSON; none where it is left out.
    fn json(&self) -> Option<Json>;
    /// Takes another value.
    fn set(&mut self, text: &str) -> Result<(), String>;
    /// Takes another value as it is typed several times: of what is not repeated, once.
    fn set_all(&mut self, texts: &[String]) -> Result<(), String> {
        match texts {
            [text] => self.set(text),
            _ => Err(format!("{} values; expected one", texts.len())),
        }
    }
    /// Whether it may be typed several times, a value each.
    fn is_repeated(&self) -> bool {
        false
    }
    /// Takes the value it has where it is left out.
    fn unset(&mut self);
    /// All values there are; none where any text may be one.
    fn choices(&self) -> Vec<&'static str>;
    /// Whether it is given or not, without a value.
    fn is_switch(&self) -> bool {
        false
    }
}

macro_rules! chosen {
    ($($type:ty),+) => {$(
        impl Value for $type {
            fn text(&self) -> String {
                self.name().into()
            }
            fn parse(text: &str) -> Result<Self, String> {
                text.parse()
            }
            fn choices() -> Vec<&'static str> {
                Self::ALL.iter().map(|value| value.name()).collect()
            }
        }
    )+};
}

macro_rules! counted {
    ($($type:ty),+) => {$(
        impl Value for $type {
            fn text(&self) -> String {
                self.to_string()
            }
            fn parse(text: &str) -> Result<Self, String> {
                text.parse().map_err(|error| format!("{error}"))
            }
            fn json(&self) -> Json {
                (*self).into()
            }
        }
    )+};
}

impl Value for String {
    fn text(&self) -> String {
        self.clone()
    }
    fn parse(text: &str) -> Result<Self, String> {
        Ok(text.into())
    }
}

impl Value for UnitName {
    fn text(&self) -> String {
        self.to_string()
    }
    fn parse(text: &str) -> Result<Self, String> {
        text.parse()
    }
}

counted!(u32, u64, usize);
chosen!(
    Accuracy,
    BinScale,
    Boundary,
    By,
    Convention,
    Correction,
    Debias,
    Divisor,
    Estimator,
    Normalization,
    SmoothingKernel,
    Spatial,
    Statistic,
    Taper
);

impl Value for f64 {
    fn text(&self) -> String {
        number(*self)
    }
    fn parse(text: &str) -> Result<Self, String> {
        text.parse().map_err(|error| format!("{error}"))
    }
    fn json(&self) -> Json {
        (*self).into()
    }
}

/// What is no Unicode in a path becomes U+FFFD.
impl Value for PathBuf {
    fn text(&self) -> String {
        self.to_string_lossy().into()
    }
    fn parse(text: &str) -> Result<Self, String> {
        Ok(text.into())
    }
}

impl Value for RawLayout {
    fn text(&self) -> String {
        self.to_string()
    }
    fn parse(text: &str) -> Result<Self, String> {
        text.parse().map_err(|error| match error {
            Error::Setting { reason, .. } => reason,
            other => other.to_string(),
        })
    }
}

/// In bytes, as JSON.
impl Value for Memory {
    fn text(&self) -> String {
        self.to_string()
    }
    fn json(&self) -> Json {
        self.0.into()
    }
    fn parse(text: &str) -> Result<Self, String> {
        text.parse()
    }
}

/// A number, or the name of a rule for it.
macro_rules! given_or_by_rule {
    ($($type:ty),+) => {$(
        impl Value for $type {
            fn text(&self) -> String {
                match self {
                    Self::Given(value) => number(*value),
                    rule => rule.to_string(),
                }
            }
            fn json(&self) -> Json {
                match self {
                    Self::Given(value) => (*value).into(),
                    rule => rule.to_string().into(),
                }
            }
            fn parse(text: &str) -> Result<Self, String> {
                text.parse()
            }
        }
    )+};
}

given_or_by_rule!(Bandwidth, IntensityBandwidth);

impl Value for LagReach {
    fn text(&self) -> String {
        self.to_string()
    }
    fn parse(text: &str) -> Result<Self, String> {
        text.parse()
    }
}

impl Value for DeviceChoice {
    fn text(&self) -> String {
        match self {
            Self::Auto => "auto".into(),
            Self::Cpu => "cpu".into(),
            Self::Gpu => "gpu".into(),
            Self::Reference => "reference".into(),
            Self::Index(index) => index.to_string(),
        }
    }
    fn json(&self) -> Json {
        match self {
            Self::Index(index) => (*index).into(),
            named => named.text().into(),
        }
    }
    fn parse(text: &str) -> Result<Self, String> {
        text.parse()
    }
    fn choices() -> Vec<&'static str> {
        vec!["auto", "cpu", "gpu", "reference"]
    }
}

/// Several numbers or words, separated by commas.
impl<T: Value> Value for Vec<T> {
    fn text(&self) -> String {
        self.iter().map(Value::text).collect::<Vec<_>>().join(",")
    }
    fn parse(text: &str) -> Result<Self, String> {
        text.split(',').map(T::parse).collect()
    }
    fn json(&self) -> Json {
        self.iter().map(Value::json).collect()
    }
}

/// What may be left out.
impl<T: Value> Field for Option<T> {
    fn texts(&self) -> Vec<String> {
        self.iter().map(Value::text).collect()
    }
    fn json(&self) -> Option<Json> {
        self.as_ref().map(Value::json)
    }
    fn set(&mut self, text: &str) -> Result<(), String> {
        *self = Some(T::parse(text)?);
        Ok(())
    }
    fn unset(&mut self) {
        *self = None;
    }
    fn choices(&self) -> Vec<&'static str> {
        T::choices()
    }
}

/// What always has a value.
macro_rules! always {
    ($($type:ty),+) => {$(
        impl Field for $type {
            fn texts(&self) -> Vec<String> {
                vec![self.text()]
            }
            fn json(&self) -> Option<Json> {
                Some(Value::json(self))
            }
            fn set(&mut self, text: &str) -> Result<(), String> {
                *self = Value::parse(text)?;
                Ok(())
            }
            fn unset(&mut self) {
                *self = Self::default();
            }
            fn choices(&self) -> Vec<&'static str> {
                <$type as Value>::choices()
            }
        }
    )+};
}

always!(Normalization, Convention, DeviceChoice, Accuracy);

impl Field for Vec<Statistic> {
    fn texts(&self) -> Vec<String> {
        vec![self.text()]
    }
    fn json(&self) -> Option<Json> {
        Some(Value::json(self))
    }
    fn set(&mut self, text: &str) -> Result<(), String> {
        *self = Value::parse(text)?;
        Ok(())
    }
    fn unset(&mut self) {
        *self = DEFAULT_STATISTICS.to_vec();
    }
    fn choices(&self) -> Vec<&'static str> {
        Statistic::choices()
    }
}

/// What is repeated instead of separated by commas: a path or a parameter may hold one.
macro_rules! repeated {
    ($($type:ty),+) => {$(
        impl Field for Vec<$type> {
            fn texts(&self) -> Vec<String> {
                self.iter().map(Value::text).collect()
            }
            fn json(&self) -> Option<Json> {
                (!self.is_empty()).then(|| Value::json(self))
            }
            fn set(&mut self, text: &str) -> Result<(), String> {
                *self = vec![Value::parse(text)?];
                Ok(())
            }
            fn set_all(&mut self, texts: &[String]) -> Result<(), String> {
                *self = texts.iter().map(|text| Value::parse(text)).collect::<Result<_, _>>()?;
                Ok(())
            }
            fn is_repeated(&self) -> bool {
                true
            }
            fn unset(&mut self) {
                self.clear();
            }
            fn choices(&self) -> Vec<&'static str> {
                Vec::new()
            }
        }
    )+};
}

repeated!(PathBuf, String);

impl Field for bool {
    fn texts(&self) -> Vec<String> {
        vec![self.to_string()]
    }
    fn json(&self) -> Option<Json> {
        Some((*self).into())
    }
    fn set(&mut self, text: &str) -> Result<(), String> {
        *self = text.parse().map_err(|_| "expected true or false")?;
        Ok(())
    }
    fn unset(&mut self) {
        *self = false;
    }
    fn choices(&self) -> Vec<&'static str> {
        Vec::new()
    }
    fn is_switch(&self) -> bool {
        true
    }
}

impl Row {
    /// All values it may have; none where any text may be one.
    pub fn choices(&self) -> Vec<&'static str> {
        (self.get)(&Request::default()).choices()
    }

    /// Whether it is given or not, without a value.
    pub fn is_switch(&self) -> bool {
        (self.get)(&Request::default()).is_switch()
    }

    /// Whether it may be given several times.
    pub fn is_repeated(&self) -> bool {
        (self.get)(&Request::default()).is_repeated()
    }

    /// Whether it has another value than where it is left out.
    pub fn is_given(&self, request: &Request) -> bool {
        (self.get)(request).texts() != (self.get)(&Request::default()).texts()
    }
}

impl Request {
    /// The value of a setting as it is typed; empty where it is left out.
    pub fn value(&self, setting: Setting) -> String {
        let Some(row) = setting.row() else { return String::new() };
        let field = (row.get)(self);
        let text = field.texts().join(if setting == Setting::Params { " " } else { "," });
        if field.is_switch() && text == "false" { String::new() } else { text }
    }

    /// The request with another value of a setting, or with none if `text` is empty. Several files or parameters are not
    /// one text: they are fields of `input`.
    ///
    /// # Errors
    /// A value that cannot be parsed, or that does not go together with the others.
    pub fn with(&self, setting: Setting, text: &str) -> Result<Self> {
        let mut with = self.clone();
        with.set(setting, text)?;
        with.check_together()?;
        Ok(with)
    }

    /// The request of these settings, each with its value as it is typed, or with several where it may be repeated.
    ///
    /// # Errors
    /// A value that cannot be parsed; settings that do not go together.
    pub fn of(settings: impl IntoIterator<Item = (Setting, Vec<String>)>) -> Result<Self> {
        let mut request = Self::default();
        for (setting, texts) in settings {
            let Some(row) = setting.row() else {
                return Err(Error::setting(setting, texts.join(","), "is in no request"));
            };
            let set = (row.get_mut)(&mut request).set_all(&texts);
            set.map_err(|reason| Error::setting(setting, texts.join(","), reason))?;
        }
        request.check_together()?;
        Ok(request)
    }

    /// Takes another value of a setting, whether it goes together with the others or not.
    pub(crate) fn set(&mut self, setting: Setting, text: &str) -> Result<()> {
        let Some(row) = setting.row() else { return Err(Error::setting(setting, text, "is in no request")) };
        let field = (row.get_mut)(self);
        match text.trim() {
            "" => field.unset(),
            text => field.set(text).map_err(|reason| Error::setting(setting, text, reason))?,
        }
        Ok(())
    }

    /// Whether what is given goes together, as the command line checks it too.
    fn check_together(&self) -> Result<()> {
        for row in SETTINGS.iter().filter(|row| row.is_given(self)) {
            let given = |other: &Setting| other.row().is_some_and(|other| other.is_given(self));
            let reason = match (row.conflicts.iter().find(|other| given(other)), row.needs) {
                (Some(other), _) => format!("cannot be used with {}", other.mention()),
                (None, Some(needed)) if !given(&needed) => format!("needs {}", needed.mention()),
                _ => continue,
            };
            return Err(Error::setting(row.setting, self.value(row.setting), reason));
        }
        Ok(())
    }

    /// The shortest arguments of `pairwave analyze` that make this request: what has its default is left out, and files
    /// come last.
    pub fn arguments(&self) -> Vec<String> {
        let mut arguments = Vec::new();
        for row in SETTINGS.iter().filter(|row| row.setting != Setting::Files && row.is_given(self)) {
            let field = (row.get)(self);
            for value in field.texts() {
                if field.is_switch() {
                    arguments.push(row.flag.to_string());
                } else if value.starts_with('-') {
                    arguments.push(format!("{}={value}", row.flag));
                } else {
                    arguments.extend([row.flag.to_string(), value]);
                }
            }
        }
        let files = self.input.files.texts();
        if files.iter().any(|file| file.len() > 1 && file.starts_with('-')) {
            arguments.push("--".into());
        }
        arguments.extend(files);
        arguments
    }

    /// The command that makes this request, as a shell takes it.
    pub fn command(&self) -> String {
        let arguments = self.arguments();
        shell_words(["pairwave", "analyze"].into_iter().chain(arguments.iter().map(String::as_str)))
    }

    /// The settings as (name, value), unset ones left out, in the order of their names.
    pub fn parameters(&self) -> Vec<(String, Json)> {
        let given = |row: &Row| Some((row.setting.name().replace('_', "-"), (row.get)(self).json()?));
        let mut named: Vec<_> = SETTINGS.iter().filter_map(given).collect();
        named.sort_by(|(a, _), (b, _)| a.cmp(b));
        named
    }
}

/// Words of a command, quoted where a shell would need it.
pub fn shell_words(words: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=+:@%".contains(c);
    let quoted = |word: &str| match !word.is_empty() && word.chars().all(plain) {
        true => word.to_string(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    };
    words.into_iter().map(|word| quoted(word.as_ref())).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
#[cfg(feature = "cli")]
mod tests {
    use super::*;

    #[test]
    fn what_is_set_reads_back() {
        let start = Request::parse(["--sampler", "random", "-n", "9"].map(String::from)).unwrap();
        for (setting, text) in [
            (Setting::Bins, "12"),
            (Setting::RMax, "0.125"),
            (Setting::MaxFrequency, "3,4"),
            (Setting::BinScale, "log"),
            (Setting::BeyondHalf, "true"),
            (Setting::Normalization, "intensity"),
            (Setting::Device, "2"),
            (Setting::Realizations, "70"),
            (Setting::Correction, "none"),
        ] {
            let with = start.with(setting, text).unwrap();
            assert_eq!(with.value(setting), text);
            assert_eq!(with.with(setting, " ").unwrap(), start, "{setting}");
            assert_ne!(with, start);
        }
        assert_eq!(start.value(Setting::Normalization), "pairs");
    }

    #[test]
    fn settings_make_a_request_all_at_once() {
        let of = |settings: &[(Setting, &[&str])]| {
            let texts = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect();
            Request::of(settings.iter().map(|(setting, all)| (*setting, texts(all))))
        };
        // What needs another may come before it.
        let all: &[(Setting, &[&str])] = &[
            (Setting::Bandwidth, &["0.1"]),
            (Setting::Kernel, &["box"]),
            (Setting::Integrand, &["disk", "formula:max(x,y)"]),
            (Setting::Wrap, &["true"]),
        ];
        let typed = ["--bandwidth=0.1", "--kernel=box", "--integrand=disk", "--integrand=formula:max(x,y)", "--wrap"];
        assert_eq!(of(all).unwrap(), Request::parse(typed.map(String::from)).unwrap());
        for (settings, why) in [
            (&[(Setting::Bandwidth, &["0.1"] as &[&str])] as &[(Setting, &[&str])], "needs `kernel`"),
            (&[(Setting::Bins, &["3", "4"])], "2 values; expected one"),
            (&[(Setting::Bins, &["x"])], "bins x"),
            (&[(Setting::Out, &["x"])], "is in no request"),
        ] {
            let error = of(settings).unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }

    #[test]
    fn what_is_no_value_is_refused_in_a_line() {
        let start = Request::default();
        let refused = |request: &Request, setting, text| request.with(setting, text).unwrap_err().told(Setting::flag);
        assert_eq!(refused(&start, Setting::Bins, "many"), "--bins many: invalid digit found in string");
        assert_eq!(refused(&start, Setting::Accuracy, "low"), "--accuracy low: expected one of fast, high");
        let given = start.with(Setting::Edges, "edges.txt").unwrap();
        assert_eq!(refused(&given, Setting::Bins, "12"), "--bins 12: cannot be used with --edges");
        assert_eq!(refused(&start, Setting::Bandwidth, "0.1"), "--bandwidth 0.1: needs --kernel");
    }

    /// What is typed one by one is what clap makes of the whole line, and clap refuses what cannot be typed.
    #[test]
    fn one_by_one_is_all_at_once() {
        for line in [
            "--sampler jittered -n 100 -k 4 --dim 3 --seed 9 --param a=1 --domain torus --box 1,2.5,1e-7 --wrap",
            "--raw f32x2 --weight-column w --class-column=-3 --window=-1,1,0,2 --classes a,b x.npy",
            "--columns x,y --realization-column frame --array a,b x.npz",
            "--stats pcf,k-function --r-max 0.25 --bins 12 --bin-scale log --beyond-half --lag-bins 8 --lag-max 0.125 x",
            "--kernel gaussian --bandwidth 0.001 --divisor d --exact-kernel --correction border --envelope 19 x",
            "--edges e.txt --frequencies f.txt --taper sine --tapers 3 --debias none --convention psa --bug-compatible x",
            "--max-frequency 3,4 --ring-directions 6 --sectors 4 --covariance-frequency 3 --lag-rings 0.1,0.2 x",
            "--normalization intensity --device 0 --accuracy high --threads 2 --memory 4GiB x",
        ] {
            let whole = Request::parse(line.split(' ').map(String::from)).unwrap();
            // What others need comes first.
            let mut rows: Vec<_> = SETTINGS.iter().filter(|row| row.is_given(&whole)).collect();
            rows.sort_by_key(|row| (row.needs.is_some(), row.setting == Setting::Sampler));
            let set = |request: Request, row: &&Row| match row.is_switch() {
                true => request.with(row.setting, "true").unwrap(),
                false => request.with(row.setting, &whole.value(row.setting)).unwrap(),
            };
            assert_eq!(rows.iter().fold(Request::default(), set), whole, "{line}");
        }
    }
}

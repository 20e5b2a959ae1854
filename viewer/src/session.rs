//! A session as text: every set by its command, and the view.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use pairwave::display::ToneMap;
use pairwave::request::Request;
use pairwave::source::Points;
use serde::{Deserialize, Serialize};

use crate::set::{MOST_SETS, Set, Wanted};
use crate::state::State;
use crate::view::{Theme, View};

/// What a session calls itself.
const FORMAT: &str = "pairwave-viewer session";

/// What would be right.
const EXPECTED: &str = "a session is the JSON that \"Save session\" writes";

/// Raised when a session of before would mean something else, or has fields that were not there.
const VERSION: u64 = 1;

/// What a window shows: fields that are not known are refused, for what they stand for would be lost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Session {
    format: String,
    version: u64,
    /// Where relative paths start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    folder: Option<PathBuf>,
    sets: Vec<Entry>,
    selected: usize,
    view: View,
}

/// One set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// Of `pairwave analyze`.
    arguments: Vec<String>,
    color: usize,
    visible: bool,
}

/// What tells sessions from other JSON, whatever else they hold.
#[derive(Deserialize)]
struct Head {
    format: Option<String>,
    version: Option<u64>,
}

impl Session {
    /// What the window shows now.
    pub(crate) fn of(state: &State) -> Self {
        let entry = |set: &Set| Entry { arguments: set.request.arguments(), color: set.color, visible: set.visible };
        Self {
            format: FORMAT.into(),
            version: VERSION,
            folder: std::env::current_dir().ok(),
            sets: state.sets.iter().map(entry).collect(),
            selected: state.selected,
            view: state.view.clone(),
        }
    }

    /// Shows what it says; after an error nothing has changed.
    pub(crate) fn show(&self, state: &mut State) -> Result<(), String> {
        state.replace(self.wanted()?, self.selected);
        state.view = self.view.clone();
        Ok(())
    }

    /// Light or dark.
    pub(crate) fn theme(&self) -> Theme {
        self.view.theme
    }

    /// As JSON.
    pub(crate) fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// The text of a file that should hold one.
    pub fn read(path: &Path) -> Result<String, String> {
        std::fs::read_to_string(path).map_err(|e| match e.kind() {
            ErrorKind::InvalidData => format!("{}: this is no session: it is not text; {EXPECTED}", path.display()),
            _ => format!("{}: {e}", path.display()),
        })
    }

    /// Reads JSON. Says in a line what is wrong with it and what would be right.
    pub fn parse(text: &str) -> Result<Self, String> {
        let head: Head = serde_json::from_str(text).map_err(|e| format!("this is no session: {e}; {EXPECTED}"))?;
        match head.format.as_deref() {
            Some(FORMAT) => {}
            Some(other) => return Err(format!("the format is {other:?}; a session has \"format\": {FORMAT:?}")),
            None => return Err(format!("this is no session: it has no \"format\": {FORMAT:?}")),
        }
        match head.version {
            Some(VERSION) => {}
            Some(other) => {
                return Err(format!("the session is of version {other}, and this viewer reads version {VERSION} only"));
            }
            None => return Err(format!("the session has no \"version\": {VERSION}")),
        }
        let session: Self = serde_json::from_str(text).map_err(|e| format!("the session cannot be read: {e}"))?;
        session.wanted()?;
        Ok(session)
    }

    /// The sets. Says what is wrong with one of them, or with what is shown.
    fn wanted(&self) -> Result<Vec<Wanted>, String> {
        let count = self.sets.len();
        if !(1..=MOST_SETS).contains(&count) {
            return Err(format!("the session has {count} sets; it must have 1 to {MOST_SETS}"));
        }
        if self.selected >= count {
            return Err(format!("\"selected\" is {}; with {count} sets it must be below {count}", self.selected));
        }
        self.check_view()?;
        let mut wanted: Vec<Wanted> = Vec::new();
        for (number, entry) in (1..).zip(&self.sets) {
            let color = entry.color;
            if color >= MOST_SETS || wanted.iter().any(|(_, other, _)| *other == color) {
                return Err(format!(
                    "set {number}: the colour is {color}; it must be below {MOST_SETS} and another for each set"
                ));
            }
            let request = Request::parse(entry.arguments.clone()).map_err(|e| format!("set {number}: {e}"))?;
            let request = self.check(request).map_err(|e| format!("set {number}: {e}"))?;
            wanted.push((request, color, entry.visible));
        }
        Ok(wanted)
    }

    /// A sampler that there is, and paths as seen from here.
    fn check(&self, mut request: Request) -> Result<Request, String> {
        let input = &mut request.input;
        if input.sampler.is_some() {
            Points::open(input).map_err(|e| e.told(pairwave::Setting::flag))?;
        } else if input.files.is_empty() {
            return Err("neither files nor --sampler NAME -n N are given".into());
        } else if input.files.iter().any(|file| file == Path::new("-")) {
            return Err("points from standard input (-) cannot be read again; save them to a file and name that".into());
        }
        let elsewhere = self.folder.as_ref().filter(|f| std::env::current_dir().is_ok_and(|here| here != **f));
        if let Some(folder) = elsewhere {
            let paths = input.files.iter_mut().chain(&mut request.edges).chain(&mut request.frequencies);
            paths.for_each(|path| *path = folder.join(&*path));
            let specs = request.integrand.iter_mut().chain(&mut request.intensity);
            specs.for_each(|spec| *spec = started(spec, folder));
        }
        Ok(request)
    }

    fn check_view(&self) -> Result<(), String> {
        let (name, value) = match self.view.tone_map {
            ToneMap::Reinhard => return self.check_plane(),
            ToneMap::Linear { max } => ("max", max),
            ToneMap::Log { decades } => ("decades", decades),
            ToneMap::Decibel { range } => ("range", range),
        };
        if !(value.is_finite() && value > 0.0) {
            return Err(format!("the tone map has \"{name}\": {value}; it must be above 0"));
        }
        self.check_plane()
    }

    fn check_plane(&self) -> Result<(), String> {
        match self.view.plane {
            0..3 => Ok(()),
            plane => Err(format!("\"plane\" is {plane}; it must be 0, 1 or 2")),
        }
    }
}

/// The specification of an integrand, the path of its file as seen from a folder.
fn started(spec: &str, folder: &Path) -> String {
    match spec.split_once("file=") {
        Some((head, file)) => format!("{head}file={}", folder.join(file).display()),
        None => spec.into(),
    }
}

/// Where the last session is kept between two runs.
pub const LAST: &str = "session";

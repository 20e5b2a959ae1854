//! What is asked for: one struct that the command line parses and the viewer edits, and the way back to a command line.
//! `analysis` turns it into plans.

mod device;
pub mod lists;
mod setting;
mod settings;

use std::path::PathBuf;

use clap::{Arg, Args, Parser};
use serde_json::{Map, Value};

use crate::error::{Error, Result, number};
use crate::estimate::Normalization;
use crate::plan::{Accuracy, Bandwidth, BinScale, Convention, Correction, Debias, Divisor, SmoothingKernel, Taper};
use crate::points::Boundary;
use crate::points::read::RawLayout;

pub use device::DeviceChoice;
pub use setting::Setting;

/// A statistic of `--stats`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Statistic {
    /// Pair correlation function g(r).
    Pcf,
    /// g of the vector between two points, on a grid of lags.
    PcfVector,
    /// Ripley's K(r), L(r) and the mean number of neighbours within r.
    KFunction,
    /// Power spectrum P(m) on the grid, with its radial mean and anisotropy.
    Spectrum,
    /// Radial mean and anisotropy only.
    Radial,
    /// Covariance of the amplitudes of low frequencies, E[s_m conj(s_l)].
    Covariance,
    /// Nearest-neighbour distances.
    Neighbors,
}

/// The points: files, or a sampler.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, serde::Serialize)]
pub struct PointsRequest {
    /// Point files or directories, one batch; `-` is stdin
    #[arg(value_name = "FILES", conflicts_with = "sampler")]
    #[serde(serialize_with = "as_text")]
    pub files: Vec<PathBuf>,

    /// Generate the points instead; `pairwave samplers` lists the names
    #[arg(long, value_name = "NAME", requires = "points")]
    pub sampler: Option<String>,

    /// Points per realization (with --sampler)
    #[arg(short = 'n', long = "points", value_name = "N")]
    pub points: Option<u64>,

    /// Number of realizations (with --sampler) [default: 1]
    #[arg(short = 'k', long = "realizations", value_name = "K")]
    pub realizations: Option<u64>,

    /// Dimension, 1 to 3 (with --sampler) [default: 2]
    #[arg(long, value_name = "D")]
    pub dim: Option<usize>,

    /// Seed (with --sampler) [default: 1]
    #[arg(long)]
    pub seed: Option<u64>,

    /// A sampler's parameter; may be repeated
    #[arg(long = "param", value_name = "KEY=VALUE")]
    pub params: Vec<String>,

    /// Read files as raw little-endian numbers, e.g. f32x2
    #[arg(long, value_name = "TYPExD", conflicts_with = "sampler", value_parser = raw_layout)]
    pub raw: Option<RawLayout>,

    /// The column that holds the weight of each point, by its name or its number from 1
    #[arg(long, value_name = "COLUMN", conflicts_with = "sampler")]
    pub weight_column: Option<String>,

    /// The column that holds the class of each point, by its name or its number from 1
    #[arg(long, value_name = "COLUMN", conflicts_with = "sampler")]
    pub class_column: Option<String>,

    /// What happens at the sides [default: torus; window with --window]
    #[arg(long, value_enum)]
    pub domain: Option<Boundary>,

    /// Sides of the torus [default: 1 each]
    #[arg(long = "box", value_name = "L1,L2[,L3]", value_delimiter = ',', allow_hyphen_values = true)]
    pub sides: Option<Vec<f64>>,

    /// The window the points were observed in
    #[arg(
        long,
        value_name = "x0,x1,y0,y1[,z0,z1]",
        value_delimiter = ',',
        allow_hyphen_values = true,
        conflicts_with_all = ["sides", "sampler"]
    )]
    pub window: Option<Vec<f64>>,

    /// Fold points outside the torus back in; without it they are an error
    #[arg(long, conflicts_with = "window")]
    pub wrap: bool,
}

/// What to measure, and how.
#[derive(Debug, Clone, PartialEq, clap::Args, serde::Serialize)]
pub struct Request {
    /// The points.
    #[command(flatten)]
    #[serde(flatten)]
    pub input: PointsRequest,

    /// Statistics to compute
    #[arg(long, value_enum, value_delimiter = ',', default_value = "pcf,spectrum,neighbors", value_name = "LIST")]
    pub stats: Vec<Statistic>,

    /// Largest distance [default: 8 closest-packing distances, at most half the shortest side]
    #[arg(long, value_name = "R", conflicts_with = "edges", allow_negative_numbers = true)]
    pub r_max: Option<f64>,

    /// Number of distance bins [default: 256]
    #[arg(long, value_name = "B", conflicts_with = "edges", allow_negative_numbers = true)]
    pub bins: Option<usize>,

    /// Spacing of the bins; log covers three decades below r-max [default: linear]
    #[arg(long, value_enum, conflicts_with = "edges")]
    pub bin_scale: Option<BinScale>,

    /// Bin edges, one number per line or separated by blanks or commas
    #[arg(long, value_name = "FILE")]
    #[serde(serialize_with = "as_text")]
    pub edges: Option<PathBuf>,

    /// Also smooth g with this kernel
    #[arg(long, value_enum)]
    pub kernel: Option<SmoothingKernel>,

    /// Standard deviation of the kernel, or a rule: stoyan, fiksel, or lscv (least-squares cross-validation) [default: stoyan]
    #[arg(long, value_name = "SD|RULE", requires = "kernel", allow_negative_numbers = true)]
    pub bandwidth: Option<Bandwidth>,

    /// What a pair at distance d adds to the estimate at r is divided by the surface of the sphere of radius r or d
    #[arg(long, value_enum, requires = "kernel")]
    pub divisor: Option<Divisor>,

    /// Sum the kernel over every pair, however many there are
    #[arg(long, requires = "kernel")]
    pub exact_kernel: bool,

    /// Edge correction [default: translation in a window, none on a torus]
    #[arg(long, value_enum)]
    pub correction: Option<Correction>,

    /// On a torus, also take distances beyond half the shortest side, up to half the diagonal
    #[arg(long)]
    pub beyond_half: bool,

    /// The two classes whose g is wanted, as a line of CSV [default: the two there are]
    #[arg(long, value_name = "A,B", requires = "class_column")]
    pub classes: Option<String>,

    /// Bins per axis of the vector g [default: 64]
    #[arg(long, value_name = "B", allow_negative_numbers = true)]
    pub lag_bins: Option<usize>,

    /// Largest lag per axis of the vector g [default: half the sides of a torus, the sides of a window]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub lag_max: Option<f64>,

    /// Radii of the rings along which g(r, theta) is shown [default: half, 1 and 2 closest-packing distances]
    #[arg(long, value_name = "R1,R2,...", value_delimiter = ',', allow_negative_numbers = true)]
    pub lag_rings: Option<Vec<f64>>,

    /// Simulate complete spatial randomness N times, for pointwise and global envelopes
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub envelope: Option<u64>,

    /// What pairs are divided by: n(n-1) or n^2 (with border correction n times the points deep enough inside, either way)
    #[arg(long, value_enum, default_value = "pairs")]
    pub normalization: Normalization,

    /// Largest frequency, for all axes or per axis [default: ceil(5 n^(1/d))]
    #[arg(long, value_name = "F[,F2[,F3]]", value_delimiter = ',', allow_negative_numbers = true)]
    pub max_frequency: Option<Vec<u32>>,

    /// Wave vectors, one per line: integers m on a torus; cycles per unit length in a window
    #[arg(long, value_name = "FILE", conflicts_with = "max_frequency")]
    #[serde(serialize_with = "as_text")]
    pub frequencies: Option<PathBuf>,

    /// For --stats radial: at most N wave vectors per ring, evenly spread over directions [default: all]
    #[arg(long, value_name = "N", allow_negative_numbers = true, conflicts_with = "frequencies")]
    pub ring_directions: Option<u64>,

    /// Sectors of half a turn in which angular power is summed (2D) [default: 18]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub sectors: Option<usize>,

    /// Largest frequency of the covariance of amplitudes [default: 8 in 2D, 64 in 1D, 2 in 3D]
    #[arg(long, value_name = "B", allow_negative_numbers = true)]
    pub covariance_frequency: Option<u32>,

    /// Taper of a window's spectrum [default: bartlett, the same everywhere]
    #[arg(long, value_enum)]
    pub taper: Option<Taper>,

    /// With --taper sine: the first N sine tapers per axis, averaged [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub tapers: Option<usize>,

    /// How the transform of the window itself is removed from its spectrum [default: direct]
    #[arg(long, value_enum)]
    pub debias: Option<Debias>,

    /// Grid, rings, labels and normalization of another program
    #[arg(long, value_enum, default_value = "ours")]
    pub convention: Convention,

    /// With --convention: also that program's known defects
    #[arg(long)]
    pub bug_compatible: bool,

    /// auto, cpu, gpu, reference, or an index of `pairwave devices`
    #[arg(long, default_value = "auto", value_name = "auto|cpu|gpu|reference|INDEX")]
    pub device: DeviceChoice,

    /// The promise about P (pair counts are exact either way)
    #[arg(long, value_enum, default_value = "fast")]
    pub accuracy: Accuracy,

    /// Threads of the CPU path [default: one per core]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub threads: Option<usize>,
}

/// Paths as text; what is no Unicode in them becomes U+FFFD.
fn as_text<P, S: serde::Serializer>(paths: &P, serializer: S) -> Result<S::Ok, S::Error>
where
    for<'a> &'a P: IntoIterator<Item = &'a PathBuf>,
{
    serializer.collect_seq(paths.into_iter().map(|path| path.to_string_lossy()))
}

fn raw_layout(text: &str) -> Result<RawLayout, String> {
    text.parse().map_err(|error: Error| error.told(crate::Setting::flag))
}

/// A request as a command of its own.
#[derive(clap::Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Typed {
    #[command(flatten)]
    request: Request,
}

impl Default for Request {
    /// What `pairwave analyze` measures when no flag is given.
    #[expect(clippy::expect_used, reason = "what parses is fixed, and a test parses it")]
    fn default() -> Self {
        Self::parse([]).expect("every setting has a default or may be left out")
    }
}

impl Request {
    /// The request that these arguments of `pairwave analyze` make. Says what is wrong with them in one line.
    pub fn parse(arguments: impl IntoIterator<Item = String>) -> Result<Self> {
        let arguments: Vec<String> = arguments.into_iter().collect();
        Typed::try_parse_from(&arguments)
            .map(|typed| typed.request)
            .map_err(|error| Error::Arguments { arguments: shell_words(&arguments), reason: in_a_line(&error) })
    }

    /// The shortest arguments of `pairwave analyze` that make this request: what has its default is left out, and files
    /// come last.
    pub fn arguments(&self) -> Vec<String> {
        let command = Self::augment_args(clap::Command::new("analyze"));
        self.arguments_with(&command, |_, values| values)
    }

    /// The arguments, each with other values than it has.
    fn arguments_with(
        &self,
        command: &clap::Command,
        values: impl Fn(&Arg, Vec<String>) -> Vec<String>,
    ) -> Vec<String> {
        let (settings, defaults) = (self.settings(), Self::default().settings());
        let (mut flags, mut files) = (Vec::new(), Vec::new());
        for argument in command.get_arguments() {
            let name = argument.get_id().as_str();
            let (Some(value), Some(default)) = (settings.get(name), defaults.get(name)) else { continue };
            let given = if value == default { Vec::new() } else { texts(value) };
            let mut values = values(argument, given);
            if argument.is_positional() {
                files = values;
                continue;
            }
            if let Some(delimiter) = argument.get_value_delimiter().filter(|_| !values.is_empty()) {
                values = vec![values.join(delimiter.encode_utf8(&mut [0; 4]))];
            }
            let long = format!("--{}", argument.get_long().unwrap_or(name));
            let flag = argument.get_short().map_or_else(|| long.clone(), |short| format!("-{short}"));
            for value in values {
                if !argument.get_action().takes_values() {
                    flags.push(flag.clone());
                } else if value.starts_with('-') {
                    flags.push(format!("{long}={value}"));
                } else {
                    flags.extend([flag.clone(), value]);
                }
            }
        }
        if files.iter().any(|file| file.len() > 1 && file.starts_with('-')) {
            flags.push("--".into());
        }
        flags.extend(files);
        flags
    }

    /// The command that makes this request, as a shell takes it.
    pub fn command(&self) -> String {
        let arguments = self.arguments();
        shell_words(["pairwave", "analyze"].into_iter().chain(arguments.iter().map(String::as_str)))
    }

    /// The settings as (name, value), unset ones left out, in the order of the help.
    pub fn parameters(&self) -> Vec<(String, String)> {
        let named = |(name, value): (String, Value)| match texts(&value) {
            texts if texts.is_empty() => None,
            texts => Some((name.replace('_', "-"), texts.join(","))),
        };
        self.settings().into_iter().filter_map(named).collect()
    }

    /// Every setting under the name of its field, which is also its name in clap.
    fn settings(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(settings)) => settings,
            _ => Map::new(),
        }
    }
}

/// What clap says, without the usage and the tips, which come after a blank line.
fn in_a_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let what: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    what.join(" ").trim_start_matches("error: ").to_string()
}

/// A setting as typed: none where it is unset, several where it is a list.
fn texts(value: &Value) -> Vec<String> {
    match value {
        Value::Null => Vec::new(),
        Value::String(text) => vec![text.clone()],
        Value::Array(items) => items.iter().flat_map(texts).collect(),
        Value::Number(n) if n.is_f64() => n.as_f64().map(number).into_iter().collect(),
        other => vec![other.to_string()],
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

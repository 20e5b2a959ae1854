//! The one table of settings: what each is called, what it is about, what it goes with. The help, the check for settings
//! that would be ignored, the rules of conventions and the controls of the viewer read it.

use super::values::Field;
use super::{Request, Statistic};
use crate::plan::Conventions;
use crate::setting::{Setting, renamed};

use Statistic::{Covariance, Intensity, KFunction, Neighbors, Pcf, PcfVector, Radial, Spectrum};

/// What a setting is about, in the order of the help.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// Where the points come from.
    Points,
    /// The box they lie in.
    Domain,
    /// What is computed.
    Statistics,
    /// g(r) and K(r).
    Distances,
    /// g of the vector.
    Lags,
    /// P.
    Frequencies,
    /// Errors of integrals.
    Integration,
    /// P of points in a window.
    Tapers,
    /// By what, and how well.
    Computing,
}

impl Group {
    /// As a heading.
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "Points",
            Self::Domain => "Domain",
            Self::Statistics => "Statistics",
            Self::Distances => "Distances",
            Self::Lags => "Lags",
            Self::Frequencies => "Frequencies",
            Self::Integration => "Integration",
            Self::Tapers => "Frequencies in a window",
            Self::Computing => "Computing",
        }
    }
}

/// What there is to know about a setting of a request, besides its type.
#[derive(Clone, Copy)]
pub struct Row {
    /// Which one.
    pub setting: Setting,
    /// Its flag as a user types it.
    pub flag: &'static str,
    /// What it is about.
    pub group: Group,
    /// Whether it is one of the few that most people need.
    pub usual: bool,
    /// The value that it has where it is left out, if one can be typed.
    pub default: Option<&'static str>,
    /// What it is where it is left out, in words.
    pub otherwise: &'static str,
    /// The statistics it is about; none where it is about all.
    pub statistics: &'static [Statistic],
    /// Why a convention that changes one of its statistics refuses it.
    pub refused: Option<&'static str>,
    /// Whether it shapes the points of samplers, and so says nothing about files.
    pub for_samplers: bool,
    /// What it says more about.
    pub needs: Option<Setting>,
    /// What it cannot be given with.
    pub conflicts: &'static [Setting],
    /// Its field.
    pub(super) get: fn(&Request) -> &dyn Field,
    /// Its field, to be changed.
    pub(super) get_mut: fn(&mut Request) -> &mut dyn Field,
}

/// Statistics of pairs, by distance.
const PAIRS: &[Statistic] = &[Pcf, KFunction];
/// Statistics of two classes, and those with envelopes.
const OF_CLASSES: &[Statistic] = &[Pcf, KFunction, Neighbors];
/// Statistics that points have weights for.
pub(super) const INHOMOGENEOUS: &[Statistic] = &[Pcf, KFunction, Spectrum, Radial, Covariance];
/// Statistics of frequencies.
const WAVES: &[Statistic] = &[Spectrum, Radial];
/// Why a program refuses settings of bins.
const OWN_BINS: Option<&str> = Some("has bins of its own");

/// A row of which only the essential is said: setting, flag, field, group.
macro_rules! row {
    ($setting:ident, $flag:literal, $($field:ident).+, $group:ident $(, $key:ident: $value:expr)* $(,)?) => {
        Row {
            $($key: $value,)*
            ..Row {
                setting: Setting::$setting,
                flag: $flag,
                group: Group::$group,
                usual: false,
                default: None,
                otherwise: "",
                statistics: &[],
                refused: None,
                for_samplers: false,
                needs: None,
                conflicts: &[],
                get: |request| &request.$($field).+,
                get_mut: |request| &mut request.$($field).+,
            }
        }
    };
}

/// All settings of a request, in the order of its fields.
#[rustfmt::skip]
pub static SETTINGS: [Row; 64] = [
    row!(Files, "FILES", input.files, Points, usual: true, conflicts: &[Setting::Sampler]),
    row!(Sampler, "--sampler", input.sampler, Points, usual: true),
    row!(Points, "-n", input.points, Points, usual: true, for_samplers: true),
    row!(Realizations, "-k", input.realizations, Points, usual: true, for_samplers: true, default: Some("1")),
    row!(Dim, "--dim", input.dim, Points, usual: true, for_samplers: true, default: Some("2")),
    row!(Seed, "--seed", input.seed, Points, usual: true, for_samplers: true, default: Some("1")),
    row!(Params, "--param", input.params, Points, usual: true, for_samplers: true),
    row!(Raw, "--raw", input.raw, Points, conflicts: &[Setting::Sampler]),
    row!(Array, "--array", input.array, Points, conflicts: &[Setting::Sampler, Setting::Raw]),
    row!(Columns, "--columns", input.columns, Points, usual: true, conflicts: &[Setting::Sampler],
        otherwise: "x, y, z by name, else all of 1 to 3"),
    row!(RealizationColumn, "--realization-column", input.realization_column, Points, conflicts: &[Setting::Sampler]),
    row!(WeightColumn, "--weight-column", input.weight_column, Points, conflicts: &[Setting::Sampler],
        statistics: INHOMOGENEOUS, refused: Some("has no weights of points")),
    row!(IntensityColumn, "--intensity-column", input.intensity_column, Points,
        conflicts: &[Setting::Sampler, Setting::WeightColumn], statistics: INHOMOGENEOUS, refused: Some("has no weights of points")),
    row!(ClassColumn, "--class-column", input.class_column, Points, conflicts: &[Setting::Sampler], statistics: OF_CLASSES),
    row!(KeepGoing, "--keep-going", input.keep_going, Points, conflicts: &[Setting::Sampler]),
    row!(EnvelopeFrom, "--envelope-from", input.envelope_from, Points, conflicts: &[Setting::Envelope],
        statistics: OF_CLASSES),
    row!(Inhomogeneous, "--inhomogeneous", input.inhomogeneous, Statistics,
        conflicts: &[Setting::WeightColumn, Setting::IntensityColumn, Setting::ClassColumn], statistics: INHOMOGENEOUS,
        refused: Some("has no weights of points")),
    row!(IntensityBandwidth, "--intensity-bandwidth", input.intensity_bandwidth, Statistics, statistics: &[Intensity],
        default: Some("scott")),
    row!(Domain, "--domain", input.domain, Domain, otherwise: "as the file states, else torus; window with `window`"),
    row!(Sides, "--box", input.sides, Domain, usual: true, otherwise: "as the file states, else 1 each"),
    row!(Window, "--window", input.window, Domain, usual: true, conflicts: &[Setting::Sides, Setting::Sampler]),
    row!(WindowPolygon, "--window-polygon", input.window_polygon, Domain,
        conflicts: &[Setting::Sides, Setting::Sampler, Setting::Window]),
    row!(Wrap, "--wrap", input.wrap, Domain, conflicts: &[Setting::Window, Setting::WindowPolygon]),
    row!(Unit, "--unit", input.unit, Domain),
    row!(Stats, "--stats", stats, Statistics, usual: true, default: Some("pcf,spectrum,neighbors")),
    row!(RMax, "--r-max", r_max, Distances, usual: true, conflicts: &[Setting::Edges], statistics: PAIRS, refused: OWN_BINS,
        otherwise: "8 closest-packing distances, at most half the shortest side"),
    row!(Bins, "--bins", bins, Distances, usual: true, conflicts: &[Setting::Edges], statistics: PAIRS, refused: OWN_BINS,
        default: Some("256")),
    row!(BinScale, "--bin-scale", bin_scale, Distances, conflicts: &[Setting::Edges], statistics: PAIRS, refused: OWN_BINS,
        default: Some("linear")),
    row!(Edges, "--edges", edges, Distances, statistics: PAIRS, refused: OWN_BINS),
    row!(Kernel, "--kernel", kernel, Distances, usual: true, statistics: &[Pcf], refused: Some("has no smoothed g")),
    row!(Bandwidth, "--bandwidth", bandwidth, Distances, needs: Some(Setting::Kernel), statistics: &[Pcf],
        default: Some("stoyan")),
    row!(Divisor, "--divisor", divisor, Distances, needs: Some(Setting::Kernel), statistics: &[Pcf], default: Some("r")),
    row!(ExactKernel, "--exact-kernel", exact_kernel, Distances, needs: Some(Setting::Kernel), statistics: &[Pcf]),
    row!(Correction, "--correction", correction, Distances, usual: true, statistics: &[Pcf, KFunction, PcfVector],
        otherwise: "translation in a window, none on a torus"),
    row!(BeyondHalf, "--beyond-half", beyond_half, Distances, statistics: PAIRS, refused: OWN_BINS),
    row!(Classes, "--classes", classes, Distances, needs: Some(Setting::ClassColumn), statistics: OF_CLASSES,
        otherwise: "the two there are"),
    row!(LagBins, "--lag-bins", lag_bins, Lags, usual: true, statistics: &[PcfVector], default: Some("65")),
    row!(LagMax, "--lag-max", lag_max, Lags, usual: true, statistics: &[PcfVector],
        otherwise: "4 closest-packing distances, as far as they fit"),
    row!(LagRings, "--lag-rings", lag_rings, Lags, statistics: &[PcfVector],
        otherwise: "half, 1 and 2 closest-packing distances"),
    row!(Envelope, "--envelope", envelope, Distances, usual: true, statistics: &[Pcf, KFunction, Neighbors]),
    row!(Normalization, "--normalization", normalization, Distances, usual: true, default: Some("pairs"),
        statistics: &[Pcf, KFunction, PcfVector], refused: Some("divides by n(n-1)")),
    row!(MaxFrequency, "--max-frequency", max_frequency, Frequencies, usual: true, statistics: WAVES,
        otherwise: "ceil(5 n^(1/d))"),
    row!(Frequencies, "--frequencies", frequencies, Frequencies, conflicts: &[Setting::MaxFrequency],
        statistics: &[Spectrum], refused: Some("has a grid of its own")),
    row!(RingDirections, "--ring-directions", ring_directions, Frequencies, conflicts: &[Setting::Frequencies],
        statistics: &[Radial], refused: Some("takes every wave vector of a ring"), otherwise: "all"),
    row!(Sectors, "--sectors", sectors, Frequencies, statistics: WAVES, refused: Some("has no directions"),
        default: Some("18")),
    row!(CovarianceFrequency, "--covariance-frequency", covariance_frequency, Frequencies, statistics: &[Covariance],
        otherwise: "8 in 2D, 64 in 1D, 2 in 3D"),
    row!(Integrand, "--integrand", integrand, Integration, usual: true, refused: Some("predicts no integrals")),
    row!(Estimator, "--estimator", estimator, Integration, needs: Some(Setting::Integrand),
        otherwise: "mean for equal n, else lambda"),
    row!(Shifts, "--shifts", shifts, Integration, needs: Some(Setting::Integrand), default: Some("16")),
    row!(Spatial, "--spatial", spatial, Integration, needs: Some(Setting::Integrand),
        otherwise: "by the number of pairs"),
    row!(Top, "--top", top, Integration, needs: Some(Setting::Integrand), otherwise: "100, in the table alone"),
    row!(Intensity, "--intensity", intensity, Integration, needs: Some(Setting::Integrand), otherwise: "uniform"),
    row!(By, "--by", by, Integration, needs: Some(Setting::Intensity)),
    row!(IntensityGrid, "--intensity-grid", intensity_grid, Statistics, statistics: &[Intensity],
        otherwise: "128 in 2D, 512 in 1D, 32 in 3D"),
    row!(Taper, "--taper", taper, Tapers, usual: true, statistics: WAVES, default: Some("bartlett"),
        otherwise: "bartlett, the same everywhere"),
    row!(Tapers, "--tapers", tapers, Tapers, statistics: WAVES, default: Some("1")),
    row!(Debias, "--debias", debias, Tapers, statistics: WAVES, default: Some("direct")),
    row!(Convention, "--convention", convention, Frequencies, usual: true, statistics: WAVES, default: Some("ours")),
    row!(BugCompatible, "--bug-compatible", bug_compatible, Frequencies, statistics: WAVES),
    row!(Device, "--device", device, Computing, usual: true, default: Some("auto")),
    row!(Accuracy, "--accuracy", accuracy, Computing, usual: true, default: Some("fast")),
    row!(Threads, "--threads", threads, Computing, usual: true, otherwise: "one per core"),
    row!(Memory, "--memory", memory, Computing, otherwise: "half of what the machine has"),
    row!(Costs, "--costs", costs, Computing, otherwise: "built in"),
];

/// The statistics that the program of a convention computes otherwise.
pub(super) fn changed_by(conventions: &Conventions) -> &'static [Statistic] {
    if conventions.pairs { &[Pcf, Spectrum, Radial] } else { WAVES }
}

impl Row {
    /// What it is where it is left out, in words with the names that a face has for settings; empty where nothing says that.
    pub fn left_out(&self, name: impl Fn(Setting) -> &'static str) -> String {
        match self.default {
            Some(default) if self.otherwise.is_empty() => default.into(),
            _ => renamed(self.otherwise, name),
        }
    }
}

impl Setting {
    /// What there is to know about it, if a request has it.
    pub fn row(self) -> Option<&'static Row> {
        SETTINGS.iter().find(|row| row.setting == self)
    }

    /// Its flag as a user types it, `--r-max`.
    pub fn flag(self) -> &'static str {
        match self {
            Self::Calibrate => "--calibrate",
            Self::Out => "--out",
            Self::Force => "--force",
            Self::Projections => "--projections",
            Self::Prefixes => "--prefixes",
            Self::Shard => "--shard",
            Self::Checkpoint => "--checkpoint",
            Self::Resume => "--resume",
            Self::Extend => "--extend",
            Self::TimeLimit => "--time-limit",
            Self::UntilError => "--until-error",
            Self::KeepSums => "--keep-sums",
            Self::Npz => "--npz",
            Self::Partial => "--partial",
            Self::PowerFrom => "--p",
            Self::Beside => "--beside",
            Self::Alpha => "--alpha",
            Self::Tolerance => "--tolerance",
            Self::Figures => "--figure",
            Self::Labels => "--labels",
            Self::Page => "--page",
            Self::RangeX => "--x",
            Self::RangeY => "--y",
            Self::LogX => "--log-x",
            Self::LogY => "--log-y",
            Self::Colors => "--colors",
            Self::Size => "--size",
            Self::Format => "--format",
            _ => self.row().map_or("", |row| row.flag),
        }
    }
}

#[cfg(test)]
#[cfg(feature = "cli")]
mod tests {
    use std::collections::BTreeSet;

    use clap::{Args, Command};

    use super::*;
    use crate::analysis::Plan;
    use crate::plan::EnsembleShape;
    use crate::points::Domain;
    use crate::request::dress;
    use crate::source::Points;

    fn request(line: &str) -> Request {
        Request::parse(line.split_whitespace().map(String::from)).unwrap()
    }

    #[test]
    fn every_row_is_an_argument_and_every_argument_a_row() {
        let command = Request::augment_args(Command::new(""));
        let arguments: Vec<_> = command.get_arguments().map(|argument| argument.get_id().as_str()).collect();
        let rows: Vec<_> = SETTINGS.iter().map(|row| row.setting.name()).collect();
        assert_eq!(arguments, rows, "in the order of the fields, which is that of the help");
        assert_eq!(Setting::ALL[..rows.len()].iter().map(|s| s.name()).collect::<Vec<_>>(), rows);
        for (argument, row) in command.get_arguments().zip(&SETTINGS) {
            let long = argument.get_long().map(|long| format!("--{long}"));
            let short = argument.get_short().map(|short| format!("-{short}"));
            let flag = short.or(long).unwrap_or("FILES".into());
            assert_eq!(flag, row.flag);
            let filled: Vec<_> = argument.get_default_values().iter().map(|v| v.to_string_lossy()).collect();
            if !filled.is_empty() && !row.is_switch() {
                assert_eq!(Some(filled.join(",").as_str()), row.default, "{flag}");
            }
            // What clap offers is what can be typed elsewhere.
            let offered: Vec<_> = argument.get_possible_values().iter().map(|v| v.get_name().to_string()).collect();
            if !offered.is_empty() && !row.is_switch() {
                assert_eq!(offered, row.choices(), "{flag}");
            }
        }
        let flags: BTreeSet<_> = Setting::ALL.iter().map(|setting| setting.flag()).collect();
        assert_eq!(flags.len(), Setting::ALL.len(), "a flag is of one setting");
        assert!(!flags.contains(""), "every setting has one");
        assert_eq!(request(""), Request::default());
    }

    /// Giving a setting the default that the table names changes nothing that is decided.
    #[test]
    fn the_defaults_are_those_of_the_code() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "1 2\n3 4\n5 1\n").unwrap();
        let window = format!("--window 0,6,0,6 {}", file.path().display());
        let decided = |request: &Request| {
            let source = Points::open(&request.input).unwrap();
            let plan = Plan::of(request, &source).unwrap();
            (source.subject().to_string(), source.domain().clone(), plan)
        };
        let mut seen = 0;
        for row in SETTINGS.iter() {
            let Some(default) = row.default else { continue };
            let scene = match row.group {
                Group::Tapers => format!("--taper sine --stats spectrum {window}"),
                Group::Lags => "--sampler random -n 9 --stats pcf-vector".into(),
                Group::Integration => "--sampler random -n 9 --integrand disk".into(),
                Group::Statistics if row.statistics == [Intensity] => "--sampler random -n 9 --stats intensity".into(),
                _ => "--sampler random -n 9 --kernel box".into(),
            };
            let given = request(&scene);
            let without = given.with(row.setting, "").unwrap();
            let with = without.with(row.setting, default);
            // The default of the taper itself is not the sine.
            let [without, with] = match row.setting {
                Setting::Taper => [request(&window), request(&format!("--taper {default} {window}"))],
                _ => [without, with.unwrap()],
            };
            assert_eq!(decided(&without), decided(&with), "{}", row.flag);
            assert_eq!(without.normalization, with.normalization);
            seen += 1;
        }
        assert!(seen > 15);
    }

    /// Those that are a rule, in words, for a scene of each kind.
    #[test]
    fn the_rules_are_those_of_the_code() {
        let shape = EnsembleShape { realizations: 2, mean_points: 400.0, max_points: 400 };
        let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
        let stats = "--stats pcf,pcf-vector,spectrum,radial,covariance";
        for domain in [Domain::unit_torus(1), Domain::unit_torus(2), Domain::unit_torus(3), window] {
            let torus = domain.is_torus();
            let (r_max, shortest) = (8.0 * domain.closest_packing_distance(400.0), domain.shortest_side());
            let dim = domain.dim();
            let frequency = (5.0 * 400f64.powf(1.0 / dim as f64)).ceil();
            for (setting, words, value) in [
                (
                    Setting::RMax,
                    "8 closest-packing distances, at most half the shortest side",
                    Some(r_max.min(shortest / 2.0).to_string()),
                ),
                (
                    Setting::Correction,
                    "translation in a window, none on a torus",
                    Some(if torus { "none" } else { "translation" }.into()),
                ),
                (
                    Setting::LagMax,
                    "4 closest-packing distances, as far as they fit",
                    Some((0.5 * r_max).min(if torus { shortest / 2.0 } else { shortest }).to_string()),
                ),
                (Setting::MaxFrequency, "ceil(5 n^(1/d))", torus.then(|| frequency.to_string())),
                (
                    Setting::CovarianceFrequency,
                    "8 in 2D, 64 in 1D, 2 in 3D",
                    Some(["64", "8", "2"][dim - 1].to_string()),
                ),
                (Setting::RingDirections, "all", None),
                (Setting::Taper, "bartlett, the same everywhere", (!torus).then(|| "bartlett".to_string())),
            ] {
                let row = setting.row().unwrap();
                assert_eq!(row.otherwise, words);
                let Some(value) = value else { continue };
                let without = request(&format!("{stats} x"));
                let with = without.with(setting, &value).unwrap();
                let [without, with] = [without, with].map(|request| Plan::new(&request, &domain, shape).unwrap());
                assert_eq!(without, with, "{setting} {value}, {domain:?}");
            }
        }
    }

    /// One line for each usual setting: `pairwave analyze -h` is read on a screen.
    #[test]
    fn the_short_help_is_short() {
        let mut command = dress(Request::augment_args(Command::new("analyze"))).term_width(100);
        let short = command.render_help().to_string();
        for row in &SETTINGS {
            let name = row.flag.trim_start_matches("-n").trim_start_matches("-k");
            if name.len() > 2 {
                let lines = short.lines().filter(|line| line.split([' ', '[', ']']).any(|word| word == name)).count();
                assert!(lines >= usize::from(row.usual), "{name}\n{short}");
            }
        }
        assert!(short.lines().count() <= 52, "{}\n{short}", short.lines().count());
        let long = command.render_long_help().to_string();
        for row in SETTINGS.iter().filter(|row| row.flag.starts_with("--")) {
            let otherwise = row.left_out(Setting::flag);
            assert!(long.contains(row.flag), "{}", row.flag);
            let long = long.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(otherwise.is_empty() || long.contains(&format!("[default: {otherwise}]")), "{}", row.flag);
            assert!(long.contains(row.group.name()));
        }
    }
}

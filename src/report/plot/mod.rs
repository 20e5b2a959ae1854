//! Figures drawn again from the tables of results, one curve per result: nothing is computed.

mod headlines;
mod page;
#[cfg(feature = "print")]
mod print;
mod result;

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::columns::{Curve, Place};
use super::{is_own, svg};
use crate::display::figure::{
    BLUE, Figure, GREEN, GREY, INK, Layer, ORANGE, Of, PURPLE, Rgb, SKY, Stroke, VERMILION, band_runs, runs,
};
use crate::display::{Interval, Units, about_one, decades, escape, extent, grow, shortened, top_of};
use crate::error::{Error, Result, number, numbers};
use crate::named::named;
use crate::setting::Setting;
use crate::stage;
use crate::statistics::axes::{DRAWN, Drawn, Level, Values};
pub(crate) use page::{Additions, Seen};
pub(crate) use result::Stored;

/// What is drawn, of which results, and how.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Plot {
    /// Directories that `pairwave analyze --out` wrote
    #[cfg_attr(feature = "cli", arg(value_name = "DIR", required = true))]
    pub results: Vec<PathBuf>,

    /// Figure to draw, as in pcf; may be repeated [default: all that every result has]
    #[cfg_attr(feature = "cli", arg(long = "figure", value_name = "NAME"))]
    pub figures: Vec<String>,

    /// Names of the results in the legend [default: those of their directories]
    #[cfg_attr(feature = "cli", arg(long, value_name = "A,B,...", value_delimiter = ','))]
    pub labels: Vec<String>,

    /// Range of the abscissa
    #[cfg_attr(
        feature = "cli",
        arg(long = "x", value_name = "LO,HI", value_delimiter = ',', allow_hyphen_values = true)
    )]
    pub range_x: Vec<f64>,

    /// Range of the ordinate
    #[cfg_attr(
        feature = "cli",
        arg(long = "y", value_name = "LO,HI", value_delimiter = ',', allow_hyphen_values = true)
    )]
    pub range_y: Vec<f64>,

    /// Logarithmic abscissa, or =false [default: where distances grow by factors]
    #[cfg_attr(feature = "cli", arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true"))]
    pub log_x: Option<bool>,

    /// Logarithmic ordinate, or =false [default: where g falls over decades]
    #[cfg_attr(feature = "cli", arg(long, value_name = "BOOL", num_args = 0..=1, require_equals = true, default_missing_value = "true"))]
    pub log_y: Option<bool>,

    /// No bands of errors, and no envelope
    #[cfg_attr(feature = "cli", arg(long))]
    pub no_bands: bool,

    /// Lines of the curves in turn: solid, dashed or dotted
    #[cfg_attr(feature = "cli", arg(long = "style", value_name = "LIST", value_delimiter = ','))]
    pub styles: Vec<Stroke>,

    /// Colors of the curves in turn: blue, vermilion, green, purple, orange, sky, black, grey or #rrggbb
    #[cfg_attr(feature = "cli", arg(long, value_name = "LIST", value_delimiter = ','))]
    pub colors: Vec<String>,

    /// Width and height on paper
    #[cfg_attr(feature = "cli", arg(long, value_name = "WxHmm", default_value = DEFAULT_SIZE))]
    pub size: String,

    /// Title above the figure [default: none]
    #[cfg_attr(feature = "cli", arg(long, value_name = "TEXT"))]
    pub title: Option<String>,

    #[cfg_attr(feature = "print", doc = "File format: svg, pdf or png [default: svg, or as the file ends]")]
    #[cfg_attr(not(feature = "print"), doc = "File format: svg")]
    #[cfg_attr(feature = "cli", arg(long, value_name = "FORMAT"))]
    pub format: Option<Format>,
}

const DEFAULT_SIZE: &str = "120x80mm";

/// What a figure is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Text that any browser shows.
    Svg,
    /// For print.
    #[cfg(feature = "print")]
    Pdf,
    /// 300 pixels per inch.
    #[cfg(feature = "print")]
    Png,
}

#[cfg(feature = "print")]
named!(Format: Svg = "svg", Pdf = "pdf", Png = "png");
#[cfg(not(feature = "print"))]
named!(Format: Svg = "svg");

/// What was drawn.
#[derive(Debug)]
#[non_exhaustive]
pub struct Plotted {
    /// The files, one per figure.
    pub files: Vec<PathBuf>,
    /// What makes the results hard to compare.
    pub warnings: Vec<String>,
}

/// Pictures of an analysis that are no curves.
const PICTURES: [&str; 6] = ["spectrum", "spectrum_grey", "pcf_vector", "covariance", "attribution_map", "points"];

/// Colours in turn, and those with other names.
const COLORS: [(&str, Rgb); 8] = [
    ("blue", BLUE),
    ("vermilion", VERMILION),
    ("green", GREEN),
    ("purple", PURPLE),
    ("orange", ORANGE),
    ("sky", SKY),
    ("black", INK),
    ("grey", GREY),
];
/// How many of them are for curves where none are asked for.
const IN_TURN: usize = 6;

impl Plot {
    /// Draws into a file, or one file per figure into a directory; a file is one that ends with the name of a format. What is there
    /// already is refused without `force`. Files appear whole.
    ///
    /// # Errors
    /// The setting, directory, table or line that is wrong; what the file system says. Nothing is written before all is drawn.
    pub fn draw(&self, out: &Path, force: bool) -> Result<Plotted> {
        let results = self.results.iter().map(|dir| Stored::open(dir)).collect::<Result<Vec<_>>>()?;
        let drawn = self.chosen(&results)?;
        let look = Look::of(self, &results)?;
        let files = self.files(out, &drawn)?;
        if let Some(taken) = files.iter().find(|file| file.symlink_metadata().is_ok()).filter(|_| !force) {
            let reason = format!("there is a file {} already; `force` replaces it", taken.display());
            return Err(Error::setting(Setting::Out, out.display(), reason));
        }
        files.iter().try_for_each(|file| check_file(Setting::Out, file, force))?;
        let mut pictures = Vec::new();
        for (each, file) in drawn.into_iter().zip(&files) {
            let figure = look.overlay(each, &results)?.figure;
            let failed = |e| Error::file(file, std::io::Error::other(e));
            pictures.push(encoded(svg::for_paper(&figure, look.size).map_err(failed)?, file).map_err(failed)?);
        }
        for (file, picture) in files.iter().zip(&pictures) {
            write(file, picture, force)?;
        }
        Ok(Plotted { files, warnings: warnings(&results) })
    }

    /// Writes one page with every figure that was asked for, the results over each other, what differs between them, and their numbers side by
    /// side. A file that is there already is refused without `force`.
    ///
    /// # Errors
    /// As `draw`.
    pub fn page(&self, file: &Path, force: bool) -> Result<Plotted> {
        let results = self.results.iter().map(|dir| Stored::open(dir)).collect::<Result<Vec<_>>>()?;
        let drawn = self.chosen(&results)?;
        let look = Look::of(self, &results)?;
        check_file(Setting::Page, file, force)?;
        let place = |path: &Path| path.canonicalize().ok();
        let among =
            |dir: &PathBuf| place(dir).is_some_and(|dir| place(file).is_some_and(|file| file.parent() == Some(&dir)));
        if is_own(file) && self.results.iter().any(among) {
            let reason = "is a file of a result that is drawn; expected another";
            return Err(Error::setting(Setting::Page, file.display(), reason));
        }
        let warnings = warnings(&results);
        let html = page::page(&look, &drawn, &results, &warnings, file, &())?;
        write(file, html.as_bytes(), force)?;
        Ok(Plotted { files: vec![file.into()], warnings })
    }

    /// The page of results with all figures that they have in common, if any, and what is added to them. It will be in a file.
    ///
    /// # Errors
    /// A table that is none, by its file and line.
    pub(crate) fn page_with(results: &[PathBuf], file: &Path, add: &dyn Additions) -> Result<String> {
        let plot = Self { results: results.to_vec(), size: DEFAULT_SIZE.into(), ..Self::default() };
        let results = results.iter().map(|dir| Stored::open(dir)).collect::<Result<Vec<_>>>()?;
        let drawn = common(&results)?;
        page::page(&Look::of(&plot, &results)?, &drawn, &results, &warnings(&results), file, add)
    }

    /// The figures that were asked for, or all that every result has.
    fn chosen(&self, results: &[Stored]) -> Result<Vec<&'static Drawn>> {
        let all = common(results)?;
        if all.is_empty() {
            let without = (1..results.len()).find(|&k| common(&results[..k]).is_ok_and(|some| some.is_empty()));
            let place = results[without.unwrap_or(results.len()).saturating_sub(1)].dir.display().to_string();
            let expected = DRAWN.map(|drawn| drawn.table).into_iter().collect::<BTreeSet<_>>();
            let expected = expected.into_iter().collect::<Vec<_>>().join(", ");
            return Err(Error::input(place, format!("has no table that all results have; expected one of {expected}")));
        }
        let names = all.iter().map(|drawn| drawn.stem).collect::<Vec<_>>().join(", ");
        let mut chosen: Vec<&'static Drawn> = Vec::new();
        for name in &self.figures {
            let Some(drawn) = DRAWN.into_iter().find(|drawn| drawn.stem == name) else {
                let what = if PICTURES.contains(&name.as_str()) { "is no curve; " } else { "" };
                return Err(Error::setting(Setting::Figures, name, format!("{what}expected one of {names}")));
            };
            for result in results {
                if let Err(why) = result.curves(drawn)? {
                    return Err(Error::setting(Setting::Figures, name, format!("{why}; expected one of {names}")));
                }
            }
            if !chosen.iter().any(|other| other.stem == drawn.stem) {
                chosen.push(drawn);
            }
        }
        Ok(if chosen.is_empty() { all } else { chosen })
    }

    /// The file of each figure.
    fn files(&self, out: &Path, drawn: &[&Drawn]) -> Result<Vec<PathBuf>> {
        let formats: Vec<_> = Format::ALL.iter().map(|format| format.name()).collect();
        let ending = out.extension().and_then(|ending| ending.to_str()).filter(|_| !out.is_dir());
        let Some(ending) = ending else {
            let format = self.format.unwrap_or(Format::Svg);
            return Ok(drawn.iter().map(|drawn| out.join(format!("{}.{format}", drawn.stem))).collect());
        };
        let refuse = |reason| Err(Error::setting(Setting::Out, out.display(), reason));
        match ending.parse::<Format>() {
            Err(_) => refuse(format!("expected a directory, or a file that ends with .{}", formats.join(", ."))),
            Ok(format) if self.format.is_some_and(|given| given != format) => {
                let given = self.format.unwrap_or(format);
                Err(Error::setting(Setting::Format, given, format!("is not that of {}", out.display())))
            }
            Ok(_) if drawn.len() > 1 => {
                let names: Vec<_> = drawn.iter().map(|drawn| drawn.stem).collect();
                let several = format!("{} figures are no one file", drawn.len());
                refuse(format!("{several}; expected a directory, or `figures` one of {}", names.join(", ")))
            }
            Ok(_) => Ok(vec![out.into()]),
        }
    }
}

/// The figures that every result has.
///
/// # Errors
/// A table that cannot be read, by its file and line.
fn common(results: &[Stored]) -> Result<Vec<&'static Drawn>> {
    let all = results.iter().map(Stored::figures).collect::<Result<Vec<_>>>()?;
    let Some((first, others)) = all.split_first() else { return Ok(Vec::new()) };
    let everywhere = |drawn: &&&Drawn| others.iter().all(|here| here.iter().any(|other| other.stem == drawn.stem));
    Ok(first.iter().filter(everywhere).copied().collect())
}

/// What makes results hard to compare with the first.
fn warnings(results: &[Stored]) -> Vec<String> {
    let of = |(first, others): (&Stored, &[Stored])| others.iter().flat_map(|other| first.differences(other)).collect();
    results.split_first().map_or(Vec::new(), of)
}

/// A figure in the format of its file.
fn encoded(svg: String, file: &Path) -> Result<Vec<u8>, Box<dyn std::error::Error + Send + Sync>> {
    match file.extension().and_then(|ending| ending.to_str()).and_then(|ending| ending.parse::<Format>().ok()) {
        #[cfg(feature = "print")]
        Some(Format::Pdf) => print::pdf(&svg),
        #[cfg(feature = "print")]
        Some(Format::Png) => print::png(&svg),
        Some(Format::Svg) | None => Ok(svg.into_bytes()),
    }
}

/// Whether a file may be written: it is not there, or a file that `force` replaces.
pub(super) fn check_file(setting: Setting, path: &Path, force: bool) -> Result<()> {
    let reason = match path.symlink_metadata() {
        Err(_) => return Ok(()),
        Ok(_) if path.is_dir() => "is a directory; expected a file",
        Ok(_) if crate::input::is_stream(path) => "is a pipe or a device; expected a file",
        Ok(_) if force => return Ok(()),
        Ok(_) => "is there already; `force` replaces it",
    };
    Err(Error::setting(setting, path.display(), reason))
}

/// Writes a file whole, and its directory if there is none.
pub(super) fn write(path: &Path, bytes: &[u8], force: bool) -> Result<()> {
    let failed = |e| Error::file(path, e);
    let ground = path.parent().filter(|ground| !ground.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(ground).map_err(|e| Error::file(ground, e))?;
    let mut file = stage::file_within(ground).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    let placed = if force { file.persist(path) } else { file.persist_noclobber(path) };
    placed.map(|_| ()).map_err(|e| failed(e.error))
}

/// A figure with the curves of several results.
struct Overlay {
    figure: Figure,
    /// The curve that each layer belongs to; of the others none.
    groups: Vec<Option<usize>>,
    /// Of each curve, in the order of their lines, which are the last layers: its result, its look, and where it stands in the table.
    curves: Vec<(usize, (Rgb, Stroke), Place)>,
}

/// How everything is drawn.
struct Look<'a> {
    plot: &'a Plot,
    labels: Vec<String>,
    x: Option<Range<f64>>,
    y: Option<Range<f64>>,
    colors: Vec<Rgb>,
    size: [f64; 2],
    units: Units,
}

impl<'a> Look<'a> {
    fn of(plot: &'a Plot, results: &[Stored]) -> Result<Self> {
        let range = |setting, ends: &[f64], log: bool| match *ends {
            [] => Ok(None),
            [lo, hi] if log && lo <= 0.0 => {
                let reason = "a logarithmic axis begins above 0; expected LO > 0";
                Err(Error::setting(setting, numbers([lo, hi]), reason))
            }
            [lo, hi] if lo < hi && (hi - lo).is_finite() => Ok(Some(lo..hi)),
            _ => {
                let reason = "expected two numbers LO,HI, the first the smaller";
                Err(Error::setting(setting, numbers(ends.iter().copied()), reason))
            }
        };
        let first = results.first();
        let agree = |same: &dyn Fn(&Stored) -> bool| results.iter().all(same);
        let unit = first.and_then(Stored::unit).filter(|unit| agree(&|r| r.unit() == Some(*unit)));
        let convention = first.map(Stored::convention).filter(|convention| agree(&|r| r.convention() == *convention));
        Ok(Self {
            plot,
            labels: labels(plot)?,
            x: range(Setting::RangeX, &plot.range_x, plot.log_x == Some(true))?,
            y: range(Setting::RangeY, &plot.range_y, plot.log_y == Some(true))?,
            colors: plot.colors.iter().map(|color| parsed_color(color)).collect::<Result<_>>()?,
            size: parsed_size(&plot.size)?,
            units: Units::new(unit, &convention.unwrap_or_default().resolve(false)).escaped(),
        })
    }

    /// A figure with the curves of every result.
    fn overlay(&self, drawn: &Drawn, results: &[Stored]) -> Result<Overlay> {
        let mut curves: Vec<(usize, usize, Curve)> = Vec::new();
        for (which, result) in results.iter().enumerate() {
            let found = result.curves(drawn)?.map_err(|why| Error::setting(Setting::Figures, drawn.stem, why))?;
            curves.extend(found.into_iter().enumerate().map(|(k, curve)| (which, k, curve)));
        }
        let levels = levels(drawn, results)?;
        let (x, log_x) = self.x_range(drawn, &curves)?;
        let inside = |at: Interval| (x.start..=x.end).contains(&at.1);
        let shown = || curves.iter().flat_map(|c| &c.2.samples).filter(|s| inside(s.0));
        let values: Vec<(f64, f64)> = shown().filter_map(|s| Some((s.1?, s.2.unwrap_or(0.0)))).collect();
        let (y, log_y) = self.y_range(drawn, &values, &levels)?;

        let bands = !self.plot.no_bands;
        let mut layers = Vec::new();
        if let Level::At(y, name) = drawn.level {
            layers.push(Layer::Level { name: name.into(), y });
        }
        if let ([only], true) = (results, bands) {
            layers.extend(envelope(only, drawn)?);
        }
        let several = curves.iter().any(|curve| curve.1 > 0);
        let look = |which: usize, curve: usize| {
            // Of several results each has its colour, and each of its curves a stroke; of one each curve a colour.
            let (turn, stroke) = if results.len() > 1 { (which, curve) } else { (curve, 0) };
            let stroke = if self.plot.styles.is_empty() {
                Stroke::ALL[(stroke + turn / IN_TURN) % Stroke::ALL.len()]
            } else {
                self.plot.styles[turn % self.plot.styles.len()]
            };
            let color = match self.colors.as_slice() {
                [] => COLORS[turn % IN_TURN].1,
                colors => colors[turn % colors.len()],
            };
            (color, stroke)
        };
        let mut owners = BTreeMap::new();
        for (at, (which, k, curve)) in curves.iter().enumerate().filter(|_| bands) {
            let ends = |s: &(Interval, Option<f64>, Option<f64>)| (s.0, s.1.zip(s.2).map(|(y, se)| (y - se, y + se)));
            let runs = band_runs(curve.samples.iter().map(ends));
            let runs: Vec<_> = runs.iter().flat_map(|run| cut(run, &x)).collect();
            if !runs.is_empty() {
                owners.insert(layers.len(), at);
                layers.push(Layer::Band { name: String::new(), color: look(*which, *k).0, runs });
            }
        }
        let line = |name: String, (color, stroke): (Rgb, Stroke), width, samples: &mut dyn Iterator<Item = _>| {
            let strips: Vec<Vec<[f64; 3]>> =
                runs(samples).into_iter().map(|run| run.into_iter().map(|(x, y)| [x, y, y]).collect()).collect();
            let runs = strips.iter().flat_map(|run| cut(run, &x));
            let runs = runs.map(|run| run.into_iter().map(|[x, y, _]| (x, y)).collect()).collect();
            Layer::Line { name, color, width, stroke, runs, of: Of::Points }
        };
        for (name, samples) in &levels {
            layers.push(line((*name).into(), (INK, Stroke::Dashed), 1.2, &mut samples.iter().copied()));
        }
        for (which, k, curve) in &curves {
            let label = &self.labels[*which];
            let named = results.len() > 1 || !self.plot.labels.is_empty();
            let name = match (named, several) {
                (true, true) => format!("{label}, {}", curve.name),
                (true, false) => label.clone(),
                (false, true) => curve.name.clone(),
                (false, false) => String::new(),
            };
            let mut samples = curve.samples.iter().map(|s| (s.0, s.1));
            layers.push(line(escape(&shortened(&name, 48)), look(*which, *k), 1.6, &mut samples));
        }
        // Bands of curves stand in front of all lines, in the order of the curves.
        let last = layers.len() - curves.len();
        let groups = (0..layers.len()).map(|k| owners.get(&k).copied().or_else(|| k.checked_sub(last))).collect();
        let kept = |(which, k, curve): (usize, usize, Curve)| (which, look(which, k), curve.place);
        let curves = curves.into_iter().map(kept).collect();
        let figure = Figure {
            title: self.plot.title.clone().unwrap_or_default().into(),
            subject: String::new(),
            note: String::new(),
            x_label: drawn.x_label(&self.units),
            y_label: drawn.y_label(&self.units),
            x,
            y,
            log_x,
            log_y,
            top: None,
            layers,
            numbers: drawn.numbers(),
        };
        Ok(Overlay { figure, groups, curves })
    }

    /// The abscissae that are drawn, and whether by their logarithms.
    fn x_range(&self, drawn: &Drawn, curves: &[(usize, usize, Curve)]) -> Result<(Range<f64>, bool)> {
        let asked = self.plot.log_x;
        let refuse = |reason: String| Err(Error::setting(Setting::LogX, "(given)", reason));
        if asked == Some(true) && !drawn.log_x {
            return refuse(format!("the abscissa of {} is a direction; leave it out", drawn.stem));
        }
        let below = self.x.as_ref().is_some_and(|range| range.start <= 0.0);
        let grown = || curves.iter().all(|curve| grow(curve.2.samples.iter().map(|s| s.0)));
        let log = asked.unwrap_or_else(|| drawn.log_x && !below && grown());
        let samples = || curves.iter().flat_map(|c| &c.2.samples).filter(|s| s.1.is_some());
        let places: Vec<f64> = samples().flat_map(|s| [s.0.0, s.0.2, s.0.1]).filter(|x| !log || *x > 0.0).collect();
        let Some((lo, hi)) = extent(&places).filter(|(lo, hi)| lo < hi) else {
            return refuse(format!("{} has no abscissa above 0; leave it out", drawn.stem));
        };
        let lo = if log { lo } else { lo.min(0.0) };
        let Some(range) = &self.x else {
            let flat = (drawn.values == Values::Probability).then(|| whole_from(curves)).flatten();
            return Ok((lo..flat.filter(|flat| *flat > lo).unwrap_or(hi), log));
        };
        if !samples().any(|s| range.contains(&s.0.1)) {
            let reason = format!("no value of {} lies there; expected a part of {}", drawn.stem, numbers([lo, hi]));
            return Err(Error::setting(Setting::RangeX, numbers([range.start, range.end]), reason));
        }
        Ok((range.clone(), log))
    }

    /// The ordinates that are drawn, and whether by their logarithms.
    fn y_range(&self, drawn: &Drawn, values: &[(f64, f64)], levels: &[Reference]) -> Result<(Range<f64>, bool)> {
        let fallen = decades(values).filter(|_| drawn.values == Values::Positive && self.plot.log_y.is_none());
        if let Some(range) = &self.y {
            let log = self.plot.log_y.unwrap_or(range.start > 0.0 && fallen.is_some());
            return Ok((range.clone(), log));
        }
        if let Some(range) = fallen {
            return Ok((range, true));
        }
        let ends = || values.iter().flat_map(|(y, se)| [y - se, y + se]);
        if self.plot.log_y == Some(true) {
            let positive: Vec<f64> = values.iter().map(|v| v.0).filter(|y| *y > 0.0).collect();
            return match extent(&positive) {
                Some((lo, hi)) if drawn.values != Values::Signed => Ok((0.7 * lo..1.5 * hi, true)),
                _ => {
                    let reason = format!("{} has values of either sign or 0; leave it out", drawn.stem);
                    Err(Error::setting(Setting::LogY, "(given)", reason))
                }
            };
        }
        let range = match drawn.values {
            Values::Positive => 0.0..top_of(values, &[]),
            Values::Probability => 0.0..1.06,
            Values::Ratio => about_one(&ends().collect::<Vec<_>>()).unwrap_or(0.0..2.0),
            Values::Signed => {
                let level = match drawn.level {
                    Level::At(y, _) => Some(y),
                    Level::Column(..) => None,
                };
                let others = levels.iter().flat_map(|(_, samples)| samples.iter().filter_map(|s| s.1)).chain(level);
                let (lo, hi) = extent(&ends().chain(others).collect::<Vec<_>>()).unwrap_or((-1.0, 1.0));
                let pad = (0.06 * (hi - lo)).max(1e-12);
                lo - pad..hi + pad
            }
        };
        Ok((range, false))
    }
}

/// Where the last of some distribution functions has come to 1 and stays there, if all do.
fn whole_from(curves: &[(usize, usize, Curve)]) -> Option<f64> {
    /// What is nearer to 1 cannot be told from it on paper.
    const WHOLE: f64 = 0.9999;
    let end_of = |curve: &Curve| {
        let rest = curve.samples.iter().rposition(|s| s.1.is_some_and(|y| y < WHOLE)).map_or(0, |last| last + 1);
        curve.samples[rest..].iter().find(|s| s.1.is_some()).map(|s| s.0.1)
    };
    let ends: Option<Vec<f64>> = curves.iter().map(|(_, _, curve)| end_of(curve)).collect();
    ends.and_then(|ends| extent(&ends)).map(|(_, last)| last)
}

/// What curves are compared with, where that is a curve too.
type Reference = (&'static str, Vec<(Interval, Option<f64>)>);

/// The references of the results, those that are alike once.
fn levels(drawn: &Drawn, results: &[Stored]) -> Result<Vec<Reference>> {
    let Level::Column(column, name) = drawn.level else { return Ok(Vec::new()) };
    let mut all: Vec<Reference> = Vec::new();
    for result in results {
        let Some(table) = result.table(drawn.table)? else { continue };
        let (Some(x), Some(y)) = (table.column(drawn.x_column)?, table.column(column)?) else { continue };
        let samples: Vec<_> = x.into_iter().zip(y).filter_map(|(x, y)| Some(((x?, x?, x?), y))).collect();
        if !all.iter().any(|other| other.1 == samples) {
            all.push((if all.is_empty() { name } else { "" }, samples));
        }
    }
    Ok(all)
}

/// The global envelope of the first curve of a figure, if there is one.
fn envelope(result: &Stored, drawn: &Drawn) -> Result<Option<Layer>> {
    let (Some(table), Some((column, _))) = (result.table("envelope.csv")?, drawn.curves.first()) else {
        return Ok(None);
    };
    let curve = if *column == "g_function" { "neighbor_g" } else { column };
    let rows = table.envelope(curve)?;
    if rows.is_empty() {
        return Ok(None);
    }
    let name = if result.envelope_is_given() { "simulated, global" } else { "random, global" };
    let samples = rows.into_iter().filter_map(|[r, lo, hi]| Some(((r?, r?, r?), lo.zip(hi))));
    Ok(Some(Layer::Band { name: name.into(), color: GREY, runs: band_runs(samples) }))
}

/// The pieces of a run in a range of abscissae, cut where they leave it.
fn cut(run: &[[f64; 3]], range: &Range<f64>) -> Vec<Vec<[f64; 3]>> {
    let mut pieces: Vec<Vec<[f64; 3]>> = Vec::new();
    for pair in run.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if b[0] < range.start || a[0] > range.end {
            continue;
        }
        let at = |x: f64| {
            let t = if b[0] > a[0] { (x - a[0]) / (b[0] - a[0]) } else { 0.0 };
            [x, a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])]
        };
        let from = if a[0] < range.start { at(range.start) } else { a };
        let to = if b[0] > range.end { at(range.end) } else { b };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&from) => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
    }
    pieces
}

/// Names for the legend: as given, else those of the directories, or their paths where two have one name.
fn labels(plot: &Plot) -> Result<Vec<String>> {
    if !plot.labels.is_empty() && plot.labels.len() != plot.results.len() {
        let reason = format!("expected {}, one for each result", plot.results.len());
        return Err(Error::setting(Setting::Labels, plot.labels.join(","), reason));
    }
    if !plot.labels.is_empty() {
        return Ok(plot.labels.clone());
    }
    let path = |dir: &PathBuf| dir.display().to_string();
    let name = |dir: &PathBuf| dir.file_name().map_or(path(dir), |name| name.to_string_lossy().into());
    let names: BTreeSet<String> = plot.results.iter().map(name).collect();
    let unique = names.len() == plot.results.len();
    Ok(plot.results.iter().map(|dir| if unique { name(dir) } else { path(dir) }).collect())
}

/// A colour by its name, or as `#rrggbb`.
fn parsed_color(text: &str) -> Result<Rgb> {
    if let Some((_, color)) = COLORS.iter().find(|(name, _)| *name == text) {
        return Ok(*color);
    }
    let digits =
        text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit()));
    match digits.and_then(|digits| u32::from_str_radix(digits, 16).ok()) {
        Some(rgb) => Ok(Rgb((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)),
        None => {
            let names = COLORS.map(|(name, _)| name).join(", ");
            Err(Error::setting(Setting::Colors, text, format!("expected one of {names}, or #rrggbb")))
        }
    }
}

/// `120x80mm` as width and height.
fn parsed_size(text: &str) -> Result<[f64; 2]> {
    /// Labels and legend take so much in either direction, and no sheet is larger than this.
    const MM: Range<f64> = 50.0..2000.0;
    let sides = text.strip_suffix("mm").and_then(|sides| sides.split_once('x'));
    let parsed = sides.and_then(|(w, h)| Some([w.trim().parse().ok()?, h.trim().parse().ok()?]));
    parsed.filter(|sides| sides.iter().all(|side| MM.contains(side))).ok_or_else(|| {
        let (least, most) = (number(MM.start), number(MM.end));
        let reason = format!("expected width and height as in {DEFAULT_SIZE}, each from {least} to {most} mm");
        Error::setting(Setting::Size, text, reason)
    })
}

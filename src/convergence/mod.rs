//! The variance of integrals against the number of points: of samplers, of files of one number of points each, of prefixes. Every number of
//! points is measured like points of its own; kept of it are the variances. See `docs/convergence.md`.

mod figure;
mod tables;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};
use xxhash_rust::xxh3::xxh3_64_with_seed;

use crate::analysis::{self, Plan};
use crate::compute::Device;
use crate::control::{Control, Progress};
use crate::display::{Ladder, LadderAt, Rung};
use crate::error::{Error, Result, number};
use crate::estimate::{
    Analysis, Measured, PowerLaw, SpectrumDetails, VarianceAt, expected_slope, isotropic_exponent, local_slopes,
};
use crate::integrand::Integrand;
use crate::plan::Estimator;
use crate::report::{self, Asked};
use crate::request::{Request, Statistic};
use crate::samplers::{Entry, ParameterValues, Process, find_with_parameters};
use crate::setting::Setting;
use crate::source::{AllAxes, Points, refuse_marks, scanned};
use crate::statistics::Table;
use crate::survey::Prefixes;

/// What the points are.
#[derive(Debug, Clone, PartialEq)]
pub enum Subjects {
    /// Samplers, `NAME` or `NAME:key=value,...`, at numbers of points. Parameters of the request go to each that has them.
    Samplers(Vec<String>, Prefixes),
    /// Files, folders or patterns, each with all realizations of one number of points.
    Groups(Vec<PathBuf>),
    /// The first points of the realizations in the files of the request.
    Prefixes(Prefixes),
}

/// What was found.
#[derive(Debug, Clone)]
pub struct Convergence {
    /// Samplers, or what the files are called.
    subjects: Vec<Subject>,
    integrands: Vec<Integrand>,
    dim: usize,
    /// Of each subject and integrand one after the other, n rising.
    curves: Vec<Curve>,
    /// What the user should know.
    pub warnings: Vec<String>,
    device: String,
}

/// Whose points they are.
#[derive(Debug, Clone)]
struct Subject {
    name: String,
    /// b of its power at low frequency, `P ~ nu^b`, at the largest n, and its 95 % interval where it was measured.
    exponent: Option<f64>,
    exponent_interval: Option<[f64; 2]>,
    /// Whether the count of points adds a term that falls like 1/n.
    counts: bool,
}

/// V(n) of a subject and an integrand.
#[derive(Debug, Clone)]
struct Curve {
    subject: usize,
    integrand: usize,
    points: Vec<At>,
    slopes: Vec<Slope>,
}

/// At a number of points.
#[derive(Debug, Clone)]
struct At {
    n: f64,
    k: u64,
    /// The seed of its realizations, of samplers.
    seed: Option<u64>,
    observed: Option<Measured>,
    shifted: Measured,
    predicted: Measured,
    /// Of the predicted variance, from the number of points before.
    local: Option<Measured>,
}

/// A fit.
#[derive(Debug, Clone)]
struct Slope {
    variance: Rung,
    law: Option<PowerLaw>,
    asymptote: Option<PowerLaw>,
}

/// The variances that are fitted.
const VARIANCES: [Rung; 3] = [Rung::Predicted, Rung::Shifted, Rung::Observed];

/// The fewest points, and the most numbers of them, that are looked at below those of a request.
const FEWEST: u64 = 16;
const MOST_HALVES: usize = 8;

impl At {
    fn of(&self, variance: Rung) -> Option<Measured> {
        match variance {
            Rung::Predicted => Some(self.predicted),
            Rung::Shifted => Some(self.shifted),
            Rung::Observed => self.observed,
        }
    }
}

/// The seed of realizations of `n` points: sets of different n are independent, those of a sequence too. Below 2^53, so that every program
/// reads it as it is.
fn seed_at(seed: u64, n: u64) -> u64 {
    xxh3_64_with_seed(&n.to_le_bytes(), seed) >> 11
}

/// Makes points when their turn comes.
type Open = dyn Fn(&Control) -> Result<Points>;

/// Points of one subject at one n.
struct Task {
    subject: usize,
    /// n, about: what the work grows with.
    n: f64,
    seed: Option<u64>,
    open: Box<Open>,
    /// Whether P is measured for the exponent at low frequency.
    measures_power: bool,
}

/// Measures.
///
/// # Errors
/// What the samplers, the files, the plans or the device say; fewer than two numbers of points; `Error::Cancelled`.
pub fn run(
    subjects: &Subjects,
    request: &Request,
    device: &Device,
    control: &Control,
    progress: &mut dyn FnMut(Progress),
) -> Result<Convergence> {
    let mut climb = Climb::new(subjects, request, control)?;
    while climb.advance(device, control, progress)? {}
    Ok(climb.found())
}

/// What is found so far of a run, one number of points after the other.
pub struct Climb {
    request: Request,
    tasks: Vec<Task>,
    /// Of them, those that are measured.
    done: usize,
    /// What part of the work that is.
    before: f64,
    /// Whose warning, what it is, and of how many others.
    said: Vec<(String, String, u64)>,
    /// Without fits.
    found: Convergence,
}

impl Climb {
    /// Looks at what is asked for; nothing is measured yet.
    ///
    /// # Errors
    /// What the samplers and the files say; fewer than two numbers of points; `Error::Cancelled`.
    pub fn new(subjects: &Subjects, request: &Request, control: &Control) -> Result<Self> {
        if request.integrand.is_empty() {
            let reason = "expected an integrand such as disk or box:x0=0.2,x1=0.7; `pairwave integrands` lists them";
            return Err(Error::setting(Setting::Integrand, "(none)", reason));
        }
        let mut warnings = Vec::new();
        let (subjects, tasks) = match subjects {
            Subjects::Samplers(specs, numbers) => samplers(specs, numbers, request, &mut warnings)?,
            Subjects::Groups(groups) => files(groups, request, control, &mut warnings)?,
            Subjects::Prefixes(numbers) => prefixes(numbers, request, control, &mut warnings)?,
        };
        let (integrands, curves, device) = (Vec::new(), Vec::new(), String::new());
        let found = Convergence { subjects, integrands, dim: 2, curves, warnings, device };
        Ok(Self { request: request.clone(), tasks, done: 0, before: 0.0, said: Vec::new(), found })
    }

    /// The sampler of a request, at its number of points and at halves of that, down to 16 and at most 8 of them. `None` where there is no
    /// sampler, which alone makes other numbers of points, no such number, or no integrand.
    ///
    /// # Errors
    /// As `new`.
    pub fn below(request: &Request, control: &Control) -> Option<Result<Self>> {
        let (sampler, most) = (request.input.sampler.clone()?, request.input.points?);
        if request.integrand.is_empty() {
            return None;
        }
        let halves = std::iter::successors(Some(most), |n| (*n / 2 >= FEWEST).then_some(*n / 2));
        let mut numbers: Vec<String> = halves.take(MOST_HALVES).map(|n| n.to_string()).collect();
        numbers.reverse();
        let parsed = numbers.join(",").parse::<Prefixes>();
        let numbers = parsed.map_err(|reason| Error::setting(Setting::Points, most, reason));
        Some(
            numbers.and_then(|numbers| {
                Self::new(&Subjects::Samplers(vec![sampler], numbers), &request.only(&[]), control)
            }),
        )
    }

    /// How many numbers of points are measured, and of how many.
    pub fn progress(&self) -> (u64, u64) {
        (self.done as u64, self.tasks.len() as u64)
    }

    /// Measures at one more number of points; whether there are others. What an error leaves is what was found before.
    ///
    /// # Errors
    /// As `run`.
    pub fn advance(&mut self, device: &Device, control: &Control, progress: &mut dyn FnMut(Progress)) -> Result<bool> {
        let Some(task) = self.tasks.get(self.done) else { return Ok(false) };
        control.check()?;
        let all: f64 = self.tasks.iter().map(|task| task.n).sum();
        let (part, before, total) = (task.n / all, self.before, self.tasks.len() as u64);
        let points = Arc::new((task.open)(control)?);
        let mut asked = self.request.clone();
        asked.stats = if task.measures_power { vec![Statistic::Radial] } else { Vec::new() };
        asked.input.sampler = None;
        let plan = Plan::of(&asked, &points)?.for_device(device.compute());
        let done = self.done as u64;
        let mut told = |p: Progress| {
            progress(p.as_part(part, before, [done, total]));
        };
        let analysis = analysis::run(&asked, points, plan, device, control, &mut told)?;
        let found = &mut self.found;
        let subject = &mut found.subjects[task.subject];
        let name = format!("{}, n = {}", subject.name, number(analysis.shape.mean_points));
        let nothing = || Error::input(&name, "no realization has points to integrate with");
        let errors = analysis.integration().ok_or_else(nothing)?;
        for text in &analysis.warnings {
            match self.said.iter_mut().find(|other| other.1 == *text) {
                Some(other) => other.2 += 1,
                None => self.said.push((name.clone(), text.clone(), 0)),
            }
        }
        if task.measures_power {
            let low = analysis.get::<SpectrumDetails>().and_then(|details| details.scalars.low_frequency);
            subject.exponent = low.and_then(|low| low.exponent);
            subject.exponent_interval = low.and_then(|low| low.exponent_interval);
        }
        subject.counts |= errors.estimator == Estimator::Lambda && varies(&analysis);
        found.dim = analysis.domain.dim();
        found.device = device.computed_by().device();
        for (k, e) in errors.each.iter().enumerate() {
            let at = At {
                n: analysis.shape.mean_points,
                k: errors.realizations,
                seed: task.seed,
                observed: e.observed,
                shifted: or_nothing(e.shifted, e.v0 / analysis.shape.mean_points),
                predicted: or_nothing(errors.predicted(e), e.v0 / analysis.shape.mean_points),
                local: None,
            };
            match found.curves.iter_mut().find(|c| (c.subject, c.integrand) == (task.subject, k)) {
                Some(curve) => curve.points.push(at),
                None => found.curves.push(Curve {
                    subject: task.subject,
                    integrand: k,
                    points: vec![at],
                    slopes: Vec::new(),
                }),
            }
        }
        found.integrands = errors.each.iter().map(|e| e.integrand.clone()).collect();
        (self.done, self.before) = (self.done + 1, before + part);
        Ok(self.done < self.tasks.len())
    }

    /// What is found so far, with its fits.
    pub fn found(&self) -> Convergence {
        let mut found = self.found.clone();
        found.curves.sort_by_key(|curve| (curve.subject, curve.integrand));
        for curve in &mut found.curves {
            curve.fit();
            for slope in &curve.slopes {
                let zero = |at: &&At| at.of(slope.variance).is_some_and(|v| v.value == 0.0);
                let zeros = curve.points.iter().filter(zero).count();
                if zeros > 0 {
                    found.warnings.push(format!(
                        "{}, {}: the {} variance is 0 at {zeros} of {} numbers of points, which are left out of its fit",
                        found.subjects[curve.subject].name,
                        found.integrands[curve.integrand].spec(),
                        slope.variance,
                        curve.points.len()
                    ));
                }
            }
        }
        let more = |more: u64| if more > 0 { format!(" and {more} more") } else { String::new() };
        let said = self.said.iter().map(|(name, text, times)| format!("{name}{}: {text}", more(*times)));
        found.warnings.extend(said);
        found
    }
}

/// Whether the number of points does.
fn varies(analysis: &Analysis) -> bool {
    analysis.min_points != analysis.shape.max_points || analysis.shape.mean_points != analysis.shape.max_points as f64
}

/// 0 for what is rounding beside the variance of random points: a lattice integrates some functions exactly.
fn or_nothing(measured: Measured, random: f64) -> Measured {
    if measured.value > 1e-12 * random { measured } else { Measured { value: 0.0, se: Some(0.0) } }
}

/// What there is to do, subject by subject, n rising.
type Tasks = (Vec<Subject>, Vec<Task>);

/// Numbers of points are too few for a slope.
fn too_few(setting: Setting, what: &str) -> Error {
    Error::setting(setting, what, "a slope needs two numbers of points; expected more, as in 2^4..2^12")
}

fn samplers(specs: &[String], numbers: &Prefixes, request: &Request, warnings: &mut Vec<String>) -> Result<Tasks> {
    let (k, dim) = (request.input.realizations.unwrap_or(1), request.input.dim.unwrap_or(2));
    let seed = request.input.seed.unwrap_or(1);
    let parsed = specs.iter().map(|spec| find_with_parameters(spec)).collect::<Result<Vec<_>>>()?;
    if let Some(twice) = (1..specs.len()).find(|&k| specs[..k].contains(&specs[k])) {
        return Err(Error::setting(Setting::Sampler, &specs[twice], "is given twice"));
    }
    let has = |entry: &Entry, param: &str| {
        entry.all_parameters().any(|p| Some(p.name) == param.split_once('=').map(|(key, _)| key.trim()))
    };
    if let Some(param) = request.input.params.iter().find(|param| !parsed.iter().any(|(entry, _)| has(entry, param))) {
        let names: Vec<&str> = parsed.iter().map(|(entry, _)| entry.name).collect();
        let reason = format!("none of {} has this parameter; expected key=value of one of them", names.join(", "));
        return Err(Error::setting(Setting::Params, param, reason));
    }
    let (mut subjects, mut tasks) = (Vec::new(), Vec::new());
    for (subject, ((entry, own), spec)) in parsed.into_iter().zip(specs).enumerate() {
        let shared = request.input.params.iter().map(String::as_str).filter(|param| has(entry, param));
        let params: Vec<String> = own.into_iter().chain(shared).map(String::from).collect();
        let values = ParameterValues::parse(entry, &params)?;
        let mut sizes: Vec<u64> = Vec::new();
        let mut others = Vec::new();
        for &n in numbers.numbers() {
            let nearest = entry.nearest_size(n, dim);
            if nearest != n {
                others.push(format!("{nearest} for {n}"));
            }
            if sizes.last().is_none_or(|last| *last < nearest) {
                sizes.push(nearest);
            }
        }
        if !others.is_empty() {
            warnings.push(format!("{spec}: n = {}, the nearest that it can make", others.join(", ")));
        }
        // One number of points is no slope, but samplers can be ranked at it.
        if sizes.len() < 2 && numbers.numbers().len() > 1 {
            let words: Vec<String> = sizes.iter().map(u64::to_string).collect();
            return Err(too_few(Setting::Points, &words.join(",")));
        }
        let mut exponent = None;
        let mut closed = true;
        for (place, &n) in sizes.iter().enumerate() {
            // All that can be wrong is, before the first is measured.
            let process = Process::of(entry, n, k, dim, seed_at(seed, n), &values)?;
            let last = place + 1 == sizes.len();
            if last {
                closed = process.power([1, 0, 0]).is_some();
                exponent = isotropic_exponent(|m| process.power(m), n as f64, dim);
            }
            let mut input = request.input.clone();
            (input.files, input.sampler) = (Vec::new(), Some(entry.name.to_string()));
            (input.points, input.seed, input.params) = (Some(n), Some(seed_at(seed, n)), params.clone());
            let open = move |control: &Control| Points::open_with(&input, control);
            let (n, seed) = (n as f64, Some(seed_at(seed, n)));
            tasks.push(Task { subject, n, seed, open: Box::new(open), measures_power: last && !closed });
        }
        subjects.push(Subject { name: spec.into(), exponent, exponent_interval: None, counts: false });
    }
    Ok((subjects, tasks))
}

fn files(groups: &[PathBuf], request: &Request, control: &Control, warnings: &mut Vec<String>) -> Result<Tasks> {
    if groups.len() < 2 {
        let reason = "a slope needs two numbers of points; expected a file or folder of realizations for each, or `prefixes` of one";
        let what = groups.first().map_or("(none)".into(), |group| group.display().to_string());
        return Err(Error::setting(Setting::Files, what, reason));
    }
    let mut opened = Vec::new();
    for group in groups {
        let mut input = request.input.clone();
        (input.files, input.sampler) = (vec![group.clone()], None);
        let typed = input.clone();
        input = scanned(input)?;
        // Integrals are planned by what is typed; a scan may be of more.
        if input != typed {
            let reason = format!(
                "{} was made with it, and convergence is measured without; expected the files themselves, or a scan without it",
                group.display()
            );
            refuse_marks(&input, &reason)?;
        }
        let points = Points::open_with(&input, control)?;
        points.warnings().iter().for_each(|warning| warnings.push(format!("{}: {warning}", group.display())));
        opened.push((group, points.shape().mean_points, points.domain().dim(), input));
    }
    opened.sort_by(|a, b| a.1.total_cmp(&b.1));
    for pair in opened.windows(2) {
        let (a, b) = (pair[0].0.display(), pair[1].0.display());
        if pair[0].1 == pair[1].1 {
            let reason = format!(
                "has {} points per realization like {a}; expected one group of files for each number",
                pair[1].1
            );
            return Err(Error::input(b.to_string(), reason));
        }
        if pair[0].2 != pair[1].2 {
            return Err(Error::input(b.to_string(), format!("is {}D; {a} is {}D", pair[1].2, pair[0].2)));
        }
    }
    let name = format!("{} and {} more", opened[0].0.display(), opened.len() - 1);
    let last = opened.len() - 1;
    let task = |(place, (_, n, _, input)): (usize, (&PathBuf, f64, usize, _))| {
        let open = move |control: &Control| Points::open_with(&input, control);
        Task { subject: 0, n, seed: None, open: Box::new(open), measures_power: place == last }
    };
    let subject = Subject { name, exponent: None, exponent_interval: None, counts: false };
    Ok((vec![subject], opened.into_iter().enumerate().map(task).collect()))
}

fn prefixes(numbers: &Prefixes, request: &Request, control: &Control, warnings: &mut Vec<String>) -> Result<Tasks> {
    let points = Arc::new(AllAxes::open(&request.input, request.memory(), control)?);
    let (n, fewest) = (numbers.largest(), points.fewest());
    if n > fewest {
        return Err(Error::setting(Setting::Prefixes, n, format!("a realization has only {fewest} points")));
    }
    if numbers.numbers().len() < 2 {
        return Err(too_few(Setting::Prefixes, &n.to_string()));
    }
    if points.dim() > 3 {
        let reason = format!("expected points of 1 to 3 coordinates, these have {}; `columns` chooses", points.dim());
        return Err(Error::input(points.subject(), reason));
    }
    warnings.extend(points.warnings().iter().cloned());
    warnings.push("prefixes are the same points again and again: slopes are right on average, their intervals are not, which take every n as independent".into());
    let axes: Vec<usize> = (0..points.dim()).collect();
    let task = |&n: &u64| {
        let (points, axes) = (points.clone(), axes.clone());
        let open = move |_: &Control| points.view(&axes, Some(n));
        Task { subject: 0, n: n as f64, seed: None, open: Box::new(open), measures_power: n == numbers.largest() }
    };
    let tasks = numbers.numbers().iter().map(task).collect();
    let name = points.subject().to_string();
    Ok((vec![Subject { name, exponent: None, exponent_interval: None, counts: false }], tasks))
}

impl Curve {
    /// The points of one of its variances.
    fn of(&self, variance: Rung) -> Vec<VarianceAt> {
        self.points.iter().filter_map(|at| Some(VarianceAt { n: at.n, variance: at.of(variance)? })).collect()
    }

    fn fit(&mut self) {
        let locals = local_slopes(&self.of(Rung::Predicted));
        self.points.iter_mut().zip(locals).for_each(|(at, local)| at.local = local);
        let slope = |variance: Rung| {
            let points = self.of(variance);
            Slope { variance, law: PowerLaw::fit(&points), asymptote: PowerLaw::asymptote(&points) }
        };
        self.slopes = VARIANCES.map(slope).into();
    }
}

impl Convergence {
    /// The curves of an integrand, by its place in the list, as they are drawn.
    pub fn ladders(&self, integrand: usize) -> Vec<Ladder> {
        self.of_integrand(integrand).map(|(_, ladder)| ladder).collect()
    }

    /// The same, with which subject each is of.
    fn of_integrand(&self, integrand: usize) -> impl Iterator<Item = (usize, Ladder)> + '_ {
        self.curves.iter().filter(move |curve| curve.integrand == integrand).map(|curve| {
            let at = |at: &At| LadderAt {
                n: at.n,
                variances: [Rung::Predicted, Rung::Observed, Rung::Shifted].map(|rung| at.of(rung)),
                slope: at.local,
            };
            let law = |rung| curve.slopes.iter().find(|slope| slope.variance == rung).and_then(|slope| slope.law);
            let ladder = Ladder {
                name: self.subjects[curve.subject].name.clone(),
                spec: self.integrands[curve.integrand].spec().into(),
                points: curve.points.iter().map(at).collect(),
                laws: [Rung::Predicted, Rung::Observed, Rung::Shifted].map(law),
                expected: self.expected(curve),
            };
            (curve.subject, ladder)
        })
    }

    /// The exponent that counts at low frequency.
    fn exponent(&self, curve: &Curve) -> Option<f64> {
        let subject = &self.subjects[curve.subject];
        let counted = subject.counts && self.integrands[curve.integrand].integral() != 0.0;
        if counted { Some(0.0) } else { subject.exponent }
    }

    /// The slope to be expected.
    fn expected(&self, curve: &Curve) -> Option<f64> {
        Some(expected_slope(self.exponent(curve)?, self.integrands[curve.integrand].smoothness(), self.dim))
    }

    /// The variances, the slopes and the ranks, for a terminal.
    pub fn text(&self) -> String {
        let variances = [
            "subject",
            "integrand",
            "n",
            "k",
            "var_observed",
            "var_observed_se",
            "var_shifted",
            "var_shifted_se",
            "var_predicted",
            "var_predicted_se",
            "local_slope",
        ];
        let slopes = [
            "subject",
            "integrand",
            "variance",
            "slope",
            "slope_lo",
            "slope_hi",
            "chi2_per_dof",
            "asymptotic_slope",
            "asymptotic_lo",
            "asymptotic_hi",
            "expected_slope",
        ];
        let ranks = [
            "integrand",
            "rank",
            "rank_shifted",
            "subject",
            "n",
            "var_predicted",
            "var_shifted",
            "var_observed",
            "n_random",
        ];
        let slopes = report::some_columns("slopes of ln V on ln n, 95 % intervals", &slopes, &tables::slopes(self));
        let largest = "at the largest n, from the least variance, with the random points that would do as well";
        [
            report::some_columns("variance", &variances, &tables::variances(self)),
            if self.has_slopes() { slopes } else { String::new() },
            report::some_columns(largest, &ranks, &tables::ranks(self)),
        ]
        .join("\n")
    }

    /// Writes tables, the figure and the summary into `dir`, as `report::write` does.
    ///
    /// # Errors
    /// As `report::write`.
    pub fn write(&self, dir: &Path, asked: &Asked, force: bool) -> Result<Vec<PathBuf>> {
        report::write_files(dir, force, asked, &self.warnings, self.summary(), |files| {
            for (name, table) in self.tables() {
                files.add(name, |file| file.write_all(&table.csv()?));
            }
            if self.has_slopes() {
                files.add("convergence.svg", |file| file.write_all(figure::svg(self).as_bytes()));
            }
        })
    }

    /// Its tables, by the names of their files.
    pub fn tables(&self) -> Vec<(&'static str, Table)> {
        let slopes = self.has_slopes().then(|| ("slopes.csv", tables::slopes(self)));
        [("convergence.csv", tables::variances(self)), ("ranks.csv", tables::ranks(self))]
            .into_iter()
            .chain(slopes)
            .collect()
    }

    /// Whether there is more than one number of points.
    fn has_slopes(&self) -> bool {
        self.curves.iter().any(|curve| curve.points.len() > 1)
    }

    /// What it holds of convergence.
    fn summary(&self) -> Value {
        let law = |law: &Option<PowerLaw>| {
            law.as_ref().map(|law| {
                json!({
                    "slope": law.slope,
                    "slope_se": law.slope_se,
                    "interval": law.interval,
                    "chi2_per_dof": law.chi2_per_dof,
                    "points": law.points,
                    "zeros": law.zeros,
                    "range": law.range,
                })
            })
        };
        let subject = |s: &Subject| json!({ "name": s.name, "low_frequency_exponent": s.exponent, "interval": s.exponent_interval });
        let slopes = |curve: &Curve| -> Value {
            let fit = |s: &Slope| json!({ "variance": s.variance.name(), "fit": law(&s.law), "asymptote": law(&s.asymptote) });
            let smoothness = self.integrands[curve.integrand].smoothness();
            json!({
                "subject": self.subjects[curve.subject].name,
                "integrand": self.integrands[curve.integrand].spec(),
                "fits": curve.slopes.iter().map(fit).collect::<Vec<_>>(),
                "expected_slope": self.expected(curve),
                "low_frequency_exponent": self.exponent(curve),
                "smoothness": smoothness.is_finite().then_some(smoothness),
            })
        };
        json!({
            "convergence": self.subjects.iter().map(subject).collect::<Vec<_>>(),
            "d": self.dim,
            "slopes": self.curves.iter().map(slopes).collect::<Vec<_>>(),
            "device": self.device,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_points_has_a_seed_of_its_own() {
        let seeds: std::collections::BTreeSet<u64> = (1..1000).flat_map(|n| [seed_at(1, n), seed_at(2, n)]).collect();
        assert_eq!(seeds.len(), 1998);
        assert!(seeds.iter().all(|seed| *seed < 1 << 53));
    }
}

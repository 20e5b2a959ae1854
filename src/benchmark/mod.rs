//! Run time against error: every way in which the same numbers can be had on this machine, timed, and held against a slow exact one. See
//! `docs/benchmarks.md`.

mod calibrate;
mod efficiency;
mod figure;
mod growth;
mod kernel;
mod naive;
mod pairs;
mod skipped;
mod spectra;
mod tables;
mod timing;
mod variance;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::compute::cpu::Cpu;
use crate::compute::{Device, Session, reference::Reference};
use crate::control::{Control, Progress};
use crate::error::{Error, Result};
use crate::named::named;
use crate::plan::{Costs, DeviceCosts};
use crate::points::{Domain, Ensemble, RawPoints};
use crate::report::{self, Asked};
use crate::request::DeviceChoice;
use crate::samplers::{ParameterValues, Process, find_with_parameters};

pub use calibrate::{Calibration, Explained};
pub use efficiency::Efficiency;
pub use growth::{Exponent, Grown};
pub use skipped::Skipped;
use timing::Care;
pub use timing::{Machine, Timing};

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Section {
    /// Counts of pairs.
    Pairs,
    /// The kernel estimate of g.
    Kernel,
    /// The power spectrum.
    Spectrum,
    /// Variances of integrals, predicted and observed.
    Variance,
    /// Errors of integrals against the time of drawing and evaluating, by samplers.
    Samplers,
    /// How times grow, and how well plans know it.
    Growth,
    /// Work that is done beside that of a plain implementation.
    Skipped,
}

named!(Section: Pairs = "pairs", Kernel = "kernel", Spectrum = "spectrum", Variance = "variance", Samplers = "samplers", Growth = "growth", Skipped = "skipped");

/// What is asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Wanted {
    /// Sections; none: all.
    pub sections: Vec<Section>,
    /// Small problems, few runs: below half a minute.
    pub quick: bool,
    /// What computes beside the CPU path: nothing for `Cpu`.
    pub device: DeviceChoice,
    /// Threads of the CPU path; one, if it is not said.
    pub threads: Option<usize>,
    /// Samplers whose errors are held against time, and random points; none: the usual ones.
    pub samplers: Vec<String>,
    /// What they integrate; none: the usual ones.
    pub integrands: Vec<String>,
    /// Whether the costs of methods are measured; without sections these and how times grow are all that is.
    pub calibrate: bool,
}

/// One way to have the numbers of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// In words.
    pub method: String,
    /// What computed.
    pub device: String,
    /// Of one realization.
    pub seconds: Timing,
    /// Operations of a realization, in 1e9, and their name.
    pub work: Option<(f64, &'static str)>,
    /// Floating-point operations of a realization, in 1e9, where it is clear what they are at least.
    pub gflop: Option<f64>,
    /// Difference from the exact numbers: root mean square and largest; none where there is only chance.
    pub error: Option<[f64; 2]>,
    /// What chance makes of one realization, where it is not that of the scene.
    pub statistical: Option<f64>,
    /// Whether no other way is both faster and as accurate.
    pub front: bool,
}

/// Numbers that can be had in several ways.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What they are, of which points.
    pub name: String,
    /// What the section is.
    pub section: Section,
    /// What errors are of, and relative to what.
    pub error_of: &'static str,
    /// The ways.
    pub ways: Vec<Way>,
    /// The same error that chance makes in one realization; in K it is less by `sqrt(K)`.
    pub statistical: f64,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Benchmark {
    /// What the machine can do.
    pub machine: Machine,
    /// Ways to the same numbers.
    pub scenes: Vec<Scene>,
    /// Errors of integrals against time.
    pub efficiency: Vec<Efficiency>,
    /// Times of growing problems.
    pub grown: Vec<Grown>,
    /// How they grow.
    pub exponents: Vec<Exponent>,
    /// Work that was not done.
    pub skipped: Vec<Skipped>,
    /// What methods cost here.
    pub calibration: Option<Calibration>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Errors of integrals of about 1 below which they are rounding.
const ROUNDING: f64 = 1e-14;

/// What sections work with.
struct Bench<'a> {
    quick: bool,
    care: Care,
    /// The CPU path and, if there is one, a GPU.
    devices: Vec<Device>,
    machine: Machine,
    /// What methods cost here, where that was measured.
    costs: Option<Costs>,
    control: &'a Control,
}

/// Measures.
///
/// # Errors
/// A device that is not there or fails, `Error::Cancelled`.
pub fn run(wanted: &Wanted, control: &Control, progress: &mut dyn FnMut(Progress)) -> Result<Benchmark> {
    let threads = Some(wanted.threads.unwrap_or(1));
    let cpu = Device::new(Box::new(Cpu::new(threads)?), threads)?;
    let mut warnings = Vec::new();
    if cfg!(debug_assertions) {
        warnings.push(
            "this is a checked build, which is several times slower: `cargo run --release -- bench` times the program"
                .into(),
        );
    }
    let other = crate::control::wait(Device::open(wanted.device, threads))?;
    warnings.extend(other.note().map(String::from));
    let name = |device: &Device| device.computed_by().device();
    let mut devices = vec![cpu];
    if name(&other) != name(&devices[0]) {
        devices.push(other);
    }
    let care = match wanted.quick {
        true => Care { runs: 3, least: 2e-3, enough: 0.7 },
        false => Care { runs: 7, least: 2e-2, enough: 4.0 },
    };
    // Its share is nobody's: a section is told of as a whole.
    let quiet = control.beside();
    let machine = Machine::measure(name(&devices[0]), devices[0].pool(), care, &quiet)?;
    let mut bench = Bench { quick: wanted.quick, care, devices, machine, costs: None, control: &quiet };
    let own = !(wanted.samplers.is_empty() && wanted.integrands.is_empty());
    let asked = match (&wanted.sections[..], wanted.calibrate) {
        ([], true) if own => &[Section::Samplers, Section::Growth],
        ([], true) => &[Section::Growth][..],
        ([], false) if own => &[Section::Samplers],
        ([], false) => Section::ALL,
        (sections, _) => sections,
    };
    let sections: Vec<Section> = Section::ALL.iter().copied().filter(|s| asked.contains(s)).collect();
    let planned = if wanted.quick { 20.0 } else { 150.0 };
    let calibration = match wanted.calibrate {
        true => {
            control.begin();
            progress(Progress { stage: "costs", done: 0, total: 1, before: 0.0, piece: 0.5, planned, known: None });
            Some(calibrate::measure(&bench)?)
        }
        false => None,
    };
    bench.costs = calibration.as_ref().map(|found| found.costs.clone());
    let (mut scenes, mut efficiency, mut skipped) = (Vec::new(), Vec::new(), Vec::new());
    let (mut grown, mut exponents) = (Vec::new(), Vec::new());
    for (k, section) in sections.iter().enumerate() {
        control.begin();
        let (before, piece) = (k as f64 / sections.len() as f64, 1.0 / sections.len() as f64);
        let (stage, done, total) = (section.name(), k as u64, sections.len() as u64);
        progress(Progress { stage, done, total, before, piece, planned, known: None });
        match section {
            Section::Pairs => scenes.extend(pairs::scenes(&bench)?),
            Section::Kernel => scenes.push(kernel::scene(&bench)?),
            Section::Spectrum => scenes.extend(spectra::scenes(&bench)?),
            Section::Variance => scenes.extend(variance::scenes(&bench)?),
            Section::Samplers => efficiency = efficiency::measure(&bench, &wanted.samplers, &wanted.integrands)?,
            Section::Growth => (grown, exponents) = growth::measure(&bench)?,
            Section::Skipped => skipped = skipped::measure(&bench)?,
        }
    }
    scenes.iter_mut().for_each(Scene::find_front);
    let Bench { machine, devices, .. } = bench;
    for device in &devices {
        warnings.extend(device.note().map(String::from));
    }
    warnings.dedup();
    Ok(Benchmark { machine, scenes, efficiency, grown, exponents, skipped, calibration, warnings })
}

impl Bench<'_> {
    /// The same problem, quick or not.
    fn size<T>(&self, quick: T, whole: T) -> T {
        if self.quick { quick } else { whole }
    }

    /// Times sums on a device.
    fn timed<T>(
        &self,
        device: &Device,
        mut work: impl AsyncFnMut(&mut Session<'_>) -> Result<T>,
    ) -> Result<(Timing, T)> {
        self.care.time(self.control, || self.once(device, &mut work))
    }

    /// Sums on a device.
    fn once<T>(&self, device: &Device, work: &mut impl AsyncFnMut(&mut Session<'_>) -> Result<T>) -> Result<T> {
        crate::control::wait(work(&mut Session::new(device, self.control, None)))
    }

    /// Times what runs on the threads of the CPU path.
    fn plain<T: Send>(&self, work: impl Fn() -> T + Sync) -> Result<(Timing, T)> {
        let pool = self.devices[0].pool();
        self.care.time(self.control, || Ok(pool.install(&work)))
    }

    /// What methods cost on a device, as it was measured if it was.
    fn costs_of(&self, device: &Device) -> DeviceCosts {
        let (built_in, name) = (device.compute().costs(), device.compute().costs_name());
        self.costs.as_ref().map_or(built_in, |costs| costs.of(&name, built_in))
    }

    /// The slow truth.
    fn reference(&self) -> Result<Device> {
        Device::new(Box::new(Reference), Some(self.machine.threads))
    }
}

/// A sampler on the unit torus, `NAME` or `NAME:key=value`.
fn process(spec: &str, n: u64, k: u64, dim: usize) -> Result<Process> {
    let (entry, params) = find_with_parameters(spec)?;
    Process::of(entry, n, k, dim, 1, &ParameterValues::parse(entry, &params)?)
}

/// Its realizations.
fn sampled(spec: &str, n: u64, k: u64, dim: usize, control: &Control) -> Result<Ensemble> {
    process(spec, n, k, dim)?.ensemble(0..k, control)
}

/// Points given one by one, of one realization.
fn given(points: &[[f64; 2]]) -> Result<Ensemble> {
    let coordinates = points.iter().flatten().copied().collect();
    let raw = RawPoints { dim: 2, coordinates, source: "bench".into(), lines: Vec::new() };
    Ensemble::from_raw(&[raw], &Domain::unit_torus(2), false, 0)
}

/// The points of the first realization in 2D.
fn flat(ensemble: &Ensemble) -> Vec<[f64; 2]> {
    (0..ensemble.points_in(0))
        .map(|j| {
            let position = ensemble.position(0, j);
            [position[0], position[1]]
        })
        .collect()
}

/// Root mean square and largest of differences.
fn error_of(differences: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut squares, mut largest, mut n) = (0.0, 0.0f64, 0.0);
    for d in differences {
        squares += d * d;
        largest = largest.max(d.abs());
        n += 1.0;
    }
    [if n > 0.0 { f64::sqrt(squares / n) } else { 0.0 }, largest]
}

impl Scene {
    /// Marks the ways that no other beats: by what they are off, or where all are off by chance alone, by that.
    fn find_front(&mut self) {
        let errs = self.ways.iter().any(|way| way.error.is_some());
        let of = |way: &Way| match way.error {
            Some([rms, _]) => Some((way.seconds.median, rms)),
            None if errs => None,
            None => Some((way.seconds.median, way.statistical.unwrap_or(self.statistical))),
        };
        let all: Vec<_> = self.ways.iter().map(of).collect();
        for (way, own) in self.ways.iter_mut().zip(&all) {
            let Some((t, e)) = own else { continue };
            let beats = |(other_t, other_e): &(f64, f64)| other_t <= t && other_e <= e && (other_t < t || other_e < e);
            way.front = !all.iter().flatten().any(beats);
        }
    }
}

impl Scene {
    /// From how many realizations on a way's difference from the truth is more than chance. Not of variances, whose differences are means over
    /// realizations already, and partly chance.
    fn realizations_as_accurate(&self, way: &Way) -> Option<f64> {
        let [rms, _] = way.error.filter(|_| self.section != Section::Variance)?;
        let chance = way.statistical.unwrap_or(self.statistical);
        (rms > 0.0).then(|| (chance / rms).powi(2))
    }
}

impl Machine {
    /// In words.
    fn words(&self) -> String {
        let Self { cpu, processor, gflops, gigabytes, .. } = self;
        let on = if processor.is_empty() { String::new() } else { format!(" on {processor}") };
        format!("{cpu}{on}: {gflops:.0} GFLOP/s of f32 multiply-adds, {gigabytes:.1} GB/s of memory")
    }
}

impl Way {
    /// What is drawn: the difference from the truth, or where there is none, chance.
    fn drawn(&self, statistical: f64) -> f64 {
        self.error.map_or(self.statistical.unwrap_or(statistical), |[rms, _]| rms)
    }

    /// Its share of what the machine's multiply-adds could do.
    pub fn share(&self, machine: &Machine) -> Option<f64> {
        // The rate is that of the CPU path.
        let gflop = self.gflop.filter(|_| self.device == machine.cpu)?;
        Some(gflop / self.seconds.median / machine.gflops)
    }
}

impl Benchmark {
    /// For a terminal.
    pub fn text(&self) -> String {
        tables::text(self)
    }

    /// Writes tables, figures, the page and the summary into `dir`, as `report::write` does.
    ///
    /// # Errors
    /// As `report::write`.
    pub fn write(&self, dir: &Path, asked: &Asked, force: bool) -> Result<Vec<PathBuf>> {
        let drawn = figure::page(self, asked).map_err(|e| Error::input("figures of the benchmark", e.to_string()))?;
        report::write_files(dir, force, asked, &self.warnings, self.summary(), |files| {
            for (name, table) in tables::all(self) {
                files.add(name, move |file| file.write_all(&table.csv()?));
            }
            for (name, svg) in &drawn.figures {
                files.add(name, |file| file.write_all(svg.as_bytes()));
            }
            files.add(report::PAGE, |file| file.write_all(drawn.page.as_bytes()));
        })
    }

    /// How many times as fast as random points to the same error, whose error is `sqrt(v0 / n)`, and its standard error. None where what is left
    /// is rounding.
    fn against_random(&self, of: &Efficiency) -> Option<[f64; 2]> {
        let same = |e: &&Efficiency| e.sampler == "random" && e.integrand == of.integrand;
        let random = self.efficiency.iter().filter(same).max_by_key(|e| e.n)?;
        let needed = of.variance / of.error.powi(2);
        let times = random.seconds(1.0) / random.n as f64 * needed / of.seconds(1.0);
        (of.error > ROUNDING).then(|| [times, times * 2.0 * of.error_se / of.error])
    }

    fn summary(&self) -> Value {
        let Machine { cpu, processor, threads, gflops, gigabytes } = &self.machine;
        json!({
            "benchmark": {
                "cpu": cpu,
                "processor": processor,
                "plan_pace": self.pace(),
                "threads": threads,
                "fma_gflops": gflops,
                "triad_gigabytes_per_s": gigabytes,
            }
        })
    }
}

//! A request and the number of points -> everything decided before the first sum: a value that prints.

use std::borrow::Cow;
use std::fmt;

use crate::compute::{Compute, Device};
use crate::error::{Error, Result, number};
use crate::plan::{DeviceCosts, EnsembleShape};
use crate::points::Domain;
use crate::request::{DeviceChoice, Lists, Request, Statistic, refuse_idle_settings, refuse_unknown_to_convention};
use crate::setting::Setting;
use crate::source::Points;
use crate::statistics::ROOMS;
use crate::statistics::group::{Ask, Part, Parts};

/// Everything decided before the first sum: a value that can be printed.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Of every group of sums.
    pub(super) parts: Parts,
    /// The files of numbers that the request names, as they were read.
    pub(super) lists: Lists,
    /// Simulations for envelopes: drawn from complete spatial randomness, or given.
    pub(super) simulations: u64,
    /// What of the default is not measured, and why.
    pub(super) left_out: Option<&'static str>,
    /// Whether they were given.
    pub(super) simulations_given: bool,
    /// Realizations worked on at a time.
    pub(super) batch: u64,
    /// Number and size of all realizations.
    shape: EnsembleShape,
}

/// Seconds that a GPU takes to be opened, at least: a driver is loaded, kernels are compiled and checked.
const SOON: f64 = 0.1;

/// Values of simulated curves held at a time: 1 GiB.
const MAX_SIMULATED: u64 = 1 << 27;

impl Plan {
    /// Decides from the request and its points.
    ///
    /// # Errors
    /// Settings that cannot be, contradict each other or say nothing about what is asked for; too few points.
    pub fn of(request: &Request, source: &Points) -> Result<Self> {
        let mut plan = Self::with(request, source.domain(), source.shape(), source.classes(), Lists::default())?;
        if let Some(simulations) = source.simulations() {
            plan.simulations = simulations_given(&plan, simulations, source.shape().realizations)?;
            plan.simulations_given = true;
        }
        let pairs = [Statistic::Pcf, Statistic::KFunction].iter().any(|s| request.stats.contains(s));
        let input = &request.input;
        let weights = [
            (Setting::WeightColumn, &input.weight_column),
            (Setting::IntensityColumn, &input.intensity_column),
            (Setting::Inhomogeneous, &input.inhomogeneous),
        ];
        if let Some((setting, Some(value))) = weights.into_iter().find(|(_, value)| value.is_some()) {
            if input.is_inhomogeneous() && source.inhomogeneity().is_none() {
                let reason = "these points have no intensity; what is opened by this request has it, and `Points::with_intensity` \
                              gives it to points in memory";
                return Err(Error::setting(setting, value, reason));
            }
            if pairs {
                source.check_pair_weights(&format!("{} {value}", setting.mention()))?;
            }
        }
        Ok(plan)
    }

    /// Decides from the request and the number of points, which are of one class.
    ///
    /// # Errors
    /// As `of`.
    pub fn new(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<Self> {
        Self::with(request, domain, shape, &[], Lists::default())
    }

    pub(super) fn with(
        request: &Request,
        domain: &Domain,
        shape: EnsembleShape,
        classes: &[String],
        lists: Lists,
    ) -> Result<Self> {
        let (request, left_out) = available(request, domain);
        let request = request.as_ref();
        if let Some(path) = &request.costs {
            lists.costs(path)?;
        }
        let ask = Ask { request, lists: &lists, domain, shape, classes };
        let of_pairs = [Statistic::Pcf, Statistic::KFunction, Statistic::PcfVector, Statistic::Neighbors];
        check_points(of_pairs.into_iter().any(|s| ask.wants(s)), shape)?;
        refuse_idle_settings(request)?;
        check_convention(request, domain, shape)?;
        let mut parts = Parts::default();
        for room in ROOMS {
            room.plan(&ask, &mut parts)?;
        }
        let batch = parts.iter().map(|part| part.batch().realizations).min().unwrap_or(1);
        let simulations = match request.envelope {
            Some(simulations) => check_simulations(&parts, simulations, Setting::Envelope)?,
            None => 0,
        };
        if let (Some(n), Some(column)) = (request.envelope, &request.input.weight_column) {
            let reason =
                format!("simulated points would have no weights, those of the file have (`weight_column` {column})");
            return Err(Error::setting(Setting::Envelope, n, reason));
        }
        if request.input.is_inhomogeneous() {
            let reason =
                "simulations have no intensity that they could be weighted by (`inhomogeneous`, `intensity_column`)";
            if let Some(n) = request.envelope {
                return Err(Error::setting(Setting::Envelope, n, reason));
            }
            if let Some(from) = request.input.envelope_from.first() {
                return Err(Error::setting(Setting::EnvelopeFrom, from.display(), reason));
            }
        }
        Ok(Self { parts, lists, simulations, simulations_given: false, left_out, batch, shape })
    }

    /// What was read of the files of numbers that the request names, in a line; none if they were given otherwise.
    pub fn lists_read(&self) -> Option<&str> {
        self.lists.said()
    }

    /// Seconds of one thread that a part takes for all realizations.
    pub(super) fn seconds(&self, part: &dyn Part) -> f64 {
        part.seconds(self.shape.mean_points) * self.shape.realizations as f64
    }

    /// The same for all parts of all simulations.
    pub(super) fn simulated_seconds(&self) -> f64 {
        let one: f64 =
            self.parts.iter().filter_map(|part| part.in_simulations()).map(|p| self.seconds(p.as_ref())).sum();
        self.simulations as f64 * one
    }

    /// Opens the device that the request asks for; where it leaves the choice, no GPU for what the CPU path has done before one is ready.
    ///
    /// # Errors
    /// As `Device::open`.
    pub async fn open(&self, request: &Request) -> Result<Device> {
        if request.device == DeviceChoice::Auto {
            let cpu = Device::open(DeviceChoice::Cpu, request.threads).await?;
            if let Some(note) = self.soon_done(cpu.pool().threads()) {
                return Ok(cpu.noted(note));
            }
        }
        Device::open(request.device, request.threads).await
    }

    /// Why so many threads of the CPU path do it before a GPU is ready; none if they do not.
    pub fn soon_done(&self, threads: usize) -> Option<String> {
        let one = self.parts.iter().map(|part| self.seconds(part)).sum::<f64>() + self.simulated_seconds();
        let seconds = one / threads as f64;
        (seconds < SOON).then(|| {
            let ms = 1e3 * seconds;
            format!("{ms:.1} ms of work for the CPU path, less than a GPU takes to be ready: none was looked for")
        })
    }

    /// The same plan with what suits a device.
    pub fn for_device(mut self, compute: &dyn Compute) -> Self {
        let device = self.costs_of(compute);
        self.parts.iter_mut().for_each(|part| part.suit(&device));
        self
    }

    /// What methods cost on a device: as it was measured, where the request names a file of that, or as built in.
    pub(super) fn costs_of(&self, compute: &dyn Compute) -> DeviceCosts {
        let built_in = compute.costs();
        self.lists.costs_read().map_or(built_in, |costs| costs.of(&compute.costs_name(), built_in))
    }

    /// What a simulation for envelopes needs of it.
    pub(super) fn of_simulations(&self) -> Self {
        let mut parts = Parts::default();
        self.parts.iter().filter_map(|part| part.in_simulations()).for_each(|part| parts.push(part));
        Self { parts, simulations: 0, ..self.clone() }
    }
}

/// Without the spectrum in a polygon, where nothing in particular was asked for; with a word about it.
fn available<'a>(request: &'a Request, domain: &Domain) -> (Cow<'a, Request>, Option<&'static str>) {
    if domain.as_polygon().is_none() || request.stats != Request::default().stats {
        return (Cow::Borrowed(request), None);
    }
    let stats = request.stats.iter().copied().filter(|s| *s != Statistic::Spectrum).collect();
    let word = "the spectrum is not measured: it is not available for points in a polygon (`window_polygon`)";
    (Cow::Owned(Request { stats, ..request.clone() }), Some(word))
}

/// The number of simulations, of curves with so many values that they can be held.
fn check_simulations(parts: &Parts, simulations: u64, setting: Setting) -> Result<u64> {
    let values = parts.iter().map(|part| part.curve_values()).sum::<usize>() as u64;
    let largest = MAX_SIMULATED / values.max(1) - 1;
    if (1..=largest).contains(&simulations) {
        return Ok(simulations);
    }
    let reason = format!("expected 1 to {largest} simulations of {values} values each");
    Err(Error::setting(setting, simulations, reason))
}

/// The number of simulations among those given, each of as many realizations as the points have.
fn simulations_given(plan: &Plan, given: &Points, realizations: u64) -> Result<u64> {
    let all = given.shape().realizations;
    if !all.is_multiple_of(realizations) {
        let reason = format!(
            "{all} realizations are no whole number of simulations of {realizations} realizations, as many as the points have"
        );
        return Err(Error::setting(Setting::EnvelopeFrom, given.subject(), reason));
    }
    check_simulations(&plan.parts, all / realizations, Setting::EnvelopeFrom)
}

/// Whether the realizations hold enough points for pairs, or for anything.
pub(super) fn check_points(pairs: bool, shape: EnsembleShape) -> Result<()> {
    let reason = match shape.max_points {
        0 => "no realization has any points; nothing can be measured",
        1 if pairs => {
            "pcf, pcf-vector, k-function and neighbors need a realization of at least 2 points, the largest has 1; `stats` spectrum works with 1"
        }
        _ => return Ok(()),
    };
    Err(Error::input("points", reason))
}

/// Whether the program of a convention could have done what is asked for.
pub(super) fn check_convention(request: &Request, domain: &Domain, shape: EnsembleShape) -> Result<()> {
    let conventions = request.conventions();
    conventions.check(domain)?;
    if !conventions.foreign {
        return Ok(());
    }
    let name = conventions.of.to_string();
    if (shape.max_points as f64) > shape.mean_points {
        let reason = format!(
            "needs as many points in every realization; they have {} on average and up to {}",
            number(shape.mean_points),
            shape.max_points
        );
        return Err(Error::setting(Setting::Convention, name, reason));
    }
    refuse_unknown_to_convention(request)
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.lists_read() {
            writeln!(f, "{line}")?;
        }
        for part in self.parts.iter() {
            write!(f, "{part}")?;
        }
        if self.simulations > 0 {
            let n = self.simulations;
            let of = if self.simulations_given { "given" } else { "of complete spatial randomness" };
            writeln!(f, "envelope: {n} simulations {of}, each with all the pairs above")?;
        }
        let measured: Vec<Statistic> = self.parts.iter().flat_map(|part| part.statistics()).collect();
        // Rings are read off the sums of P.
        let skipped = Statistic::ALL.iter().filter(|s| **s != Statistic::Radial && !measured.contains(s));
        for statistic in skipped {
            let why = match (statistic, self.left_out) {
                (Statistic::Spectrum, Some(_)) => "not available in a polygon",
                _ => "not asked for",
            };
            writeln!(f, "skipped: {} ({why})", statistic.name())?;
        }
        writeln!(f, "together: {} realizations at a time", self.batch)?;
        let largest: Vec<_> =
            self.parts.iter().map(|part| (part.name(), part.memory())).filter(|of| of.1 >> 20 > 0).collect();
        if !largest.is_empty() {
            let words: Vec<_> = largest.iter().map(|(name, bytes)| format!("{name} {} MiB", bytes >> 20)).collect();
            writeln!(f, "memory of sums, estimates and output, about: {}", words.join(", "))?;
        }
        let mut all: Vec<_> = self.parts.iter().map(|part| (part.name(), self.seconds(part))).collect();
        all.push(("envelope", self.simulated_seconds()));
        all.retain(|(_, seconds)| *seconds > 0.0);
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let total: f64 = all.iter().map(|(_, seconds)| seconds).sum();
        let words: Vec<_> = all.iter().map(|(name, seconds)| format!("{name} {seconds:.2e}")).collect();
        writeln!(f, "in seconds of one thread, about: {total:.2e} ({})", words.join(", "))
    }
}

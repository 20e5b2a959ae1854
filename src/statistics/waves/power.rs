//! P at every wave vector, and what is summed with it.

use std::collections::HashSet;
use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, WavePower};
use crate::compute::Session;
use crate::error::{Error, Result, numbers};
use crate::estimate::{Analysis, PowerSpectrum, RadialSpectrum, SpectrumDetails};
use crate::plan::{
    Batch, DEFAULT_SECTORS, Debias, DeviceCosts, MAX_FREQUENCY, Taper, TaperPlan, WaveGrid, WaveList, WavePlan,
    WaveVectors,
};
use crate::points::{Domain, Ensemble};
use crate::request::{Group as Settings, Request, SETTINGS, Statistic};
use crate::setting::Setting;
use crate::statistics::group::{Ask, Effort, Group, Kept, Parts, Subject, digest};

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Waves {
    pub(crate) plan: WavePlan,
    /// Whether P itself is wanted, not only its rings.
    grid_wanted: bool,
    /// Whether integration errors, which are measured first, have it on the way.
    lent: bool,
}

/// Plans them, if they are wanted.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    let grid_wanted = ask.wants(Statistic::Spectrum);
    if grid_wanted || ask.wants(Statistic::Radial) {
        let plan = waves(ask).map_err(|e| match &ask.request.max_frequency {
            Some(typed) => e.typed_as(Setting::MaxFrequency, numbers(typed.iter().map(|&f| f64::from(f)))),
            None => e,
        })?;
        let plan = WavePlan { rings_only: !grid_wanted && plan.rings.count > 0, ..plan };
        parts.add(Waves { plan, grid_wanted, lent: false });
    }
    Ok(())
}

/// The wave vectors a request asks for, with tapers, rings and sectors.
fn waves(ask: &Ask<'_>) -> Result<WavePlan> {
    let Ask { request, domain, shape, .. } = *ask;
    let frequencies = match (request.max_frequency.as_deref(), request.conventions().max_frequency(shape.max_points)) {
        (Some([f]), _) => vec![*f; domain.dim()],
        (Some(each), _) => each.to_vec(),
        (None, Some(f)) => vec![f; domain.dim()],
        (None, None) => WaveGrid::default_max_frequency(shape.mean_points, domain, request.memory()),
    };
    let waves = match (&request.frequencies, request.ring_directions) {
        (Some(path), _) => ask.lists.frequencies(path, domain)?.clone().into(),
        // In 1D a ring is a pair of opposite wave vectors: any number of directions is all of them.
        (None, Some(n)) if n == 0 || domain.dim() > 1 => WaveList::ring_directions(domain, &frequencies, n)?.into(),
        (None, _) => WaveVectors::from(WaveGrid::new(&frequencies)?),
    };
    // Directions of what is not 2D are refused, in their own words; rings of others have none.
    let all_directions = domain.dim() == 2 && waves.grid().is_some() && !request.conventions().foreign;
    let sectors = request.sectors.or(all_directions.then_some(DEFAULT_SECTORS));
    let plan = WavePlan::new(domain, waves, request.accuracy, shape)?
        .within(request.memory())
        .with_taper(taper(request, domain)?)
        .with_conventions(request.conventions())?;
    match sectors {
        Some(count) => plan.with_sectors(count),
        None => Ok(plan),
    }
}

/// The tapers a request asks for.
fn taper(request: &Request, domain: &Domain) -> Result<TaperPlan> {
    let given = SETTINGS.iter().find(|row| row.group == Settings::Tapers && row.is_given(request));
    if let Some(row) = given.filter(|_| domain.is_torus()) {
        let reason = "is about a window; a torus cuts nothing off";
        return Err(Error::setting(row.setting, request.value(row.setting), reason));
    }
    let (kind, debias) = (request.taper.unwrap_or_default(), request.debias.unwrap_or_default());
    TaperPlan::new(kind, request.tapers, debias, domain.dim())
}

impl Group for Waves {
    type Sums = WavePower;

    const NAME: &'static str = "P";
    const STAGE: &'static str = "wave_power";

    fn statistics(&self) -> Vec<Statistic> {
        vec![Statistic::Spectrum, Statistic::Radial]
    }

    fn identity(&self) -> Value {
        let plan = &self.plan;
        let waves = match &plan.waves {
            WaveVectors::Grid(grid) => json!({ "max_frequency": grid.max_frequency()[..grid.dim()] }),
            WaveVectors::List(list) => {
                let components = list.vectors.iter().flat_map(|v| v[..list.dim].iter().copied());
                json!({ "vectors": digest(components), "mirrored": list.mirrored })
            }
        };
        json!({
            "waves": waves,
            "convention": [plan.conventions.of.to_string(), plan.conventions.bug_compatible.to_string()],
            "sectors": plan.rings.sectors.count,
            "taper": plan.taper.map(|t| json!({ "taper": t.taper.to_string(), "orders": t.orders, "debias": t.debias.to_string() })),
            "rings_only": plan.rings_only,
            "accuracy": plan.accuracy.name(),
        })
    }

    fn batch(&self) -> Batch {
        self.plan.batch
    }

    fn suit(&mut self, device: &DeviceCosts) {
        self.plan.costs = device.waves;
    }

    fn none(&self, by: ComputedBy) -> WavePower {
        WavePower::new(by, self.plan.waves.len(), &self.plan.rings)
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<WavePower> {
        match session.take_lent().filter(|_| self.lent) {
            Some(power) => Ok(power),
            None => session.wave_power(&self.plan, batch).await,
        }
    }

    fn estimate(&self, sums: &WavePower, subject: &Subject<'_>, found: &mut Analysis) {
        let (plan, request) = (&self.plan, subject.request);
        found.grid_wanted = self.grid_wanted;
        let spectrum = PowerSpectrum::new(plan, sums);
        if request.frequencies.is_none() {
            let radial = RadialSpectrum::new(plan, sums, &spectrum);
            if !plan.conventions.foreign {
                // Lag counts take every point alike.
                let vector = found.vector().filter(|_| !request.input.is_weighted());
                let details = SpectrumDetails::new(plan, sums, &spectrum, &radial, found.pair_correlation(), vector);
                found.findings.insert(details);
            }
            found.findings.insert(radial);
        }
        found.closed_form.radial = self.closed_form(subject);
        found.findings.insert(spectrum);
    }

    fn warnings(&self, _: &WavePower, subject: &Subject<'_>, _: &Parts, _: &Analysis) -> Vec<String> {
        let (plan, request) = (&self.plan, subject.request);
        let mut warnings = Vec::new();
        let default_grid = request.max_frequency.is_none() && !request.conventions().foreign;
        if let Some(grid) = plan.waves.grid().filter(|_| default_grid) {
            let reach = grid.max_frequency()[0];
            let wanted = 5.0 * subject.shape.mean_points.powf(1.0 / grid.dim() as f64);
            if subject.domain.is_cubic() && f64::from(reach) < 0.9 * wanted {
                let why = match reach {
                    MAX_FREQUENCY => "the largest there is",
                    _ => "to bound its memory; --max-frequency asks for more",
                };
                warnings.push(format!("P reaches |m| = {reach} only, {why}"));
            }
        }
        if plan.taper.is_some_and(|t| t.taper == Taper::Bartlett) {
            let warning =
                "P in a window has Bartlett's taper: large P leaks into frequencies around it; --taper sine leaks less";
            warnings.push(warning.to_string());
        }
        if plan.tapered().is_some() && plan.taper.is_some_and(|t| t.debias == Debias::None) {
            let warning = "--debias none leaves the transform of the window in P: at low frequencies it grows with n";
            warnings.push(warning.to_string());
        }
        warnings
    }

    fn effort(&self, n: u64) -> Effort {
        Effort { pairs: 0.0, products: n as f64 * self.plan.waves.len() as f64 }
    }

    fn seconds(&self, n: f64) -> f64 {
        if self.lent { 0.0 } else { self.plan.seconds(n) }
    }

    fn memory(&self) -> u128 {
        self.plan.waves.memory()
    }

    fn kept(&self, sums: &WavePower, wanted: &Self, sizes: &mut dyn Iterator<Item = u64>) -> Option<Kept<Self>> {
        if Group::identity(self) == Group::identity(wanted) {
            return Some(Kept { plan: wanted.clone(), sums: sums.clone(), rebinned: false });
        }
        // More than is wanted, by the same methods.
        let trimmed =
            Self { plan: WavePlan { rings_only: wanted.plan.rings_only, ..self.plan.clone() }, ..self.clone() };
        let by = |n: u64| self.plan.method(n as usize) == wanted.plan.method(n as usize);
        let holds = wanted.plan.rings_only && Group::identity(&trimmed) == Group::identity(wanted);
        let distinct: HashSet<u64> = sizes.collect();
        (holds && distinct.into_iter().all(by)).then(|| Kept {
            plan: self.clone(),
            sums: sums.clone(),
            rebinned: false,
        })
    }
}

impl Waves {
    /// The plan of all of P, marked as lent, if `grid` asks for the same modes just as well.
    pub(crate) fn borrow(&mut self, grid: &WavePlan) -> Option<&WavePlan> {
        let plan = &self.plan;
        let plain = plan.tapered().is_none() && !plan.conventions.foreign && !plan.rings_only;
        self.lent = plain && plan.waves == grid.waves && plan.accuracy == grid.accuracy;
        self.lent.then_some(&self.plan)
    }

    /// What theory says of the mean of P over each ring, on a cubic torus.
    fn closed_form(&self, subject: &Subject<'_>) -> Option<Vec<f64>> {
        let process = subject.closed_forms()?;
        let (waves, rings) = (&self.plan.waves, &self.plan.rings);
        let mut sums = vec![0.0; rings.count];
        for (index, &ring) in rings.ring_of.iter().enumerate().filter(|(_, ring)| **ring > 0) {
            let times = f64::from(rings.times[index]);
            sums[ring as usize - 1] += times * process.power(waves.vector(index).map(|m| m as i32))?;
        }
        Some(sums.iter().zip(&rings.modes).map(|(sum, &modes)| sum / modes as f64).collect())
    }
}

impl fmt::Display for Waves {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.plan.fmt(f)?;
        if self.lent { writeln!(f, "  skipped: integration errors have it on the way") } else { Ok(()) }
    }
}

//! What integration errors are read off.

use std::fmt;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, IntegrationSums, WavePower};
use crate::compute::Session;
use crate::error::{Result, number};
use crate::estimate::{Analysis, IntegrationErrors};
use crate::plan::{Batch, DeviceCosts, Importance, IntegrationPlan, IntegrationSettings, PairSum, WavePlan};
use crate::points::Ensemble;
use crate::request::Statistic;
use crate::statistics::group::{Ask, Group, Kept, Parts, Subject, digest};
use crate::statistics::waves::Waves;

/// Standard errors beyond which a difference is said to be one.
const SURE: f64 = 5.0;

/// The variance of f over its mean square below which what is left of it may be rounding.
const NEARLY_CONSTANT: f64 = 1e-10;

/// Errors of integrals over the root of the mean square below which they are no news.
const CLOSED: f64 = 1e-12;

/// Shifts of each realization where nothing is said.
const SHIFTS: u32 = 16;

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Integration {
    plan: IntegrationPlan,
    /// Whether the power on its grid is that of P.
    lends: bool,
}

/// Plans them, if an integrand is named.
pub(super) fn plan(ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
    let request = ask.request;
    if request.integrand.is_empty() {
        return Ok(());
    }
    let settings = IntegrationSettings {
        integrands: &request.integrand,
        estimator: request.estimator,
        shifts: request.shifts.unwrap_or(SHIFTS),
        spatial: request.spatial,
        top: request.top,
        intensity: request.intensity.as_deref(),
        by: request.by,
        weighted: request.input.weight_column.is_some(),
        max_frequency: request.max_frequency.as_deref(),
        low_frequency: request.covariance_frequency,
        accuracy: request.accuracy,
        memory: request.memory(),
        equal: ask.shape.mean_points == ask.shape.max_points as f64,
    };
    let mut plan = IntegrationPlan::new(ask.domain, settings, ask.shape)?;
    let weighs_anew = matches!(plan.importance, Some(Importance::Known(_))) || request.input.is_inhomogeneous();
    let lent = parts.get_mut::<Waves>().filter(|_| !weighs_anew);
    let lends = match lent.and_then(|waves| waves.borrow(&plan.grid)) {
        Some(waves) => {
            plan.grid = waves.clone();
            true
        }
        None => {
            plan = plan.narrowed()?;
            false
        }
    };
    parts.add_first(Integration { plan, lends });
    Ok(())
}

impl Group for Integration {
    type Sums = IntegrationSums;

    const NAME: &'static str = "integration";
    const STAGE: &'static str = "integration";
    const LAST_WORDS: bool = true;

    fn statistics(&self) -> Vec<Statistic> {
        Vec::new()
    }

    fn identity(&self) -> Value {
        let plan = &self.plan;
        let of = |i: &crate::integrand::Integrand| json!([i.spec(), i.integral(), i.square_integral()]);
        let pairs = match plan.pairs {
            PairSum::Exact => json!("exact"),
            PairSum::Deposit(nodes) => json!(nodes),
            PairSum::Radial(bins) => json!(["radial", bins]),
            PairSum::None => Value::Null,
        };
        let density = plan.importance.as_ref().map(|importance| match importance {
            Importance::Known(density) => json!([density.spec(), density.integral()]),
            Importance::Removal(removal) => json!([removal.density.spec(), removal.maximum, removal.kept]),
            Importance::Warp(density) => json!([density.spec(), "warp"]),
        });
        json!({
            "integrands": plan.integrands.iter().map(of).collect::<Vec<_>>(),
            "max_frequency": plan.max_frequency(),
            "axis_frequency": plan.axis_frequency(),
            "all_modes": plan.grid.wanted.is_none(),
            "low_frequency": plan.low.max_frequency()[0],
            "shifts": digest(plan.shifts.iter().copied()),
            "density": density,
            "estimator": plan.importance.is_some().then(|| plan.estimator.name()),
            "pairs": pairs,
            "accuracy": plan.grid.accuracy.name(),
        })
    }

    fn batch(&self) -> Batch {
        self.plan.batch
    }

    fn suit(&mut self, device: &DeviceCosts) {
        self.plan.grid.costs = device.waves;
    }

    fn seconds(&self, n: f64) -> f64 {
        self.plan.seconds(n)
    }

    /// Whether P is wanted too says only what is summed beside.
    fn kept(&self, sums: &IntegrationSums, wanted: &Self, _: &mut dyn Iterator<Item = u64>) -> Option<Kept<Self>> {
        (Group::identity(self) == Group::identity(wanted)).then(|| {
            let lends = wanted.lends && self.plan.grid == wanted.plan.grid;
            let plan = IntegrationPlan { grid: self.plan.grid.clone(), ..wanted.plan.clone() };
            Kept { plan: Self { plan, lends }, sums: sums.clone(), rebinned: false }
        })
    }

    fn none(&self, by: ComputedBy) -> IntegrationSums {
        let none = |plan: &WavePlan| WavePower::new(by.clone(), plan.waves.len(), &plan.rings);
        IntegrationSums {
            grid: none(&self.plan.grid),
            axes: self.plan.axes.iter().map(none).collect(),
            integrands: self.plan.integrands.len(),
            unit: 1.0,
            lags: Vec::new(),
            realizations: Vec::new(),
        }
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<IntegrationSums> {
        session.integration(&self.plan, self.lends, batch).await
    }

    fn estimate(&self, sums: &IntegrationSums, _: &Subject<'_>, found: &mut Analysis) {
        found.findings.add(IntegrationErrors::new(&self.plan, sums));
    }

    fn warnings(&self, _: &IntegrationSums, subject: &Subject<'_>, _: &Parts, found: &Analysis) -> Vec<String> {
        let Some(errors) = found.integration() else { return Vec::new() };
        let mut warnings = Vec::new();
        if (2..30).contains(&errors.realizations) {
            warnings.push(format!(
                "the interval of an observed variance of {} realizations covers less than it says (some 80 % at K = 10, of clusters less)",
                errors.realizations
            ));
        }
        if errors.left_out > 0 {
            warnings.push(format!(
                "{} without points have no mean of f and are left out",
                crate::error::plural(errors.left_out, "realization")
            ));
        }
        if let Some(placed) = &errors.placed {
            let off = placed.points.se.map(|se| (placed.points.value - placed.expected) / se);
            if let Some(z) = off.filter(|z| z.is_finite() && z.abs() > SURE) {
                warnings.push(format!(
                    "realizations have {} points on average, {} were expected ({z:.1} standard errors): `intensity` is not how dense they are",
                    number(placed.points.value),
                    number(placed.expected)
                ));
            }
        }
        if subject.request.input.inhomogeneous.is_some() || subject.request.input.intensity_column.is_some() {
            warnings.push(
                "integration takes every point once: what makes g and P inhomogeneous has no part in it; expected `intensity` or `weight_column` where points weigh one over their intensity"
                    .into(),
            );
        }
        let uneven = errors.placed.is_some() || subject.request.input.weight_column.is_some();
        if let Some((placed, cells)) = errors.placed.as_ref().and_then(|placed| Some((placed, placed.cells?))) {
            warnings.push(format!(
                "{} jumps or bends, and is taken as constant on {cells} cells per axis: points are as dense as that, and weighted by that",
                placed.spec
            ));
        }
        for one in &errors.each {
            let z = one.bias.se.map(|se| one.bias.value / se.max(1e-13 * one.integrand.square_integral().sqrt()));
            if let Some(z) = z.filter(|z| errors.realizations >= 10 && z.abs() > SURE) {
                let why = if uneven {
                    "the weights of points are not one over how dense they are, or where f is not 0 there are none"
                } else {
                    "points are denser in some places than in others"
                };
                warnings.push(format!(
                    "{}: estimates are biased by {}, {z:.1} standard errors: {why}",
                    one.integrand.spec(),
                    number(one.bias.value)
                ));
            }
            if let Some(z) = one.removal.and_then(|r| r.z_as_is).filter(|z| z.abs() > 4.5) {
                warnings.push(format!(
                    "{}: errors of the points that are kept and what their parents predict are {z:.1} standard errors apart",
                    one.integrand.spec()
                ));
            }
            let (spec, whole) = (one.integrand.spec(), one.closed.value);
            if one.tail_bound > 0.02 * whole && one.tail_share > 0.0 && one.spatial.is_none() {
                warnings.push(format!(
                    "{spec}: what lies beyond the frequencies measured is known to {:.1} % of the variance only (P = 1 is taken there); larger `max_frequency`, or the spatial form",
                    100.0 * one.tail_bound / whole
                ));
            }
            if let Some(z) = one.z.filter(|z| z.abs() > 4.5) {
                warnings.push(format!(
                    "{spec}: shifted and predicted variance are {z:.1} standard errors apart; with right formulas and many realizations they are not"
                ));
            }
            let square = one.integrand.square_integral();
            let share = one.integrand.variance() / square;
            if share != 0.0 && share.abs() < NEARLY_CONSTANT {
                warnings.push(format!(
                    "{spec}: is constant but for {:.0e} of it: its variance is the difference of integrals that are nearly the same, and is rounded; expected it less its constant part",
                    share.abs().sqrt()
                ));
            }
            let unclosed = one.integrand.coefficient_error().max(one.integrand.integral_error());
            if unclosed > CLOSED * square.sqrt() {
                warnings.push(format!("{spec}: its integral and Fourier coefficients are known to {unclosed:.1e}"));
            }
        }
        warnings
    }
}

impl fmt::Display for Integration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.plan.fmt(f)
    }
}

//! Integration errors: predicted from power and from pairs, and observed. See `docs/integration-error.md`.
//!
//! With weights c on every point (1/n of each realization, or one over the mean number of points), v0 = int f^2 - I^2 and sums as in
//! `compute::reference::integration`, the error of `c S` averaged over all shifts of a realization is
//!
//! ```text
//! V_k = c^2 sum_(m != 0) |f_m|^2 |s_m|^2 + I^2 (c n - 1)^2 = c^2 (n v0 + 2 pairs) + I^2 (c n - 1)^2
//! ```
//!
//! exactly, for any points; the second term is 0 where c = 1/n. The sum over m is cut at F, and beyond it P is taken as 1:
//! `tail = c^2 n (v0 - sum_R |f_m|^2)`. As they are, without shifts, `(c S - I)^2 = V_k + phase_k`.

use crate::accumulate::{IntegrandSums, IntegrationSums, RealizationSums};
use crate::estimate::{Analysis, mean, standard_error};
use crate::integrand::{Density, Integrand};
use crate::plan::{By, Estimator, IntegrationPlan, PairSum};

/// Errors of all integrands.
#[derive(Debug, Clone)]
pub struct IntegrationErrors {
    /// One per integrand.
    pub each: Vec<IntegrationError>,
    /// The density that points are placed by, and how, where it is no constant.
    pub placed: Option<(Density, By)>,
    /// The estimator.
    pub estimator: Estimator,
    /// How pairs were summed.
    pub pairs: PairSum,
    /// Largest frequencies of the grid, and along an axis alone.
    pub max_frequency: Vec<u32>,
    /// The latter.
    pub axis_frequency: u32,
    /// Largest low frequency of the truncated phase term.
    pub low_frequency: u32,
    /// Shifts per realization.
    pub shifts: u64,
    /// Realizations that count: those without points have no mean.
    pub realizations: u64,
    /// Those without points, where the estimator is a mean.
    pub left_out: u64,
}

/// A number with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard error; `None` where there is none.
    pub se: Option<f64>,
}

/// Of one integrand.
#[derive(Debug, Clone)]
pub struct IntegrationError {
    /// The integrand.
    pub integrand: Integrand,
    /// The variance of one random point, `int f^2 - I^2`.
    pub v0: f64,
    /// Mean of the estimates.
    pub mean: Measured,
    /// Mean of the estimates less I.
    pub bias: Measured,
    /// Variance of the estimates (ddof 1), by their fourth moment; `None` for K = 1.
    pub observed: Option<Measured>,
    /// Its 95 % interval, of the logarithm.
    pub observed_interval: Option<[f64; 2]>,
    /// Mean squared error.
    pub mse: f64,
    /// Mean squared error over shifts.
    pub shifted: Measured,
    /// Predicted from pairs; `None` where these are too many.
    pub spatial: Option<Measured>,
    /// Predicted from the frequencies of the grid alone.
    pub spectral: Measured,
    /// What closes that: frequencies beyond it, as measured along axes, and with P = 1 elsewhere.
    pub tail: f64,
    /// The part of it that is measured along axes.
    pub tail_axes: f64,
    /// How far the rest may be off, by how far P is from 1 where it ends.
    pub tail_bound: f64,
    /// The part of `v0` that the rest stands for.
    pub tail_share: f64,
    /// All of the prediction: frequencies, what closes them, and the number of points.
    pub closed: Measured,
    /// Of the number of points, where it is random: `I^2` times the mean of `(n / lambda - 1)^2`.
    pub count_term: f64,
    /// What makes the error as it is another than that of shifts.
    pub phase: Measured,
    /// The same of low frequencies alone.
    pub phase_low: f64,
    /// Shifted against predicted, in standard errors of their differences; `None` for K = 1 or where all of them are 0.
    pub z: Option<f64>,
    /// The estimates.
    pub estimates: Vec<f64>,
    /// V of each realization: from pairs where these are summed, else from power with the tail.
    pub stationarised: Vec<f64>,
    /// Rings of frequencies, and what each adds to the predicted variance.
    pub rings: Vec<RingShare>,
    /// The frequencies that add most.
    pub modes: Vec<ModeShare>,
}

/// What frequencies `|m|` in [k - 1/2, k + 1/2) add.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingShare {
    /// k.
    pub m: f64,
    /// `sum |f_m|^2`.
    pub coefficients: f64,
    /// `c^2 sum |f_m|^2 E|s_m|^2`.
    pub variance: f64,
}

/// What a mode and its mirror image add.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeShare {
    /// The frequency.
    pub m: [i32; 3],
    /// `|f_m|^2` of both.
    pub coefficient: f64,
    /// P.
    pub p: f64,
    /// What they add.
    pub variance: f64,
}

/// Modes that are kept by name.
const TOP: usize = 100;

/// A tail that is no more than rounding.
pub(super) const COMPLETE: f64 = 1e-12;

impl IntegrationErrors {
    /// Of the sums.
    pub fn new(plan: &IntegrationPlan, sums: &IntegrationSums) -> Option<Self> {
        let own = plan.estimator != Estimator::Lambda;
        let counted: Vec<&RealizationSums> = sums.realizations.iter().filter(|r| !own || r.n > 0).collect();
        let counts: Vec<f64> = counted.iter().map(|r| r.n as f64).collect();
        let lambda = mean(&counts).filter(|lambda| *lambda > 0.0)?;
        let weights: Vec<f64> = counts.iter().map(|n| 1.0 / if own { *n } else { lambda }).collect();
        // E|s_m|^2 c^2, as a ratio where n varies: what all realizations add up to.
        let scale = if own { mean(&weights)?.powi(2) } else { lambda.powi(-2) } / counted.len() as f64;
        let power = sums.grid.mode_totals().q;
        let axes: Vec<Vec<f64>> = sums.axes.iter().map(|axis| axis.mode_totals().q).collect();
        let totals = Totals { plan, power: &power, axes: &axes, scale, points: counts.iter().sum() };
        let each = plan.integrands.iter().enumerate();
        let each =
            each.map(|(i, integrand)| one(&totals, i, integrand, &counted, &weights)).collect::<Option<Vec<_>>>()?;
        Some(Self {
            each,
            placed: plan.placed.clone(),
            estimator: plan.estimator,
            pairs: plan.pairs,
            max_frequency: plan.max_frequency().to_vec(),
            axis_frequency: plan.axis_frequency(),
            low_frequency: plan.low.max_frequency()[0],
            shifts: (plan.shifts.len() / plan.domain.dim()) as u64,
            realizations: counted.len() as u64,
            left_out: (sums.realizations.len() - counted.len()) as u64,
        })
    }
}

impl IntegrationErrors {
    /// What the predictions for an integrand come to: by pairs where all are summed, else by power with its tail.
    pub fn predicted(&self, e: &IntegrationError) -> Measured {
        match e.spatial.filter(|_| self.pairs == PairSum::Exact) {
            Some(spatial) => spatial,
            None => e.closed,
        }
    }
}

/// What all integrands share.
struct Totals<'a> {
    plan: &'a IntegrationPlan,
    /// `sum |s_m|^2` over realizations, per stored mode.
    power: &'a [f64],
    axes: &'a [Vec<f64>],
    /// Makes them a variance: c^2 over the number of realizations.
    scale: f64,
    /// Points of all realizations.
    points: f64,
}

fn one(
    totals: &Totals<'_>,
    i: usize,
    integrand: &Integrand,
    counted: &[&RealizationSums],
    weights: &[f64],
) -> Option<IntegrationError> {
    let (exact, v0) = (integrand.integral(), integrand.variance().max(0.0));
    let plan = totals.plan;
    let k = counted.len() as f64;
    let each: Vec<(&IntegrandSums, f64, f64)> =
        counted.iter().zip(weights).map(|(r, c)| (&r.each[i], r.n as f64, *c)).collect();
    let of = |value: &dyn Fn(&IntegrandSums, f64, f64) -> f64| -> Vec<f64> {
        each.iter().map(|(sums, n, c)| value(sums, *n, *c)).collect()
    };
    let measured = |values: &[f64]| Some(Measured { value: mean(values)?, se: standard_error(values) });
    let table = &plan.tables[i];
    let inside: f64 = table.grid.iter().sum::<f64>() + table.axes.iter().flatten().sum::<f64>();
    let rest = v0 - inside;
    let rest = if rest.abs() <= COMPLETE * v0 { 0.0 } else { rest.max(0.0) };
    // 1/n times n is 1 but for rounding.
    let own = plan.estimator != Estimator::Lambda;
    let count = of(&|_, n, c| if own { 0.0 } else { (exact * (c * n - 1.0)).powi(2) });
    let spectral = of(&|s, _, c| c * c * s.grid);
    let axes = of(&|s, _, c| c * c * s.axes);
    let rests = of(&|_, n, c| c * c * n * rest);
    let tails: Vec<f64> = axes.iter().zip(&rests).map(|(a, b)| a + b).collect();
    let spatial = of(&|s, n, c| c * c * (n * v0 + 2.0 * s.pairs).max(0.0));
    let by_pairs = plan.pairs != PairSum::None;
    let add = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
    let closed = add(&add(&spectral, &tails), &count);
    let in_space = add(&spatial, &count);
    let stationarised = if plan.pairs == PairSum::Exact { in_space.clone() } else { closed.clone() };
    let estimates = of(&|s, _, c| c * s.values);
    let squared: Vec<f64> = estimates.iter().map(|e| (e - exact).powi(2)).collect();
    let phases: Vec<f64> = squared.iter().zip(&stationarised).map(|(square, v)| square - v).collect();
    // S(t) c - I = c (S(t) - n I) + I (c n - 1).
    let shifted = of(&|s, n, c| {
        let level = if own { 0.0 } else { exact * (c * n - 1.0) };
        (c * c * s.shifted[1] + 2.0 * c * level * s.shifted[0] + level * level).max(0.0)
    });
    let low = of(&|s, _, c| c * c * (s.low[0] * s.low[0] - s.low[1]));
    let (rings, modes) = shares(totals, table);
    let (mut predicted, mut all, mut in_space) = (measured(&spectral)?, measured(&closed)?, measured(&in_space)?);
    if counted.len() == 1 {
        [predicted.se, all.se] = single_errors(totals, table, weights[0]).map(Some);
        in_space.se = all.se;
    }
    let observed = observed(&estimates, integrand.square_integral());
    let mean_estimate = measured(&estimates)?;
    Some(IntegrationError {
        integrand: integrand.clone(),
        v0,
        mean: mean_estimate,
        bias: Measured { value: mean_estimate.value - exact, se: mean_estimate.se },
        observed,
        observed_interval: observed.and_then(|o| Some((o, o.se?))).filter(|(o, _)| o.value > 0.0).map(|(o, se)| {
            let reach = (1.96 * se / o.value).exp();
            [o.value / reach, o.value * reach]
        }),
        mse: squared.iter().sum::<f64>() / k,
        shifted: measured(&shifted)?,
        spatial: by_pairs.then_some(in_space),
        spectral: predicted,
        tail: mean(&tails)?,
        tail_axes: mean(&axes)?,
        tail_bound: mean(&rests)? * highest_excess(plan, totals.power, totals.axes, totals.points),
        tail_share: if v0 > 0.0 { rest / v0 } else { 0.0 },
        closed: all,
        count_term: mean(&count)?,
        phase: measured(&phases)?,
        phase_low: mean(&low)?,
        z: paired(&shifted, &stationarised, v0 * mean(weights)?),
        estimates,
        stationarised,
        rings,
        modes,
    })
}

/// The variance of estimates (ddof 1) and its standard error by the fourth central moment, for few estimates at least half of what normal
/// ones have; 0 where all are one number.
fn observed(estimates: &[f64], scale: f64) -> Option<Measured> {
    let k = estimates.len() as f64;
    let center = mean(estimates).filter(|_| estimates.len() >= 2)?;
    let moment = |p: i32| estimates.iter().map(|e| (e - center).powi(p)).sum::<f64>();
    let variance = moment(2) / (k - 1.0);
    if variance <= 1e-25 * scale {
        return Some(Measured { value: 0.0, se: Some(0.0) });
    }
    let fourth = moment(4) / k;
    let se = ((fourth - (k - 3.0) / (k - 1.0) * variance * variance) / k).max(0.0).sqrt();
    let floor = if k < 100.0 { variance * (2.0 / (k - 1.0)).sqrt() / 2.0 } else { 0.0 };
    Some(Measured { value: variance, se: Some(se.max(floor)) })
}

/// Shifted against predicted, realization by realization: the mean difference in its standard errors. Rounding is no difference, and all that
/// there is of a constant.
fn paired(shifted: &[f64], predicted: &[f64], unit: f64) -> Option<f64> {
    if unit == 0.0 {
        return None;
    }
    let differences: Vec<f64> = shifted.iter().zip(predicted).map(|(w, v)| w - v).collect();
    let se = standard_error(&differences)?.max(1e-13 * unit);
    let z = mean(&differences)? / se;
    z.is_finite().then_some(z)
}

/// The standard error of the spectral form of one realization, `c^2 sqrt(sum |f_m|^4 |s_m|^4)` over all modes: theory, of exponential
/// power. Of the grid, and with frequencies along axes.
fn single_errors(totals: &Totals<'_>, table: &crate::plan::IntegrandTable, c: f64) -> [f64; 2] {
    // Where a stored mode stands for its mirror image too, (2 |f|^2)^2 q^2 / 2 is the sum over both.
    let square = |f: &f64, q: &f64, times: f64| (f * q).powi(2) / times;
    let stored = totals.plan.grid.waves.grid();
    let times = |index: usize| stored.map_or(1.0, |grid| f64::from(grid.multiplicity(index)));
    let grid: f64 = table.grid.iter().zip(totals.power).enumerate().map(|(at, (f, q))| square(f, q, times(at))).sum();
    let along = |(table, power): (&Vec<f64>, &Vec<f64>)| -> f64 {
        table.iter().zip(power).map(|(f, q)| square(f, q, 2.0)).sum()
    };
    let axes: f64 = table.axes.iter().zip(totals.axes).map(along).sum();
    [grid, grid + axes].map(|sum| c * c * sum.sqrt())
}

/// How far P is from 1 where the grid ends: the largest, over directions, of means over its outermost tenth, and along axes. `power` over
/// `level` is P; what is not finite is not known.
pub(super) fn highest_excess(plan: &IntegrationPlan, power: &[f64], axes: &[Vec<f64>], level: f64) -> f64 {
    let Some(grid) = plan.grid.waves.grid() else { return 1.0 };
    let frequencies = grid.max_frequency();
    const DIRECTIONS: usize = 16;
    let (mut sums, mut counts) = ([0.0; DIRECTIONS], [0.0; DIRECTIONS]);
    for (index, q) in power.iter().enumerate() {
        let m = grid.mode(index);
        let out = (0..grid.dim()).map(|a| f64::from(m[a].abs()) / f64::from(frequencies[a])).fold(0.0, f64::max);
        if out > 0.9 && q.is_finite() {
            let angle = f64::from(m[1]).atan2(f64::from(m[0])).rem_euclid(std::f64::consts::PI);
            let at = ((angle / std::f64::consts::PI * DIRECTIONS as f64) as usize).min(DIRECTIONS - 1);
            sums[at] += q;
            counts[at] += 1.0;
        }
    }
    let far = |sum: f64, count: f64| if count > 0.0 { (sum / count / level - 1.0).abs() } else { 0.0 };
    let around = sums.iter().zip(counts).map(|(sum, count)| far(*sum, count)).fold(0.0, f64::max);
    let along = axes.iter().map(|axis| {
        let end = axis[axis.len() * 9 / 10..].iter().filter(|q| q.is_finite());
        far(end.clone().sum(), end.count() as f64)
    });
    along.fold(around, f64::max)
}

/// What rings and single modes add to the predicted variance.
fn shares(totals: &Totals<'_>, table: &crate::plan::IntegrandTable) -> (Vec<RingShare>, Vec<ModeShare>) {
    let mut rings: Vec<RingShare> = Vec::new();
    let mut modes: Vec<ModeShare> = Vec::new();
    let mut add = |m: [i32; 3], coefficient: f64, q: f64, twice: bool| {
        if coefficient == 0.0 {
            return;
        }
        let ring = m.iter().map(|&m| f64::from(m) * f64::from(m)).sum::<f64>().sqrt().round() as usize;
        if rings.len() <= ring {
            rings.extend((rings.len()..=ring).map(|k| RingShare { m: k as f64, coefficients: 0.0, variance: 0.0 }));
        }
        let variance = totals.scale * coefficient * q;
        rings[ring].coefficients += coefficient;
        rings[ring].variance += variance;
        // Of a pair that is stored twice, one.
        let first = m.iter().find(|m| **m != 0).is_some_and(|m| *m > 0);
        let both = if twice { 2.0 } else { 1.0 };
        let (coefficient, variance) = (both * coefficient, both * variance);
        let among = modes.len() < TOP || modes.last().is_some_and(|last| last.variance < variance);
        if first && among {
            let at = modes.partition_point(|other| other.variance >= variance);
            modes.insert(at, ModeShare { m, coefficient, p: q / totals.points, variance });
            modes.truncate(TOP);
        }
    };
    if let Some(grid) = totals.plan.grid.waves.grid() {
        for (index, (f, q)) in table.grid.iter().zip(totals.power).enumerate() {
            add(grid.mode(index), *f, *q, grid.mode(index)[0] == 0);
        }
    }
    for (a, (of_axis, power)) in table.axes.iter().zip(totals.axes).enumerate() {
        for (m, (f, q)) in of_axis.iter().zip(power).enumerate() {
            let mut vector = [0; 3];
            vector[a] = m as i32;
            add(vector, *f, *q, false);
        }
    }
    rings.retain(|ring| ring.coefficients > 0.0);
    (rings, modes)
}

impl Analysis {
    /// Integration errors.
    pub fn integration(&self) -> Option<&IntegrationErrors> {
        self.get()
    }
}

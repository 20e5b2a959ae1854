//! Integration errors: predicted from power and from pairs, and observed. See `docs/integration-error.md`.
//!
//! With a factor c on the weight `w_j` of every point (what it is, is said by the estimator), v0 = int f^2 - I^2 and sums as in
//! `compute::reference::integration`, the error of `c S` averaged over all shifts of a realization is
//!
//! ```text
//! V_k = c^2 sum_(m != 0) |f_m|^2 |s_m|^2 + level^2 = c^2 (v0 sum w^2 + 2 pairs) + level^2,   level = I (c sum w - 1)
//! ```
//!
//! exactly, for any points. The sum over m is cut at F, and beyond it P is taken as 1: `tail = c^2 sum w^2 (v0 - sum_R |f_m|^2)`. As they are,
//! without shifts, `(c S - I)^2 = V_k + phase_k`. Where of these points some are kept, each with probability q and then weighing 1/q, the variance
//! grows by `c int f^2 (1/q - 1)`, and of the very points at hand it is `(c S - I)^2 + c^2 sum f^2 (1/q - 1)`.

use crate::accumulate::{IntegrandSums, IntegrationSums, KeptSums, LAG_STEP, RealizationSums};
use crate::estimate::{Analysis, mean, standard_error};
use crate::integrand::Integrand;
use crate::plan::{By, Estimator, Importance, IntegrationPlan, PairSum};

/// Errors of all integrands.
#[derive(Debug, Clone)]
pub struct IntegrationErrors {
    /// One per integrand.
    pub each: Vec<IntegrationError>,
    /// The estimator.
    pub estimator: Estimator,
    /// How pairs were summed.
    pub pairs: PairSum,
    /// How many of the frequencies that add most are to be named.
    pub top: Option<u32>,
    /// The largest frequencies along each axis that were asked for, or are usual.
    pub asked_frequency: Vec<u32>,
    /// Those that are summed: as many, or as far as an integrand has coefficients.
    pub max_frequency: Vec<u32>,
    /// The largest along an axis alone.
    pub axis_frequency: u32,
    /// Largest low frequency of the truncated phase term.
    pub low_frequency: u32,
    /// Shifts per realization.
    pub shifts: u64,
    /// Realizations that count: those without points have no mean.
    pub realizations: u64,
    /// Those without points, where the estimator is a mean.
    pub left_out: u64,
    /// The density that points come by, where it is no constant.
    pub placed: Option<Placed>,
}

/// A density that points come by.
#[derive(Debug, Clone)]
pub struct Placed {
    /// Its specification.
    pub spec: String,
    /// How points come by it; `None` where they are said to have it.
    pub by: Option<By>,
    /// Number of points per realization, of those that are kept.
    pub points: Measured,
    /// What that should be.
    pub expected: f64,
    /// Cells per axis on which a density is taken as constant that points are warped to, where it jumps or bends.
    pub cells: Option<usize>,
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
    /// Of the number of points, where it is random, or of their weights: `I^2` times the mean of `(c sum w - 1)^2`.
    pub count_term: f64,
    /// What removal adds.
    pub removal: Option<RemovalError>,
    /// What makes the error as it is another than that of shifts.
    pub phase: Measured,
    /// The same of low frequencies alone.
    pub phase_low: f64,
    /// The variance of the part of the estimate that low frequencies make (ddof 1): their centred covariance, `sum conj(f_m) f_l Cov(s_m, s_l)`;
    /// `None` for K = 1.
    pub var_low: Option<f64>,
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
    /// What every frequency in the plane adds, in 3D in that of m_z = 0; `None` in 1D, and where none adds anything.
    pub map: Option<ModeMap>,
    /// Shells of lags, and what each adds; empty where pairs are not summed.
    pub lags: Vec<LagShare>,
    /// What single points add, `c^2 v0 sum w^2`: all of it, were they independent.
    pub alone: f64,
}

/// What pairs of points add whose lag, as a fraction of the box, has a length in [lo, hi).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagShare {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
    /// Mean of `a - I^2` over lags.
    pub excess: f64,
    /// What pairs add: more than as many independent points would, whose pairs add 0 in all.
    pub variance: f64,
}

/// What is known of points that are kept at random.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RemovalError {
    /// The part of the variance that removal adds, `int f^2 (1/lambda - 1/lambda_max)`.
    pub variance: f64,
    /// How far that may be off.
    pub error: f64,
    /// The mean squared error that the parents as they are lead to; `None` of ratios.
    pub as_is: Option<Measured>,
    /// The observed one against it, in standard errors of their differences.
    pub z_as_is: Option<f64>,
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

/// What every frequency `(m_x, m_y)` adds, in 3D of those with m_z = 0: up to 1023 per axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeMap {
    half: [u32; 2],
    /// Of `m_x >= 0`: index `m_x (2 half_y + 1) + m_y + half_y`. The others are mirror images.
    variances: Vec<f64>,
    largest: f64,
}

/// More frequencies per axis than a picture shows are not kept.
const MAPPED: u32 = 1023;

impl ModeMap {
    /// The largest frequencies.
    pub fn half(&self) -> [u32; 2] {
        self.half
    }

    /// What `m` alone adds to the variance, its mirror image apart; `None` at zero frequency and beyond the largest.
    pub fn variance(&self, m: [i32; 2]) -> Option<f64> {
        let [x, y] = if m[0] < 0 { m.map(|m| -m) } else { m };
        let [wide, high] = self.half.map(|half| half as i32);
        let inside = x <= wide && (-high..=high).contains(&y) && m != [0; 2];
        inside.then(|| self.variances[(x * (2 * high + 1) + y + high) as usize])
    }

    /// The largest of them.
    pub fn largest(&self) -> f64 {
        self.largest
    }
}

/// Modes that are kept by name where nothing is said.
const TOP: usize = 100;

/// A tail that is no more than rounding.
const COMPLETE: f64 = 1e-12;

/// What of `v0` is not `inside`, the sum of `|f_m|^2` over frequencies that are known.
pub(super) fn beyond(v0: f64, inside: f64) -> f64 {
    let rest = v0 - inside;
    if rest.abs() <= COMPLETE * v0 { 0.0 } else { rest.max(0.0) }
}

impl IntegrationErrors {
    /// Of the sums.
    pub fn new(plan: &IntegrationPlan, sums: &IntegrationSums) -> Option<Self> {
        let needs_points = plan.estimator != Estimator::Lambda;
        let is_ratio = plan.estimator.is_ratio();
        let counts_in = |r: &&RealizationSums| {
            let left = r.removal.as_ref().is_none_or(|removal| removal.kept > 0 && removal.shifts > 0);
            !needs_points || r.n > 0 && !(is_ratio && (r.weight == 0.0 || !left))
        };
        let counted: Vec<&RealizationSums> = sums.realizations.iter().filter(counts_in).collect();
        let points = |r: &&RealizationSums| r.removal.as_ref().map_or(r.n, |removal| removal.kept) as f64;
        let kept: Vec<f64> = counted.iter().map(points).collect();
        let mean_points = Measured { value: mean(&kept)?, se: standard_error(&kept) };
        let parents = mean(&counted.iter().map(|r| r.n as f64).collect::<Vec<_>>())?;
        let expected = match &plan.importance {
            None | Some(Importance::Warp(_)) => mean_points.value,
            Some(Importance::Known(density)) => density.integral(),
            Some(Importance::Removal(removal)) => removal.kept * parents,
        };
        let weigh = |r: &RealizationSums| match plan.estimator {
            Estimator::Mean => (1.0 / r.n as f64, plan.weighted),
            Estimator::CountRatio if !plan.weighted => (1.0 / r.n as f64, false),
            Estimator::CountRatio => (expected / r.n as f64, true),
            // Of unweighted points the sum of weights is their number.
            Estimator::Ratio => (1.0 / r.weight, false),
            Estimator::Lambda if plan.weighted => (1.0, true),
            Estimator::Lambda => (1.0 / parents, true),
        };
        let factors: Vec<Factor> = (counted.iter())
            .map(|r| {
                let (c, varies) = weigh(r);
                Factor { c, off: if varies { c * r.weight - 1.0 } else { 0.0 } }
            })
            .collect();
        if factors.iter().any(|f| !f.c.is_finite()) {
            return None;
        }
        let power = sums.grid.mode_totals().q;
        let axes: Vec<Vec<f64>> = sums.axes.iter().map(|axis| axis.mode_totals().q).collect();
        let norm = counted.iter().map(|r| r.square).sum::<f64>() / (sums.unit * sums.unit);
        let totals = Totals {
            plan,
            power: &power,
            axes: &axes,
            unit: sums.unit,
            norm,
            lags: &sums.lags,
            counted: &counted,
            factors: &factors,
        };
        Some(Self {
            each: (0..plan.integrands.len()).map(|i| one(&totals, i)).collect::<Option<Vec<_>>>()?,
            estimator: plan.estimator,
            pairs: plan.pairs,
            top: plan.top,
            asked_frequency: plan.asked.clone(),
            max_frequency: plan.max_frequency().to_vec(),
            axis_frequency: plan.axis_frequency(),
            low_frequency: plan.low.max_frequency()[0],
            shifts: (plan.shifts.len() / plan.domain.dim()) as u64,
            realizations: counted.len() as u64,
            left_out: (sums.realizations.len() - counted.len()) as u64,
            placed: plan.importance.as_ref().map(|importance| Placed {
                spec: importance.density().into(),
                by: importance.by(),
                points: mean_points,
                expected,
                cells: match importance {
                    Importance::Warp(density) => density.cells(),
                    _ => None,
                },
            }),
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

/// What makes sums of a realization an estimate.
#[derive(Clone, Copy)]
struct Factor {
    c: f64,
    /// `c sum w - 1`; 0 where it is so by what c is, but for rounding.
    off: f64,
}

/// What all integrands share.
struct Totals<'a> {
    plan: &'a IntegrationPlan,
    /// `sum |s_m|^2` over realizations, per stored mode, of weights over `unit`.
    power: &'a [f64],
    axes: &'a [Vec<f64>],
    unit: f64,
    /// `sum w^2` of all realizations, of the same: P is power over it.
    norm: f64,
    lags: &'a [i64],
    counted: &'a [&'a RealizationSums],
    factors: &'a [Factor],
}

fn one(totals: &Totals<'_>, i: usize) -> Option<IntegrationError> {
    let plan = totals.plan;
    let (integrand, averaged) = (&plan.integrands[i], &plan.averaged[i]);
    let (exact, level, v0) = (integrand.integral(), averaged.integral(), averaged.variance().max(0.0));
    let k = totals.counted.len() as f64;
    let of = |value: &dyn Fn(&IntegrandSums, &RealizationSums, Factor) -> f64| -> Vec<f64> {
        totals.counted.iter().zip(totals.factors).map(|(r, factor)| value(&r.each[i], r, *factor)).collect()
    };
    let measured = |values: &[f64]| Some(Measured { value: mean(values)?, se: standard_error(values) });
    let table = &plan.tables[i];
    let inside: f64 = table.grid.iter().sum::<f64>() + table.axes.iter().flatten().sum::<f64>();
    let rest = beyond(v0, inside);
    let count = of(&|_, _, f| (level * f.off).powi(2));
    let spectral = of(&|s, _, f| f.c * f.c * s.grid);
    let axes = of(&|s, _, f| f.c * f.c * s.axes);
    let rests = of(&|_, r, f| f.c * f.c * r.square * rest);
    let tails = add(&axes, &rests);
    let term = plan.removal().map(|removal| removal.terms[i]);
    let removal = of(&|_, _, f| f.c * term.map_or(0.0, |term| term.value));
    let spatial = of(&|s, r, f| f.c * f.c * (r.square * v0 + 2.0 * s.pairs).max(0.0));
    let by_pairs = plan.pairs != PairSum::None;
    let closed = add(&add(&add(&spectral, &tails), &count), &removal);
    let in_space = add(&add(&spatial, &count), &removal);
    let stationarised = if plan.pairs == PairSum::Exact { in_space.clone() } else { closed.clone() };
    // c S - I = c (S - I sum w) + I off.
    let of_parent =
        |s: &IntegrandSums, r: &RealizationSums, f: Factor| f.c * (s.values - level * r.weight) + level * f.off;
    let parents = of(&of_parent);
    let is_ratio = plan.estimator.is_ratio();
    let kept = |value: &dyn Fn(&KeptSums, Factor) -> f64,
                otherwise: &dyn Fn(&IntegrandSums, &RealizationSums, Factor) -> f64| {
        of(&|s, r, f| r.removal.as_ref().map_or_else(|| otherwise(s, r, f), |removal| value(&removal.each[i], f)))
    };
    // The error of a ratio is what was summed.
    let errors = kept(&|s, f| if is_ratio { s.error } else { f.c * s.error + exact * f.off }, &of_parent);
    let estimates: Vec<f64> = errors.iter().map(|e| exact + e).collect();
    let squared: Vec<f64> = errors.iter().map(|e| e * e).collect();
    let squared_error = |[first, second]: [f64; 2], f: Factor| {
        let off = exact * f.off;
        (f.c * f.c * second + 2.0 * f.c * off * first + off * off).max(0.0)
    };
    let shifted = kept(&|s, f| if is_ratio { s.shifted[1] } else { squared_error(s.shifted, f) }, &|s, _, f| {
        squared_error(s.shifted, f)
    });
    let before: Vec<f64> = stationarised.iter().zip(&removal).map(|(v, removal)| v - removal).collect();
    let phases: Vec<f64> = parents.iter().zip(&before).map(|(error, v)| error * error - v).collect();
    let low = of(&|s, _, f| f.c * f.c * (s.low[0] * s.low[0] - s.low[1]));
    let unit = v0 * mean(&of(&|_, r, f| f.c * f.c * r.square))?;
    let removal_error = term.map(|term| {
        let given = kept(&|s, f| f.c * f.c * s.given, &|_, _, _| 0.0);
        let as_is: Vec<f64> = parents.iter().zip(&given).map(|(error, given)| error * error + given).collect();
        let known = !is_ratio;
        RemovalError {
            variance: removal.iter().sum::<f64>() / k,
            error: term.error * totals.factors.iter().map(|f| f.c).sum::<f64>() / k,
            as_is: known.then(|| measured(&as_is)).flatten(),
            z_as_is: known.then(|| paired(&squared, &as_is, unit)).flatten(),
        }
    });
    let (rings, modes, map) = shares(totals, table, [mean(&spectral)?, mean(&axes)?]);
    let lags = lag_shares(totals, table);
    let (mut predicted, mut all, mut in_space) = (measured(&spectral)?, measured(&closed)?, measured(&in_space)?);
    if totals.counted.len() == 1 {
        [predicted.se, all.se] = single_errors(totals, table, totals.factors[0].c).map(Some);
        in_space.se = all.se;
    }
    let observed = observed(&errors, integrand.square_integral());
    let mean_estimate = measured(&estimates)?;
    let bias = measured(&errors)?;
    Some(IntegrationError {
        integrand: integrand.clone(),
        v0,
        mean: mean_estimate,
        bias,
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
        tail_bound: mean(&rests)? * highest_excess(plan, totals.power, totals.axes, totals.norm),
        tail_share: if v0 > 0.0 { rest / v0 } else { 0.0 },
        closed: all,
        count_term: mean(&count)?,
        removal: removal_error,
        phase: measured(&phases)?,
        phase_low: mean(&low)?,
        var_low: variance(&of(&|s, _, f| f.c * s.low[0])),
        z: paired(&shifted, &stationarised, unit),
        estimates,
        stationarised,
        rings,
        modes,
        map,
        lags,
        alone: unit,
    })
}

/// With ddof 1.
fn variance(values: &[f64]) -> Option<f64> {
    let center = mean(values).filter(|_| values.len() >= 2)?;
    Some(values.iter().map(|x| (x - center).powi(2)).sum::<f64>() / (values.len() - 1) as f64)
}

fn add(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// The variance of estimates (ddof 1) and its standard error by the fourth central moment, for few estimates at least half of what normal
/// ones have; 0 where all are one number.
fn observed(estimates: &[f64], scale: f64) -> Option<Measured> {
    let k = estimates.len() as f64;
    let center = mean(estimates).filter(|_| estimates.len() >= 2)?;
    let variance = variance(estimates)?;
    if variance <= 1e-25 * scale {
        return Some(Measured { value: 0.0, se: Some(0.0) });
    }
    let fourth = estimates.iter().map(|e| (e - center).powi(4)).sum::<f64>() / k;
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
    [grid, grid + axes].map(|sum| (c * totals.unit).powi(2) * sum.sqrt())
}

/// How far P is from 1 where the grid ends: the largest, over directions, of means over its outermost tenth, and along axes. `power` over
/// `level` is P; what is not finite is not known.
pub(super) fn highest_excess(plan: &IntegrationPlan, power: &[f64], axes: &[Vec<f64>], level: f64) -> f64 {
    let Some(grid) = plan.grid.waves.grid() else { return 1.0 };
    let frequencies = grid.max_frequency();
    const DIRECTIONS: usize = 16;
    let (mut sums, mut counts) = ([0.0; DIRECTIONS], [0.0; DIRECTIONS]);
    for (index, q) in power.iter().enumerate().filter(|(index, _)| plan.grid.computes(*index)) {
        let m = grid.mode(index);
        let out = (0..grid.dim()).map(|a| f64::from(m[a].abs()) / f64::from(frequencies[a].max(1))).fold(0.0, f64::max);
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

/// What rings, single modes and those of a plane add to the predicted variance: all of the grid, and all along axes beyond it.
fn shares(
    totals: &Totals<'_>,
    table: &crate::plan::IntegrandTable,
    [inside, beyond]: [f64; 2],
) -> (Vec<RingShare>, Vec<ModeShare>, Option<ModeMap>) {
    let product = |table: &[f64], power: &[f64]| table.iter().zip(power).map(|(f, q)| f * q).sum::<f64>();
    let along: f64 = table.axes.iter().zip(totals.axes).map(|(table, power)| product(table, power)).sum();
    // c varies where n does: products are those of sums over realizations.
    let scale = |variance: f64, whole: f64| if whole > 0.0 { variance / whole } else { 0.0 };
    let scales = [scale(inside, product(&table.grid, totals.power)), scale(beyond, along)];
    let mut rings: Vec<RingShare> = Vec::new();
    let mut modes: Vec<ModeShare> = Vec::new();
    let mut add = |m: [i32; 3], coefficient: f64, q: f64, scale: f64, twice: bool| {
        if coefficient == 0.0 {
            return;
        }
        let ring = m.iter().map(|&m| f64::from(m) * f64::from(m)).sum::<f64>().sqrt().round() as usize;
        if rings.len() <= ring {
            rings.extend((rings.len()..=ring).map(|k| RingShare { m: k as f64, coefficients: 0.0, variance: 0.0 }));
        }
        let variance = scale * coefficient * q;
        rings[ring].coefficients += coefficient;
        rings[ring].variance += variance;
        // Of a pair that is stored twice, one.
        let first = m.iter().find(|m| **m != 0).is_some_and(|m| *m > 0);
        let both = if twice { 2.0 } else { 1.0 };
        let (coefficient, variance) = (both * coefficient, both * variance);
        let top = totals.plan.top.map_or(TOP, |top| top as usize);
        let among = modes.len() < top || modes.last().is_some_and(|last| last.variance < variance);
        if first && among {
            let at = modes.partition_point(|other| other.variance >= variance);
            modes.insert(at, ModeShare { m, coefficient, p: q / totals.norm, variance });
            modes.truncate(top);
        }
    };
    if let Some(grid) = totals.plan.grid.waves.grid() {
        for (index, (f, q)) in table.grid.iter().zip(totals.power).enumerate() {
            add(grid.mode(index), *f, *q, scales[0], grid.mode(index)[0] == 0);
        }
    }
    for (a, (of_axis, power)) in table.axes.iter().zip(totals.axes).enumerate() {
        for (m, (f, q)) in of_axis.iter().zip(power).enumerate() {
            let mut vector = [0; 3];
            vector[a] = m as i32;
            add(vector, *f, *q, scales[1], false);
        }
    }
    rings.retain(|ring| ring.coefficients > 0.0);
    (rings, modes, mapped(totals, table, scales[0]))
}

/// What every frequency in a plane adds: its coefficient times `|s_m|^2`, times `scale`.
fn mapped(totals: &Totals<'_>, table: &crate::plan::IntegrandTable, scale: f64) -> Option<ModeMap> {
    let grid = totals.plan.grid.waves.grid().filter(|grid| grid.dim() >= 2)?;
    let [x, y, _] = grid.max_frequency();
    let half @ [wide, high] = [x, y].map(|f| f.min(MAPPED));
    let of = |m| {
        let at = grid.half_index(m);
        scale * table.grid[at] * totals.power[at] / f64::from(grid.multiplicity(at))
    };
    let plane = (0..=wide as i32).flat_map(|x| (-(high as i32)..=high as i32).map(move |y| [x, y, 0]));
    let variances: Vec<f64> = plane.map(|m| if m == [0; 3] { 0.0 } else { of(m) }).collect();
    let largest = variances.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
    (largest > 0.0).then_some(ModeMap { half, variances, largest })
}

/// Shells of lags up to half a side, by width.
const SHELLS_TO_HALF: usize = 64;

/// What shells of lags add to the variance: pairs around every node times `a - I^2` there, less what as many pairs at random lags have.
fn lag_shares(totals: &Totals<'_>, table: &crate::plan::IntegrandTable) -> Vec<LagShare> {
    let Some(side) = totals.plan.lag_nodes().filter(|_| totals.lags.len() == table.nodes.len()) else {
        return Vec::new();
    };
    let dim = totals.plan.domain.dim();
    // c varies where n does: then this is its mean.
    let squared: f64 = totals.factors.iter().map(|f| f.c * f.c).sum::<f64>() / totals.factors.len() as f64;
    let scale = 2.0 * squared * totals.unit * totals.unit * LAG_STEP / totals.counted.len() as f64;
    let all = side.pow(dim as u32) as f64;
    let uniform = totals.lags.iter().map(|count| *count as f64).sum::<f64>() / all;
    let width = 0.5 / SHELLS_TO_HALF as f64;
    let shells = ((dim as f64).sqrt() * SHELLS_TO_HALF as f64).ceil() as usize + 1;
    let (mut variances, mut excess, mut count) = (vec![0.0; shells], vec![0.0; shells], vec![0.0; shells]);
    for (node, (pairs, b)) in totals.lags.iter().zip(&table.nodes).enumerate() {
        let along = |a: usize| {
            let place = node / side.pow(a as u32) % side;
            place.min(side - place) as f64 / side as f64
        };
        let r = (0..dim).map(|a| along(a).powi(2)).sum::<f64>().sqrt();
        let shell = ((r / width) as usize).min(shells - 1);
        let times = totals.plan.lag_multiplicity(node);
        variances[shell] += scale * (*pairs as f64 - times * uniform) * b;
        excess[shell] += times * b;
        count[shell] += times;
    }
    (0..shells)
        .filter(|&k| count[k] > 0.0)
        .map(|k| LagShare {
            lo: k as f64 * width,
            hi: (k + 1) as f64 * width,
            excess: excess[k] / count[k],
            variance: variances[k],
        })
        .collect()
}

impl Analysis {
    /// Integration errors.
    pub fn integration(&self) -> Option<&IntegrationErrors> {
        self.get()
    }
}

//! The intensity at points, by whose inverse they are weighted. See `docs/inhomogeneous.md`.

use std::sync::Arc;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::Points;
use super::weights::Weights;
use crate::accumulate::intensity_scores;
use crate::control::Control;
use crate::error::{Error, Result, number, numbers};
use crate::estimate::{Inhomogeneity, IntensityChoice};
use crate::integrand::{Integrand, find};
use crate::plan::{IntensityBandwidth, IntensityPlan, IntensitySearch, KernelMass, kernel_sum};
use crate::points::Ensemble;
use crate::request::{ESTIMATE, PointsRequest};
use crate::setting::Setting;

/// Pairs of a point and another that an estimate may take over all realizations: about a minute of one thread.
const PAIRS: f64 = (1u64 << 30) as f64;

/// Points looked at in a step.
const STEP: f64 = (1u64 << 20) as f64;

/// What points are weighted by.
#[derive(Debug, Clone)]
pub(super) struct Intensity {
    pub(super) found: Inhomogeneity,
    rule: Rule,
    /// The largest 1/lambda of all.
    largest: f64,
}

#[derive(Debug, Clone)]
enum Rule {
    /// Weights that the points came with.
    Read,
    Of(Integrand),
    /// 1/lambda of all points, and where each realization starts.
    Known(Arc<(Vec<usize>, Vec<f64>)>),
}

/// What is seen of lambda at all points.
#[derive(Debug, Clone)]
pub(super) struct Seen {
    least: f64,
    largest: f64,
    inverses: f64,
}

impl Default for Seen {
    fn default() -> Self {
        Self { least: f64::INFINITY, largest: 0.0, inverses: 0.0 }
    }
}

impl Seen {
    /// Takes the points of another realization into account: their 1/lambda.
    ///
    /// # Errors
    /// The first lambda that no point can be weighted by, by its place.
    pub(super) fn see(&mut self, lambda: &[f64], place: impl Fn(usize) -> String, more: &str) -> Result<Vec<f64>> {
        if let Some(j) = lambda.iter().position(|l| !(*l > 0.0 && (1.0 / l).is_normal() && l.is_finite())) {
            let reason =
                format!("the intensity there is {}; expected a finite number above 0{more}", number(lambda[j]));
            return Err(Error::input(place(j), reason));
        }
        self.least = lambda.iter().copied().fold(self.least, f64::min);
        self.largest = lambda.iter().copied().fold(self.largest, f64::max);
        let inverses = inverses(lambda);
        self.inverses += inverses.iter().sum::<f64>();
        Ok(inverses)
    }

    fn found(&self, intensity: String, points: &Points) -> Inhomogeneity {
        Inhomogeneity {
            intensity,
            bandwidth: None,
            rule: None,
            others: None,
            least: self.least,
            largest: self.largest,
            inverse_mean: self.inverses / (points.shape.realizations as f64 * points.domain.measure()),
        }
    }
}

pub(super) fn inverses(lambda: &[f64]) -> Vec<f64> {
    lambda.iter().map(|l| 1.0 / l).collect()
}

impl Intensity {
    /// Of points that came with it in a column.
    pub(super) fn read(column: &str, seen: &Seen, points: &Points) -> Self {
        Self::of_elsewhere(seen.found(format!("column {column}"), points))
    }

    /// Of points that were weighted already.
    pub(super) fn of_elsewhere(found: Inhomogeneity) -> Self {
        Self { found, rule: Rule::Read, largest: 0.0 }
    }

    /// The same points with their weights.
    pub(super) fn weigh(&self, ensemble: Ensemble) -> Ensemble {
        let weights = match &self.rule {
            Rule::Read => return ensemble,
            Rule::Of(lambda) => {
                (0..ensemble.realizations()).flat_map(|k| inverses(&values(lambda, &ensemble, k))).collect()
            }
            Rule::Known(known) => {
                let (starts, inverses) = known.as_ref();
                let first = ensemble.first_index() as usize;
                inverses[starts[first]..starts[first + ensemble.realizations()]].to_vec()
            }
        };
        ensemble.with_weights_of(&weights, self.largest)
    }
}

/// A function of the place at the points of realization `k`, in fractions of the box below 1.
fn values(lambda: &Integrand, ensemble: &Ensemble, k: usize) -> Vec<f64> {
    let below = |x: f64| x.min(1.0 - f64::EPSILON / 2.0);
    let axes: Vec<Vec<f64>> = (0..ensemble.domain().dim()).map(|a| ensemble.turns(k, a).map(below).collect()).collect();
    let value = |j: usize| {
        let mut x = [0.0; 3];
        x.iter_mut().zip(&axes).for_each(|(x, axis)| *x = axis[j]);
        lambda.value(&x[..axes.len()])
    };
    (0..ensemble.points_in(k)).into_par_iter().map(value).collect()
}

/// A kernel estimate of lambda from the points of other realizations, or of a single one from its other points.
struct Estimate {
    bandwidth: f64,
    rule: IntensityBandwidth,
    /// The realizations that it is read off, by their indices: positions from the lower corner, by axis.
    from: Vec<(u64, Vec<Vec<f64>>)>,
}

impl Estimate {
    fn new(points: &Points, rule: IntensityBandwidth, control: &Control) -> Result<Self> {
        let (domain, shape) = (&points.domain, points.shape);
        let mut bandwidth = IntensityPlan::bandwidth(domain, rule, shape)?;
        if let Some(search) = IntensitySearch::new(domain, rule, shape) {
            let mut scores = None;
            for batch in steps(points) {
                let some = intensity_scores(&search, &points.batch(batch, control)?, control)?;
                match &mut scores {
                    None => scores = Some(some),
                    Some(scores) => scores.realizations.extend(some.realizations),
                }
            }
            let choice = scores.and_then(|scores| IntensityChoice::new(&search, &scores));
            bandwidth = choice.map_or(bandwidth, |choice| choice.bandwidth);
        }
        let k = shape.realizations;
        let n = shape.mean_points.max(1.0);
        let most = (PAIRS / (n * n * k as f64)).max(2.0).min(k as f64) as u64;
        let one = |i: u64| {
            let index = (u128::from(i) * u128::from(k) / u128::from(most)) as u64;
            Ok((index, points.batch(index..index + 1, control)?.offsets_from_corner(0)))
        };
        Ok(Self { bandwidth, rule, from: (0..most).map(one).collect::<Result<_>>()? })
    }

    /// lambda at the points of a realization.
    fn values(&self, points: &Points, index: u64, axes: &[Vec<f64>], control: &Control) -> Result<Vec<f64>> {
        let (domain, alone) = (&points.domain, points.shape.realizations == 1);
        let mass = KernelMass::new(domain, self.bandwidth);
        let others: Vec<&Vec<Vec<f64>>> =
            self.from.iter().filter(|(other, _)| alone || *other != index).map(|(_, axes)| axes).collect();
        let value = |j: usize| {
            control.check()?;
            let place: Vec<f64> = axes.iter().map(|axis| axis[j]).collect();
            let but = alone.then_some(j);
            let sum: f64 = others.iter().map(|o| kernel_sum(domain, self.bandwidth, &place, o, but)).sum();
            Ok(sum / others.len() as f64 / mass.at(&place))
        };
        (0..axes[0].len()).into_par_iter().map(value).collect()
    }
}

/// Ranges of realizations of not too many points together.
fn steps(points: &Points) -> impl Iterator<Item = std::ops::Range<u64>> + use<> {
    let (k, n) = (points.shape.realizations, points.shape.max_points.max(1));
    let step = ((STEP / n as f64) as u64).max(1);
    (0..k.div_ceil(step)).map(move |i| i * step..((i + 1) * step).min(k))
}

impl Points {
    /// The same points, weighted by the inverse of the intensity that the request names with `inhomogeneous`; as they are where it
    /// names none. What `open` reads has it already.
    ///
    /// # Errors
    /// An intensity that cannot be, or is not above 0 at some point; points that have weights.
    pub fn with_intensity(mut self, request: &PointsRequest, control: &Control) -> Result<Self> {
        let Some(how) = request.inhomogeneous.as_deref().filter(|_| self.intensity.is_none()) else { return Ok(self) };
        let wrong = |reason: &str| Error::setting(Setting::Inhomogeneous, how, reason);
        let rule = request.intensity_bandwidth.unwrap_or(IntensityBandwidth::Scott);
        if self.shape.max_points == 0 {
            // What is wrong with the points is said where they are measured.
            return Ok(self);
        }
        let estimate = (how == ESTIMATE).then(|| Estimate::new(&self, rule, control)).transpose()?;
        let lambda = match &estimate {
            Some(_) => None,
            None => Some(Integrand::new(how, self.domain.dim()).map_err(|error| match error {
                Error::Setting { setting: Setting::Integrand, value, reason } => {
                    let unknown = find(how.split(':').next().unwrap_or(how).trim()).is_err();
                    let or = if unknown { ", or estimate, a kernel estimate" } else { "" };
                    Error::setting(Setting::Inhomogeneous, value, reason + or)
                }
                other => other,
            })?),
        };
        let more = if estimate.is_some() { ": a larger `intensity_bandwidth` reaches more points" } else { "" };
        let (mut seen, mut weights) = (Seen::default(), Weights::default());
        let (mut starts, mut known, mut largest) = (vec![0], Vec::new(), 0.0f64);
        for batch in steps(&self) {
            let some = self.batch(batch, control)?;
            for k in 0..some.realizations() {
                if some.weights(k).is_some() {
                    return Err(wrong("the points have weights of their own; expected points without"));
                }
                let index = some.first_index() + k as u64;
                let of_points = match (&estimate, &lambda) {
                    (Some(estimate), _) => estimate.values(&self, index, &some.offsets_from_corner(k), control)?,
                    (None, Some(lambda)) => values(lambda, &some, k),
                    (None, None) => Vec::new(),
                };
                let place = |j: usize| {
                    let at = numbers(some.position(k, j));
                    format!("{}, realization {index}, point {j} at {at}", self.subject)
                };
                let inverses = seen.see(&of_points, place, more)?;
                weights.see(&inverses, place);
                largest = inverses.iter().copied().fold(largest, f64::max);
                if estimate.is_some() {
                    known.extend(inverses);
                    starts.push(known.len());
                }
            }
        }
        let spec = lambda.as_ref().map_or(ESTIMATE, Integrand::spec);
        let mut found = seen.found(spec.into(), &self);
        if let Some(estimate) = &estimate {
            found.bandwidth = Some(estimate.bandwidth);
            found.rule = Some(estimate.rule.to_string());
            found.others = Some(match self.shape.realizations {
                1 => 0,
                // Those it is read off may hold the realization itself.
                k => (estimate.from.len() as u64).min(k - 1),
            });
        }
        if let Value::Object(identity) = &mut self.identity {
            identity.insert("intensity".into(), json!(found));
        }
        let rule = lambda.map_or_else(|| Rule::Known(Arc::new((starts, known))), Rule::Of);
        self.weights = weights;
        self.intensity = Some(Intensity { found, rule, largest });
        Ok(self)
    }

    /// How the intensity came that points are weighted by the inverse of.
    pub fn inhomogeneity(&self) -> Option<&Inhomogeneity> {
        self.intensity.as_ref().map(|intensity| &intensity.found)
    }
}

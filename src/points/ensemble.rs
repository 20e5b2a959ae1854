//! Realizations of a pattern, checked once.

use std::borrow::Borrow;

use rayon::prelude::*;

use super::fixed_point::{difference, scale_to_period, steps};
use super::{Domain, EnsembleShape, RawPoints};
use crate::error::{Error, Result, number, plural};

/// Realizations of one point process in one domain, as fixed-point fractions, checked once and never changed.
///
/// Two integers stand for each coordinate `x` of axis `k`:
/// - the *fraction* `(x - origin_k) / side_k`, the argument of phases, wrapping at 2^64 (`m . x mod 1` is exact for integer
///   `m`). The upper side of a window is the fraction 0, as 1 is for such m; `turns` tells them apart for any other;
/// - the *length* `(x - origin_k) / length_unit`, the argument of distances (one step is the same length on every
///   axis). They are the same integers on a cubic torus and are then stored once. In a window no two places that are a step
///   apart share one, up to and including both sides.
///
/// Each is the multiple of 2^-64 nearest to the quotient of what is given, `x - origin` being taken without rounding; but
/// lengths of a torus with unequal sides are those of the fraction, and off by at most one step.
///
/// Where points came as coordinates these are kept as they were given: the reference takes phases from them, not from
/// integers.
#[derive(Debug, Clone, PartialEq)]
pub struct Ensemble {
    domain: Domain,
    /// Index of the first realization in the whole batch; the order of sums follows it.
    first_index: u64,
    /// `offsets[k]..offsets[k + 1]` are the points of realization `k`.
    offsets: Vec<usize>,
    fractions: Vec<Vec<u64>>,
    /// `None` on a cubic torus, where lengths are the fractions.
    lengths: Option<Vec<Vec<u64>>>,
    /// Coordinates as they were given, per axis; `None` where points came as integers.
    coordinates: Option<Vec<Vec<f64>>>,
    /// The weight of each point, scaled by a power of two so that the largest magnitude is in (1/2, 1]; `None` where every
    /// point weighs 1.
    weights: Option<Vec<f64>>,
    /// What they are multiplied by to be what was given, a power of two.
    weight_unit: f64,
    /// The class of each point; `None` where there is only one.
    classes: Option<Vec<u32>>,
}

impl Ensemble {
    /// Checks and converts realizations. `wrap` folds points outside a torus back in; without it (and always for a
    /// window) a point outside is an error that names the point.
    ///
    /// # Errors
    /// The first point that is outside or not finite, by its place; sets of another dimension.
    pub fn from_raw(raw: &[RawPoints], domain: &Domain, wrap: bool, first_index: u64) -> Result<Self> {
        Self::from_sets(raw.iter(), raw.iter().map(RawPoints::len).sum(), domain, wrap, first_index)
    }

    /// The same of sets that are not needed any more: each goes as soon as it is converted.
    pub(crate) fn from_owned(raw: Vec<RawPoints>, domain: &Domain, wrap: bool, first_index: u64) -> Result<Self> {
        let total = raw.iter().map(RawPoints::len).sum();
        Self::from_sets(raw.into_iter(), total, domain, wrap, first_index)
    }

    /// Whether a set could be converted.
    pub(crate) fn check(set: &RawPoints, domain: &Domain, wrap: bool) -> Result<()> {
        check_dim(set, domain)?;
        check_polygon(set, domain)?;
        for (j, point) in set.coordinates.chunks_exact(set.dim).enumerate() {
            for (k, &x) in point.iter().enumerate() {
                offset(x, k, domain, wrap).ok_or_else(|| outside(set, j, k, x, domain))?;
            }
        }
        Ok(())
    }

    fn from_sets(
        raw: impl Iterator<Item = impl Borrow<RawPoints>>,
        total: usize,
        domain: &Domain,
        wrap: bool,
        first_index: u64,
    ) -> Result<Self> {
        let dim = domain.dim();
        let mut offsets = vec![0];
        // A clone would not have the capacity.
        let mut fractions: Vec<Vec<u64>> = (0..dim).map(|_| Vec::with_capacity(total)).collect();
        let mut coordinates: Vec<Vec<f64>> = (0..dim).map(|_| Vec::with_capacity(total)).collect();
        let (unit, periods) = (domain.length_unit(), domain.periods());
        let own_lengths = !(domain.is_torus() && domain.is_cubic());
        let mut lengths: Vec<Vec<u64>> =
            (0..dim).map(|_| Vec::with_capacity(if own_lengths { total } else { 0 })).collect();
        for set in raw {
            let set: &RawPoints = set.borrow();
            check_dim(set, domain)?;
            check_polygon(set, domain)?;
            for (j, point) in set.coordinates.chunks_exact(dim).enumerate() {
                for (k, &x) in point.iter().enumerate() {
                    let offset = offset(x, k, domain, wrap).ok_or_else(|| outside(set, j, k, x, domain))?;
                    let fraction = fraction(offset, domain.sides()[k], domain);
                    fractions[k].push(fraction);
                    coordinates[k].push(x);
                    if own_lengths {
                        lengths[k].push(if domain.is_torus() {
                            scale_to_period(fraction, periods[k])
                        } else {
                            steps(offset, unit) as u64
                        });
                    }
                }
            }
            offsets.push(fractions[0].len());
        }
        let lengths = own_lengths.then_some(lengths);
        Ok(Self {
            domain: domain.clone(),
            first_index,
            offsets,
            fractions,
            lengths,
            coordinates: Some(coordinates),
            weights: None,
            weight_unit: 1.0,
            classes: None,
        })
    }

    /// The same points with weights, one per point of all realizations: finite and not all 0. They are divided by the
    /// power of two at or above the largest magnitude, which drops out of all estimates. Spectra take them as they are, of
    /// either sign; g and K, where weights are at least 0, take products of two of them in steps of 2^-64.
    pub fn with_weights(self, weights: &[f64]) -> Self {
        let largest = weights.iter().fold(0.0, |l: f64, w| l.max(w.abs()));
        self.with_weights_of(weights, largest)
    }

    /// The same where `largest` is the largest magnitude in more realizations than these.
    pub(crate) fn with_weights_of(mut self, weights: &[f64], largest: f64) -> Self {
        let scaled: Vec<f64> = scaled(weights, largest).collect();
        self.weights = Some(scaled);
        self.weight_unit = 1.0 / self::scaled(&[1.0], largest).sum::<f64>();
        self
    }

    /// The same points with classes, one per point of all realizations.
    pub fn with_classes(mut self, classes: Vec<u32>) -> Self {
        self.classes = Some(classes);
        self
    }

    /// The points of the classes that `wanted` holds, in the same realizations.
    pub fn of_classes(&self, wanted: &[u32]) -> Self {
        let Some(classes) = &self.classes else { return self.clone() };
        let kept: Vec<usize> = (0..self.total_points()).filter(|&j| wanted.contains(&classes[j])).collect();
        fn cut<T: Copy>(axes: &[Vec<T>], kept: &[usize]) -> Vec<Vec<T>> {
            axes.iter().map(|a| kept.iter().map(|&j| a[j]).collect()).collect()
        }
        let marks = |marks: &Vec<u32>| kept.iter().map(|&j| marks[j]).collect();
        Self {
            domain: self.domain.clone(),
            first_index: self.first_index,
            offsets: self.offsets.iter().map(|&o| kept.partition_point(|&j| j < o)).collect(),
            fractions: cut(&self.fractions, &kept),
            lengths: self.lengths.as_ref().map(|l| cut(l, &kept)),
            coordinates: self.coordinates.as_ref().map(|c| cut(c, &kept)),
            weights: self.weights.as_ref().map(|w| kept.iter().map(|&j| w[j]).collect()),
            weight_unit: self.weight_unit,
            classes: Some(marks(classes)),
        }
    }

    /// The domain.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Number of realizations held here.
    pub fn realizations(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The same realizations, counted from another index in the batch.
    pub(crate) fn numbered_from(self, first_index: u64) -> Self {
        Self { first_index, ..self }
    }

    /// Index of the first of them in the whole batch.
    pub fn first_index(&self) -> u64 {
        self.first_index
    }

    /// Number of points in realization `k` (counted from the first held here).
    pub fn points_in(&self, k: usize) -> usize {
        self.offsets[k + 1] - self.offsets[k]
    }

    /// Number of points in all realizations held here.
    pub fn total_points(&self) -> usize {
        self.fractions[0].len()
    }

    /// The range of realization `k` within `all_fractions` and `all_lengths`.
    pub fn range(&self, k: usize) -> std::ops::Range<usize> {
        self.offsets[k]..self.offsets[k + 1]
    }

    /// Fractions of the own side along `axis`, all realizations back to back.
    pub fn all_fractions(&self, axis: usize) -> &[u64] {
        &self.fractions[axis]
    }

    /// Positions along `axis` in steps of `length_unit / 2^64`, all realizations back to back.
    pub fn all_lengths(&self, axis: usize) -> &[u64] {
        self.lengths.as_ref().map_or(&self.fractions[axis], |l| &l[axis])
    }

    /// Per axis, the fractions of realization `k`.
    pub fn fractions(&self, k: usize) -> Vec<&[u64]> {
        (0..self.domain.dim()).map(|a| &self.all_fractions(a)[self.range(k)]).collect()
    }

    /// Per axis, the lengths of realization `k`.
    pub fn lengths(&self, k: usize) -> Vec<&[u64]> {
        (0..self.domain.dim()).map(|a| &self.all_lengths(a)[self.range(k)]).collect()
    }

    /// Per axis, the coordinates of realization `k` as they were given; `None` where points came as integers.
    pub fn coordinates(&self, k: usize) -> Option<Vec<&[f64]>> {
        self.coordinates.as_ref().map(|axes| axes.iter().map(|a| &a[self.range(k)]).collect())
    }

    /// The fractions of realization `k` along `axis` as numbers, from 0 to 1: 1 on the upper side of a window.
    pub fn turns(&self, k: usize, axis: usize) -> impl Iterator<Item = f64> {
        let (window, range) = (!self.domain.is_torus(), self.range(k));
        let pairs = self.all_fractions(axis)[range.clone()].iter().zip(&self.all_lengths(axis)[range]);
        // A fraction that wrapped belongs to a length that did not.
        pairs.map(move |(&f, &l)| if window && f == 0 && l > 1 { 1.0 } else { f as f64 * 2f64.powi(-64) })
    }

    /// The weights of the points of realization `k`, the largest magnitude of all realizations in (1/2, 1]; `None` where every
    /// point weighs 1.
    pub fn weights(&self, k: usize) -> Option<&[f64]> {
        self.weights.as_ref().map(|w| &w[self.range(k)])
    }

    /// What `weights` are multiplied by to be those that were given: a power of two, infinite beyond the largest numbers.
    pub(crate) fn weight_unit(&self) -> f64 {
        self.weight_unit
    }

    /// The class of each point of realization `k`; `None` where there is only one.
    pub fn classes(&self, k: usize) -> Option<&[u32]> {
        self.classes.as_ref().map(|c| &c[self.range(k)])
    }

    /// The sum of squared weights of realization `k`, which `|s_m|^2` is compared with: n where every point weighs 1.
    pub fn norm(&self, k: usize) -> f64 {
        self.weights(k).map_or(self.points_in(k) as f64, |w| w.iter().map(|w| w * w).sum())
    }

    /// Number and size of the realizations held here.
    pub fn shape(&self) -> EnsembleShape {
        EnsembleShape::of(&self.offsets.windows(2).map(|w| (w[1] - w[0]) as u64).collect::<Vec<_>>())
    }

    /// One realization of integers that were an ensemble's before.
    pub(crate) fn from_integers(
        domain: Domain,
        index: u64,
        fractions: Vec<Vec<u64>>,
        lengths: Option<Vec<Vec<u64>>>,
        weights: Option<Vec<f64>>,
        classes: Option<Vec<u32>>,
    ) -> Self {
        let offsets = vec![0, fractions[0].len()];
        Self {
            domain,
            first_index: index,
            offsets,
            fractions,
            lengths,
            coordinates: None,
            weights,
            weight_unit: 1.0,
            classes,
        }
    }

    /// Position of point `j` of realization `k` in the domain's own units.
    pub fn position(&self, k: usize, j: usize) -> Vec<f64> {
        let unit = self.domain.length_unit() / 2f64.powi(64);
        (0..self.domain.dim())
            .map(|a| self.domain.origin()[a] + self.all_lengths(a)[self.offsets[k] + j] as f64 * unit)
            .collect()
    }

    /// Per axis, the positions of realization `k` in the domain's own units, from its lower corner.
    pub(crate) fn offsets_from_corner(&self, k: usize) -> Vec<Vec<f64>> {
        let unit = self.domain.length_unit() / 2f64.powi(64);
        self.lengths(k).iter().map(|axis| axis.iter().map(|&x| x as f64 * unit).collect()).collect()
    }

    /// A copy of realizations `range` (counted from the first held here).
    pub fn slice(&self, range: std::ops::Range<usize>) -> Self {
        let points = self.offsets[range.start]..self.offsets[range.end];
        fn cut<T: Copy>(axes: &[Vec<T>], points: &std::ops::Range<usize>) -> Vec<Vec<T>> {
            axes.iter().map(|a| a[points.clone()].to_vec()).collect()
        }
        Self {
            domain: self.domain.clone(),
            first_index: self.first_index + range.start as u64,
            offsets: self.offsets[range.start..=range.end].iter().map(|o| o - points.start).collect(),
            fractions: cut(&self.fractions, &points),
            lengths: self.lengths.as_ref().map(|l| cut(l, &points)),
            coordinates: self.coordinates.as_ref().map(|c| cut(c, &points)),
            weights: self.weights.as_ref().map(|w| w[points.clone()].to_vec()),
            weight_unit: self.weight_unit,
            classes: self.classes.as_ref().map(|c| c[points.clone()].to_vec()),
        }
    }

    /// The same fractions in another torus of the same dimension.
    pub fn stretched(&self, domain: &Domain) -> Self {
        if *domain == self.domain {
            return self.clone();
        }
        let periods = domain.periods();
        let lengths = (!domain.is_cubic()).then(|| {
            let axes = self.fractions.iter().zip(periods);
            axes.map(|(axis, period)| axis.iter().map(|&f| scale_to_period(f, period)).collect()).collect()
        });
        Self { domain: domain.clone(), lengths, coordinates: None, ..self.clone() }
    }

    /// The same points without weights.
    pub(crate) fn unweighted(&self) -> std::borrow::Cow<'_, Self> {
        match self.weights {
            None => std::borrow::Cow::Borrowed(self),
            Some(_) => std::borrow::Cow::Owned(Self { weights: None, weight_unit: 1.0, ..self.clone() }),
        }
    }

    /// The fractions along one axis of a torus, in a torus of one.
    pub(crate) fn on_axis(&self, axis: usize, line: &Domain) -> Self {
        let one = |axes: &Vec<Vec<f64>>| vec![axes[axis].clone()];
        Self {
            domain: line.clone(),
            first_index: self.first_index,
            offsets: self.offsets.clone(),
            fractions: vec![self.fractions[axis].clone()],
            lengths: None,
            coordinates: self.coordinates.as_ref().map(one),
            weights: self.weights.clone(),
            weight_unit: self.weight_unit,
            classes: self.classes.clone(),
        }
    }

    /// Number of points that coincide with an earlier point of the same realization: on a torus to 2^-64 of a side, in a
    /// window by their coordinates, where these are there.
    pub fn duplicates(&self) -> u64 {
        let in_realization = |k: usize| {
            let torus = self.domain.is_torus();
            let places = if torus { self.fractions(k) } else { self.lengths(k) };
            let given = self.coordinates(k).filter(|_| !torus);
            let key = |j: usize| -> [u64; 3] {
                std::array::from_fn(|a| match &given {
                    // -0 is 0.
                    Some(axes) => axes.get(a).map_or(0, |x| (x[j] + 0.0).to_bits()),
                    None => places.get(a).map_or(0, |x| x[j]),
                })
            };
            let mut keys: Vec<_> = (0..self.points_in(k)).map(key).collect();
            keys.sort_unstable();
            keys.windows(2).filter(|w| w[0] == w[1]).count() as u64
        };
        (0..self.realizations()).into_par_iter().map(in_realization).sum()
    }
}

fn check_dim(set: &RawPoints, domain: &Domain) -> Result<()> {
    if set.dim == domain.dim() {
        return Ok(());
    }
    let reason = format!("points have {} coordinates, the domain has {} axes", set.dim, domain.dim());
    Err(Error::input(&set.source, reason))
}

/// Weights over the power of two at or above the largest magnitude.
fn scaled(weights: &[f64], largest: f64) -> impl Iterator<Item = f64> {
    // Divided by the power of two below first: the one above may not be finite.
    let below = 2f64.powi(libm::ilogb(largest).clamp(-1022, 1023));
    let units = if below < largest { 0.5 } else { 1.0 };
    weights.iter().map(move |w| w / below * units)
}

/// Whether a weight is not negligible beside the largest magnitude, for pairs: their product is some steps of 2^-64.
pub(crate) fn counts_in_pairs(weight: f64, largest: f64) -> bool {
    scaled(&[weight], largest).any(|w| w >= 2f64.powi(-60))
}

/// The way of `x` from the origin, with what it is rounded by; folded once round on a torus where `wrap` says so, so that it
/// may be negative. `None` outside.
fn offset(x: f64, axis: usize, domain: &Domain, wrap: bool) -> Option<[f64; 2]> {
    let side = domain.sides()[axis];
    let [whole, rest] = difference(x, domain.origin()[axis]);
    if !whole.is_finite() {
        return None;
    }
    match (domain.is_torus(), wrap) {
        // The remainder is exact; dividing first would lose the digits that the whole turns take up.
        (true, true) => Some([whole % side, rest]),
        (true, false) => (0.0..side).contains(&whole).then_some([whole, rest]),
        (false, _) => {
            let beyond = whole > side || (whole == side && rest > domain.rests()[axis]);
            (whole >= 0.0 && !beyond).then_some([whole, rest])
        }
    }
}

/// The fraction of a side that `offset` is, in steps of 2^-64 and modulo 1.
fn fraction([whole, rest]: [f64; 2], side: f64, domain: &Domain) -> u64 {
    if whole < 0.0 {
        return (steps([-whole, -rest], side) as u64).wrapping_neg();
    }
    let steps = steps([whole, rest], side);
    // A side is rounded: what is at its end may be a hair beyond 1.
    if domain.is_torus() { steps as u64 } else { steps.min(1 << 64) as u64 }
}

/// Whether all points are in the polygon that the window is, or on a side of it; of those that are no numbers others tell.
fn check_polygon(set: &RawPoints, domain: &Domain) -> Result<()> {
    let Some(polygon) = domain.as_polygon() else { return Ok(()) };
    let points = set.coordinates.as_chunks::<2>().0;
    let outside = |&j: &usize| {
        let point = points[j];
        let in_box = |k: usize| offset(point[k], k, domain, false).is_some();
        point.iter().all(|x| x.is_finite()) && !(in_box(0) && in_box(1) && polygon.contains_point(point))
    };
    let outside: Vec<usize> = (0..points.len()).into_par_iter().filter(outside).collect();
    let Some(&first) = outside.first() else { return Ok(()) };
    let [x, y] = points[first].map(number);
    let are = match outside.len() {
        1 => "1 point is outside the polygon, at".into(),
        n => format!("{n} points are outside the polygon, the first at"),
    };
    let reason = format!(
        "of {}, {are} ({x}, {y}); expected points inside or on its sides, or the outline in which they were observed \
         (`window_polygon`)",
        plural(points.len() as u64, "point")
    );
    Err(Error::input(set.place(first), reason))
}

/// How far points reach along each axis, if that is more than the side of a torus along one.
fn beyond_box(set: &RawPoints, domain: &Domain) -> Option<String> {
    let along =
        |axis: usize| set.coordinates.chunks_exact(set.dim).map(move |point| point[axis]).filter(|x| x.is_finite());
    let reach = |axis| along(axis).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let reaches: Vec<_> = (0..set.dim).map(reach).collect();
    let shown = |(axis, (low, high)): (usize, &(f64, f64))| {
        format!("{} to {} in {}", number(*low), number(*high), ["x", "y", "z"][axis])
    };
    let beyond = reaches.iter().zip(domain.sides()).any(|((low, high), side)| high - low >= *side);
    beyond.then(|| reaches.iter().enumerate().map(shown).collect::<Vec<_>>().join(", "))
}

fn outside(set: &RawPoints, j: usize, axis: usize, x: f64, domain: &Domain) -> Error {
    let name = ["x", "y", "z"][axis];
    let x_text = number(x);
    let (lo, hi) = (domain.origin()[axis], domain.origin()[axis] + domain.sides()[axis]);
    let reason = if !x.is_finite() {
        format!("{name} = {x_text} is not a finite number")
    } else if domain.is_torus()
        && let Some(reach) = beyond_box(set, domain)
    {
        // Folding would put what is far apart side by side: no advice for such points.
        format!(
            "{name} = {x_text} is outside [{lo}, {hi}), and the points reach from {reach}: `window` gives the window they were observed in, \
             `sides` the sides of a larger torus; `wrap` would fold them over each other"
        )
    } else if domain.is_torus() {
        format!(
            "{name} = {x_text} is outside [{lo}, {hi}); `wrap` folds points in, `sides` sets the sides, `window` a window"
        )
    } else {
        format!("{name} = {x_text} is outside the window [{lo}, {hi}]; `window` x0,x1,y0,y1 sets it")
    };
    Error::input(set.place(j), reason)
}

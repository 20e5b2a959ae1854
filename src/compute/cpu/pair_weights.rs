//! What pairs add beside their count: edge-correction weights, products of point weights, and who is deep inside the
//! window. Formulas: see `reference`.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, TAU};

use super::polygon_weights::PolygonWeights;
use crate::accumulate::{BorderHistogram, PairHistogram, WEIGHT_STEPS};
use crate::plan::{Correction, PairPlan};
use crate::points::geometry;

/// What the pairs of one realization need to know about its points beside where they are.
pub(super) struct PointData<'a> {
    /// With border correction, the number of bins whose upper edge is at most the distance of the point from the border.
    depths: Vec<u32>,
    /// With isotropic correction in a polygon, the distances of the points from the border: what no side cuts need not be looked at.
    to_border: Vec<u64>,
    /// Weights of the points, where the plan takes them into account.
    masses: Option<Cow<'a, [f64]>>,
}

impl<'a> PointData<'a> {
    /// Of points at `axes` with weights `masses`.
    pub(super) fn new(plan: &PairPlan, axes: &[&[u64]], masses: Option<&'a [f64]>) -> Self {
        let border = plan.domain.border();
        let to_border = |j: usize| border.distance_of(axes, j);
        let all = |wanted: bool| if wanted { 0..axes[0].len() } else { 0..0 };
        let depths = all(plan.border()).map(|j| geometry::depth(&plan.thresholds, to_border(j)) as u32).collect();
        let cut = plan.correction == Correction::Isotropic && plan.domain.as_polygon().is_some();
        Self { depths, to_border: all(cut).map(to_border).collect(), ..Self::of_masses(plan, axes, masses) }
    }

    /// The same without distances from the border, which weights of pairs do without.
    pub(super) fn of_masses(plan: &PairPlan, axes: &[&[u64]], masses: Option<&'a [f64]>) -> Self {
        let unit = || Cow::Owned(vec![1.0; axes[0].len()]);
        let masses = plan.masses.then(|| masses.map_or_else(unit, Cow::Borrowed));
        Self { depths: Vec::new(), to_border: Vec::new(), masses }
    }

    /// What the weights are compared with.
    pub(super) fn mass_sums(&self) -> Option<[u128; 2]> {
        self.masses.as_deref().map(geometry::mass_sums)
    }
}

/// The weight of any pair of one realization.
pub(super) struct PairWeights<'a> {
    axes: &'a [&'a [u64]],
    data: &'a PointData<'a>,
    correction: Correction,
    polygon: Option<&'a PolygonWeights<'a>>,
    /// In length units, and in steps.
    sides: [f64; 3],
    side_steps: [u64; 3],
}

impl<'a> PairWeights<'a> {
    pub(super) fn new(
        plan: &PairPlan,
        axes: &'a [&'a [u64]],
        data: &'a PointData<'a>,
        polygon: Option<&'a PolygonWeights<'a>>,
    ) -> Self {
        let mut sides = [0.0; 3];
        for (a, side) in sides.iter_mut().zip(plan.domain.sides()) {
            *a = side / plan.domain.length_unit();
        }
        Self { axes, data, correction: plan.correction, polygon, sides, side_steps: plan.domain.side_steps() }
    }

    /// The weights of (i, j) and of (j, i), added: in steps of 2^-32, with weights of points 2^-64.
    #[inline(always)]
    pub(super) fn both(&self, i: usize, j: usize) -> u128 {
        let product = |w: u64| match &self.data.masses {
            Some(masses) => geometry::weighted_pair([masses[i], masses[j]], w),
            None => u128::from(w),
        };
        match self.correction {
            Correction::None | Correction::Border => 2 * product(1 << 32),
            Correction::Translation => 2 * product(self.translation(i, j)),
            Correction::Isotropic => {
                let [a, b] = self.isotropic(i, j);
                product(a) + product(b)
            }
        }
    }

    /// What either order counts without edge weights: 1, or `u_i u_j` in steps of 2^-64.
    #[inline(always)]
    fn plain(&self, i: usize, j: usize) -> u128 {
        self.data.masses.as_ref().map_or(1, |masses| geometry::weighted_pair([masses[i], masses[j]], 1 << 32))
    }

    /// `reference::translation_weight`, operation for operation, with the quotients of sides taken once.
    #[inline(always)]
    fn translation(&self, i: usize, j: usize) -> u64 {
        if let Some(polygon) = self.polygon {
            let place = |j: usize| [0, 1].map(|a| self.axes[a][j]);
            return polygon.translation(place(i), place(j));
        }
        let mut weight = 1.0;
        for (axis, a) in self.axes.iter().zip(self.sides) {
            // Dividing by a power of two and multiplying with its inverse are the same, exact operation.
            let h = axis[i].abs_diff(axis[j]) as f64 * 2f64.powi(-64);
            weight *= a / (a - h);
        }
        (weight * WEIGHT_STEPS).round_ties_even() as u64
    }

    /// `reference::isotropic_weight` from both ends, operation for operation, but for circles that no side cuts.
    #[inline(always)]
    fn isotropic(&self, i: usize, j: usize) -> [u64; 2] {
        let square = |d: u64| u128::from(d) * u128::from(d);
        let r2: u128 = self.axes.iter().map(|axis| square(axis[i].abs_diff(axis[j]))).sum();
        if let Some(polygon) = self.polygon {
            return [i, j].map(|at| {
                let clear = self.data.to_border.get(at).is_some_and(|&d| square(d) >= r2);
                if clear { 1 << 32 } else { polygon.isotropic([0, 1].map(|a| self.axes[a][at]), r2) }
            });
        }
        [i, j].map(|at| {
            let nearest = geometry::border_distance(self.axes, self.side_steps, at);
            if square(nearest) >= r2 { 1 << 32 } else { self.cut_circle(at, r2) }
        })
    }

    /// The isotropic weight of a circle about point `at` that some side cuts.
    fn cut_circle(&self, at: usize, r2: u128) -> u64 {
        let [x, y] = match self.axes {
            [x, y] => [x[at], y[at]],
            // One of two ends is inside.
            _ => return 2 << 32,
        };
        // Squared, the distance to a side and the half chord that it cuts out.
        let side = |d: u64| {
            let d2 = (u128::from(d) * u128::from(d)).min(r2);
            (d2, (d2 as f64).sqrt(), ((r2 - d2) as f64).sqrt())
        };
        let r2_rounded = r2 as f64;
        let (xs, ys) =
            ([x, self.side_steps[0].saturating_sub(x)].map(side), [y, self.side_steps[1].saturating_sub(y)].map(side));
        let mut inside = 0.0;
        for (a2, a, chord_a) in xs {
            for (b2, b, chord_b) in ys {
                if let Some(beyond) = a2.checked_sub(r2 - b2) {
                    let across = (a * b + chord_a * chord_b) * (chord_a * b + a * chord_b);
                    // A quarter that no side cuts is one.
                    inside += if chord_a + chord_b == 0.0 {
                        FRAC_PI_2
                    } else {
                        libm::atan2(beyond as f64 * r2_rounded, across)
                    };
                }
            }
        }
        (TAU / inside * WEIGHT_STEPS).round_ties_even() as u64
    }
}

/// Sums over unordered pairs, of both orders.
pub(super) enum WeightSums {
    /// Of weights.
    Weights(Vec<u128>),
    /// Of pairs seen from deep inside, as in `BorderHistogram`.
    Border { counts: Vec<u128>, ends: Vec<u128> },
}

impl WeightSums {
    /// `None` where pairs are only counted.
    pub(super) fn new(plan: &PairPlan) -> Option<Self> {
        let bins = plan.bins.len();
        if plan.border() {
            return Some(Self::Border { counts: vec![0; bins], ends: vec![0; bins + 1] });
        }
        plan.weighted().then(|| Self::Weights(vec![0; bins]))
    }

    /// Adds the pairs (i, j) and (j, i).
    #[inline(always)]
    pub(super) fn add(&mut self, of: &PairWeights<'_>, bin: usize, i: usize, j: usize) {
        match self {
            Self::Weights(weights) => weights[bin] += of.both(i, j),
            Self::Border { counts, ends } => {
                let pair = of.plain(i, j);
                for depth in [of.data.depths[i] as usize, of.data.depths[j] as usize] {
                    let seen = if depth > bin { pair } else { 0 };
                    counts[bin] += seen;
                    ends[depth] += seen;
                }
            }
        }
    }

    /// The histogram of these points with these sums, leaving nothing.
    pub(super) fn take(&mut self, histogram: PairHistogram, points: &PointData<'_>) -> PairHistogram {
        match self {
            Self::Weights(weights) => {
                let weights = Some(weights.iter_mut().map(std::mem::take).collect());
                PairHistogram { weights, masses: points.mass_sums(), ..histogram }
            }
            Self::Border { counts, ends } => {
                let bins = counts.len();
                let [counts, ends] = [counts, ends].map(|sums| sums.iter_mut().map(std::mem::take).collect());
                let norms = geometry::border_norms(&points.depths, bins, points.masses.as_deref());
                PairHistogram { border: Some(BorderHistogram { counts, ends, norms }), ..histogram }
            }
        }
    }
}

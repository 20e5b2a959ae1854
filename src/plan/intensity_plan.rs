//! The plan for the intensity on a grid: where it is estimated, and by which bandwidth.

use std::f64::consts::{SQRT_2, TAU};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::{Batch, EnsembleShape};
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::points::polygon::Polygon;
use crate::setting::Setting;

/// How the bandwidth of the intensity is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IntensityBandwidth {
    /// This standard deviation, in the domain's length unit.
    Given(f64),
    /// Scott's rule, `n^(-1/(d+4))` times the geometric mean over axes of the standard deviation of the points (Scott 1992, p. 152;
    /// spatstat's `bw.scott` with `isotropic`); on a torus, which has no middle, times that of uniform points, `L / sqrt(12)`.
    Scott,
    /// Likelihood cross-validation (Loader 1999, section 5.3; spatstat's `bw.ppl`).
    Likelihood,
}

impl fmt::Display for IntensityBandwidth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Given(_) => "given",
            Self::Scott => "scott",
            Self::Likelihood => "likelihood",
        })
    }
}

impl std::str::FromStr for IntensityBandwidth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "scott" => Ok(Self::Scott),
            "likelihood" => Ok(Self::Likelihood),
            number => number.parse().map(Self::Given).map_err(|_| "expected a number, scott or likelihood".into()),
        }
    }
}

/// Everything decided about the intensity before any kernel is summed.
#[derive(Debug, Clone, PartialEq)]
pub struct IntensityPlan {
    /// The domain.
    pub domain: Domain,
    /// Cells per axis; the intensity is that at their middles.
    pub cells: usize,
    /// Standard deviation of the Gaussian kernel along each axis.
    pub bandwidth: f64,
    /// Per cell, the last axis fastest, the part of a kernel about its middle that is in the domain, by which the sum of kernels is
    /// divided (Diggle 1985): 1 on a torus, 0 where the middle is outside a polygon.
    pub mass: Arc<[f64]>,
    /// Realizations worked on at a time.
    pub batch: Batch,
    shape: EnsembleShape,
}

/// What a bandwidth is found by.
#[derive(Debug, Clone, PartialEq)]
pub struct IntensitySearch {
    /// The domain.
    pub domain: Domain,
    /// Bandwidths that are tried for `Likelihood`, ascending; none for `Scott`.
    pub bandwidths: Vec<f64>,
    /// Points of a realization whose likelihood is looked at, evenly spread in their order; all others are neighbours only.
    pub points: usize,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

/// Standard deviations beyond which a kernel is cut off: what is lost is below 1e-15 of its peak.
pub(crate) const KERNEL_REACH: f64 = 8.4;

/// Cells together.
const MOST_CELLS: usize = 1 << 24;

/// Bandwidths tried.
const TRIED: usize = 24;

/// Pairs of points over all realizations, for each bandwidth.
const PAIRS: f64 = (1 << 23) as f64;

/// The Gaussian kernel along an axis, of period `side` if it wraps.
fn axis_kernel(distance: f64, bandwidth: f64, side: Option<f64>) -> f64 {
    let at = |x: f64| {
        let z = x / bandwidth;
        if z.abs() > KERNEL_REACH { 0.0 } else { (-0.5 * z * z).exp() / (bandwidth * TAU.sqrt()) }
    };
    let Some(side) = side else { return at(distance) };
    let nearest = distance - side * (distance / side).round();
    let images = (KERNEL_REACH * bandwidth / side + 0.5).floor() as i32;
    (-images..=images).map(|k| at(nearest + f64::from(k) * side)).sum()
}

/// The sum of the kernels of points at a place: both from the lower corner, the points by axis; `but` is left out.
pub(crate) fn kernel_sum(domain: &Domain, bandwidth: f64, place: &[f64], axes: &[Vec<f64>], but: Option<usize>) -> f64 {
    let side = |a: usize| domain.is_torus().then(|| domain.sides()[a]);
    let kernel = |j: usize| {
        let mut product = 1.0;
        for (a, (x, axis)) in place.iter().zip(axes).enumerate() {
            product *= axis_kernel(x - axis[j], bandwidth, side(a));
            if product == 0.0 {
                break;
            }
        }
        product
    };
    let n = axes.first().map_or(0, Vec::len);
    (0..n).filter(|j| Some(*j) != but).map(kernel).sum()
}

/// The part of a Gaussian between two ends.
fn between(at: f64, [low, high]: [f64; 2], bandwidth: f64) -> f64 {
    let z = |x: f64| (x - at) / (bandwidth * SQRT_2);
    0.5 * (libm::erf(z(high)) - libm::erf(z(low)))
}

/// The part of a kernel about a place that is in the domain. Over a polygon it is exact along x, and by Gauss's rule of three nodes
/// along y, in steps of at most a quarter of a bandwidth that end at every vertex: to 1e-7.
pub(crate) struct KernelMass<'a> {
    domain: &'a Domain,
    bandwidth: f64,
    /// Of a polygon, its rows at the nodes, ascending.
    rows: Vec<MassRow>,
}

/// A line through a polygon at a height from its lower corner.
struct MassRow {
    y: f64,
    weight: f64,
    /// Where sides cross it: 1 where the inside is to the left of them, else -1.
    crossings: Vec<(f64, f64)>,
}

impl<'a> KernelMass<'a> {
    pub(crate) fn new(domain: &'a Domain, bandwidth: f64) -> Self {
        let rows = domain.as_polygon().map_or(Vec::new(), |polygon| polygon_rows(polygon, domain.origin(), bandwidth));
        Self { domain, bandwidth, rows }
    }

    /// About a place given from the lower corner of the domain.
    pub(crate) fn at(&self, place: &[f64]) -> f64 {
        match place {
            _ if self.domain.is_torus() => 1.0,
            &[x, y] if self.domain.as_polygon().is_some() => {
                let rows = self.reached(y);
                self.total(y, rows.clone(), &self.along(x, rows))
            }
            _ => place
                .iter()
                .zip(self.domain.sides())
                .map(|(&x, &side)| between(x, [0.0, side], self.bandwidth))
                .product(),
        }
    }

    /// The rows that a kernel at this height reaches.
    fn reached(&self, y: f64) -> Range<usize> {
        let reach = KERNEL_REACH * self.bandwidth;
        self.rows.partition_point(|row| row.y < y - reach)..self.rows.partition_point(|row| row.y <= y + reach)
    }

    /// Per row, the part of a kernel along x that is inside.
    fn along(&self, x: f64, rows: Range<usize>) -> Vec<f64> {
        let part = |&(at, sign): &(f64, f64)| 0.5 * sign * libm::erf((at - x) / (self.bandwidth * SQRT_2));
        self.rows[rows].iter().map(|row| row.crossings.iter().map(part).sum()).collect()
    }

    /// The sum over rows of what is inside along them.
    fn total(&self, y: f64, rows: Range<usize>, along: &[f64]) -> f64 {
        let row = |(row, inside): (&MassRow, &f64)| row.weight * inside * axis_kernel(row.y - y, self.bandwidth, None);
        self.rows[rows].iter().zip(along).map(row).sum()
    }

    /// About the middles of all cells; 0 where they are outside a polygon.
    fn on_grid(&self, plan: &IntensityPlan) -> Vec<f64> {
        let Some(polygon) = self.domain.as_polygon() else {
            let at = |cell: usize| self.at(&plan.middle(cell)[..self.domain.dim()]);
            return (0..plan.cell_count()).into_par_iter().map(at).collect();
        };
        let column = |i: usize| {
            let x = plan.middle_of(0, i);
            let along = self.along(x, 0..self.rows.len());
            let cell = |j: usize| {
                let y = plan.middle_of(1, j);
                let inside = polygon.contains_point([self.domain.origin()[0] + x, self.domain.origin()[1] + y]);
                let rows = self.reached(y);
                if inside { self.total(y, rows.clone(), &along[rows]) } else { 0.0 }
            };
            (0..plan.cells).map(cell).collect::<Vec<_>>()
        };
        (0..plan.cells).into_par_iter().flat_map_iter(column).collect()
    }
}

/// The rows of a polygon at the nodes along y.
fn polygon_rows(polygon: &Polygon, origin: &[f64], bandwidth: f64) -> Vec<MassRow> {
    let from_corner = |v: &[f64; 2]| [v[0] - origin[0], v[1] - origin[1]];
    let rings: Vec<Vec<[f64; 2]>> =
        polygon.parts().iter().flatten().map(|ring| ring.iter().map(from_corner).collect()).collect();
    let mut ends: Vec<f64> = rings.iter().flatten().map(|v| v[1]).collect();
    ends.sort_unstable_by(f64::total_cmp);
    ends.dedup();
    let node = 0.6f64.sqrt();
    let slab = |w: &[f64]| {
        let steps = (4.0 * (w[1] - w[0]) / bandwidth).ceil();
        let (low, half) = (w[0], 0.5 * (w[1] - w[0]) / steps);
        (0..steps as usize).flat_map(move |k| {
            let middle = low + (2 * k + 1) as f64 * half;
            [(-node, 5.0), (0.0, 8.0), (node, 5.0)].map(|(at, weight)| (middle + at * half, half * weight / 9.0))
        })
    };
    let nodes: Vec<(f64, f64)> = ends.windows(2).flat_map(slab).collect();
    let row = |(y, weight): (f64, f64)| {
        let sides = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        // What is inside is on the left of a side.
        let crossing = |(a, b): (&[f64; 2], &[f64; 2])| {
            let x = || a[0] + (b[0] - a[0]) * ((y - a[1]) / (b[1] - a[1]));
            ((a[1] > y) != (b[1] > y)).then(|| (x(), if b[1] > a[1] { 1.0 } else { -1.0 }))
        };
        MassRow { y, weight, crossings: sides.filter_map(crossing).collect() }
    };
    nodes.into_par_iter().map(row).collect()
}

/// Scott's rule of points whose standard deviations multiply to `spread` to the power of d.
pub(crate) fn scott(spread: f64, points: f64, dim: usize) -> f64 {
    spread * points.max(1.0).powf(-1.0 / (dim as f64 + 4.0))
}

impl IntensityPlan {
    /// On so many cells per axis; by default 512 in 1D, 128 in 2D and 32 in 3D. A bandwidth that is still to be found is Scott's of
    /// uniform points until then.
    ///
    /// # Errors
    /// A grid too coarse or too large, a bandwidth that is not above 0 or longer than the longest side.
    pub fn new(
        domain: &Domain,
        cells: Option<usize>,
        bandwidth: IntensityBandwidth,
        shape: EnsembleShape,
    ) -> Result<Self> {
        let dim = domain.dim();
        let cells = cells.unwrap_or([512, 128, 32][dim - 1]);
        let most = (MOST_CELLS as f64).powf(1.0 / dim as f64).round() as usize;
        if !(2..=most).contains(&cells) {
            let reason = format!("expected 2 to {most} cells per axis in {dim}D");
            return Err(Error::setting(Setting::IntensityGrid, cells, reason));
        }
        let bandwidth = Self::bandwidth(domain, bandwidth, shape)?;
        let batch = Batch::new(shape, shape.max_points * 24 + 16 * (cells as u64).pow(dim as u32));
        let plan = Self { domain: domain.clone(), cells, bandwidth, mass: Arc::default(), batch, shape };
        Ok(plan.with_bandwidth(bandwidth))
    }

    /// A bandwidth that is given; one that is still to be found is Scott's of uniform points.
    ///
    /// # Errors
    /// One that is not above 0 or longer than the longest side.
    pub(crate) fn bandwidth(domain: &Domain, bandwidth: IntensityBandwidth, shape: EnsembleShape) -> Result<f64> {
        let longest = domain.sides().iter().copied().fold(0.0, f64::max);
        match bandwidth {
            IntensityBandwidth::Given(bandwidth) if bandwidth > 0.0 && bandwidth <= longest => Ok(bandwidth),
            IntensityBandwidth::Given(bandwidth) => {
                let reason = format!("expected a standard deviation above 0 and at most the longest side, {longest}");
                Err(Error::setting(Setting::IntensityBandwidth, bandwidth, reason))
            }
            _ => Ok(scott(uniform_spread(domain), shape.mean_points, domain.dim())),
        }
    }

    /// The same with another bandwidth.
    pub fn with_bandwidth(&self, bandwidth: f64) -> Self {
        let mass = KernelMass::new(&self.domain, bandwidth).on_grid(self).into();
        Self { bandwidth, mass, ..self.clone() }
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.pow(self.domain.dim() as u32)
    }

    /// The middle of cells along an axis, from the lower corner of the domain.
    pub fn middle_of(&self, axis: usize, index: usize) -> f64 {
        (index as f64 + 0.5) * self.domain.sides()[axis] / self.cells as f64
    }

    /// The middle of a cell, from the lower corner of the domain.
    pub fn middle(&self, cell: usize) -> [f64; 3] {
        let dim = self.domain.dim();
        let along = |a: usize| self.middle_of(a, cell / self.cells.pow((dim - 1 - a) as u32) % self.cells);
        std::array::from_fn(|a| if a < dim { along(a) } else { 0.0 })
    }

    /// The kernel along an axis at a distance.
    pub fn kernel(&self, axis: usize, distance: f64) -> f64 {
        axis_kernel(distance, self.bandwidth, self.domain.is_torus().then(|| self.domain.sides()[axis]))
    }
}

/// The geometric mean of the standard deviations of uniform points in the box.
fn uniform_spread(domain: &Domain) -> f64 {
    domain.sides().iter().product::<f64>().powf(1.0 / domain.dim() as f64) / 12f64.sqrt()
}

impl IntensitySearch {
    /// What a rule must see of the points; `None` where it is decided without.
    pub fn new(domain: &Domain, rule: IntensityBandwidth, shape: EnsembleShape) -> Option<Self> {
        let n = shape.mean_points.max(1.0);
        let bandwidths = match rule {
            IntensityBandwidth::Likelihood => {
                let spacing = (domain.measure() / n).powf(1.0 / domain.dim() as f64);
                let to = 0.25 * domain.shortest_side();
                let from = (0.25 * spacing).min(0.1 * to);
                (0..TRIED).map(|k| from * (to / from).powf(k as f64 / (TRIED - 1) as f64)).collect()
            }
            IntensityBandwidth::Scott if !domain.is_torus() => Vec::new(),
            _ => return None,
        };
        let points = (PAIRS / n / shape.realizations as f64).max(16.0) as usize;
        let batch = Batch::new(shape, shape.max_points * 24);
        Some(Self { domain: domain.clone(), bandwidths, points, batch })
    }
}

impl fmt::Display for IntensitySearch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.bandwidths.first().zip(self.bandwidths.last()) {
            Some((from, to)) => writeln!(
                f,
                "intensity bandwidth: likelihood of {} points at most per realization, each left out, {} bandwidths from {from:.4e} to {to:.4e}",
                self.points,
                self.bandwidths.len()
            ),
            None => writeln!(f, "intensity bandwidth: Scott's rule"),
        }
    }
}

impl fmt::Display for IntensityPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = vec![self.cells.to_string(); self.domain.dim()].join(" x ");
        let edges = if self.domain.is_torus() { "wrapped" } else { "divided by its mass in the window" };
        writeln!(f, "intensity: {list} cells, Gaussian kernel of standard deviation {:.4e}, {edges}", self.bandwidth)?;
        writeln!(f, "  direct sums in f64, kernels cut off at {KERNEL_REACH} standard deviations, on the CPU")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_have_mass_1() {
        for (bandwidth, side) in [(0.1, Some(1.0)), (0.7, Some(1.0)), (0.1, None)] {
            let steps = 4000;
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps) - 0.5;
            let sum: f64 = (0..steps).map(|k| axis_kernel(at(k), bandwidth, side)).sum::<f64>() / f64::from(steps);
            assert!((sum - 1.0).abs() < 1e-6, "{bandwidth} {side:?}: {sum}");
        }
    }

    /// A square that is cut into two parts has the mass of the square.
    #[test]
    fn the_mass_of_a_polygon_is_that_of_its_parts() {
        let ring = |x0: f64, x1: f64| vec![vec![[x0, 0.0], [x1, 0.0], [x1, 1.0], [x0, 1.0]]];
        let tooth = vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.3], [0.0, 1.0]]];
        let rest = vec![vec![[0.0, 1.0], [0.5, 0.3], [1.0, 1.0]]];
        let square = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
        for bandwidth in [0.05, 0.2, 0.9] {
            for place in [[0.5, 0.5], [0.01, 0.97], [0.5, 0.29]] {
                let whole = KernelMass::new(&square, bandwidth).at(&place);
                let polygons = [vec![ring(0.0, 0.25), ring(0.5, 1.0)], vec![tooth.clone()], vec![rest.clone()]]
                    .map(|parts| Domain::polygon(parts).unwrap());
                let mass = |p: &Domain| {
                    KernelMass::new(p, bandwidth).at(&[place[0] - p.origin()[0], place[1] - p.origin()[1]])
                };
                let [two, tooth, rest] = polygons.each_ref().map(mass);
                let gap = between(place[0], [0.25, 0.5], bandwidth) * between(place[1], [0.0, 1.0], bandwidth);
                assert!((two + gap - whole).abs() < 1e-7, "{bandwidth} {place:?}: {two} and {gap} of {whole}");
                assert!((tooth + rest - whole).abs() < 1e-7, "{bandwidth} {place:?}: {tooth} and {rest} of {whole}");
            }
        }
    }
}

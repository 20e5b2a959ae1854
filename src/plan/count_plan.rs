//! The plan for numbers of points in boxes and balls: of which sizes, and where they are put.

use std::fmt;

use super::neighbor_plan::prime_from;
use super::{Batch, EnsembleShape};
use crate::ball::unit_ball;
use crate::named::named;
use crate::points::Domain;

/// What points are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CountShape {
    /// An interval, or a box whose sides are in the proportions of the domain's.
    Box,
    /// A disk or a ball.
    Ball,
}

named!(CountShape: Box = "box", Ball = "ball");

/// A box or a ball of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CountSize {
    /// Which.
    pub shape: CountShape,
    /// The side of a box (the geometric mean of its sides), the radius of a ball.
    pub size: f64,
    /// Length, area or volume.
    pub measure: f64,
    /// The same in the integers that are counted with.
    pub extent: CountExtent,
}

/// A size in integers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountExtent {
    /// An interval of so many fixed-point steps: counted at every place there is.
    Interval(u64),
    /// A box of so many cells along each axis: counted at every place of the lattice of cells.
    Cells(usize),
    /// A ball of so many fixed-point steps, about every centre from which it does not reach out of a window.
    Ball(u64),
}

/// Everything decided about counts before any point is counted.
#[derive(Debug, Clone, PartialEq)]
pub struct CountPlan {
    /// The domain.
    pub domain: Domain,
    /// Sizes of boxes, then of balls, each ascending.
    pub sizes: Vec<CountSize>,
    /// Cells per axis of the lattice of boxes.
    pub cells: usize,
    /// Centres of balls per axis; 1 on axes beyond the dimension.
    pub centers: [u64; 3],
    /// Realizations worked on at a time.
    pub batch: Batch,
}

/// Sizes of balls, and of intervals.
const SIZES: usize = 24;

/// Cells of the lattice of boxes, all together: at least, per point, and at most.
const CELLS: [f64; 3] = [4096.0, 4.0, (1 << 22) as f64];

/// Centres of balls over all realizations together, and at least in each.
const CENTERS: [f64; 2] = [16384.0, 256.0];

/// Pairs of a centre and a point in a realization, at most.
const PAIRS: f64 = (1u64 << 29) as f64;

impl CountPlan {
    /// Of boxes up to half the domain's sides and balls with diameters up to half of the largest that fits.
    pub fn new(domain: &Domain, shape: EnsembleShape) -> Self {
        let dim = domain.dim();
        let spacing = domain.closest_packing_distance(shape.mean_points.max(1.0));
        let step = domain.length_unit() / 2f64.powi(64);
        let root = |x: f64| x.powf(1.0 / dim as f64);
        let side = root(domain.sides().iter().product());
        let steps = |length: f64| ((length / step) as u64).max(1);
        let mut sizes = Vec::new();
        // A prime number per axis, so that a pattern made on a grid is met at all phases, not at a few.
        let cells = prime_from(root(CELLS[0].max(CELLS[1] * shape.mean_points).min(CELLS[2])).ceil() as u64) as usize;
        if dim == 1 {
            sizes.extend(spread(0.25 * spacing, 0.5 * side).map(|length| {
                let length = steps(length);
                let size = length as f64 * step;
                CountSize { shape: CountShape::Box, size, measure: size, extent: CountExtent::Interval(length) }
            }));
        } else {
            sizes.extend(counts_up_to(cells / 2).map(|q| {
                let size = side * q as f64 / cells as f64;
                CountSize {
                    shape: CountShape::Box,
                    size,
                    measure: size.powi(dim as i32),
                    extent: CountExtent::Cells(q),
                }
            }));
            sizes.extend(spread(0.25 * spacing, 0.25 * domain.inner_diameter()).map(|radius| {
                let radius = steps(radius);
                let size = radius as f64 * step;
                let measure = unit_ball(dim) * size.powi(dim as i32);
                CountSize { shape: CountShape::Ball, size, measure, extent: CountExtent::Ball(radius) }
            }));
        }
        let wanted = (CENTERS[0] / shape.realizations as f64).max(CENTERS[1]).min(PAIRS / shape.mean_points.max(1.0));
        let apart = root(domain.sides().iter().product::<f64>() / wanted);
        let centers =
            std::array::from_fn(|a| domain.sides().get(a).map_or(1, |side| prime_from((side / apart).ceil() as u64)));
        // Keys of an axis and its events; cells of counts, of their sums and of places.
        let lattice = if dim == 1 { 0 } else { 16 * (cells as u64).pow(dim as u32) };
        let batch = Batch::new(shape, shape.max_points * 48 + lattice + 48 * sizes.len() as u64);
        Self { domain: domain.clone(), sizes, cells, centers, batch }
    }

    /// Number of centres of balls.
    pub fn center_count(&self) -> usize {
        self.centers.iter().product::<u64>() as usize
    }

    /// Centre `index` of a realization, in fixed-point steps.
    pub fn center(&self, realization: u64, index: usize) -> [u64; 3] {
        let (mut rest, sides) = (index as u64, self.domain.side_steps());
        std::array::from_fn(|a| {
            let count = u128::from(self.centers[a]);
            let i = u128::from(rest % self.centers[a]);
            rest /= self.centers[a];
            if a >= self.domain.dim() {
                return 0;
            }
            let side = if sides[a] == 0 { 1 << 64 } else { u128::from(sides[a]) };
            let shift = u128::from(random(realization, 3 + a as u64));
            ((i * side) / count + ((side * shift) >> 64) / count) as u64
        })
    }

    /// How far the lattice of cells is shifted along an axis in a realization: of 2^64 for the side, less than a cell and not 0.
    pub fn cell_shift(&self, realization: u64, axis: usize) -> u64 {
        (random(realization, axis as u64) / self.cells as u64).max(1)
    }

    /// The ends of cell `index` along an axis in a realization, in fixed-point steps. In a window the last cell is cut by the end.
    pub fn cell_ends(&self, realization: u64, axis: usize, index: usize) -> [f64; 2] {
        let shift = self.cell_shift(realization, axis) as f64 * 2f64.powi(-64);
        let side = self.domain.side_steps()[axis] as f64;
        [index, index + 1].map(|i| (shift + i as f64 / self.cells as f64) * side)
    }
}

/// Lengths from one to another, as if on a ruler of logarithms; the smallest at most an eighth of the largest.
fn spread(from: f64, to: f64) -> impl Iterator<Item = f64> {
    let from = from.min(0.125 * to);
    (0..SIZES).map(move |k| from * (to / from).powf(k as f64 / (SIZES - 1) as f64))
}

/// 1, 2, 3, 4, 6, 8, 12, 16 ... up to a number.
fn counts_up_to(most: usize) -> impl Iterator<Item = usize> {
    let all = (0..usize::BITS - 2).flat_map(|k| [1 << k, if k == 0 { 0 } else { 3 << (k - 1) }]);
    all.filter(|&q| q > 0).take_while(move |&q| q <= most.max(1))
}

/// Number `which` of a realization: SplitMix64 (Steele, Lea, Flood 2014), the same on every machine.
fn random(realization: u64, which: u64) -> u64 {
    let mut z = (6 * realization + which + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl fmt::Display for CountPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (dim, sizes) = (self.domain.dim(), |shape| self.sizes.iter().filter(move |s| s.shape == shape).count());
        if dim == 1 {
            return writeln!(
                f,
                "counts: intervals of {} sizes, at every place (exact integrals)",
                sizes(CountShape::Box)
            );
        }
        let list = |n: &dyn Fn(usize) -> String| (0..dim).map(n).collect::<Vec<_>>().join(" x ");
        let (cells, centers) = (list(&|_| self.cells.to_string()), list(&|a| self.centers[a].to_string()));
        writeln!(
            f,
            "counts: boxes of {} sizes on a lattice of {cells} cells, balls of {} about {centers} centres",
            sizes(CountShape::Box),
            sizes(CountShape::Ball)
        )?;
        writeln!(f, "  both lattices shifted at random per realization; exact integers, on the CPU")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_ascend_and_lattices_fill_the_box() {
        let shape = EnsembleShape { realizations: 3, mean_points: 100.0, max_points: 100 };
        for domain in [
            Domain::unit_torus(1),
            Domain::torus(&[1.0, 0.3]).unwrap(),
            Domain::window(&[(-3.0, 4.0), (10.0, 12.0), (0.0, 1.0)]).unwrap(),
        ] {
            let plan = CountPlan::new(&domain, shape);
            for shape in [CountShape::Box, CountShape::Ball] {
                let measures: Vec<f64> = plan.sizes.iter().filter(|s| s.shape == shape).map(|s| s.measure).collect();
                assert!(measures.windows(2).all(|w| w[0] < w[1]), "{domain}: {measures:?}");
                assert!(measures.last().is_none_or(|m| *m < 0.6 * domain.measure()));
            }
            let unit = domain.length_unit() / 2f64.powi(64);
            for (a, &side) in domain.sides().iter().enumerate() {
                let m = plan.centers[a];
                let mut places: Vec<u64> = (0..plan.center_count()).map(|i| plan.center(7, i)[a]).collect();
                places.sort_unstable();
                places.dedup();
                assert_eq!(places.len() as u64, m, "{domain}");
                let gaps = places.windows(2).map(|w| (w[1] - w[0]) as f64 * unit * m as f64 / side);
                gaps.for_each(|gap| assert!((gap - 1.0).abs() < 1e-9, "{gap}"));
                assert!(places[0] as f64 * unit < side / m as f64 && *places.last().unwrap() as f64 * unit < side);
                assert!(plan.cell_shift(7, a) <= u64::MAX / plan.cells as u64);
            }
        }
        assert_eq!(counts_up_to(17).collect::<Vec<_>>(), [1, 2, 3, 4, 6, 8, 12, 16]);
    }

    /// The first numbers of the generator with seed 0, as published.
    #[test]
    fn the_generator_is_splitmix64() {
        assert_eq!([random(0, 0), random(0, 1)], [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4]);
    }
}

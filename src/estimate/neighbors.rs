//! Nearest-neighbour distances.
//!
//! For each point of a realization the distance to the nearest other point, `d_i = min_(j != i) |x_i - x_j|` (minimum image
//! on a torus, plain in a window, no edge correction: near the edge of a window d_i is too long on average). Reported
//! are the least d_i and their mean, also relative to the distance in the closest packing of as many points (Lagae,
//! Dutre, "A Comparison of Methods for Generating Poisson Disk Distributions", CGF 2008).
//!
//! Which point is nearest is decided in the integers of the ensemble, as in `compute::reference`: a k-d tree in f64 proposes
//! candidates, and exact squared distances choose. Only the final root is rounded.

use std::cmp::Ordering;

use kd_tree::{KdPoint, KdTreeN};
use rayon::prelude::*;

use crate::compute::Control;
use crate::compute::reference::squared_distance;
use crate::error::{Error, Result};
use crate::points::{Domain, Ensemble};

/// Nearest-neighbour distances realization by realization, in the order of their index. A merge of parts equals the whole,
/// bit for bit, however the batch was cut.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct NearestNeighbors {
    realizations: Vec<RealizationNeighbors>,
}

/// Nearest-neighbour distances of one realization.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct RealizationNeighbors {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// The distances; `None` with fewer than two points, where there is no neighbour.
    pub distances: Option<Distances>,
}

/// Distances within one realization, in the domain's units.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Distances {
    /// Distance of the closest pair.
    pub minimum: f64,
    /// Mean over points of the distance to the nearest other point.
    pub mean: f64,
    /// Distance of neighbours in the closest packing of n points, `d_hex`.
    pub closest_packing: f64,
}

/// Nearest-neighbour distances of a batch, over the realizations that have two points or more.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct NeighborDistances {
    /// Smallest over all realizations, in the domain's length unit; `None` if no realization has two points.
    pub minimum: Option<f64>,
    /// Mean over realizations of the mean over the points of each. Every realization counts alike, whatever its n: not the
    /// sum of all distances over the number of all points, unlike the ratios of sums elsewhere in `estimate`.
    pub mean: Option<f64>,
    /// Standard error of `mean` across realizations (K >= 2).
    pub mean_se: Option<f64>,
    /// Smallest over realizations of the minimum in units of the closest-packing distance of the realization's n.
    pub minimum_relative: Option<f64>,
    /// Mean over realizations, likewise, of the mean in units of the closest-packing distance of the realization's n.
    pub mean_relative: Option<f64>,
}

/// Nearest-neighbour distances of every realization.
pub fn neighbor_distances(ensemble: &Ensemble, control: &Control) -> Result<NearestNeighbors> {
    let domain = ensemble.domain();
    let realizations = (0..ensemble.realizations()).into_par_iter().map(|k| {
        control.check()?;
        let squares = nearest_squares(&ensemble.lengths(k), domain, control)?;
        let n = squares.len() as f64;
        let step = domain.length_unit() / 2f64.powi(64);
        let distances = squares.iter().min().map(|&minimum| Distances {
            minimum: (minimum as f64).sqrt() * step,
            // `squares` has one order, whatever threads found them.
            mean: squares.iter().map(|&square| (square as f64).sqrt()).sum::<f64>() / n * step,
            closest_packing: domain.closest_packing_distance(n),
        });
        Ok(RealizationNeighbors {
            index: ensemble.first_index() + k as u64,
            n: ensemble.points_in(k) as u64,
            distances,
        })
    });
    Ok(NearestNeighbors { realizations: realizations.collect::<Result<_>>()? })
}

impl NearestNeighbors {
    /// Per realization, ordered by index.
    pub fn realizations(&self) -> &[RealizationNeighbors] {
        &self.realizations
    }

    /// Adds other realizations of the same process.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        // Batches mostly come in order, one after the other.
        let follows = self.realizations.last().map(|r| r.index) < other.realizations.first().map(|r| r.index);
        if follows {
            self.realizations.extend_from_slice(&other.realizations);
            return Ok(());
        }
        let mut merged = [self.realizations.as_slice(), &other.realizations].concat();
        merged.sort_by_key(|r| r.index);
        if let Some(twice) = merged.windows(2).find(|w| w[0].index == w[1].index) {
            let reason = format!("both parts hold realization {}", twice[0].index);
            return Err(Error::input("neighbor distances", reason));
        }
        self.realizations = merged;
        Ok(())
    }

    /// The whole batch in a few numbers.
    pub fn summary(&self) -> NeighborDistances {
        let all: Vec<Distances> = self.realizations.iter().filter_map(|r| r.distances).collect();
        let least = |f: fn(&Distances) -> f64| all.iter().map(f).reduce(f64::min);
        let means: Vec<f64> = all.iter().map(|d| d.mean).collect();
        NeighborDistances {
            minimum: least(|d| d.minimum),
            mean: mean(&means),
            mean_se: standard_error(&means),
            minimum_relative: least(|d| d.minimum / d.closest_packing),
            mean_relative: mean(&all.iter().map(|d| d.mean / d.closest_packing).collect::<Vec<_>>()),
        }
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Of the mean, from the spread of the values; `None` for fewer than two.
fn standard_error(values: &[f64]) -> Option<f64> {
    let mean = mean(values).filter(|_| values.len() >= 2)?;
    let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    let k = values.len() as f64;
    Some((squares / (k * (k - 1.0))).sqrt())
}

/// Per point the exact squared distance to its nearest neighbour in squared
/// steps; empty with fewer than two points.
fn nearest_squares(axes: &[&[u64]], domain: &Domain, control: &Control) -> Result<Vec<u128>> {
    let n = axes[0].len();
    if n < 2 {
        return Ok(Vec::new());
    }
    // Fewer points than this are compared all with all: no slower, and `KdSliceN::nearests` finds one point instead of
    // two in a tree of two.
    if n < 16 {
        let nearest = |i| (0..n).filter(|&j| j != i).map(|j| squared_distance(axes, domain.periods(), i, j)).min();
        return Ok((0..n).filter_map(nearest).collect());
    }
    match axes.len() {
        1 => Search::<1>::new(axes, domain).run(control),
        2 => Search::<2>::new(axes, domain).run(control),
        _ => Search::<3>::new(axes, domain).run(control),
    }
}

struct Site<const D: usize> {
    steps: [u64; D],
    index: usize,
}

/// A k-d tree over the integers of a realization. The crate's searches take any coordinate of an item through a closure,
/// and there `coordinate of the item - coordinate of the query` is taken in integers before it becomes an f64: relative
/// error 2^-53 however close the points are and wherever they lie.
struct Search<'a, const D: usize>
where
    [f64; D]: KdPoint<Scalar = f64>,
{
    axes: &'a [&'a [u64]],
    periods: [u64; 3],
    is_torus: bool,
    tree: KdTreeN<Site<D>, <[f64; D] as KdPoint>::Dim>,
}

impl<'a, const D: usize> Search<'a, D>
where
    [f64; D]: KdPoint<Scalar = f64>,
    <[f64; D] as KdPoint>::Dim: Sync,
{
    fn new(axes: &'a [&'a [u64]], domain: &Domain) -> Self {
        let site = |index| Site { steps: std::array::from_fn(|a| axes[a][index]), index };
        let sites = (0..axes[0].len()).map(site).collect();
        Self {
            axes,
            periods: domain.periods(),
            is_torus: domain.is_torus(),
            tree: KdTreeN::build_by_key(sites, |site, a| site.steps[a]),
        }
    }

    fn run(&self, control: &Control) -> Result<Vec<u128>> {
        // Searched in the order of the tree, where queries that follow one another walk the same nodes.
        let parts: Vec<Vec<u128>> = self
            .tree
            .items()
            .par_chunks(512)
            .map(|sites| {
                control.check()?;
                Ok(sites.iter().map(|site| self.nearest_square(site)).collect())
            })
            .collect::<Result<_>>()?;
        let mut squares = vec![0; self.axes[0].len()];
        for (site, square) in self.tree.items().iter().zip(parts.into_iter().flatten()) {
            squares[site.index] = square;
        }
        Ok(squares)
    }

    fn nearest_square(&self, site: &Site<D>) -> u128 {
        let exact = |j: usize| squared_distance(self.axes, self.periods, site.index, j);
        // Two, as one of them is the point itself. What lies beyond the reach is put infinitely far away, so that the tree
        // leaves it out: seen from an image far from all points, they are about equally far, and no distance found
        // among them would exclude the others.
        let propose = |image: [i8; D], reach: f64| {
            let offset = |item: &Site<D>, a| match self.offset(item, site, image, a) {
                offset if offset.abs() <= reach => offset,
                offset => f64::INFINITY.copysign(offset),
            };
            let found = self.tree.nearests_by(&[0.0; D], 2, offset);
            found.into_iter().map(|f| f.item.index).filter(|&j| j != site.index).map(exact).min()
        };
        let mut best = propose([0; D], f64::INFINITY).unwrap_or(u128::MAX);
        if best == 0 {
            return 0;
        }
        for image in self.images_within(site, best) {
            let reach = (best as f64).sqrt() * (1.0 + 1e-14);
            best = propose(image, reach).map_or(best, |square| square.min(best));
        }
        // The proposals are nearest up to the rounding of f64, some 1e-15 of the squared distance: enough to confuse the
        // neighbours of a lattice. The exact minimum is among the points that close.
        let radius = (best as f64).sqrt() * (1.0 + 1e-14);
        for image in std::iter::once([0; D]).chain(self.images_within(site, best)) {
            let close = self.tree.within_by_cmp(|item, a| match self.offset(item, site, image, a) {
                offset if offset < -radius => Ordering::Less,
                offset if offset > radius => Ordering::Greater,
                _ => Ordering::Equal,
            });
            for j in close.into_iter().map(|item| item.index).filter(|&j| j != site.index) {
                best = best.min(exact(j));
            }
        }
        best
    }

    /// From the `image`-th periodic image of `site` to `item`, along axis `a`, in steps.
    fn offset(&self, item: &Site<D>, site: &Site<D>, image: [i8; D], a: usize) -> f64 {
        let (to, from) = (item.steps[a], site.steps[a]);
        match image[a] {
            0 if to >= from => (to - from) as f64,
            0 => -((from - to) as f64),
            turns => (i128::from(to) - i128::from(from) - i128::from(turns) * self.period(a)) as f64,
        }
    }

    /// The images of `site`, itself excepted, whose ball of squared radius `square` reaches into the box.
    fn images_within(&self, site: &Site<D>, square: u128) -> impl Iterator<Item = [i8; D]> + use<D> {
        let radius = (square as f64).sqrt() * (1.0 + 1e-14);
        let needed: [[bool; 3]; D] = std::array::from_fn(|a| {
            // The image a period higher is near the box if the point is near the low end, and the other way round.
            let (to_low, to_high) = (site.steps[a] as f64, (self.period(a) - i128::from(site.steps[a])) as f64);
            [self.is_torus && to_high <= radius, true, self.is_torus && to_low <= radius]
        });
        (0..3usize.pow(D as u32)).filter_map(move |code| {
            let digit = |a: usize| code / 3usize.pow(a as u32) % 3;
            let wanted = (0..D).all(|a| needed[a][digit(a)]);
            let image = std::array::from_fn(|a| digit(a) as i8 - 1);
            (wanted && image != [0; D]).then_some(image)
        })
    }

    fn period(&self, a: usize) -> i128 {
        if self.periods[a] == 0 { 1 << 64 } else { i128::from(self.periods[a]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::reference::squared_distance;
    use crate::points::RawPoints;
    use crate::samplers::{ParameterValues, Realization, find};

    fn raw(dim: usize, coordinates: Vec<f64>) -> RawPoints {
        RawPoints { dim, coordinates, source: "test".into(), lines: Vec::new() }
    }

    fn one(domain: &Domain, coordinates: Vec<f64>) -> Ensemble {
        Ensemble::from_raw(&[raw(domain.dim(), coordinates)], domain, domain.is_torus(), 0).unwrap()
    }

    fn sample(name: &str, param: &[&str], n: u64, dim: usize) -> Vec<f64> {
        let sampler = find(name).unwrap();
        let values = ParameterValues::parse(sampler, param).unwrap();
        sampler.generate(&Realization { n, dim, seed: 3, index: 0 }, &values).unwrap()
    }

    /// The same integers as a comparison of all points with all, not a tolerance apart.
    fn assert_exact(what: &str, domain: &Domain, coordinates: Vec<f64>) {
        let ensemble = one(domain, coordinates);
        let axes = ensemble.lengths(0);
        let n = axes[0].len();
        let found = nearest_squares(&axes, domain, &Control::default()).unwrap();
        let all =
            |i| (0..n).filter(|&j| j != i).map(|j| squared_distance(&axes, domain.periods(), i, j)).min().unwrap();
        let expected: Vec<u128> = (0..n).map(all).collect();
        assert!(found == expected, "{what} in {domain:?}");
    }

    fn domains(dim: usize) -> Vec<Domain> {
        // Sides with full mantissas; one torus so thin that balls reach around it.
        let sides = [1.0, 0.712_345_678_901, 1.234_567_890_123];
        let thin = [1.0, 0.001_234_567_890_1, 0.3];
        vec![
            Domain::unit_torus(dim),
            Domain::torus(&sides[..dim]).unwrap(),
            Domain::torus(&thin[..dim]).unwrap(),
            Domain::window(&[(-0.1, 1.1), (0.0, 1.7), (5.0, 5.3)][..dim]).unwrap(),
        ]
    }

    fn into(domain: &Domain, unit: &[f64]) -> Vec<f64> {
        let place = |(i, x): (usize, &f64)| {
            let a = i % domain.dim();
            domain.origin()[a] + x * domain.sides()[a]
        };
        unit.iter().enumerate().map(place).collect()
    }

    #[test]
    fn equals_all_pairs_in_every_domain() {
        let processes: &[(&str, &[&str], u64)] = &[
            ("random", &[], 15),
            ("random", &[], 16),
            ("random", &[], 17),
            ("random", &[], 1000),
            ("thomas", &["mu=30", "sigma=0.001"], 1000),
            ("poisson-disk", &[], 500),
            ("halton", &[], 900),
        ];
        for dim in 1..=3 {
            for domain in domains(dim) {
                for &(name, param, n) in processes {
                    assert_exact(name, &domain, into(&domain, &sample(name, param, n, dim)));
                }
            }
        }
    }

    /// All neighbours tie up to the rounding of the coordinates: a tree that compared f64 squares could not tell them apart.
    #[test]
    fn equals_all_pairs_on_lattices() {
        for (dim, n) in [(1, 1000), (2, 900), (3, 1000)] {
            for domain in domains(dim) {
                for shift in ["shift=none", "shift=random"] {
                    assert_exact(shift, &domain, into(&domain, &sample("grid", &[shift], n, dim)));
                }
            }
        }
    }

    #[test]
    fn equals_all_pairs_of_points_a_few_steps_apart() {
        // Clusters 2^-50 .. 2^-64 wide around corners and centre, some across the boundary.
        for dim in 1..=3 {
            let mut points = Vec::new();
            for i in 0..400u32 {
                let tiny = 2f64.powi(-50 - (i % 15) as i32) * f64::from(i % 7 + 1);
                for a in 0..dim as u32 {
                    points.push(match (i >> a) % 4 {
                        0 => tiny,
                        1 => 1.0 - 2f64.powi(-53) * f64::from(i % 9 + 1),
                        2 => 0.5 + tiny,
                        _ => 1.0 / 3.0 + tiny,
                    });
                }
            }
            // On unequal sides the integers have up to 64 significant bits: a difference of f64 would lose 11.
            for domain in domains(dim).into_iter().filter(Domain::is_torus) {
                assert_exact("tiny clusters", &domain, into(&domain, &points));
            }
        }
    }

    /// Fractions of the sides of degenerate patterns: most points on or next to a side or corner of the box, all of them on
    /// a line or in a strip.
    fn degenerate(dim: usize, n: usize) -> Vec<(&'static str, Vec<f64>)> {
        let random = sample("random", &[], n as u64, dim);
        let last = 1.0 - 2f64.powi(-53);
        let along = |f: &dyn Fn(usize, usize, f64) -> f64| -> Vec<f64> {
            random.iter().enumerate().map(|(k, &x)| f(k / dim, k % dim, x)).collect()
        };
        vec![
            ("line at the low side", along(&|_, a, x| if a == 0 { x } else { 0.0 })),
            ("line at the high side", along(&|_, a, x| if a == 0 { x } else { last })),
            ("line across the middle", along(&|_, a, x| if a == dim - 1 { x } else { 0.5 })),
            ("even line at the low side", along(&|i, a, _| if a == 0 { i as f64 / n as f64 } else { 0.0 })),
            ("axes through the corner", along(&|i, a, x| if a == i % dim { x } else { 0.0 })),
            ("diagonal", along(&|i, _, _| random[i * dim])),
            ("plane at the low side", along(&|_, a, x| if a < dim - 1 { x } else { 0.0 })),
            ("strip at the low side", along(&|_, a, x| if a == 0 { x } else { 1e-9 * x })),
            ("strip at the high side", along(&|_, a, x| if a == 0 { x } else { (1.0 - 1e-9 * x).min(last) })),
            // One in a hundred on the other side of the seam.
            (
                "strip across the side",
                along(&|i, a, x| match (a, i % 100) {
                    (0, _) => x,
                    (_, 0) => (1.0 - 1e-9 * x).min(last),
                    _ => 1e-9 * x,
                }),
            ),
            (
                "clusters at the corners",
                along(&|i, a, x| {
                    let tail = x.powi(40);
                    if i >> a & 1 == 0 { tail } else { (1.0 - tail).min(last) }
                }),
            ),
        ]
    }

    #[test]
    fn equals_all_pairs_on_lines_and_in_strips() {
        for dim in 1..=3 {
            for domain in domains(dim) {
                for (what, points) in degenerate(dim, 2000) {
                    assert_exact(what, &domain, into(&domain, &points));
                }
            }
        }
    }

    /// Would not end if one search looked at most of the points.
    #[test]
    fn lines_and_strips_of_many_points_are_searched() {
        let n = 10_000;
        for dim in 1..=3 {
            for domain in domains(dim).into_iter().step_by(2) {
                for (what, points) in degenerate(dim, n) {
                    let ensemble = one(&domain, into(&domain, &points));
                    let axes = ensemble.lengths(0);
                    let found = nearest_squares(&axes, &domain, &Control::default()).unwrap();
                    for i in (0..n).step_by(n / 20) {
                        let others = (0..n).filter(|&j| j != i);
                        let expected = others.map(|j| squared_distance(&axes, domain.periods(), i, j)).min();
                        assert_eq!(Some(found[i]), expected, "{what} in {domain:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn threads_do_not_change_the_result() {
        let domain = Domain::torus(&[1.0, 0.7]).unwrap();
        let ensemble = one(&domain, into(&domain, &sample("thomas", &["mu=30", "sigma=0.01"], 10_000, 2)));
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| neighbor_distances(&ensemble, &Control::default()).unwrap())
        };
        assert_eq!(with(1), with(5));
    }

    #[test]
    fn duplicates_are_fast_and_zero() {
        for dim in 1..=3 {
            for domain in domains(dim) {
                let equal = one(&domain, into(&domain, &vec![0.25; 200_000 * dim]));
                let summary = neighbor_distances(&equal, &Control::default()).unwrap().summary();
                assert_eq!((summary.minimum, summary.mean, summary.mean_se), (Some(0.0), Some(0.0), None));
                // One point alone, far from a hundred thousand equal ones.
                let mut but_one = vec![0.25; 100_000 * dim];
                but_one[..dim].fill(0.75);
                let but_one = one(&domain, into(&domain, &but_one));
                let found = neighbor_distances(&but_one, &Control::default()).unwrap().summary().mean.unwrap();
                let expected = squared_distance(&but_one.lengths(0), domain.periods(), 0, 1) as f64;
                let mean = expected.sqrt() * domain.length_unit() / 2f64.powi(64) / 1e5;
                assert!((found / mean - 1.0).abs() < 1e-15, "{dim}D: {} against {mean}", found);
            }
        }
    }

    #[test]
    fn the_numbers_of_small_cases() {
        let domain = Domain::torus(&[4.0, 2.0]).unwrap();
        let none = raw(2, vec![]);
        let single = raw(2, vec![1.0, 1.0]);
        // Across the boundary: 1 apart in x, 0 in y.
        let pair = raw(2, vec![0.25, 1.0, 3.25, 1.0]);
        // 0.5 and 0.5 apart in y, the third sees the second.
        let triple = raw(2, vec![1.0, 0.0, 1.0, 0.5, 1.0, 1.25]);
        let ensemble = Ensemble::from_raw(&[none, single, pair, triple], &domain, false, 10).unwrap();
        let whole = neighbor_distances(&ensemble, &Control::default()).unwrap();
        let [none, single, pair, triple] = whole.realizations() else { panic!("four realizations") };
        assert_eq!((none.index, none.n, none.distances), (10, 0, None));
        assert_eq!((single.index, single.n, single.distances), (11, 1, None));
        let distances = |minimum, mean, n: f64| {
            Some(Distances { minimum, mean, closest_packing: (2.0 / (3f64.sqrt() * n / 8.0)).sqrt() })
        };
        assert_eq!((pair.n, pair.distances), (2, distances(1.0, 1.0, 2.0)));
        assert_eq!((triple.n, triple.distances), (3, distances(0.5, 1.75 / 3.0, 3.0)));
        let summary = whole.summary();
        assert_eq!((summary.minimum, summary.mean), (Some(0.5), Some((1.0 + 1.75 / 3.0) / 2.0)));
        // Two values a and b: |a - b| / 2.
        let error = summary.mean_se.unwrap();
        assert!((error - (1.0 - 1.75 / 3.0) / 2.0).abs() < 1e-15, "{error}");
        assert_eq!(summary.minimum_relative, Some(0.5 / triple.distances.unwrap().closest_packing));
        let relative = [pair, triple].map(|r| r.distances.map(|d| d.mean / d.closest_packing).unwrap());
        assert_eq!(summary.mean_relative, Some((relative[0] + relative[1]) / 2.0));

        let nobody = neighbor_distances(&ensemble.slice(0..2), &Control::default()).unwrap();
        assert_eq!(nobody.summary(), NeighborDistances::default());
        let alone = neighbor_distances(&ensemble.slice(1..3), &Control::default()).unwrap();
        assert_eq!((alone.summary().mean, alone.summary().mean_se), (Some(1.0), None));

        let mut parts = neighbor_distances(&ensemble.slice(2..4), &Control::default()).unwrap();
        assert!(parts.merge(&alone).unwrap_err().to_string().contains("both parts hold realization 12"));
        parts.merge(&nobody).unwrap();
        assert_eq!(parts, whole);
    }

    #[test]
    fn random_points_have_the_mean_of_a_poisson_process() {
        // 1 / (2 sqrt(lambda)) for n to infinity; with n - 1 others Gamma(n) / (2 Gamma(n + 1/2)), 1 + 1/(8 n) times that.
        let sampler = find("random").unwrap();
        let values = ParameterValues::defaults(sampler).unwrap();
        let control = Control::default();
        let n = 2000;
        let ensemble = crate::samplers::ensemble(sampler, n, 2, 1, 0..200, &values, &control).unwrap();
        let found = neighbor_distances(&ensemble, &control).unwrap().summary();
        let expected = 0.5 / (n as f64).sqrt() * (1.0 + 1.0 / 8.0 / n as f64);
        let z = (found.mean.unwrap() - expected) / found.mean_se.unwrap();
        assert!(z.abs() < 4.0, "{z} standard errors off");
    }

    #[test]
    fn stops_when_asked() {
        let control = Control::default();
        control.cancel();
        let ensemble = one(&Domain::unit_torus(2), sample("random", &[], 100, 2));
        assert!(matches!(neighbor_distances(&ensemble, &control), Err(Error::Cancelled)));
    }
}

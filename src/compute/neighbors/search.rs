//! Exact nearest-neighbour distances.
//!
//! Which point is nearest is decided in the integers of the ensemble, as in `compute::reference`: a k-d tree in f64 proposes
//! candidates, and exact squared distances choose.

use std::cmp::Ordering;

use kd_tree::{KdPoint, KdTreeN};
use rayon::prelude::*;

use crate::control::Control;
use crate::error::Result;
use crate::plan::NeighborPlan;
use crate::points::Domain;
use crate::points::geometry::minimum_image;

/// Exact squared distances in squared steps; `u128::MAX` where there is no point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Nearest {
    /// From each point to the nearest other point, or the nearest of another class.
    pub(super) of_points: Vec<u128>,
    /// From each test point to the nearest point.
    pub(super) of_probes: Vec<u128>,
}

impl Nearest {
    /// Of the points of one realization and the test points of the plan, which is `part` of the piece of work at hand. With
    /// `from`, from those points to `axes`.
    pub(super) fn find(
        plan: &NeighborPlan,
        from: Option<&[&[u64]]>,
        axes: &[&[u64]],
        part: f64,
        control: &Control,
    ) -> Result<Self> {
        match axes.len() {
            1 => Self::find_in::<1>(plan, from, axes, part, control),
            2 => Self::find_in::<2>(plan, from, axes, part, control),
            _ => Self::find_in::<3>(plan, from, axes, part, control),
        }
    }

    fn find_in<const D: usize>(
        plan: &NeighborPlan,
        from: Option<&[&[u64]]>,
        axes: &[&[u64]],
        part: f64,
        control: &Control,
    ) -> Result<Self>
    where
        [f64; D]: KdPoint<Scalar = f64>,
        <[f64; D] as KdPoint>::Dim: Sync,
    {
        let search = Search::<D>::new(axes, &plan.domain);
        let to_nearest = |count: usize, place: &(dyn Fn(usize) -> [u64; D] + Sync)| {
            let each = (0..count).into_par_iter().with_min_len(CHUNK).map(|i| {
                if i.is_multiple_of(CHUNK) {
                    control.check()?;
                }
                Ok(search.nearest(&Site { steps: place(i), index: NOBODY }).square)
            });
            each.collect::<Result<Vec<_>>>()
        };
        let of_probes = to_nearest(plan.probes.len(), &|i| {
            let position = plan.probes.position(i);
            std::array::from_fn(|a| position[a])
        })?;
        let of_points = match from {
            Some(from) => to_nearest(from[0].len(), &|i| std::array::from_fn(|a| from[a][i]))?,
            None => search.of_points(axes[0].len(), part, control)?.into_iter().map(|near| near.square).collect(),
        };
        Ok(Self { of_points, of_probes })
    }
}

/// Per point of a realization, the index of the nearest other; `None` for a lone point. Of several at the same distance the
/// one with the lowest index, unless points coincide.
pub(super) fn partners(domain: &Domain, axes: &[&[u64]], control: &Control) -> Result<Vec<Option<usize>>> {
    let of_points = match axes {
        [x] => Search::<1>::new(axes, domain).of_points(x.len(), 0.0, control),
        [x, _] => Search::<2>::new(axes, domain).of_points(x.len(), 0.0, control),
        _ => Search::<3>::new(axes, domain).of_points(axes[0].len(), 0.0, control),
    }?;
    Ok(of_points.into_iter().map(|near| (near.index != NOBODY).then_some(near.index)).collect())
}

/// The nearest point: its exact squared distance, then its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Near {
    square: u128,
    index: usize,
}

/// No point at all.
const NONE: Near = Near { square: u128::MAX, index: NOBODY };

/// The index of a site that is none of the points.
const NOBODY: usize = usize::MAX;

/// Searches between two looks at the control.
const CHUNK: usize = 512;

#[derive(Clone, Copy)]
struct Site<const D: usize> {
    steps: [u64; D],
    index: usize,
}

/// A k-d tree over the integers of a realization. The crate's searches take any coordinate of an item through a closure,
/// and there `coordinate of the item - coordinate of the query` is taken in integers before it becomes an f64: relative
/// error 2^-53 however close the points are and wherever they lie.
pub(super) struct Search<const D: usize>
where
    [f64; D]: KdPoint<Scalar = f64>,
{
    periods: [u64; 3],
    is_torus: bool,
    /// Points that coincide: the one in the tree, and the other.
    coincident: Vec<[usize; 2]>,
    /// Every place once: a tree cannot tell equal points apart, and a test point would meet all of them.
    tree: KdTreeN<Site<D>, <[f64; D] as KdPoint>::Dim>,
}

impl<const D: usize> Search<D>
where
    [f64; D]: KdPoint<Scalar = f64>,
    <[f64; D] as KdPoint>::Dim: Sync,
{
    pub(super) fn new(axes: &[&[u64]], domain: &Domain) -> Self {
        let site = |index| Site { steps: std::array::from_fn(|a| axes[a][index]), index };
        let mut sites: Vec<Site<D>> = (0..axes[0].len()).map(site).collect();
        sites.par_sort_unstable_by_key(|site| (site.steps, site.index));
        let mut coincident = Vec::new();
        sites.dedup_by(|site, kept| {
            let same = site.steps == kept.steps;
            if same {
                coincident.push([kept.index, site.index]);
            }
            same
        });
        Self {
            periods: domain.periods(),
            is_torus: domain.is_torus(),
            coincident,
            tree: KdTreeN::build_by_key(sites, |site, a| site.steps[a]),
        }
    }

    /// `part`: of the piece of work at hand.
    fn of_points(&self, n: usize, part: f64, control: &Control) -> Result<Vec<Near>> {
        // Searched in the order of the tree, where queries that follow one another walk the same nodes.
        let parts: Vec<Vec<Near>> = self
            .tree
            .items()
            .par_chunks(CHUNK)
            .map(|sites| {
                control.check()?;
                let found = sites.iter().map(|site| self.nearest(site)).collect();
                control.advance(part * sites.len() as f64 / n as f64);
                Ok(found)
            })
            .collect::<Result<_>>()?;
        let mut nearest = vec![NONE; n];
        for (site, near) in self.tree.items().iter().zip(parts.into_iter().flatten()) {
            nearest[site.index] = near;
        }
        for &[a, b] in &self.coincident {
            nearest[a] = Near { square: 0, index: b };
            nearest[b] = Near { square: 0, index: a };
        }
        Ok(nearest)
    }

    /// As `points::geometry::squared_distance`.
    fn square(&self, a: &Site<D>, b: &Site<D>) -> u128 {
        let along = |axis: usize| u128::from(minimum_image(a.steps[axis], b.steps[axis], self.periods[axis]));
        (0..D).map(|axis| along(axis).pow(2)).sum()
    }

    /// From a place to the nearest point, in steps.
    pub(super) fn distance(&self, place: [u64; D]) -> f64 {
        (self.nearest(&Site { steps: place, index: NOBODY }).square as f64).sqrt()
    }

    /// From `site` to the nearest point that is not itself.
    fn nearest(&self, site: &Site<D>) -> Near {
        let exact = |item: &Site<D>| Near { square: self.square(site, item), index: item.index };
        let others =
            |items: &mut dyn Iterator<Item = &Site<D>>| items.filter(|item| item.index != site.index).map(exact).min();
        // Fewer points than this are compared all with all: no slower, and `KdSliceN::nearests` finds one point instead of
        // two in a tree of two.
        if self.tree.items().len() < 16 {
            return others(&mut self.tree.items().iter()).unwrap_or(NONE);
        }
        // One of the two nearest to a point is the point itself.
        let wanted = if site.index == NOBODY { 1 } else { 2 };
        // What lies beyond the reach is put infinitely far away, so that the tree leaves it out: seen from an image far from
        // all points, they are about equally far, and no distance found among them would exclude the others.
        let propose = |image: [i8; D], reach: f64| {
            let offset = |item: &Site<D>, a| match self.offset(item, site, image, a) {
                offset if offset.abs() <= reach => offset,
                offset => f64::INFINITY.copysign(offset),
            };
            let found = self.tree.nearests_by(&[0.0; D], wanted, offset);
            others(&mut found.into_iter().map(|f| f.item))
        };
        let mut best = propose([0; D], f64::INFINITY).unwrap_or(NONE);
        if best.square == 0 {
            return best;
        }
        for image in self.images_within(site, best.square) {
            let reach = (best.square as f64).sqrt() * (1.0 + 1e-14);
            best = propose(image, reach).map_or(best, |near| near.min(best));
        }
        // The proposals are nearest up to the rounding of f64, some 1e-15 of the squared distance: enough to confuse the
        // neighbours of a lattice. The exact minimum is among the points that close.
        let radius = (best.square as f64).sqrt() * (1.0 + 1e-14);
        for image in std::iter::once([0; D]).chain(self.images_within(site, best.square)) {
            let close = self.tree.within_by_cmp(|item, a| match self.offset(item, site, image, a) {
                offset if offset < -radius => Ordering::Less,
                offset if offset > radius => Ordering::Greater,
                _ => Ordering::Equal,
            });
            best = best.min(others(&mut close.into_iter()).unwrap_or(best));
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
    use crate::error::Error;
    use crate::plan::EnsembleShape;
    use crate::points::geometry::squared_distance;
    use crate::points::{Ensemble, RawPoints};
    use crate::samplers::Process;

    fn raw(dim: usize, coordinates: Vec<f64>) -> RawPoints {
        RawPoints { dim, coordinates, source: "test".into(), lines: Vec::new() }
    }

    fn one(domain: &Domain, coordinates: Vec<f64>) -> Ensemble {
        Ensemble::from_raw(&[raw(domain.dim(), coordinates)], domain, domain.is_torus(), 0).unwrap()
    }

    fn sample(name: &str, param: &[&str], n: u64, dim: usize) -> Vec<f64> {
        Process::new(name, n, 1, dim, 3, param).unwrap().coordinates(0, &Control::default()).unwrap()
    }

    /// A few test points, as of a thousand realizations.
    fn plan(domain: &Domain) -> NeighborPlan {
        let shape = EnsembleShape { realizations: 1000, mean_points: 30.0, max_points: 30 };
        NeighborPlan::new(domain, None, shape).unwrap()
    }

    /// The same integers as a comparison of all points with all, not a tolerance apart.
    fn assert_exact(what: &str, domain: &Domain, coordinates: Vec<f64>) {
        let ensemble = one(domain, coordinates);
        let axes = ensemble.lengths(0);
        let n = axes[0].len();
        let plan = plan(domain);
        let found = Nearest::find(&plan, None, &axes, 0.0, &Control::default()).unwrap();
        let all =
            |i| (0..n).filter(|&j| j != i).map(|j| squared_distance(&axes, domain.periods(), i, j)).min().unwrap();
        let expected: Vec<u128> = (0..n).map(all).collect();
        assert!(found.of_points == expected, "{what} in {domain:?}");
        for (i, &found) in found.of_probes.iter().enumerate() {
            // The test point stands in the place of an extra point.
            let probe = plan.probes.position(i);
            let with: Vec<Vec<u64>> = axes.iter().zip(probe).map(|(axis, x)| [*axis, &[x][..]].concat()).collect();
            let with: Vec<&[u64]> = with.iter().map(Vec::as_slice).collect();
            let expected = (0..n).map(|j| squared_distance(&with, domain.periods(), n, j)).min().unwrap();
            assert_eq!(found, expected, "{what} in {domain:?}, test point {i}");
        }
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
                    let found = Nearest::find(&plan(&domain), None, &axes, 0.0, &Control::default()).unwrap().of_points;
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
    fn nobody_is_infinitely_far() {
        for domain in domains(2) {
            let plan = plan(&domain);
            let find = |points| {
                Nearest::find(&plan, None, &one(&domain, points).lengths(0), 0.0, &Control::default()).unwrap()
            };
            let none = find(vec![]);
            assert!(none.of_points.is_empty() && none.of_probes.iter().all(|&s| s == u128::MAX));
            let single = find(into(&domain, &[0.5, 0.5]));
            assert_eq!(single.of_points, [u128::MAX]);
            assert!(single.of_probes.iter().all(|&s| s < u128::MAX));
        }
    }

    #[test]
    fn stops_when_asked() {
        let control = Control::default();
        control.cancel();
        let domain = Domain::unit_torus(2);
        let ensemble = one(&domain, sample("random", &[], 100, 2));
        assert!(matches!(
            Nearest::find(&plan(&domain), None, &ensemble.lengths(0), 0.0, &control),
            Err(Error::Cancelled)
        ));
    }
}

//! Maximal Poisson disk: uniform darts, kept where no point is closer than a distance, until no place is left (random sequential
//! adsorption to saturation; in one dimension Renyi's parking problem).
//!
//! Darts fall uniformly into equal boxes that hold all the free space. A box that a dart is kept in is full, for its diagonal is no longer
//! than the distance; after a round the others are halved along every axis, and those that one disk covers are dropped (Ebeida
//! et al., "A simple algorithm for maximal Poisson-disk sampling in high dimensions", 2012; White, Cline, Egbert 2007). The free space is hit uniformly at
//! any time, so the law is that of endless dart throwing, and it ends when no box is left.
//!
//! The distance makes the expected number n: as n grows, points at half of it cover 0.747598 (Renyi 1958), 0.547069, 0.384131 of
//! space in 1, 2, 3 dimensions (Torquato, Uche, Stillinger 2006; Zhang, Torquato 2013).

use std::sync::Arc;

use crate::ball::unit_ball;
use crate::control::Control;
use crate::error::Result;
use crate::samplers::torus_cells::TorusCells;
use crate::samplers::{BELOW_ONE, Entry, Family, Number, Realization, Sampler, Stream};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["mpd"],
    source: "White, Cline, Egbert 2007; Ebeida et al. 2012; Renyi 1958 (1D)",
    number: Number::Expected,
    ..Entry::new(
        "maximal-poisson-disk",
        Family::BlueNoise,
        "dart throwing until no place is left; n on average",
        |given| Ok(Arc::new(Maximal { n: given.n, dim: given.dim, distance: distance(given.n, given.dim) })),
    )
};

/// What disks of half the distance cover at saturation, by dimension.
const COVERED: [f64; 3] = [0.747_597_920_253_411, 0.547_069, 0.384_131];

/// Halvings after which a box is nothing.
const DEEPEST: u32 = 48;

struct Maximal {
    n: u64,
    dim: usize,
    distance: f64,
}

/// The distance that leaves n points on average.
fn distance(n: u64, dim: usize) -> f64 {
    2.0 * (COVERED[dim - 1] / (n as f64 * unit_ball(dim))).powf(1.0 / dim as f64)
}

impl Sampler for Maximal {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        match self.dim {
            1 => self.fill::<1>(&mut stream, control),
            2 => self.fill::<2>(&mut stream, control),
            _ => self.fill::<3>(&mut stream, control),
        }
    }

    fn count_variance(&self) -> Option<f64> {
        None
    }
}

impl Maximal {
    fn fill<const D: usize>(&self, stream: &mut Stream, control: &Control) -> Result<Vec<f64>> {
        let mut cells = TorusCells::<D>::new(2 * self.n as usize, self.distance);
        // Boxes whose diagonal is below the distance.
        let base = ((D as f64).sqrt() / self.distance).floor() as u64 + 1;
        let mut boxes: Vec<[u64; D]> =
            (0..base.pow(D as u32)).map(|at| std::array::from_fn(|axis| at / base.pow(axis as u32) % base)).collect();
        let mut per_axis = base as f64;
        for _ in 0..DEEPEST {
            // A dart per box: fewer would halve boxes that the next darts fill, more would miss full ones.
            for thrown in 0..boxes.len() {
                if thrown % 8192 == 0 {
                    control.check()?;
                }
                if boxes.is_empty() {
                    break;
                }
                let at = stream.below(boxes.len() as u64) as usize;
                let dart = boxes[at].map(|corner| ((corner as f64 + stream.uniform()) / per_axis).min(BELOW_ONE));
                if !cells.any_near(&dart, |_| true) {
                    cells.push(dart);
                    boxes.swap_remove(at);
                }
            }
            per_axis *= 2.0;
            let half = 0.5 / per_axis;
            let free = |corner: &[u64; D]| {
                let centre = corner.map(|c| (c as f64 + 0.5) / per_axis);
                !cells.any_near(&centre, |j| farthest2(&centre, half, &cells.points[j]) < self.distance * self.distance)
            };
            let halves = |corner: [u64; D]| {
                (0..1u64 << D).map(move |e| {
                    let mut half = corner.map(|c| 2 * c);
                    half.iter_mut().enumerate().for_each(|(axis, c)| *c += e >> axis & 1);
                    half
                })
            };
            boxes = boxes.into_iter().flat_map(halves).filter(free).collect();
            if boxes.is_empty() {
                break;
            }
        }
        Ok(cells.points.into_flattened())
    }
}

/// The square of the distance from a point to the farthest corner of a box, on the torus.
fn farthest2<const D: usize>(centre: &[f64; D], half: f64, point: &[f64; D]) -> f64 {
    let along = |k: usize| {
        let d = (centre[k] - point[k]).abs();
        d.min(1.0 - d) + half
    };
    (0..D).map(|k| along(k) * along(k)).sum()
}

//! The covering radius: the largest distance from any place of the domain to the nearest point.
//!
//! The distance to the nearest point changes by no more than one walks. So a box of half diagonal h around a place at distance f
//! holds none beyond f + h: boxes that cannot hold the farthest place are left out, the others are cut into halves along every
//! axis. Distances are those of integers (`search`).

use kd_tree::KdPoint;
use rayon::prelude::*;

use super::search::Search;
use crate::control::Control;
use crate::error::Result;
use crate::points::Domain;

/// How close the bound must come.
const TOLERANCE: f64 = 1e-9;

/// Boxes that are cut further. Only lattices have so many places equally far; then the bound stays where it was.
const BOXES: usize = 1 << 14;

/// The same where there are too many: what finds the distance itself.
const FEW: usize = 64;

/// The distance of the farthest place found, and a bound of all: equal to 1e-9 unless very many places are equally far.
///
/// # Errors
/// `Error::Cancelled`.
pub(in crate::compute) fn covering_radius(domain: &Domain, axes: &[&[u64]], control: &Control) -> Result<[f64; 2]> {
    match axes.len() {
        1 => within::<1>(domain, axes, control),
        2 => within::<2>(domain, axes, control),
        _ => within::<3>(domain, axes, control),
    }
}

/// A box: its low corner in units of the cut, and the distance at its middle.
#[derive(Clone, Copy)]
struct Cell<const D: usize> {
    corner: [u64; D],
    distance: f64,
}

fn within<const D: usize>(domain: &Domain, axes: &[&[u64]], control: &Control) -> Result<[f64; 2]>
where
    [f64; D]: KdPoint<Scalar = f64>,
    <[f64; D] as KdPoint>::Dim: Sync,
{
    let search = Search::<D>::new(axes, domain);
    let unit = domain.length_unit();
    let sides: [f64; D] = std::array::from_fn(|a| domain.sides()[a]);
    // About as many boxes as points, and as cubic as the sides allow.
    let spacing = (domain.measure() / axes[0].len() as f64).powf(1.0 / D as f64);
    let mut counts = sides.map(|side| (side / spacing).ceil().clamp(1.0, 1e7) as u64);
    let total: u64 = counts.iter().product();
    let at = |corner: [u64; D], counts: [u64; D]| {
        let place = |a: usize| (corner[a] as f64 + 0.5) / counts[a] as f64 * sides[a];
        // Places inside the domain, which is less than 2^64 steps wide.
        let steps = std::array::from_fn(|a| (place(a) / unit * 2f64.powi(64)) as u64);
        Cell { corner, distance: search.distance(steps) * unit / 2f64.powi(64) }
    };
    let first = |index: u64| {
        let mut rest = index;
        let corner = std::array::from_fn(|a| {
            let digit = rest % counts[a];
            rest /= counts[a];
            digit
        });
        at(corner, counts)
    };
    control.check()?;
    let mut cells: Vec<Cell<D>> = (0..total).into_par_iter().map(first).collect();
    let mut farthest = 0f64;
    // What boxes that were given up may hold.
    let mut given_up = 0f64;
    loop {
        control.check()?;
        let half = (0..D).map(|a| (sides[a] / counts[a] as f64).powi(2)).sum::<f64>().sqrt() / 2.0;
        farthest = cells.iter().fold(farthest, |f, cell| f.max(cell.distance));
        cells.retain(|cell| cell.distance + half > farthest * (1.0 + TOLERANCE));
        if cells.len() > BOXES.max(2 * total as usize) {
            cells.sort_by(|a, b| b.distance.total_cmp(&a.distance).then(a.corner.cmp(&b.corner)));
            given_up = cells[FEW..].iter().fold(given_up, |g, cell| g.max(cell.distance + half));
            cells.truncate(FEW);
        }
        // Beyond 2^52 parts places would be rounded.
        if cells.is_empty() || counts.iter().any(|&c| c > 1 << 51) {
            let left = cells.iter().map(|cell| cell.distance + half).fold(given_up, f64::max);
            return Ok([farthest, left.max(farthest * (1.0 + TOLERANCE))]);
        }
        counts = counts.map(|c| 2 * c);
        let halves = |cell: Cell<D>| {
            (0..1u32 << D).map(move |half| std::array::from_fn(|a| 2 * cell.corner[a] + u64::from(half >> a & 1)))
        };
        let parts: Vec<[u64; D]> = cells.into_iter().flat_map(halves).collect();
        cells = parts.into_par_iter().map(|corner| at(corner, counts)).collect();
    }
}

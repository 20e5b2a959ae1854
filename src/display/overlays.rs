//! What is drawn with the points of the first realization, in the domain's length unit: planes to look at, links to nearest
//! neighbours, strata, and copies across the sides of a torus.

use super::human;
use crate::compute::neighbors::nearest_neighbors;
use crate::compute::shifts;
use crate::control::Control;
use crate::error::Result;
use crate::estimate::Analysis;
use crate::integrand::Integrand;
use crate::plan::By;
use crate::points::{Domain, Ensemble};

/// A point or corner: to the right, upward.
pub type Place = [f64; 2];

/// Pairs of axes to look along, each (to the right, upward): one in 1D and 2D, three in 3D. In 1D the second axis is none and
/// everything on it is 0.
pub fn planes(dim: usize) -> &'static [[usize; 2]] {
    if dim < 3 { &[[0, 1]] } else { &[[0, 1], [0, 2], [1, 2]] }
}

/// Low and high corner of the domain on a plane.
pub fn frame(domain: &Domain, plane: [usize; 2]) -> [Place; 2] {
    let low = plane.map(|axis| domain.origin().get(axis).copied().unwrap_or(0.0));
    let sides = plane.map(|axis| domain.sides().get(axis).copied().unwrap_or(0.0));
    [low, [low[0] + sides[0], low[1] + sides[1]]]
}

/// The points of the first realization, projected onto a plane.
pub fn projected(points: &Ensemble, plane: [usize; 2]) -> Vec<Place> {
    let place = |j| {
        let x = points.position(0, j);
        plane.map(|axis| x.get(axis).copied().unwrap_or(0.0))
    };
    (0..count(points)).map(place).collect()
}

fn count(points: &Ensemble) -> usize {
    if points.realizations() > 0 { points.points_in(0) } else { 0 }
}

/// A point of the first realization with its coordinates: `point 17: (0.25, 0.5)`.
pub fn point_text(points: &Ensemble, index: usize) -> Option<String> {
    (index < count(points)).then(|| {
        let x: Vec<String> = points.position(0, index).into_iter().map(human).collect();
        format!("point {index}: ({})", x.join(", "))
    })
}

/// What each point of the first realization weighs in integrals, over the mean of those that count; 0 of those that are not kept. `None`
/// where all weigh the same.
pub fn weights(analysis: &Analysis, points: &Ensemble) -> Option<Vec<f64>> {
    let placed = analysis.integration()?.placed.as_ref();
    let density = placed.and_then(|placed| Integrand::new(&placed.spec, points.domain().dim()).ok());
    let weights = match (count(points), placed.map(|placed| placed.by), density) {
        (0, ..) => return None,
        (_, Some(Some(By::Removal)), Some(density)) => shifts::kept(points, &density, density.maximum().0),
        (_, Some(None), Some(density)) => shifts::over_density(points, &density),
        (_, None, _) => points.weights(0)?.to_vec(),
        _ => return None,
    };
    let counted: Vec<f64> = weights.iter().copied().filter(|w| *w != 0.0).collect();
    let mean = counted.iter().sum::<f64>() / counted.len() as f64;
    (mean > 0.0).then(|| weights.iter().map(|w| w / mean).collect())
}

/// A weight of these in words.
pub fn weight_text(weight: f64) -> String {
    if weight == 0.0 { "not kept".into() } else { format!("weight {} of the mean", human(weight)) }
}

/// From every point of the first realization to the nearest other one, on a torus to its nearest image, which may lie outside
/// the box; projected onto a plane. Points that coincide have no links.
///
/// # Errors
/// `Error::Cancelled`.
pub fn neighbor_links(points: &Ensemble, plane: [usize; 2], control: &Control) -> Result<Vec<[Place; 2]>> {
    if count(points) == 0 {
        return Ok(Vec::new());
    }
    let domain = points.domain();
    let partners = nearest_neighbors(points, 0, control)?;
    let link = |(from, to): (usize, Option<usize>)| {
        let (a, b) = (points.position(0, from), points.position(0, to?));
        let image: Vec<f64> = (a.iter().zip(&b).zip(domain.sides()))
            .map(|((a, b), side)| if domain.is_torus() { b - side * ((b - a) / side).round() } else { *b })
            .collect();
        let on = |x: &[f64]| plane.map(|axis| x.get(axis).copied().unwrap_or(0.0));
        (a != image).then(|| [on(&a), on(&image)])
    };
    Ok(partners.into_iter().enumerate().filter_map(link).collect())
}

/// Copies of the places on a plane of a torus across its sides, the places themselves left out, so that both together fill
/// -1 to 2 sides per axis. `None` in a window, which does not repeat.
pub fn tiles(domain: &Domain, plane: [usize; 2], places: &[Place]) -> Option<Vec<Place>> {
    let shift = |axis: usize, turns: i32| domain.sides().get(axis).map(|side| f64::from(turns) * side);
    let turns = |axis: usize| (-1..=1).filter_map(move |t| if t == 0 { Some(0.0) } else { shift(axis, t) });
    let shifts = turns(plane[0]).flat_map(|x| turns(plane[1]).map(move |y| [x, y])).filter(|s| *s != [0.0; 2]);
    domain.is_torus().then(|| shifts.flat_map(|[x, y]| places.iter().map(move |p| [p[0] + x, p[1] + y])).collect())
}

/// The m of m^d equal strata of `n` points, where n is such a power.
pub fn strata(n: usize, dim: usize) -> Option<usize> {
    let root = (n as f64).powf(1.0 / dim as f64).round() as usize;
    (n > 0 && root.checked_pow(dim as u32) == Some(n)).then_some(root)
}

/// The lines between the strata of `n` points on a plane, sides of the domain included; `None` where n is not m^d.
pub fn strata_lines(domain: &Domain, plane: [usize; 2], n: usize) -> Option<Vec<[Place; 2]>> {
    let m = strata(n, domain.dim())?;
    let [low, high] = frame(domain, plane);
    let at = |axis: usize, k: usize| low[axis] + (high[axis] - low[axis]) * (k as f64 / m as f64);
    let upright = (0..=m).map(|k| [[at(0, k), low[1]], [at(0, k), high[1]]]);
    let level = (0..=m).filter(|_| domain.dim() > 1).map(|k| [[low[0], at(1, k)], [high[0], at(1, k)]]);
    Some(upright.chain(level).collect())
}

//! Poisson disk by dart throwing (Cook 1986; in physics random sequential adsorption): uniform darts one after another,
//! each kept if no point is closer than a radius, until n are kept.
//!
//! The radius is relative to the distance in the closest packing of n points. Dart throwing jams before that: at 0.7476 in
//! 1D (Renyi 1958: coverage 0.74760), 0.7767 in 2D (coverage 0.54707), 0.8035 in 3D (coverage 0.3841). No closed form
//! for g or P beyond one dimension is known.

use rand_chacha::ChaCha8Rng;

use super::stream::{stream, uniform};
use super::{Accepts, Parameter, ParameterValues, Realization, Sampler, check_size};
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::setting::Setting;

pub(super) struct PoissonDisk;

/// The relative radius at which dart throwing jams for n to infinity, by dimension.
const JAMMED: [f64; 3] = [0.7476, 0.7767, 0.8035];

/// Darts per point before a run is given up; radius 0.76 in 2D, 2 % from jamming, is reached well before.
const DARTS_PER_POINT: u64 = 1000;

impl Sampler for PoissonDisk {
    fn name(&self) -> &'static str {
        "poisson-disk"
    }

    fn summary(&self) -> &'static str {
        "dart throwing: n uniform points, none closer than a radius"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter {
            name: "radius",
            default: "0.7",
            accepts: Accepts::Above(0.0, 1.0),
            help: "least distance, relative to the closest packing of n points; jams near 0.748 (1D), 0.777 (2D), 0.804 (3D)",
        }]
    }

    fn check(&self, n: u64, dim: usize, values: &ParameterValues) -> Result<()> {
        check_size(n, dim)?;
        let radius = values.number("radius")?;
        // What a finite set may hold beyond the limit shrinks like 1/sqrt(n); generously:
        if radius > JAMMED[dim - 1] + 1.0 / (n as f64).sqrt() {
            return Err(jammed(n, dim, radius));
        }
        Ok(())
    }

    fn generate(&self, realization: &Realization, values: &ParameterValues) -> Result<Vec<f64>> {
        let Realization { n, dim, .. } = *realization;
        self.check(n, dim, values)?;
        let radius = values.number("radius")?;
        let distance = radius * Domain::unit_torus(dim).closest_packing_distance(n as f64);
        let mut rng = stream(self, values, realization);
        // Few points jam by bad luck, many only by their radius: small sets start over.
        for _ in 0..(10_000 / n).clamp(1, 100) {
            let points = match dim {
                1 => throw::<1>(&mut rng, n as usize, distance),
                2 => throw::<2>(&mut rng, n as usize, distance),
                _ => throw::<3>(&mut rng, n as usize, distance),
            };
            if let Some(points) = points {
                return Ok(points);
            }
        }
        Err(jammed(n, dim, radius))
    }
}

fn jammed(n: u64, dim: usize, radius: f64) -> Error {
    let limit = JAMMED[dim - 1];
    let reason = format!(
        "dart throwing cannot place {n} points this far apart in {dim}D; lower radius (many points jam near {limit}, the \
         default is 0.7)"
    );
    Error::setting(Setting::Params, format!("radius={radius}"), reason)
}

/// One run, or `None` if it jams.
fn throw<const D: usize>(rng: &mut ChaCha8Rng, n: usize, distance: f64) -> Option<Vec<f64>> {
    let mut cells = Cells::<D>::new(n, distance);
    for _ in 0..DARTS_PER_POINT * n as u64 {
        cells.place(std::array::from_fn(|_| uniform(rng)));
        if cells.points.len() == n {
            return Some(cells.points.into_flattened());
        }
    }
    None
}

/// Points in cells at least as wide as the distance, so that only a cell and its neighbours need be searched.
struct Cells<const D: usize> {
    points: Vec<[f64; D]>,
    per_axis: usize,
    /// The last point of each cell and the one before each point, as index + 1; 0 ends a list.
    last: Vec<u32>,
    before: Vec<u32>,
    distance_squared: f64,
}

impl<const D: usize> Cells<D> {
    fn new(n: usize, distance: f64) -> Self {
        // No more cells than about points, however small the distance.
        let by_number = (n as f64).powf(1.0 / D as f64).ceil();
        let per_axis = (1.0 / distance).floor().min(by_number).max(1.0) as usize;
        Self {
            points: Vec::with_capacity(n),
            per_axis,
            last: vec![0; per_axis.pow(D as u32)],
            before: Vec::with_capacity(n),
            // Differences of multiples of 2^-53 are exact; their squared sum is off by at most 2 ulp, so that with this
            // margin no kept pair is closer than `distance`, exactly.
            distance_squared: distance * distance * (1.0 + 4.0 * f64::EPSILON),
        }
    }

    fn place(&mut self, dart: [f64; D]) {
        // `per_axis` times the largest f64 below 1 may round to `per_axis`.
        let home = dart.map(|x| ((x * self.per_axis as f64) as usize).min(self.per_axis - 1));
        if !self.is_blocked(&dart, &home) {
            let cell = home.iter().rev().fold(0, |cell, h| cell * self.per_axis + h);
            self.points.push(dart);
            self.before.push(self.last[cell]);
            self.last[cell] = self.points.len() as u32;
        }
    }

    fn is_blocked(&self, dart: &[f64; D], home: &[usize; D]) -> bool {
        // With fewer than three cells per axis, all of them are neighbours, once each.
        let width = self.per_axis.min(3);
        (0..width.pow(D as u32)).any(|neighbour| {
            let (mut rest, mut cell, mut stride) = (neighbour, 0, 1);
            for h in home {
                cell += (h + self.per_axis - 1 + rest % width) % self.per_axis * stride;
                rest /= width;
                stride *= self.per_axis;
            }
            let mut next = self.last[cell] as usize;
            while next != 0 {
                if distance_squared(dart, &self.points[next - 1]) < self.distance_squared {
                    return true;
                }
                next = self.before[next - 1] as usize;
            }
            false
        })
    }
}

fn distance_squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let along = |k: usize| {
        let d = (a[k] - b[k]).abs();
        d.min(1.0 - d)
    };
    (0..D).map(|k| along(k) * along(k)).sum()
}

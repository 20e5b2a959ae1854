//! Poisson disk by dart throwing (Cook 1986; in physics random sequential adsorption): uniform darts one after another,
//! each kept if no point is closer than a radius, until n are kept.
//!
//! The radius is relative to the distance in the closest packing of n points. Dart throwing jams before that: at 0.7476 in
//! 1D (Renyi 1958: coverage 0.74760), 0.7767 in 2D (coverage 0.54707), 0.8035 in 3D (coverage 0.3841). No closed form
//! for g or P beyond one dimension is known.

use std::sync::Arc;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::samplers::torus_cells::TorusCells;
use crate::samplers::{Accepts, Entry, Family, Given, Parameter, Realization, Sampler, Stream};
use crate::setting::Setting;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["dart-throwing", "ssi", "rsa"],
    source: "Cook 1986; Diggle's simple sequential inhibition",
    parameters: &[Parameter::new(
        "radius",
        "0.7",
        Accepts::Above(0.0, 1.0),
        "least distance, relative to the closest packing of n points; jams near 0.748 (1D), 0.777 (2D), 0.804 (3D)",
    )],
    ..Entry::new("poisson-disk", Family::BlueNoise, "dart throwing: n uniform points, none closer than a radius", make)
};

/// The relative radius at which dart throwing jams for n to infinity, by dimension.
const JAMMED: [f64; 3] = [0.7476, 0.7767, 0.8035];

/// Darts per point before a run is given up; radius 0.76 in 2D, 2 % from jamming, is reached well before.
const DARTS_PER_POINT: u64 = 1000;

/// Darts between two looks at the control: some milliseconds.
const DARTS_BETWEEN_LOOKS: u64 = 10_000;

struct PoissonDisk {
    dim: usize,
    n: u64,
    /// Relative to the closest packing.
    radius: f64,
}

fn make(given: &Given<'_>) -> Result<Arc<dyn Sampler>> {
    let radius = given.values.number("radius")?;
    let disk = PoissonDisk { dim: given.dim, n: given.n, radius };
    // What a finite set may hold beyond the limit shrinks like 1/sqrt(n); generously:
    if radius > JAMMED[given.dim - 1] + 1.0 / (given.n as f64).sqrt() {
        return Err(disk.jammed());
    }
    Ok(Arc::new(disk))
}

impl Sampler for PoissonDisk {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let distance = self.radius * Domain::unit_torus(self.dim).closest_packing_distance(self.n as f64);
        let mut stream = which.stream();
        // Few points jam by bad luck, many only by their radius: small sets start over.
        for _ in 0..(10_000 / self.n).clamp(1, 100) {
            let points = match self.dim {
                1 => throw::<1>(&mut stream, self.n as usize, distance, control)?,
                2 => throw::<2>(&mut stream, self.n as usize, distance, control)?,
                _ => throw::<3>(&mut stream, self.n as usize, distance, control)?,
            };
            if let Some(points) = points {
                return Ok(points);
            }
        }
        Err(self.jammed())
    }
}

impl PoissonDisk {
    fn jammed(&self) -> Error {
        let Self { dim, n, radius } = *self;
        let limit = JAMMED[dim - 1];
        let reason = format!(
            "dart throwing cannot place {n} points this far apart in {dim}D; lower radius (many points jam near {limit}, the \
             default is 0.7)"
        );
        Error::setting(Setting::Params, format!("radius={radius}"), reason)
    }
}

/// One run, or `None` if it jams.
fn throw<const D: usize>(stream: &mut Stream, n: usize, distance: f64, control: &Control) -> Result<Option<Vec<f64>>> {
    let mut cells = TorusCells::<D>::new(n, distance);
    for thrown in 0..DARTS_PER_POINT * n as u64 {
        if thrown % DARTS_BETWEEN_LOOKS == 0 {
            control.check()?;
        }
        let dart = std::array::from_fn(|_| stream.uniform());
        if !cells.any_near(&dart, |_| true) {
            cells.push(dart);
        }
        if cells.points.len() == n {
            return Ok(Some(cells.points.into_flattened()));
        }
    }
    Ok(None)
}

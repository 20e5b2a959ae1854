//! Point processes on the unit torus: one file each, a registry, and closed forms where they exist.
//!
//! A new process is one new file and one line in `REGISTRY`.
//!
//! Conventions of the closed forms: `n` points (the expected number where the process draws it) on the unit torus,
//! `P(m) = E|s_m|^2 / E n` at integer `m != 0`, and `g` by the number of ordered pairs, `E c / (E[n (n - 1)] |shell|)`, so
//! that n independent points have g = 1 exactly. Both are those of the randomly shifted process, as g and P always are.

mod grid;
mod halton;
mod jittered;
mod parameters;
mod poisson_disk;
mod process;
mod random;
mod stream;
mod thomas;

use std::ops::Range;

use rayon::prelude::*;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::points::{Domain, Ensemble, RawPoints};
use crate::setting::Setting;

pub use parameters::{Accepts, Parameter, ParameterValues};
pub use process::{AnySampler, Process};

/// Every process, in the order of `pairwave samplers`.
static REGISTRY: [&dyn Sampler; 6] =
    [&random::Random, &grid::Grid, &jittered::Jittered, &poisson_disk::PoissonDisk, &halton::Halton, &thomas::Thomas];

/// More points per realization than this are refused.
pub const MAX_POINTS: u64 = 100_000_000;

/// Which realization of a process. Together with the process's name and parameter values it determines every bit of
/// the points (see `stream.rs`): not the order in which realizations are drawn, nor the number of threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Realization {
    /// Number of points, or its expectation where the process draws it.
    pub n: u64,
    /// Number of coordinates per point, 1 to 3.
    pub dim: usize,
    /// Seed of the whole batch.
    pub seed: u64,
    /// Index within the batch.
    pub index: u64,
}

/// A point process on the unit torus.
pub trait Sampler: Send + Sync {
    /// The name on the command line.
    fn name(&self) -> &'static str;

    /// What it is, in one line.
    fn summary(&self) -> &'static str;

    /// Its parameters, `--param name=value`.
    fn parameters(&self) -> &'static [Parameter] {
        &[]
    }

    /// Whether every realization has exactly n points.
    fn fixed_n(&self) -> bool {
        true
    }

    /// Whether n points in `dim` dimensions can be asked for; the error says what can. Cheap.
    ///
    /// # Errors
    /// A number of points or a dimension that cannot be had, and what can.
    fn check(&self, n: u64, dim: usize, _values: &ParameterValues) -> Result<()> {
        check_size(n, dim)
    }

    /// The number of points nearest to `n` that can be asked for, as far as that depends on `dim` alone.
    fn nearest_size(&self, n: u64, _dim: usize) -> u64 {
        n.clamp(1, MAX_POINTS)
    }

    /// The points of one realization: coordinates in [0, 1), point by point.
    ///
    /// # Errors
    /// What cannot be drawn.
    fn generate(&self, realization: &Realization, values: &ParameterValues) -> Result<Vec<f64>>;

    /// g at distance `r` in [0, 1/2], averaged over directions and normalized by n (n - 1); `None` where no closed form
    /// is known or g is not a function (a lattice).
    fn pair_correlation(&self, _n: u64, _dim: usize, _r: f64, _values: &ParameterValues) -> Option<f64> {
        None
    }

    /// P at `m != 0` (components beyond `dim` are ignored), exact at this n; `None` where no closed form is known.
    fn power(&self, _n: u64, _m: [i32; 3], _dim: usize, _values: &ParameterValues) -> Option<f64> {
        None
    }
}

/// Every process.
pub fn registry() -> &'static [&'static dyn Sampler] {
    &REGISTRY
}

/// The process called `name`.
///
/// # Errors
/// A name that is not known, with the nearest that is.
pub fn find(name: &str) -> Result<&'static dyn Sampler> {
    registry().iter().find(|s| s.name() == name).copied().ok_or_else(|| {
        let names: Vec<_> = registry().iter().map(|s| s.name()).collect();
        let hint = nearest(name, &names).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
        Error::setting(Setting::Sampler, name, format!("no such sampler{hint}; expected one of {}", names.join(", ")))
    })
}

/// Realizations `indices` of a batch as an ensemble on the unit torus, drawn in parallel.
///
/// # Errors
/// What the sampler says; `Error::Cancelled`.
pub fn ensemble(
    sampler: &dyn Sampler,
    n: u64,
    dim: usize,
    seed: u64,
    indices: Range<u64>,
    values: &ParameterValues,
    control: &Control,
) -> Result<Ensemble> {
    sampler.check(n, dim, values)?;
    let first = indices.start;
    let raw: Vec<RawPoints> = indices
        .into_par_iter()
        .map(|index| {
            control.check()?;
            let coordinates = sampler.generate(&Realization { n, dim, seed, index }, values)?;
            let source = format!("{}, realization {index}", sampler.name());
            Ok(RawPoints { dim, coordinates, source, lines: Vec::new() })
        })
        .collect::<Result<_>>()?;
    Ensemble::from_raw(&raw, &Domain::unit_torus(dim), false, first)
}

/// The candidate most like `name`, if any is like it.
fn nearest<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let likeness = |c: &&str| strsim::jaro_winkler(&name.to_lowercase(), c);
    // 0.7 is clap's own threshold for suggestions.
    candidates.iter().copied().filter(|c| likeness(c) > 0.7).max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
}

fn check_size(n: u64, dim: usize) -> Result<()> {
    if !(1..=3).contains(&dim) {
        return Err(Error::setting(Setting::Dim, dim, "expected 1, 2 or 3"));
    }
    if !(1..=MAX_POINTS).contains(&n) {
        return Err(Error::setting(Setting::Points, n, format!("expected 1 to {MAX_POINTS} points")));
    }
    Ok(())
}

/// `k` with `k^dim = n`; the error names the nearest n that have one.
fn strata_per_axis(n: u64, dim: usize, name: &str) -> Result<u64> {
    check_size(n, dim)?;
    let power = |k: u64| k.pow(dim as u32);
    // The root in f64 is off by far less than 1/2 for n <= 1e8, so rounding it finds an exact root; the loop below only
    // moves it to the floor.
    let mut k = (n as f64).powf(1.0 / dim as f64).round() as u64;
    if power(k) == n {
        return Ok(k);
    }
    while power(k) > n {
        k -= 1;
    }
    let reason = format!("{name} in {dim}D needs n = k^{dim}; the nearest are {} and {}", power(k), power(k + 1));
    Err(Error::setting(Setting::Points, n, reason))
}

/// The power `k^dim` nearest to `n`, of those that may be asked for.
fn nearest_power(n: u64, dim: usize) -> u64 {
    let root = (n.clamp(1, MAX_POINTS) as f64).powf(1.0 / dim as f64) as u64;
    let powers = (root.saturating_sub(1)..=root + 1).map(|k| k.pow(dim as u32));
    powers.filter(|p| (1..=MAX_POINTS).contains(p)).min_by_key(|p| p.abs_diff(n)).unwrap_or(1)
}

/// `x` folded into [0, 1). The remainder of a tiny negative number rounds to 1, which is 0 on a torus.
fn wrap(x: f64) -> f64 {
    let f = x - x.floor();
    if f < 1.0 { f } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_sizes_can_be_asked_for() {
        for sampler in registry() {
            let values = ParameterValues::defaults(*sampler).unwrap();
            for dim in 1..=3 {
                for n in [0, 1, 2, 3, 26, 27, 28, 1000, 65_000, 99_999_999, MAX_POINTS, u64::MAX] {
                    let nearest = sampler.nearest_size(n, dim);
                    sampler.check(nearest, dim, &values).unwrap();
                    // Nothing nearer can be.
                    for nearer in
                        n.saturating_sub(nearest.abs_diff(n).min(40)).max(1)..nearest.min(n.saturating_add(40))
                    {
                        let closer = nearer.abs_diff(n) < nearest.abs_diff(n);
                        assert!(
                            !closer || sampler.check(nearer, dim, &values).is_err(),
                            "{} {n} {nearer}",
                            sampler.name()
                        );
                    }
                }
            }
        }
    }
}

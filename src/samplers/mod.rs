//! Point processes on the unit torus: one file each in a folder by family, a registry, and closed forms where they exist.
//!
//! A new process is one new file and one line in `REGISTRY`.
//!
//! Conventions of the closed forms: `n` points (the expected number where the process draws it) on the unit torus,
//! `P(m) = E|s_m|^2 / E n` at integer `m != 0`, and `g` by the number of ordered pairs, `E c / (E[n (n - 1)] |shell|)`, so
//! that n independent points have g = 1 exactly. Both are those of the randomly shifted process, as g and P always are.

mod blue_noise;
mod clusters;
mod entry;
mod gaussian;
mod independent;
mod low_discrepancy;
mod parameters;
mod process;
mod quadrature;
mod size;
mod stratified;
mod stream;
mod torus_cells;
mod torus_nearest;
mod waves;

use rand_distr::Poisson;

use crate::error::{Error, Result};
use crate::setting::Setting;

pub use entry::{Entry, Family, Given, Make, Number, SHIFT, Sampler};
pub use parameters::{Accepts, Parameter, ParameterValues};
pub use process::{InOrder, Process};
pub use size::Size;
pub use stream::{Realization, Stream};

/// Every process, in the order of `pairwave samplers`: by family.
static REGISTRY: &[&Entry] = &[
    &independent::random::ENTRY,
    &independent::poisson::ENTRY,
    &independent::grid::ENTRY,
    &independent::hexagonal::ENTRY,
    &independent::cubic::FCC,
    &independent::cubic::BCC,
    &independent::perturbed_grid::ENTRY,
    &stratified::jittered::ENTRY,
    &stratified::multi_jittered::ENTRY,
    &stratified::lhs::ENTRY,
    &stratified::cell::ENTRY,
    &low_discrepancy::halton::ENTRY,
    &low_discrepancy::hammersley::ENTRY,
    &low_discrepancy::sobol::ENTRY,
    &low_discrepancy::pmj02::ENTRY,
    &low_discrepancy::lattice::ENTRY,
    &low_discrepancy::fibonacci::ENTRY,
    &low_discrepancy::kronecker::ENTRY,
    &blue_noise::poisson_disk::ENTRY,
    &blue_noise::maximal_poisson_disk::ENTRY,
    &blue_noise::matern::TYPE_I,
    &blue_noise::matern::TYPE_II,
    &blue_noise::best_candidate::ENTRY,
    &blue_noise::lloyd::ENTRY,
    &blue_noise::fpo::ENTRY,
    &blue_noise::stealthy::ENTRY,
    &clusters::thomas::ENTRY,
    &clusters::matern_cluster::ENTRY,
    &clusters::cauchy_cluster::ENTRY,
    &clusters::lgcp::ENTRY,
    &clusters::gaussian_dpp::ENTRY,
    &clusters::fourier_dpp::ENTRY,
    &clusters::ginibre::ENTRY,
];

/// More points per realization than this are refused.
pub const MAX_POINTS: u64 = 100_000_000;

/// The largest f64 below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// Every process.
pub fn registry() -> &'static [&'static Entry] {
    REGISTRY
}

/// The process called `name`, or that has this alias.
///
/// # Errors
/// A name that is not known, with the nearest that is.
pub fn find(name: &str) -> Result<&'static Entry> {
    entry::find_in(REGISTRY, name)
}

/// The sampler of `NAME` or `NAME:key=value,...`, and its parameters as they are given.
///
/// # Errors
/// As `find`.
pub(crate) fn find_with_parameters(spec: &str) -> Result<(&'static Entry, Vec<&str>)> {
    let (name, own) = spec.split_once(':').unwrap_or((spec, ""));
    Ok((find(name.trim())?, own.split(',').filter(|own| !own.is_empty()).collect()))
}

/// The candidate most like `name`, if any is like it.
pub(crate) fn nearest_names<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    let likeness = |c: &&str| strsim::jaro_winkler(&name.to_lowercase(), c);
    // 0.7 is clap's own threshold for suggestions.
    candidates.iter().copied().filter(|c| likeness(c) > 0.7).max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
}

/// The Poisson distribution of a mean.
fn poisson(mean: f64) -> Result<Poisson<f64>> {
    Poisson::new(mean)
        .map_err(|e| Error::setting(Setting::Points, mean, format!("no Poisson number has this mean: {e}")))
}

/// `x` folded into [0, 1). The remainder of a tiny negative number rounds to 1, which is 0 on a torus.
fn wrap(x: f64) -> f64 {
    let f = x - x.floor();
    if f < 1.0 { f } else { 0.0 }
}

/// `(cell + u) / cells`, kept in the cell where rounding would put it into another: `floor(x * cells) = cell` in f64 too.
fn in_cell(cell: u64, u: f64, cells: f64) -> f64 {
    let mut x = (cell as f64 + u) / cells;
    while x * cells >= cell as f64 + 1.0 {
        x = x.next_down();
    }
    while x * cells < cell as f64 {
        x = x.next_up();
    }
    x
}

/// The places of n = k^d cells, the first axis fastest: all coordinates of one, then of the next.
fn cells(n: u64, k: u64, dim: usize) -> impl Iterator<Item = u64> {
    let (mut cell, mut axis) = (vec![0; dim], 0);
    let next = move || {
        let here = cell[axis];
        axis += 1;
        if axis == dim {
            axis = 0;
            for place in &mut cell {
                *place += 1;
                if *place < k {
                    break;
                }
                *place = 0;
            }
        }
        Some(here)
    };
    std::iter::from_fn(next).take(n as usize * dim)
}

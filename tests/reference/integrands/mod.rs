//! Integrands against numbers that share nothing with them: sums over a fine grid, slices, known values, and each other.
//!
//! Trusts: arithmetic and the values f(x), which are compared with the definitions in `values`. Proves: integrals, f_m and a(r) are those
//! of f. Each comparator is shown a planted fault. Cannot see: what only frequencies far above those compared would show.

mod closed;
mod files;
mod forms;
mod values;

use std::f64::consts::TAU;

use pairwave::Integrand;
use rustfft::num_complex::Complex;

/// One of every kind and dimension, off centre, with parameters that are not the defaults too.
const ALL: [(&str, usize); 51] = [
    ("disk", 1),
    ("disk", 2),
    ("disk", 3),
    ("disk:r=0.2,x=0.31,y=0.93", 2),
    ("disk:r=0.41,x=0.1,y=0.45", 2),
    ("disk:r=0.5", 2),
    ("ball:r=0.37,x=0.2,y=0.9,z=0.6", 3),
    ("disk:r=0.4,x=0.7", 1),
    ("box", 1),
    ("box", 2),
    ("box", 3),
    ("box:x0=0,x1=0.9,y0=0.3,y1=1", 2),
    ("step", 1),
    ("step:axis=y,at=0.7", 2),
    ("step:axis=z", 3),
    ("interval", 1),
    ("steps", 1),
    ("half-plane", 2),
    ("half-plane:angle=2.2,offset=0.1", 2),
    ("half-plane:angle=0,offset=0.37", 2),
    ("half-plane", 3),
    ("half-plane:angle=0.6,tilt=0.5,offset=0.7", 3),
    ("half-plane:angle=-2.5,tilt=-0.9,offset=-0.8", 3),
    ("half-plane:angle=0.6,tilt=1.5707963267948966,offset=0.4", 3),
    ("gaussian", 1),
    ("gaussian", 2),
    ("gaussian", 3),
    ("gaussian:sigma=0.5,x=0.9,y=0.1", 2),
    ("cut-gaussian", 1),
    ("cut-gaussian", 2),
    ("cut-gaussian", 3),
    ("cut-gaussian:sigma=0.05,sigma-y=3,x=1,y=0", 2),
    ("ramp", 1),
    ("ramp:axis=y", 2),
    ("monomial", 1),
    ("monomial", 2),
    ("monomial:x=1,y=2,z=3", 3),
    ("monomial:x=12", 1),
    ("cosine", 1),
    ("cosine", 2),
    ("cosine:x=1,z=3,phase=1", 3),
    ("checker", 1),
    ("checker:cells=5", 2),
    ("checker:cells=2", 3),
    ("zone-plate", 1),
    ("zone-plate:alpha=20", 2),
    ("zone-plate:alpha=3.5", 3),
    ("bump", 1),
    ("bump:x=0.2,y=0.8", 2),
    ("bump:r=0.45,q=1,x=0.3", 2),
    ("bump:q=3,r=0.4,z=0.1", 3),
];

fn all() -> impl Iterator<Item = Integrand> {
    ALL.into_iter().map(|(spec, dim)| made(spec, dim))
}

fn made(spec: &str, dim: usize) -> Integrand {
    Integrand::new(spec, dim).unwrap_or_else(|error| panic!("{spec} in {dim}D: {error}"))
}

/// Centres of n^d cells.
fn centers(n: usize, dim: usize) -> impl Iterator<Item = Vec<f64>> {
    let at = move |i: usize, k: usize| (i / n.pow(k as u32) % n) as f64 / n as f64 + 0.5 / n as f64;
    (0..n.pow(dim as u32)).map(move |i| (0..dim).map(|k| at(i, k)).collect())
}

/// Cells per axis of a sum over the box.
fn fine(dim: usize) -> usize {
    [100_000, 600, 80][dim - 1]
}

fn dot(m: &[i32], x: &[f64]) -> f64 {
    m.iter().zip(x).map(|(m, x)| f64::from(*m) * x).sum()
}

/// exp(-2 pi i t).
fn turn(t: f64) -> Complex<f64> {
    Complex::from_polar(1.0, -TAU * t)
}

/// Some wave vectors with |m_k| <= reach, 0 first, in no order.
fn modes(dim: usize, reach: i32, count: usize) -> Vec<Vec<i32>> {
    let mut state = 12345u64;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((state >> 33) % (2 * reach as u64 + 1)) as i32 - reach
    };
    let drawn = (1..count).map(|_| (0..dim).map(|_| next()).collect());
    std::iter::once(vec![0; dim]).chain(drawn).collect()
}

/// Some lags in [-0.7, 0.7)^d, 0 first.
fn lags(dim: usize, count: usize) -> Vec<Vec<f64>> {
    let steps = [0.8191725134, 0.6710436067, 0.5497004779];
    let lag =
        |i: usize| (0..dim).map(|k| if i == 0 { 0.0 } else { 1.4 * (i as f64 * steps[k]).fract() - 0.7 }).collect();
    (0..count).map(lag).collect()
}

//! Integrands: functions on the unit box, with what is known of them: integrals, Fourier coefficients, autocorrelation.
//!
//! A new integrand is one new file and one line in `REGISTRY`.
//!
//! Conventions: coordinates are fractions of the box, whatever its sides, so that I is the mean of f. Intervals are half-open, sets
//! are `<`. `f_m = int f(x) exp(-2 pi i m.x) dx` and the periodic autocorrelation `a(r) = int f(x) f(x + r mod 1) dx`, also of
//! an f that does not itself wrap; `a(0) = int f^2`, `int a = I^2`.

mod boxes;
mod bump;
mod cells;
mod checker;
mod cosine;
mod cut_gaussian;
mod density;
mod difference;
mod disk;
mod elementary;
mod entry;
mod expression;
mod factors;
mod formula;
mod gaussian;
mod half_plane;
mod half_space;
mod image;
mod inverse;
mod monomial;
mod panels;
mod pieces;
mod quadrature;
mod radial;
mod ramp;
mod separable;
mod shape;
mod spec;
mod stairs;
mod steps;
mod table;
mod warped;
mod zone_plate;

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use crate::error::{Error, Result};
use crate::setting::Setting;

pub use density::Density;
pub(crate) use density::nonnegative;
pub use entry::Entry;
pub use factors::{Factor, Steps};
pub(crate) use quadrature::{Integral, gauss, nested, over_cells};
pub use separable::Separable;
pub use spec::{Parameter, Takes};
pub(crate) use warped::{DIVERGES, FLOORS};

/// Every integrand, in the order of `pairwave integrands`.
static REGISTRY: &[&Entry] = &[
    &disk::ENTRY,
    &boxes::BOX,
    &boxes::STEP,
    &boxes::INTERVAL,
    &steps::ENTRY,
    &half_plane::ENTRY,
    &gaussian::ENTRY,
    &cut_gaussian::ENTRY,
    &ramp::ENTRY,
    &monomial::ENTRY,
    &cosine::ENTRY,
    &checker::ENTRY,
    &zone_plate::ENTRY,
    &bump::ENTRY,
    &image::ENTRY,
    &formula::ENTRY,
    &table::ENTRY,
];

/// Every integrand.
pub fn registry() -> &'static [&'static Entry] {
    REGISTRY
}

/// The integrand called `name`, or that has this alias.
///
/// # Errors
/// A name that is not known, with the nearest that is.
pub fn find(name: &str) -> Result<&'static Entry> {
    entry::find_in(REGISTRY, name)
}

/// A function on the unit box of one dimension, made of its specification and checked once. A clone shares what it holds.
#[derive(Clone)]
pub struct Integrand {
    spec: Arc<str>,
    entry: &'static Entry,
    dim: usize,
    integral: f64,
    square_integral: f64,
    shape: Arc<dyn shape::Shape>,
}

impl fmt::Debug for Integrand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in {}D", self.spec, self.dim)
    }
}

impl Integrand {
    /// The integrand that `spec` names, `NAME` or `NAME:key=value,...`, in `dim` dimensions.
    ///
    /// # Errors
    /// A name, key, value or dimension that cannot be, and what can; a file that cannot be read; an expression that does not parse or
    /// is not finite somewhere.
    pub fn new(spec: &str, dim: usize) -> Result<Self> {
        // What is wrong is wrong in this text.
        Self::made(spec.trim(), dim).map_err(|error| match error {
            Error::Setting { setting: Setting::Integrand, value, reason } if value.is_empty() => {
                Error::setting(Setting::Integrand, spec, reason)
            }
            other => other,
        })
    }

    fn made(spec: &str, dim: usize) -> Result<Self> {
        let (name, rest) = spec.split_once(':').unwrap_or((spec, ""));
        let entry = find(name.trim())?;
        if !entry.dims.contains(&dim) {
            return Err(entry::wrong(format!("{} is there in {}, this is {dim}D", entry.name, entry.in_dims())));
        }
        let values = spec::Values::parse(entry, dim, rest)?;
        let shape = (entry.make)(&entry::Given { dim, values: &values })?;
        let (integral, square_integral) = (shape.integral(), shape.square_integral());
        entry::in_range(integral, square_integral)?;
        Ok(Self { spec: values.canonical(entry.name).into(), entry, dim, integral, square_integral, shape })
    }

    /// Its specification with all parameters: the column `integrand` of tables.
    pub fn spec(&self) -> &str {
        &self.spec
    }

    /// Its line of the registry.
    pub fn entry(&self) -> &'static Entry {
        self.entry
    }

    /// Number of axes.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// f at `x`, fractions of the box in [0, 1).
    pub fn value(&self, x: &[f64]) -> f64 {
        self.shape.value(padded(x))
    }

    /// f at many places in [0, 1)^d; components beyond the dimension must be 0.
    pub fn values(&self, x: &[[f64; 3]], out: &mut [f64]) {
        self.shape.values(x, out);
    }

    /// I, the integral of f.
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// A bound of the error of I and of the integral of f^2 that is more than rounding; 0 where they are closed.
    pub fn integral_error(&self) -> f64 {
        self.shape.integral_error()
    }

    /// The integral of f^2, a(0).
    pub fn square_integral(&self) -> f64 {
        self.square_integral
    }

    /// The variance of f at one random point, `v0 = int f^2 - I^2`.
    pub fn variance(&self) -> f64 {
        self.square_integral - self.integral * self.integral
    }

    /// `f_m = int f(x) exp(-2 pi i m.x) dx`.
    pub fn coefficient(&self, m: &[i32]) -> Complex<f64> {
        let mut all = [0; 3];
        all.iter_mut().zip(m).for_each(|(to, from)| *to = *from);
        self.shape.coefficient(all)
    }

    /// An estimated bound of the error of every f_m that is more than rounding; 0 where they are closed.
    pub fn coefficient_error(&self) -> f64 {
        self.shape.coefficient_error()
    }

    /// f_m for all `|m_k| <= max_k`, one `max` per axis: index `m + max`, the x axis first (slowest), as P is laid out on its whole
    /// grid. Shared between the threads it is called in.
    pub fn coefficients(&self, max: &[u32]) -> Vec<Complex<f64>> {
        let mut all = [0; 3];
        all.iter_mut().zip(max).for_each(|(to, from)| *to = *from);
        self.shape.coefficients(all)
    }

    /// `a(r) = int f(x) f(x + r mod 1) dx` at any lag.
    pub fn autocorrelation(&self, r: &[f64]) -> f64 {
        self.shape.autocorrelation(padded(r).map(shape::wrap))
    }

    /// a at many lags; components beyond the dimension must be 0.
    pub fn autocorrelations(&self, r: &[[f64; 3]], out: &mut [f64]) {
        self.shape.autocorrelations(r, out);
    }

    /// An estimated bound of the error of a that is more than rounding; 0 where it is closed.
    pub fn autocorrelation_error(&self) -> f64 {
        self.shape.autocorrelation_error()
    }

    /// Its factors, if it is an offset and a product of functions of one coordinate each.
    pub fn separable(&self) -> Option<&Separable> {
        self.shape.separable()
    }

    /// Equal cells per axis on which it is constant, as pictures and tables are.
    pub(crate) fn cells(&self) -> Option<[usize; 3]> {
        self.shape.cells().map(|(shape, _)| shape)
    }

    /// f less `scale` times p, under the name of f.
    pub(crate) fn less(&self, p: &Self, scale: f64) -> Self {
        let shape = difference::Difference::new(self.dim, self.shape.clone(), p.shape.clone(), scale);
        let (integral, square_integral) = (shape::Shape::integral(&shape), shape::Shape::square_integral(&shape));
        Self { integral, square_integral, shape: Arc::new(shape), ..self.clone() }
    }

    /// Its largest value, and its least with the place where that is: of a grid, then by ever smaller steps from the best of it.
    pub(crate) fn maximum(&self) -> (f64, (f64, [f64; 3])) {
        let dim = self.dim;
        let side = [1usize << 16, 512, 64][dim - 1];
        let at = |i: usize, k: usize| {
            if k < dim { (i / side.pow(k as u32) % side) as f64 / side as f64 + 0.5 / side as f64 } else { 0.0 }
        };
        let value = |i: usize| {
            let x = std::array::from_fn(|k| at(i, k));
            (self.shape.value(x), x)
        };
        let all = (0..side.pow(dim as u32)).into_par_iter().map(value);
        let none = || ((f64::NEG_INFINITY, [0.0; 3]), (f64::INFINITY, [0.0; 3]));
        let of = |v: (f64, [f64; 3])| (v, v);
        let (most, least) = all
            .map(of)
            .reduce(none, |a, b| (if b.0.0 > a.0.0 { b.0 } else { a.0 }, if b.1.0 < a.1.0 { b.1 } else { a.1 }));
        let climb = |start: (f64, [f64; 3]), sign: f64| {
            let (mut best, mut step) = (start, 1.0 / side as f64);
            while step > 1e-17 {
                let mut better = None;
                for k in 0..dim {
                    for way in [-step, step] {
                        let mut x = best.1;
                        x[k] = (x[k] + way).clamp(0.0, 1.0 - f64::EPSILON / 2.0);
                        let v = self.shape.value(x);
                        if sign * v > sign * better.unwrap_or(best).0 {
                            better = Some((v, x));
                        }
                    }
                }
                match better {
                    Some(found) => best = found,
                    None => step *= 0.5,
                }
            }
            best
        };
        let of_cells = self.shape.cells().and_then(|(_, values)| values.iter().copied().reduce(f64::max));
        (of_cells.unwrap_or_else(|| climb(most, 1.0).0), climb(least, -1.0))
    }

    /// c of `|f_m|^2 ~ |m|^(-d-c)`, averaged over directions: 1 where f jumps, 3 where it has a kink, infinite where it is smooth, across
    /// the wrap too. 1 of a formula that does not wrap; where it does, nothing is known of its derivatives.
    pub fn smoothness(&self) -> f64 {
        self.shape.smoothness()
    }
}

fn padded(x: &[f64]) -> [f64; 3] {
    let mut all = [0.0; 3];
    all.iter_mut().zip(x).for_each(|(to, from)| *to = *from);
    all
}

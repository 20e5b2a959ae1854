//! An expression that somebody typed.

use std::sync::Arc;

use rustfft::num_complex::Complex;

use super::entry::{AXES, Entry, Given, in_range, wrong};
use super::expression::Expression;
use super::pieces::{CELLS, Known, SPREAD};
use super::quadrature::{Integrals, over_box};
use super::shape::{Shape, wrap};
use super::spec::{Parameter, Takes};
use crate::error::Result;

pub(super) static ENTRY: Entry = Entry {
    formulas: "I and int f^2 by adaptive Gauss quadrature; f_m and a(r) exactly of cubic polynomials on equal cells (4096 in 1D, 256^2, 32^3); errors: half as many cells beside it",
    source: "Legendre's polynomials and spherical Bessel functions: Abramowitz & Stegun 10.1.14",
    parameters: &[Parameter::new(
        "",
        "",
        Takes::Expression,
        "+ - * / ^ and functions of x, y, z; pi, e and tau; -x^2 is -(x^2)",
    )],
    closed: false,
    example: "formula:x*sin(9*x)",
    ..Entry::new("formula", "any expression of the coordinates", make)
};

struct Formula {
    dim: usize,
    expression: Expression,
    /// Of f over `scale`, about its size: errors are told from rounding whatever the size of f.
    integrals: Integrals,
    scale: f64,
    pieces: Known,
}

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let (dim, text) = (given.dim, given.text("")?);
    let expression = Expression::parse(text, dim).map_err(wrong)?;
    let value = |x| expression.value(x);
    let cells = CELLS[dim - 1];
    let scale = size(dim, largest_at_corners(dim, cells, value)?, value);
    // Places between: those of the quadrature, which come near what is infinite where there is such a place.
    let mut bad = None;
    let integrals = over_box(dim, |x| {
        let v = value(x);
        if !v.is_finite() {
            bad.get_or_insert((x, v));
            return 0.0;
        }
        v / scale
    });
    if let Some((x, v)) = bad {
        return Err(not_finite(dim, x, v));
    }
    let (first, second) = (integrals.first * scale, integrals.second * scale * scale);
    // A jump leaves less than that, a pole more.
    if integrals.error > (0.05 * (integrals.first.abs() + integrals.second)).max(1e-9) {
        let reason = "the integral of it or of its square does not converge; expected an expression that is finite on the whole box, and does not vary over less than some hundredth of it everywhere";
        return Err(wrong(reason));
    }
    in_range(first, second)?;
    let pieces = Known::new(dim, value, first);
    Ok(Arc::new(Formula { dim, integrals, scale, pieces, expression }))
}

/// The largest |f| at edges and corners of cells, where poles at 0 and simple fractions lie.
fn largest_at_corners(dim: usize, cells: usize, value: impl Fn([f64; 3]) -> f64) -> Result<f64> {
    let mut largest = 0f64;
    for i in 0..cells.pow(dim as u32) {
        let axis = |k: usize| (i / cells.pow(k as u32) % cells) as f64 / cells as f64;
        let x = std::array::from_fn(|k| if k < dim { axis(k) } else { 0.0 });
        let v = value(x);
        if !v.is_finite() {
            return Err(not_finite(dim, x, v));
        }
        largest = largest.max(v.abs());
    }
    Ok(largest)
}

/// A power of 2 about the root of the mean square at some places, poles apart; 1 of what is 0 there.
fn size(dim: usize, largest: f64, value: impl Fn([f64; 3]) -> f64) -> f64 {
    let place = |i: u32| std::array::from_fn(|k| if k < dim { wrap(f64::from(i) * SPREAD[k]) } else { 0.0 });
    let values: Vec<f64> = (1..1024).map(|i| value(place(i))).filter(|v| v.is_finite()).collect();
    let largest = values.iter().fold(largest, |most, v| most.max(v.abs()));
    let mean = values.iter().map(|v| (v / largest).powi(2)).sum::<f64>() / values.len() as f64;
    let size = (largest * mean.sqrt()).log2().floor().exp2();
    if size > 0.0 && size.is_finite() { size } else { 1.0 }
}

fn not_finite(dim: usize, x: [f64; 3], value: f64) -> crate::Error {
    let place: Vec<String> = (0..dim).map(|k| format!("{} = {}", AXES[k], x[k])).collect();
    let what = if value.is_nan() { "no number" } else { "infinite" };
    wrong(format!("it is {what} at {}; expected an expression that is finite on [0, 1)^{dim}", place.join(", ")))
}

impl Shape for Formula {
    fn value(&self, x: [f64; 3]) -> f64 {
        self.expression.value(x)
    }

    fn integral(&self) -> f64 {
        self.integrals.first * self.scale
    }

    fn integral_error(&self) -> f64 {
        self.integrals.error * self.scale.max(self.scale * self.scale)
    }

    fn square_integral(&self) -> f64 {
        self.integrals.second * self.scale * self.scale
    }

    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        self.pieces.coefficient(m)
    }

    fn coefficient_error(&self) -> f64 {
        self.pieces.coefficient_error
    }

    fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        self.pieces.coefficients(max)
    }

    fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        self.pieces.autocorrelation(r)
    }

    fn autocorrelation_error(&self) -> f64 {
        self.pieces.autocorrelation_error
    }

    /// By looking across the wrap, at some places of every side: a jump, a bend, or neither.
    fn smoothness(&self) -> f64 {
        // What the quadrature could not resolve jumps inside.
        if self.integrals.error > 1e-12 * (1.0 + self.integrals.second) {
            return 1.0;
        }
        let scale = self.integrals.second.sqrt() * self.scale;
        let mut least = f64::INFINITY;
        let h = 1e-4;
        for i in 0..64u32 {
            let [u, v, _] = SPREAD.map(|step| wrap(f64::from(i) * step));
            for axis in 0..self.dim {
                let at = |t: f64| {
                    let mut x = [0.0; 3];
                    (x[(axis + 1) % 3], x[(axis + 2) % 3]) = (u, v);
                    x[axis] = t;
                    let x = std::array::from_fn(|k| if k < self.dim { x[k] } else { 0.0 });
                    self.expression.value(x)
                };
                let jump = (at(1.0) - at(0.0)).abs();
                if jump.is_nan() || jump >= 1e-9 * scale {
                    return 1.0;
                }
                let slope = |from: f64, h: f64| (4.0 * at(from + h) - 3.0 * at(from) - at(from + 2.0 * h)) / (2.0 * h);
                if (slope(0.0, h) - slope(1.0, -h)).abs() > 1e-3 * scale {
                    least = 3.0;
                }
            }
        }
        least
    }
}

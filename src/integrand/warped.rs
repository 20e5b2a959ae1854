//! An integrand as points see it that are placed by the warp of a density: `h(u) = f(T u) / p(T u)`.

use std::sync::Arc;

use rustfft::num_complex::Complex;

use super::density::Density;
use super::pieces::Known;
use super::quadrature::{Integrals, over_box, over_cells};
use super::shape::{Shape, grid};
use super::{Factor, Integrand, Separable};
use crate::error::{Error, Result};
use crate::setting::Setting;

/// What deviates no more from its mean is constant but for rounding.
const ROUNDING: f64 = 1e-12;

/// A density that falls to 0 is looked at down to these parts of its mean, or of its largest value, and the variance must not depend on which.
pub(crate) const FLOORS: [f64; 2] = [1e-9, 1e-14];

/// An integral that changes by more than this part from one to the other is taken not to converge.
pub(crate) const DIVERGES: f64 = 0.02;

/// The same of its stated error.
const UNKNOWN: f64 = 0.5;

pub(super) struct Warped {
    f: Integrand,
    density: Density,
    square_integral: f64,
    integral_error: f64,
    form: Form,
}

/// How its transform and autocorrelation are known.
enum Form {
    /// It is one number.
    Constant,
    /// A product of functions of one coordinate each, times a number.
    Product(f64, Vec<Known>),
    /// By its values.
    Whole(Known),
}

impl Warped {
    pub(super) fn new(f: &Integrand, density: &Density) -> Result<Self> {
        let dim = f.dim();
        nothing_is_lost(f, density)?;
        let one = |u: [f64; 3]| value(f, density, u);
        let integral = f.integral();
        let mut warped = Self {
            f: f.clone(),
            density: density.clone(),
            square_integral: integral * integral,
            integral_error: f.integral_error().max(density.error() * integral.abs()),
            form: Form::Constant,
        };
        if spread(dim, 4096).all(|u| (one(u) - integral).abs() <= ROUNDING * integral.abs()) {
            return Ok(warped);
        }
        if let Some((scale, lines)) = product(f, density) {
            let of = |(axis, factor): (usize, &Factor)| {
                let total = density.integral_along(axis);
                let line = |v: f64| density.ratio_along(axis, factor, v);
                let known = Known::new(1, |u| line(u[0]), factor.integral());
                let square = converging(f, density, 1, |x, floor| {
                    factor.value(x[0]) / (density.along(axis, x[0]) / total).max(floor).sqrt()
                })?;
                Ok((known, square))
            };
            let all = lines.iter().enumerate().map(of).collect::<Result<Vec<_>>>()?;
            warped.square_integral = scale * scale * all.iter().map(|(_, square)| square.first).product::<f64>();
            let relative: f64 = all.iter().map(|(_, square)| square.error / square.first.max(f64::MIN_POSITIVE)).sum();
            warped.integral_error = warped.integral_error.max(relative * warped.square_integral);
            warped.form = Form::Product(scale, all.into_iter().map(|(known, _)| known).collect());
            return Ok(warped);
        }
        // Over x, where it is smoother than over u.
        let root = |x: [f64; 3], floor| f.value(&x[..dim]) / density.value(&x[..dim]).max(floor).sqrt();
        let square = match density.constant_on() {
            Some(shape) => {
                let square = |x: [f64; 3]| match density.value(&x[..dim]) {
                    p if p > 0.0 => f.value(&x[..dim]).powi(2) / p,
                    _ => 0.0,
                };
                let found = over_cells(dim, shape, square);
                Integrals { first: found.value, second: 0.0, error: found.error }
            }
            None => converging(f, density, dim, root)?,
        };
        warped.square_integral = square.first;
        warped.integral_error = warped.integral_error.max(square.error);
        warped.form = Form::Whole(Known::new(dim, one, integral));
        Ok(warped)
    }
}

/// `f / p` where `u` is mapped to.
fn value(f: &Integrand, density: &Density, u: [f64; 3]) -> f64 {
    let dim = f.dim();
    let (x, p) = density.sampled(u);
    if p > 0.0 { f.value(&x[..dim]) / p } else { 0.0 }
}

/// Evenly spread places of the box, in no order.
fn spread(dim: usize, count: u32) -> impl Iterator<Item = [f64; 3]> {
    (1..=count).map(move |i| {
        let place = super::pieces::SPREAD.map(|step| super::shape::wrap(f64::from(i) * step));
        std::array::from_fn(|k| if k < dim { place[k] } else { 0.0 })
    })
}

/// The factors and the scale of f, where f and the density are products.
fn product<'a>(f: &'a Integrand, density: &Density) -> Option<(f64, &'a [Factor])> {
    let factors = |s: &'a Separable| (s.scale(), s.factors());
    f.separable().filter(|s| s.offset() == 0.0 && density.is_product()).map(factors)
}

/// The integral of the square of `root`, f over the root of p, where p is no less than a part of its mean: which part may not matter.
fn converging(f: &Integrand, density: &Density, dim: usize, root: impl Fn([f64; 3], f64) -> f64) -> Result<Integrals> {
    let [rough, fine] = FLOORS.map(|floor| over_box(dim, |x| root(x, floor)));
    let apart = (fine.second - rough.second).abs();
    let known = apart <= DIVERGES * fine.second && fine.error <= UNKNOWN * fine.second;
    if !(known && fine.second.is_finite()) && fine.second != 0.0 {
        let reason = format!(
            "falls to 0 where {} does not: the integral of its square over it, and so the variance, is not finite or too large to be known; expected a density that is higher there",
            f.spec()
        );
        return Err(Error::setting(Setting::Intensity, density.spec(), reason));
    }
    Ok(Integrals { first: fine.second, second: 0.0, error: fine.error + apart })
}

/// A density of 0 where f is not is a bias that no number of points removes.
fn nothing_is_lost(f: &Integrand, density: &Density) -> Result<()> {
    let dim = f.dim();
    let cells: usize = [1 << 14, 512, 64][dim - 1];
    let (mut lost, mut all) = (0.0, 0.0);
    for i in 0..cells.pow(dim as u32) {
        let x: [f64; 3] = std::array::from_fn(|k| {
            if k < dim { ((i / cells.pow(k as u32) % cells) as f64 + 0.5) / cells as f64 } else { 0.0 }
        });
        let value = f.value(&x[..dim]).abs();
        all += value;
        if value > 0.0 && density.value(&x[..dim]) <= 0.0 {
            lost += value;
        }
    }
    if lost > 0.0 {
        let reason = format!(
            "is 0 where {} is not: {:.3} % of the integral is never sampled, a bias; expected a density above 0 wherever the integrand is not 0",
            f.spec(),
            100.0 * lost / all
        );
        return Err(Error::setting(Setting::Intensity, density.spec(), reason));
    }
    Ok(())
}

impl Shape for Warped {
    fn value(&self, u: [f64; 3]) -> f64 {
        value(&self.f, &self.density, u)
    }

    fn integral(&self) -> f64 {
        self.f.integral()
    }

    fn integral_error(&self) -> f64 {
        self.integral_error
    }

    fn square_integral(&self) -> f64 {
        self.square_integral
    }

    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        match &self.form {
            Form::Constant if m == [0; 3] => Complex::from(self.f.integral()),
            Form::Constant => Complex::default(),
            Form::Product(scale, lines) => {
                let along = |(line, m): (&Known, i32)| line.coefficient([m, 0, 0]);
                lines.iter().zip(m).map(along).product::<Complex<f64>>() * *scale
            }
            Form::Whole(known) => known.coefficient(m),
        }
    }

    fn coefficients(&self, max: [u32; 3]) -> Vec<Complex<f64>> {
        match &self.form {
            Form::Constant => grid(max, |m| self.coefficient(m)),
            Form::Product(scale, lines) => {
                let list = |(line, max): (&Known, u32)| line.coefficients([max, 0, 0]);
                let lists: Vec<Vec<Complex<f64>>> = lines.iter().zip(max).map(list).collect();
                grid(max, |m| {
                    let along = |(k, list): (usize, &Vec<Complex<f64>>)| list[(m[k] + max[k] as i32) as usize];
                    lists.iter().enumerate().map(along).product::<Complex<f64>>() * *scale
                })
            }
            Form::Whole(known) => known.coefficients(max),
        }
    }

    fn coefficient_error(&self) -> f64 {
        match &self.form {
            Form::Constant => 0.0,
            // No f_m is larger than the root of the integral of the square.
            Form::Product(scale, lines) => {
                scale.abs()
                    * product_error(lines, |line| {
                        (line.autocorrelation([0.0; 3]).max(0.0).sqrt(), line.coefficient_error)
                    })
            }
            Form::Whole(known) => known.coefficient_error,
        }
    }

    fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        match &self.form {
            Form::Constant => self.square_integral,
            Form::Product(scale, lines) => {
                let along = |(line, r): (&Known, f64)| line.autocorrelation([r, 0.0, 0.0]);
                scale * scale * lines.iter().zip(r).map(along).product::<f64>()
            }
            Form::Whole(known) => known.autocorrelation(r),
        }
    }

    fn autocorrelation_error(&self) -> f64 {
        match &self.form {
            Form::Constant => 0.0,
            Form::Product(scale, lines) => {
                scale
                    * scale
                    * product_error(lines, |line| (line.autocorrelation([0.0; 3]), line.autocorrelation_error))
            }
            Form::Whole(known) => known.autocorrelation_error,
        }
    }

    /// That of the less smooth of both: the map is as smooth as the density integrated once, and bends where that does.
    fn smoothness(&self) -> f64 {
        match self.form {
            Form::Constant => f64::INFINITY,
            _ => self.f.smoothness().min(self.density.smoothness()),
        }
    }
}

/// What a product errs by, of the sizes and errors of its factors.
fn product_error(lines: &[Known], of: impl Fn(&Known) -> (f64, f64)) -> f64 {
    let each: Vec<(f64, f64)> = lines.iter().map(of).collect();
    let but = |k: usize| (0..each.len()).filter(|j| *j != k).map(|j| each[j].0).product::<f64>();
    (0..each.len()).map(|k| each[k].1 * but(k)).sum()
}

impl Integrand {
    /// As points see it that are placed by the warp of a density: a function of where they are before that, with the same integral.
    ///
    /// # Errors
    /// A density that is 0, or falls to 0 too fast, where the integrand is not.
    pub fn warped(&self, density: &Density) -> Result<Self> {
        let shape = Warped::new(self, density)?;
        Ok(Self {
            spec: self.spec.clone(),
            entry: self.entry,
            dim: self.dim,
            integral: self.integral,
            square_integral: shape.square_integral,
            shape: Arc::new(shape),
        })
    }
}

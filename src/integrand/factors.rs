//! Functions of one coordinate, of which products are made. Everything about them is known in closed form.

use std::f64::consts::{PI, TAU};

use errorfunctions::ComplexErrorFunctions;
use rustfft::num_complex::Complex;

use super::elementary::{Images, LANES, REACH, cosine_of_turns, times_cosine, times_interval, times_steps};
use super::shape::{turn, wrap};
use crate::fourier::transform;
use crate::sinc::sinc;

/// A function on [0, 1).
#[derive(Debug, Clone, PartialEq)]
pub enum Factor {
    /// 1.
    One,
    /// 1 on [lo, hi), which lies in [0, 1].
    Interval {
        /// Where it begins.
        lo: f64,
        /// Where it ends.
        hi: f64,
    },
    /// x^p.
    Power(u32),
    /// cos(2 pi k x + phase), k above 0.
    Cosine {
        /// Periods per side.
        k: u32,
        /// In radians.
        phase: f64,
    },
    /// exp(-(x - c)^2 / 2 s^2), summed over all images.
    Gaussian {
        /// s.
        sigma: f64,
        /// c.
        center: f64,
    },
    /// The same, cut off at the ends of [0, 1).
    CutGaussian {
        /// s.
        sigma: f64,
        /// c.
        center: f64,
    },
    /// Constant on equal cells.
    Steps(Steps),
}

/// Values on equal cells of [0, 1), with their transform and autocorrelation.
#[derive(Debug, Clone, PartialEq)]
pub struct Steps {
    values: Vec<f64>,
    /// DFT(v) / N.
    transform: Vec<Complex<f64>>,
    /// The mean of v_i v_(i+j), j = 0 to N.
    products: Vec<f64>,
    /// The sum of those before each.
    sums: Vec<f64>,
}

impl Steps {
    pub(super) fn new(values: Vec<f64>) -> Self {
        let n = values.len();
        let mut field: Vec<_> = values.iter().map(|&v| Complex::from(v / n as f64)).collect();
        transform(&mut field, &[n]);
        let product = |j: usize| (0..n).map(|i| values[i] * values[(i + j) % n]).sum::<f64>() / n as f64;
        let products = (0..=n).map(|j| product(j % n)).collect();
        let before = |sum: &mut f64, v: &f64| Some(std::mem::replace(sum, *sum + v));
        let sums = values.iter().scan(0.0, before).collect();
        Self { values, transform: field, products, sums }
    }
}

impl Factor {
    /// Its value at `x` in [0, 1).
    pub fn value(&self, x: f64) -> f64 {
        let mut value = [1.0];
        self.times(&[x], &mut value);
        value[0]
    }

    /// Multiplies `out` by its values at `x`, at most `LANES` of them.
    fn times(&self, x: &[f64], out: &mut [f64]) {
        let each = out.iter_mut().zip(x);
        match self {
            Self::One => (),
            Self::Interval { lo, hi } => times_interval(x, *lo, *hi, out),
            Self::Power(1) => each.for_each(|(out, x)| *out *= x),
            Self::Power(p) => each.for_each(|(out, x)| *out *= x.powi(*p as i32)),
            Self::Cosine { k, phase } => times_cosine(x, f64::from(*k), phase / TAU, out),
            Self::Gaussian { sigma, center } => Images::new(*sigma).times(x, *center, 1.0, out),
            Self::CutGaussian { sigma, center } => {
                each.for_each(|(out, x)| *out *= (-0.5 * ((x - center) / sigma).powi(2)).exp());
            }
            Self::Steps(steps) => times_steps(x, &steps.values, out),
        }
    }

    /// Multiplies `out` by its values at one coordinate of places.
    pub(super) fn times_values(&self, x: &[[f64; 3]], axis: usize, out: &mut [f64]) {
        by_lanes(x, axis, out, |x, out| self.times(x, out));
    }

    /// The same by its autocorrelation at lags anywhere.
    pub(super) fn times_autocorrelations(&self, r: &[[f64; 3]], axis: usize, out: &mut [f64]) {
        match self {
            Self::Gaussian { sigma, .. } => {
                let (images, factor) = (Images::new(sigma * std::f64::consts::SQRT_2), PI.sqrt() * sigma);
                by_lanes(r, axis, out, |r, out| images.times(r, 0.0, factor, out));
            }
            Self::Cosine { k, .. } => {
                by_lanes(r, axis, out, |r, out| {
                    times_cosine(r, f64::from(*k), 0.0, out);
                    out.iter_mut().for_each(|a| *a *= 0.5);
                });
            }
            _ => out.iter_mut().zip(r).for_each(|(out, r)| *out *= self.autocorrelation(wrap(r[axis]))),
        }
    }

    /// `int f(x) exp(-2 pi i m x) dx`.
    pub fn coefficient(&self, m: i32) -> Complex<f64> {
        let mf = f64::from(m);
        match self {
            Self::One => Complex::from(f64::from(u8::from(m == 0))),
            Self::Interval { lo, hi } => {
                let w = hi - lo;
                turn(0.5 * mf * (lo + hi)) * (w * sinc(w * mf))
            }
            Self::Power(p) if m == 0 => Complex::from(1.0 / (f64::from(*p) + 1.0)),
            Self::Power(p) => {
                let step = Complex::new(0.0, 1.0 / (TAU * mf));
                (1..=*p).fold(Complex::default(), |f, p| step * (1.0 - f64::from(p) * f))
            }
            Self::Cosine { k, phase } => {
                if m.unsigned_abs() != *k {
                    return Complex::default();
                }
                Complex::from_polar(0.5, phase * mf.signum())
            }
            Self::Gaussian { sigma, center } => {
                turn(mf * center) * (TAU.sqrt() * sigma * (-2.0 * (PI * sigma * mf).powi(2)).exp())
            }
            Self::CutGaussian { sigma, center } => {
                let q = std::f64::consts::SQRT_2 * PI * sigma * mf;
                let end = |x: f64| (x - center) / (sigma * std::f64::consts::SQRT_2);
                turn(mf * center)
                    * (half_transform(end(1.0), q) - half_transform(end(0.0), q))
                    * (sigma * (PI / 2.0).sqrt())
            }
            Self::Steps(steps) => {
                let n = steps.values.len();
                let part = mf / n as f64;
                turn(0.5 * part) * sinc(part) * steps.transform[m.rem_euclid(n as i32) as usize]
            }
        }
    }

    /// Its integral.
    pub fn integral(&self) -> f64 {
        self.coefficient(0).re
    }

    /// The integral over [0, t].
    pub(super) fn cumulative(&self, t: f64) -> f64 {
        let gaussian = |sigma: f64, center: f64| {
            let at = |x: f64| libm::erf((x - center) / (sigma * std::f64::consts::SQRT_2));
            sigma * (PI / 2.0).sqrt() * (at(t) - at(0.0))
        };
        match self {
            Self::One => t,
            Self::Interval { lo, hi } => t.clamp(*lo, *hi) - lo,
            Self::Power(p) => t.powi(*p as i32 + 1) / (f64::from(*p) + 1.0),
            Self::Cosine { k, phase } => {
                let turns = TAU * f64::from(*k);
                ((turns * t + phase).sin() - phase.sin()) / turns
            }
            Self::Gaussian { sigma, center } => {
                let reach = (1.0 + REACH * sigma).floor() as i32;
                (-reach..=reach).map(|j| gaussian(*sigma, center + f64::from(j))).sum()
            }
            Self::CutGaussian { sigma, center } => gaussian(*sigma, *center),
            Self::Steps(steps) => {
                let n = steps.values.len();
                let place = t * n as f64;
                let j = (place as usize).min(n - 1);
                (steps.sums[j] + steps.values[j] * (place - j as f64)) / n as f64
            }
        }
    }

    /// `int f(x) f(x + r mod 1) dx`, `r` in [0, 1).
    #[inline]
    pub fn autocorrelation(&self, r: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Interval { lo, hi } => {
                let (w, r) = (hi - lo, r.min(1.0 - r));
                (w - r).max(0.0) + (w + r - 1.0).max(0.0)
            }
            Self::Power(p) => power_autocorrelation(*p as i32, r),
            Self::Cosine { k, .. } => 0.5 * cosine_of_turns(f64::from(*k) * r),
            // The product of two Gaussians is one that is wider by sqrt 2, of their distance.
            Self::Gaussian { sigma, .. } => {
                let mut a = [1.0];
                Images::new(sigma * std::f64::consts::SQRT_2).times(&[r], 0.0, PI.sqrt() * sigma, &mut a);
                a[0]
            }
            Self::CutGaussian { sigma, center } => {
                let part = |from: f64, to: f64, t: f64| {
                    let at = |x: f64| libm::erf((x + t - center) / sigma);
                    0.5 * sigma * PI.sqrt() * (at(to) - at(from)) * (-(t / sigma).powi(2)).exp()
                };
                part(0.0, 1.0 - r, 0.5 * r) + part(1.0 - r, 1.0, 0.5 * (r - 1.0))
            }
            Self::Steps(steps) => {
                let n = steps.values.len();
                let place = r * n as f64;
                let j = (place as usize).min(n - 1);
                let (a, b) = (steps.products[j], steps.products[j + 1]);
                a + (place - j as f64) * (b - a)
            }
        }
    }

    pub(super) fn smoothness(&self) -> f64 {
        match self {
            Self::One | Self::Cosine { .. } | Self::Gaussian { .. } => f64::INFINITY,
            Self::Interval { .. } | Self::Power(_) | Self::CutGaussian { .. } | Self::Steps(_) => 1.0,
        }
    }
}

/// Calls `times` with one coordinate of some places at a time, side by side.
fn by_lanes(x: &[[f64; 3]], axis: usize, out: &mut [f64], mut times: impl FnMut(&[f64], &mut [f64])) {
    let mut one = [0.0; LANES];
    for (x, out) in x.chunks(LANES).zip(out.chunks_mut(LANES)) {
        one.iter_mut().zip(x).for_each(|(one, x)| *one = x[axis]);
        times(&one[..x.len()], out);
    }
}

/// `exp(-q^2) erf(u + i q)`, through the Faddeeva function w, which does not overflow (Abramowitz & Stegun 7.1).
fn half_transform(u: f64, q: f64) -> Complex<f64> {
    if u < 0.0 {
        return -half_transform(-u, -q);
    }
    let w = Complex::new(-q, u).w();
    Complex::from((-q * q).exp()) - Complex::from_polar((-u * u).exp(), -2.0 * u * q) * w
}

/// Of x^p: both parts of the torus, before the wrap and behind it, by the binomial theorem.
fn power_autocorrelation(p: i32, r: f64) -> f64 {
    if p == 1 {
        return 1.0 / 3.0 - 0.5 * r * (1.0 - r);
    }
    let s = 1.0 - r;
    let mut binomial = 1.0;
    let mut sum = 0.0;
    for k in 0..=p {
        let order = p + k + 1;
        sum += binomial * (r.powi(p - k) * s.powi(order) + s.powi(p - k) * r.powi(order)) / f64::from(order);
        binomial *= f64::from(p - k) / f64::from(k + 1);
    }
    sum
}

//! Balls and bumps: functions of the distance to a centre, on the torus.

use std::f64::consts::PI;

use rustfft::num_complex::Complex;

use super::elementary::{self, nearest};
use super::quadrature::gauss;
use super::shape::{Shape, phase, turn};

/// `(1 - |x - c|^2 / R^2)^q` inside the ball of radius R about c, R at most 1/2; q = 0 is the ball itself.
pub(super) struct Radial {
    dim: usize,
    radius: f64,
    center: [f64; 3],
    q: u32,
    /// `A(t 2R) / (R^d (1 - t^2)^e)`, e = 2 q + (d + 1)/2, by Chebyshev's polynomials in 2 t - 1: what is left of the autocorrelation in
    /// the plane or space when its zero at 2R and its bell are taken out is smooth and nearly even. Empty for a ball, which has a
    /// closed form.
    smooth: Vec<f64>,
}

/// Coefficients that the smooth part has.
const TERMS: usize = 48;

impl Radial {
    pub(super) fn new(dim: usize, radius: f64, center: [f64; 3], q: u32) -> Self {
        let smooth = if q == 0 { Vec::new() } else { chebyshev(|t| smooth_part(dim, q, t)) };
        Self { dim, radius, center, q, smooth }
    }

    /// The autocorrelation in the plane or space at distance r.
    fn apart(&self, r: f64) -> f64 {
        let big = self.radius;
        if r >= 2.0 * big {
            return 0.0;
        }
        match (self.q, self.dim) {
            (0, 1) => 2.0 * big - r,
            // Below 2R rounding cannot make the root's argument negative nor the cosine's above 1.
            (0, 2) => {
                let rest = (2.0 * big - r) * (2.0 * big + r);
                2.0 * big * big * (0.5 * r / big).min(1.0).acos() - 0.5 * r * rest.max(0.0).sqrt()
            }
            (0, _) => PI / 12.0 * (4.0 * big + r) * (2.0 * big - r).powi(2),
            _ => {
                let t = 0.5 * r / big;
                let x = 2.0 * t - 1.0;
                let (b0, b1) =
                    self.smooth.iter().skip(1).rev().fold((0.0, 0.0), |(b0, b1), c| (2.0 * x * b0 - b1 + c, b0));
                let smooth = x * b0 - b1 + self.smooth[0];
                let left = (1.0 - t) * (1.0 + t);
                let twice = 4 * self.q as i32 + self.dim as i32 + 1;
                let root = if twice % 2 == 0 { 1.0 } else { left.sqrt() };
                big.powi(self.dim as i32) * smooth * left.powi(twice / 2) * root
            }
        }
    }
}

impl Shape for Radial {
    fn value(&self, x: [f64; 3]) -> f64 {
        let mut value = [0.0];
        self.values(&[x], &mut value);
        value[0]
    }

    fn values(&self, x: &[[f64; 3]], out: &mut [f64]) {
        elementary::radial(x, self.center, self.radius, self.q, out);
    }

    fn integral(&self) -> f64 {
        integral(self.dim, self.radius, self.q)
    }

    fn square_integral(&self) -> f64 {
        integral(self.dim, self.radius, 2 * self.q)
    }

    fn coefficient(&self, m: [i32; 3]) -> Complex<f64> {
        let m2: f64 = m.iter().map(|&m| f64::from(m).powi(2)).sum();
        if m2 == 0.0 {
            return Complex::from(self.integral());
        }
        // Gamma(q + 1) pi^-q R^d (R |m|)^(-d/2 - q) J_(d/2 + q)(2 pi R |m|); Bessel functions of half an odd order are spherical ones.
        let rm = self.radius * m2.sqrt();
        let x = 2.0 * PI * rm;
        let q = self.q as i32;
        let factorial: f64 = (1..=self.q).map(f64::from).product();
        let bessel = match self.dim {
            2 => libm::jn(1 + q, x) / rm.powi(1 + q),
            // J_(n + 1/2)(x) = sqrt(2 x / pi) j_n(x), and sqrt(2 x / pi) = 2 sqrt(rm).
            1 => 2.0 * spherical_bessel(q, x) / rm.powi(q),
            _ => 2.0 * spherical_bessel(1 + q, x) / rm.powi(1 + q),
        };
        turn(phase(m, self.center)) * (factorial / PI.powi(q) * self.radius.powi(self.dim as i32) * bessel)
    }

    /// A sum over images; up to R = 1/4 only the nearest is ever in reach.
    fn autocorrelation(&self, r: [f64; 3]) -> f64 {
        let r = r.map(nearest);
        if self.radius <= 0.25 {
            return self.apart((r[0] * r[0] + r[1] * r[1] + r[2] * r[2]).sqrt());
        }
        let reach = |k: usize| if k < self.dim { -1..=1 } else { 0..=0 };
        let reach2 = 4.0 * self.radius * self.radius;
        let mut sum = 0.0;
        for i in reach(0) {
            let x2 = (r[0] + f64::from(i)).powi(2);
            for j in reach(1) {
                let y2 = (r[1] + f64::from(j)).powi(2);
                for k in reach(2) {
                    let z2 = (r[2] + f64::from(k)).powi(2);
                    let r2 = x2 + y2 + z2;
                    if r2 < reach2 {
                        sum += self.apart(r2.sqrt());
                    }
                }
            }
        }
        sum
    }

    fn smoothness(&self) -> f64 {
        1.0 + 2.0 * f64::from(self.q)
    }
}

/// `pi^(d/2) R^d Gamma(q + 1) / Gamma(q + 1 + d/2)`.
fn integral(dim: usize, radius: f64, q: u32) -> f64 {
    // The ball, then one step in q at a time: Gamma(q + 1) / Gamma(q + 1 + d/2) grows by q / (q + d/2).
    let steps: f64 = (1..=q).map(|q| f64::from(q) / (f64::from(q) + 0.5 * dim as f64)).product();
    crate::ball::unit_ball(dim) * radius.powi(dim as i32) * steps
}

/// j_n(x), x above 0: upwards from sine and cosine where that is stable, else its power series (Abramowitz & Stegun 10.1).
pub(super) fn spherical_bessel(n: i32, x: f64) -> f64 {
    if x < f64::from(n) + 1.0 {
        let mut term: f64 = (1..=n).map(|k| x / f64::from(2 * k + 1)).product();
        let mut sum = term;
        for k in 1..60 {
            term *= -0.5 * x * x / f64::from(k * (2 * n + 2 * k + 1));
            sum += term;
        }
        return sum;
    }
    let (sin, cos) = x.sin_cos();
    let (mut below, mut here) = (sin / x, sin / (x * x) - cos / x);
    if n == 0 {
        return below;
    }
    for k in 1..n {
        (below, here) = (here, f64::from(2 * k + 1) / x * here - below);
    }
    here
}

/// Chebyshev coefficients on t in [0, 1].
fn chebyshev(f: impl Fn(f64) -> f64) -> Vec<f64> {
    let n = TERMS as f64;
    let angle = |i: usize| PI * (i as f64 + 0.5) / n;
    let values: Vec<f64> = (0..TERMS).map(|i| f(0.5 * (1.0 + angle(i).cos()))).collect();
    let term = |k: usize| {
        let sum: f64 = values.iter().enumerate().map(|(i, v)| v * (k as f64 * angle(i)).cos()).sum();
        sum * if k == 0 { 1.0 } else { 2.0 } / n
    };
    (0..TERMS).map(term).collect()
}

/// `A(2 t) / (1 - t^2)^e` of the bump of radius 1: two lenses, u along the lag and v across, u from the middle to the edge as
/// (1 - t)(1 - s^2), v in units of what is left there. Polynomials but for one root, so Gauss's rule is exact to rounding.
fn smooth_part(dim: usize, q: u32, t: f64) -> f64 {
    let rule: Vec<(f64, f64)> = gauss(40).into_iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
    let left = 1.0 - t;
    let q = q as i32;
    let mut sum = 0.0;
    for &(s, ws) in &rule {
        let u = left * (1.0 - s * s);
        // V^2 / left, V the half width of the lens.
        let v2 = s * s * (1.0 + t + u);
        let inner = |eta2: f64| (v2 * (1.0 - eta2)).powi(q) * (v2 * (1.0 - eta2) + 4.0 * t * (1.0 - s * s)).powi(q);
        let across: f64 = match dim {
            1 => inner(0.0),
            2 => rule.iter().map(|(eta, w)| w * 2.0 * v2.sqrt() * inner(eta * eta)).sum(),
            _ => rule.iter().map(|(eta, w)| w * 2.0 * PI * eta * v2 * inner(eta * eta)).sum(),
        };
        sum += ws * 4.0 * s * across;
    }
    // left, (1 - t), stands in du once, in each factor q times and in what is across (d - 1)/2 times: e in all.
    sum / (1.0 + t).powf(f64::from(2 * q) + 0.5 * (dim as f64 + 1.0))
}

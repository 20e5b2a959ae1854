//! The log-Gaussian Cox process (Moller, Syversveen, Waagepetersen, "Log Gaussian Cox processes", 1998), its field constant in M^d cells
//! of the torus.
//!
//! With C the covariance of the field at the nodes, images summed, and log-intensity mean `ln n - C(0) / 2`, exactly, m_j not all
//! multiples of M,
//!
//! ```text
//! P(m) = 1 + n prod_j sinc^2(m_j / M) F(m)      F(m) = M^-d sum_l (exp(C(l)) - 1) exp(-2 pi i m.l / M)      Var n = n + n^2 F(0)
//! ```
//!
//! g tends to `exp(C(r)) / (1 + F(0))` as cells shrink. C is drawn by the discrete Fourier transform, in which a sum of images is
//! not negative: its values are aliases of a positive spectrum.

use std::collections::HashMap;
use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};
use rustfft::num_complex::Complex;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::fourier::transform;
use crate::samplers::{
    Accepts, Entry, Family, Given, Number, Parameter, Realization, Sampler, cells, in_cell, poisson,
};
use crate::setting::Setting;
use crate::sinc::sinc;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Moller, Syversveen, Waagepetersen 1998",
    formulas: "P = 1 + n prod sinc^2(m_j/M) F(m), F = M^-d sum (exp C(l) - 1) exp(-2 pi i m.l/M), Var n = n + n^2 F(0); g(r) ~ exp(C(r)) as cells shrink",
    number: Number::Expected,
    parameters: &[
        Parameter::new("variance", "1", Accepts::Between(0.0, 20.0), "variance of the log-intensity"),
        Parameter::new("scale", "2", Accepts::Above(0.0, 1e6), "correlation length s, in units of n^(-1/d)"),
        Parameter::new(
            "covariance",
            "exponential",
            Accepts::OneOf(&["exponential", "gaussian"]),
            "exp(-r/s) or exp(-r^2/s^2), times the variance",
        ),
        Parameter::new(
            "cells",
            "auto",
            Accepts::WordOrWhole("auto", 4, 1 << 20),
            "cells per axis, a power of 2; auto: at most an eighth of the scale wide, 64 or more",
        ),
    ],
    ..Entry::new("lgcp", Family::Clusters, "log-Gaussian Cox process: random intensity, then a Poisson process", make)
};

/// Most cells of a field: it and its transform take 2 GiB.
const MOST_CELLS: u64 = 1 << 26;

/// The longest scales, in sides of the torus by dimension, whose images are summed in a moment.
const LONGEST: [f64; 3] = [4.0, 4.0, 0.75];

/// Images whose covariance is below this share of the variance are left out.
const NEGLIGIBLE: f64 = 1e-13;

struct LogGaussian {
    dim: usize,
    n: f64,
    /// M.
    side: usize,
    /// Square roots of the eigenvalues of the covariance, over `M^(d/2)`.
    amplitudes: Vec<f64>,
    /// C(0).
    variance: f64,
    /// F.
    spectrum: Vec<f64>,
    covariance: Covariance,
}

#[derive(Clone, Copy)]
struct Covariance {
    gaussian: bool,
    variance: f64,
    /// In units of the side.
    scale: f64,
}

impl Covariance {
    fn at(&self, r2: f64) -> f64 {
        let x = r2.sqrt() / self.scale;
        self.variance * if self.gaussian { (-x * x).exp() } else { (-x).exp() }
    }

    /// Distance beyond which it is negligible.
    fn reach(&self) -> f64 {
        let x = -NEGLIGIBLE.ln();
        self.scale * if self.gaussian { x.sqrt() } else { x }
    }

    /// The sum of all images at the node with these places, in cells of a torus with so many per axis.
    fn periodized(&self, node: &[usize], side: usize) -> f64 {
        let reach = self.reach();
        let offset = |k: usize| node.get(k).map_or(0.0, |&l| l as f64 / side as f64);
        let images = |k: usize| {
            let most = if k < node.len() { reach.ceil() as i64 + 1 } else { 0 };
            (-most..=most).map(move |image| (offset(k) + image as f64).powi(2))
        };
        let mut sum = 0.0;
        for x in images(0).filter(|x| *x <= reach * reach) {
            for y in images(1).filter(|y| x + y <= reach * reach) {
                sum +=
                    images(2).map(|z| x + y + z).filter(|r2| *r2 <= reach * reach).map(|r2| self.at(r2)).sum::<f64>();
            }
        }
        sum
    }
}

fn make(given: &Given<'_>) -> Result<Arc<dyn Sampler>> {
    let (n, dim) = (given.n as f64, given.dim);
    let relative = given.values.number("scale")?;
    let scale = relative * n.powf(-1.0 / dim as f64);
    let longest = LONGEST[dim - 1];
    if scale > longest {
        let most = longest / scale * relative;
        let reason = format!(
            "scale of lgcp at n = {n} in {dim}D is at most {most:.3}, {longest} sides of the torus: more images than can be summed"
        );
        return Err(Error::setting(Setting::Params, format!("scale={relative}"), reason));
    }
    let side = match given.values.whole("cells")? {
        Some(side) if side.is_power_of_two() => side,
        Some(side) => {
            let near = side.next_power_of_two();
            let reason = format!("cells of lgcp is a power of 2; the nearest are {} and {near}", near / 2);
            return Err(Error::setting(Setting::Params, format!("cells={side}"), reason));
        }
        None => ((8.0 / scale).min(1e9).ceil() as u64).next_power_of_two().max(64),
    };
    if side.saturating_pow(dim as u32) > MOST_CELLS {
        let most = 1u64 << (26 / dim as u32);
        let reason = format!(
            "lgcp in {dim}D has at most {most} cells per axis; {side} are needed for cells of an eighth of the scale"
        );
        return Err(Error::setting(Setting::Params, format!("scale={relative}"), reason));
    }
    let side = side as usize;
    let gaussian = given.values.word("covariance")? == "gaussian";
    let covariance = Covariance { gaussian, variance: given.values.number("variance")?, scale };
    // Nodes that differ by reflections and order of axes have the same value.
    let mut known: HashMap<Vec<usize>, f64> = HashMap::new();
    let nodes: Vec<usize> = cells((side as u64).pow(dim as u32), side as u64, dim).map(|l| l as usize).collect();
    let values: Vec<f64> = nodes
        .chunks_exact(dim)
        .map(|node| {
            let mut folded: Vec<usize> = node.iter().map(|&l| l.min(side - l)).collect();
            folded.sort_unstable();
            *known.entry(folded).or_insert_with_key(|node| covariance.periodized(node, side))
        })
        .collect();
    let of = |value: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let mut field: Vec<Complex<f64>> = values.iter().map(|&c| Complex::new(value(c), 0.0)).collect();
        transform(&mut field, &vec![side; dim]);
        field.into_iter().map(|z| z.re).collect()
    };
    let count = values.len() as f64;
    // Not negative but for rounding.
    let amplitudes = of(&|c| c).into_iter().map(|eigenvalue| (eigenvalue.max(0.0) / count).sqrt()).collect();
    let spectrum = of(&f64::exp_m1).into_iter().map(|f| f / count).collect();
    let variance = values.first().copied().unwrap_or(0.0);
    Ok(Arc::new(LogGaussian { dim, n, side, amplitudes, variance, spectrum, covariance }))
}

impl Sampler for LogGaussian {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let mut normal = || -> f64 { StandardNormal.sample(&mut stream.rng) };
        let mut field: Vec<Complex<f64>> =
            self.amplitudes.iter().map(|a| Complex::new(a * normal(), a * normal())).collect();
        transform(&mut field, &vec![self.side; self.dim]);
        control.check()?;
        let mean = (self.n / field.len() as f64).ln() - 0.5 * self.variance;
        let places: Vec<u64> = cells(field.len() as u64, self.side as u64, self.dim).collect();
        let mut points = Vec::new();
        for (z, place) in field.iter().zip(places.chunks_exact(self.dim)) {
            let number = poisson((mean + z.re).exp().max(f64::MIN_POSITIVE))?.sample(&mut stream.rng) as u64;
            for _ in 0..number {
                points.extend(place.iter().map(|&cell| in_cell(cell, stream.uniform(), self.side as f64)));
            }
        }
        Ok(points)
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        (0.0..=0.5).contains(&r).then(|| self.covariance.at(r * r).exp() / (1.0 + self.spectrum[0]))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let side = self.side as i64;
        let within = |m: i32| i64::from(m).rem_euclid(side) as usize;
        let at = m.iter().rev().fold(0, |at, &m| at * self.side + within(m));
        let cell: f64 = m.iter().map(|&m| sinc(f64::from(m) / self.side as f64).powi(2)).product();
        Some(1.0 + self.n * cell * self.spectrum[at])
    }

    fn count_variance(&self) -> Option<f64> {
        Some(self.n + self.n * self.n * self.spectrum[0])
    }
}

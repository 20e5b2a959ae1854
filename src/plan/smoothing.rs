//! Smoothing kernels.

use crate::named::named;

/// The shape of a smoothing kernel. Bandwidth is its standard deviation (spatstat's convention).
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum SmoothingKernel {
    /// `3/4 (1 - (x/h)^2) / h`, half-width `h = sqrt(5) bandwidth`.
    Epanechnikov,
    /// Gaussian, cut at 8 bandwidths (where it is 1e-14 of its peak).
    Gaussian,
    /// `1 / (2h)`, half-width `h = sqrt(3) bandwidth`.
    Box,
}

named!(SmoothingKernel: Epanechnikov = "epanechnikov", Gaussian = "gaussian", Box = "box");

/// The sphere whose surface a pair is divided by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Divisor {
    /// Of the radius at which g is estimated.
    #[default]
    R,
    /// Of the distance of the pair.
    D,
}

named!(Divisor: R = "r", D = "d");

/// A kernel with its bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Smoothing {
    /// Its shape.
    pub shape: SmoothingKernel,
    /// Its standard deviation, in the domain's length unit.
    pub bandwidth: f64,
}

impl SmoothingKernel {
    /// The distance from which on the kernel is 0, in bandwidths.
    pub fn reach(self) -> f64 {
        match self {
            Self::Epanechnikov => 5f64.sqrt(),
            Self::Gaussian => 8.0,
            Self::Box => 3f64.sqrt(),
        }
    }
}

impl Smoothing {
    /// The distance from which on the kernel is 0.
    pub fn reach(&self) -> f64 {
        self.shape.reach() * self.bandwidth
    }

    /// The kernel at `x`: its integral is 1.
    pub fn value(&self, x: f64) -> f64 {
        let u = x / self.reach();
        if u.abs() >= 1.0 {
            return 0.0;
        }
        match self.shape {
            SmoothingKernel::Epanechnikov => self.peak() * (1.0 - u * u),
            SmoothingKernel::Gaussian => self.peak() * (-0.5 * (x / self.bandwidth).powi(2)).exp(),
            SmoothingKernel::Box => self.peak(),
        }
    }

    /// The kernel at 0.
    pub fn peak(&self) -> f64 {
        match self.shape {
            SmoothingKernel::Epanechnikov => 0.75 / self.reach(),
            SmoothingKernel::Gaussian => 1.0 / (std::f64::consts::TAU.sqrt() * self.bandwidth),
            SmoothingKernel::Box => 0.5 / self.reach(),
        }
    }

    /// The integral of the kernel from -infinity to `x`.
    pub fn cumulative(&self, x: f64) -> f64 {
        let u = (x / self.reach()).clamp(-1.0, 1.0);
        match self.shape {
            SmoothingKernel::Epanechnikov => 0.5 + 0.75 * u - 0.25 * u * u * u,
            SmoothingKernel::Gaussian => 0.5 * libm::erfc(-x / (self.bandwidth * std::f64::consts::SQRT_2)),
            SmoothingKernel::Box => 0.5 + 0.5 * u,
        }
    }

    /// The largest value minus the smallest over `[lo, hi]`. Kernels fall on both sides of 0.
    pub fn oscillation(&self, lo: f64, hi: f64) -> f64 {
        let (a, b) = (self.value(lo), self.value(hi));
        if lo <= 0.0 && hi >= 0.0 { self.peak() - a.min(b) } else { (a - b).abs() }
    }
}

/// Length, circumference or area of the sphere of radius `r`: 2, 2 pi r, 4 pi r^2.
pub fn sphere_surface(r: f64, dim: usize) -> f64 {
    let pi = std::f64::consts::PI;
    match dim {
        1 => 2.0,
        2 => 2.0 * pi * r,
        _ => 4.0 * pi * r * r,
    }
}

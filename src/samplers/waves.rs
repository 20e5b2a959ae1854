//! Waves at whole frequencies.

use std::f64::consts::TAU;

/// Waves `exp(2 pi i k . x)` of some modes k.
pub(super) struct Waves {
    pub(super) dim: usize,
    /// The largest |k_j|.
    pub(super) reach: i32,
    /// `dim` components each.
    pub(super) modes: Vec<i32>,
}

impl Waves {
    /// How many.
    pub(super) fn len(&self) -> usize {
        self.modes.len() / self.dim
    }

    /// Their values at a place, real and imaginary parts.
    pub(super) fn values(&self, x: &[f64], re: &mut [f64], im: &mut [f64]) {
        let (reach, side) = (self.reach as usize, 2 * self.reach as usize + 1);
        let mut table = vec![(1.0, 0.0); side * self.dim];
        for (&x, table) in x.iter().zip(table.chunks_exact_mut(side)) {
            for k in 1..=reach {
                // Products modulo 1 first, so that the angle keeps its digits.
                let (sin, cos) = (TAU * (k as f64 * x).fract()).sin_cos();
                (table[reach + k], table[reach - k]) = ((cos, sin), (cos, -sin));
            }
        }
        for ((mode, re), im) in self.modes.chunks_exact(self.dim).zip(re).zip(im) {
            let mut product = (1.0, 0.0);
            for (axis, &k) in mode.iter().enumerate() {
                let (c, s) = table[axis * side + (k + self.reach) as usize];
                product = (product.0 * c - product.1 * s, product.0 * s + product.1 * c);
            }
            (*re, *im) = product;
        }
    }
}

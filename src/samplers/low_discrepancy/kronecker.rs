//! The Kronecker sequence of the generalized golden ratios (Roberts 2018, "R2" in the plane): coordinate j of point i is
//! `frac(i alpha_j)`, `alpha_j = phi^-j` with `phi^(d+1) = phi + 1`.
//!
//! In u64, where products wrap as the torus does: f64 products lose digits from i = 2^10 on.
//!
//! `P(m) = sin^2(pi n theta) / (n sin^2(pi theta))`, `theta = m . alpha`.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Entry, Family, Number, Realization, Sampler};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["r2"],
    source: "Roberts 2018",
    formulas: "P = sin^2(pi n t)/(n sin^2(pi t)), t = m.alpha, alpha_j = phi^-j, phi^(d+1) = phi + 1",
    number: Number::Sequence,
    dims: 1..=16,
    same_every_time: |_| true,
    ..Entry::new("kronecker", Family::LowDiscrepancy, "Kronecker sequence of generalized golden ratios (R2)", |given| {
        Ok(Arc::new(Kronecker { n: given.n, alpha: alphas(given.dim) }))
    })
};

struct Kronecker {
    n: u64,
    /// In steps of 2^-64.
    alpha: Vec<u64>,
}

impl Sampler for Kronecker {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        // The 53 bits of an f64 below 1.
        let place = |i: u64, alpha: &u64| (i.wrapping_mul(*alpha) >> 11) as f64 * 2f64.powi(-53);
        Ok((0..which.n).flat_map(|i| self.alpha.iter().map(move |alpha| place(i, alpha))).collect())
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let turn = |m: i32, alpha: u64| (i64::from(m) as u64).wrapping_mul(alpha);
        let theta = m.iter().zip(&self.alpha).fold(0u64, |sum, (&m, &alpha)| sum.wrapping_add(turn(m, alpha)));
        // Both angles are taken modulo 1 in integers, to either side of 0.
        let sine = |turns: u64| (PI * (turns as i64) as f64 * 2f64.powi(-64)).sin();
        let n = self.n as f64;
        let one = sine(theta);
        Some(if one == 0.0 { n } else { sine(theta.wrapping_mul(self.n)).powi(2) / (n * one * one) })
    }
}

/// `phi^-1 .. phi^-d` in steps of 2^-64, rounded.
fn alphas(dim: usize) -> Vec<u64> {
    // alpha = 1 / phi solves alpha^d + alpha^(d+1) = 1; in steps of 2^-127, bit by bit.
    let powers = |alpha: u128| std::iter::successors(Some(alpha), move |power| Some(product(*power, alpha)));
    let mut alpha = 0u128;
    for bit in (0..127).rev() {
        let trial = alpha | 1 << bit;
        let mut last = powers(trial).skip(dim - 1);
        if last.next().zip(last.next()).is_some_and(|(a, b)| a + b <= 1 << 127) {
            alpha = trial;
        }
    }
    powers(alpha).take(dim).map(|power| ((power + (1 << 62)) >> 63) as u64).collect()
}

/// The product of two numbers in [0, 1) in steps of 2^-127.
fn product(a: u128, b: u128) -> u128 {
    let low = |x: u128| x & u128::from(u64::MAX);
    let (a1, a0, b1, b0) = (a >> 64, low(a), b >> 64, low(b));
    let middle = a1 * b0 + ((a0 * b0) >> 64);
    let (m1, m0) = (middle >> 64, low(middle));
    let high = a1 * b1 + m1 + ((m0 + a0 * b1) >> 64);
    // 2^-254 in steps of 2^-128, doubled.
    high << 1
}

//! Sobol's sequence (Sobol' 1967) with the direction numbers of Joe and Kuo (2008), in natural order, 53 digits.
//!
//! `scramble=owen` is nested uniform scrambling (Owen 1995), exactly, one random word per coordinate (Helmer, Christensen,
//! Kensler, "Stochastic generation of (t, s) sample sequences", 2021): of 2^k <= i < 2^(k+1), x_i shares exactly k digits with one
//! earlier point, so its scrambled digits are the k of that point, the other one at place k + 1, and fresh ones.
//!
//! P of a scrambled set is that of a net: see `net_power`.

use std::sync::{Arc, OnceLock};

use super::interleaved;
use super::net_power::net_power;
use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Accepts, Entry, Family, Number, Parameter, Realization, Sampler, Stream};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Sobol' 1967; Joe & Kuo 2008; Owen 1995",
    formulas: "owen, n = 2^M: axes 1 - sinc^2(m/n); P = 1 + sum (Gamma(l) - 1) prod beta_l(m), beta_l(m) = sinc^2(m/2^l) - sinc^2(m/2^(l-1)); none: on the axes n where n divides m, else 0",
    notice: include_str!("../../../LICENSE-JOE-KUO"),
    number: Number::Sequence,
    dims: 1..=16,
    parameters: &[Parameter::new(
        "scramble",
        "owen",
        Accepts::OneOf(&["owen", "digital-shift", "none"]),
        "owen: nested uniform scrambling; digital-shift: all digits of an axis by one random word",
    )],
    same_every_time: |values| values.word("scramble").is_ok_and(|word| word == "none"),
    ..Entry::new("sobol", Family::LowDiscrepancy, "Sobol' sequence, a (0,2)-sequence in the plane", |given| {
        let scramble = match given.values.word("scramble")? {
            "digital-shift" => Scramble::DigitalShift,
            "none" => Scramble::None,
            _ => Scramble::Owen,
        };
        Ok(Arc::new(Sobol { n: given.n, dim: given.dim, scramble, counts: OnceLock::new() }))
    })
};

/// Digits of a coordinate.
pub(super) const DIGITS: u32 = 53;

/// Degree, middle coefficients and first direction numbers of the primitive polynomials of axes 2 to 16: rows of
/// new-joe-kuo-6.21201 (see `LICENSE-JOE-KUO`).
const POLYNOMIALS: [(usize, u64, &[u64]); 15] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
];

#[derive(Clone, Copy, PartialEq)]
enum Scramble {
    Owen,
    DigitalShift,
    None,
}

struct Sobol {
    n: u64,
    dim: usize,
    scramble: Scramble,
    /// Numbers of points by their leading zeros, for the closed form.
    counts: OnceLock<Vec<u64>>,
}

/// The direction numbers of an axis: point i is the exclusive or of those of its digits. The first digit is bit 52.
fn directions(axis: usize) -> [u64; DIGITS as usize] {
    let mut v = [0u64; DIGITS as usize];
    let digits = DIGITS as usize;
    if axis == 0 {
        for (k, v) in v.iter_mut().enumerate() {
            *v = 1 << (digits - 1 - k);
        }
        return v;
    }
    let (degree, middle, first) = POLYNOMIALS[axis - 1];
    for k in 0..digits {
        v[k] = if k < degree {
            first[k] << (digits - 1 - k)
        } else {
            let taps = (1..degree).filter(|j| middle >> (degree - 1 - j) & 1 == 1).map(|j| v[k - j]);
            taps.fold(v[k - degree] ^ (v[k - degree] >> degree), |sum, tap| sum ^ tap)
        };
    }
    v
}

/// The points of an axis as integers of 53 digits.
fn plain(axis: usize, n: usize) -> Vec<u64> {
    let v = directions(axis);
    let mut x = vec![0u64; n];
    for i in 1..n {
        let k = i.ilog2() as usize;
        x[i] = x[i ^ (1 << k)] ^ v[k];
    }
    x
}

/// For each k the number d below 2^k with the property that point i of 2^k <= i < 2^(k+1) shares its first k digits with
/// point `(i - 2^k) ^ d`: as points are linear in i, the d whose own first k digits are those of direction k.
fn partners(axis: usize) -> Vec<usize> {
    let v = directions(axis);
    let top = |x: u64, k: usize| x >> (DIGITS as usize - k);
    // The first k digits of direction j < k have a 1 at place j + 1 and none behind it: solved from the last place to the first.
    let solve = |k: usize| {
        let mut rest = if k == 0 { 0 } else { top(v[k], k) };
        (0..k).rev().fold(0usize, |d, j| {
            let place = 1u64 << (k - 1 - j);
            if rest & place == 0 {
                return d;
            }
            rest ^= top(v[j], k);
            d | 1 << j
        })
    };
    (0..usize::BITS.min(DIGITS) as usize).map(solve).collect()
}

/// The points of an axis under nested uniform scrambling.
pub(super) fn owen(axis: usize, n: usize, stream: &mut Stream) -> Vec<u64> {
    let partners = partners(axis);
    let mut x = vec![0u64; n];
    for i in 0..n {
        let fresh = stream.bits() >> (64 - DIGITS);
        x[i] = if i == 0 {
            fresh
        } else {
            let k = i.ilog2();
            let partner = x[(i ^ (1 << k)) ^ partners[k as usize]];
            let flipped = 1u64 << (DIGITS - 1 - k);
            let behind = flipped - 1;
            ((partner ^ flipped) & !behind) | (fresh & behind)
        };
    }
    x
}

/// As a coordinate, exactly.
pub(super) fn to_f64(x: u64) -> f64 {
    x as f64 * 2f64.powi(-(DIGITS as i32))
}

impl Sampler for Sobol {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let n = which.n as usize;
        let mut columns = Vec::with_capacity(which.dim);
        for axis in 0..which.dim {
            control.check()?;
            let mut stream = which.stream_of_axis(axis);
            let mut x = match self.scramble {
                Scramble::Owen => Vec::new(),
                Scramble::DigitalShift | Scramble::None => plain(axis, n),
            };
            match self.scramble {
                Scramble::None => {}
                Scramble::DigitalShift => {
                    let word = stream.bits() >> (64 - DIGITS);
                    x.iter_mut().for_each(|x| *x ^= word);
                }
                Scramble::Owen => x = owen(axis, n, &mut stream),
            }
            columns.push(x.into_iter().map(to_f64).collect());
        }
        Ok(interleaved(&columns))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        if !self.n.is_power_of_two() {
            return None;
        }
        let levels = self.n.ilog2() as usize;
        match self.scramble {
            Scramble::Owen if self.dim <= 3 => Some(net_power(levels, m, |zeros| self.leading_zeros(levels, zeros))),
            Scramble::None if m.iter().filter(|m| **m != 0).count() == 1 => {
                let on_peak = m.iter().all(|&m| i64::from(m) % self.n as i64 == 0);
                Some(if on_peak { self.n as f64 } else { 0.0 })
            }
            _ => None,
        }
    }
}

impl Sobol {
    /// The number of plain points whose first `zeros[j]` digits on axis j are 0.
    fn leading_zeros(&self, levels: usize, zeros: &[usize]) -> u64 {
        let side = levels + 1;
        let counts = self.counts.get_or_init(|| {
            let columns: Vec<Vec<u64>> = (0..self.dim).map(|axis| plain(axis, self.n as usize)).collect();
            let leading = |x: u64| (x.leading_zeros() - (64 - DIGITS)).min(levels as u32) as usize;
            let mut counts = vec![0u64; side.pow(self.dim as u32)];
            for i in 0..self.n as usize {
                counts[columns.iter().fold(0, |at, column| at * side + leading(column[i]))] += 1;
            }
            // Those with more zeros have so many too.
            for axis in 0..self.dim {
                let step = side.pow((self.dim - 1 - axis) as u32);
                for at in (0..counts.len()).rev() {
                    if at / step % side + 1 < side {
                        counts[at] += counts[at + step];
                    }
                }
            }
            counts
        });
        counts[zeros.iter().fold(0, |at, &zeros| at * side + zeros)]
    }
}

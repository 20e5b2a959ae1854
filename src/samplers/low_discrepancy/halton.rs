//! The Halton sequence (Halton 1960): coordinate j of point i is the radical inverse of i in the j-th prime base, i = 0, 1, ..,
//! starting at the origin.
//!
//! `scramble=owen`, n = b_j^M: `P = 1 - sinc^2(m/n)` on axis j; `scramble=none`: n where n divides m, else 0.

use std::sync::Arc;

use super::interleaved;
use super::radical_inverse::{PRIMES, permuted, plain, scrambled};
use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Accepts, Entry, Family, Number, Parameter, Realization, Sampler};
use crate::sinc::sinc;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Halton 1960; Owen 1995; Matousek 1998 (permuted)",
    formulas: "owen, on axis j at n = b_j^M: P = 1 - sinc^2(m/n); none: n where n divides m, else 0",
    number: Number::Sequence,
    dims: 1..=16,
    parameters: &[Parameter::new(
        "scramble",
        "none",
        Accepts::OneOf(&["none", "permuted", "owen"]),
        "permuted: one permutation of digits per base and place; owen: nested uniform scrambling",
    )],
    same_every_time: |values| values.word("scramble").is_ok_and(|word| word == "none"),
    ..Entry::new("halton", Family::LowDiscrepancy, "Halton sequence: radical inverses in bases 2, 3, 5, ..", |given| {
        let scramble = match given.values.word("scramble")? {
            "permuted" => Scramble::Permuted,
            "owen" => Scramble::Owen,
            _ => Scramble::None,
        };
        Ok(Arc::new(Halton { n: given.n, scramble }))
    })
};

#[derive(Clone, Copy)]
enum Scramble {
    None,
    Permuted,
    Owen,
}

struct Halton {
    n: u64,
    scramble: Scramble,
}

impl Sampler for Halton {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let n = which.n as usize;
        let mut columns = Vec::with_capacity(which.dim);
        for (axis, &base) in PRIMES[..which.dim].iter().enumerate() {
            control.check()?;
            // Each axis has a stream of its own, so that the first points do not depend on how many follow.
            let mut stream = which.stream_of_axis(axis);
            columns.push(match self.scramble {
                Scramble::None => plain(base, n),
                Scramble::Permuted => permuted(base, n, &mut stream),
                Scramble::Owen => scrambled(base, n, &mut stream),
            });
        }
        Ok(interleaved(&columns))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let mut others = m.iter().enumerate().filter(|(_, m)| **m != 0);
        let (axis, &m) = others.next()?;
        let whole = is_power_of(PRIMES[axis], self.n) && others.next().is_none();
        match self.scramble {
            Scramble::Owen if whole => Some(1.0 - sinc(f64::from(m) / self.n as f64).powi(2)),
            Scramble::None if whole => Some(if i64::from(m) % self.n as i64 == 0 { self.n as f64 } else { 0.0 }),
            _ => None,
        }
    }
}

/// Whether `n = base^M`.
pub(super) fn is_power_of(base: u64, mut n: u64) -> bool {
    while n > 1 && n.is_multiple_of(base) {
        n /= base;
    }
    n == 1
}

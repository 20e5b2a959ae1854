//! The Hammersley set (Hammersley 1960): point i is (i/n, radical inverses of i in bases 2, 3).
//!
//! On the first axis `P(m) = n` where n divides m, else 0; on the second too, where n is a power of 2.

use std::sync::Arc;

use super::halton::is_power_of;
use super::interleaved;
use super::radical_inverse::{PRIMES, plain};
use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Entry, Family, Realization, Sampler};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Hammersley 1960",
    formulas: "on the first axis, and at n = 2^M on the second: P = n where n divides m, else 0",
    same_every_time: |_| true,
    ..Entry::new(
        "hammersley",
        Family::LowDiscrepancy,
        "Hammersley set: i/n and radical inverses in bases 2, 3",
        |given| Ok(Arc::new(Hammersley { n: given.n })),
    )
};

struct Hammersley {
    n: u64,
}

impl Sampler for Hammersley {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let n = which.n;
        let mut columns = vec![(0..n).map(|i| i as f64 / n as f64).collect()];
        columns.extend(PRIMES[..which.dim - 1].iter().map(|&base| plain(base, n as usize)));
        Ok(interleaved(&columns))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let mut others = m.iter().enumerate().filter(|(_, m)| **m != 0);
        let (axis, &m) = others.next()?;
        let even = axis == 0 || is_power_of(PRIMES[axis - 1], self.n);
        let on_peak = i64::from(m) % self.n as i64 == 0;
        (even && others.next().is_none()).then_some(if on_peak { self.n as f64 } else { 0.0 })
    }
}

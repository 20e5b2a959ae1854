//! The Fibonacci lattice: (i/n, i F_(k-1)/n mod 1) with n = F_k a Fibonacci number. `P(m) = n` where `m . z = 0 mod n`,
//! z = (1, F_(k-1)), else 0.

use std::sync::Arc;

use super::lattice::Lattice;
use crate::samplers::{Entry, Family, Size};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    formulas: "P = n where m_1 + F_(k-1) m_2 = 0 mod n, else 0",
    size: Size::new(
        "a Fibonacci number from 2 on",
        |n, _| pairs().map(|p| p.1).take_while(|f| *f <= n).last(),
        |n, _| pairs().map(|p| p.1).find(|f| *f >= n),
    ),
    dims: 2..=2,
    same_every_time: |_| true,
    ..Entry::new("fibonacci", Family::LowDiscrepancy, "Fibonacci lattice, n a Fibonacci number", |given| {
        let before = pairs().find(|p| p.1 == given.n).map_or(1, |p| p.0);
        Ok(Arc::new(Lattice { n: given.n, z: vec![1, before] }))
    })
};

/// Fibonacci numbers from 2 on with the one before each.
fn pairs() -> impl Iterator<Item = (u64, u64)> {
    std::iter::successors(Some((1, 2)), |&(a, b): &(u64, u64)| Some((b, a.checked_add(b)?)))
}

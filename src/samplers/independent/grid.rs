//! The regular grid of n = k^d points at the centres of k^d cells.
//!
//! `P(m) = n` where every `m_j` is a multiple of k (the Bragg peaks), 0 elsewhere, shifted or not; g is a sum of deltas.

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::size::root_below;
use crate::samplers::{Entry, Family, Realization, Sampler, Size, cells};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["regular"],
    formulas: "P = n where every m_j is a multiple of k, else 0",
    size: Size::POWER,
    ..Entry::new("grid", Family::Independent, "regular grid of n = k^d points at cell centres", |given| {
        Ok(Arc::new(Grid { k: root_below(given.n, given.dim), n: given.n }))
    })
};

struct Grid {
    k: u64,
    n: u64,
}

impl Sampler for Grid {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        Ok(cells(which.n, self.k, which.dim).map(|cell| (cell as f64 + 0.5) / self.k as f64).collect())
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let on_peak = m.iter().all(|m| i64::from(*m) % self.k as i64 == 0);
        Some(if on_peak { self.n as f64 } else { 0.0 })
    }
}

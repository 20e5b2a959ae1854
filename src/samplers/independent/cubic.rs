//! The face-centred and the body-centred cubic lattice.
//!
//! Conventional cells at i / k with 4 and 2 points each. Bragg peaks, `P = n`, at m = k h with h all even or all odd (fcc), or
//! of an even sum (bcc).

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::size::root_below;
use crate::samplers::{Entry, Family, Realization, Sampler, Size, cells};

pub(in crate::samplers) static FCC: Entry = Entry {
    formulas: "P = n at m = k h, h all even or all odd, else 0; d_min is that of the closest packing",
    size: Size::new("4 k^3", |n, _| below(n, 4), |n, _| Some(above(n, 4))),
    dims: 3..=3,
    ..Entry::new("fcc", Family::Independent, "face-centred cubic lattice, the closest packing", |given| {
        Ok(Arc::new(Cubic { k: root_below(given.n / 4, 3), basis: &[[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]] }))
    })
};

pub(in crate::samplers) static BCC: Entry = Entry {
    formulas: "P = n at m = k h, h_1 + h_2 + h_3 even, else 0; d_min is 0.9720 of the closest packing",
    size: Size::new("2 k^3", |n, _| below(n, 2), |n, _| Some(above(n, 2))),
    dims: 3..=3,
    ..Entry::new("bcc", Family::Independent, "body-centred cubic lattice", |given| {
        Ok(Arc::new(Cubic { k: root_below(given.n / 2, 3), basis: &[[0, 0, 0], [1, 1, 1]] }))
    })
};

struct Cubic {
    k: u64,
    /// Points of a cell, in halves of its side.
    basis: &'static [[u32; 3]],
}

impl Sampler for Cubic {
    fn generate(&self, _: &Realization, _: &Control) -> Result<Vec<f64>> {
        let cells: Vec<u64> = cells(self.k.pow(3), self.k, 3).collect();
        let place = |cell: u64, half: u32| (cell as f64 + 0.5 * f64::from(half)) / self.k as f64;
        let of_cell = |cell: &[u64]| {
            let cell = [cell[0], cell[1], cell[2]];
            self.basis.iter().flat_map(move |half| [0, 1, 2].map(|axis| place(cell[axis], half[axis])))
        };
        Ok(cells.chunks_exact(3).flat_map(of_cell).collect())
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let k = self.k as i64;
        if m.iter().any(|&m| i64::from(m) % k != 0) {
            return Some(0.0);
        }
        // The waves of a cell's points add up or cancel.
        let h: Vec<i64> = m.iter().map(|&m| i64::from(m) / k).collect();
        let odd = |half: &&[u32; 3]| half.iter().zip(&h).map(|(&half, h)| i64::from(half) * h).sum::<i64>() % 2 != 0;
        let sum = self.basis.len() as f64 - 2.0 * self.basis.iter().filter(odd).count() as f64;
        Some((k * k * k) as f64 * sum * sum / self.basis.len() as f64)
    }
}

fn below(n: u64, per_cell: u64) -> Option<u64> {
    Some(root_below(n / per_cell, 3)).filter(|&k| k > 0).map(|k| per_cell * k.pow(3))
}

fn above(n: u64, per_cell: u64) -> u64 {
    let cells = n.div_ceil(per_cell);
    let root = root_below(cells, 3);
    per_cell * if root.pow(3) == cells { root } else { root + 1 }.pow(3)
}

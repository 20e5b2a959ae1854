//! The cell process of Baddeley and Silverman ("A cautionary example on the use of second-order methods for analyzing point
//! patterns", Biometrics 1984): every one of n = k^d cells has 0, 1 or 10 uniform points, with probability 1/10, 8/9, 1/90.
//!
//! The number in a cell has mean 1 and second factorial moment 1, as a Poisson number has, so that `g = 1`, `P(m) = 1` at
//! m != 0 and `Var n = n`, and yet it is no Poisson process: a tenth of the cells are empty, of a Poisson process 0.368.

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::size::root_below;
use crate::samplers::{Entry, Family, Number, Realization, Sampler, Size, Stream, cells, in_cell};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["baddeley-silverman"],
    source: "Baddeley & Silverman 1984",
    formulas: "g = 1, P = 1, Var n = n, and not Poisson",
    number: Number::Expected,
    size: Size::POWER,
    ..Entry::new(
        "cell",
        Family::Stratified,
        "0, 1 or 10 uniform points per cell, with the g and P of a Poisson process",
        |given| Ok(Arc::new(Cell { k: root_below(given.n, given.dim), n: given.n })),
    )
};

struct Cell {
    k: u64,
    n: u64,
}

/// The points of a cell.
fn number(stream: &mut Stream) -> u64 {
    match stream.below(90) {
        0..9 => 0,
        9..89 => 1,
        _ => 10,
    }
}

impl Sampler for Cell {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        // Numbers first, so that they can be had alone.
        let numbers: Vec<u64> = (0..self.n).map(|_| number(&mut stream)).collect();
        let cells: Vec<u64> = cells(self.n, self.k, which.dim).collect();
        let k = self.k as f64;
        let mut points = Vec::with_capacity(cells.len());
        for (cell, number) in cells.chunks_exact(which.dim).zip(numbers) {
            for _ in 0..number {
                points.extend(cell.iter().map(|&cell| in_cell(cell, stream.uniform(), k)));
            }
        }
        Ok(points)
    }

    fn count(&self, which: &Realization, _: &Control) -> Result<u64> {
        let mut stream = which.stream();
        Ok((0..self.n).map(|_| number(&mut stream)).sum())
    }

    fn pair_correlation(&self, _: f64) -> Option<f64> {
        Some(1.0)
    }

    fn power(&self, _: &[i32]) -> Option<f64> {
        Some(1.0)
    }

    fn count_variance(&self) -> Option<f64> {
        Some(self.n as f64)
    }
}

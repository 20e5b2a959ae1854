//! Correlated multi-jittered sampling of n = k^2 points: one in each of k x k cells, and one in each of n rows and of n
//! columns.
//!
//! Within its cell (a, b) a point stands in the column of substrata `p(b)` and in the row `q(a)`, p and q permutations
//! of 0 .. k, and is uniform in the square of side 1/n that they leave. `shared`: one p for all columns of cells and one q for all
//! rows (Kensler, "Correlated multi-jittered sampling", 2013, with uniform permutations in place of his hashes);
//! `independent`: a p for every column and a q for every row (Chiu, Shirley, Wang, "Multi-jittered sampling", 1994).
//!
//! With `s = sinc^2(m_1/n) sinc^2(m_2/n)`, `D(p) = k^2 [p = 0 mod k]`, `E(q) = k^2` where `q = 0 mod n` and
//! `sin^2(pi q/k) / sin^2(pi q/n)` elsewhere, `c(q) = (E(q) - k) / (k (k - 1))` and `u(q) = E(q) / k^2`:
//!
//! ```text
//! shared:       P = 1 - s + (s/n) A(m_1, m_2) A(m_2, m_1),    A(p, q) = k + c(q) (D(p) - k)
//! independent:  P = 1 - s + (s/n) [n + k (D(m_2) - k) c(m_1) u(m_2) + k (D(m_1) - k) c(m_2) u(m_1)
//!                                    + (D(m_1) - k) (D(m_2) - k) u(m_1) u(m_2)]
//! ```

use std::f64::consts::PI;
use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::size::root_below;
use crate::samplers::{Accepts, Entry, Family, Parameter, Realization, Sampler, Size, in_cell};
use crate::sinc::sinc;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["multi-jittered"],
    source: "Kensler 2013 (shared); Chiu, Shirley, Wang 1994 (independent)",
    formulas: "P = 1 - s + (s/n) A(m_1, m_2) A(m_2, m_1) (shared), s = sinc^2(m_1/n) sinc^2(m_2/n); also independent",
    size: Size::SQUARE,
    dims: 2..=2,
    parameters: &[Parameter::new(
        "permutations",
        "shared",
        Accepts::OneOf(&["shared", "independent"]),
        "shared: one for all columns and one for all rows; independent: one for each",
    )],
    ..Entry::new("cmj", Family::Stratified, "multi-jittered: one point per cell, per row and per column", |given| {
        let shared = given.values.word("permutations")? == "shared";
        Ok(Arc::new(MultiJittered { k: root_below(given.n, 2), shared }))
    })
};

struct MultiJittered {
    k: u64,
    shared: bool,
}

impl Sampler for MultiJittered {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let (k, n) = (self.k as usize, which.n as f64);
        let count = if self.shared { 1 } else { k };
        let mut permutations = || -> Vec<Vec<u32>> { (0..count).map(|_| stream.permutation(k)).collect() };
        let (columns, rows) = (permutations(), permutations());
        let mut points = Vec::with_capacity(2 * k * k);
        for b in 0..k {
            for a in 0..k {
                let within = [u64::from(columns[a % count][b]), u64::from(rows[b % count][a])];
                for (cell, within) in [a, b].into_iter().zip(within) {
                    points.push(in_cell(cell as u64 * self.k + within, stream.uniform(), n));
                }
            }
        }
        Ok(points)
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let [m1, m2] = [i64::from(*m.first()?), i64::from(*m.get(1)?)];
        let (ki, ni) = (self.k as i64, (self.k * self.k) as i64);
        let (k, n) = (ki as f64, ni as f64);
        let s = (sinc(m1 as f64 / n) * sinc(m2 as f64 / n)).powi(2);
        // D - k, and E.
        let d = |p: i64| if p % ki == 0 { k * k - k } else { -k };
        let e = |q: i64| {
            let turn = (q % ni) as f64 / n;
            if q % ni == 0 { k * k } else { ((PI * turn * k).sin() / (PI * turn).sin()).powi(2) }
        };
        // A single point has no other to stand in its row.
        let c = |q: i64| if ki == 1 { 0.0 } else { (e(q) - k) / (k * (k - 1.0)) };
        let u = |q: i64| e(q) / (k * k);
        let pairs = if self.shared {
            (k + c(m2) * d(m1)) * (k + c(m1) * d(m2))
        } else {
            n + k * d(m2) * c(m1) * u(m2) + k * d(m1) * c(m2) * u(m1) + d(m1) * d(m2) * u(m1) * u(m2)
        };
        Some(1.0 - s + s / n * pairs)
    }
}

//! Latin hypercube sampling (n rooks): on every axis one point in each of n intervals, in random order.
//!
//! With `a(0) = 1 - 1/n`, `a(m) = -sinc^2(m/n)/n` and `a'(m) = 1` where `m = 0 mod n`, `-1/(n - 1)` elsewhere,
//!
//! ```text
//! random place in the interval:  P = 1 + n ((n-1)/n) (n/(n-1))^d prod_j a(m_j), so 1 - sinc^2(m/n) on the axes
//! centre of the interval:        P = 1 + (n - 1) prod_j a'(m_j)
//! ```

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Accepts, Entry, Family, Parameter, Realization, Sampler, in_cell};
use crate::sinc::sinc;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["n-rooks", "latin-hypercube"],
    source: "McKay, Beckman, Conover 1979; Shirley 1991",
    formulas: "random: P = 1 + n ((n-1)/n) (n/(n-1))^d prod a(m_j), a(0) = 1 - 1/n, a(m) = -sinc^2(m/n)/n; centre: P = 1 + (n-1) prod a'(m_j)",
    dims: 1..=16,
    parameters: &[Parameter::new(
        "place",
        "random",
        Accepts::OneOf(&["random", "centre"]),
        "where in its interval a coordinate is",
    )],
    ..Entry::new(
        "lhs",
        Family::Stratified,
        "Latin hypercube: one point in each of n intervals of every axis",
        |given| {
            let centre = given.values.word("place")? == "centre";
            Ok(Arc::new(LatinHypercube { n: given.n, centre }))
        },
    )
};

struct LatinHypercube {
    n: u64,
    centre: bool,
}

impl Sampler for LatinHypercube {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let n = which.n as usize;
        let mut points = vec![0.0; n * which.dim];
        for axis in 0..which.dim {
            let order = stream.permutation(n);
            for (point, cell) in points.chunks_exact_mut(which.dim).zip(order) {
                let within = if self.centre { 0.5 } else { stream.uniform() };
                point[axis] = in_cell(u64::from(cell), within, n as f64);
            }
        }
        Ok(points)
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let n = self.n as f64;
        if self.n == 1 {
            // A random place is uniform; a centre is where it is, and one point has P = 1 anyway.
            return Some(1.0);
        }
        Some(if self.centre {
            let a = |m: i32| if i64::from(m) % self.n as i64 == 0 { 1.0 } else { -1.0 / (n - 1.0) };
            1.0 + (n - 1.0) * m.iter().map(|&m| a(m)).product::<f64>()
        } else {
            let a = |m: i32| if m == 0 { 1.0 - 1.0 / n } else { -sinc(f64::from(m) / n).powi(2) / n };
            1.0 + (n - 1.0) * (n / (n - 1.0)).powi(m.len() as i32) * m.iter().map(|&m| a(m)).product::<f64>()
        })
    }
}

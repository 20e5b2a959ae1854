//! The hexagonal lattice, as nearly as a square torus allows: b rows of a points, every other one moved by half a step.
//!
//! n = a b with b even, else the wrap breaks a row, and nearest neighbours at least 0.97 of the distance in the closest
//! packing apart. Bragg peaks, `P = n`, at `m_1 = a h` with `m_2 = (b / 2) (h mod 2)` modulo b.

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Entry, Family, Realization, Sampler, Size};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["hex", "triangular"],
    formulas: "P = n at m_1 = a h, m_2 = (b/2)(h mod 2) mod b, else 0; d_min = min(1/a, sqrt(1/4a^2 + 1/b^2), 2/b)",
    size: Size::new("a b with b even and d_min at least 0.97 of the closest packing", below, above),
    dims: 2..=2,
    ..Entry::new("hexagonal", Family::Independent, "hexagonal lattice of b rows of a points, b even", |given| {
        // The size was checked, so there is one.
        let (a, b) = rows(given.n).unwrap_or((given.n, 1));
        Ok(Arc::new(Hexagonal { a, b }))
    })
};

struct Hexagonal {
    a: u64,
    b: u64,
}

impl Sampler for Hexagonal {
    fn generate(&self, _: &Realization, _: &Control) -> Result<Vec<f64>> {
        let (a, b) = (self.a as f64, self.b as f64);
        let place = |i: u64, j: u64| [(i as f64 + 0.5 * (j % 2) as f64) / a, j as f64 / b];
        Ok((0..self.b).flat_map(|j| (0..self.a).flat_map(move |i| place(i, j))).collect())
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let (a, b) = (self.a as i64, self.b as i64);
        let (m1, m2) = (i64::from(*m.first()?), i64::from(*m.get(1)?));
        let on_peak = m1 % a == 0 && (m2 - b / 2 * (m1 / a).rem_euclid(2)) % b == 0;
        Some(if on_peak { (a * b) as f64 } else { 0.0 })
    }
}

/// The square of the distance between nearest neighbours.
fn nearest2(a: u64, b: u64) -> f64 {
    let (a, b) = ((a as f64).powi(-2), (b as f64).powi(-2));
    a.min(0.25 * a + b).min(4.0 * b)
}

fn close_enough(a: u64, b: u64) -> bool {
    let packed2 = 2.0 / (3f64.sqrt() * (a * b) as f64);
    a > 0 && b > 0 && nearest2(a, b) >= 0.97 * 0.97 * packed2
}

/// Even numbers of rows that can be close enough to the packing with about n points: b / a is near 2 / sqrt 3.
fn even_rows(n: u64) -> impl Iterator<Item = u64> {
    let ideal = (n as f64 * 2.0 / 3f64.sqrt()).sqrt();
    let (low, high) = ((0.85 * ideal).floor() as u64, (1.15 * ideal).ceil() as u64 + 2);
    (low.max(2)..=high).filter(|b| b % 2 == 0)
}

/// The rows and their lengths that lie closest, `None` where none is close enough.
fn rows(n: u64) -> Option<(u64, u64)> {
    let pairs = even_rows(n).filter(|b| n.is_multiple_of(*b)).map(|b| (n / b, b));
    pairs.filter(|&(a, b)| close_enough(a, b)).max_by(|x, y| nearest2(x.0, x.1).total_cmp(&nearest2(y.0, y.1)))
}

fn below(n: u64, _: usize) -> Option<u64> {
    let fewer = |b: u64| (0..3).filter_map(move |less| (n / b).checked_sub(less).map(|a| (a, b)));
    even_rows(n).flat_map(fewer).filter(|&(a, b)| close_enough(a, b)).map(|(a, b)| a * b).max()
}

fn above(n: u64, _: usize) -> Option<u64> {
    let more = |b: u64| (0..3).map(move |more| (n.div_ceil(b) + more, b));
    even_rows(n).flat_map(more).filter(|&(a, b)| close_enough(a, b)).map(|(a, b)| a * b).min().or_else(|| {
        // The least ones are further apart than their rows.
        (n..n + 64).find(|&n| rows(n).is_some())
    })
}

//! Which numbers of points a process can have.

use super::MAX_POINTS;
use crate::error::{Error, Result};
use crate::setting::Setting;

/// A rule for n in `dim` dimensions, in words and as the nearest that it allows.
pub struct Size {
    /// In words, for lists.
    pub words: &'static str,
    /// The largest that is at most `n`, for `n` up to `MAX_POINTS`.
    below: fn(u64, usize) -> Option<u64>,
    /// The smallest that is at least `n`.
    above: fn(u64, usize) -> Option<u64>,
}

impl Size {
    /// Any n.
    pub(super) const ANY: Self = Self::at_least::<1>("any");
    /// n = k^d.
    pub(super) const POWER: Self =
        Self::new("k^d", |n, dim| power_below(n, dim, |k| k), |n, dim| power_above(n, dim, |k| k));
    /// n = k^2.
    pub(super) const SQUARE: Self = Self { words: "k^2", ..Self::POWER };
    /// n = (2 k + 1)^d.
    pub(super) const ODD_POWER: Self = Self::new(
        "(2 k + 1)^d",
        |n, dim| power_below(n, dim, |k| k - (k + 1) % 2),
        |n, dim| power_above(n, dim, |k| k + (k + 1) % 2),
    );

    /// A rule of its own.
    pub(super) const fn new(
        words: &'static str,
        below: fn(u64, usize) -> Option<u64>,
        above: fn(u64, usize) -> Option<u64>,
    ) -> Self {
        Self { words, below, above }
    }

    /// Any n from `LEAST` on.
    pub(super) const fn at_least<const LEAST: u64>(words: &'static str) -> Self {
        Self::new(words, |n, _| (n >= LEAST).then_some(n), |n, _| Some(n.max(LEAST)))
    }

    /// The largest that is at most `n`.
    pub fn below(&self, n: u64, dim: usize) -> Option<u64> {
        (n > 0).then(|| (self.below)(n.min(MAX_POINTS), dim)).flatten()
    }

    /// The smallest that is at least `n`.
    pub fn above(&self, n: u64, dim: usize) -> Option<u64> {
        (n <= MAX_POINTS).then(|| (self.above)(n.max(1), dim)).flatten().filter(|&n| n <= MAX_POINTS)
    }

    /// Whether `n` is one; the error names the nearest.
    pub(super) fn check(&self, name: &str, n: u64, dim: usize) -> Result<()> {
        let ends = [self.below(n, dim), self.above(n, dim)];
        if ends[0] == Some(n) {
            return Ok(());
        }
        let reason = if self.words == Self::ANY.words {
            format!("expected 1 to {MAX_POINTS} points")
        } else {
            let near: Vec<String> = ends.iter().flatten().map(u64::to_string).collect();
            let verb = if near.len() == 1 { "nearest is" } else { "nearest are" };
            let needs = self.words.replace("^d", &format!("^{dim}"));
            format!("{name} in {dim}D needs n = {needs}; the {verb} {}", near.join(" and "))
        };
        Err(Error::setting(Setting::Points, n, reason))
    }
}

/// The largest `k` with `k^dim <= n`.
pub(super) fn root_below(n: u64, dim: usize) -> u64 {
    let power = |k: u64| u128::from(k).pow(dim as u32);
    // The root in f64 is off by far less than 1 for n <= 1e8; the loops settle what rounding left open.
    let mut k = (n as f64).powf(1.0 / dim as f64).round() as u64;
    while power(k) > u128::from(n) {
        k -= 1;
    }
    while power(k + 1) <= u128::from(n) {
        k += 1;
    }
    k
}

fn power_below(n: u64, dim: usize, base: fn(u64) -> u64) -> Option<u64> {
    Some(base(root_below(n, dim)).pow(dim as u32))
}

fn power_above(n: u64, dim: usize, base: fn(u64) -> u64) -> Option<u64> {
    let root = root_below(n, dim);
    let root = if root.pow(dim as u32) == n { root } else { root + 1 };
    base(root).checked_pow(dim as u32)
}

//! Radical inverses, plain, permuted and scrambled, of 0 .. n at once.
//!
//! Digits of i in base b, mirrored at the radix point. With `i = d b^k + r`, d its first digit, the mirrored digits of i are those
//! of r with d at place k + 1 in place of the 0 that r has there: every number follows from an earlier one, without a
//! division.

use crate::samplers::{BELOW_ONE, Stream};

/// The first primes: bases of the axes.
pub(super) const PRIMES: [u64; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];

/// Numbers in base `base` by their digits, the first the most significant: a whole number of `base^-digits`.
struct Digits {
    base: u64,
    /// `base^0 ..= base^digits`.
    powers: Vec<u64>,
}

impl Digits {
    /// So many that they reach the last bit of an f64, and at least those of 0 .. n.
    fn fine(base: u64) -> Self {
        let mut powers = vec![1u64];
        // One more digit must not overflow 2^63.
        while powers.last().is_some_and(|&p| p < 1 << 53) {
            match powers.last().and_then(|p| p.checked_mul(base)).filter(|&p| p < 1 << 63) {
                Some(next) => powers.push(next),
                None => break,
            }
        }
        Self { base, powers }
    }

    fn count(&self) -> usize {
        self.powers.len() - 1
    }

    fn one(&self) -> u64 {
        self.powers[self.count()]
    }

    /// What a 1 at place `k` (from 0) after the radix point is worth.
    fn worth(&self, k: usize) -> u64 {
        self.powers[self.count() - 1 - k]
    }

    fn to_f64(&self, y: u64) -> f64 {
        (y as f64 / self.one() as f64).min(BELOW_ONE)
    }

    /// Fills `y[1..]`, each from a number with one digit less: `next(y, i, k, d)` for `i = d base^k + r`.
    fn fill(&self, y: &mut [u64], mut next: impl FnMut(&[u64], usize, usize, u64) -> u64) {
        let (mut k, mut i) = (0, 1);
        while i < y.len() {
            let step = self.powers[k] as usize;
            for d in 1..self.base {
                for _ in 0..step {
                    if i == y.len() {
                        return;
                    }
                    y[i] = next(y, i, k, d);
                    i += 1;
                }
            }
            k += 1;
        }
    }
}

/// The radical inverses of 0 .. n, each the f64 nearest to it.
pub(super) fn plain(base: u64, n: usize) -> Vec<f64> {
    // As few digits as 0 .. n has: both integers of the quotient are exact in f64.
    let mut digits = Digits::fine(base);
    let needed = digits.powers.iter().position(|&p| p as u128 >= n as u128).unwrap_or(digits.count()).max(1);
    digits.powers.truncate(needed + 1);
    let mut y = vec![0u64; n];
    digits.fill(&mut y, |y, i, k, d| y[i - (d * digits.powers[k]) as usize] + d * digits.worth(k));
    y.into_iter().map(|y| digits.to_f64(y)).collect()
}

/// With one uniform permutation of the digits per place (Matousek 1998), of the places behind the last digit too: else
/// the origin would stay where it is.
pub(super) fn permuted(base: u64, n: usize, stream: &mut Stream) -> Vec<f64> {
    let digits = Digits::fine(base);
    let places: Vec<Vec<u32>> = (0..digits.count()).map(|_| stream.permutation(base as usize)).collect();
    let digit = |k: usize, d: u64| u64::from(places[k][d as usize]) * digits.worth(k);
    let mut y = vec![0u64; n];
    if let Some(first) = y.first_mut() {
        *first = (0..digits.count()).map(|k| digit(k, 0)).sum();
    }
    digits.fill(&mut y, |y, i, k, d| y[i - (d * digits.powers[k]) as usize] - digit(k, 0) + digit(k, d));
    y.into_iter().map(|y| digits.to_f64(y)).collect()
}

/// Nested uniform scrambling (Owen 1995): a permutation of its own for the digits behind every prefix.
///
/// As Helmer, Christensen and Kensler (2021) do in base 2: i shares exactly k digits with `r = i - d b^k`, whose digit k + 1 is the
/// image of 0. That of i is the image of d under the same permutation, so it is drawn among the images that r and the
/// numbers `r + b^k, r + 2 b^k, ..` before i have left, and the digits behind are fresh: no other point shares them.
pub(super) fn scrambled(base: u64, n: usize, stream: &mut Stream) -> Vec<f64> {
    let digits = Digits::fine(base);
    let mut y = vec![0u64; n];
    if let Some(first) = y.first_mut() {
        *first = stream.below(digits.one());
    }
    digits.fill(&mut y, |y, i, k, d| {
        let (step, worth) = (digits.powers[k] as usize, digits.worth(k));
        let whole = y[i - d as usize * step] / worth;
        let prefix = whole / base * base;
        // Images that are taken, in one word: no base here is above 64.
        let taken = (1..=d as usize).fold(0u64, |taken, back| taken | 1 << (y[i - back * step] / worth - prefix));
        let image = nth_free(taken, stream.below(base - d));
        (prefix + image) * worth + stream.below(worth)
    });
    y.into_iter().map(|y| digits.to_f64(y)).collect()
}

/// The `nth` bit, from 0, that is not set.
fn nth_free(taken: u64, nth: u64) -> u64 {
    let mut free = !taken;
    for _ in 0..nth {
        free &= free - 1;
    }
    u64::from(free.trailing_zeros())
}

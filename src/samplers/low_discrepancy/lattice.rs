//! Rank-1 lattices of Korobov's form: (i/n, i a/n, i a^2/n) modulo 1.
//!
//! `P(m) = n` where `m . z = 0 mod n`, z = (1, a, a^2), else 0. `a=widest` takes the a coprime to n whose lattice has the longest
//! shortest vector (Dammertz, Keller, "Image synthesis by rank-1 lattices", MCQMC 2008), of equals the smallest.

use std::sync::Arc;

use crate::control::Control;
use crate::error::{Error, Result};
use crate::samplers::{Accepts, Entry, Family, Given, MAX_POINTS, Parameter, Realization, Sampler, Size};
use crate::setting::Setting;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["rank-1", "korobov"],
    source: "Korobov 1959; Dammertz & Keller 2008 (widest)",
    formulas: "P = n where m_1 + a m_2 + a^2 m_3 = 0 mod n, else 0",
    size: Size::at_least::<2>("2 or more"),
    dims: 2..=3,
    parameters: &[Parameter::new(
        "a",
        "widest",
        Accepts::WordOrWhole("widest", 1, MAX_POINTS - 1),
        "the generator, below n; widest: that with the longest shortest vector",
    )],
    same_every_time: |_| true,
    ..Entry::new("lattice", Family::LowDiscrepancy, "rank-1 lattice (i/n, i a/n, i a^2/n)", make)
};

fn make(given: &Given<'_>) -> Result<Arc<dyn Sampler>> {
    let (n, dim) = (given.n, given.dim);
    let a = match given.values.whole("a")? {
        Some(a) if a < n => a,
        Some(a) => {
            let reason = format!("a of lattice is a whole number from 1 to n - 1 = {}", n - 1);
            return Err(Error::setting(Setting::Params, format!("a={a}"), reason));
        }
        None => widest(n, dim),
    };
    let square = (u128::from(a) * u128::from(a) % u128::from(n)) as u64;
    Ok(Arc::new(Lattice { n, z: [1, a, square][..dim].to_vec() }))
}

/// A rank-1 lattice.
pub(super) struct Lattice {
    pub(super) n: u64,
    /// The generating vector, below n: products with i < n stay below 2^64.
    pub(super) z: Vec<u64>,
}

impl Sampler for Lattice {
    fn generate(&self, which: &Realization, _: &Control) -> Result<Vec<f64>> {
        let n = self.n;
        Ok((0..which.n).flat_map(|i| self.z.iter().map(move |z| (i * z % n) as f64 / n as f64)).collect())
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let n = i128::from(self.n);
        let turns: i128 = m.iter().zip(&self.z).map(|(&m, &z)| i128::from(m) * i128::from(z)).sum();
        Some(if turns % n == 0 { self.n as f64 } else { 0.0 })
    }
}

/// The a coprime to n with the longest shortest vector; of equals the smallest.
fn widest(n: u64, dim: usize) -> u64 {
    // a and n - a have mirror images of each other's lattices.
    let candidates = (1..=(n / 2).max(1)).filter(|&a| coprime(a, n));
    let mut best = (1, 0);
    for a in candidates {
        let shortest2 = if dim == 2 { shortest2_in_plane(a, n) } else { shortest2_in_space(a, n) };
        if shortest2 > best.1 {
            best = (a, shortest2);
        }
    }
    best.0
}

fn coprime(mut a: u64, mut b: u64) -> bool {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// The square of the length of the shortest vector of the lattice spanned by (1, a) and (0, n), by Gauss's reduction. Squares stay below
/// 2^63 for n up to 1e8.
fn shortest2_in_plane(a: u64, n: u64) -> i128 {
    let dot = |a: [i64; 2], b: [i64; 2]| a[0] * b[0] + a[1] * b[1];
    let (mut short, mut long) = ([1, a as i64], [0, n as i64]);
    loop {
        if dot(short, short) > dot(long, long) {
            (short, long) = (long, short);
        }
        let (along, own) = (dot(short, long), dot(short, short));
        // To the nearest whole number, halves toward 0.
        let times = (2 * along.abs() + own - 1) / (2 * own) * along.signum();
        if times == 0 {
            return i128::from(own);
        }
        long = [long[0] - times * short[0], long[1] - times * short[1]];
    }
}

/// As in the plane, of (1, a, a^2), (0, n, 0), (0, 0, n): a basis reduced in the sense of Minkowski begins with a shortest vector
/// (Semaev, "A 3-dimensional lattice reduction algorithm", 2001).
fn shortest2_in_space(a: u64, n: u64) -> i128 {
    let (a, n) = (i128::from(a), i128::from(n));
    let mut basis = [[1, a, a * a % n], [0, n, 0], [0, 0, n]];
    loop {
        basis.sort_by_key(|b| dot(b, b));
        let [mut b0, mut b1, b2] = basis;
        let mut pair = [b0, b1];
        reduce_pair(&mut pair);
        [b0, b1] = pair;
        let shorter = closest_in_plane(&b0, &b1, &b2);
        let done = dot(&shorter, &shorter) >= dot(&b2, &b2);
        basis = [b0, b1, if done { b2 } else { shorter }];
        if done {
            return basis.iter().map(|b| dot(b, b)).min().unwrap_or(0);
        }
    }
}

/// Gauss's reduction: the first becomes a shortest vector.
fn reduce_pair<const D: usize>(basis: &mut [[i128; D]; 2]) {
    loop {
        if dot(&basis[0], &basis[0]) > dot(&basis[1], &basis[1]) {
            basis.swap(0, 1);
        }
        let times = rounded(dot(&basis[0], &basis[1]), dot(&basis[0], &basis[0]));
        if times == 0 {
            return;
        }
        basis[1] = minus(&basis[1], &basis[0], times);
    }
}

/// `c` less the multiples of two reduced vectors that bring it closest to the origin.
fn closest_in_plane<const D: usize>(a: &[i128; D], b: &[i128; D], c: &[i128; D]) -> [i128; D] {
    let (aa, ab, bb, ac, bc) = (dot(a, a), dot(a, b), dot(b, b), dot(a, c), dot(b, c));
    let determinant = aa * bb - ab * ab;
    let (x, y) = (rounded(ac * bb - bc * ab, determinant), rounded(bc * aa - ac * ab, determinant));
    let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (x, y)));
    let all = around.map(|(x, y)| minus(&minus(c, a, x), b, y));
    all.min_by_key(|v| dot(v, v)).unwrap_or(*c)
}

fn dot<const D: usize>(a: &[i128; D], b: &[i128; D]) -> i128 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus<const D: usize>(a: &[i128; D], b: &[i128; D], times: i128) -> [i128; D] {
    std::array::from_fn(|k| a[k] - times * b[k])
}

/// The whole number nearest to a / b, b positive; halves toward 0, so that a reduction ends.
fn rounded(a: i128, b: i128) -> i128 {
    let up = (2 * a.abs() + b - 1) / (2 * b);
    if a < 0 { -up } else { up }
}

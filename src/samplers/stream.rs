//! Random numbers that depend on a realization's identity and on nothing else.
//!
//! ChaCha8 (Bernstein 2008) with
//!
//! ```text
//! key    = h || seed || n || dim                          four little-endian u64; n is 0 for sequences
//! h      = FNV-1a, 64 bit, of  name 0x00 key=value 0x00 key=value 0x00 ...
//! stream = index of the realization
//! ```
//!
//! Parameters come in the order of their declaration, defaults written out, numbers in Rust's shortest round-trip form: a
//! default given explicitly changes nothing. Those without identity (`shift`, the number of steps of a relaxation) are
//! left out, so that sets that differ in them alone can be compared point by point. A cipher needs no hashing of its key,
//! so no two (seed, n, dim) ever share a stream, and only the text passes through a hash.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Which realization of a process. Together with the process's name and parameters it determines every bit of the points:
/// not the order in which realizations are drawn, nor the number of threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Realization {
    /// Number of points, or its expectation where the process draws it.
    pub n: u64,
    /// Number of coordinates per point.
    pub dim: usize,
    /// Seed of the whole batch.
    pub seed: u64,
    /// Index within the batch.
    pub index: u64,
    /// The hash of name and parameters.
    pub(super) identity: u64,
    /// Whether n is no part of the identity.
    pub(super) sequence: bool,
}

impl Realization {
    /// Its random numbers, from the start.
    pub fn stream(&self) -> Stream {
        self.stream_of(self.identity)
    }

    /// The random numbers of one axis, for sequences whose first points do not depend on how many follow.
    pub(super) fn stream_of_axis(&self, axis: usize) -> Stream {
        self.stream_of(fnv1a(self.identity, &[b'x', axis as u8]))
    }

    /// One vector of the torus, from a stream of its own.
    pub(super) fn shift(&self) -> Vec<f64> {
        // Any other key would do; this one is the hash of the same text followed by one more word.
        let mut stream = self.stream_of(fnv1a(self.identity, b"shift\0"));
        (0..self.dim).map(|_| stream.uniform()).collect()
    }

    fn stream_of(&self, identity: u64) -> Stream {
        let mut key = [0; 32];
        let n = if self.sequence { 0 } else { self.n };
        for (bytes, word) in key.chunks_exact_mut(8).zip([identity, self.seed, n, self.dim as u64]) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(self.index);
        Stream { rng }
    }
}

/// The random numbers of one realization. For the distributions of `rand_distr` it is a generator.
pub struct Stream {
    /// The generator.
    pub rng: ChaCha8Rng,
}

impl Stream {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.rng.next_u64()
    }

    /// A multiple of 2^-53 in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 2f64.powi(-53)
    }

    /// A whole number in [0, bound), each equally likely (Lemire 2019); `bound` is at least 1.
    pub fn below(&mut self, bound: u64) -> u64 {
        loop {
            let product = u128::from(self.bits()) * u128::from(bound);
            // Products whose low half is below 2^64 mod bound are one too many for their high half.
            if product as u64 >= bound || product as u64 >= bound.wrapping_neg() % bound {
                return (product >> 64) as u64;
            }
        }
    }

    /// A permutation of 0 .. length (Fisher, Yates; Durstenfeld 1964).
    pub fn permutation(&mut self, length: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..length as u32).collect();
        for last in (1..length).rev() {
            order.swap(last, self.below(last as u64 + 1) as usize);
        }
        order
    }
}

/// The hash of a name and its parameters.
pub(super) fn identity(name: &str, canonical: impl Iterator<Item = String>) -> u64 {
    let text = std::iter::once(name.to_owned()).chain(canonical);
    let bytes: Vec<u8> = text.flat_map(|t| t.into_bytes().into_iter().chain([0])).collect();
    fnv1a(0xcbf2_9ce4_8422_2325, &bytes)
}

/// Fowler, Noll, Vo (1991), 64 bit, variant 1a, going on from `start`.
fn fnv1a(start: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(start, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_hashes() {
        let hash = |bytes| fnv1a(0xcbf2_9ce4_8422_2325, bytes);
        assert_eq!(hash(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(hash(b"foobar"), 0x8594_4171_f739_67e8);
    }
}

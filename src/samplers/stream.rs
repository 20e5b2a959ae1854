//! Random numbers that depend on a realization's identity and on nothing else.
//!
//! ChaCha8 (Bernstein 2008) with
//!
//! ```text
//! key    = h || seed || n || dim                          four little-endian u64
//! h      = FNV-1a, 64 bit, of  name 0x00 key=value 0x00 key=value 0x00 ...
//! stream = index of the realization
//! ```
//!
//! Parameters come in the order of their declaration, defaults written out, numbers in Rust's shortest round-trip form: a
//! default given explicitly changes nothing. A cipher needs no hashing of its key, so no two (seed, n, dim) ever share a
//! stream, and only the text passes through a hash.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::{ParameterValues, Realization, Sampler};

/// The generator of one realization.
pub(super) fn stream(sampler: &dyn Sampler, values: &ParameterValues, realization: &Realization) -> ChaCha8Rng {
    let text = std::iter::once(sampler.name().to_owned()).chain(values.canonical());
    let identity: Vec<u8> = text.flat_map(|t| t.into_bytes().into_iter().chain([0])).collect();
    let mut key = [0; 32];
    let words = [fnv1a(&identity), realization.seed, realization.n, realization.dim as u64];
    for (bytes, word) in key.chunks_exact_mut(8).zip(words) {
        bytes.copy_from_slice(&word.to_le_bytes());
    }
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(realization.index);
    rng
}

/// A multiple of 2^-53 in [0, 1).
pub(super) fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * 2f64.powi(-53)
}

/// Fowler, Noll, Vo (1991), 64 bit, variant 1a.
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_published_hashes() {
        assert_eq!(super::fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(super::fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(super::fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }
}

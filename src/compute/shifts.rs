//! Where integrands are looked at: points as fractions of the box, and their random shifts.

use crate::points::Ensemble;

/// Coordinates of realization `k` as fractions of the box, point by point, as they were given: whether a point is inside of a set is
/// decided by them, not by integers near them.
pub(super) fn places(ensemble: &Ensemble, k: usize) -> Vec<[f64; 3]> {
    let domain = ensemble.domain();
    let mut places = vec![[0.0; 3]; ensemble.points_in(k)];
    for a in 0..domain.dim() {
        let mut put = |j: usize, x: f64| places[j][a] = wrapped(x);
        match ensemble.coordinates(k) {
            Some(given) => {
                let (origin, side) = (domain.origin()[a], domain.sides()[a]);
                given[a].iter().enumerate().for_each(|(j, x)| put(j, (x - origin) / side));
            }
            None => ensemble.turns(k, a).enumerate().for_each(|(j, x)| put(j, x)),
        }
    }
    places
}

/// `x` folded into [0, 1).
pub(super) fn wrapped(x: f64) -> f64 {
    if (0.0..1.0).contains(&x) {
        return x;
    }
    let folded = x - x.floor();
    // The rest of a tiny negative number rounds to 1.
    if folded < 1.0 { folded } else { 0.0 }
}

/// The random shift of a realization: SplitMix64 of its index in the batch, so that it depends on nothing else.
pub(super) fn random_shift(index: u64) -> [f64; 3] {
    let mut state = index.wrapping_mul(3).wrapping_add(0x5851_f42d_4c95_7f2d);
    std::array::from_fn(|_| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 2f64.powi(-53)
    })
}

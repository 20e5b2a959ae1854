//! Raw sums of `wave_power`: over realizations, of `q = |s_m|^2` and what its error needs, per stored mode and ring.

use super::ordered_sum::{LEAF, OrderedSum};
use crate::compute::ComputedBy;
use crate::error::{Error, Result};
use crate::plan::Rings;

/// Sums over realizations of `q = |s_m|^2` per stored mode (see `WaveGrid`), and of the ring sums of q, with the second
/// moments that their errors need. The additions are ordered by realization index (`OrderedSum`).
#[derive(Debug, Clone, PartialEq)]
pub struct WavePower {
    /// Who computed them.
    pub computed_by: ComputedBy,
    /// Number of realizations.
    pub realizations: u64,
    /// Sums of n and n^2 over realizations.
    pub n_moments: [u128; 2],
    modes: usize,
    rings: usize,
    /// q, q^2, q n per mode, then Q, Q^2, Q n per ring, back to back.
    sums: OrderedSum,
    leaf: Option<Leaf>,
}

#[derive(Debug, Clone, PartialEq)]
struct Leaf {
    index: u64,
    sum: Vec<f64>,
}

/// The totals of one block of `WavePower`: per mode, or per ring.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerMoments {
    /// Sum over realizations of q (or of the ring sum of q).
    pub q: Vec<f64>,
    /// Sum of its square.
    pub q_squared: Vec<f64>,
    /// Sum of q n.
    pub q_n: Vec<f64>,
}

impl WavePower {
    /// No realizations yet.
    pub fn new(computed_by: ComputedBy, modes: usize, rings: &Rings) -> Self {
        Self {
            computed_by,
            realizations: 0,
            n_moments: [0; 2],
            modes,
            rings: rings.count,
            sums: OrderedSum::default(),
            leaf: None,
        }
    }

    /// Adds realization `index` with `n` points, whose `|s_m|^2` is `power` (one value per stored mode). Indices come in
    /// increasing order.
    pub fn add<T: Copy + Into<f64>>(&mut self, index: u64, n: u64, power: &[T], rings: &Rings) {
        debug_assert_eq!(power.len(), self.modes, "one value per stored mode");
        if self.leaf.as_ref().is_some_and(|leaf| leaf.index != index / LEAF) {
            self.close_leaf();
        }
        let (modes, ring_count) = (self.modes, self.rings);
        let leaf =
            self.leaf.get_or_insert_with(|| Leaf { index: index / LEAF, sum: vec![0.0; 3 * (modes + ring_count)] });
        self.realizations += 1;
        self.n_moments[0] += u128::from(n);
        self.n_moments[1] += u128::from(n) * u128::from(n);
        let n = n as f64;
        let (mode_sums, ring_sums) = leaf.sum.split_at_mut(3 * modes);
        let mut ring_totals = vec![0.0; ring_count + 1];
        // The plane m_0 = 0 is stored whole, so a mode and its mirror image are both there; elsewhere one stands for two.
        let plane = rings.plane_len;
        for (i, (&q, sums)) in power.iter().zip(mode_sums.chunks_exact_mut(3)).enumerate() {
            let q: f64 = q.into();
            sums[0] += q;
            sums[1] += q * q;
            sums[2] += q * n;
            ring_totals[rings.ring_of[i] as usize] += if i < plane { q } else { 2.0 * q };
        }
        for (total, sums) in ring_totals[1..].iter().zip(ring_sums.chunks_exact_mut(3)) {
            sums[0] += total;
            sums[1] += total * total;
            sums[2] += total * n;
        }
        // A full leaf is closed at once, so that equal content is held in equal form.
        if (index + 1).is_multiple_of(LEAF) {
            self.close_leaf();
        }
    }

    /// Closes the leaf being filled. Called when a batch ends.
    pub fn close_leaf(&mut self) {
        if let Some(leaf) = self.leaf.take() {
            self.sums.add_leaf(leaf.index, leaf.sum);
        }
    }

    /// Adds other realizations of the same process. Both parts must consist of whole leaves of 16 realizations (the very
    /// last may be partial).
    pub fn merge(&mut self, mut other: Self) -> Result<()> {
        self.close_leaf();
        other.close_leaf();
        if (self.modes, self.rings) != (other.modes, other.rings) {
            let reason = format!("{} modes cannot be merged with {}", self.modes, other.modes);
            return Err(Error::input("wave power", reason));
        }
        if self.sums.overlaps(&other.sums) {
            return Err(Error::input("wave power", "the two parts hold the same realizations"));
        }
        self.computed_by = self.computed_by.merge(&other.computed_by);
        self.realizations += other.realizations;
        for (a, b) in self.n_moments.iter_mut().zip(&other.n_moments) {
            *a += b;
        }
        self.sums.merge(other.sums);
        Ok(())
    }

    /// Number of stored modes.
    pub fn modes(&self) -> usize {
        self.modes
    }

    /// The totals per stored mode and per ring.
    pub fn totals(&self) -> (PowerMoments, PowerMoments) {
        let mut sums = self.sums.clone();
        if let Some(leaf) = self.leaf.clone() {
            sums.add_leaf(leaf.index, leaf.sum);
        }
        let mut total = sums.total();
        total.resize(3 * (self.modes + self.rings), 0.0);
        let (modes, rings) = total.split_at(3 * self.modes);
        (unzip(modes), unzip(rings))
    }
}

fn unzip(triples: &[f64]) -> PowerMoments {
    let column = |k: usize| triples.iter().skip(k).step_by(3).copied().collect();
    PowerMoments { q: column(0), q_squared: column(1), q_n: column(2) }
}

//! Raw sums of `wave_power`: over realizations, of `q = |s_m|^2` and what its error needs, per stored mode, ring and sector.

use super::ordered_sum::{NOT_NEXT, OrderedSum};
use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};
use crate::plan::{LEAF, Rings};

/// Sums over realizations of `q = |s_m|^2` per stored mode (see `WaveVectors`), and of its sums over rings, over sectors and
/// over the upper half of the rings, with the second moments that their errors need. Each is compared with the norm
/// `N = sum_j w_j^2` of its realization: n where every point weighs 1. The additions are ordered by realization index (`OrderedSum`).
#[derive(Debug, Clone, PartialEq)]
pub struct WavePower {
    /// Who computed them.
    pub computed_by: ComputedBy,
    /// Number of realizations.
    pub realizations: u64,
    modes: usize,
    rings: usize,
    sectors: usize,
    mode_sums: OrderedSum,
    ring_sums: OrderedSum,
    leaf: Option<Leaf>,
}

/// The leaf being filled: q of every member, then q^2, then q N. `rings` holds rings, then sectors, then the upper half of the
/// rings; also N and N^2.
#[derive(Debug, Clone, PartialEq)]
struct Leaf {
    index: u64,
    modes: Vec<f64>,
    rings: Vec<f64>,
}

/// Totals over realizations, one value per mode or per ring.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerMoments {
    /// Sum over realizations of q (or of the ring sum of q).
    pub q: Vec<f64>,
    /// Sum of its square.
    pub q_squared: Vec<f64>,
    /// Sum of q N.
    pub q_n: Vec<f64>,
}

impl WavePower {
    /// No realizations yet.
    pub fn new(computed_by: ComputedBy, modes: usize, rings: &Rings) -> Self {
        Self {
            computed_by,
            realizations: 0,
            modes,
            rings: rings.count,
            sectors: rings.sectors.count,
            mode_sums: OrderedSum::default(),
            ring_sums: OrderedSum::default(),
            leaf: None,
        }
    }

    /// Adds realization `index` with norm `norm`, whose `|s_m|^2` is `power` (one value per stored mode). Indices come in
    /// increasing order.
    pub fn add<T: Copy + Into<f64>>(&mut self, index: u64, norm: f64, power: &[T], rings: &Rings) {
        debug_assert_eq!(power.len(), self.modes, "one value per stored mode");
        if self.leaf.as_ref().is_some_and(|leaf| leaf.index != index / LEAF) {
            self.close_leaf();
        }
        let (modes, ring_count, groups) = (self.modes, self.rings, self.groups());
        let leaf = self.leaf.get_or_insert_with(|| Leaf {
            index: index / LEAF,
            modes: vec![0.0; 3 * modes],
            rings: vec![0.0; 3 * groups + 2],
        });
        self.realizations += 1;
        add_moments(&mut leaf.modes, power.iter().map(|&q| q.into()), norm);
        let mut totals = vec![0.0; ring_count + 1];
        for ((&q, &ring), &times) in power.iter().zip(&rings.ring_of).zip(&rings.times) {
            totals[ring as usize] += f64::from(times) * q.into();
        }
        let mut sectors = vec![0.0; self.sectors + 1];
        for ((&q, &sector), &times) in power.iter().zip(&rings.sectors.sector_of).zip(&rings.times) {
            sectors[sector as usize] += f64::from(times) * q.into();
        }
        let upper: f64 = totals[1..][rings.upper()].iter().sum();
        let (moments, norms) = leaf.rings.split_at_mut(3 * groups);
        add_moments(moments, totals[1..].iter().chain(&sectors[1..]).copied().chain([upper]), norm);
        norms[0] += norm;
        norms[1] += norm * norm;
        // A full leaf is closed at once, so that equal content is held in equal form.
        if (index + 1).is_multiple_of(LEAF) {
            self.close_leaf();
        }
    }

    /// Closes the leaf being filled. Called when a batch ends.
    pub fn close_leaf(&mut self) {
        if let Some(leaf) = self.leaf.take() {
            self.mode_sums.add_leaf(leaf.index, leaf.modes);
            self.ring_sums.add_leaf(leaf.index, leaf.rings);
        }
    }

    /// Adds the realization that follows, to those of one leaf that is not full.
    ///
    /// # Errors
    /// A realization of another leaf.
    pub fn append(&mut self, mut next: Self) -> Result<()> {
        self.close_leaf();
        next.close_leaf();
        if !(self.mode_sums.append(&next.mode_sums) && self.ring_sums.append(&next.ring_sums)) {
            return Err(Error::input("wave power", NOT_NEXT));
        }
        self.computed_by = self.computed_by.merge(&next.computed_by);
        self.realizations += next.realizations;
        Ok(())
    }

    /// Adds other realizations of the same process. Both parts must consist of whole leaves of 16 realizations (the very
    /// last may be partial).
    ///
    /// # Errors
    /// Sums of another shape; realizations that both hold, or a leaf that was cut.
    pub fn merge(&mut self, mut other: Self) -> Result<()> {
        self.close_leaf();
        other.close_leaf();
        let kind = |p: &Self| (p.modes, p.rings, p.sectors);
        if kind(self) != kind(&other) {
            let reason = format!("{} modes cannot be merged with {}, or the sectors differ", self.modes, other.modes);
            return Err(Error::input("wave power", reason));
        }
        if self.mode_sums.overlaps(&other.mode_sums) {
            return Err(Error::input(
                "wave power",
                "the two parts hold the same realizations, or were not cut at multiples of 16",
            ));
        }
        self.computed_by = self.computed_by.merge(&other.computed_by);
        self.realizations += other.realizations;
        self.mode_sums.merge(other.mode_sums);
        self.ring_sums.merge(other.ring_sums);
        Ok(())
    }

    /// Number of stored modes.
    pub fn modes(&self) -> usize {
        self.modes
    }

    /// The totals per stored mode.
    pub fn mode_totals(&self) -> PowerMoments {
        let open = self.leaf.as_ref().map(|leaf| (leaf.index, leaf.modes.as_slice()));
        PowerMoments::of(self.mode_sums.total_with(open), self.modes)
    }

    /// The totals per ring.
    pub fn ring_totals(&self) -> PowerMoments {
        self.group_totals(0..self.rings)
    }

    /// The totals per sector.
    pub fn sector_totals(&self) -> PowerMoments {
        self.group_totals(self.rings..self.rings + self.sectors)
    }

    /// The totals of the upper half of the rings (`Rings::upper`) together: one value.
    pub fn upper_totals(&self) -> PowerMoments {
        self.group_totals(self.groups() - 1..self.groups())
    }

    /// Rings, sectors, and the upper half of the rings.
    fn groups(&self) -> usize {
        self.rings + self.sectors + 1
    }

    fn group_totals(&self, range: std::ops::Range<usize>) -> PowerMoments {
        let mut totals = self.ring_sums();
        totals.truncate(3 * self.groups());
        let all = PowerMoments::of(totals, self.groups());
        let part = |v: &[f64]| v[range.clone()].to_vec();
        PowerMoments { q: part(&all.q), q_squared: part(&all.q_squared), q_n: part(&all.q_n) }
    }

    /// The sums of N and N^2 over realizations.
    pub fn norm_totals(&self) -> [f64; 2] {
        match self.ring_sums()[..] {
            [.., n, squared] => [n, squared],
            _ => [0.0; 2],
        }
    }

    fn ring_sums(&self) -> Vec<f64> {
        let open = self.leaf.as_ref().map(|leaf| (leaf.index, leaf.rings.as_slice()));
        self.ring_sums.total_with(open)
    }
}

impl Sums for WavePower {
    fn merge(&mut self, other: Self) -> Result<()> {
        Self::merge(self, other)
    }

    fn append(&mut self, next: Self) -> Result<()> {
        Self::append(self, next)
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        let mut closed = self.clone();
        closed.close_leaf();
        closed.computed_by.encode(out);
        out.value("realizations", closed.realizations);
        out.value("members", vec![closed.modes, closed.rings, closed.sectors]);
        closed.mode_sums.encode("modes", out);
        closed.ring_sums.encode("rings", out);
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let [modes, rings, sectors]: [usize; 3] = from.read("members")?;
        let groups = rings.saturating_add(sectors).saturating_add(1);
        Ok(Self {
            computed_by: ComputedBy::decode(from)?,
            realizations: from.count("realizations")?,
            modes,
            rings,
            sectors,
            mode_sums: OrderedSum::decode("modes", modes.saturating_mul(3), from)?,
            ring_sums: OrderedSum::decode("rings", groups.saturating_mul(3).saturating_add(2), from)?,
            leaf: None,
        })
    }
}

/// Adds q, q^2 and q N of one realization to sums laid out one after the other.
fn add_moments(sums: &mut [f64], values: impl Iterator<Item = f64>, n: f64) {
    let members = sums.len() / 3;
    let (q_sums, rest) = sums.split_at_mut(members);
    let (square_sums, n_sums) = rest.split_at_mut(members);
    for (((q, sum), squares), with_n) in values.zip(q_sums).zip(square_sums).zip(n_sums) {
        *sum += q;
        *squares += q * q;
        *with_n += q * n;
    }
}

impl PowerMoments {
    fn of(mut sums: Vec<f64>, members: usize) -> Self {
        sums.resize(3 * members, 0.0);
        let q_n = sums.split_off(2 * members);
        let q_squared = sums.split_off(members);
        Self { q: sums, q_squared, q_n }
    }
}

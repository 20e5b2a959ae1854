//! Raw sums of a kernel estimate: over realizations, of the kernel sums and what their error needs, per r.

use super::ordered_sum::{NOT_NEXT, OrderedSum};
use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};
use crate::plan::LEAF;

/// The kernel sums of one realization, one value per r.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelCurve {
    /// What `sums` is compared with by both normalizations: ordered pairs `n (n - 1)` and `n^2`, or what stands for them
    /// where points have weights.
    pub norms: [f64; 2],
    /// `sum w k` over ordered pairs.
    pub sums: Vec<f64>,
    /// Over unordered pairs, the square of what both orders add to `sums`.
    pub squares: Vec<f64>,
    /// Bound on the error of `sums`; 0 where every pair is taken at its own distance.
    pub bounds: Vec<f64>,
    /// Ordered pairs at distance 0, left out because they would be divided by 0.
    pub coincident: u64,
}

impl KernelCurve {
    /// At `len` distances, no pairs yet.
    pub(crate) fn new(norms: [f64; 2], len: usize) -> Self {
        let zeros = || vec![0.0; len];
        Self { norms, sums: zeros(), squares: zeros(), bounds: zeros(), coincident: 0 }
    }

    /// Adds other pairs of the same realization.
    pub(crate) fn merge(&mut self, part: &Self) {
        for (a, b) in
            [(&mut self.sums, &part.sums), (&mut self.squares, &part.squares), (&mut self.bounds, &part.bounds)]
        {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
        self.coincident += part.coincident;
    }
}

/// Sums over realizations. The additions are ordered by realization index (`OrderedSum`).
#[derive(Debug, Clone, PartialEq)]
pub struct KernelSums {
    /// Who computed them.
    pub computed_by: ComputedBy,
    /// Number of realizations.
    pub realizations: u64,
    /// Ordered pairs at distance 0 that were left out.
    pub coincident: u64,
    len: usize,
    moments: OrderedSum,
    /// The leaf being filled.
    leaf: Option<(u64, Vec<f64>)>,
}

/// Totals over realizations. `c` is the kernel sum of one realization, `N` what it is compared with, by both normalizations.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelMoments {
    /// `sum c`, per r.
    pub sums: Vec<f64>,
    /// `sum c^2`.
    pub sum_squares: Vec<f64>,
    /// `sum c N`, by normalization.
    pub products: [Vec<f64>; 2],
    /// Sum of `KernelCurve::squares`.
    pub squares: Vec<f64>,
    /// Sum of `KernelCurve::bounds`.
    pub bounds: Vec<f64>,
    /// `sum N` and `sum N^2`, by normalization.
    pub norms: [[f64; 2]; 2],
}

/// Values per r in a leaf, and those after them.
const PER_R: usize = 6;
const NORMS: usize = 4;

impl KernelSums {
    /// No realizations yet, at `len` distances.
    pub fn new(computed_by: ComputedBy, len: usize) -> Self {
        Self { computed_by, realizations: 0, coincident: 0, len, moments: OrderedSum::default(), leaf: None }
    }

    /// Adds realization `index`. Indices come in increasing order.
    pub fn add(&mut self, index: u64, curve: &KernelCurve) {
        debug_assert_eq!(curve.sums.len(), self.len, "one value per r");
        if self.leaf.as_ref().is_some_and(|(leaf, _)| *leaf != index / LEAF) {
            self.close_leaf();
        }
        self.realizations += 1;
        self.coincident += curve.coincident;
        let len = self.len;
        let (_, sums) = self.leaf.get_or_insert_with(|| (index / LEAF, vec![0.0; PER_R * len + NORMS]));
        let [pairs, squared] = curve.norms;
        for k in 0..len {
            let c = curve.sums[k];
            let values = [c, c * c, c * pairs, c * squared, curve.squares[k], curve.bounds[k]];
            for (part, value) in values.into_iter().enumerate() {
                sums[part * len + k] += value;
            }
        }
        for (sum, value) in sums[PER_R * len..].iter_mut().zip([pairs, pairs * pairs, squared, squared * squared]) {
            *sum += value;
        }
        // A full leaf is closed at once, so that equal content is held in equal form.
        if (index + 1).is_multiple_of(LEAF) {
            self.close_leaf();
        }
    }

    /// Closes the leaf being filled. Called when a batch ends.
    pub fn close_leaf(&mut self) {
        if let Some((leaf, sums)) = self.leaf.take() {
            self.moments.add_leaf(leaf, sums);
        }
    }

    /// Adds the realization that follows, to those of one leaf that is not full.
    ///
    /// # Errors
    /// A realization of another leaf.
    pub fn append(&mut self, mut next: Self) -> Result<()> {
        self.close_leaf();
        next.close_leaf();
        if !self.moments.append(&next.moments) {
            return Err(Error::input("kernel sums", NOT_NEXT));
        }
        self.computed_by = self.computed_by.merge(&next.computed_by);
        self.realizations += next.realizations;
        self.coincident += next.coincident;
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
        if self.len != other.len {
            let reason = format!("{} distances cannot be merged with {}", self.len, other.len);
            return Err(Error::input("kernel sums", reason));
        }
        if self.moments.overlaps(&other.moments) {
            let reason = "the two parts hold the same realizations, or were not cut at multiples of 16";
            return Err(Error::input("kernel sums", reason));
        }
        self.computed_by = self.computed_by.merge(&other.computed_by);
        self.realizations += other.realizations;
        self.coincident += other.coincident;
        self.moments.merge(other.moments);
        Ok(())
    }

    /// The totals.
    pub fn totals(&self) -> KernelMoments {
        let open = self.leaf.as_ref().map(|(leaf, sums)| (*leaf, sums.as_slice()));
        let mut all = self.moments.total_with(open);
        all.resize(PER_R * self.len + NORMS, 0.0);
        let part = |k: usize| all[k * self.len..(k + 1) * self.len].to_vec();
        let n = &all[PER_R * self.len..];
        KernelMoments {
            sums: part(0),
            sum_squares: part(1),
            products: [part(2), part(3)],
            squares: part(4),
            bounds: part(5),
            norms: [[n[0], n[1]], [n[2], n[3]]],
        }
    }
}

impl Sums for KernelSums {
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
        out.value("coincident", closed.coincident);
        out.value("distances", closed.len);
        closed.moments.encode("moments", out);
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let len: usize = from.read("distances")?;
        let values = len.saturating_mul(PER_R).saturating_add(NORMS);
        Ok(Self {
            computed_by: ComputedBy::decode(from)?,
            realizations: from.count("realizations")?,
            coincident: from.count("coincident")?,
            len,
            moments: OrderedSum::decode("moments", values, from)?,
            leaf: None,
        })
    }
}

//! Sums of f64 over realizations that do not depend on how the batch was cut or how many threads worked on it.
//!
//! Floating-point addition is not associative, so "the same sum" must mean "the same additions". Realizations are
//! grouped into leaves of `LEAF` by index; a leaf is summed in index order; leaves are added pairwise along the binary
//! tree over leaf indices. Every node of that tree has one value whatever the order in which parts arrive, and merging
//! two shards only completes nodes. At most log2(leaves) nodes are held per contiguous range.

use std::collections::BTreeMap;

use super::{Decoder, Encoder};
use crate::error::Result;

/// Why an `append` was refused.
pub(super) const NOT_NEXT: &str = "only a realization of the same leaf can be appended";

/// A vector of sums over realizations, in a fixed order of additions.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OrderedSum {
    /// Complete nodes, keyed by (level, index): node `(l, i)` holds leaves `[i 2^l, (i + 1) 2^l)`. No two nodes here
    /// are siblings.
    nodes: BTreeMap<(u32, u64), Vec<f64>>,
}

impl OrderedSum {
    /// Adds the sum over one whole leaf (or the last, partial one). `leaf = realization index / LEAF`.
    ///
    /// # Panics
    /// If the leaf is there already: the same realizations counted twice is a bug of ours.
    pub fn add_leaf(&mut self, leaf: u64, sum: Vec<f64>) {
        self.insert(0, leaf, sum);
    }

    /// Adds all realizations of `other`, which must be disjoint.
    pub fn merge(&mut self, other: Self) {
        for ((level, index), sum) in other.nodes {
            self.insert(level, index, sum);
        }
    }

    /// Adds `next`, the realization that follows those of the leaf that is all of `self`. So a leaf that grows by one
    /// realization at a time has the bytes of the leaf added at once. Whether both are of the same leaf.
    #[must_use]
    pub fn append(&mut self, next: &Self) -> bool {
        let (mut here, mut there) = (self.nodes.iter_mut(), next.nodes.iter());
        match (here.next(), there.next(), here.next(), there.next()) {
            (Some((&(0, a), sum)), Some((&(0, b), single)), None, None) if a == b => {
                sum.iter_mut().zip(single).for_each(|(a, b)| *a += b);
                true
            }
            _ => false,
        }
    }

    fn insert(&mut self, mut level: u32, mut index: u64, mut sum: Vec<f64>) {
        while let Some(sibling) = self.nodes.remove(&(level, index ^ 1)) {
            // Left plus right; addition commutes, so which of them arrived first is not seen.
            for (a, b) in sum.iter_mut().zip(&sibling) {
                *a += b;
            }
            level += 1;
            index >>= 1;
        }
        let before = self.nodes.insert((level, index), sum);
        assert!(before.is_none(), "leaf {index} of level {level} was added twice");
    }

    /// Writes the nodes.
    pub(super) fn encode(&self, name: &str, out: &mut Encoder) {
        out.within(name, |out| {
            out.u64s("nodes", self.nodes.keys().flat_map(|&(level, index)| [u64::from(level), index]));
            out.f64s("sums", self.nodes.values().flatten().copied());
        });
    }

    /// Reads what `encode` wrote: nodes of `len` values each.
    pub(super) fn decode(name: &str, len: usize, from: &mut Decoder<'_>) -> Result<Self> {
        from.within(name, |from| {
            let keys = from.u64s("nodes")?;
            let (keys, rest) = keys.as_chunks::<2>();
            let sums = from.f64s_of("sums", keys.len().saturating_mul(len))?;
            let mut read = Self::default();
            let sums = (0..keys.len()).map(|k| sums[k * len..(k + 1) * len].to_vec());
            for (&[level, index], sum) in keys.iter().zip(sums) {
                // Levels and indices whose realizations can be counted.
                let level = u32::try_from(level).ok().filter(|&l| l < 60 && index < 1 << (60 - l));
                let one = level.map(|level| Self { nodes: BTreeMap::from([((level, index), sum)]) });
                match one.filter(|one| rest.is_empty() && !read.overlaps(one)) {
                    Some(one) => read.nodes.extend(one.nodes),
                    None => return Err(from.error("its sums do not lie in one tree over realizations")),
                }
            }
            Ok(read)
        })
    }

    /// Whether leaves of `other` are here already.
    pub fn overlaps(&self, other: &Self) -> bool {
        let span = |(level, index): &(u32, u64)| (index << level)..((index + 1) << level);
        self.nodes
            .keys()
            .any(|a| other.nodes.keys().any(|b| span(a).start < span(b).end && span(b).start < span(a).end))
    }

    /// The total: nodes from the left, smallest leaf index first. Empty if nothing was added.
    pub fn total(&self) -> Vec<f64> {
        self.total_with(None)
    }

    /// The total as if `leaf` (its index and sum) had been added too.
    pub fn total_with(&self, leaf: Option<(u64, &[f64])>) -> Vec<f64> {
        let mut with_leaf;
        let nodes = match leaf {
            None => &self.nodes,
            Some((index, sum)) => {
                with_leaf = self.clone();
                with_leaf.add_leaf(index, sum.to_vec());
                &with_leaf.nodes
            }
        };
        let mut nodes: Vec<_> = nodes.iter().map(|(&(level, index), sum)| (index << level, sum)).collect();
        nodes.sort_unstable_by_key(|&(start, _)| start);
        let mut nodes = nodes.into_iter();
        let Some((_, first)) = nodes.next() else { return Vec::new() };
        nodes.fold(first.clone(), |mut total, (_, sum)| {
            for (a, b) in total.iter_mut().zip(sum) {
                *a += b;
            }
            total
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf(i: u64) -> Vec<f64> {
        // Magnitudes far apart, so that any other order of additions gives other bits.
        vec![(1.0 + i as f64).powi(if i.is_multiple_of(3) { 30 } else { -3 }), 0.1 * i as f64]
    }

    fn sum_of(range: std::ops::Range<u64>) -> OrderedSum {
        let mut sum = OrderedSum::default();
        range.for_each(|i| sum.add_leaf(i, leaf(i)));
        sum
    }

    #[test]
    fn any_cut_and_any_order_gives_the_same_bytes() {
        let whole = sum_of(0..37);
        for cut in 1..37 {
            let mut left = sum_of(0..cut);
            left.merge(sum_of(cut..37));
            assert_eq!(left, whole, "cut at {cut}");
            let mut right = sum_of(cut..37);
            right.merge(sum_of(0..cut));
            assert_eq!(right.total(), whole.total(), "cut at {cut}, reversed");
        }
        let mut shuffled = OrderedSum::default();
        (0..37).for_each(|i| shuffled.add_leaf(i * 11 % 37, leaf(i * 11 % 37)));
        assert_eq!(shuffled, whole);
    }

    /// Leaves 0 to 6 are nodes of 4, of 2 and of 1: 1 is lost in what is added to it first, and would be left if it came last.
    #[test]
    fn totals_are_added_from_the_left() {
        let mut sum = OrderedSum::default();
        let values = [0.25, 0.25, 0.25, 0.25, 5e15, 5e15, -1e16];
        (0..).zip(values).for_each(|(leaf, value)| sum.add_leaf(leaf, vec![value]));
        assert_eq!(sum.total(), [0.0]);
    }

    #[test]
    fn a_leaf_that_grows_has_the_bytes_of_one_added_at_once() {
        let values = [1e30, -0.1, 3e-3, 7e12, 0.1];
        let single = |v| {
            let mut sum = OrderedSum::default();
            sum.add_leaf(3, vec![v]);
            sum
        };
        let mut grown = single(values[0]);
        assert!(values[1..].iter().all(|&v| grown.append(&single(v))));
        assert_eq!(grown.total(), [values.iter().fold(0.0, |sum, v| sum + v)]);
        assert!(!grown.append(&sum_of(4..5)), "another leaf");
        assert!(!grown.append(&sum_of(0..2)), "more than a leaf");
    }

    #[test]
    fn few_nodes_are_held() {
        assert!(sum_of(0..1000).nodes.len() <= 10);
        assert!(sum_of(0..4).overlaps(&sum_of(3..5)));
        assert!(!sum_of(0..4).overlaps(&sum_of(4..5)));
    }

    #[test]
    #[should_panic(expected = "added twice")]
    fn the_same_leaf_twice_is_refused() {
        let mut sum = sum_of(0..1);
        sum.add_leaf(0, leaf(0));
    }
}

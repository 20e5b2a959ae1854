//! Numbers of points of the realizations that were measured.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::plan::EnsembleShape;

/// Runs of realizations of equally many points: a million of them alike take no more memory than one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Sizes {
    /// By the first of a run: one past its last, and how many points each has.
    runs: BTreeMap<u64, (u64, u64)>,
    len: u64,
}

impl Sizes {
    /// Realizations of so many points each; `false`, and nothing is changed, if some of them are here already.
    pub(super) fn add(&mut self, range: Range<u64>, n: u64) -> bool {
        if range.is_empty() {
            return true;
        }
        let before = self.runs.range(..range.end).next_back().map(|(&start, &(end, n))| (start, end, n));
        if before.is_some_and(|(_, end, _)| end > range.start) {
            return false;
        }
        let (mut start, mut end) = (range.start, range.end);
        if let Some((first, _, _)) = before.filter(|&(_, last, of)| last == range.start && of == n) {
            start = first;
        }
        if let Some(&(last, _)) = self.runs.get(&range.end).filter(|run| run.1 == n) {
            self.runs.remove(&range.end);
            end = last;
        }
        self.runs.insert(start, (end, n));
        self.len += range.end - range.start;
        true
    }

    /// Runs of equally many points, in order.
    pub(super) fn runs(&self) -> impl Iterator<Item = (Range<u64>, u64)> {
        self.runs.iter().map(|(&start, &(end, n))| (start..end, n))
    }

    /// Those of a range of realizations.
    pub(super) fn within(&self, range: &Range<u64>) -> impl Iterator<Item = (Range<u64>, u64)> {
        let first = self.runs.range(..=range.start).next_back().map_or(range.start, |(&start, _)| start);
        let cut = move |(&start, &(end, n)): (&u64, &(u64, u64))| (start.max(range.start)..end.min(range.end), n);
        self.runs.range(first..range.end.max(first)).map(cut).filter(|(run, _)| !run.is_empty())
    }

    /// How many of a range there are.
    pub(super) fn count(&self, range: &Range<u64>) -> u64 {
        self.within(range).map(|(run, _)| run.end - run.start).sum()
    }

    /// How many realizations there are.
    pub(super) fn len(&self) -> u64 {
        self.len
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// One number for each realization, in order.
    pub(super) fn values(&self) -> impl Iterator<Item = u64> {
        self.runs().flat_map(|(run, n)| run.map(move |_| n))
    }

    /// The fewest points.
    pub(super) fn least(&self) -> u64 {
        self.runs().map(|(_, n)| n).min().unwrap_or(0)
    }

    pub(super) fn shape(&self) -> EnsembleShape {
        EnsembleShape::of_runs(self.runs().map(|(run, n)| (run.end - run.start, n)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_join_and_no_realization_is_there_twice() {
        let mut sizes = Sizes::default();
        assert!(sizes.add(16..32, 5) && sizes.add(0..16, 5) && sizes.add(40..48, 5) && sizes.add(32..40, 5));
        assert_eq!(sizes.runs().collect::<Vec<_>>(), [(0..48, 5)]);
        assert!(!sizes.add(47..49, 5) && !sizes.add(0..1, 5));
        assert!(sizes.add(48..50, 6) && sizes.add(60..61, 6));
        assert_eq!(sizes.runs().collect::<Vec<_>>(), [(0..48, 5), (48..50, 6), (60..61, 6)]);
        assert_eq!((sizes.len(), sizes.least(), sizes.count(&(40..61))), (51, 5, 11));
        assert_eq!(sizes.within(&(47..60)).collect::<Vec<_>>(), [(47..48, 5), (48..50, 6)]);
        assert_eq!(sizes.values().count(), 51);
        let all: Vec<u64> = sizes.values().collect();
        assert_eq!(sizes.shape(), EnsembleShape::of(&all));
    }
}

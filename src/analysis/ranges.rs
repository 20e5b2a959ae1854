//! Which realizations something holds.

use std::ops::Range;

/// Disjoint ranges of indices, in order, none next to another.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Ranges(Vec<Range<u64>>);

impl Ranges {
    /// Adds indices that are not here yet.
    pub(super) fn add(&mut self, range: Range<u64>) {
        if range.is_empty() {
            return;
        }
        self.0.push(range);
        self.0.sort_by_key(|r| r.start);
        let mut joined: Vec<Range<u64>> = Vec::with_capacity(self.0.len());
        for range in self.0.drain(..) {
            match joined.last_mut() {
                Some(last) if last.end >= range.start => last.end = last.end.max(range.end),
                _ => joined.push(range),
            }
        }
        self.0 = joined;
    }

    /// Adds those of `other`.
    pub(super) fn merge(&mut self, other: &Self) {
        other.0.iter().for_each(|range| self.add(range.clone()));
    }

    /// The first index that both hold.
    pub(super) fn common(&self, other: &Self) -> Option<Range<u64>> {
        let meet = |a: &Range<u64>, b: &Range<u64>| a.start.max(b.start)..a.end.min(b.end);
        self.0.iter().flat_map(|a| other.0.iter().map(move |b| meet(a, b))).find(|r| !r.is_empty())
    }

    /// How many indices there are.
    pub(super) fn count(&self) -> u64 {
        self.0.iter().map(|r| r.end - r.start).sum()
    }

    /// One past the last index.
    pub(super) fn end(&self) -> u64 {
        self.0.last().map_or(0, |r| r.end)
    }

    /// The first gap within `span`, to its end.
    pub(super) fn gap(&self, span: &Range<u64>) -> Option<Range<u64>> {
        let mut start = span.start;
        for range in &self.0 {
            if range.start > start {
                break;
            }
            start = start.max(range.end);
        }
        let end = self.0.iter().map(|r| r.start).filter(|&s| s > start).min().unwrap_or(span.end);
        let gap = start..end.min(span.end);
        (!gap.is_empty()).then_some(gap)
    }

    /// Those from `start` on are forgotten.
    pub(super) fn cut(&mut self, start: u64) {
        self.0.iter_mut().for_each(|r| r.end = r.end.min(start));
        self.0.retain(|r| !r.is_empty());
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Range<u64>> {
        self.0.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(range: Range<u64>) -> Ranges {
        let mut ranges = Ranges::default();
        ranges.add(range);
        ranges
    }

    #[test]
    fn ranges_join_and_gaps_are_found() {
        let mut ranges = Ranges::default();
        for range in [16..32, 64..80, 0..16, 40..40] {
            ranges.add(range);
        }
        assert_eq!(ranges.iter().cloned().collect::<Vec<_>>(), [0..32, 64..80]);
        assert_eq!((ranges.count(), ranges.end()), (48, 80));
        assert_eq!(ranges.gap(&(0..100)), Some(32..64));
        assert_eq!(ranges.gap(&(64..100)), Some(80..100));
        assert_eq!(ranges.gap(&(8..20)), None);
        let other = of(30..35);
        assert_eq!((ranges.common(&other), of(32..64).common(&ranges)), (Some(30..32), None));
        ranges.cut(20);
        assert_eq!(ranges, of(0..20));
    }
}

//! The sums of one group, and the realizations that they hold.

use std::borrow::Cow;
use std::ops::Range;

use super::ranges::Ranges;
use super::sizes::Sizes;
use crate::error::{Error, Result};
use crate::plan::LEAF;
use crate::statistics::group::{KeptPart, Part, PartSums, together};

/// Seconds that a step of a measurement that is looked at aims at, so that whoever takes steps can look up between them.
const STEP: f64 = 0.05;

/// The sums of one group.
#[derive(Debug)]
pub(super) struct Track {
    /// What the sums are of.
    pub(super) part: Box<dyn Part>,
    pub(super) wanted: bool,
    /// Of whole leaves of realizations.
    pub(super) whole: Option<Box<dyn PartSums>>,
    /// Of those of a leaf that is not full.
    pub(super) leaf: Option<Box<dyn PartSums>>,
    pub(super) done: Ranges,
    pub(super) kept: u64,
    pub(super) rebinned: bool,
    /// What a realization took, in seconds.
    pub(super) each: f64,
}

impl Track {
    pub(super) fn new(part: Box<dyn Part>) -> Self {
        Self {
            part,
            wanted: true,
            whole: None,
            leaf: None,
            done: Ranges::default(),
            kept: 0,
            rebinned: false,
            each: f64::INFINITY,
        }
    }

    /// All its sums.
    pub(super) fn sums(&self) -> Result<Option<Cow<'_, dyn PartSums>>> {
        together(self.whole.as_deref(), self.leaf.as_deref())
    }

    /// The same sums as those of another plan, if they are.
    pub(super) fn kept(self, wanted: &dyn Part, sizes: &Sizes) -> Option<Self> {
        let done = self.done.count();
        let keep = |sums: Option<&dyn PartSums>| match sums {
            Some(sums) => self.part.kept(sums, wanted, &mut sizes.values()).map(Some),
            None => Some(None),
        };
        let (whole, leaf) = (keep(self.whole.as_deref())?, keep(self.leaf.as_deref())?);
        let any = whole.as_ref().or(leaf.as_ref());
        // Without sums there is nothing to keep.
        let (part, rebinned) = any.map(|kept| (kept.part.clone_part(), kept.rebinned))?;
        let sums = |kept: Option<KeptPart>| kept.map(|kept| kept.sums);
        let (whole, leaf) = (sums(whole), sums(leaf));
        Some(Self { part, wanted: true, whole, leaf, done: self.done, kept: done, rebinned, each: self.each })
    }

    /// Which realizations to measure next: whole leaves where they are quick, else one.
    pub(super) fn next(&mut self, span: &Range<u64>, live: bool, most: u64) -> Option<Range<u64>> {
        let Range { mut start, end } = self.done.gap(span)?;
        if self.part.whole_leaves() && !start.is_multiple_of(LEAF) {
            // Realizations cannot be added to a leaf that is one product: it is made anew.
            start = start / LEAF * LEAF;
            self.done.cut(start);
            self.leaf = None;
        }
        let left = end - start;
        let most = if live { most.min(self.part.batch().realizations) } else { most };
        let size = if !start.is_multiple_of(LEAF) {
            1
        } else if self.part.whole_leaves() && live {
            LEAF
        } else if live {
            match (STEP / self.each) as u64 {
                0 | 1 => 1,
                few if few < LEAF => few,
                many => (many.min(left) / LEAF * LEAF).min(most.max(LEAF) / LEAF * LEAF),
            }
        } else if left < LEAF {
            left
        } else {
            // The last leaf, which is not full, apart: so realizations can be added to it.
            most.max(LEAF).min(left) / LEAF * LEAF
        };
        Some(start..start + size.max(1).min(left))
    }

    /// Adds the sums of realizations that were not there.
    pub(super) fn add(&mut self, range: Range<u64>, next: Box<dyn PartSums>) -> Result<()> {
        let (starts, ends) = (range.start.is_multiple_of(LEAF), range.end.is_multiple_of(LEAF));
        match (starts, ends, &mut self.leaf) {
            (true, true, _) => join(&mut self.whole, next)?,
            (true, false, _) => self.leaf = Some(next),
            (false, full, Some(leaf)) => {
                leaf.append(next)?;
                if full && let Some(leaf) = self.leaf.take() {
                    join(&mut self.whole, leaf)?;
                }
            }
            (false, _, None) => {
                return Err(Error::input("sums", "realizations of a leaf are missing: a bug of pairwave"));
            }
        }
        self.done.add(range);
        Ok(())
    }
}

/// Adds sums of other realizations.
pub(super) fn join(sums: &mut Option<Box<dyn PartSums>>, next: Box<dyn PartSums>) -> Result<()> {
    match sums {
        Some(sums) => sums.merge(next),
        None => {
            *sums = Some(next);
            Ok(())
        }
    }
}

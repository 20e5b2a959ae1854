//! Files that are read when their points are needed.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use super::intensity::inverses;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::points::read::{Columns, MarkedPoints, PointFile, ReadOptions};
use crate::points::{Domain, Ensemble};

/// Files that are too large to be held, read when they are needed.
pub(super) struct Files {
    /// Each with the index of its first realization.
    pub(super) files: Vec<(u64, PointFile)>,
    /// What they were when they were scanned; none where this run has looked at all of them itself.
    pub(super) stamps: Vec<Stamp>,
    pub(super) options: ReadOptions,
    pub(super) columns: Columns,
    pub(super) marks: Marking,
    /// The file that was read last, if it was read at once.
    pub(super) last: Mutex<Option<(usize, Arc<Vec<MarkedPoints>>)>>,
}

/// By what a file is known to be the one that it was.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) struct Stamp {
    pub(super) bytes: u64,
    /// When it was changed last, in whole seconds since 1970.
    pub(super) modified_s: u64,
}

/// What points are marked with, and folded by.
#[derive(Debug, Clone, Default)]
pub(super) struct Marking {
    pub(super) wrap: bool,
    /// Whether there are weights, and the largest of all.
    pub(super) largest: Option<f64>,
    /// Whether they are the inverses of what is read.
    pub(super) inverse: bool,
    /// The numbers of the classes, if there are any.
    pub(super) classes: Option<HashMap<String, u32>>,
}

impl Files {
    /// Of points that are held.
    pub(super) fn none(options: ReadOptions, columns: Columns, marks: Marking) -> Self {
        Self { files: Vec::new(), stamps: Vec::new(), options, columns, marks, last: Mutex::default() }
    }

    pub(super) fn batch(&self, range: Range<u64>, domain: &Domain, control: &Control) -> Result<Ensemble> {
        let at = self.files.partition_point(|(first, _)| *first <= range.start).saturating_sub(1);
        let mut sets = Vec::new();
        for (k, (first, file)) in self.files.iter().enumerate().skip(at).take_while(|(_, f)| f.0 < range.end) {
            control.check()?;
            self.stamps.get(k).map_or(Ok(()), |then| then.check(file.path()))?;
            let end = self.files.get(k + 1).map_or(range.end, |next| next.0).min(range.end);
            let within = range.start.max(*first) - first..end - first;
            match file {
                PointFile::Rows(_) => sets.extend(file.read(within, &self.options, &self.columns)?),
                PointFile::Whole(_) => {
                    let whole = self.whole(k, file)?;
                    let changed =
                        || Error::input(place(&whole), "holds fewer realizations than when it was first read");
                    let some = whole.get(within.start as usize..within.end as usize).ok_or_else(changed)?;
                    sets.extend_from_slice(some);
                }
            }
        }
        self.marks.ensemble(sets, domain, range.start)
    }

    /// A file that is read at once; the last one is kept, since batches may cut it.
    pub(super) fn whole(&self, k: usize, file: &PointFile) -> Result<Arc<Vec<MarkedPoints>>> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, sets)) = last.as_ref().filter(|(at, _)| *at == k) {
            return Ok(sets.clone());
        }
        let sets = Arc::new(file.read(0..0, &self.options, &self.columns)?);
        *last = Some((k, sets.clone()));
        Ok(sets)
    }
}

/// Where the first of some sets stands.
pub(super) fn place(sets: &[MarkedPoints]) -> String {
    sets.first().map_or("points".into(), |set| set.points.source.clone())
}

impl Marking {
    /// Realizations from `first` on.
    pub(super) fn ensemble(&self, sets: Vec<MarkedPoints>, domain: &Domain, first: u64) -> Result<Ensemble> {
        let (mut raw, mut weights, mut classes) = (Vec::new(), Vec::new(), Vec::new());
        for set in sets {
            if let Some(numbers) = &self.classes {
                // A label that was not there when the file was first read is in no class.
                classes.extend(set.labels.iter().map(|label| numbers.get(label).copied().unwrap_or(u32::MAX)));
            }
            raw.push(set.points);
            weights.extend(if self.inverse { inverses(&set.weights) } else { set.weights });
        }
        let mut ensemble = Ensemble::from_owned(raw, domain, self.wrap, first)?;
        if let Some(largest) = self.largest {
            ensemble = ensemble.with_weights_of(&weights, largest);
        }
        if self.classes.is_some() {
            ensemble = ensemble.with_classes(classes);
        }
        Ok(ensemble)
    }
}

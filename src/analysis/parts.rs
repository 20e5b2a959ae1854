//! Parts of a measurement: cut, gone on with, added to, kept in files and read from them.

use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::Path;

use super::{Measurement, Plan};
use crate::compute::Device;
use crate::error::{Error, Result, plural};
use crate::input;
use crate::plan::LEAF;
use crate::report::SUMS;
use crate::setting::Setting;
use crate::stage;

impl Measurement {
    /// `512 of 1024 realizations`.
    pub fn held(&self) -> String {
        format!("{} of {}", self.realizations(), plural(self.total(), "realization"))
    }

    /// The part `shard` (from 1) of `of` parts of about the same number of realizations, to be measured by itself and merged.
    ///
    /// # Errors
    /// A part that cannot be; what needs all realizations at once.
    pub fn shard(self, shard: u64, of: u64, device: &Device) -> Result<Self> {
        let refuse = |reason: String| Err(Error::setting(Setting::Shard, format!("{shard}/{of}"), reason));
        if let Some(what) = self.needs_all() {
            return refuse(format!(
                "{what} needs all realizations at once; expected it in the run that is not cut, or left out"
            ));
        }
        let leaves = self.total().div_ceil(LEAF);
        if shard == 0 || shard > of || of > leaves {
            return refuse(format!(
                "expected I/N with 1 <= I <= N <= {leaves}: {} are summed {LEAF} at a time",
                plural(self.total(), "realization")
            ));
        }
        let cut =
            |shard: u64| ((u128::from(leaves) * u128::from(shard) / u128::from(of)) as u64 * LEAF).min(self.total());
        let span = cut(shard - 1)..cut(shard);
        self.within(span, device)
    }

    /// Goes on where another measurement of the same kind ended.
    ///
    /// # Errors
    /// As `merge`; realizations that this one is not to have.
    pub fn resume(mut self, earlier: Self) -> Result<Self> {
        let span = self.span.clone();
        let beyond = |(run, _): (Range<u64>, u64)| match run.start < span.start {
            true => Some(run.start),
            false => (run.end > span.end).then(|| run.start.max(span.end)),
        };
        if let Some(out) = earlier.sizes.runs().find_map(beyond) {
            let reason =
                format!("holds realization {}; expected realizations {} to {} only", out + 1, span.start + 1, span.end);
            return Err(Error::input("the earlier run", reason));
        }
        self.merge(earlier)?;
        Ok(self.to(span))
    }

    /// Adds these realizations to those of an earlier measurement, by the plan that the earlier one was made by: numbers that follow from how
    /// many realizations there are (points that F is looked at from, windows that are counted in) stay what they were. Of files, the first
    /// realizations are those of the earlier one, in its order, and others come after them.
    ///
    /// # Errors
    /// As `resume`.
    pub fn extend(mut self, mut earlier: Self, device: &Device) -> Result<Self> {
        let (shape, lists) = (earlier.source.shape(), self.plan.lists.clone());
        if self.source.is_scanned() && shape.realizations < self.total() {
            let reason = "were scanned, and of the first of them alone nothing is known; expected the files themselves, to add to a result";
            return Err(Error::setting(Setting::Files, self.source.subject(), reason));
        }
        if self.source.identity_of_first(shape.realizations).as_ref() == Some(earlier.source.identity()) {
            earlier.source = self.source.clone();
        }
        let planned = Plan::with(&self.request, self.source.domain(), shape, self.source.classes(), lists)?;
        self.plan = planned.for_device(device.compute());
        Self::new(self.request, self.source, self.plan).resume(earlier)
    }

    /// Writes its sums into a directory, whole or not at all.
    ///
    /// # Errors
    /// What the file system says; what was there before stays.
    pub fn save(&self, dir: &Path) -> Result<()> {
        let path = dir.join(SUMS);
        let written = fs::create_dir_all(dir).and_then(|()| {
            // Of a name of its own: another run may be writing here.
            let mut file = stage::file_within(dir)?;
            file.write_all(&self.write())?;
            file.as_file().sync_all()?;
            file.persist(&path).map_err(|e| e.error)
        });
        written.map(drop).map_err(|e| Error::file(path, e))
    }

    /// The sums in a directory, or in a file.
    ///
    /// # Errors
    /// What cannot be read, or is no file of sums.
    pub fn load(path: &Path) -> Result<Self> {
        let file = if path.is_dir() { path.join(SUMS) } else { path.to_path_buf() };
        if path.is_dir() && !file.exists() {
            let reason =
                format!("holds no {SUMS}; expected a directory that `shard`, `keep_sums` or an unfinished run left");
            return Err(Error::input(path.display().to_string(), reason));
        }
        Self::read(&file.display().to_string(), &input::read(&file)?)
    }
}

//! What is remarked on files while they are read.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::error::{Error, Result, plural};
use crate::points::read::{Broken, Input, LeftOut, MarkedPoints, Reading, StatedBox};
use crate::points::{Domain, RawPoints};
use crate::request::PointsRequest;

/// How files were read, and what the user should know of that.
#[derive(Default)]
pub(super) struct Remarks {
    pub(super) input: Input,
    notes: Vec<String>,
    more_notes: u64,
    last: Option<Arc<Reading>>,
    /// The box that a file stated, or why it is none, and that file.
    stated: Option<Stated>,
    /// Of files that were left out for their number of coordinates: how many there are of each.
    others: BTreeMap<usize, (u64, RawPoints)>,
}

/// What a file says of its box, and which file.
type Stated = (String, Result<StatedBox, String>);

/// So many remarks about files are shown; of the rest, how many there are.
const MOST_NOTES: usize = 20;

impl Remarks {
    /// Keeps a remark, once.
    pub(super) fn note(&mut self, note: &str) {
        if self.notes.iter().any(|known| known == note) {
            return;
        }
        match self.notes.len() < MOST_NOTES {
            true => self.notes.push(note.to_string()),
            false => self.more_notes += 1,
        }
    }

    /// Notes how a file was read, once.
    pub(super) fn read(&mut self, reading: &Arc<Reading>, source: &str) {
        if self.last.as_ref().is_some_and(|last| Arc::ptr_eq(last, reading) || last == reading) {
            return;
        }
        if let Some(difference) = self.input.see(reading) {
            self.note(&format!("{source}: {difference}"));
        }
        reading.notes.iter().for_each(|note| self.note(note));
        self.stated = agreed(self.stated.take(), reading, source);
        self.last = Some(reading.clone());
    }

    /// The domain that the files state, where the request has none.
    pub(super) fn stated(&self, request: &PointsRequest) -> Result<Option<Domain>> {
        domain_of(self.stated.as_ref(), request)
    }

    /// The same with one file more.
    pub(super) fn stated_with(&self, set: &MarkedPoints, request: &PointsRequest) -> Result<Option<Domain>> {
        domain_of(agreed(self.stated.clone(), &set.reading, &set.points.source).as_ref(), request)
    }

    /// Notes a file that is left out. Of points with another number of coordinates it is remembered how many files have it.
    pub(super) fn leave_out(&mut self, broken: Broken) {
        let left = LeftOut { file: broken.file.display().to_string(), reason: broken.error.to_string() };
        self.input.left_out.push(left);
        if let Some(like) = broken.like {
            self.others.entry(like.dim).or_insert((0, like)).0 += 1;
        }
    }

    /// Points like those of most files, if that is not what the first had.
    pub(super) fn most(&self) -> Option<RawPoints> {
        let (files, like) = self.others.values().max_by_key(|(files, like)| (*files, std::cmp::Reverse(like.dim)))?;
        (*files > self.input.files).then(|| like.clone())
    }

    /// Where all files were left out there is nothing to go on with.
    pub(super) fn check_any(&self) -> Result<()> {
        match self.input.left_out.as_slice() {
            [first, ..] if self.input.files == 0 => {
                let many = plural(self.input.left_out.len() as u64, "file");
                Err(Error::input("points", format!("none of {many} can be used; the first: {}", first.reason)))
            }
            _ => Ok(()),
        }
    }

    /// What is said of files that were left out.
    fn of_left_out(&self) -> Option<String> {
        const MOST: usize = 5;
        let left = &self.input.left_out;
        let all = left.len() as u64 + self.input.files;
        let shown: Vec<_> = left.iter().take(MOST).map(|left| left.reason.as_str()).collect();
        let more = left.len().saturating_sub(MOST);
        let more = if more > 0 { format!("; and {more} more, all in summary.json") } else { String::new() };
        let were = if left.len() == 1 { "was" } else { "were" };
        (!left.is_empty())
            .then(|| format!("{} of {} {were} left out: {}{more}", left.len(), plural(all, "file"), shown.join("; ")))
    }

    /// All of them.
    pub(super) fn all(&self) -> Vec<String> {
        let more = (self.more_notes > 0)
            .then(|| format!("{} of this kind about other files", plural(self.more_notes, "more remark")));
        self.of_left_out().into_iter().chain(self.notes.iter().cloned()).chain(more).collect()
    }
}

/// What files state of their box, with one file more.
fn agreed(known: Option<Stated>, reading: &Reading, source: &str) -> Option<Stated> {
    let Some(stated) = &reading.stated else { return known };
    let file = source.split(", realization ").next().unwrap_or(source).to_string();
    match known {
        None => Some((file, stated.clone())),
        Some((first, known)) if known.is_ok() && known != *stated => {
            Some((file, Err(format!("its box is not that of {first}; `sides` or `window` sets one for all"))))
        }
        known => known,
    }
}

fn domain_of(stated: Option<&Stated>, request: &PointsRequest) -> Result<Option<Domain>> {
    let given = request.sides.is_some() || request.window.is_some() || request.window_polygon.is_some();
    let Some((file, stated)) = stated.filter(|_| !given) else { return Ok(None) };
    let domain = stated.as_ref().map_err(String::clone).and_then(|stated| stated.domain(request.domain));
    domain.map(Some).map_err(|reason| Error::input(file, reason))
}

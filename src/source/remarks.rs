//! What is remarked on files while they are read.

use std::sync::Arc;

use crate::error::{Error, Result, plural};
use crate::points::Domain;
use crate::points::read::{Input, Reading, StatedBox};
use crate::request::PointsRequest;

/// How files were read, and what the user should know of that.
#[derive(Default)]
pub(super) struct Remarks {
    pub(super) input: Input,
    notes: Vec<String>,
    more_notes: u64,
    last: Option<Arc<Reading>>,
    /// The box that a file stated, or why it is none, and that file.
    stated: Option<(String, Result<StatedBox, String>)>,
}

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
        if let Some(stated) = &reading.stated {
            let file = || source.split(", realization ").next().unwrap_or(source).to_string();
            match &mut self.stated {
                None => self.stated = Some((file(), stated.clone())),
                Some((first, known)) if known.is_ok() && known != stated => {
                    let reason = format!("its box is not that of {first}; `sides` or `window` sets one for all");
                    self.stated = Some((file(), Err(reason)));
                }
                Some(_) => {}
            }
        }
        self.last = Some(reading.clone());
    }

    /// The domain that the files state, where the request has none.
    pub(super) fn stated(&self, request: &PointsRequest) -> Result<Option<Domain>> {
        let given = request.sides.is_some() || request.window.is_some() || request.window_polygon.is_some();
        let Some((file, stated)) = self.stated.as_ref().filter(|_| !given) else { return Ok(None) };
        let domain = stated.as_ref().map_err(String::clone).and_then(|stated| stated.domain(request.domain));
        domain.map(Some).map_err(|reason| Error::input(file, reason))
    }

    /// All of them.
    pub(super) fn all(&self) -> Vec<String> {
        let more = (self.more_notes > 0)
            .then(|| format!("{} of this kind about other files", plural(self.more_notes, "more remark")));
        self.notes.iter().cloned().chain(more).collect()
    }
}

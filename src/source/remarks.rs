//! What is remarked on files while they are read.

use std::sync::Arc;

use crate::error::plural;
use crate::points::read::{Input, Reading};

/// How files were read, and what the user should know of that.
#[derive(Default)]
pub(super) struct Remarks {
    pub(super) input: Input,
    notes: Vec<String>,
    more_notes: u64,
    last: Option<Arc<Reading>>,
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
        self.last = Some(reading.clone());
    }

    /// All of them.
    pub(super) fn all(&self) -> Vec<String> {
        let more = (self.more_notes > 0)
            .then(|| format!("{} of this kind about other files", plural(self.more_notes, "more remark")));
        self.notes.iter().cloned().chain(more).collect()
    }
}

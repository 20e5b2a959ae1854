//! Parts of a request that lie in files: bin edges, wave vectors, costs.

mod edges;
mod frequencies;

use std::path::Path;
use std::sync::OnceLock;

pub use edges::read_edges;
pub use frequencies::{frequencies_of_bytes, read_frequencies};

use crate::error::Result;
use crate::plan::{Costs, WaveList};
use crate::points::Domain;

/// The lists that a request names, each read when it is first needed, or given.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Lists {
    edges: OnceLock<Vec<f64>>,
    frequencies: OnceLock<WaveList>,
    costs: OnceLock<Costs>,
    /// What was read of the frequencies, in words.
    said: OnceLock<String>,
}

impl Lists {
    /// Those that were read before.
    pub(crate) fn given(
        edges: Option<Vec<f64>>,
        frequencies: Option<WaveList>,
        costs: Option<Costs>,
        said: Option<String>,
    ) -> Self {
        let cell = Self::default();
        edges.into_iter().for_each(|edges| _ = cell.edges.set(edges));
        frequencies.into_iter().for_each(|list| _ = cell.frequencies.set(list));
        costs.into_iter().for_each(|costs| _ = cell.costs.set(costs));
        said.into_iter().for_each(|said| _ = cell.said.set(said));
        cell
    }

    /// Bin edges.
    pub(crate) fn edges(&self, path: &Path) -> Result<&[f64]> {
        match self.edges.get() {
            Some(edges) => Ok(edges),
            None => {
                let edges = read_edges(path)?;
                Ok(self.edges.get_or_init(|| edges))
            }
        }
    }

    /// Wave vectors.
    pub(crate) fn frequencies(&self, path: &Path, domain: &Domain) -> Result<&WaveList> {
        match self.frequencies.get() {
            Some(list) => Ok(list),
            None => {
                let (list, said) = read_frequencies(path, domain)?;
                _ = self.said.set(said);
                Ok(self.frequencies.get_or_init(|| list))
            }
        }
    }

    /// What methods cost, as measured.
    pub(crate) fn costs(&self, path: &Path) -> Result<&Costs> {
        match self.costs.get() {
            Some(costs) => Ok(costs),
            None => {
                let costs = Costs::read(&path.display().to_string(), &crate::input::read_text(path)?)?;
                Ok(self.costs.get_or_init(|| costs))
            }
        }
    }

    /// The same, where they were read.
    pub(crate) fn costs_read(&self) -> Option<&Costs> {
        self.costs.get()
    }

    /// What was read of files of frequencies, in a line.
    pub(crate) fn said(&self) -> Option<&str> {
        self.said.get().map(String::as_str)
    }

    /// What was read.
    pub(crate) fn read(&self) -> (Option<&[f64]>, Option<&WaveList>) {
        (self.edges.get().map(Vec::as_slice), self.frequencies.get())
    }
}

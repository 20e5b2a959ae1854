//! Parts of a request that lie in files: bin edges and wave vectors.

mod edges;
mod frequencies;

pub use edges::read_edges;
pub use frequencies::read_frequencies;

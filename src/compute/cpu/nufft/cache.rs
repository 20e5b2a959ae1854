//! Plans that are kept from call to call: batches and statistics of a run ask for the same few.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use super::Nufft;
use crate::compute::cpu::SimdLevel;
use crate::error::Result;
use crate::memory::Memory;
use crate::plan::WaveGrid;

/// Plans kept.
const KEPT: usize = 8;

/// What a plan is made for: the grid, the bits of its tolerance, about how many points, and the memory.
type Key = (WaveGrid, u64, usize, Memory);

/// The plans last asked for, the latest last.
#[derive(Default)]
pub(in super::super) struct Cache(Mutex<Vec<(Key, Arc<Nufft>)>>);

impl Cache {
    /// The plan of `Nufft::new`, made if it is not there. All callers are on one processor: they name the same level.
    pub(in super::super) fn get(
        &self,
        grid: &WaveGrid,
        tolerance: f64,
        points: usize,
        level: SimdLevel,
        memory: Memory,
    ) -> Result<Arc<Nufft>> {
        let key = (*grid, tolerance.to_bits(), points, memory);
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = match kept.iter().position(|(other, _)| *other == key) {
            Some(at) => kept.remove(at),
            None => (key, Arc::new(Nufft::new(grid, tolerance, points as f64, level)?.within(memory))),
        };
        let nufft = Arc::clone(&found.1);
        if kept.len() == KEPT {
            kept.remove(0);
        }
        kept.push(found);
        Ok(nufft)
    }
}

impl fmt::Debug for Cache {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cache").finish_non_exhaustive()
    }
}

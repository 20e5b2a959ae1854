//! A sampler with all that determines its realizations.

use std::ops::Range;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use rayon::prelude::*;

use super::entry::{Entry, Sampler};
use super::stream::identity;
use super::{ParameterValues, Realization, find, wrap};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::points::{Domain, Ensemble, RawPoints};
use crate::pool::Pool;
use crate::setting::Setting;

/// Most realizations of a run. Of each its number of points is kept, so this is 16 GiB.
const MAX_REALIZATIONS: u64 = 1 << 30;

/// A sampler with everything that determines its realizations.
pub struct Process {
    /// Its name.
    pub name: String,
    /// The sampler, made of n, dimension and parameters.
    pub sampler: Arc<dyn Sampler>,
    /// Whether every realization has exactly n points.
    pub fixed_n: bool,
    /// Its parameters, `key=value`, defaults written out; `shift=random` where each set is shifted.
    pub parameters: Vec<String>,
    /// Points per realization, expected where the sampler draws it.
    pub n: u64,
    /// Number of realizations.
    pub realizations: u64,
    /// Dimension.
    pub dim: usize,
    /// Seed.
    pub seed: u64,
    shift: bool,
    identity: u64,
    sequence: bool,
}

impl Process {
    /// Of the registry, by a name or an alias; checks it, the parameters and n.
    ///
    /// # Errors
    /// A name or parameters that are not known, n that the sampler cannot draw, no realizations.
    pub fn new(name: &str, n: u64, realizations: u64, dim: usize, seed: u64, params: &[&str]) -> Result<Self> {
        let entry = find(name)?;
        Self::of(entry, n, realizations, dim, seed, &ParameterValues::parse(entry, params)?)
    }

    /// Of a line of the registry.
    ///
    /// # Errors
    /// n that the sampler cannot draw, no realizations.
    pub fn of(
        entry: &Entry,
        n: u64,
        realizations: u64,
        dim: usize,
        seed: u64,
        values: &ParameterValues,
    ) -> Result<Self> {
        let sampler = entry.of(n, dim, values)?;
        let shift = entry.shifts(values)?;
        Self {
            name: entry.name.into(),
            sampler,
            fixed_n: entry.fixed_n(),
            parameters: values.canonical().chain(shift.then(|| "shift=random".into())).collect(),
            n,
            realizations,
            dim,
            seed,
            shift,
            identity: identity(entry.name, values.identity()),
            sequence: entry.number == super::Number::Sequence,
        }
        .checked()
    }

    /// Of a sampler of one's own, which has exactly n points.
    ///
    /// # Errors
    /// No points, no realizations.
    pub fn own(
        name: &str,
        sampler: Arc<dyn Sampler>,
        n: u64,
        realizations: u64,
        dim: usize,
        seed: u64,
    ) -> Result<Self> {
        super::Size::ANY.check(name, n, dim)?;
        if dim == 0 {
            return Err(Error::setting(Setting::Dim, dim, "expected at least 1"));
        }
        Self {
            name: name.into(),
            sampler,
            fixed_n: true,
            parameters: Vec::new(),
            n,
            realizations,
            dim,
            seed,
            shift: false,
            identity: identity(name, std::iter::empty()),
            sequence: false,
        }
        .checked()
    }

    fn checked(self) -> Result<Self> {
        let realizations = self.realizations;
        if realizations == 0 {
            return Err(Error::setting(Setting::Realizations, 0, "expected at least 1 realization"));
        }
        if realizations > MAX_REALIZATIONS {
            let reason = format!(
                "expected at most {MAX_REALIZATIONS} realizations: what is kept of each would not fit into the memory of a machine"
            );
            return Err(Error::setting(Setting::Realizations, realizations, reason));
        }
        Ok(self)
    }

    fn which(&self, index: u64) -> Realization {
        let Self { n, dim, seed, identity, sequence, .. } = *self;
        Realization { n, dim, seed, index, identity, sequence }
    }

    /// The points of realization `index` on the unit torus: coordinates point by point.
    ///
    /// # Errors
    /// What the sampler says; `Error::Cancelled`.
    pub fn coordinates(&self, index: u64, control: &Control) -> Result<Vec<f64>> {
        control.check()?;
        let which = self.which(index);
        let mut points = self.sampler.generate(&which, control)?;
        if self.shift {
            let shift = which.shift();
            for point in points.chunks_exact_mut(self.dim) {
                point.iter_mut().zip(&shift).for_each(|(x, s)| *x = wrap(*x + s));
            }
        }
        Ok(points)
    }

    /// The number of points of realization `index`.
    ///
    /// # Errors
    /// What the sampler says; `Error::Cancelled`.
    pub fn count(&self, index: u64, control: &Control) -> Result<u64> {
        control.check()?;
        if self.fixed_n { Ok(self.n) } else { self.sampler.count(&self.which(index), control) }
    }

    /// Realization `index`, on the unit torus.
    ///
    /// # Errors
    /// What the sampler says; `Error::Cancelled`.
    pub fn realization(&self, index: u64, control: &Control) -> Result<RawPoints> {
        let source = format!("{}, realization {index}", self.name);
        Ok(RawPoints { dim: self.dim, coordinates: self.coordinates(index, control)?, source, lines: Vec::new() })
    }

    /// Realizations `indices` as an ensemble on the unit torus, drawn in parallel.
    ///
    /// # Errors
    /// What the sampler says; `Error::Cancelled`.
    pub fn ensemble(&self, indices: Range<u64>, control: &Control) -> Result<Ensemble> {
        let first = indices.start;
        let raw: Vec<RawPoints> =
            indices.into_par_iter().map(|index| self.realization(index, control)).collect::<Result<_>>()?;
        Ensemble::from_owned(raw, &Domain::unit_torus(self.dim), false, first)
    }

    /// Closed form of g on the unit torus, normalized by E[n (n - 1)].
    pub fn pair_correlation(&self, r: f64) -> Option<f64> {
        self.sampler.pair_correlation(r)
    }

    /// Closed form of P at `m != 0`; components beyond the dimension are ignored.
    pub fn power(&self, m: [i32; 3]) -> Option<f64> {
        self.sampler.power(m.get(..self.dim)?)
    }
}

/// Points of one chunk that is drawn at once by all threads, about: some milliseconds' work.
const CHUNK_POINTS: u64 = 1 << 18;

/// Realizations of a process one after the other, drawn ahead by all threads of a pool.
pub struct InOrder {
    chunks: Receiver<Result<Vec<RawPoints>>>,
    chunk: std::vec::IntoIter<RawPoints>,
}

impl InOrder {
    /// All of them.
    ///
    /// # Errors
    /// No thread to draw on.
    pub fn new(process: Arc<Process>, pool: Pool, control: Arc<Control>) -> Result<Self> {
        // One chunk is written while the next is drawn.
        let (send, chunks) = sync_channel(1);
        let draw = move || {
            let size = (CHUNK_POINTS / process.n).clamp(1, 1 << 14) * pool.threads() as u64;
            let mut first = 0;
            while first < process.realizations {
                let end = process.realizations.min(first + size);
                let one = |index| process.realization(index, &control);
                let chunk: Result<Vec<_>> = pool.install(|| (first..end).into_par_iter().map(one).collect());
                let failed = chunk.is_err();
                // Nobody is there to take it once the other end is dropped.
                if send.send(chunk).is_err() || failed {
                    return;
                }
                first = end;
            }
        };
        std::thread::Builder::new().name("pairwave-draw".into()).spawn(draw).map_err(|e| Error::file("a thread", e))?;
        Ok(Self { chunks, chunk: Vec::new().into_iter() })
    }
}

impl Iterator for InOrder {
    type Item = Result<RawPoints>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(set) = self.chunk.next() {
                return Some(Ok(set));
            }
            match self.chunks.recv().ok()? {
                Ok(chunk) => self.chunk = chunk.into_iter(),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

//! Best candidate (Mitchell, "Spectrally optimal sampling for distribution ray tracing", 1991): point i is that of `candidates` i + 1
//! uniform candidates that is farthest from all before it, on the torus.

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::torus_nearest::TorusNearest;
use crate::samplers::{Accepts, Entry, Family, Number, Parameter, Realization, Sampler, Stream};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Mitchell 1991",
    number: Number::Sequence,
    parameters: &[Parameter::new(
        "candidates",
        "1",
        Accepts::Whole(1, 1000),
        "candidates of a point, times the number of points before it",
    )],
    ..Entry::new(
        "best-candidate",
        Family::BlueNoise,
        "each point the farthest from those before it of several candidates",
        |given| Ok(Arc::new(BestCandidate { candidates: given.values.whole("candidates")?.unwrap_or(1) })),
    )
};

struct BestCandidate {
    candidates: u64,
}

impl Sampler for BestCandidate {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let n = which.n as usize;
        match which.dim {
            1 => self.place::<1>(&mut stream, n, control),
            2 => self.place::<2>(&mut stream, n, control),
            _ => self.place::<3>(&mut stream, n, control),
        }
    }
}

impl BestCandidate {
    fn place<const D: usize>(&self, stream: &mut Stream, n: usize, control: &Control) -> Result<Vec<f64>> {
        let mut near = TorusNearest::<D>::new();
        let mut tried = 0u64;
        for i in 0..n {
            let mut best = ([0.0; D], -1.0);
            for _ in 0..self.candidates * i as u64 + 1 {
                tried += 1;
                if tried.is_multiple_of(8192) {
                    control.check()?;
                }
                let candidate = std::array::from_fn(|_| stream.uniform());
                let distance2 = near.nearest2(&candidate, best.1);
                if distance2 > best.1 {
                    best = (candidate, distance2);
                }
            }
            near.push(best.0);
        }
        Ok(near.points().as_flattened().to_vec())
    }
}

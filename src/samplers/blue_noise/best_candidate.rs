//! Best candidate (Mitchell, "Spectrally optimal sampling for distribution ray tracing", 1991): point i is that of `candidates` i + 1
//! uniform candidates that is farthest from all before it, on the torus.

use std::sync::Arc;

use crate::control::Control;
use crate::error::Result;
use crate::samplers::torus_cells::distance_squared;
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
        let mut near = Nearest::<D>::new(1);
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
            // Cells of about two points.
            if i > 4 * near.cells.len() {
                near = Nearest::rebuilt(near);
            }
            near.push(best.0);
        }
        Ok(near.points.into_flattened())
    }
}

/// Points of the torus in cells, for their nearest.
struct Nearest<const D: usize> {
    points: Vec<[f64; D]>,
    per_axis: usize,
    cells: Vec<Vec<u32>>,
}

impl<const D: usize> Nearest<D> {
    fn new(per_axis: usize) -> Self {
        Self { points: Vec::new(), per_axis, cells: vec![Vec::new(); per_axis.pow(D as u32)] }
    }

    /// With twice as many cells along every axis.
    fn rebuilt(old: Self) -> Self {
        let mut new = Self::new(2 * old.per_axis);
        old.points.into_iter().for_each(|point| new.push(point));
        new
    }

    fn home(&self, point: &[f64; D]) -> [usize; D] {
        // `per_axis` is a power of 2: the product is exact.
        point.map(|x| (x * self.per_axis as f64) as usize)
    }

    fn push(&mut self, point: [f64; D]) {
        let cell = self.home(&point).iter().rev().fold(0, |cell, h| cell * self.per_axis + h);
        self.cells[cell].push(self.points.len() as u32);
        self.points.push(point);
    }

    /// The square of the distance to the nearest, or of one that is at most `enough` away.
    fn nearest2(&self, place: &[f64; D], enough: f64) -> f64 {
        let home = self.home(place);
        let side = 1.0 / self.per_axis as f64;
        let mut found = f64::INFINITY;
        // Cells in shells about the home, until what is beyond cannot be nearer; the last shell meets itself around the torus.
        for shell in 0..=(self.per_axis / 2) as i64 {
            let inner = (shell - 1) as f64 * side;
            if shell > 0 && inner > 0.0 && inner * inner > found {
                break;
            }
            self.each_of_shell(&home, shell, |cell| {
                for &j in &self.cells[cell] {
                    found = found.min(distance_squared(place, &self.points[j as usize]));
                }
                found <= enough
            });
            if found <= enough {
                break;
            }
        }
        found
    }

    /// The cells at a largest offset of `shell` from `home`, until one says that it is enough.
    fn each_of_shell(&self, home: &[usize; D], shell: i64, mut visit: impl FnMut(usize) -> bool) {
        let width = 2 * shell + 1;
        for at in 0..width.pow(D as u32) {
            let mut rest = at;
            let offset: [i64; D] = std::array::from_fn(|_| {
                let offset = rest % width - shell;
                rest /= width;
                offset
            });
            if offset.iter().all(|o| o.abs() < shell) {
                continue;
            }
            let m = self.per_axis as i64;
            let cell = (0..D).rev().fold(0, |cell, k| cell * m + (home[k] as i64 + offset[k]).rem_euclid(m));
            if visit(cell as usize) {
                return;
            }
        }
    }
}

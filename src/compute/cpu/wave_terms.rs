//! Lists of wave vectors: one sine and cosine per point and vector, in f64. Formula: see `reference`.
//!
//! The part of `m . x` that integers make is exact in wrapping arithmetic; what a fraction of a cycle adds is rounded to
//! 2^-53 of a turn. Each vector has sums in lanes, points dealt to them in turn: they do not depend on how vectors are
//! shared between threads.

use super::phase_tables::turn_f64;
use super::simd;
use super::wave_power::{Method, WavePoints};
use super::{Cpu, SimdLevel};
use crate::control::{Control, Done};
use crate::error::Result;
use crate::plan::WaveList;

/// Points a kernel takes at a time.
pub(super) const LANES: usize = 8;

/// Points whose coordinates stay in the cache while vectors pass by; also what is summed before it joins other sums.
const CHUNK: usize = 1024;

/// Vectors of a part: what a thread takes at a time.
const PART: usize = 64;

/// One wave vector, in cycles per side.
pub(super) struct Vector {
    /// The integer below each component.
    whole: [u64; 3],
    /// What is left of each component, if any is.
    rest: Option<[f64; 3]>,
}

impl Vector {
    fn new(m: [f64; 3]) -> Self {
        let rest = m.map(|m| m - m.floor());
        Self { whole: m.map(|m| m.floor() as i64 as u64), rest: (rest != [0.0; 3]).then_some(rest) }
    }
}

/// A list, vector by vector.
pub(super) struct Terms<'a> {
    list: &'a WaveList,
    level: SimdLevel,
}

impl<'a> Terms<'a> {
    pub(super) fn new(cpu: &Cpu, list: &'a WaveList) -> Self {
        Self { list, level: cpu.level() }
    }
}

impl Method for Terms<'_> {
    type Scratch = ();

    fn parts(&self) -> usize {
        self.list.vectors.len().div_ceil(PART)
    }

    fn sum(
        &self,
        part: usize,
        points: &WavePoints<'_>,
        (): &mut (),
        control: &Control,
        mut put: impl FnMut(usize, [f64; 2]),
    ) -> Result<()> {
        let first = part * PART;
        let last = (first + PART).min(self.list.vectors.len());
        let vectors: Vec<Vector> = self.list.vectors[first..last].iter().map(|&m| Vector::new(m)).collect();
        let mut totals = vec![[[0.0; LANES]; 2]; vectors.len()];
        for chunk in points.chunks(CHUNK) {
            control.check()?;
            for (vector, totals) in vectors.iter().zip(&mut totals) {
                let mut sums = [[0.0; LANES]; 2];
                simd::add_terms(self.level, vector, &chunk, &mut sums);
                for (total, sum) in totals.as_flattened_mut().iter_mut().zip(sums.as_flattened()) {
                    *total += sum;
                }
            }
        }
        let products = (points.len() * vectors.len()) as u64;
        control.did(Done { products, bytes: products * 8 * points.axes.len() as u64, ..Done::default() });
        for (k, [cos, sin]) in totals.into_iter().enumerate() {
            let s = if self.list.vectors[first + k] == [0.0; 3] {
                [points.total_weight(), 0.0]
            } else {
                [cos.iter().sum(), -sin.iter().sum::<f64>()]
            };
            put(first + k, s);
        }
        Ok(())
    }
}

/// The loop over points, to be inlined into a function for an instruction set.
pub(super) mod terms {
    use super::{LANES, Vector, WavePoints, turn_f64};

    /// Adds `w cos` and `w sin` of `2 pi m . x` of every point to the lane of the point.
    #[inline(always)]
    pub(in super::super) fn add<const FMA: bool>(
        vector: &Vector,
        points: &WavePoints<'_>,
        sums: &mut [[f64; LANES]; 2],
    ) {
        let n = points.len();
        for first in (0..n).step_by(LANES) {
            let count = LANES.min(n - first);
            let mut phases = [0u64; LANES];
            let mut rests = [0f64; LANES];
            for (a, axis) in points.axes.iter().enumerate() {
                let mut x = [0u64; LANES];
                x[..count].copy_from_slice(&axis[first..first + count]);
                for (phase, x) in phases.iter_mut().zip(x) {
                    *phase = phase.wrapping_add(x.wrapping_mul(vector.whole[a]));
                }
                if let Some(rest) = vector.rest {
                    // Not of the integers: in a window the upper side is not the lower one.
                    let turns = &points.turns[a][first..first + count];
                    rests.iter_mut().zip(turns).for_each(|(sum, turns)| *sum += turns * rest[a]);
                }
            }
            if vector.rest.is_some() {
                for (phase, rest) in phases.iter_mut().zip(rests) {
                    // In [1, 2): 52 bits of it are the mantissa.
                    let turn = 1.0 + (rest - rest.floor());
                    *phase = phase.wrapping_add(turn.to_bits() << 12);
                }
            }
            let mut weights = [0f64; LANES];
            match points.weights {
                Some(w) => weights[..count].copy_from_slice(&w[first..first + count]),
                None => weights[..count].fill(1.0),
            }
            let [cos, sin] = sums;
            for (((cos, sin), phase), weight) in cos.iter_mut().zip(sin).zip(phases).zip(weights) {
                let (c, s) = turn_f64::<FMA>(phase);
                *cos += weight * c;
                *sin += weight * s;
            }
        }
    }
}

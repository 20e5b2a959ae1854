//! The integer frequency grid, and how half of it stands for all.

use crate::error::{Error, Result};
use crate::memory::Memory;
use crate::points::Domain;
use crate::setting::Setting;

/// All integer wave vectors `m` with `|m_k| <= F_k`. Only `m_0 >= 0` is computed and stored: `P(-m) = P(m)`.
///
/// Stored order: `m_0` in `0..=F_0` outermost, then `m_1` in `-F_1..=F_1`, then `m_2` in `-F_2..=F_2`; axes a domain
/// lacks have `F = 0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct WaveGrid {
    dim: usize,
    max_frequency: [u32; 3],
}

/// Frequencies above this are refused: `m` must be exact in f32.
pub const MAX_FREQUENCY: u32 = 1 << 22;

/// Bytes that sums, transforms, estimates and output take per mode of the whole grid: measured as the peak of whole runs, 50.
const BYTES_PER_MODE: u128 = 52;

/// Larger grids are refused: they would take more than about 26 GiB.
const MAX_MODES: u128 = 1 << 29;

/// The default grid never has more modes than this (about 3 GiB), nor more than the memory holds.
const MAX_DEFAULT_MODES: u64 = 1 << 26;

impl WaveGrid {
    /// The grid with the given largest frequency per axis (`max_frequency.len()` axes).
    ///
    /// # Errors
    /// Frequencies of 0, beyond the largest, or of another number of axes.
    pub fn new(max_frequency: &[u32]) -> Result<Self> {
        let mut all = [0; 3];
        for (a, &f) in all.iter_mut().zip(max_frequency) {
            if f > MAX_FREQUENCY {
                return Err(Error::setting(Setting::MaxFrequency, f, format!("expected at most {MAX_FREQUENCY}")));
            }
            *a = f;
        }
        let grid = Self { dim: max_frequency.len(), max_frequency: all };
        let modes: u128 = all.iter().map(|&f| 2 * u128::from(f) + 1).product();
        if modes > MAX_MODES {
            let value = max_frequency.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
            let gib = (modes * BYTES_PER_MODE) >> 30;
            let reason = format!(
                "{modes} wave vectors need about {gib} GiB; at most {MAX_MODES} are supported (rings alone: `stats` radial `ring_directions` N)"
            );
            return Err(Error::setting(Setting::MaxFrequency, value, reason));
        }
        Ok(grid)
    }

    /// The default grid, `F = ceil(5 n^(1/d))` on a cube; on unequal sides `F_k` grows with the side so that the
    /// largest frequency per unit length is the same on every axis. Where that would be more than `MAX_DEFAULT_MODES`
    /// modes, or more than `memory` holds, n counts as what reaches just that many.
    pub fn default_max_frequency(n: f64, domain: &Domain, memory: Memory) -> Vec<u32> {
        let d = domain.dim() as f64;
        let mean_side = domain.measure().powf(1.0 / d);
        // About 10^d modes per point.
        let most = MAX_DEFAULT_MODES.min(memory.0 / BYTES_PER_MODE as u64);
        let n = n.min(most as f64 / 10f64.powf(d));
        let f = |&side: &f64| {
            let exact = 5.0 * n.powf(1.0 / d) * side / mean_side;
            // An exact integer must not be lifted by the rounding of the root.
            (exact * (1.0 - 1e-12)).ceil().clamp(1.0, f64::from(MAX_FREQUENCY)) as u32
        };
        domain.sides().iter().map(f).collect()
    }

    /// Bytes that sums, estimates and output take of it.
    pub(crate) fn memory(&self) -> u128 {
        self.full_len() as u128 * BYTES_PER_MODE
    }

    /// Number of axes.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// `F` per axis; 0 on axes the domain lacks.
    pub fn max_frequency(&self) -> [u32; 3] {
        self.max_frequency
    }

    /// `F` along each axis of the domain.
    pub fn max_frequency_of_axes(&self) -> &[u32] {
        &self.max_frequency[..self.dim]
    }

    /// Stored length per axis: `F_0 + 1`, `2 F_1 + 1`, `2 F_2 + 1`.
    pub fn half_shape(&self) -> [usize; 3] {
        let [f0, f1, f2] = self.max_frequency.map(|f| f as usize);
        [f0 + 1, 2 * f1 + 1, 2 * f2 + 1]
    }

    /// Number of stored modes.
    pub fn half_len(&self) -> usize {
        self.half_shape().iter().product()
    }

    /// Number of modes of the whole grid.
    pub fn full_len(&self) -> usize {
        self.max_frequency.iter().map(|&f| 2 * f as usize + 1).product()
    }

    /// Where the DC mode `m = 0` is stored.
    pub fn dc(&self) -> usize {
        self.half_index([0, 0, 0])
    }

    /// Where mode `m` is stored; `-m` stands in where `m_0 < 0`.
    pub fn half_index(&self, m: [i32; 3]) -> usize {
        let m = if m[0] < 0 { m.map(|x| -x) } else { m };
        let [_, n1, n2] = self.half_shape();
        let at = |k: usize| (m[k] + self.max_frequency[k] as i32) as usize;
        (m[0] as usize * n1 + at(1)) * n2 + at(2)
    }

    /// The stored mode at `index`.
    pub fn mode(&self, index: usize) -> [i32; 3] {
        let [_, n1, n2] = self.half_shape();
        let at = |i: usize, k: usize| i as i32 - self.max_frequency[k] as i32;
        [(index / (n1 * n2)) as i32, at(index / n2 % n1, 1), at(index % n2, 2)]
    }

    /// How many modes of the whole grid the stored mode stands for: 2 (itself and its mirror image) where `m_0 > 0`;
    /// 1 on the plane `m_0 = 0`, which is stored whole.
    pub fn multiplicity(&self, index: usize) -> u32 {
        if self.mode(index)[0] > 0 { 2 } else { 1 }
    }

    /// Shape of the whole grid: `2 F_k + 1` per axis of the domain.
    pub fn full_shape(&self) -> Vec<usize> {
        self.max_frequency[..self.dim].iter().map(|&f| 2 * f as usize + 1).collect()
    }

    /// The whole grid from stored values, x axis first (slowest), index `m + F`.
    pub fn full<'a>(&self, half: &'a [f64]) -> impl ExactSizeIterator<Item = f64> + 'a {
        let (dc, centre) = (self.dc(), self.full_len() / 2);
        // What precedes DC is what follows it, read backwards: exactly so also on the plane m_0 = 0, which is stored whole and
        // where an FFT's two halves differ by rounding.
        (0..self.full_len()).map(move |i| half[dc + i.abs_diff(centre)])
    }

    /// The columns of the matrix product: all `(m_1, m_2)` from which every stored mode follows by sign, i.e. one of
    /// each pair `+-(m_1, m_2)`.
    pub fn columns(&self) -> Vec<[i32; 2]> {
        let [_, f1, f2] = self.max_frequency.map(|f| f as i32);
        let zero = (0..=f2).map(|m2| [0, m2]);
        let rest = (1..=f1).flat_map(|m1| (-f2..=f2).map(move |m2| [m1, m2]));
        zero.chain(rest).collect()
    }
}

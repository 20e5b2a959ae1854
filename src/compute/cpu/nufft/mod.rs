//! Amplitudes of all modes of a grid by the type 1 nonuniform fast Fourier transform: points are spread to a fine grid with
//! a smooth kernel, the grid is transformed, and the transform of the kernel is divided out (Dutt and Rokhlin, SIAM J. Sci.
//! Comput. 14, 1368, 1993; the kernel and the choice of its width follow FINUFFT: Barnett, Magland, af Klinteberg, SIAM J.
//! Sci. Comput. 41, C479, 2019).
//!
//! Weights are real, so the fine grid is real too: half of the spreading and of the transform along the first axis, and of
//! all others only what the modes with `m_0 >= 0` need. Positions are exact integers until they are fractions of a cell, so
//! that the error does not grow with the frequency. Everything is f64.

mod cache;
mod kernel;
mod spread;
mod threads;
mod transform;

pub(super) use cache::Cache;
pub(super) use spread::Band;
pub use spread::Nonuniform;

use rustfft::num_complex::Complex;

use self::kernel::SpreadingKernel;
use self::spread::{FineGrid, Sorted};
use self::transform::{Cut, Transform, Worker};
use super::SimdLevel;
use crate::control::{Control, Done};
use crate::error::Result;
use crate::memory::Memory;
use crate::plan::{NufftSizes, WaveGrid};
use crate::pool::Pool;

/// A plan for all realizations that share a grid of modes.
pub struct Nufft {
    grid: WaveGrid,
    sizes: NufftSizes,
    transform: Transform,
    /// Bytes that a transform may take.
    memory: Memory,
}

/// What one transform at a time needs beside its result; grows as asked, and is kept for the next one.
#[derive(Debug, Default)]
pub struct Scratch {
    columns: Vec<Complex<f64>>,
    sorted: Sorted,
    workers: Vec<Worker>,
}

impl Nufft {
    /// Plans the modes of a grid for realizations of about `points` points each, by which the fastest sizes are chosen.
    ///
    /// The error of all amplitudes, relative in l2 to those of uniform points, is at most `tolerance`, and that of no single
    /// one is above `2 tolerance sum |w|`. Tolerances from 4e-15 to 0.1 can be kept; any other is an error.
    pub fn new(grid: &WaveGrid, tolerance: f64, points: f64, level: SimdLevel) -> Result<Self> {
        let sizes = NufftSizes::new(grid, tolerance, points)?;
        // Polynomials err little next to aliasing, even where their error is lifted most.
        let kernel = |a: usize| SpreadingKernel::new(sizes.width, sizes.sigma(a), 0.02 * tolerance);
        let axes = (0..sizes.axes.len()).map(|a| (sizes.axes[a], sizes.cells[a], kernel(a))).collect();
        let transform = Transform::new(FineGrid::new(axes, level), &sizes.largest);
        Ok(Self { grid: *grid, sizes, transform, memory: Memory(u64::MAX) })
    }

    /// The same within about this memory, results and sorted points apart: by bands of the fine grid, and where even that
    /// takes more, by blocks of frequencies, for each of which points are spread again. The same bits come out.
    #[must_use]
    pub fn within(self, memory: Memory) -> Self {
        Self { memory, ..self }
    }

    fn cut(&self, threads: usize) -> Cut {
        self.transform.cut(threads, self.sizes.frequencies(self.memory), self.memory)
    }

    /// Bytes of a `Scratch` for `n` points on `threads` threads.
    pub fn bytes(&self, n: usize, weighted: bool, threads: usize) -> u64 {
        let cut = self.cut(threads);
        self.transform.bytes(cut, threads) + self.transform.grid().sorted_bytes(n, weighted)
    }

    /// `s_m = sum_j w_j exp(-2 pi i m.x_j)` of every stored mode, in the order of `WaveGrid`. DC is the sum of the weights.
    ///
    /// `points` has the axes of the grid, and `out` the length `half_len`. The same bits come out on one thread (`pool` is
    /// `None`) and on any pool.
    pub fn amplitudes(
        &self,
        points: &Nonuniform<'_>,
        scratch: &mut Scratch,
        pool: Option<&Pool>,
        control: &Control,
        out: &mut [Complex<f64>],
    ) -> Result<()> {
        self.run(points, scratch, pool, control, |s| s, out)?;
        out[self.grid.dc()] = Complex::new(total(points), 0.0);
        Ok(())
    }

    /// The same, real and imaginary part apart.
    pub(super) fn components(
        &self,
        points: &Nonuniform<'_>,
        scratch: &mut Scratch,
        pool: Option<&Pool>,
        control: &Control,
        out: &mut [[f64; 2]],
    ) -> Result<()> {
        self.run(points, scratch, pool, control, |s| [s.re, s.im], out)?;
        out[self.grid.dc()] = [total(points), 0.0];
        Ok(())
    }

    /// `|s_m|^2` of every stored mode; else as `amplitudes`.
    pub fn power(
        &self,
        points: &Nonuniform<'_>,
        scratch: &mut Scratch,
        pool: Option<&Pool>,
        control: &Control,
        out: &mut [f64],
    ) -> Result<()> {
        self.run(points, scratch, pool, control, |s| s.norm_sqr(), out)?;
        out[self.grid.dc()] = total(points).powi(2);
        Ok(())
    }

    fn run<T: Send>(
        &self,
        points: &Nonuniform<'_>,
        scratch: &mut Scratch,
        pool: Option<&Pool>,
        control: &Control,
        finish: impl Fn(Complex<f64>) -> T + Sync,
        out: &mut [T],
    ) -> Result<()> {
        let threads = pool.map_or(1, Pool::threads);
        let Scratch { columns, sorted, workers } = scratch;
        workers.resize_with(threads.max(workers.len()), Worker::default);
        self.transform.grid().sort(points, sorted, pool, control)?;
        let cut = self.cut(threads);
        // Every point is added to the cells of its kernel; a Fourier transform takes about log2 of its cells additions of each.
        let (n, cells) = (points.axes[0].len() as u64, self.sizes.fine_cells());
        let spread = n * (self.sizes.width as u64).pow(self.sizes.axes.len() as u32);
        let turned = (cells * cells.max(2.0).log2()) as u64;
        control.did(Done { products: spread + turned, bytes: 16 * (spread + cells as u64), ..Done::default() });
        self.transform.run(sorted, (columns, workers), (cut, pool), control, finish, out)
    }
}

/// The sum of all weights, which is the amplitude at `m = 0`.
fn total(points: &Nonuniform<'_>) -> f64 {
    points.weights.map_or(points.axes[0].len() as f64, |w| w.iter().sum())
}

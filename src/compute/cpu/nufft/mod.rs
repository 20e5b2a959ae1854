//! Amplitudes of all modes of a grid by the type 1 nonuniform fast Fourier transform: points are spread to a fine grid with
//! a smooth kernel, the grid is transformed, and the transform of the kernel is divided out (Dutt and Rokhlin, SIAM J. Sci.
//! Comput. 14, 1368, 1993; the kernel and the choice of its width follow FINUFFT: Barnett, Magland, af Klinteberg, SIAM J.
//! Sci. Comput. 41, C479, 2019).
//!
//! Weights are real, so the fine grid is real too: half of the spreading and of the transform along the first axis, and of
//! all others only what the modes with `m_0 >= 0` need. Positions are exact integers until they are fractions of a cell, so
//! that the error does not grow with the frequency. Everything is f64.

mod kernel;
mod spread;
mod threads;
mod transform;

pub(super) use spread::Band;
pub use spread::Points;

use rayon::ThreadPool;
use rustfft::num_complex::Complex;

use self::kernel::{Kernel, MAX_WIDTH, width};
use self::spread::{FineGrid, Sorted};
use self::transform::{Transform, Worker};
use super::SimdLevel;
use crate::compute::Control;
use crate::error::{Error, Result, number};
use crate::plan::WaveGrid;

/// The tolerance of accuracy `fast`.
pub const FAST_TOLERANCE: f64 = 1e-9;

/// The tolerance of accuracy `high`.
pub const HIGH_TOLERANCE: f64 = 1e-14;

/// Tolerances that can be asked for: what the widest kernel and rounding in f64 allow.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-14..=0.1;

/// How much finer than the frequencies wanted the grid may be, `cells >= sigma * 2 F`: a finer grid makes longer transforms
/// and narrower kernels.
const UPSAMPLING: [f64; 3] = [1.5, 2.0, 2.25];

/// Nanoseconds of one thread, measured where `fma_gflop` reaches 128 GFLOP/s: per point (its place in the sort and its kernel
/// values), per row of cells that a point is added to and per cell of such a row, and per cell of the grid (set to 0, fold,
/// transform).
const POINT_NS: f64 = 18.0;
const ROW_NS: f64 = 1.4;
const ROW_CELL_NS: f64 = 0.08;
const CELL_NS: f64 = 3.5;

/// The sizes that follow from a grid, a tolerance and the number of points.
#[derive(Debug, Clone, PartialEq)]
struct Sizes {
    /// The axes that are transformed; one without frequencies adds nothing, but for the first, which is the real one.
    axes: Vec<usize>,
    largest: Vec<usize>,
    cells: Vec<usize>,
    width: usize,
}

impl Sizes {
    /// The fastest that keep the tolerance.
    fn new(grid: &WaveGrid, tolerance: f64, points: f64) -> Result<Self> {
        if !TOLERANCES.contains(&tolerance) {
            let reason = format!("expected {} to {}", number(*TOLERANCES.start()), number(*TOLERANCES.end()));
            return Err(Error::setting("--tolerance", number(tolerance), reason));
        }
        let f = grid.max_frequency().map(|f| f as usize);
        let axes: Vec<usize> = (0..grid.dim()).filter(|&a| a == 0 || f[a] > 0).collect();
        let largest: Vec<usize> = axes.iter().map(|&a| f[a]).collect();
        let with = |upsampling: f64| {
            let cells: Vec<usize> = largest.iter().map(|&f| fine_size(upsampling, f)).collect();
            let mut sizes = Self { axes: axes.clone(), largest: largest.clone(), cells, width: 0 };
            let sigma = (0..axes.len()).map(|a| sizes.sigma(a)).fold(f64::INFINITY, f64::min);
            sizes.width = width(tolerance, sigma, axes.len());
            sizes
        };
        let possible = UPSAMPLING.map(with).into_iter().filter(|sizes| sizes.width <= MAX_WIDTH);
        possible
            .min_by(|a, b| a.nanoseconds(points).total_cmp(&b.nanoseconds(points)))
            .ok_or_else(|| Error::setting("--tolerance", number(tolerance), "no kernel is wide enough"))
    }

    /// How much finer than its frequencies axis `a` is.
    fn sigma(&self, a: usize) -> f64 {
        self.cells[a] as f64 / (2 * self.largest[a]) as f64
    }

    fn nanoseconds(&self, points: f64) -> f64 {
        let rows = self.width.pow(self.axes.len() as u32 - 1) as f64;
        let cells = self.cells.iter().map(|&c| c as f64).product::<f64>();
        points * (POINT_NS + rows * (ROW_NS + ROW_CELL_NS * spread::lanes(self.width) as f64)) + CELL_NS * cells
    }
}

/// The estimated time of one realization on one thread, in nanoseconds where `fma_gflop` reaches 128 GFLOP/s. An error for
/// a tolerance that cannot be kept.
pub fn nanoseconds(grid: &WaveGrid, tolerance: f64, points: f64) -> Result<f64> {
    Ok(Sizes::new(grid, tolerance, points)?.nanoseconds(points))
}

/// A plan for all realizations that share a grid of modes.
pub struct Nufft {
    grid: WaveGrid,
    transform: Transform,
}

/// What one transform at a time needs beside its result; grows as asked, and is kept for the next one.
#[derive(Debug, Default)]
pub struct Scratch {
    cells: Vec<f64>,
    columns: Vec<Complex<f64>>,
    sorted: Sorted,
    workers: Vec<Worker>,
}

impl Nufft {
    /// Plans the modes of a grid for realizations of about `points` points each, by which the fastest sizes are chosen.
    ///
    /// The error of all amplitudes, relative in l2 to those of uniform points, is at most `tolerance`, and that of no single
    /// one is above `2 tolerance sum |w|`. Tolerances from 1e-14 to 0.1 can be kept; any other is an error.
    pub fn new(grid: &WaveGrid, tolerance: f64, points: f64, level: SimdLevel) -> Result<Self> {
        let sizes = Sizes::new(grid, tolerance, points)?;
        // Polynomials err little next to aliasing, even where their error is lifted most.
        let kernel = |a: usize| Kernel::new(sizes.width, sizes.sigma(a), 0.02 * tolerance);
        let axes = (0..sizes.axes.len()).map(|a| (sizes.axes[a], sizes.cells[a], kernel(a))).collect();
        Ok(Self { grid: *grid, transform: Transform::new(FineGrid::new(axes, level), &sizes.largest) })
    }

    /// Bytes of a `Scratch` for `n` points on `threads` threads.
    pub fn bytes(&self, n: usize, weighted: bool, threads: usize) -> u64 {
        let fine = self.transform.grid();
        let columns = self.transform.columns(fine.axes.len() - 1) * size_of::<Complex<f64>>();
        let workers = threads as u64 * self.transform.worker_bytes();
        (fine.stored() * 8 + columns) as u64 + fine.sorted_bytes(n, weighted) + workers
    }

    /// `s_m = sum_j w_j exp(-2 pi i m.x_j)` of every stored mode, in the order of `WaveGrid`. DC is the sum of the weights.
    ///
    /// `points` has the axes of the grid, and `out` the length `half_len`. The same bits come out on one thread (`pool` is
    /// `None`) and on any pool.
    pub fn amplitudes(
        &self,
        points: &Points<'_>,
        scratch: &mut Scratch,
        pool: Option<&ThreadPool>,
        control: &Control,
        out: &mut [Complex<f64>],
    ) -> Result<()> {
        self.run(points, scratch, pool, control, |s| s, out)?;
        out[self.grid.dc()] = Complex::new(total(points), 0.0);
        Ok(())
    }

    /// `|s_m|^2` of every stored mode; else as `amplitudes`.
    pub fn power(
        &self,
        points: &Points<'_>,
        scratch: &mut Scratch,
        pool: Option<&ThreadPool>,
        control: &Control,
        out: &mut [f64],
    ) -> Result<()> {
        self.run(points, scratch, pool, control, |s| s.norm_sqr(), out)?;
        out[self.grid.dc()] = total(points).powi(2);
        Ok(())
    }

    fn run<T: Send>(
        &self,
        points: &Points<'_>,
        scratch: &mut Scratch,
        pool: Option<&ThreadPool>,
        control: &Control,
        finish: impl Fn(Complex<f64>) -> T + Sync,
        out: &mut [T],
    ) -> Result<()> {
        let fine = self.transform.grid();
        let threads = pool.map_or(1, ThreadPool::current_num_threads);
        scratch.cells.resize(fine.stored(), 0.0);
        scratch.columns.resize(self.transform.columns(fine.axes.len() - 1), Complex::default());
        scratch.workers.resize_with(threads.max(scratch.workers.len()), Worker::default);
        scratch.workers.iter_mut().for_each(|worker| self.transform.prepare(worker));
        fine.spread(points, &mut scratch.sorted, &mut scratch.cells, pool, control)?;
        let Scratch { cells, columns, workers, .. } = scratch;
        self.transform.run((cells, columns, workers), pool, control, finish, out)
    }
}

/// The sum of all weights, which is the amplitude at `m = 0`.
fn total(points: &Points<'_>) -> f64 {
    points.weights.map_or(points.axes[0].len() as f64, |w| w.iter().sum())
}

/// The least number of cells, even and at least `sigma 2 f`, that the library transforms fast: powers of two and three and at
/// most one five.
fn fine_size(sigma: f64, f: usize) -> usize {
    let least = ((sigma * 2.0 * f as f64).ceil() as usize).max(2 * f + 2);
    let fast = |mut n: usize| {
        n >>= n.trailing_zeros();
        if n % 5 == 0 {
            n /= 5;
        }
        while n % 3 == 0 {
            n /= 3;
        }
        n == 1
    };
    (least.next_multiple_of(2)..).step_by(2).find(|&n| fast(n)).unwrap_or(least)
}

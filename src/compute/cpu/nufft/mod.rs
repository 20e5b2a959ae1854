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

/// Tolerances that can be asked for.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-14..=0.1;

/// How much finer than the frequencies wanted the grid may be: `cells >= sigma * 2 F`.
const UPSAMPLING: [f64; 3] = [1.25, 1.5, 2.0];

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
    pub fn new(grid: &WaveGrid, tolerance: f64, points: f64, level: SimdLevel) -> Result<Self> {
        if !TOLERANCES.contains(&tolerance) {
            let (least, most) = (number(*TOLERANCES.start()), number(*TOLERANCES.end()));
            return Err(Error::setting("--tolerance", number(tolerance), format!("expected {least} to {most}")));
        }
        let f = grid.max_frequency().map(|f| f as usize);
        // An axis without frequencies adds nothing, but for the first, which is the real one.
        let axes: Vec<usize> = (0..grid.dim()).filter(|&a| a == 0 || f[a] > 0).collect();
        let largest: Vec<usize> = axes.iter().map(|&a| f[a]).collect();
        let upsampling = std::env::var("SIGMA").ok().and_then(|s| s.parse().ok()).unwrap_or(if points < 10.0 {
            1.5
        } else {
            UPSAMPLING[2]
        });
        let cells: Vec<usize> = largest.iter().map(|&f| fine_size(upsampling, f)).collect();
        let sigma = |a: usize| cells[a] as f64 / (2 * largest[a]) as f64;
        let least_sigma = (0..axes.len()).map(sigma).fold(f64::INFINITY, f64::min);
        let width = std::env::var("WIDTH")
            .ok()
            .and_then(|s| s.parse().ok())
            .unwrap_or(width(tolerance, least_sigma, axes.len()).min(MAX_WIDTH));
        let kernels = (0..axes.len()).map(|a| (axes[a], cells[a], Kernel::new(width, sigma(a), 0.1 * tolerance)));
        if std::env::var("SHOW").is_ok() {
            eprintln!("cells {cells:?} width {width}");
        }
        let fine = FineGrid::new(kernels.collect(), level);
        Ok(Self { grid: *grid, transform: Transform::new(fine, &largest) })
    }

    /// Bytes of a `Scratch` for `n` points on `threads` threads.
    pub fn bytes(&self, n: usize, weighted: bool, threads: usize) -> u64 {
        let fine = self.transform.grid();
        let columns = self.transform.columns(fine.axes.len() - 1) * size_of::<Complex<f64>>();
        let workers = threads as u64 * self.transform.worker_bytes();
        (fine.stored() * 8 + columns) as u64 + fine.sorted_bytes(n, weighted) + workers
    }

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
        let t0 = std::time::Instant::now();
        fine.spread(points, &mut scratch.sorted, &mut scratch.cells, pool, control)?;
        let t1 = std::time::Instant::now();
        let r = self.transform.run(
            &mut scratch.cells,
            &mut scratch.columns,
            &mut scratch.workers,
            pool,
            control,
            finish,
            out,
        );
        if std::env::var("SHOW").is_ok() {
            eprintln!("spread {:.3} fft {:.3}", (t1 - t0).as_secs_f64() * 1e3, t1.elapsed().as_secs_f64() * 1e3);
        }
        r
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

//! The sizes of a nonuniform fast Fourier transform: how fine a grid, and how wide a kernel. The fastest that keep the
//! tolerance, by an estimate of the time.

use std::f64::consts::PI;

use super::WaveGrid;
use crate::error::{Error, Result, number};
use crate::memory::Memory;
use crate::setting::Setting;

/// Widest kernel, in cells: two vectors of eight f64.
pub const MAX_KERNEL_WIDTH: usize = 16;

/// Tolerances that can be asked for: what the widest kernel and rounding in f64 allow.
const TOLERANCES: std::ops::RangeInclusive<f64> = 4e-15..=0.1;

/// How much finer than the frequencies wanted the grid may be, `cells >= sigma * 2 F`: a finer grid makes longer transforms
/// and narrower kernels.
const UPSAMPLING: [f64; 3] = [1.5, 2.0, 2.25];

/// What a transform takes on a device, in nanoseconds of one thread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NufftCosts {
    /// A point's kernel along an axis, by the square of its width: so many cells, polynomials of about that degree.
    pub kernel: f64,
    /// A row of cells that a point is added to.
    pub row: f64,
    /// A cell of it, in whole vectors.
    pub add: f64,
    /// A cell of a small fine grid: cleared, folded and transformed.
    pub cell: f64,
    /// What a cell of a large one takes beside that; half of it in a grid of `cache` cells.
    pub far_cell: f64,
    /// See `far_cell`.
    pub cache: f64,
    /// Beginning.
    pub start: f64,
}

impl NufftCosts {
    /// Least squares of the logarithms of the times of transforms in `benches/wave_sweep.rs`, on the core of `WaveCosts::CPU`.
    pub const CPU: Self =
        Self { kernel: 0.115, row: 0.1, add: 0.14, cell: 2.4, far_cell: 2.6, cache: 6e5, start: 2000.0 };

    /// One realization of `points` points.
    pub fn nanoseconds(&self, sizes: &NufftSizes, points: f64) -> f64 {
        let kernels = (sizes.axes.len() * sizes.width.pow(2)) as f64;
        let rows = sizes.width.pow(sizes.axes.len() as u32 - 1) as f64;
        let row = self.row + self.add * kernel_lanes(sizes.width) as f64;
        let cells = sizes.fine_cells();
        let cell = self.cell + self.far_cell * cells / (cells + self.cache);
        self.start + points * (kernels * self.kernel + rows * row) + cells * cell
    }
}

/// The sizes that follow from a grid, a tolerance and the number of points.
#[derive(Debug, Clone, PartialEq)]
pub struct NufftSizes {
    /// The axes that are transformed; one without frequencies adds nothing, but for the first, which is the real one.
    pub axes: Vec<usize>,
    /// Their largest frequencies.
    pub largest: Vec<usize>,
    /// Their cells in the fine grid.
    pub cells: Vec<usize>,
    /// Cells of a kernel along each.
    pub width: usize,
}

impl NufftSizes {
    /// The fastest that keep the tolerance.
    ///
    /// # Errors
    /// Why there is none: a fine grid that does not fit, a tolerance out of reach.
    pub fn new(grid: &WaveGrid, tolerance: f64, points: f64) -> Result<Self> {
        if !TOLERANCES.contains(&tolerance) {
            let reason = format!("expected {} to {}", number(*TOLERANCES.start()), number(*TOLERANCES.end()));
            return Err(Error::setting(Setting::Tolerance, number(tolerance), reason));
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
        let time = |sizes: &Self| NufftCosts::CPU.nanoseconds(sizes, points);
        let possible = UPSAMPLING.map(with).into_iter().filter(|sizes| sizes.width <= MAX_KERNEL_WIDTH);
        possible
            .min_by(|a, b| time(a).total_cmp(&time(b)))
            .ok_or_else(|| Error::setting(Setting::Tolerance, number(tolerance), "no kernel is wide enough"))
    }

    /// How much finer than its frequencies axis `a` is.
    pub fn sigma(&self, a: usize) -> f64 {
        self.cells[a] as f64 / (2 * self.largest[a]) as f64
    }

    /// Frequencies of the first axis that are done at a time, so that what is left of the fine grid before its last axis takes
    /// no more than half of the memory: as many in every block, but for the last one, and at least one.
    pub fn frequencies(&self, memory: Memory) -> usize {
        let kept = self.largest[0] + 1;
        let Some((last, others)) = self.cells.split_last().filter(|(_, others)| !others.is_empty()) else {
            return kept;
        };
        let between: usize = self.largest[1..others.len()].iter().map(|f| 2 * f + 1).product();
        let bytes = (16 * last * between) as u64;
        let most = (memory.0 / 2 / bytes.max(1)).clamp(1, kept as u64) as usize;
        kept.div_ceil(kept.div_ceil(most))
    }

    /// How many blocks those are: the points are spread again for each.
    pub fn blocks(&self, memory: Memory) -> usize {
        (self.largest[0] + 1).div_ceil(self.frequencies(memory))
    }

    /// Cells of the fine grid.
    pub fn fine_cells(&self) -> f64 {
        self.cells.iter().map(|&c| c as f64).product()
    }
}

/// f64 in the vectors that hold a kernel.
pub(crate) fn kernel_lanes(width: usize) -> usize {
    if width <= 8 { 8 } else { 16 }
}

/// The width that keeps the aliasing error of `dim` axes, upsampled by `sigma`, below `tolerance`: its rate is
/// `exp(-pi w sqrt(1 - 1 / sigma))` (Barnett, Magland, af Klinteberg, SIAM J. Sci. Comput. 41, C479, 2019, eq. 4.9); the
/// cells beyond that are measured, for sigma from 1.5 to 2.25.
fn width(tolerance: f64, sigma: f64, dim: usize) -> usize {
    let cells = (1.0 / tolerance).ln() / (PI * (1.0 - 1.0 / sigma).sqrt());
    (cells + 0.9 + 0.3 * dim as f64).ceil().max(2.0) as usize
}

/// The least number of cells, even and at least `sigma 2 f`, that the library transforms fast: powers of two and three and at
/// most one five.
fn fine_size(sigma: f64, f: usize) -> usize {
    let least = ((sigma * 2.0 * f as f64).ceil() as usize).max(2 * f + 2);
    let fast = |mut n: usize| {
        n >>= n.trailing_zeros();
        if n.is_multiple_of(5) {
            n /= 5;
        }
        while n.is_multiple_of(3) {
            n /= 3;
        }
        n == 1
    };
    (least.next_multiple_of(2)..).step_by(2).find(|&n| fast(n)).unwrap_or(least)
}

//! From the fine grid to amplitudes: Fourier transforms axis by axis, each cut to the frequencies wanted and divided by the
//! transform of the kernel.
//!
//! The first axis is real and contiguous. Slabs (rows in 2D, planes in 3D) are transformed one by one, some bands of them as
//! soon as the points in reach are spread to them; eight at a time are transposed, so that the transforms along the last axis
//! read whole cache lines. What is kept between the two, the columns of the last axis, is done in blocks of frequencies of
//! the first where it would not fit into memory. No number depends on the cuts.

use std::ops::Range;
use std::sync::Arc;

use realfft::{RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner, num_complex::Complex};

use super::spread::{FineGrid, Sorted, add_all};
use super::threads::share;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::memory::Memory;
use crate::pool::Pool;
use crate::setting::Setting;

/// Slabs transposed at a time: two cache lines of one frequency.
const BLOCK: usize = 8;

/// Bytes of the bands that a task of many works on: about the last cache.
const CACHE: u64 = 1 << 25;

/// Bytes of a fine grid up to which it is spread as a whole.
const WHOLE: u64 = 1 << 26;

/// Transforms along the last axis per task.
const LINES: usize = 16;

/// The frequencies of one axis.
pub(super) struct AxisTransform {
    largest: usize,
    fft: AxisFft,
    /// `1 / transform of the kernel` at 0 to the largest frequency.
    factors: Vec<f64>,
}

enum AxisFft {
    Real(Arc<dyn RealToComplex<f64>>),
    Complex(Arc<dyn Fft<f64>>),
}

/// What one thread needs.
#[derive(Debug, Default)]
pub(super) struct Worker {
    /// Bands of the fine grid.
    cells: Vec<f64>,
    axes: Vec<AxisWorker>,
}

#[derive(Debug, Default, Clone)]
struct AxisWorker {
    /// The transforms of a block of slabs, or one line.
    line: Vec<Complex<f64>>,
    slabs: Vec<Complex<f64>>,
    columns: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

/// The transforms of all axes.
pub(super) struct Transform {
    grid: FineGrid,
    axes: Vec<AxisTransform>,
}

/// How a transform is cut for some threads and some memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    /// Bands of the fine grid spread and transformed at a time.
    bands: usize,
    /// Frequencies of the first axis done at a time.
    frequencies: usize,
}

/// A block of frequencies of the first axis.
struct Part<'a> {
    of: &'a Transform,
    frequencies: Range<usize>,
}

impl Transform {
    /// Up to frequency `largest[a]` along axis `a`.
    pub(super) fn new(grid: FineGrid, largest: &[usize]) -> Self {
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        let axes = grid.axes.iter().zip(largest).enumerate().map(|(a, (axis, &largest))| {
            let fft = match a {
                0 => AxisFft::Real(real.plan_fft_forward(axis.cells)),
                _ => AxisFft::Complex(complex.plan_fft_forward(axis.cells)),
            };
            let factors = axis.kernel.transform(axis.cells, largest).into_iter().map(f64::recip).collect();
            AxisTransform { largest, fft, factors }
        });
        Self { axes: axes.collect(), grid }
    }

    pub(super) fn grid(&self) -> &FineGrid {
        &self.grid
    }

    fn last(&self) -> usize {
        self.axes.len() - 1
    }

    /// Into as many frequencies at a time, and into bands that take a quarter of the memory on all threads, but at least one.
    pub(super) fn cut(&self, threads: usize, frequencies: usize, memory: Memory) -> Cut {
        let all = self.grid.bands();
        let band_bytes = (self.grid.band() * self.grid.step(self.last()) * size_of::<f64>()) as u64;
        // A few bands are done all at once; of more, a task does two beside its own.
        let fits = (memory.0 / 4 / threads as u64 / band_bytes).saturating_sub(2);
        let bands = match all as u64 * band_bytes {
            bytes if self.last() == 0 || bytes <= WHOLE.min(memory.0 / 4) => all,
            _ => all.div_ceil(4 * threads).min((CACHE / band_bytes).max(4).min(fits) as usize).max(1),
        };
        Cut { bands, frequencies }
    }

    /// Bytes beside the sorted points: of columns, and of workers.
    pub(super) fn bytes(&self, cut: Cut, threads: usize) -> u64 {
        let part = Part { of: self, frequencies: 0..cut.frequencies };
        let last = self.last();
        let complex: usize = (0..=last).map(|a| part.worker_numbers(a).into_iter().sum::<usize>()).sum();
        let room = (cut.bands + 2).min(self.grid.bands()) * self.grid.band() * self.grid.step(last);
        let numbers = part.columns(last) + threads * complex;
        (numbers * size_of::<Complex<f64>>() + threads * room * size_of::<f64>()) as u64
    }

    fn whole(&self) -> Part<'_> {
        Part { of: self, frequencies: 0..self.axes[0].largest + 1 }
    }

    /// The amplitudes of sorted points as `finish` makes them, in the order of `WaveGrid`. `columns` and `workers` are room to
    /// work in, one worker per thread.
    pub(super) fn run<T: Send>(
        &self,
        sorted: &Sorted,
        (columns, workers): (&mut Vec<Complex<f64>>, &mut [Worker]),
        (cut, pool): (Cut, Option<&Pool>),
        control: &Control,
        finish: impl Fn(Complex<f64>) -> T + Sync,
        out: &mut [T],
    ) -> Result<()> {
        if self.last() == 0 {
            let Worker { cells, axes } = &mut workers[0];
            self.whole().prepare(axes);
            let cells = self.grid.spread(0..self.grid.bands(), sorted, cells, pool, control)?;
            return self.whole().row(cells, &mut axes[0], |m, s| out[m] = finish(s));
        }
        let each = out.len() / (self.axes[0].largest + 1);
        for (k, out) in out.chunks_mut(cut.frequencies * each).enumerate() {
            let first = k * cut.frequencies;
            let part = Part { of: self, frequencies: first..first + out.len() / each };
            part.run(sorted, (columns, workers), (cut.bands, pool), control, &finish, out)?;
        }
        Ok(())
    }
}

impl Part<'_> {
    /// Frequencies kept along axis `a`.
    fn kept(&self, a: usize) -> usize {
        if a == 0 { self.frequencies.len() } else { 2 * self.of.axes[a].largest + 1 }
    }

    /// Frequencies of one slab of axis `a`: those of the axes before it.
    fn modes(&self, a: usize) -> usize {
        (0..a).map(|b| self.kept(b)).product()
    }

    /// Numbers in the columns of axis `a`: all frequencies of its slabs, as stored.
    fn columns(&self, a: usize) -> usize {
        if a == 0 { 0 } else { self.modes(a) * self.of.grid.axes[a].stored.next_multiple_of(BLOCK) }
    }

    /// Numbers of the line, slabs, columns and scratch of an `AxisWorker`.
    fn worker_numbers(&self, a: usize) -> [usize; 4] {
        let (line, scratch) = match &self.of.axes[a].fft {
            AxisFft::Real(fft) => (fft.complex_len(), fft.get_scratch_len()),
            AxisFft::Complex(fft) => {
                (self.of.grid.axes[a].stored.next_multiple_of(BLOCK), fft.get_inplace_scratch_len())
            }
        };
        let slabs = if a == 0 { 0 } else { self.modes(a) * BLOCK };
        let columns = if a < self.of.last() { self.columns(a) } else { 0 };
        [line, slabs, columns, scratch]
    }

    /// Makes a worker fit.
    fn prepare(&self, axes: &mut Vec<AxisWorker>) {
        axes.resize_with(self.of.axes.len(), AxisWorker::default);
        for (a, axis) in axes.iter_mut().enumerate() {
            let all = [&mut axis.line, &mut axis.slabs, &mut axis.columns, &mut axis.scratch];
            all.into_iter().zip(self.worker_numbers(a)).for_each(|(v, n)| v.resize(n, Complex::default()));
        }
    }

    fn run<T: Send>(
        &self,
        sorted: &Sorted,
        (columns, workers): (&mut Vec<Complex<f64>>, &mut [Worker]),
        (bands, pool): (usize, Option<&Pool>),
        control: &Control,
        finish: impl Fn(Complex<f64>) -> T + Sync,
        out: &mut [T],
    ) -> Result<()> {
        let (grid, last) = (&self.of.grid, self.of.last());
        workers.iter_mut().for_each(|worker| self.prepare(&mut worker.axes));
        columns.resize(self.columns(last), Complex::default());
        let (step, modes) = (grid.step(last), self.modes(last));
        if bands == grid.bands() {
            let mut room = std::mem::take(&mut workers[0].cells);
            let cells = grid.spread(0..bands, sorted, &mut room, pool, control)?;
            grid.fold(last, cells);
            let tasks = cells.chunks_mut(BLOCK * step).zip(columns.chunks_mut(BLOCK * modes)).enumerate();
            share(pool, workers, tasks, |worker, (block, (cells, columns))| {
                self.slabs(last, block * BLOCK, cells, columns, &mut worker.axes, control)
            })?;
            workers[0].cells = room;
        } else {
            let pads = self.pads(sorted, &mut workers[0].cells, control)?;
            let tasks = columns.chunks_mut(bands * grid.band() * modes).enumerate();
            share(pool, workers, tasks, |worker, (task, columns)| {
                let own = (task * bands).min(grid.bands())..((task + 1) * bands).min(grid.bands());
                let steps = grid.steps(&own);
                let cells = grid.spread(own, sorted, &mut worker.cells, None, control)?;
                for (to, pad) in pads.iter().filter(|(to, _)| steps.contains(to)) {
                    add_all(&mut cells[(to - steps.start) * step..][..step], pad);
                }
                self.slabs(last, steps.start, cells, columns, &mut worker.axes, control)
            })?;
        }
        let columns = &*columns;
        let kept = self.kept(last);
        let lines = out.chunks_mut(LINES * kept).enumerate();
        share(pool, workers, lines, |worker, (task, out)| {
            control.check()?;
            for (k, out) in out.chunks_exact_mut(kept).enumerate() {
                self.line(last, task * LINES + k, columns, &mut worker.axes[last], |m, s| out[m] = finish(s));
            }
            Ok(())
        })
    }

    /// The pads of the last axis, and the step as stored that each stands for, in the order of `FineGrid::fold`.
    fn pads(&self, sorted: &Sorted, room: &mut Vec<f64>, control: &Control) -> Result<Vec<(usize, Vec<f64>)>> {
        let (grid, last) = (&self.of.grid, self.of.last());
        let step = grid.step(last);
        let mut pads = Vec::new();
        for band in 0..grid.bands() {
            let steps = grid.steps(&(band..band + 1));
            let here: Vec<_> = grid.pads(last).filter(|(at, _)| steps.contains(at)).collect();
            if here.is_empty() {
                continue;
            }
            let cells = grid.spread(band..band + 1, sorted, room, None, control)?;
            pads.extend(here.into_iter().map(|(at, to)| (to, cells[(at - steps.start) * step..][..step].to_vec())));
        }
        Ok(pads)
    }

    /// Transforms slabs of axis `a`, of which the first is stored at `first`, a multiple of `BLOCK`, and transposes them:
    /// columns of `BLOCK` numbers per frequency. Pads are left out.
    fn slabs(
        &self,
        a: usize,
        first: usize,
        cells: &mut [f64],
        columns: &mut [Complex<f64>],
        workers: &mut [AxisWorker],
        control: &Control,
    ) -> Result<()> {
        let (axis, step, modes) = (&self.of.grid.axes[a], self.of.grid.step(a), self.modes(a));
        let (before, own) = workers.split_at_mut(a);
        let own = &mut own[0];
        let wanted = axis.pad()..axis.pad() + axis.cells;
        let blocks = cells.chunks_mut(BLOCK * step).zip(columns.chunks_mut(BLOCK * modes)).enumerate();
        for (block, (slabs, columns)) in blocks {
            control.check()?;
            let slabs = slabs.chunks_exact_mut(step).zip(own.slabs.chunks_exact_mut(modes)).enumerate();
            for (_, (slab, out)) in slabs.filter(|(s, _)| wanted.contains(&(first + block * BLOCK + s))) {
                self.slab(a - 1, slab, before, out, control)?;
            }
            for (mode, column) in columns.chunks_exact_mut(BLOCK).enumerate() {
                for (s, number) in column.iter_mut().enumerate() {
                    *number = own.slabs[s * modes + mode];
                }
            }
        }
        Ok(())
    }

    /// All frequencies of one slab whose last axis is `a`.
    fn slab(
        &self,
        a: usize,
        cells: &mut [f64],
        workers: &mut [AxisWorker],
        out: &mut [Complex<f64>],
        control: &Control,
    ) -> Result<()> {
        if a == 0 {
            return self.row(cells, &mut workers[0], |m, s| out[m] = s);
        }
        self.of.grid.fold(a, cells);
        let mut columns = std::mem::take(&mut workers[a].columns);
        self.slabs(a, 0, cells, &mut columns, workers, control)?;
        for (mode, out) in out.chunks_exact_mut(self.kept(a)).enumerate() {
            self.line(a, mode, &columns, &mut workers[a], |m, s| out[m] = s);
        }
        workers[a].columns = columns;
        Ok(())
    }

    /// The frequencies of one row of the first axis.
    fn row(
        &self,
        cells: &mut [f64],
        worker: &mut AxisWorker,
        mut write: impl FnMut(usize, Complex<f64>),
    ) -> Result<()> {
        self.of.grid.fold(0, cells);
        let (axis, own) = (&self.of.grid.axes[0], &self.of.axes[0]);
        let AxisFft::Real(fft) = &own.fft else { return Ok(()) };
        let row = &mut cells[axis.pad()..][..axis.cells];
        fft.process_with_scratch(row, &mut worker.line, &mut worker.scratch)
            .map_err(|e| Error::setting(Setting::MaxFrequency, own.largest, e.to_string()))?;
        let range = self.frequencies.clone();
        for (m, (s, factor)) in worker.line[range.clone()].iter().zip(&own.factors[range]).enumerate() {
            write(m, s * factor);
        }
        Ok(())
    }

    /// The frequencies of axis `a`, the least first, at one frequency of its slabs.
    fn line(
        &self,
        a: usize,
        mode: usize,
        columns: &[Complex<f64>],
        worker: &mut AxisWorker,
        mut write: impl FnMut(usize, Complex<f64>),
    ) {
        let (axis, own) = (&self.of.grid.axes[a], &self.of.axes[a]);
        let AxisFft::Complex(fft) = &own.fft else { return };
        let blocks = columns.chunks_exact(BLOCK * self.modes(a));
        for (to, block) in worker.line.chunks_exact_mut(BLOCK).zip(blocks) {
            to.copy_from_slice(&block[BLOCK * mode..][..BLOCK]);
        }
        let cells = axis.cells;
        let line = &mut worker.line[axis.pad()..][..cells];
        fft.process_with_scratch(line, &mut worker.scratch);
        let f = own.largest;
        for (m, (s, factor)) in line[cells - f..].iter().zip(own.factors[1..].iter().rev()).enumerate() {
            write(m, s * factor);
        }
        for (m, (s, factor)) in line.iter().zip(&own.factors).enumerate() {
            write(f + m, s * factor);
        }
    }
}

//! From the fine grid to amplitudes: Fourier transforms axis by axis, each cut to the frequencies wanted and divided by the
//! transform of the kernel.
//!
//! The first axis is real and contiguous. Slabs (rows in 2D, planes in 3D) are transformed one by one; eight of them at a
//! time are transposed, so that the transforms along the last axis read whole cache lines.

use std::sync::Arc;

use realfft::{RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner, num_complex::Complex};

use super::spread::FineGrid;
use super::threads::share;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::pool::Pool;
use crate::setting::Setting;

/// Slabs transposed at a time: two cache lines of one frequency.
const BLOCK: usize = 8;

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

/// What one thread needs, per axis.
#[derive(Debug, Default)]
pub(super) struct Worker {
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

    /// Frequencies kept along axis `a`.
    fn kept(&self, a: usize) -> usize {
        if a == 0 { self.axes[0].largest + 1 } else { 2 * self.axes[a].largest + 1 }
    }

    /// Frequencies of one slab of axis `a`: those of the axes before it.
    fn modes(&self, a: usize) -> usize {
        (0..a).map(|b| self.kept(b)).product()
    }

    /// Numbers in the columns of axis `a`: all frequencies of its slabs.
    pub(super) fn columns(&self, a: usize) -> usize {
        if a == 0 { 0 } else { self.modes(a) * self.grid.axes[a].cells.next_multiple_of(BLOCK) }
    }

    /// Bytes of a `Worker`.
    pub(super) fn worker_bytes(&self) -> u64 {
        let last = self.axes.len() - 1;
        let numbers = (0..=last).map(|a| {
            let line = self.grid.axes[a].cells * 2;
            line + self.modes(a) * BLOCK + if a < last { self.columns(a) } else { 0 }
        });
        (numbers.sum::<usize>() * size_of::<Complex<f64>>()) as u64
    }

    /// Makes a worker fit.
    pub(super) fn prepare(&self, worker: &mut Worker) {
        let last = self.axes.len() - 1;
        worker.axes.resize_with(self.axes.len(), AxisWorker::default);
        for (a, (axis, worker)) in self.axes.iter().zip(&mut worker.axes).enumerate() {
            let (line, scratch) = match &axis.fft {
                AxisFft::Real(fft) => (fft.complex_len(), fft.get_scratch_len()),
                AxisFft::Complex(fft) => (fft.len().next_multiple_of(BLOCK), fft.get_inplace_scratch_len()),
            };
            worker.line.resize(line, Complex::default());
            worker.slabs.resize(if a == 0 { 0 } else { self.modes(a) * BLOCK }, Complex::default());
            worker.columns.resize(if a < last { self.columns(a) } else { 0 }, Complex::default());
            worker.scratch.resize(scratch, Complex::default());
        }
    }

    /// The amplitudes of the grid `cells`, which it overwrites, as `finish` makes them, in the order of `WaveGrid`. `columns`
    /// are for the last axis.
    pub(super) fn run<T: Send>(
        &self,
        (cells, columns, workers): (&mut [f64], &mut [Complex<f64>], &mut [Worker]),
        pool: Option<&Pool>,
        control: &Control,
        finish: impl Fn(Complex<f64>) -> T + Sync,
        out: &mut [T],
    ) -> Result<()> {
        let last = self.axes.len() - 1;
        if last == 0 {
            return self.row(cells, &mut workers[0].axes[0], |m, s| out[m] = finish(s));
        }
        self.grid.fold(last, cells);
        let blocks = self.blocks(last, cells, columns);
        share(pool, workers, blocks, |worker, (slabs, columns)| {
            control.check()?;
            self.block(last, slabs, columns, &mut worker.axes)
        })?;
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

    /// The slabs of axis `a`, a block at a time, and where their frequencies go.
    fn blocks<'a>(
        &self,
        a: usize,
        cells: &'a mut [f64],
        columns: &'a mut [Complex<f64>],
    ) -> impl Iterator<Item = (&'a mut [f64], &'a mut [Complex<f64>])> + Send + use<'a> {
        let (axis, step) = (&self.grid.axes[a], self.grid.step(a));
        let cells = &mut cells[axis.pad() * step..][..axis.cells * step];
        cells.chunks_mut(BLOCK * step).zip(columns.chunks_mut(BLOCK * self.modes(a)))
    }

    /// Transforms slabs of axis `a` and transposes them: columns of `BLOCK` numbers per frequency.
    fn block(
        &self,
        a: usize,
        slabs: &mut [f64],
        columns: &mut [Complex<f64>],
        workers: &mut [AxisWorker],
    ) -> Result<()> {
        let modes = self.modes(a);
        let (before, own) = workers.split_at_mut(a);
        let own = &mut own[0];
        for (slab, out) in slabs.chunks_mut(self.grid.step(a)).zip(own.slabs.chunks_exact_mut(modes)) {
            self.slab(a - 1, slab, before, out)?;
        }
        for (mode, column) in columns.chunks_exact_mut(BLOCK).enumerate() {
            for (s, number) in column.iter_mut().enumerate() {
                *number = own.slabs[s * modes + mode];
            }
        }
        Ok(())
    }

    /// All frequencies of one slab whose last axis is `a`.
    fn slab(&self, a: usize, cells: &mut [f64], workers: &mut [AxisWorker], out: &mut [Complex<f64>]) -> Result<()> {
        if a == 0 {
            return self.row(cells, &mut workers[0], |m, s| out[m] = s);
        }
        self.grid.fold(a, cells);
        let mut columns = std::mem::take(&mut workers[a].columns);
        for (slabs, columns) in self.blocks(a, cells, &mut columns) {
            self.block(a, slabs, columns, workers)?;
        }
        for (mode, out) in out.chunks_exact_mut(self.kept(a)).enumerate() {
            self.line(a, mode, &columns, &mut workers[a], |m, s| out[m] = s);
        }
        workers[a].columns = columns;
        Ok(())
    }

    /// The frequencies `0 ..= largest` of one row of the first axis.
    fn row(
        &self,
        cells: &mut [f64],
        worker: &mut AxisWorker,
        mut write: impl FnMut(usize, Complex<f64>),
    ) -> Result<()> {
        self.grid.fold(0, cells);
        let (axis, own) = (&self.grid.axes[0], &self.axes[0]);
        let AxisFft::Real(fft) = &own.fft else { return Ok(()) };
        let row = &mut cells[axis.pad()..][..axis.cells];
        fft.process_with_scratch(row, &mut worker.line, &mut worker.scratch)
            .map_err(|e| Error::setting(Setting::MaxFrequency, own.largest, e.to_string()))?;
        for (m, (s, factor)) in worker.line.iter().zip(&own.factors).enumerate() {
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
        let own = &self.axes[a];
        let AxisFft::Complex(fft) = &own.fft else { return };
        let blocks = columns.chunks_exact(BLOCK * self.modes(a));
        for (to, block) in worker.line.chunks_exact_mut(BLOCK).zip(blocks) {
            to.copy_from_slice(&block[BLOCK * mode..][..BLOCK]);
        }
        let cells = self.grid.axes[a].cells;
        let line = &mut worker.line[..cells];
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

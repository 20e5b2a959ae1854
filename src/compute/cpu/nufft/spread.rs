//! Spreading: every point adds its kernel to the cells around it.
//!
//! - The grid is padded: cell `c` of an axis is stored at `c + (w - 1) / 2`, so that the first cell a point reaches is stored at
//!   the point's own (rounded) position, and nothing wraps until `fold`.
//! - Nonuniform are sorted by tiles of cells, so that those in a row meet the same part of the cache.
//! - Tiles are cut from bands of the last axis. A kernel reaches from its band into the next one at most, so that a few bands
//!   can be done by themselves: the fine grid is never there as a whole.

use std::ops::Range;

use super::kernel::SpreadingKernel;
use super::threads::share;
use crate::compute::cpu::simd::{self, SimdLevel};
use crate::control::Control;
use crate::error::Result;
use crate::plan::kernel_lanes as lanes;
use crate::pool::Pool;

/// Nonuniform that are sorted at a time: in the second-level cache.
const CHUNK: usize = 1 << 15;

/// Cells of a tile in 1D, 2D and 3D, last axis last, as powers of two; no band is thinner than the widest kernel.
const TILE_SHIFTS: [[u32; 3]; 3] = [[10, 0, 0], [6, 6, 0], [4, 4, 4]];

/// Nonuniform of a tile whose kernels are added up before they are added to those of others: a sum of so many terms, and of so
/// many sums, rounds much less than one of all.
const MOST_AT_ONCE: usize = 2048;

/// With more tiles than this, pairs are joined: their bookkeeping would take longer than what they save.
const MAX_TILES: usize = 1 << 14;

/// One axis of the fine grid.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Which axis of the points it is.
    axis: usize,
    /// Cells.
    pub(super) cells: usize,
    /// Cells as stored: what kernels reach, and what vectors write beyond.
    pub(super) stored: usize,
    pub(super) kernel: SpreadingKernel,
    tile_shift: u32,
}

impl Axis {
    /// Where cell 0 is stored.
    pub(super) fn pad(&self) -> usize {
        (self.kernel.width() - 1) / 2
    }

    /// The (rounded) position in cells, at most `cells`, and how far the point is beyond it, as -1 to 1. No bit is lost.
    #[inline(always)]
    fn locate(&self, x: u64) -> (usize, f64) {
        let half = u128::from(self.kernel.width() % 2 == 1) << 63;
        let position = u128::from(x) * self.cells as u128 + half;
        let beyond = (position as u64 ^ (1 << 63)) as i64;
        ((position >> 64) as usize, beyond as f64 * 2f64.powi(-63))
    }

    fn tile(&self, x: u64) -> usize {
        self.locate(x).0 >> self.tile_shift
    }

    fn tiles(&self) -> usize {
        (self.cells >> self.tile_shift) + 1
    }
}

/// The fine grid, the first axis contiguous, and its tiles.
#[derive(Debug, Clone)]
pub(super) struct FineGrid {
    pub(super) axes: Vec<Axis>,
    level: SimdLevel,
}

impl FineGrid {
    /// Per axis: which axis of the points, cells and kernel. All kernels are equally wide.
    pub(super) fn new(axes: Vec<(usize, usize, SpreadingKernel)>, level: SimdLevel) -> Self {
        let shifts = TILE_SHIFTS[axes.len() - 1];
        let axis = |(a, (axis, cells, kernel)): (usize, (usize, usize, SpreadingKernel))| {
            let stored =
                if a == 0 { (cells + lanes(kernel.width())).next_multiple_of(8) } else { cells + kernel.width() };
            Axis { axis, cells, stored, kernel, tile_shift: shifts[a] }
        };
        let mut grid = Self { axes: axes.into_iter().enumerate().map(axis).collect(), level };
        while grid.tiles() > MAX_TILES {
            if let Some(axis) = grid.axes.iter_mut().max_by_key(|axis| axis.tiles()) {
                axis.tile_shift += 1;
            }
        }
        grid
    }

    /// Cells as stored of one step along axis `a`.
    pub(super) fn step(&self, a: usize) -> usize {
        self.axes[..a].iter().map(|axis| axis.stored).product()
    }

    fn tiles(&self) -> usize {
        self.axes.iter().map(Axis::tiles).product()
    }

    /// Bytes of `Sorted` for `n` points.
    pub(super) fn sorted_bytes(&self, n: usize, weighted: bool) -> u64 {
        let per_point = 8 * (self.axes.len() + usize::from(weighted)) + 4;
        (n * per_point + n.div_ceil(CHUNK) * 4 * (self.tiles() + 1)) as u64
    }

    /// Sorts points by tiles.
    pub(super) fn sort(
        &self,
        points: &Nonuniform<'_>,
        sorted: &mut Sorted,
        pool: Option<&Pool>,
        control: &Control,
    ) -> Result<()> {
        let n = points.axes[0].len();
        sorted.weighted = points.weights.is_some();
        sorted.chunks.resize_with(n.div_ceil(CHUNK), Chunk::default);
        let mut workers = vec![(); pool.map_or(1, Pool::threads)];
        share(pool, &mut workers, sorted.chunks.iter_mut().enumerate(), |_, (c, chunk)| {
            control.check()?;
            chunk.sort(self, points, c * CHUNK..n.min((c + 1) * CHUNK));
            Ok(())
        })
    }

    /// Bands of the last axis.
    pub(super) fn bands(&self) -> usize {
        self.axes.last().map_or(0, Axis::tiles)
    }

    /// Steps of the last axis in a band.
    pub(super) fn band(&self) -> usize {
        self.axes.last().map_or(1, |axis| 1 << axis.tile_shift)
    }

    /// The steps of the last axis, as stored, that begin in these bands; after the last band there are no others.
    pub(super) fn steps(&self, bands: &Range<usize>) -> Range<usize> {
        let stored = self.axes.last().map_or(0, |axis| axis.stored);
        let end = if bands.end == self.bands() { stored } else { bands.end * self.band() };
        bands.start * self.band()..end.min(stored)
    }

    /// `sum_j w_j phi(x - x_j)` at every cell of `steps(&bands)`. `cells` are room to work in: a kernel reaches from its band
    /// into the next one, so that the one before is done too, and what reaches beyond is dropped. Every cell gets its terms
    /// in the same order, those of even bands first, on any number of threads and however the grid is cut.
    pub(super) fn spread<'a>(
        &self,
        bands: Range<usize>,
        sorted: &Sorted,
        cells: &'a mut Vec<f64>,
        pool: Option<&Pool>,
        control: &Control,
    ) -> Result<&'a mut [f64]> {
        let (band, step) = (self.band(), self.step(self.axes.len() - 1));
        let tiles = self.axes[..self.axes.len() - 1].iter().map(Axis::tiles).product::<usize>();
        let before = bands.start.saturating_sub(1);
        let first = before * band;
        let end = self.steps(&(before..(bands.end + 1).min(self.bands()))).end;
        cells.clear();
        cells.resize((end - first) * step, 0.0);
        let mut workers = vec![(); pool.map_or(1, Pool::threads)];
        for parity in 0..2 {
            let from = before + (before + parity) % 2;
            let at = ((from - before) * band * step).min(cells.len());
            let tasks = cells[at..].chunks_mut(2 * band * step).zip((from..bands.end).step_by(2));
            share(pool, &mut workers, tasks, |_, (cells, index)| {
                control.check()?;
                let tiles = index * tiles..(index + 1) * tiles;
                let band = Band { grid: self, chunks: &sorted.chunks, tiles, first: index * band, cells };
                simd::spread(self.level, band, sorted.weighted);
                Ok(())
            })?;
        }
        let steps = self.steps(&bands);
        Ok(&mut cells[(steps.start - first) * step..(steps.end - first) * step])
    }

    /// The pads of axis `a`: the step of each, as stored, and that of the cell it stands for.
    pub(super) fn pads(&self, a: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let axis = &self.axes[a];
        let (first, cells, stored) = (axis.pad(), axis.cells, axis.stored);
        (0..first).chain(first + cells..stored).map(move |at| (at, first + (at + cells * stored - first) % cells))
    }

    /// Adds the pads of axis `a` to the cells they stand for. `cells` are all steps along the axis.
    pub(super) fn fold(&self, a: usize, cells: &mut [f64]) {
        let step = self.step(a);
        for (at, to) in self.pads(a) {
            let (low, high) = cells.split_at_mut(at.max(to) * step);
            let (low, high) = (&mut low[at.min(to) * step..][..step], &mut high[..step]);
            let (to, from) = if to < at { (low, high) } else { (high, low) };
            add_all(to, from);
        }
    }
}

/// `to += from`
pub(super) fn add_all(to: &mut [f64], from: &[f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += *from;
    }
}

/// Nonuniform of one realization: fractions of the side per axis, and weights where they are not all 1.
#[derive(Debug, Clone, Copy)]
pub struct Nonuniform<'a> {
    /// Fractions of the side in steps of 2^-64.
    pub axes: &'a [&'a [u64]],
    /// One per point; `None` where every point weighs 1.
    pub weights: Option<&'a [f64]>,
}

/// Nonuniform in the order of their tiles, chunk by chunk.
#[derive(Debug, Default)]
pub(super) struct Sorted {
    chunks: Vec<Chunk>,
    weighted: bool,
}

#[derive(Debug, Default)]
struct Chunk {
    /// The tile of each point, in the order of the input.
    tiles: Vec<u32>,
    /// `starts[t] .. starts[t + 1]` are the points of tile `t`.
    starts: Vec<u32>,
    /// Per point its fractions and, where there are weights, the bits of its weight.
    records: Vec<u64>,
}

impl Chunk {
    fn sort(&mut self, grid: &FineGrid, points: &Nonuniform<'_>, range: Range<usize>) {
        let axes: Vec<&[u64]> = grid.axes.iter().map(|axis| &points.axes[axis.axis][range.clone()]).collect();
        let weights = points.weights.map(|w| &w[range]);
        match (axes.as_slice(), weights) {
            (&[x], None) => self.sort_in(grid, [x], |_, [x]| [x]),
            (&[x], Some(w)) => self.sort_in(grid, [x], |j, [x]| [x, w[j].to_bits()]),
            (&[x, y], None) => self.sort_in(grid, [x, y], |_, x| x),
            (&[x, y], Some(w)) => self.sort_in(grid, [x, y], |j, [x, y]| [x, y, w[j].to_bits()]),
            (&[x, y, z], None) => self.sort_in(grid, [x, y, z], |_, x| x),
            (&[x, y, z], Some(w)) => self.sort_in(grid, [x, y, z], |j, [x, y, z]| [x, y, z, w[j].to_bits()]),
            _ => {}
        }
    }

    /// A counting sort, which keeps the order within a tile.
    #[inline(always)]
    fn sort_in<const D: usize, const R: usize>(
        &mut self,
        grid: &FineGrid,
        points: [&[u64]; D],
        record: impl Fn(usize, [u64; D]) -> [u64; R],
    ) {
        let n = points[0].len();
        let axes: [&Axis; D] = std::array::from_fn(|a| &grid.axes[a]);
        // The start of a tile is kept one place on while tiles are counted, and two while they are filled.
        self.starts.clear();
        self.starts.resize(grid.tiles() + 2, 0);
        self.tiles.clear();
        self.tiles.extend((0..n).map(|j| {
            let tile = (0..D).rev().fold(0, |tile, a| tile * axes[a].tiles() + axes[a].tile(points[a][j]));
            self.starts[tile + 2] += 1;
            tile as u32
        }));
        let mut total = 0;
        for start in &mut self.starts {
            total += *start;
            *start = total;
        }
        self.records.resize(n * R, 0);
        let records = self.records.as_chunks_mut::<R>().0;
        for (j, &tile) in self.tiles.iter().enumerate() {
            let next = &mut self.starts[tile as usize + 1];
            records[*next as usize] = record(j, std::array::from_fn(|a| points[a][j]));
            *next += 1;
        }
    }
}

/// The work of one thread: the tiles of a band, and the cells that their points reach.
pub(in super::super) struct Band<'a> {
    grid: &'a FineGrid,
    chunks: &'a [Chunk],
    tiles: Range<usize>,
    /// Where the band begins along the last axis.
    first: usize,
    cells: &'a mut [f64],
}

impl Band<'_> {
    /// To be inlined into a function for an instruction set.
    #[inline(always)]
    pub(in super::super) fn spread<const FMA: bool>(self, weighted: bool) {
        let lanes = lanes(self.grid.axes[0].kernel.width());
        match (self.grid.axes.len(), lanes, weighted) {
            (1, 8, false) => self.points::<FMA, 1, 1, 8>(),
            (1, 8, true) => self.points::<FMA, 1, 2, 8>(),
            (1, _, false) => self.points::<FMA, 1, 1, 16>(),
            (1, _, true) => self.points::<FMA, 1, 2, 16>(),
            (2, 8, false) => self.points::<FMA, 2, 2, 8>(),
            (2, 8, true) => self.points::<FMA, 2, 3, 8>(),
            (2, _, false) => self.points::<FMA, 2, 2, 16>(),
            (2, _, true) => self.points::<FMA, 2, 3, 16>(),
            (_, 8, false) => self.points::<FMA, 3, 3, 8>(),
            (_, 8, true) => self.points::<FMA, 3, 4, 8>(),
            (_, _, false) => self.points::<FMA, 3, 3, 16>(),
            (_, _, true) => self.points::<FMA, 3, 4, 16>(),
        }
    }

    #[inline(always)]
    fn points<const FMA: bool, const D: usize, const R: usize, const L: usize>(self) {
        let axes: [&Axis; D] = std::array::from_fn(|a| &self.grid.axes[a]);
        let band = Place {
            origin: std::array::from_fn(|a| if a + 1 < D { 0 } else { self.first }),
            steps: std::array::from_fn(|a| self.grid.step(a)),
        };
        let mut apart = Vec::new();
        for tile in self.tiles {
            let run = |chunk: &Chunk| chunk.starts[tile] as usize..chunk.starts[tile + 1] as usize;
            let count = self.chunks.iter().map(|chunk| run(chunk).len()).sum::<usize>();
            if count <= MOST_AT_ONCE {
                for chunk in self.chunks {
                    for record in &chunk.records.as_chunks::<R>().0[run(chunk)] {
                        add_point::<FMA, D, R, L>(&axes, record, &band, self.cells);
                    }
                }
                continue;
            }
            let (own, sides) = Place::of_tile(&axes, tile);
            for chunk in self.chunks {
                for records in chunk.records.as_chunks::<R>().0[run(chunk)].chunks(MOST_AT_ONCE) {
                    apart.clear();
                    apart.resize(sides.iter().product(), 0.0);
                    for record in records {
                        add_point::<FMA, D, R, L>(&axes, record, &own, &mut apart);
                    }
                    // No further than the grid, which the last tiles overlap.
                    let within: [usize; D] = std::array::from_fn(|a| sides[a].min(axes[a].stored - own.origin[a]));
                    let rows = apart.chunks_exact(sides[0]).enumerate();
                    for (row, values) in rows {
                        let (mut rest, mut inside, mut to) = (row, true, own.origin[0]);
                        for a in 1..D {
                            inside &= rest % sides[a] < within[a];
                            to += (rest % sides[a] + own.origin[a] - band.origin[a]) * band.steps[a];
                            rest /= sides[a];
                        }
                        if D == 1 {
                            to -= band.origin[0];
                        }
                        if inside {
                            let to = &mut self.cells[to..to + within[0]];
                            to.iter_mut().zip(values).for_each(|(to, value)| *to += value);
                        }
                    }
                }
            }
        }
    }
}

/// Where cells are kept: the first one along every axis, and the distance of neighbours.
struct Place<const D: usize> {
    origin: [usize; D],
    steps: [usize; D],
}

impl<const D: usize> Place<D> {
    /// All cells that the points of a tile reach, by themselves, and how many there are along every axis.
    fn of_tile(axes: &[&Axis; D], tile: usize) -> (Self, [usize; D]) {
        let mut rest = tile;
        let origin = std::array::from_fn(|a| {
            let index = rest % axes[a].tiles();
            rest /= axes[a].tiles();
            index << axes[a].tile_shift
        });
        let sides = axes.map(|axis| (1 << axis.tile_shift) + lanes(axis.kernel.width()));
        let steps = std::array::from_fn(|a| sides[..a].iter().product());
        (Self { origin, steps }, sides)
    }
}

/// Adds the kernel at a point.
#[inline(always)]
fn add_point<const FMA: bool, const D: usize, const R: usize, const L: usize>(
    axes: &[&Axis; D],
    record: &[u64; R],
    place: &Place<D>,
    cells: &mut [f64],
) {
    let (width, steps) = (axes[0].kernel.width(), &place.steps);
    let mut start = 0;
    // A loop: what is called through a closure may lose the instruction set.
    let mut values = [[0.0; L]; D];
    for a in 0..D {
        let (at, u) = axes[a].locate(record[a]);
        start += (at - place.origin[a]) * steps[a];
        horner::<FMA, L>(&axes[a].kernel, u, &mut values[a]);
    }
    if R > D {
        let weight = f64::from_bits(record[D]);
        values[D - 1].iter_mut().for_each(|v| *v *= weight);
    }
    let cells = &mut cells[start..];
    match D {
        1 => add::<FMA, L>(cells, 1.0, &values[0]),
        2 => {
            for (row, &y) in values[1][..width].iter().enumerate() {
                add::<FMA, L>(&mut cells[row * steps[1]..], y, &values[0]);
            }
        }
        _ => {
            for (plane, &z) in values[2][..width].iter().enumerate() {
                for (row, &y) in values[1][..width].iter().enumerate() {
                    add::<FMA, L>(&mut cells[plane * steps[2] + row * steps[1]..], y * z, &values[0]);
                }
            }
        }
    }
}

#[inline(always)]
fn fused<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

/// All pieces of the kernel at `u`, by Horner's rule.
#[inline(always)]
fn horner<const FMA: bool, const L: usize>(kernel: &SpreadingKernel, u: f64, values: &mut [f64; L]) {
    let mut sums = [0.0; L];
    for power in kernel.pieces() {
        for (sum, c) in sums.iter_mut().zip(power) {
            *sum = fused::<FMA>(*sum, u, *c);
        }
    }
    *values = sums;
}

/// `cells += factor * values`
#[inline(always)]
fn add<const FMA: bool, const L: usize>(cells: &mut [f64], factor: f64, values: &[f64; L]) {
    if let Some(cells) = cells.first_chunk_mut::<L>() {
        // In a copy, which the compiler keeps in whole vectors.
        let mut sums = *cells;
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum = fused::<FMA>(factor, *value, *sum);
        }
        *cells = sums;
    }
}

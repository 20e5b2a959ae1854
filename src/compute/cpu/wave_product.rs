//! Grids of wave vectors: `s` as matrix products. Formula: see `reference`.
//!
//! With `m = a + b`, `exp(-2 pi i m . x)` factors into phases of `a` and of `b`, so the sums over points of
//! `cos cos`, `sin sin`, `cos sin` and `sin cos` over rows `a` and columns `b` give `s` at `a + b` and, by a sign, at
//! `a - b`: trigonometry costs `n (rows + columns)`, and the rest is one real product of `2 rows x n x 2 columns`.
//!
//! - In 2D and 3D the rows are `(m_0, 0, 0)` and the columns `(0, m_1, m_2)`, one of each pair of opposite signs.
//! - In 1D the rows are `1 ..= h` and the columns the multiples of `2 h + 1`, with `h` near `sqrt(F / 2)`.
//!
//! Row 0 and column 0, where the cosine is 1, are plain sums over the other table, so products fill whole vectors at
//! F = 64, 128, 256. Weights multiply the table of the rows.
//!
//! Points go in panels, far apart in the input: a panel's product is taken in f32 or f64, and added to f64 sums, in f32 a
//! few at once. So each sum is made by the same additions in the same order, however the grid is cut into tiles for threads.

use super::Cpu;
use super::phase_tables::{GROUP, Panel, Table, place};
use super::product::{Element, FEWEST_POINTS, Operand, product};
use super::simd::{self, SimdLevel};
use super::wave_power::{Method, WavePoints};
use crate::compute::coprime_from;
use crate::control::{Control, Done};
use crate::error::Result;
use crate::plan::{PANEL, WaveGrid};

/// Panels that are added up in f32: that has one rounding per panel more, which is little beside those of its points, and
/// reads and writes the f64 sums as many times less.
const PANELS_PER_SUM: usize = 4;

/// Lines of a block: `gemm` does not copy the table of columns for so few. Whole groups of a table.
const LINES: usize = 48;

/// Lines from which a tile is one block: then that copy pays.
const MANY_LINES: usize = 256;

/// Panels between two looks at the control.
const PANELS_PER_CHECK: usize = 64;

/// Longest side of a tile, in bytes of one table's cosines at one point: two tables of a panel fit the second-level
/// cache. In f32 a little above 256 frequencies, so that grids of that size stay whole.
const LARGEST_TILE: usize = 264 * size_of::<f32>();

/// Tiles are not cut smaller than this for the sake of threads: below, trigonometry dominates.
const SMALLEST_TILE: usize = 32;

/// A grid as products in f32 or f64, cut into tiles.
pub(super) struct Product<'a, T> {
    factors: Factors<'a>,
    tiles: Vec<Tile>,
    panel: usize,
    level: SimdLevel,
    real: std::marker::PhantomData<T>,
}

impl<'a, T: Real> Product<'a, T> {
    /// The grid in at least `parts` tiles, where that is sensible. Of the modes only those of `rings` (0 for none), if
    /// given, and DC.
    pub(super) fn new(cpu: &Cpu, grid: &WaveGrid, rings: Option<&'a [u32]>, panel: usize, parts: usize) -> Self {
        let factors = Factors::new(grid, rings);
        let tiles = factors.tiles::<T>(parts);
        Self {
            factors,
            tiles,
            panel: panel.clamp(FEWEST_POINTS, PANEL),
            level: cpu.level(),
            real: std::marker::PhantomData,
        }
    }
}

impl<T: Real> Method for Product<'_, T> {
    type Scratch = Scratch<T>;

    fn parts(&self) -> usize {
        self.tiles.len()
    }

    fn sum(
        &self,
        part: usize,
        points: &WavePoints<'_>,
        scratch: &mut Scratch<T>,
        control: &Control,
        put: impl FnMut(usize, [f64; 2]),
    ) -> Result<()> {
        let tile = &self.tiles[part];
        scratch.sum(self.level, tile, points, self.panel, control)?;
        scratch.write(&self.factors, tile, points, put);
        Ok(())
    }
}

/// How the modes of a grid are made from rows and columns; row 0 and column 0 stand in no table.
struct Factors<'a> {
    rows: Vec<[i32; 3]>,
    row_axes: Vec<usize>,
    columns: Vec<[i32; 3]>,
    column_axes: Vec<usize>,
    dc: i64,
    /// Where row 0 plus column `c` is stored, and row 0 minus column `c`.
    plus: Vec<i64>,
    minus: Vec<i64>,
    /// How far that moves from one row to the next.
    plus_step: i64,
    minus_step: i64,
    modes: i64,
    rings: Option<&'a [u32]>,
}

impl<'a> Factors<'a> {
    fn new(grid: &WaveGrid, rings: Option<&'a [u32]>) -> Self {
        let f = grid.max_frequency().map(|f| f as i32);
        let at = |m: [i32; 3]| grid.half_index(m) as i64;
        let (dc, modes) = (grid.dc() as i64, grid.half_len() as i64);
        if grid.dim() == 1 {
            let half = f64::from(f[0] / 2).sqrt().round() as i32;
            let step = 2 * half + 1;
            let columns: Vec<[i32; 3]> = (1..=(f[0] + half) / step).map(|p| [p * step, 0, 0]).collect();
            // Row q and column p: the modes p step + q, and p step - q.
            let at: Vec<i64> = columns.iter().map(|c| i64::from(c[0])).collect();
            return Self {
                rows: (1..=half.min(f[0])).map(|q| [q, 0, 0]).collect(),
                row_axes: vec![0],
                columns,
                column_axes: vec![0],
                dc,
                plus: at.clone(),
                minus: at,
                plus_step: 1,
                minus_step: -1,
                modes,
                rings,
            };
        }
        let mut columns: Vec<[i32; 3]> = grid.columns().into_iter().skip(1).map(|[m1, m2]| [0, m1, m2]).collect();
        if let Some(rings) = rings {
            // By frequency, so that what a row needs of them comes first.
            columns.sort_by_key(|&m| rings[at(m) as usize].wrapping_sub(1));
        }
        let [_, n1, n2] = grid.half_shape();
        Self {
            rows: (1..=f[0]).map(|m0| [m0, 0, 0]).collect(),
            row_axes: vec![0],
            column_axes: (1..grid.dim()).collect(),
            dc,
            plus: columns.iter().map(|&m| at(m)).collect(),
            minus: columns.iter().map(|&m| at(m.map(|x| -x))).collect(),
            columns,
            plus_step: (n1 * n2) as i64,
            minus_step: (n1 * n2) as i64,
            modes,
            rings,
        }
    }

    /// The index of a mode that is stored and wanted.
    fn wanted(&self, at: i64) -> Option<usize> {
        let inside = (0..self.modes).contains(&at).then_some(at as usize)?;
        self.rings.is_none_or(|rings| rings[inside] > 0).then_some(inside)
    }

    /// Where row `row` plus and minus column `column` are, counted from row 0.
    fn at(&self, row: usize, column: usize) -> [Option<usize>; 2] {
        let row = row as i64;
        [self.plus[column] + row * self.plus_step, self.minus[column] + row * self.minus_step].map(|at| self.wanted(at))
    }

    /// Cuts rows and columns into at least `wanted` tiles where that is sensible, none too large for the caches.
    fn tiles<T: Real>(&self, wanted: usize) -> Vec<Tile> {
        let (rows, columns) = (self.rows.len(), self.columns.len());
        let largest = LARGEST_TILE / size_of::<T>();
        let (mut row_parts, mut column_parts) = (rows.div_ceil(largest).max(1), columns.div_ceil(largest).max(1));
        while row_parts * column_parts < wanted {
            let (height, width) = (rows / row_parts, columns / column_parts);
            if height.max(width) < 2 * SMALLEST_TILE {
                break;
            }
            *(if width >= height { &mut column_parts } else { &mut row_parts }) += 1;
        }
        let cut = |len: usize, parts: usize| {
            let by = len.div_ceil(parts).next_multiple_of(GROUP).max(GROUP);
            // One part at least, empty if there is nothing.
            (0..len.max(1)).step_by(by).map(move |start| start..(start + by).min(len))
        };
        cut(columns, column_parts)
            .flat_map(|c| cut(rows, row_parts).map(move |r| (r, c.clone())))
            .map(|(r, c)| Tile {
                blocks: self.blocks(r.clone(), c.clone()),
                left: Table::new(&self.row_axes, &self.rows[r.clone()]),
                right: Table::new(&self.column_axes, &self.columns[c.clone()]),
                first_row: r.start,
                first_column: c.start,
            })
            .filter(|tile| !tile.blocks.is_empty() || tile.first_row == 0 || tile.first_column == 0)
            .collect()
    }

    /// The blocks of a tile: as many columns for each as its rows need.
    fn blocks(&self, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut offset = 0;
        // Rings need fewer columns of the later rows: there, blocks stay small.
        let many = self.rings.is_none() && 2 * rows.len() >= MANY_LINES;
        let height = if many { rows.len() } else { LINES / 2 };
        for first in rows.clone().step_by(height) {
            let block = first..(first + height).min(rows.end);
            let needed = |c: usize| block.clone().any(|r| self.at(r + 1, c).iter().any(Option::is_some));
            let Some(last) = columns.clone().rev().find(|&c| needed(c)) else { continue };
            let lines = 2 * block.len().next_multiple_of(GROUP);
            let width = 2 * (last + 1 - columns.start).next_multiple_of(GROUP);
            blocks.push(Block { first: block.start - rows.start, rows: block.len(), lines, width, offset });
            offset += lines * width;
        }
        blocks
    }
}

/// A rectangle of rows and columns.
struct Tile {
    left: Table,
    right: Table,
    first_row: usize,
    first_column: usize,
    blocks: Vec<Block>,
}

/// Some rows of a tile, with the first of its columns.
struct Block {
    first: usize,
    rows: usize,
    /// Lines of the product: cosines and sines of the rows, in whole groups.
    lines: usize,
    /// Columns of the product.
    width: usize,
    /// Where its sums begin.
    offset: usize,
}

/// The tables of a panel, and sums of a tile; reused from tile to tile.
pub(super) struct Scratch<T> {
    left: Vec<T>,
    right: Vec<T>,
    /// Of row 0 or column 0, over a panel.
    line: Vec<T>,
    /// Of the product, over a few panels, block by block.
    panels: Vec<T>,
    /// Of the product, over all.
    sums: Vec<f64>,
    /// Of row 0 over the columns, and of column 0 over the rows.
    row: Vec<f64>,
    column: Vec<f64>,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        let [left, right, line, panels] = [(); 4].map(|()| Vec::new());
        Self { left, right, line, panels, sums: Vec::new(), row: Vec::new(), column: Vec::new() }
    }
}

impl<T: Real> Scratch<T> {
    /// The sums of every row and column of the tile, over all points.
    fn sum(
        &mut self,
        level: SimdLevel,
        tile: &Tile,
        points: &WavePoints<'_>,
        panel: usize,
        control: &Control,
    ) -> Result<()> {
        let (rows, columns) = (tile.left.width(), tile.right.width());
        let (left_stride, right_stride) = (stride::<T>(rows), stride::<T>(columns));
        let left = aligned(&mut self.left, panel * left_stride);
        let right = aligned(&mut self.right, panel * right_stride);
        zeroed(&mut self.sums, tile.blocks.last().map_or(0, |b| b.offset + b.lines * b.width));
        zeroed(&mut self.row, columns);
        zeroed(&mut self.column, rows);
        let n = points.len();
        // No divisor in common with `n`: else the panels of a lattice can be one lattice shifted, and their rounding
        // errors, alike, add up.
        let panels = coprime_from(n.div_ceil(panel), n);
        let mut weights = [T::ONE; PANEL];
        for start in 0..panels {
            if start % PANELS_PER_CHECK == 0 {
                control.check()?;
            }
            // Points far apart in the input: many sets come in an order along which phases vary slowly, and neighbours
            // would add up to large partial sums, with large rounding errors, before they cancel.
            let mut gathered = [[0u64; PANEL]; 3];
            let mut count = 0;
            for (to, axis) in gathered.iter_mut().zip(&points.axes) {
                count = 0;
                for (to, &x) in to.iter_mut().zip(axis[start..].iter().step_by(panels)) {
                    *to = x;
                    count += 1;
                }
            }
            if let Some(all) = points.weights {
                for (to, &w) in weights.iter_mut().zip(all[start..].iter().step_by(panels)) {
                    *to = T::rounded(w);
                }
            }
            let weights = &weights[..count];
            let cut = gathered.each_ref().map(|axis| &axis[..count]);
            let panel = Panel { axes: &cut };
            T::fill(level, &tile.left, &panel, left, left_stride);
            T::fill(level, &tile.right, &panel, right, right_stride);
            if tile.first_row == 0 {
                T::add_sums(level, right, right_stride, weights, &mut self.line, &mut self.row);
            }
            if tile.first_column == 0 {
                T::add_sums(level, left, left_stride, weights, &mut self.line, &mut self.column);
            }
            if points.weights.is_some() {
                for (line, &weight) in left.chunks_exact_mut(left_stride).zip(weights) {
                    line[..rows].iter_mut().for_each(|value| *value = *value * weight);
                }
            }
            if count < FEWEST_POINTS {
                left[count * left_stride..FEWEST_POINTS * left_stride].fill(T::default());
            }
            let count = count.max(FEWEST_POINTS);
            let sums = T::sums_of_panels(&mut self.panels, &mut self.sums);
            for block in &tile.blocks {
                let left = Operand { values: &left[2 * block.first..], stride: left_stride, width: block.lines };
                let right = Operand { values: right, stride: right_stride, width: block.width };
                let sums = &mut sums[block.offset..][..block.lines * block.width];
                product(left, right, count, sums, start % T::PANELS > 0);
            }
            if (start + 1) % T::PANELS == 0 || start + 1 == panels {
                T::join_panels(level, &mut self.sums, &self.panels);
            }
        }
        // Lines and columns are cosines and sines: four products make two modes.
        let modes: usize = tile.blocks.iter().map(|block| block.lines * block.width / 2).sum();
        let products = (n * (modes + (rows + columns) / 2)) as u64;
        // Tables are written and read.
        let bytes = (n * (2 * (left_stride + right_stride) * size_of::<T>() + 8 * points.axes.len())) as u64;
        control.did(Done { products, bytes, ..Done::default() });
        Ok(())
    }

    /// `s` of the modes of the tile.
    fn write(&self, factors: &Factors<'_>, tile: &Tile, points: &WavePoints<'_>, mut put: impl FnMut(usize, [f64; 2])) {
        let at_origin = tile.first_row == 0 && tile.first_column == 0;
        if at_origin {
            put(factors.dc as usize, [points.total_weight(), 0.0]);
        }
        // In one dimension, row minus column is the mirror image of what is stored.
        let mirror = if factors.minus_step < 0 { -1.0 } else { 1.0 };
        if tile.first_row == 0 {
            for c in 0..tile.right.len() {
                let (cos, sin) = (self.row[place(c)], self.row[place(c) + GROUP]);
                let [plus, minus] = factors.at(0, tile.first_column + c);
                if let Some(plus) = plus {
                    put(plus, [cos, -sin]);
                }
                if let Some(minus) = minus.filter(|_| plus != minus) {
                    put(minus, [cos, sin]);
                }
            }
        }
        if tile.first_column == 0 {
            for r in 0..tile.left.len() {
                let at = factors.dc + (tile.first_row + r + 1) as i64 * factors.plus_step;
                if let Some(at) = factors.wanted(at) {
                    put(at, [self.column[place(r)], -self.column[place(r) + GROUP]]);
                }
            }
        }
        for block in &tile.blocks {
            for r in 0..block.rows {
                let line = |k: usize| &self.sums[block.offset + k * block.width..][..block.width];
                let (cos, sin) = (line(place(r)), line(place(r) + GROUP));
                for c in 0..(block.width / 2).min(tile.right.len()) {
                    let (to_cos, to_sin) = (place(c), place(c) + GROUP);
                    let (cc, cs, sc, ss) = (cos[to_cos], cos[to_sin], sin[to_cos], sin[to_sin]);
                    let [plus, minus] = factors.at(tile.first_row + block.first + r + 1, tile.first_column + c);
                    if let Some(plus) = plus {
                        put(plus, [cc - ss, -(sc + cs)]);
                    }
                    if let Some(minus) = minus {
                        put(minus, [cc + ss, mirror * (cs - sc)]);
                    }
                }
            }
        }
    }
}

fn zeroed(values: &mut Vec<f64>, len: usize) {
    values.clear();
    values.resize(len, 0.0);
}

/// An odd number of cache lines, so that a column of a table does not fall into few sets of the cache.
fn stride<T>(width: usize) -> usize {
    let line = 64 / size_of::<T>();
    (width.div_ceil(line) | 1) * line
}

/// `len` values that begin at a cache line.
fn aligned<T: Real>(buffer: &mut Vec<T>, len: usize) -> &mut [T] {
    let line = 64 / size_of::<T>();
    if buffer.len() < len + line {
        buffer.resize(len + line, T::default());
    }
    let offset = buffer.as_ptr().align_offset(64).min(line);
    &mut buffer[offset..offset + len]
}

/// f32 or f64: the precision of tables and of the sum over a panel.
pub(super) trait Real: Element + Default + Send + Sync + std::ops::Mul<Output = Self> {
    /// Rounded.
    fn rounded(value: f64) -> Self;

    fn fill(level: SimdLevel, table: &Table, panel: &Panel<'_>, out: &mut [Self], stride: usize);

    /// Writes the weighted sums over points of a table's columns.
    fn table_sums(level: SimdLevel, table: &[Self], stride: usize, weights: &[Self], sums: &mut [Self]);

    /// `to += from`: the sums of a panel join those of all points.
    fn join(level: SimdLevel, to: &mut [f64], from: &[Self]);

    /// Adds the weighted sums over points of a table's columns to `sums`; `scratch` is there to be reused.
    fn add_sums(
        level: SimdLevel,
        table: &[Self],
        stride: usize,
        weights: &[Self],
        scratch: &mut Vec<Self>,
        sums: &mut [f64],
    ) {
        let scratch = first(scratch, sums.len());
        Self::table_sums(level, table, stride, weights, scratch);
        Self::join(level, sums, scratch);
    }

    /// Panels that are added up in this precision.
    const PANELS: usize;

    /// Where they are added up; `sums` are those over all points.
    fn sums_of_panels<'a>(panels: &'a mut Vec<Self>, sums: &'a mut [f64]) -> &'a mut [Self];

    /// Adds them to `sums`, if they are not there.
    fn join_panels(level: SimdLevel, sums: &mut [f64], panels: &[Self]);
}

/// The first `len` values of a buffer that grows to hold them.
fn first<T: Real>(buffer: &mut Vec<T>, len: usize) -> &mut [T] {
    buffer.resize(buffer.len().max(len), T::default());
    &mut buffer[..len]
}

impl Real for f32 {
    fn rounded(value: f64) -> Self {
        value as Self
    }

    fn fill(level: SimdLevel, table: &Table, panel: &Panel<'_>, out: &mut [Self], stride: usize) {
        simd::fill_f32(level, table, panel, out, stride);
    }

    fn table_sums(level: SimdLevel, table: &[Self], stride: usize, weights: &[Self], sums: &mut [Self]) {
        simd::table_sums_f32(level, table, stride, weights, sums);
    }

    fn join(level: SimdLevel, to: &mut [f64], from: &[Self]) {
        simd::add(level, to, from);
    }

    const PANELS: usize = PANELS_PER_SUM;

    fn sums_of_panels<'a>(panels: &'a mut Vec<Self>, sums: &'a mut [f64]) -> &'a mut [Self] {
        first(panels, sums.len())
    }

    fn join_panels(level: SimdLevel, sums: &mut [f64], panels: &[Self]) {
        Self::join(level, sums, panels);
    }
}

impl Real for f64 {
    fn rounded(value: f64) -> Self {
        value
    }

    fn fill(level: SimdLevel, table: &Table, panel: &Panel<'_>, out: &mut [Self], stride: usize) {
        simd::fill_f64(level, table, panel, out, stride);
    }

    fn table_sums(level: SimdLevel, table: &[Self], stride: usize, weights: &[Self], sums: &mut [Self]) {
        simd::table_sums_f64(level, table, stride, weights, sums);
    }

    fn join(_: SimdLevel, to: &mut [f64], from: &[Self]) {
        for (to, from) in to.iter_mut().zip(from) {
            *to += *from;
        }
    }

    const PANELS: usize = usize::MAX;

    fn sums_of_panels<'a>(_: &'a mut Vec<Self>, sums: &'a mut [f64]) -> &'a mut [Self] {
        sums
    }

    fn join_panels(_: SimdLevel, _: &mut [f64], _: &[Self]) {}
}

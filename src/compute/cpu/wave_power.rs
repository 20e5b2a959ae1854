//! The power spectrum as matrix products. Formula: see `reference`.
//!
//! With `m = a + b`, `exp(-2 pi i m . x)` factors into phases of `a` and of `b`, so the sums over points of
//! `cos cos`, `sin sin`, `cos sin` and `sin cos` over rows `a` and columns `b` give `s` at `a + b` and, by a sign, at
//! `a - b`: trigonometry costs `n (rows + columns)`, and the rest is one real product of `2 rows x n x 2 columns`.
//!
//! - In 2D and 3D the rows are `(m_0, 0, 0)` and the columns `(0, m_1, m_2)`, one of each pair of opposite signs.
//! - In 1D the rows are `0 ..= h` and the columns the multiples of `2 h + 1`, with `h` near `sqrt(F / 2)`.
//!
//! Points go in panels, far apart in the input: a panel's product is taken in f32 (`fast`) or f64 (`high`), and added
//! to f64 sums. So each sum is made by the same additions in the same order, however the grid is cut into tiles for
//! threads.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::Cpu;
use super::phase_tables::{Panel, Table};
use super::product::{Element, FEWEST_POINTS, Operand, lanes, product};
use super::simd::{self, SimdLevel};
use crate::accumulate::{LEAF, WavePower};
use crate::compute::{Compute, Control, coprime_from};
use crate::error::Result;
use crate::plan::{Accuracy, MEMORY_BUDGET, WaveGrid, WavePlan};
use crate::points::Ensemble;

/// Points per panel: with more of them the error grows (see `Accuracy` for the bound it must keep), with fewer the time
/// to add up panels. `product` must take as many at once.
const PANEL: usize = 160;

/// Rows of a block: its sums over a panel stay in the cache until they are added to the others, and `gemm` does not
/// copy the table of columns for so few.
const ROWS: usize = 48;

/// Panels between two looks at the control.
const PANELS_PER_CHECK: usize = 64;

/// Longest side of a tile, in bytes of one table's cosines at one point: two tables of a panel fit the second-level
/// cache. In f32 a little above 256 frequencies, so that grids of that size stay whole.
const LARGEST_TILE: usize = 264 * size_of::<f32>();

/// Tiles are not cut smaller than this for the sake of threads: below, trigonometry dominates.
const SMALLEST_TILE: usize = 32;

pub(super) fn wave_power(cpu: &Cpu, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower> {
    match plan.accuracy {
        Accuracy::Fast => wave_power_in::<f32>(cpu, plan, ensemble, control),
        Accuracy::High => wave_power_in::<f64>(cpu, plan, ensemble, control),
    }
}

fn wave_power_in<T: Real>(cpu: &Cpu, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower> {
    let Some(grid) = plan.waves.grid() else {
        return crate::compute::reference::Reference.wave_power(plan, ensemble, control);
    };
    let factors = Factors::new(grid);
    let threads = cpu.threads();
    let modes = plan.waves.len();
    let new_sums = || WavePower::new(cpu.computed_by(), modes, &plan.rings);
    let first = ensemble.first_index();
    let realizations = ensemble.realizations();
    let spectrum_bytes = modes as u64 * 8;
    let next = AtomicUsize::new(0);

    // Many realizations: one thread per leaf of the ordered sum, so that nothing is left to one thread alone. A leaf in
    // the making is three sums per mode beside the spectrum.
    let leaf_of = |k: usize| (first + k as u64) / LEAF;
    let leaves: Vec<Range<usize>> = (0..realizations)
        .filter(|&k| k == 0 || leaf_of(k) != leaf_of(k - 1))
        .map(|start| start..(((leaf_of(start) + 1) * LEAF - first) as usize).min(realizations))
        .collect();
    let enough = threads == 1 || leaves.len() >= 2 * threads;
    if enough && 4 * spectrum_bytes * threads as u64 <= MEMORY_BUDGET {
        let tiles = factors.tiles::<T>(1);
        let sums = Mutex::new(new_sums());
        let results = cpu.pool.broadcast(|_| {
            let mut scratch = Scratch::<T>::default();
            let mut power = vec![0.0; modes];
            loop {
                control.check()?;
                let Some(leaf) = leaves.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
                let mut sum = new_sums();
                for k in leaf.clone() {
                    for tile in &tiles {
                        scratch.sum(cpu.level, tile, &ensemble.fractions(k), control)?;
                        scratch.write_power(&factors, tile, &mut power);
                    }
                    sum.add(first + k as u64, ensemble.norm(k), &power, &plan.rings);
                }
                sum.close_leaf();
                sums.lock().unwrap_or_else(PoisonError::into_inner).merge(sum)?;
            }
        });
        results.into_iter().collect::<Result<()>>()?;
        return Ok(sums.into_inner().unwrap_or_else(PoisonError::into_inner));
    }

    // Else as many realizations at a time as there are threads and memory for, cut into tiles.
    let mut sums = new_sums();
    let at_once = (MEMORY_BUDGET / spectrum_bytes.max(1)).clamp(1, threads as u64) as usize;
    for start in (0..realizations).step_by(at_once) {
        let wave = start..(start + at_once).min(realizations);
        let tiles = factors.tiles::<T>(if wave.len() >= threads { 1 } else { (2 * threads).div_ceil(wave.len()) });
        let powers: Vec<_> = wave.clone().map(|_| Mutex::new(vec![0.0; modes])).collect();
        next.store(0, Ordering::Relaxed);
        let results = cpu.pool.broadcast(|_| {
            let mut scratch = Scratch::<T>::default();
            loop {
                control.check()?;
                let task = next.fetch_add(1, Ordering::Relaxed);
                let (k, tile) = (task / tiles.len(), task % tiles.len());
                let Some(power) = powers.get(k) else { return Ok(()) };
                scratch.sum(cpu.level, &tiles[tile], &ensemble.fractions(start + k), control)?;
                let mut power = power.lock().unwrap_or_else(PoisonError::into_inner);
                scratch.write_power(&factors, &tiles[tile], &mut power);
            }
        });
        results.into_iter().collect::<Result<()>>()?;
        for (k, power) in wave.zip(powers) {
            let power = power.into_inner().unwrap_or_else(PoisonError::into_inner);
            sums.add(first + k as u64, ensemble.norm(k), &power, &plan.rings);
        }
    }
    sums.close_leaf();
    Ok(sums)
}

/// How the modes of a grid are made from rows and columns.
struct Factors {
    rows: Vec<[i32; 3]>,
    row_axes: Vec<usize>,
    columns: Vec<[i32; 3]>,
    column_axes: Vec<usize>,
    /// Where row 0 plus column `c` is stored, and row 0 minus column `c`.
    plus: Vec<i64>,
    minus: Vec<i64>,
    /// How far that moves from one row to the next.
    plus_step: i64,
    minus_step: i64,
}

impl Factors {
    fn new(grid: &WaveGrid) -> Self {
        let f = grid.max_frequency().map(|f| f as i32);
        if grid.dim() == 1 {
            let half = f64::from(f[0] / 2).sqrt().round() as i32;
            let step = 2 * half + 1;
            let columns: Vec<[i32; 3]> = (0..=(f[0] + half) / step).map(|p| [p * step, 0, 0]).collect();
            // Row q and column p: the modes p step + q, and p step - q. The latter is -q for p = 0, which is not stored.
            let at: Vec<i64> = columns.iter().map(|c| i64::from(c[0])).collect();
            return Self {
                rows: (0..=half).map(|q| [q, 0, 0]).collect(),
                row_axes: vec![0],
                columns,
                column_axes: vec![0],
                plus: at.clone(),
                minus: at,
                plus_step: 1,
                minus_step: -1,
            };
        }
        let columns: Vec<[i32; 3]> = grid.columns().into_iter().map(|[m1, m2]| [0, m1, m2]).collect();
        let at = |m: [i32; 3]| grid.half_index(m) as i64;
        let [_, n1, n2] = grid.half_shape();
        Self {
            rows: (0..=f[0]).map(|m0| [m0, 0, 0]).collect(),
            row_axes: vec![0],
            column_axes: (1..grid.dim()).collect(),
            plus: columns.iter().map(|&m| at(m)).collect(),
            minus: columns.iter().map(|&m| at(m.map(|x| -x))).collect(),
            columns,
            plus_step: (n1 * n2) as i64,
            minus_step: (n1 * n2) as i64,
        }
    }

    /// Cuts rows and columns into at least `wanted` tiles where that is sensible, none too large for the caches.
    fn tiles<T: Real>(&self, wanted: usize) -> Vec<Tile> {
        let (rows, columns) = (self.rows.len(), self.columns.len());
        let largest = LARGEST_TILE / size_of::<T>();
        let (mut row_parts, mut column_parts) = (rows.div_ceil(largest), columns.div_ceil(largest));
        while row_parts * column_parts < wanted {
            let (height, width) = (rows / row_parts, columns / column_parts);
            if height.max(width) < 2 * SMALLEST_TILE {
                break;
            }
            *(if width >= height { &mut column_parts } else { &mut row_parts }) += 1;
        }
        // Cosines and sines of half as many columns fill a vector.
        let height = rows.div_ceil(row_parts);
        let width = columns.div_ceil(column_parts).next_multiple_of(lanes::<T>() / 2);
        let cut = |len: usize, by: usize| (0..len).step_by(by).map(move |start| start..(start + by).min(len));
        cut(columns, width)
            .flat_map(|c| cut(rows, height).map(move |r| (r, c.clone())))
            .map(|(r, c)| Tile {
                left: Table::new(&self.row_axes, &self.rows[r.clone()]),
                right: Table::new(&self.column_axes, &self.columns[c.clone()]),
                first_row: r.start,
                first_column: c.start,
            })
            .collect()
    }
}

/// A rectangle of rows and columns.
struct Tile {
    left: Table,
    right: Table,
    first_row: usize,
    first_column: usize,
}

/// The tables of a panel, its sums in a block of rows, and the sums of a tile; reused from tile to tile.
struct Scratch<T> {
    left: Vec<T>,
    right: Vec<T>,
    panel: Vec<T>,
    sums: Vec<f64>,
    columns: usize,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        Self { left: Vec::new(), right: Vec::new(), panel: Vec::new(), sums: Vec::new(), columns: 0 }
    }
}

impl<T: Real> Scratch<T> {
    /// The four sums of every row and column of the tile, over all points.
    fn sum(&mut self, level: SimdLevel, tile: &Tile, axes: &[&[u64]], control: &Control) -> Result<()> {
        let rows = 2 * tile.left.len();
        self.columns = (2 * tile.right.len()).next_multiple_of(lanes::<T>());
        let left_stride = stride::<T>(rows.max(tile.left.width()));
        let right_stride = stride::<T>(self.columns.max(tile.right.width()));
        let left = aligned(&mut self.left, PANEL * left_stride);
        let right = aligned(&mut self.right, PANEL * right_stride);
        self.sums.clear();
        self.sums.resize(rows * self.columns, 0.0);
        let n = axes[0].len();
        // No divisor in common with `n`: else the panels of a lattice can be one lattice shifted, and their rounding
        // errors, alike, add up.
        let panels = coprime_from(n.div_ceil(PANEL), n);
        for start in 0..panels {
            if start % PANELS_PER_CHECK == 0 {
                control.check()?;
            }
            // Points far apart in the input: many sets come in an order along which phases vary slowly, and neighbours
            // would add up to large partial sums, with large rounding errors, before they cancel.
            let mut gathered = [[0u64; PANEL]; 3];
            let mut points = 0;
            for (to, axis) in gathered.iter_mut().zip(axes) {
                points = 0;
                for (to, &x) in to.iter_mut().zip(axis[start..].iter().step_by(panels)) {
                    *to = x;
                    points += 1;
                }
            }
            let cut = gathered.each_ref().map(|axis| &axis[..points]);
            let panel = Panel { axes: &cut };
            T::fill(level, &tile.left, &panel, left, left_stride);
            T::fill(level, &tile.right, &panel, right, right_stride);
            if points < FEWEST_POINTS {
                left[points * left_stride..FEWEST_POINTS * left_stride].fill(T::default());
            }
            let points = points.max(FEWEST_POINTS);
            for (block, sums) in self.sums.chunks_mut(ROWS * self.columns).enumerate() {
                let first = block * ROWS;
                let left = Operand { values: &left[first..], stride: left_stride, width: ROWS.min(rows - first) };
                let right = Operand { values: right, stride: right_stride, width: self.columns };
                T::add_product(level, left, right, points, &mut self.panel, sums);
            }
        }
        Ok(())
    }

    /// `|s|^2` of the modes of the tile.
    fn write_power(&self, factors: &Factors, tile: &Tile, power: &mut [f64]) {
        let (height, width) = (tile.left.len(), tile.right.len());
        let columns = tile.first_column..tile.first_column + width;
        let (plus, minus) = (&factors.plus[columns.clone()], &factors.minus[columns]);
        for r in 0..height {
            let (cos, sin) = (&self.sums[r * self.columns..], &self.sums[(height + r) * self.columns..]);
            let (cc, cs) = (&cos[..width], &cos[width..2 * width]);
            let (sc, ss) = (&sin[..width], &sin[width..2 * width]);
            let row = (tile.first_row + r) as i64;
            for c in 0..width {
                let at = [plus[c] + row * factors.plus_step, minus[c] + row * factors.minus_step];
                let q = [
                    (cc[c] - ss[c]).powi(2) + (sc[c] + cs[c]).powi(2),
                    (cc[c] + ss[c]).powi(2) + (sc[c] - cs[c]).powi(2),
                ];
                for (at, q) in at.into_iter().zip(q) {
                    // Outside only in 1D, at the ends.
                    if let Some(power) = usize::try_from(at).ok().and_then(|at| power.get_mut(at)) {
                        *power = q;
                    }
                }
            }
        }
    }
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
trait Real: Element + Default + Send {
    fn fill(level: SimdLevel, table: &Table, panel: &Panel<'_>, out: &mut [Self], stride: usize);

    /// Adds the product to `sums`; `scratch` is there to be reused.
    fn add_product(
        level: SimdLevel,
        left: Operand<'_, Self>,
        right: Operand<'_, Self>,
        points: usize,
        scratch: &mut Vec<Self>,
        sums: &mut [f64],
    );
}

impl Real for f32 {
    fn fill(level: SimdLevel, table: &Table, panel: &Panel<'_>, out: &mut [Self], stride: usize) {
        simd::fill_f32(level, table, panel, out, stride);
    }

    fn add_product(
        level: SimdLevel,
        left: Operand<'_, Self>,
        right: Operand<'_, Self>,
        points: usize,
        scratch: &mut Vec<Self>,
        sums: &mut [f64],
    ) {
        scratch.resize(scratch.len().max(sums.len()), 0.0);
        let scratch = &mut scratch[..sums.len()];
        product(left, right, points, scratch, false);
        simd::add(level, sums, scratch);
    }
}

impl Real for f64 {
    fn fill(level: SimdLevel, table: &Table, panel: &Panel<'_>, out: &mut [Self], stride: usize) {
        simd::fill_f64(level, table, panel, out, stride);
    }

    fn add_product(
        _: SimdLevel,
        left: Operand<'_, Self>,
        right: Operand<'_, Self>,
        points: usize,
        _: &mut Vec<Self>,
        sums: &mut [f64],
    ) {
        product(left, right, points, sums, true);
    }
}

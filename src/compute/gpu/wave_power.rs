//! The power spectrum on the GPU: how the grid and the points are cut, and how the sums become `WavePower`. See the
//! reference for the definition, `shaders/wave_power.wgsl` for the work itself and `shaders/shared/wave_types.wgsl` for where
//! its sums lie.

use std::ops::Range;

use super::kernel::{self, KernelSpec};
use super::params::{WAVE_POWER, WAVE_POWER_FOLD, WAVE_POWER_WEIGHTED, WaveParams, WaveRange};
use super::{GpuCompute, MAX_GROUPS};
use crate::accumulate::WavePower;
use crate::compute::compensated::Compensated;
use crate::compute::{Compute, coprime_from};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Accuracy, WaveGrid, WavePlan};
use crate::points::Ensemble;

const NAME: &str = "wave_power";
const FOLD_NAME: &str = "wave_power_fold";
/// Rows and columns per invocation, and numbers per table entry.
const BLOCK: u32 = 4;
/// Workgroup memory for tables: what every WebGPU device has.
const TABLE_BYTES: u32 = 16 << 10;
/// Points summed in plain f32: the error of P grows with the square root of this, the cost of settling with its inverse.
const PANEL: u32 = 64;
/// Chunks of points a realization is cut into: enough for the largest devices, as long as a chunk repays its sums.
const CHUNKS: usize = 128;
/// Least and largest number of points of a chunk. The steps of `wave_settle.wgsl` are counted in i32 up to the latter.
const CHUNK: [usize; 2] = [1024, 32_768];
const FOLD_WORKGROUP: u32 = 64;
const LISTS: &str = "lists of wave vectors have no GPU kernel";
/// Bytes per sum and invocation: an integer and its rest in f32, or one f64, of four columns.
const SUM_BYTES: u64 = 32;

/// How a grid is cut into blocks of one workgroup each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Blocks {
    row_lanes: u32,
    column_lanes: u32,
    lanes: u32,
    /// Sums per invocation.
    slots: u32,
    /// Blocks over rows and columns: at least 1, since row 0 and column 0 lie along them.
    count: [u32; 2],
}

impl Blocks {
    fn new(grid: &WaveGrid) -> Self {
        let (rows, columns) = (grid.half_shape()[0] as u32 - 1, columns(grid) as u32 - 1);
        // Blocks are square where the grid allows, since a table entry costs as much as about 30 multiply-adds per number.
        let shapes = [(16, 16, 256), (8, 8, 64), (63, 1, 64), (1, 63, 64)].map(|(row_lanes, column_lanes, lanes)| {
            let count = [(rows, row_lanes), (columns, column_lanes)].map(|(n, l)| n.div_ceil(BLOCK * l).max(1));
            let slots = if rows.min(columns) == 0 { 2 } else { 18 };
            Self { row_lanes, column_lanes, lanes, slots, count }
        });
        let cost = |blocks: &Self| {
            let product = if blocks.slots > 2 { 64 * blocks.lanes } else { 0 };
            blocks.total() * u64::from(product + 120 * blocks.entries())
        };
        shapes.into_iter().min_by_key(cost).unwrap_or(shapes[0])
    }

    /// Table entries of a block.
    fn entries(&self) -> u32 {
        self.row_lanes + self.column_lanes
    }

    /// Results of a block, of eight numbers each.
    fn items(&self) -> u32 {
        self.entries() + if self.slots > 2 { BLOCK * self.lanes } else { 0 }
    }

    fn total(&self) -> u64 {
        u64::from(self.count[0]) * u64::from(self.count[1])
    }

    /// Rows and columns of a block.
    fn span(&self) -> [usize; 2] {
        [self.row_lanes, self.column_lanes].map(|lanes| (BLOCK * lanes) as usize)
    }

    /// Bytes of the sums of one block over one chunk.
    fn sum_bytes(&self) -> u64 {
        SUM_BYTES * u64::from(self.slots * self.lanes)
    }
}

/// The product kernel for a grid.
pub(super) fn spec(grid: &WaveGrid, accuracy: Accuracy, weighted: bool) -> KernelSpec {
    let blocks = Blocks::new(grid);
    let (phase, settle, real_bytes, panel) = match accuracy {
        Accuracy::Fast => (kernel::PHASE, kernel::WAVE_SETTLE, 4, PANEL),
        // No panels within a chunk.
        Accuracy::High => (kernel::PHASE_F64, kernel::WAVE_SETTLE_F64, 8, CHUNK[1] as u32),
    };
    let (weights, bindings) =
        if weighted { (kernel::WAVE_WEIGHTED, WAVE_POWER_WEIGHTED) } else { (kernel::WAVE_UNWEIGHTED, WAVE_POWER) };
    let entries = blocks.entries();
    let tile = TABLE_BYTES / (2 * BLOCK * real_bytes * entries);
    KernelSpec {
        name: NAME,
        files: vec![phase, kernel::WAVE_TYPES, settle, weights, kernel::WAVE_POWER],
        overrides: vec![
            ("DIM", grid.dim() as u32),
            ("ROW_LANES", blocks.row_lanes),
            ("COLUMN_LANES", blocks.column_lanes),
            ("ENTRIES", entries),
            ("WORKGROUP", blocks.lanes),
            ("SLOTS", blocks.slots),
            ("TILE", tile),
            ("TABLE_WORDS", tile * entries),
            ("PANEL", panel),
        ],
        bindings,
    }
}

/// The kernel that folds sums into `|s_m|^2`.
pub(super) fn fold_spec(grid: &WaveGrid, accuracy: Accuracy) -> KernelSpec {
    let blocks = Blocks::new(grid);
    let mut files = match accuracy {
        Accuracy::Fast => vec![kernel::TWO_FLOAT, kernel::WAVE_TYPES, kernel::WAVE_TOTAL],
        Accuracy::High => vec![kernel::WAVE_TYPES, kernel::WAVE_TOTAL_F64],
    };
    files.push(kernel::WAVE_POWER_FOLD);
    KernelSpec {
        name: FOLD_NAME,
        files,
        overrides: vec![
            ("WORKGROUP", FOLD_WORKGROUP),
            ("ENTRIES", blocks.entries()),
            ("LANES", blocks.lanes),
            ("SLOTS", blocks.slots),
            ("ITEMS", blocks.items()),
        ],
        bindings: WAVE_POWER_FOLD,
    }
}

/// Number of columns: one of each pair `+-(m_1, m_2)`. In the order of `WaveGrid::columns`, column `c` is `c` places
/// after (0, 0) in the stored plane, and its mirror image `c` places before.
fn columns(grid: &WaveGrid) -> usize {
    let [_, n1, n2] = grid.half_shape();
    (n1 * n2).div_ceil(2)
}

/// Points per chunk of a realization with `n` points. It depends on nothing else, so neither do the bytes of the result.
fn chunk(n: usize) -> usize {
    n.div_ceil(CHUNKS).next_multiple_of(PANEL as usize).clamp(CHUNK[0], CHUNK[1])
}

/// Why a plan cannot run here. `f64` says why f64 cannot be relied on, if so.
pub(super) fn supports(plan: &WavePlan, f64: Result<(), String>, binding_bytes: u64) -> Result<(), String> {
    if plan.tapered().is_some() {
        return Err("no GPU kernel for tapered spectra".into());
    }
    if plan.accuracy == Accuracy::High {
        f64.map_err(|why| format!("accuracy high needs f64: {why}"))?;
    }
    let Some(grid) = plan.waves.grid() else { return Err(LISTS.into()) };
    fits(plan.shape.max_points, grid, binding_bytes)
}

/// Whether the points of a realization and the sums of one block over all its chunks fit into buffers.
fn fits(points: u64, grid: &WaveGrid, binding_bytes: u64) -> Result<(), String> {
    let chunks = points.div_ceil(chunk(usize::try_from(points).unwrap_or(usize::MAX / 2)) as u64);
    let sums = chunks.saturating_mul(Blocks::new(grid).sum_bytes());
    let bytes = points.saturating_mul(8 * grid.dim() as u64).max(sums);
    if bytes > binding_bytes || points > u64::from(u32::MAX) / 8 {
        return Err(format!("{points} points need {bytes} bytes in one buffer, the device has {binding_bytes}"));
    }
    Ok(())
}

/// The largest rectangle of blocks of which no more than `fitting` are needed: whole rows of blocks, or a part of one.
fn cut(count: [u32; 2], fitting: u64) -> [u32; 2] {
    let fitting = u32::try_from(fitting).unwrap_or(u32::MAX).max(1);
    if count[1] <= fitting { [(fitting / count[1]).min(count[0]), count[1]] } else { [1, fitting] }
}

pub(super) async fn wave_power(
    compute: &GpuCompute,
    plan: &WavePlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<WavePower> {
    let gpu = compute.gpu();
    let tuning = &compute.tuning;
    let binding_bytes = gpu.limits.max_storage_buffer_binding_size;
    let grid = plan.waves.grid().ok_or_else(|| gpu.error(NAME, LISTS))?;
    let sizes: Vec<usize> = (0..ensemble.realizations()).map(|k| ensemble.points_in(k)).collect();
    let largest = sizes.iter().copied().max().unwrap_or(0);
    fits(largest as u64, grid, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;

    let weighted = (0..sizes.len()).any(|k| ensemble.weights(k).is_some());
    let blocks = Blocks::new(grid);
    let job = Job {
        compute,
        grid,
        accuracy: plan.accuracy,
        blocks,
        product: compute.kernel(spec(grid, plan.accuracy, weighted)).await?,
        fold: compute.kernel(fold_spec(grid, plan.accuracy)).await?,
    };
    let buffer_bytes = tuning.buffer_bytes.min(binding_bytes);
    let points_cap = buffer_bytes as usize / (8 * grid.dim());
    let sums_cap = buffer_bytes / blocks.sum_bytes();

    let mut result = WavePower::new(compute.computed_by(), grid.half_len(), &plan.rings);
    let mut first = 0;
    while first < sizes.len() {
        // As many realizations as fit with the whole grid, or one and a part of it.
        let (mut end, mut points, mut chunks) = (first, 0, 0);
        while end < sizes.len() {
            // Without points there are no chunks, but |s|^2 = 0 takes room, too.
            let more = sizes[end].div_ceil(chunk(sizes[end])).max(1) as u64;
            let fits = points + sizes[end] <= points_cap && (chunks + more) * blocks.total() <= sums_cap;
            if end > first && !fits {
                break;
            }
            (points, chunks, end) = (points + sizes[end], chunks + more, end + 1);
        }
        let batch = first..end;
        let part = cut(blocks.count, sums_cap / chunks);
        let mut power = vec![vec![0f64; grid.half_len()]; batch.len()];
        gpu.guarded(NAME, async || {
            let points = job.upload(ensemble, &batch, part);
            for row in (0..blocks.count[0]).step_by(part[0] as usize) {
                for column in (0..blocks.count[1]).step_by(part[1] as usize) {
                    control.check()?;
                    let end = [(row + part[0]).min(blocks.count[0]), (column + part[1]).min(blocks.count[1])];
                    job.run(&points, [row..end[0], column..end[1]], &mut power, control).await?;
                }
            }
            Ok(())
        })
        .await?;
        for (k, power) in batch.zip(&mut power) {
            // s_0 is the sum of weights. It needs no phases, and is the one value an f32 may be too short for.
            power[grid.dc()] = match ensemble.weights(k) {
                Some(weights) => weights.iter().copied().collect::<Compensated>().sum().powi(2),
                None => (sizes[k] as f64).powi(2),
            };
            result.add(ensemble.first_index() + k as u64, ensemble.norm(k), power.as_slice(), &plan.rings);
        }
        first = end;
    }
    result.close_leaf();
    Ok(result)
}

/// The kernels and the plan of one call.
struct Job<'a> {
    compute: &'a GpuCompute,
    grid: &'a WaveGrid,
    accuracy: Accuracy,
    blocks: Blocks,
    product: std::sync::Arc<kernel::Kernel>,
    fold: std::sync::Arc<kernel::Kernel>,
}

/// Points of some realizations on the device, and room for what becomes of them.
struct Points {
    total: usize,
    fractions: wgpu::Buffer,
    weights: Option<wgpu::Buffer>,
    chunks: Vec<WaveRange>,
    chunks_buffer: wgpu::Buffer,
    realizations: usize,
    realizations_buffer: wgpu::Buffer,
    /// Scratch for one part of the grid after another: allocating it is dearer than using it.
    sums: wgpu::Buffer,
    power: wgpu::Buffer,
}

/// The points of a realization in an order in which those of a panel lie far apart in the input: neighbours in a file are
/// often neighbours in space or on a lattice, and equal addends err alike. The stride shares no divisor with n, else
/// the panels of a lattice can be one lattice shifted, and err alike too.
fn far_apart(n: usize) -> impl Iterator<Item = usize> {
    let stride = coprime_from(n.div_ceil(PANEL as usize).max(1), n);
    (0..stride).flat_map(move |first| (first..n).step_by(stride))
}

impl Job<'_> {
    fn upload(&self, ensemble: &Ensemble, batch: &Range<usize>, part: [u32; 2]) -> Points {
        let (gpu, fill) = (self.compute.gpu(), self.compute.tuning.fill);
        let points = ensemble.range(batch.start).start..ensemble.range(batch.end - 1).end;
        let mut fractions = Vec::with_capacity(points.len() * ensemble.domain().dim());
        for axis in 0..ensemble.domain().dim() {
            let axis = ensemble.all_fractions(axis);
            for k in batch.clone() {
                let axis = &axis[ensemble.range(k)];
                fractions.extend(far_apart(axis.len()).map(|j| [axis[j] as u32, (axis[j] >> 32) as u32]));
            }
        }
        let weights: Vec<f64> = batch
            .clone()
            .filter_map(|k| ensemble.weights(k))
            .flat_map(|weights| far_apart(weights.len()).map(move |j| weights[j]))
            .collect();
        let weights = ensemble.weights(batch.start).map(|_| match self.accuracy {
            Accuracy::Fast => gpu.upload("weights", &weights.iter().map(|&w| w as f32).collect::<Vec<_>>(), fill),
            Accuracy::High => gpu.upload("weights", &weights, fill),
        });
        let (mut chunks, mut realizations) = (Vec::new(), Vec::new());
        for k in batch.clone() {
            let range = ensemble.range(k);
            let first = chunks.len() as u32;
            let size = chunk(range.len());
            for start in range.clone().step_by(size) {
                let count = size.min(range.end - start) as u32;
                chunks.push(WaveRange { first: (start - points.start) as u32, count });
            }
            realizations.push(WaveRange { first, count: chunks.len() as u32 - first });
        }
        let blocks = u64::from(part[0] * part[1]);
        let items = blocks * u64::from(self.blocks.items()) * realizations.len() as u64;
        Points {
            total: points.len(),
            sums: gpu.scratch("sums", chunks.len() as u64 * blocks * self.blocks.sum_bytes(), fill),
            power: gpu.scratch("power", items * self.item_bytes(), fill),
            fractions: gpu.upload("fractions", &fractions, fill),
            weights,
            chunks_buffer: gpu.upload("chunks", &chunks, fill),
            chunks,
            realizations: realizations.len(),
            realizations_buffer: gpu.upload("realizations", &realizations, fill),
        }
    }

    /// Bytes of eight numbers.
    fn item_bytes(&self) -> u64 {
        match self.accuracy {
            Accuracy::Fast => 32,
            Accuracy::High => 64,
        }
    }

    /// The blocks of a part of the grid, into `power` (per realization, one value per stored mode).
    async fn run(
        &self,
        points: &Points,
        part: [Range<u32>; 2],
        power: &mut [Vec<f64>],
        control: &Control,
    ) -> Result<()> {
        let (gpu, tuning) = (self.compute.gpu(), &self.compute.tuning);
        let span = self.blocks.span();
        let mut params = WaveParams {
            first_row: 1 + part[0].start * span[0] as u32,
            first_column: 1 + part[1].start * span[1] as u32,
            row_blocks: part[0].len() as u32,
            column_blocks: part[1].len() as u32,
            frequency_2: self.grid.max_frequency()[2],
            total_points: points.total as u32,
            ..WaveParams::default()
        };
        let blocks = params.row_blocks * params.column_blocks;
        params.jobs = blocks * points.chunks.len() as u32;
        // Work per group, in multiply-adds.
        let longest = points.chunks.iter().map(|c| c.count).max().unwrap_or(1);
        let work = u64::from(64 * self.blocks.lanes) * u64::from(longest);
        let groups = (tuning.fma_per_dispatch / work).clamp(1, u64::from(MAX_GROUPS)) as u32;
        let mut last = None;
        while params.first_job < params.jobs {
            control.check()?;
            let count = groups.min(params.jobs - params.first_job);
            let uniform = gpu.uniform("params", &params);
            let mut encoder = gpu.encoder(NAME);
            let mut buffers = vec![&uniform, &points.chunks_buffer, &points.fractions, &points.sums];
            buffers.extend(&points.weights);
            self.product.dispatch(gpu, &mut encoder, &buffers, count);
            params.first_job += count;
            // One submission ahead: the device has work while the host waits, and a cancelled call ends soon.
            if let Some(last) = last.replace(gpu.submit(encoder)) {
                gpu.wait(NAME, last).await?;
            }
        }

        let total = blocks as usize * self.blocks.items() as usize * points.realizations;
        params.jobs = total as u32;
        params.first_job = 0;
        let mut encoder = gpu.encoder(FOLD_NAME);
        while params.first_job * FOLD_WORKGROUP < params.jobs {
            let count = (params.jobs.div_ceil(FOLD_WORKGROUP) - params.first_job).min(MAX_GROUPS);
            let uniform = gpu.uniform("params", &params);
            let buffers = [&uniform, &points.realizations_buffer, &points.sums, &points.power];
            self.fold.dispatch(gpu, &mut encoder, &buffers, count);
            params.first_job += count;
        }
        let folded: Vec<[f64; 8]> = match self.accuracy {
            Accuracy::Fast => {
                let folded = gpu.read_back::<[f32; 8]>(FOLD_NAME, encoder, &points.power, total).await?;
                folded.into_iter().map(|item| item.map(f64::from)).collect()
            }
            Accuracy::High => gpu.read_back(FOLD_NAME, encoder, &points.power, total).await?,
        };
        for (power, folded) in power.iter_mut().zip(folded.chunks_exact(total / points.realizations)) {
            let places = part[0].clone().flat_map(|row| part[1].clone().map(move |column| [row, column]));
            for (block, items) in places.zip(folded.chunks_exact(self.blocks.items() as usize)) {
                self.place(block, items, power);
            }
        }
        Ok(())
    }

    /// The results of a block, where they belong.
    fn place(&self, block: [u32; 2], items: &[[f64; 8]], power: &mut [f64]) {
        let [grid_rows, n1, n2] = self.grid.half_shape();
        let (plane, centre, grid_columns) = (n1 * n2, n1 * n2 / 2, columns(self.grid));
        let mut put = |row: usize, column: usize, plus: f64, minus: f64| {
            if row < grid_rows && column < grid_columns {
                power[row * plane + centre - column] = minus;
                power[row * plane + centre + column] = plus;
            }
        };
        let [rows, columns] = [self.blocks.row_lanes as usize, self.blocks.column_lanes as usize];
        let (entries, product) = items.split_at(rows + columns);
        let block_row = 1 + block[0] as usize * self.blocks.span()[0];
        let block_column = 1 + block[1] as usize * self.blocks.span()[1];
        for (entry, values) in entries.iter().enumerate() {
            for (i, &q) in values[..4].iter().enumerate() {
                match entry.checked_sub(rows) {
                    None => put(block_row + 4 * entry + i, 0, q, q),
                    Some(entry) => put(0, block_column + 4 * entry + i, q, q),
                }
            }
        }
        for (r, values) in product.chunks_exact(self.blocks.lanes as usize).enumerate() {
            for (lane, values) in values[..rows * columns].iter().enumerate() {
                for i in 0..4 {
                    let (row, column) = (block_row + 4 * (lane % rows) + r, block_column + 4 * (lane / rows) + i);
                    put(row, column, values[i], values[4 + i]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_counted_along_the_stored_plane() {
        for f in [&[3][..], &[2, 3], &[0, 5], &[4, 2, 3], &[1, 0, 2], &[2, 3, 0]] {
            let grid = WaveGrid::new(f).unwrap();
            let listed = grid.columns();
            assert_eq!(listed.len(), columns(&grid), "{f:?}");
            let [_, n1, n2] = grid.half_shape();
            for (c, [m1, m2]) in listed.into_iter().enumerate() {
                assert_eq!(grid.half_index([0, m1, m2]), n1 * n2 / 2 + c, "{f:?}");
            }
        }
    }

    #[test]
    fn blocks_cover_the_grid_and_powers_of_two_fill_them() {
        for f in
            [&[64, 64][..], &[128, 128], &[256, 256], &[3], &[0, 9], &[7, 0], &[65_536, 2], &[1, 65_536], &[9, 8, 7]]
        {
            let grid = WaveGrid::new(f).unwrap();
            let blocks = Blocks::new(&grid);
            let wanted = [grid.half_shape()[0] - 1, columns(&grid) - 1];
            for (axis, wanted) in wanted.into_iter().enumerate() {
                let covered = blocks.count[axis] as usize * blocks.span()[axis];
                assert!(covered >= wanted && covered < wanted.max(1) + blocks.span()[axis], "{f:?}: {blocks:?}");
                if f.len() == 2 && f[0] == f[1] {
                    assert_eq!(covered, wanted, "{f:?}: {blocks:?}");
                }
            }
            assert_eq!(blocks.slots == 2, wanted.contains(&0), "{f:?}: {blocks:?}");
            assert_eq!(blocks.lanes % blocks.entries(), 0, "{blocks:?}");
            assert!(blocks.lanes >= blocks.row_lanes * blocks.column_lanes, "{blocks:?}");
        }
    }

    #[test]
    fn cuts_fit_and_make_progress() {
        for count in [[1, 1], [4, 4], [261, 1], [1, 261], [300, 70]] {
            for fitting in [0, 1, 7, 500, u64::MAX] {
                let [rows, columns] = cut(count, fitting);
                assert!(rows >= 1 && rows <= count[0] && columns >= 1 && columns <= count[1], "{count:?}, {fitting}");
                assert!(u64::from(rows * columns) <= fitting.max(1), "{count:?}, {fitting}");
            }
        }
    }

    #[test]
    fn chunks_hold_whole_panels_and_steps_that_fit() {
        for n in [0, 1, 5000, 65_536, 1_000_000, 100_000_000] {
            let points = chunk(n);
            assert!(points.is_multiple_of(PANEL as usize) && (CHUNK[0]..=CHUNK[1]).contains(&points), "{n}: {points}");
            assert!(points == CHUNK[1] || n.div_ceil(points) <= CHUNKS, "{n}: {points}");
        }
        // Steps of 2^-15 in i32, and panels that stay next to 384.
        assert!(CHUNK[1] as u64 * (1 << 15) <= 1 << 30 && PANEL < 128);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_bytes() {
        let grid = WaveGrid::new(&[64, 64]).unwrap();
        let binding = 128 << 20;
        assert_eq!(fits(1_000_000, &grid, binding), Ok(()));
        // 2^23 points of two coordinates of 8 bytes.
        assert!(fits(8_400_000, &grid, binding).unwrap_err().contains("134400000 bytes"));
        // 128 chunks of one block of 18 sums of 32 bytes for each of 256 invocations.
        assert!(
            fits(1_000_000, &grid, 1 << 24).unwrap_err().contains("18874368 bytes"),
            "{:?}",
            fits(1_000_000, &grid, 1 << 24)
        );
        assert!(fits(u64::MAX, &grid, u64::MAX).is_err());
    }

    /// The polynomials of `shaders/shared/phase.wgsl`, read from there, in the same f32 operations.
    #[test]
    fn cosine_and_sine_keep_their_bound() {
        let constant = |after: &str, end: &str| -> Vec<f32> {
            let text = kernel::PHASE.text;
            let from = text.find(after).unwrap();
            let line = &text[from..from + text[from..].find(end).unwrap()];
            line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '-'))
                .filter(|w| w.contains("e-"))
                .map(|w| w.parse().unwrap())
                .collect()
        };
        let scale = constant("let angle", ";")[0];
        let s = constant("let s ", ";");
        let c = constant("let c ", ";");
        assert_eq!((s.len(), c.len()), (3, 3));
        let (mut worst, mut squares, mut count) = (0f64, 0f64, 0u32);
        for phase in (0..=u32::MAX).step_by(499) {
            let quarter = phase.wrapping_add(1 << 29) >> 30;
            let angle = phase.wrapping_sub(quarter << 30) as i32 as f32 * scale;
            let a2 = angle * angle;
            let sin = angle + angle * a2 * (s[0] + a2 * (s[1] + a2 * s[2]));
            let cos = 1.0 - (0.5 * a2 - a2 * a2 * (c[0] + a2 * (c[1] + a2 * c[2])));
            let (sin, cos) = match quarter {
                0 => (sin, cos),
                1 => (cos, -sin),
                2 => (-sin, -cos),
                _ => (-cos, sin),
            };
            let exact = f64::from(phase) / 2f64.powi(32) * std::f64::consts::TAU;
            for e in [f64::from(sin) - exact.sin(), f64::from(cos) - exact.cos()] {
                worst = worst.max(e.abs());
                squares += e * e;
                count += 1;
            }
        }
        let rms = (squares / f64::from(count)).sqrt();
        println!("cosine and sine: max error {worst:.2e}, rms {rms:.2e}");
        assert!(worst <= 1.2e-7 && rms <= 2.3e-8, "max {worst:e}, rms {rms:e}");
    }
}

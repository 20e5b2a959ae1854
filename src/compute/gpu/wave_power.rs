//! The power spectrum on the GPU: how the grid and the points are cut, and how the sums become `WavePower`. See the
//! reference for the definition and `shaders/wave_power.wgsl` for the work itself.

use std::ops::Range;

use super::kernel::{self, KernelSpec};
use super::params::{WAVE_POWER, WAVE_POWER_FOLD, WaveParams, WaveRange, WaveSums};
use super::{GpuCompute, MAX_GROUPS};
use crate::accumulate::WavePower;
use crate::compute::{Compute, Control, coprime_from};
use crate::error::Result;
use crate::plan::{Accuracy, WaveGrid, WavePlan};
use crate::points::Ensemble;

const NAME: &str = "wave_power";
const FOLD_NAME: &str = "wave_power_fold";
/// Rows and columns per invocation.
const BLOCK: u32 = 4;
/// Points whose phases are tabulated at a time.
const TILE: u32 = 16;
/// Points summed in plain f32: the error of P grows with the square root of this, the cost with its inverse.
const PANEL: u32 = 64;
/// Points per chunk. It depends on nothing else, so neither do the bytes of the result.
const CHUNK: usize = 2048;
const FOLD_WORKGROUP: u32 = 64;

/// The product kernel for a grid.
pub(super) fn spec(grid: &WaveGrid) -> KernelSpec {
    let columns = columns(grid) as u32;
    // Table entries cost as much as about 6 sums, so blocks are square where the grid allows.
    let (row_lanes, column_lanes) = if columns <= BLOCK {
        (32, 1)
    } else if columns <= 8 * BLOCK {
        (8, 8)
    } else {
        (16, 16)
    };
    KernelSpec {
        name: NAME,
        files: vec![kernel::PHASE, kernel::TWO_FLOAT, kernel::WAVE_TYPES, kernel::WAVE_POWER],
        overrides: vec![
            ("DIM", grid.dim() as u32),
            ("ROW_LANES", row_lanes),
            ("COLUMN_LANES", column_lanes),
            ("WORKGROUP", row_lanes * column_lanes),
            ("TILE", TILE),
            ("ROW_WORDS", TILE * row_lanes),
            ("COLUMN_WORDS", TILE * column_lanes),
            ("PANEL", PANEL),
        ],
        bindings: WAVE_POWER,
    }
}

/// The kernel that folds sums into `|s_m|^2`.
pub(super) fn fold_spec() -> KernelSpec {
    KernelSpec {
        name: FOLD_NAME,
        files: vec![kernel::TWO_FLOAT, kernel::WAVE_TYPES, kernel::WAVE_POWER_FOLD],
        overrides: vec![("WORKGROUP", FOLD_WORKGROUP)],
        bindings: WAVE_POWER_FOLD,
    }
}

/// Number of columns: one of each pair `+-(m_1, m_2)`. In the order of `WaveGrid::columns`, column `c` is `c` places
/// after (0, 0) in the stored plane, and its mirror image `c` places before.
fn columns(grid: &WaveGrid) -> usize {
    let [_, n1, n2] = grid.half_shape();
    (n1 * n2).div_ceil(2)
}

/// Why a plan cannot run here.
pub(super) fn supports(plan: &WavePlan, binding_bytes: u64) -> Result<(), String> {
    if plan.accuracy != Accuracy::Fast {
        return Err(format!("accuracy {} needs f64, which the GPU kernels do not use", plan.accuracy.name()));
    }
    let Some(grid) = plan.waves.grid() else { return Err("lists of wave vectors have no GPU kernel".into()) };
    fits(plan.shape.max_points, grid.dim(), binding_bytes)
}

fn fits(points: u64, dim: usize, binding_bytes: u64) -> Result<(), String> {
    let bytes = points.saturating_mul(8 * dim as u64);
    let sums = points.div_ceil(CHUNK as u64).saturating_mul(size_of::<WaveSums>() as u64);
    if bytes.max(sums) > binding_bytes || points > u64::from(u32::MAX) / 8 {
        return Err(format!("{points} points need {bytes} bytes in one buffer, the device has {binding_bytes}"));
    }
    Ok(())
}

/// Rows and columns computed together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Cut {
    rows: usize,
    columns: usize,
}

/// The largest part of a grid whose sums over `chunks` chunks fit into `sums` entries: whole, or whole rows of blocks, or
/// blocks, or what fits.
fn cut(rows: usize, columns: usize, block: [usize; 2], chunks: usize, sums: usize) -> Cut {
    let modes = (sums / chunks.max(1)).max(1);
    if rows * columns <= modes {
        return Cut { rows, columns };
    }
    let columns_taken = if block[0].min(rows) * columns <= modes {
        columns
    } else {
        let fitting = modes / block[0].min(rows);
        if fitting >= block[1] { fitting / block[1] * block[1] } else { fitting.max(1).min(columns) }
    };
    let fitting = (modes / columns_taken).max(1);
    let rows_taken = if fitting >= block[0] { fitting / block[0] * block[0] } else { fitting };
    Cut { rows: rows_taken.min(rows), columns: columns_taken }
}

pub(super) fn wave_power(
    compute: &GpuCompute,
    plan: &WavePlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<WavePower> {
    let gpu = compute.gpu();
    let tuning = &compute.tuning;
    let binding_bytes = gpu.limits.max_storage_buffer_binding_size;
    let grid = plan.waves.grid().ok_or_else(|| gpu.error(NAME, "no grid"))?;
    let dim = grid.dim();
    let sizes: Vec<usize> = (0..ensemble.realizations()).map(|k| ensemble.points_in(k)).collect();
    supports(plan, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;
    let largest = sizes.iter().copied().max().unwrap_or(0);
    fits(largest as u64, dim, binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;

    let job = Job { compute, grid, product: compute.kernel(spec(grid))?, fold: compute.kernel(fold_spec())? };
    let buffer_bytes = tuning.buffer_bytes.min(binding_bytes);
    let sums_cap = (buffer_bytes as usize / size_of::<WaveSums>()).max(largest.div_ceil(CHUNK));
    let points_cap = buffer_bytes as usize / (8 * dim);
    let (grid_rows, grid_columns) = (grid.half_shape()[0], columns(grid));

    let mut result = WavePower::new(compute.computed_by(), grid.half_len(), &plan.rings);
    let mut first = 0;
    while first < sizes.len() {
        // As many realizations as fit with the whole grid, or one and a part of it.
        let (mut end, mut points, mut chunks) = (first, 0, 0);
        while end < sizes.len() {
            // Without points there are no chunks, but |s|^2 = 0 takes room, too.
            let more = sizes[end].div_ceil(CHUNK).max(1);
            let fits = points + sizes[end] <= points_cap && (chunks + more) * grid_rows * grid_columns <= sums_cap;
            if end > first && !fits {
                break;
            }
            (points, chunks, end) = (points + sizes[end], chunks + more, end + 1);
        }
        let batch = first..end;
        let overrides = &job.product.spec().overrides;
        let lanes = |name| overrides.iter().find(|o| o.0 == name).map_or(1, |o| (o.1 * BLOCK) as usize);
        let part = cut(grid_rows, grid_columns, [lanes("ROW_LANES"), lanes("COLUMN_LANES")], chunks, sums_cap);
        let mut power = vec![vec![0f64; grid.half_len()]; batch.len()];
        gpu.guarded(NAME, || {
            let points = job.upload(ensemble, &batch, part);
            for row in (0..grid_rows).step_by(part.rows) {
                for column in (0..grid_columns).step_by(part.columns) {
                    control.check()?;
                    let rows = row..(row + part.rows).min(grid_rows);
                    let columns = column..(column + part.columns).min(grid_columns);
                    job.run(&points, rows, columns, &mut power, control)?;
                }
            }
            Ok(())
        })?;
        for (k, power) in batch.zip(&mut power) {
            // |s_0|^2 = n^2 needs no sum, and is the one value an f32 may be too short for.
            power[grid.dc()] = (sizes[k] as f64).powi(2);
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
    product: std::sync::Arc<kernel::Kernel>,
    fold: std::sync::Arc<kernel::Kernel>,
}

/// Points of some realizations on the device, and room for what becomes of them.
struct Points {
    total: usize,
    fractions: wgpu::Buffer,
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
    fn upload(&self, ensemble: &Ensemble, batch: &Range<usize>, part: Cut) -> Points {
        let (gpu, fill) = (self.compute.gpu(), self.compute.tuning.fill);
        let points = ensemble.range(batch.start).start..ensemble.range(batch.end - 1).end;
        let mut fractions = Vec::with_capacity(points.len() * ensemble.domain().dim());
        for axis in 0..ensemble.domain().dim() {
            let axis = ensemble.all_fractions(axis);
            // The upper word is exact; of the lower, 24 bits are enough: it is multiplied by at most 2^22 steps of 2^-32.
            let low = |x: u64| (x as u32 as f32 / 4_294_967_296.0).to_bits();
            for k in batch.clone() {
                let axis = &axis[ensemble.range(k)];
                fractions.extend(far_apart(axis.len()).map(|j| [(axis[j] >> 32) as u32, low(axis[j])]));
            }
        }
        let (mut chunks, mut realizations) = (Vec::new(), Vec::new());
        for k in batch.clone() {
            let range = ensemble.range(k);
            let first = chunks.len() as u32;
            for start in range.clone().step_by(CHUNK) {
                let count = CHUNK.min(range.end - start) as u32;
                chunks.push(WaveRange { first: (start - points.start) as u32, count });
            }
            realizations.push(WaveRange { first, count: chunks.len() as u32 - first });
        }
        let modes = part.rows * part.columns;
        Points {
            total: points.len(),
            sums: gpu.scratch("sums", (chunks.len() * modes * size_of::<WaveSums>()) as u64, fill),
            power: gpu.scratch("power", 8 * (modes * realizations.len()) as u64, fill),
            fractions: gpu.upload("fractions", &fractions, fill),
            chunks_buffer: gpu.upload("chunks", &chunks, fill),
            chunks,
            realizations: realizations.len(),
            realizations_buffer: gpu.upload("realizations", &realizations, fill),
        }
    }

    /// One part of the grid, into `power` (per realization, one value per stored mode).
    fn run(
        &self,
        points: &Points,
        rows: Range<usize>,
        columns: Range<usize>,
        power: &mut [Vec<f64>],
        control: &Control,
    ) -> Result<()> {
        let (gpu, tuning) = (self.compute.gpu(), &self.compute.tuning);
        let overrides = &self.product.spec().overrides;
        let lanes = |name| overrides.iter().find(|o| o.0 == name).map_or(1, |o| o.1);
        let block = [BLOCK * lanes("ROW_LANES"), BLOCK * lanes("COLUMN_LANES")];
        let modes = rows.len() * columns.len();
        let mut params = WaveParams {
            first_row: rows.start as u32,
            rows: rows.len() as u32,
            first_column: columns.start as u32,
            columns: columns.len() as u32,
            row_blocks: (rows.len() as u32).div_ceil(block[0]),
            column_blocks: (columns.len() as u32).div_ceil(block[1]),
            frequency_2: self.grid.max_frequency()[2],
            total_points: points.total as u32,
            ..WaveParams::default()
        };
        let blocks = params.row_blocks * params.column_blocks;
        params.jobs = blocks * points.chunks.len() as u32;
        // Work per group, in sums over one point.
        let work = u64::from(block[0] * block[1]) * 4 * CHUNK.min(points.total.max(1)) as u64;
        let groups = (tuning.fma_per_dispatch / work).clamp(1, u64::from(MAX_GROUPS)) as u32;
        let mut last = None;
        while params.first_job < params.jobs {
            control.check()?;
            let count = groups.min(params.jobs - params.first_job);
            let uniform = gpu.uniform("params", &params);
            let mut encoder = gpu.encoder(NAME);
            let buffers = [&uniform, &points.chunks_buffer, &points.fractions, &points.sums];
            self.product.dispatch(gpu, &mut encoder, &buffers, count);
            params.first_job += count;
            // One submission ahead: the device has work while the host waits, and a cancelled call ends soon.
            if let Some(last) = last.replace(gpu.queue.submit([encoder.finish()])) {
                gpu.wait(NAME, last)?;
            }
        }

        let total = modes * points.realizations;
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
        let folded: Vec<[f32; 2]> = gpu.read_back(FOLD_NAME, encoder, &points.power, total)?;

        let [_, n1, n2] = self.grid.half_shape();
        let (plane, centre) = (n1 * n2, n1 * n2 / 2);
        for (power, folded) in power.iter_mut().zip(folded.chunks_exact(modes)) {
            for (row, folded) in rows.clone().zip(folded.chunks_exact(columns.len())) {
                for (column, &[plus, minus]) in columns.clone().zip(folded) {
                    power[row * plane + centre - column] = f64::from(minus);
                    power[row * plane + centre + column] = f64::from(plus);
                }
            }
        }
        Ok(())
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
    fn cuts_fit_and_make_progress() {
        for (rows, columns) in [(1, 1), (257, 257), (65537, 3), (10, 100_000), (4097, 1)] {
            for chunks in [0, 1, 7, 500] {
                for sums in [500, 5_000, 1 << 21] {
                    let c = cut(rows, columns, [64, 64], chunks, sums);
                    assert!(c.rows >= 1 && c.rows <= rows && c.columns >= 1 && c.columns <= columns);
                    assert!(
                        c.rows * c.columns * chunks.max(1) <= sums,
                        "{c:?} for {rows} x {columns}, {chunks}, {sums}"
                    );
                }
            }
        }
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

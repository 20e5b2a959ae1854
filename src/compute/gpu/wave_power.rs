//! The power spectrum on the GPU: how the sums become `WavePower`. See the reference for the definition,
//! `shaders/wave_power.wgsl` for the work itself and `shaders/shared/wave_types.wgsl` for where its sums lie.

use std::ops::Range;
use std::sync::Arc;

use super::kernel::Kernel;
use super::params::{WaveParams, WaveRange};
use super::wave_specs::{self, Blocks, FOLD_NAME, FOLD_WORKGROUP, LISTS, NAME, PANEL, chunk, columns, cut, fits};
use super::{GpuCompute, MAX_GROUPS};
use crate::accumulate::WavePower;
use crate::compute::compensated::Compensated;
use crate::compute::{Compute, See, coprime_from};
use crate::control::Control;
use crate::error::Result;
use crate::plan::{Accuracy, WaveGrid, WavePlan};
use crate::points::Ensemble;

pub(super) async fn wave_power(
    compute: &GpuCompute,
    plan: &WavePlan,
    ensemble: &Ensemble,
    see: &See<'_>,
    control: &Control,
) -> Result<WavePower> {
    let gpu = compute.gpu();
    let tuning = &compute.tuning;
    let binding_bytes = gpu.limits.max_storage_buffer_binding_size;
    let grid = plan.waves.grid().ok_or_else(|| gpu.error(NAME, LISTS))?;
    let sizes: Vec<usize> = (0..ensemble.realizations()).map(|k| ensemble.points_in(k)).collect();
    let largest = sizes.iter().copied().max().unwrap_or(0);
    let blocks = Blocks::new(grid);
    fits(largest as u64, &blocks, grid.dim(), binding_bytes).map_err(|reason| gpu.error(NAME, reason))?;

    let weighted = (0..sizes.len()).any(|k| ensemble.weights(k).is_some());
    let job = PowerJob {
        compute,
        grid,
        accuracy: plan.accuracy,
        blocks,
        product: compute.kernel(wave_specs::product(&blocks, grid, plan.accuracy, weighted)).await?,
        fold: compute.kernel(wave_specs::fold(&blocks, plan.accuracy)).await?,
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
                    let modes = f64::from(end[0] - row) * f64::from(end[1] - column);
                    let share = modes / blocks.total() as f64 * batch.len() as f64 / sizes.len() as f64;
                    job.run(&points, [row..end[0], column..end[1]], &mut power, (control, share)).await?;
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
            see(k, power);
            result.add(ensemble.first_index() + k as u64, ensemble.norm(k), power.as_slice(), &plan.rings);
        }
        first = end;
    }
    result.close_leaf();
    Ok(result)
}

/// The kernels and the plan of one call.
struct PowerJob<'a> {
    compute: &'a GpuCompute,
    grid: &'a WaveGrid,
    accuracy: Accuracy,
    blocks: Blocks,
    product: Arc<Kernel>,
    fold: Arc<Kernel>,
}

/// Points of some realizations on the device, and room for what becomes of them.
struct UploadedWavePoints {
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

impl PowerJob<'_> {
    fn upload(&self, ensemble: &Ensemble, batch: &Range<usize>, part: [u32; 2]) -> UploadedWavePoints {
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
        UploadedWavePoints {
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
        points: &UploadedWavePoints,
        part: [Range<u32>; 2],
        power: &mut [Vec<f64>],
        (control, share): (&Control, f64),
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
            control.advance(share * f64::from(count) / f64::from(params.jobs));
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

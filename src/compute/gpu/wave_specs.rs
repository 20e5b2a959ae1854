//! How a grid and its points are cut, which kernels sum their spectrum, and what a device must hold for it.

use super::kernel::{self, KernelSpec};
use super::params::{WAVE_POWER, WAVE_POWER_FOLD, WAVE_POWER_WEIGHTED};
use crate::plan::{Accuracy, WaveGrid, WavePlan};

pub(super) const NAME: &str = "wave_power";
pub(super) const FOLD_NAME: &str = "wave_power_fold";
/// Rows and columns per invocation, and numbers per table entry.
pub(super) const BLOCK: u32 = 4;
/// Workgroup memory for tables: what every WebGPU device has.
const TABLE_BYTES: u32 = 16 << 10;
/// Points summed in plain f32: the error of P grows with the square root of this, the cost of carrying with its inverse.
pub(super) const PANEL: u32 = 64;
/// Chunks of points a realization is cut into: enough for the largest devices, as long as a chunk repays its sums.
const CHUNKS: usize = 128;
/// Least and largest number of points of a chunk. The steps of `wave_carry.wgsl` are counted in i32 up to the latter.
const CHUNK: [usize; 2] = [1024, 32_768];
pub(super) const FOLD_WORKGROUP: u32 = 64;
pub(super) const LISTS: &str = "lists of wave vectors have no GPU kernel";
/// Bytes per sum and invocation: an integer and its rest in f32, or one f64, of four columns.
const SUM_BYTES: u64 = 32;

/// How a grid is cut into blocks of one workgroup each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Blocks {
    pub(super) row_lanes: u32,
    pub(super) column_lanes: u32,
    pub(super) lanes: u32,
    /// Sums per invocation.
    slots: u32,
    /// Blocks over rows and columns: at least 1, since row 0 and column 0 lie along them.
    pub(super) count: [u32; 2],
}

impl Blocks {
    pub(super) fn new(grid: &WaveGrid) -> Self {
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
    pub(super) fn items(&self) -> u32 {
        self.entries() + if self.slots > 2 { BLOCK * self.lanes } else { 0 }
    }

    pub(super) fn total(&self) -> u64 {
        u64::from(self.count[0]) * u64::from(self.count[1])
    }

    /// Rows and columns of a block.
    pub(super) fn span(&self) -> [usize; 2] {
        [self.row_lanes, self.column_lanes].map(|lanes| (BLOCK * lanes) as usize)
    }

    /// Bytes of the sums of one block over one chunk.
    pub(super) fn sum_bytes(&self) -> u64 {
        SUM_BYTES * u64::from(self.slots * self.lanes)
    }
}

/// The product kernel for a grid, cut into blocks.
pub(super) fn product(blocks: &Blocks, grid: &WaveGrid, accuracy: Accuracy, weighted: bool) -> KernelSpec {
    let (phase, carry, real_bytes, panel) = match accuracy {
        Accuracy::Fast => (kernel::PHASE, kernel::WAVE_CARRY, 4, PANEL),
        // No panels within a chunk.
        Accuracy::High => (kernel::PHASE_F64, kernel::WAVE_CARRY_F64, 8, CHUNK[1] as u32),
    };
    let (weights, bindings) =
        if weighted { (kernel::WAVE_WEIGHTED, WAVE_POWER_WEIGHTED) } else { (kernel::WAVE_UNWEIGHTED, WAVE_POWER) };
    let entries = blocks.entries();
    let tile = TABLE_BYTES / (2 * BLOCK * real_bytes * entries);
    KernelSpec {
        name: NAME,
        files: vec![phase, kernel::WAVE_TYPES, carry, weights, kernel::WAVE_POWER],
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
pub(super) fn fold(blocks: &Blocks, accuracy: Accuracy) -> KernelSpec {
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
pub(super) fn columns(grid: &WaveGrid) -> usize {
    let [_, n1, n2] = grid.half_shape();
    (n1 * n2).div_ceil(2)
}

/// Points per chunk of a realization with `n` points. It depends on nothing else, so neither do the bytes of the result.
pub(super) fn chunk(n: usize) -> usize {
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
    fits(plan.shape.max_points, &Blocks::new(grid), grid.dim(), binding_bytes)
}

/// Whether the points of a realization and the sums of one block over all its chunks fit into buffers.
pub(super) fn fits(points: u64, blocks: &Blocks, dim: usize, binding_bytes: u64) -> Result<(), String> {
    let chunks = points.div_ceil(chunk(usize::try_from(points).unwrap_or(usize::MAX / 2)) as u64);
    let sums = chunks.saturating_mul(blocks.sum_bytes());
    let bytes = points.saturating_mul(8 * dim as u64).max(sums);
    if bytes > binding_bytes || points > u64::from(u32::MAX) / 8 {
        return Err(format!("{points} points need {bytes} bytes in one buffer, the device has {binding_bytes}"));
    }
    Ok(())
}

/// The largest rectangle of blocks of which no more than `fitting` are needed: whole rows of blocks, or a part of one.
pub(super) fn cut(count: [u32; 2], fitting: u64) -> [u32; 2] {
    let fitting = u32::try_from(fitting).unwrap_or(u32::MAX).max(1);
    if count[1] <= fitting { [(fitting / count[1]).min(count[0]), count[1]] } else { [1, fitting] }
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
        let blocks = Blocks::new(&WaveGrid::new(&[64, 64]).unwrap());
        let binding = 128 << 20;
        assert_eq!(fits(1_000_000, &blocks, 2, binding), Ok(()));
        // 2^23 points of two coordinates of 8 bytes.
        assert!(fits(8_400_000, &blocks, 2, binding).unwrap_err().contains("134400000 bytes"));
        // 128 chunks of one block of 18 sums of 32 bytes for each of 256 invocations.
        assert!(
            fits(1_000_000, &blocks, 2, 1 << 24).unwrap_err().contains("18874368 bytes"),
            "{:?}",
            fits(1_000_000, &blocks, 2, 1 << 24)
        );
        assert!(fits(u64::MAX, &blocks, 2, u64::MAX).is_err());
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

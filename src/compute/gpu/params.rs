//! Rust twins of every WGSL struct and binding, and the registry by which a test compares both sides.

use bytemuck::{Pod, Zeroable};

/// One field of a struct: name, offset and size in bytes.
pub type Field = (&'static str, usize, usize);

/// A struct shared with a shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StructLayout {
    /// Its name in WGSL.
    pub name: &'static str,
    /// Its size in bytes.
    pub size: usize,
    /// Its fields in order.
    pub fields: Vec<Field>,
}

/// How a shader sees a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// `var<uniform>`
    Uniform,
    /// `var<storage, read>`
    Read,
    /// `var<storage, read_write>`
    ReadWrite,
}

/// One binding of group 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    /// Its number.
    pub binding: u32,
    /// The name of the variable in WGSL, and the label of the buffer.
    pub name: &'static str,
    /// Address space and access.
    pub access: Access,
}

const fn bound(binding: u32, name: &'static str, access: Access) -> Binding {
    Binding { binding, name, access }
}

macro_rules! twins {
    ($($(#[$doc:meta])* struct $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)+ })+) => {
        $($(#[$doc])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
        pub struct $name { $($(#[$field_doc])* pub $field: $type,)+ })+

        /// Every struct shared with a shader.
        pub fn struct_layouts() -> Vec<StructLayout> {
            vec![$(StructLayout {
                name: stringify!($name),
                size: size_of::<$name>(),
                fields: vec![$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$type>())),+],
            }),+]
        }
    };
}

twins! {
    /// See `shaders/shared/pairs.wgsl`.
    struct PairParams {
        /// Sides of the box in steps of `length_unit / 2^32`, rounded; 0 stands for 2^32.
        side_rounded: [u32; 4],
        /// Lower half of the sides in steps of `length_unit / 2^64`; 0, 0 stands for 2^64.
        side_low: [u32; 4],
        /// Upper half.
        side_high: [u32; 4],
        /// `BinFilter::Linear`: bins per step of `length_unit / 2^32`.
        bins_per_step: f32,
        /// `BinFilter::Linear`: relative guard.
        relative_guard: f32,
        /// `BinFilter::Linear`: absolute guard, in bins.
        absolute_guard: f32,
        /// `BinFilter::Table`: `bits(r2) >> CELL_SHIFT` of the first cell.
        first_cell: u32,
        /// `BinFilter::Table`: index of the last cell.
        last_cell: u32,
        /// Points in the buffers.
        total_points: u32,
        /// Padding.
        reserved: [u32; 2],
    }

    /// See `shaders/pair_counts.wgsl`: one tile against the tiles that follow it.
    struct PairJob {
        /// Where the realization begins in the buffers.
        first_point: u32,
        /// Points of the realization.
        points: u32,
        /// The tile held in registers.
        tile: u32,
        /// How many tiles further on (cyclically) the first of the others is.
        first_step: u32,
        /// How many others.
        steps: u32,
        /// The histogram to add to.
        histogram: u32,
    }

    /// See `shaders/lag_counts.wgsl`.
    struct LagParams {
        /// Periods in steps of `length_unit / 2^32`, rounded; 0 stands for 2^32.
        side_rounded: [u32; 4],
        /// Lower half of the periods in steps of `length_unit / 2^64`; 0, 0 stands for 2^64.
        side_low: [u32; 4],
        /// Upper half.
        side_high: [u32; 4],
        /// Lower half of the first threshold of each axis, modulo 2^64.
        first_low: [u32; 4],
        /// Upper half.
        first_high: [u32; 4],
        /// Lower half of the last lag within the grid, counted from the first threshold.
        last_low: [u32; 4],
        /// Upper half.
        last_high: [u32; 4],
        /// `LagFilter`
        scale: [f32; 4],
        /// `LagFilter`
        offset: [f32; 4],
        /// `LagFilter`
        low: [f32; 4],
        /// `LagFilter`
        high: [f32; 4],
        /// `LagFilter`
        guard: [f32; 4],
        /// Cells from one bin of an axis to the next.
        strides: [u32; 4],
        /// Points in the buffers.
        total_points: u32,
        /// Padding.
        reserved_0: u32,
        /// Padding.
        reserved_1: u32,
        /// Padding.
        reserved_2: u32,
    }

    /// See `shaders/pair_counts_cells.wgsl`: tasks of one realization.
    struct CellPairJob {
        /// The first task.
        first_task: u32,
        /// How many.
        tasks: u32,
        /// The histogram to add to.
        histogram: u32,
    }

    /// See `shaders/pair_counts_cells.wgsl`: points of one cell against a range of points.
    struct CellPairTask {
        /// The first point of the cell.
        first_row: u32,
        /// How many.
        rows: u32,
        /// The first of the others.
        first: u32,
        /// One past the last of them.
        end: u32,
        /// The binary logarithm of the number of invocations that hold the rows.
        lane_bits: u32,
    }

    /// See `shaders/shared/cell_types.wgsl`.
    struct CellParams {
        /// Lower half of `CellAxis`'s multipliers.
        multiplier_low: [u32; 4],
        /// Upper half.
        multiplier_high: [u32; 4],
        /// Shifts of the upper half of the product.
        shift: [u32; 4],
        /// How far apart neighbouring cells of an axis are in the list of cells.
        stride: [u32; 4],
        /// Points in the buffers.
        total_points: u32,
        /// Padding.
        reserved_0: u32,
        /// Padding.
        reserved_1: u32,
        /// Padding.
        reserved_2: u32,
    }

    /// See `shaders/cell_count.wgsl`: points of one realization.
    struct CellJob {
        /// The first of them.
        first_point: u32,
        /// How many.
        points: u32,
        /// Where the counts of the realization begin.
        first_cell: u32,
    }

    /// See `shaders/shared/wave_types.wgsl`: the part of the grid at hand.
    struct WaveParams {
        /// The first `m_0` of the blocks at hand.
        first_row: u32,
        /// Their first column.
        first_column: u32,
        /// Blocks over rows.
        row_blocks: u32,
        /// Blocks over columns.
        column_blocks: u32,
        /// Largest `|m_2|`.
        frequency_2: u32,
        /// Points in the buffers.
        total_points: u32,
        /// The work item of workgroup 0.
        first_job: u32,
        /// Number of work items.
        jobs: u32,
        /// A zero that the shader compiler does not know.
        zero: u32,
        /// Padding.
        reserved_0: u32,
        /// Padding.
        reserved_1: u32,
        /// Padding.
        reserved_2: u32,
    }

    /// See `shaders/shared/wave_types.wgsl`: points of a chunk, or chunks of a realization.
    struct WaveRange {
        /// The first.
        first: u32,
        /// How many.
        count: u32,
    }

    /// See `shaders/probe.wgsl`.
    struct ProbeParams {
        /// Number of inputs.
        count: u32,
        /// A zero that the shader compiler does not know.
        zero: u32,
        /// Padding.
        reserved_0: u32,
        /// Padding.
        reserved_1: u32,
    }

    /// See `shaders/probe.wgsl`.
    struct ProbeInput {
        /// First summand.
        a: f32,
        /// Second summand.
        b: f32,
        /// A phase in steps of 2^-32 turns.
        phase: u32,
        /// Padding.
        reserved: u32,
    }

    /// See `shaders/probe.wgsl`.
    struct ProbeOutput {
        /// The rounded sum.
        sum: f32,
        /// What the rounding left out.
        error: f32,
        /// Cosine of the phase.
        cos: f32,
        /// Sine of the phase.
        sin: f32,
    }
}

macro_rules! pair_bindings {
    ($($(#[$doc:meta])* $name:ident = $($extra:expr),*;)+) => {
        $($(#[$doc])*
        pub const $name: &[Binding] = &[
            bound(0, "params", Access::Uniform),
            bound(1, "jobs", Access::Read),
            bound(2, "rounded", Access::Read),
            bound(3, "exact", Access::Read),
            bound(4, "thresholds", Access::Read),
            bound(5, "histograms", Access::ReadWrite),
            $($extra),*
        ];)+
    };
}

const CELLS: Binding = bound(6, "cells", Access::Read);
const BOUNDS: Binding = bound(7, "bounds", Access::Read);
const DEPTHS: Binding = bound(8, "depths", Access::Read);
const TASKS: Binding = bound(9, "tasks", Access::Read);

pair_bindings! {
    /// Bindings of `pair_counts` with linear bins.
    PAIR_LINEAR = ;
    /// Bindings of `pair_counts` with a table of bins.
    PAIR_TABLE = CELLS, BOUNDS;
    /// `PAIR_LINEAR` with minus sampling.
    PAIR_LINEAR_BORDER = DEPTHS;
    /// `PAIR_TABLE` with minus sampling.
    PAIR_TABLE_BORDER = CELLS, BOUNDS, DEPTHS;
    /// Bindings of `pair_counts_cells` with linear bins.
    CELL_PAIR_LINEAR = TASKS;
    /// Bindings of `pair_counts_cells` with a table of bins.
    CELL_PAIR_TABLE = CELLS, BOUNDS, TASKS;
    /// `CELL_PAIR_LINEAR` with minus sampling.
    CELL_PAIR_LINEAR_BORDER = DEPTHS, TASKS;
    /// `CELL_PAIR_TABLE` with minus sampling.
    CELL_PAIR_TABLE_BORDER = CELLS, BOUNDS, DEPTHS, TASKS;
}

/// Bindings of `cell_count`.
pub const CELL_COUNT: &[Binding] = &[
    bound(0, "params", Access::Uniform),
    bound(1, "jobs", Access::Read),
    bound(2, "exact", Access::Read),
    bound(3, "places", Access::ReadWrite),
    bound(4, "counts", Access::ReadWrite),
];

/// Bindings of `cell_scatter`.
pub const CELL_SCATTER: &[Binding] = &[
    bound(0, "params", Access::Uniform),
    bound(1, "starts", Access::Read),
    bound(2, "places", Access::Read),
    bound(3, "rounded", Access::Read),
    bound(4, "exact", Access::Read),
    bound(5, "depths", Access::Read),
    bound(6, "sorted_rounded", Access::ReadWrite),
    bound(7, "sorted_exact", Access::ReadWrite),
    bound(8, "sorted_depths", Access::ReadWrite),
];

/// Bindings of `lag_counts`.
pub const LAG_COUNTS: &[Binding] = PAIR_LINEAR;

macro_rules! wave_bindings {
    ($($(#[$doc:meta])* $name:ident = $($extra:expr),*;)+) => {
        $($(#[$doc])*
        pub const $name: &[Binding] = &[
            bound(0, "params", Access::Uniform),
            bound(1, "chunks", Access::Read),
            bound(2, "fractions", Access::Read),
            bound(3, "sums", Access::ReadWrite),
            $($extra),*
        ];)+
    };
}

wave_bindings! {
    /// Bindings of `wave_power`.
    WAVE_POWER = ;
    /// The same with weights of points.
    WAVE_POWER_WEIGHTED = bound(4, "weights", Access::Read);
}

/// Bindings of `wave_power_fold`.
pub const WAVE_POWER_FOLD: &[Binding] = &[
    bound(0, "params", Access::Uniform),
    bound(1, "realizations", Access::Read),
    bound(2, "sums", Access::Read),
    bound(3, "power", Access::ReadWrite),
];

/// Bindings of `probe`.
pub const PROBE: &[Binding] =
    &[bound(0, "params", Access::Uniform), bound(1, "inputs", Access::Read), bound(2, "outputs", Access::ReadWrite)];

// What wave_power and wave_power_fold share: the tile of the grid at hand, and the sums one hands to the other.

struct WaveParams {
    // Rows m_0 = first_row .. first_row + rows and columns first_column .. first_column + columns of this tile.
    first_row: u32,
    rows: u32,
    first_column: u32,
    columns: u32,
    // Workgroup blocks over them.
    row_blocks: u32,
    column_blocks: u32,
    // The work item of workgroup 0.
    first_job: u32,
    // Number of work items: blocks times chunks (wave_power), modes times realizations (wave_power_fold).
    jobs: u32,
    // Largest |m_2|.
    frequency_2: u32,
    // Coordinate a of point j is at a * total_points + j.
    total_points: u32,
    // A zero the compiler does not know.
    zero: u32,
    reserved: u32,
}

// Sums over the points of a chunk of cos cos, sin sin, cos sin and sin cos of (row, column) phases: high + low.
struct WaveSums {
    high: vec4<f32>,
    low: vec4<f32>,
}

// A range: points of a chunk, or chunks of a realization.
struct WaveRange {
    first: u32,
    count: u32,
}

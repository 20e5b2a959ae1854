// What wave_power and wave_power_fold share: the part of the grid at hand, and where sums lie.
//
// The grid is cut into blocks of ROW_LANES * 4 rows m_0 >= 1 by COLUMN_LANES * 4 columns other than (0, 0), one workgroup
// per block and chunk of points. Row 0 and column 0 need no product, so grids of a power of two fill blocks exactly.
// Four rows or four columns are one table entry; ENTRIES = ROW_LANES + COLUMN_LANES.
//
// A workgroup of LANES invocations owns SLOTS * LANES sums of a Real4 each: slot 0 and 1 are the cosines and sines of table entry lane % ENTRIES,
// over every (LANES / ENTRIES)th point; slots 2 + 4 r + (0, 1, 2, 3) are cos cos, sin sin, cos sin and sin cos of row r and
// four columns of the invocation. Consecutive invocations lie side by side.

struct WaveParams {
    // The first m_0 of the blocks at hand, and the first column.
    first_row: u32,
    first_column: u32,
    // Blocks over rows and over columns.
    row_blocks: u32,
    column_blocks: u32,
    // Largest |m_2|.
    frequency_2: u32,
    // Coordinate a of point j is at a * total_points + j.
    total_points: u32,
    // The work item of workgroup 0.
    first_job: u32,
    // Number of work items: blocks times chunks (wave_power), invocations (wave_power_fold).
    jobs: u32,
    // A zero the compiler does not know.
    zero: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

// A range: points of a chunk, or chunks of a realization.
struct WaveRange {
    first: u32,
    count: u32,
}

// The workgroup of a block and a chunk.
fn wave_group(chunk: u32, block: u32) -> u32 {
    return chunk * params.row_blocks * params.column_blocks + block;
}

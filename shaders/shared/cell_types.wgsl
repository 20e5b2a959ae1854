// What both halves of the sort into cells know.

struct CellParams {
    // Along an axis, the cell of a position is the upper half of its product with a multiplier, shifted right (CellAxis).
    multiplier_low: vec4<u32>,
    multiplier_high: vec4<u32>,
    shift: vec4<u32>,
    // How far apart neighbouring cells of an axis are in the list of cells.
    stride: vec4<u32>,
    // Points in the buffers: coordinate a of point j is at a * total_points + j.
    total_points: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

@group(0) @binding(0) var<uniform> params: CellParams;

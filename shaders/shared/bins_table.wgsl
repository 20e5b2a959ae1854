// The f32 filter for any bins (BinFilter::Table): a table over the bits of r^2. The other choice is bins_linear.wgsl.

// Per cell of r^2, the only edge that can be near, or SEARCH_BIT where several are.
@group(0) @binding(6) var<storage, read> cells: array<u32>;
// Per edge, r^2 below x is surely below the edge, above y surely above.
@group(0) @binding(7) var<storage, read> bounds: array<vec2<f32>>;

const SEARCH_BIT: u32 = 0x80000000u;
override CELL_SHIFT: u32 = 13u;

// The bin of a squared distance in steps of length_unit / 2^32, or OUTSIDE, or UNDECIDED | edge, or SEARCH.
fn bins_find(r2: f32) -> u32 {
    let position = max(bitcast<u32>(r2) >> CELL_SHIFT, params.first_cell) - params.first_cell;
    let edge = cells[min(position, params.last_cell)];
    if ((edge & SEARCH_BIT) != 0u) { return SEARCH; }
    let bound = bounds[edge];
    if (r2 < bound.x) { return select(edge - 1u, OUTSIDE, edge == 0u); }
    if (r2 > bound.y) { return edge; }
    return UNDECIDED | edge;
}

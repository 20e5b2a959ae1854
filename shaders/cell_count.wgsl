// First half of a counting sort of points into cells (definition: CellAxis in src/plan/cell_grid.rs): the cell of every point, how
// many points a cell has, and which of them this one is, in the order of arrival. That order is up to the device; sums over
// pairs are integers and do not depend on it. Second half: cell_scatter.wgsl.
//
// Joined with: shared/wide_integers, shared/cell_types.

override WORKGROUP: u32 = 64u;
override DIM: u32 = 2u;

// Points of one realization.
struct CellJob {
    first_point: u32,
    points: u32,
    // Where the counts of the realization begin.
    first_cell: u32,
}

@group(0) @binding(1) var<storage, read> jobs: array<CellJob>;
// Positions in steps of length_unit / 2^64 (low, high).
@group(0) @binding(2) var<storage, read> exact: array<vec2<u32>>;
// Cell and place within it.
@group(0) @binding(3) var<storage, read_write> places: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let job = jobs[group.x];
    for (var j = lane; j < job.points; j += WORKGROUP) {
        let point = job.first_point + j;
        var cell = job.first_cell;
        for (var axis = 0u; axis < DIM; axis++) {
            let multiplier = vec2<u32>(params.multiplier_low[axis], params.multiplier_high[axis]);
            let product = wide_product_128(exact[axis * params.total_points + point], multiplier);
            cell += wide_shift_right(product.zw, params.shift[axis]) * params.stride[axis];
        }
        places[point] = vec2<u32>(cell, atomicAdd(&counts[cell], 1u));
    }
}

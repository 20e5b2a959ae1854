// Second half of a counting sort of points into cells: every point to its place. First half: cell_count.wgsl.
//
// Joined with: shared/cell_types.

override WORKGROUP: u32 = 64u;
override DIM: u32 = 2u;
// 1 where points have depths (minus sampling).
override DEPTHS: u32 = 0u;

// The place of the first point of each cell.
@group(0) @binding(1) var<storage, read> starts: array<u32>;
@group(0) @binding(2) var<storage, read> places: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> rounded: array<u32>;
@group(0) @binding(4) var<storage, read> exact: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> depths: array<u32>;
@group(0) @binding(6) var<storage, read_write> sorted_rounded: array<u32>;
@group(0) @binding(7) var<storage, read_write> sorted_exact: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> sorted_depths: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    for (var point = group.x * WORKGROUP + lane; point < params.total_points; point += groups.x * WORKGROUP) {
        let place = places[point];
        let target_point = starts[place.x] + place.y;
        for (var axis = 0u; axis < DIM; axis++) {
            let offset = axis * params.total_points;
            sorted_rounded[offset + target_point] = rounded[offset + point];
            sorted_exact[offset + target_point] = exact[offset + point];
        }
        if (DEPTHS > 0u) { sorted_depths[target_point] = depths[point]; }
    }
}

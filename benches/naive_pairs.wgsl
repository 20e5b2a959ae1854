// Pairs per bin as one would write it first: an invocation per point, distances in f32, one histogram in global memory. Pairs
// next to an edge may be in the wrong bin. For comparison of speed only.

struct Params {
    points: u32,
    bins: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> points: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.points) { return; }
    let p = points[id.x];
    for (var j = 0u; j < id.x; j++) {
        var d = p - points[j];
        d -= round(d);
        // Up to half the side.
        let bin = u32(2.0 * length(d) * f32(params.bins));
        if (bin < params.bins) { atomicAdd(&counts[bin], 1u); }
    }
}

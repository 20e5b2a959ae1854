// The power spectrum as one would write it first: an invocation per wave vector, a sine and a cosine per point, all in f32.
// For comparison of speed only.

struct Params {
    points: u32,
    frequency: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> points: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read_write> power: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let width = 2u * params.frequency + 1u;
    if (id.x >= (params.frequency + 1u) * width) { return; }
    let m = vec2<f32>(f32(id.x / width), f32(id.x % width) - f32(params.frequency));
    var re = 0.0;
    var im = 0.0;
    for (var j = 0u; j < params.points; j++) {
        let phase = 6.2831853 * dot(m, points[j]);
        re += cos(phase);
        im -= sin(phase);
    }
    power[id.x] = re * re + im * im;
}

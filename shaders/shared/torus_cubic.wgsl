// Minimum image where every axis has period 2^64 (2^32 rounded): a wrapping difference read as signed. Also a window,
// which fills at most half of that circle. The other choice is torus_box.wgsl.

// Squared distance in f32, from coordinates rounded to 32 bits, in steps of length_unit / 2^32.
fn torus_squared_distance(p: vec3<u32>, q: vec3<u32>) -> f32 {
    let d = vec3<f32>(bitcast<vec3<i32>>(p - q));
    var r2 = d.x * d.x;
    if (DIM > 1u) { r2 += d.y * d.y; }
    if (DIM > 2u) { r2 += d.z * d.z; }
    return r2;
}

// Distance along one axis, exact, in steps of length_unit / 2^64.
fn torus_exact_distance(a: vec2<u32>, b: vec2<u32>, axis: u32) -> vec2<u32> {
    let d = wide_sub(a, b);
    if (d.y >= 0x80000000u) { return wide_sub(vec2<u32>(0u), d); }
    return d;
}

// The lag p - q in steps of length_unit / 2^32, from rounded coordinates.
fn torus_lag(p: vec3<u32>, q: vec3<u32>) -> vec3<i32> {
    return bitcast<vec3<i32>>(p - q);
}

// The lag a - b along one axis, exact, modulo 2^64.
fn torus_exact_lag(a: vec2<u32>, b: vec2<u32>, axis: u32) -> vec2<u32> {
    return wide_sub(a, b);
}
